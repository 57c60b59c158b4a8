"""Scenarios from paths, texts and dicts, and their faults as exceptions."""

from __future__ import annotations

import copy
import json
import pickle
from collections import OrderedDict
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS

RIG = SCENARIOS / "nouira2020-modified.json"


@pytest.fixture
def document() -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads(RIG.read_text(encoding="utf-8"))
    return loaded


def test_path_text_and_dict_are_the_same_scenario(document: dict[str, Any]) -> None:
    of_path = asperity.Scenario(RIG)
    assert of_path == asperity.Scenario(str(RIG))
    assert of_path == asperity.Scenario(RIG.read_text(encoding="utf-8"))
    assert of_path == asperity.Scenario(document) == asperity.Scenario(of_path)
    assert of_path.sha256 == asperity.Scenario(document).sha256
    assert of_path.to_dict() == document
    assert of_path.title == document["title"]


def test_values_are_set_together_and_leave_the_original(document: dict[str, Any]) -> None:
    original = asperity.Scenario(document)
    changed = original.with_(
        {"/excitation/peak_n": np.float32(20), "/title": "20", "/interfaces/0/law": "pl"}
    )
    assert original.to_dict() == document
    assert changed.to_dict()["excitation"]["peak_n"] == 20.0
    assert changed.title == "20"
    assert changed != original


def test_numpy_numbers_and_arrays_are_part_of_a_document(document: dict[str, Any]) -> None:
    points = np.array([[0.14e6, 1.15e12], [1e6, 2.46e12]])
    document["laws"]["measured"] = {"kind": "table", "points": points}
    document["duration_s"] = np.float64(0.01)
    taken = asperity.Scenario(document).to_dict()
    assert taken["laws"]["measured"]["points"] == points.tolist()
    assert taken["duration_s"] == 0.01


def test_every_fault_is_reported_with_its_place(document: dict[str, Any]) -> None:
    document["duration_s"] = -1
    document["bodies"][0]["lenght_m"] = document["bodies"][0].pop("length_m")
    with pytest.raises(asperity.ScenarioError) as raised:
        asperity.Scenario(document)
    error = raised.value
    faults = {fault["pointer"]: fault for fault in error.faults}
    assert {"/duration_s", "/bodies/0/lenght_m"} <= faults.keys()
    assert faults["/bodies/0/lenght_m"]["suggestion"] == '"length_m"'
    assert error.pointer == error.faults[0]["pointer"]
    assert error.accepted == error.faults[0]["accepted"]
    assert "did you mean" in str(error)
    assert isinstance(error, ValueError)


def test_a_pointer_that_leads_nowhere_names_what_exists() -> None:
    with pytest.raises(asperity.ScenarioError) as raised:
        asperity.Scenario(RIG).with_({"/excitations/peak_n": 20})
    assert raised.value.pointer == "/excitations/peak_n"
    assert "excitation" in str(raised.value.accepted)
    assert raised.value.faults[0]["suggestion"] == "/excitation/peak_n"


def test_texts_that_are_not_json_say_where() -> None:
    with pytest.raises(asperity.ScenarioError, match="line"):
        asperity.Scenario('{"schema": }')


def test_missing_files_and_folders_are_os_errors(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no such file"):
        asperity.Scenario(tmp_path / "none.json")
    with pytest.raises(OSError):
        asperity.Scenario(tmp_path)


@pytest.mark.parametrize("source", [None, 3, 2.5, [1], (), {1, 2}, object(), np.zeros(3), b"{}"])
def test_other_types_are_errors_in_words(source: Any) -> None:
    with pytest.raises((TypeError, OSError), match="accepted|no such file"):
        asperity.Scenario(source)


@pytest.mark.parametrize(
    "value", [float("nan"), float("inf"), object(), {1: {2, 3}}, b"x", 1j, np.datetime64("NaT")]
)
def test_values_that_json_does_not_know_are_errors(value: Any) -> None:
    with pytest.raises((TypeError, ValueError)):
        asperity.Scenario(RIG).with_({"/duration_s": value})


def test_cycles_and_deep_nesting_are_errors() -> None:
    cycle: dict[str, Any] = {}
    cycle["self"] = cycle
    with pytest.raises(ValueError):
        asperity.Scenario(cycle)
    deep: list[Any] = []
    for _ in range(900):
        deep = [deep]
    with pytest.raises((ValueError, RecursionError)):
        asperity.Scenario({"bodies": deep})


def test_scenarios_are_copied_and_pickled() -> None:
    scenario = asperity.Scenario(SCENARIOS / "measured-hammer.json")
    for other in (copy.copy(scenario), copy.deepcopy(scenario), pickle.loads(pickle.dumps(scenario))):
        assert other == scenario
    # Relative files are still found.
    assert pickle.loads(pickle.dumps(scenario)).with_({"/duration_s": 0.02}) is not None


def test_equal_scenarios_have_equal_hashes(document: dict[str, Any]) -> None:
    scenario = asperity.Scenario(RIG)
    reversed_keys = dict(reversed(document.items()))
    same = {scenario, asperity.Scenario(document), asperity.Scenario(reversed_keys)}
    same |= {pickle.loads(pickle.dumps(scenario)), copy.deepcopy(scenario)}
    assert len(same) == 1
    assert len(same | {scenario.with_({"/duration_s": 0.05})}) == 2


def test_values_come_from_any_mapping() -> None:
    scenario = asperity.Scenario(RIG)
    expected = scenario.with_({"/duration_s": 0.05})
    for mapping in (MappingProxyType({"/duration_s": 0.05}), OrderedDict({"/duration_s": 0.05})):
        assert scenario.with_(mapping) == expected
    for other in (None, [("/duration_s", 0.05)], "/duration_s=0.05"):
        with pytest.raises(TypeError, match="accepted: a mapping"):
            scenario.with_(other)  # type: ignore[arg-type]


def test_methods_give_what_the_functions_give() -> None:
    scenario = asperity.Scenario(RIG).with_({"/method": "modal"})
    vary, span = {"/excitation/peak_n": [9, 20]}, (0.2, 850, 900)
    told: list[float] = []
    assert scenario.simulate(progress=told.append) == asperity.simulate(scenario)
    assert told[-1] == 1.0
    assert scenario.sweep(vary) == asperity.sweep(scenario, vary)
    assert scenario.sweep(rows=vary, threads=1) == asperity.sweep(scenario, rows=vary)
    assert scenario.steady(*span, harmonics=3) == asperity.steady(scenario, *span, harmonics=3)
    assert scenario.modes(2) == asperity.modes(scenario, 2)
    assert scenario.modes() == asperity.modes(scenario)
    with pytest.raises(TypeError, match="harmonic"):
        scenario.steady(*span, harmonic=3)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="`vary` or `rows`"):
        scenario.sweep()
    with pytest.raises(ValueError, match="count"):
        scenario.modes(0)


def test_a_problem_of_a_scenario_is_a_mapping_without_one(document: dict[str, Any]) -> None:
    scenario = asperity.Scenario(document)
    with pytest.raises(TypeError, match="accepted: a mapping"):
        scenario.identify("problem.json")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="scenario of its own"):
        scenario.identify({"scenario": document})
    with pytest.raises(asperity.ScenarioError, match="unknowns"):
        scenario.identify({})


def test_a_saved_scenario_is_the_same_wherever_it_is(tmp_path: Path) -> None:
    scenario = asperity.Scenario(SCENARIOS / "measured-hammer.json").with_({"/title": "Schlag ß"})
    path = tmp_path / "saved.json"
    scenario.save(path)
    saved = asperity.Scenario(path)
    assert saved.folder == tmp_path
    # The force is read from the same file, and the rest is unchanged.
    file = saved.to_dict()["excitation"]["file"]
    assert (tmp_path / file).resolve() == SCENARIOS / "hammer-hit.csv"
    assert {**saved.to_dict(), "excitation": None} == {**scenario.to_dict(), "excitation": None}
    with pytest.raises(FileExistsError, match="overwrite"):
        scenario.save(path)
    saved.with_({"/duration_s": 0.02}).save(str(path), overwrite=True)
    assert asperity.Scenario(path).to_dict()["duration_s"] == 0.02
    assert [one.name for one in tmp_path.iterdir()] == ["saved.json"]
    with pytest.raises(FileNotFoundError):
        scenario.save(tmp_path / "none" / "saved.json")
    with pytest.raises(TypeError):
        scenario.save(3)  # type: ignore[arg-type]


def test_a_folder_is_the_start_of_relative_files() -> None:
    path = SCENARIOS / "measured-hammer.json"
    document = json.loads(path.read_text(encoding="utf-8"))
    assert asperity.Scenario(document, folder=SCENARIOS) == asperity.Scenario(path)
    with pytest.raises(asperity.ScenarioError):
        asperity.Scenario(document, folder=SCENARIOS / "elsewhere")
