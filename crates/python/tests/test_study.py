"""Studies: equal to the command, stopped and continued, with errors that have their places."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS, assert_same_columns

RIG = asperity.Scenario(SCENARIOS / "nouira2020-modified.json").with_({"/method": "modal"})


def uniform(pointer: str, lower: float, upper: float) -> dict[str, Any]:
    """An input between two ends."""
    return {
        "pointer": pointer,
        "distribution": {"kind": "uniform", "lower": lower, "upper": upper},
    }


#: Two inputs of which one counts for the frequency: Saltelli's design of 8 (2 + 2) runs.
STUDY: dict[str, Any] = {
    "inputs": [uniform("/excitation/peak_n", 9, 30), uniform("/damping/ratio", 0.03, 0.031)],
    "design": {"kind": "saltelli", "base_rows": 8},
    "chunk_rows": 8,
    "frf": {"start_hz": 700, "stop_hz": 1000, "count": 4},
}


def whole(**changes: Any) -> dict[str, Any]:
    """The study with its scenario."""
    return {"schema": "asperity/study/1", "scenario": RIG.to_dict(), **STUDY, **changes}


@pytest.fixture(scope="module")
def found() -> asperity.Study:
    return asperity.study(whole(), exceed={"fundamental.frequency_hz": 850})


def stop(fraction: float) -> None:
    """A progress function that stops what it is told about."""
    raise StopIteration(fraction)


def test_a_stopped_study_is_not_done(tmp_path: Path) -> None:
    # A hundred thousand hits are never done when the first report comes.
    many = whole(design={"kind": "saltelli", "base_rows": 32_768}, chunk_rows=64)
    with pytest.raises(StopIteration) as stopped:
        asperity.study(many, out=tmp_path / "runs", progress=stop)
    assert stopped.value.value < 0.5
    assert not (tmp_path / "runs" / "study.csv").exists()


def test_a_study_equals_that_of_the_command(
    found: asperity.Study, command: Callable[..., dict[str, Any]], tmp_path: Path
) -> None:
    path, out = tmp_path / "study.json", tmp_path / "runs"
    path.write_text(json.dumps(whole()), encoding="utf-8")
    # In the folder of a stopped study: the command goes on.
    with pytest.raises(StopIteration):
        asperity.study(path, out=out, progress=stop)
    with pytest.raises(FileExistsError, match="resume=True continues it"):
        asperity.study(path, out=out)
    again = asperity.study(path, out=out, resume=True, exceed=[("fundamental.frequency_hz", 850)])
    assert again == found and again.answers == found.answers
    exceed = ("--exceed", "fundamental.frequency_hz=850")
    assert command("study", "answers", path, "--out", out, *exceed) == found.answers
    assert_same_columns(found, out / "study.csv")
    assert_same_columns(found.histograms, out / "histograms.csv")
    assert_same_columns(found.exceedance, out / "exceedance.csv")
    assert found.frf is not None
    assert_same_columns(found.frf, out / "frf.csv")


def test_answers_are_tables(found: asperity.Study) -> None:
    assert found.rows == 32 and found.failed == 0
    quantiles = found.quantiles
    assert list(quantiles)[:5] == ["name", "unit", "runs_without", "mean", "standard_deviation"]
    assert list(quantiles)[5:] == ["0.05", "0.25", "0.5", "0.75", "0.95"]
    row = quantiles["name"].tolist().index("fundamental.frequency_hz")
    assert quantiles["0.05"][row] < quantiles["mean"][row] < quantiles["0.95"][row]
    indices = found.sobol_indices
    of = indices["name"] == "fundamental.frequency_hz"
    assert indices["input"][of].tolist() == ["/excitation/peak_n", "/damping/ratio"]
    assert indices["total"][of][0] > 0.9 > 0.1 > indices["total"][of][1]
    assert np.all(indices["total_low"][of] <= indices["total_high"][of])
    assert set(found.figures) == {"distributions", "exceedance", "sobol-indices", "frf"}


def test_a_study_is_a_method_of_its_scenario(found: asperity.Study) -> None:
    told: list[float] = []
    same = RIG.study(STUDY, threads=2, progress=told.append, probabilities=[0.1, 0.9])
    assert same == found
    assert list(same.quantiles)[5:] == ["0.1", "0.9"]
    assert told == sorted(told) and told[-1] == 1
    assert pickle.loads(pickle.dumps(same)).answers == same.answers
    with pytest.raises(ValueError, match="a scenario of its own"):
        RIG.study(whole())
    with pytest.raises(TypeError, match="accepted: a mapping"):
        RIG.study("study.json")  # type: ignore[arg-type]


def test_faults_have_their_places() -> None:
    for study, pointer in [
        ({**STUDY, "design": {"kind": "sobole", "rows": 8}}, "/design/kind"),
        ({**STUDY, "inputs": [uniform("/excitation/peak_n", 30, 9)]}, "/inputs/0/distribution"),
        ({**STUDY, "frf": {"start_hz": 9, "stop_hz": 5, "count": 4}}, "/frf/stop_hz"),
    ]:
        with pytest.raises(asperity.ScenarioError) as error:
            RIG.study(study)
        assert error.value.pointer == pointer
    with pytest.raises(asperity.ScenarioError, match="peak"):
        RIG.study({**STUDY, "inputs": [uniform("/excitation/peak", 9, 30)]})
    with pytest.raises(FileNotFoundError):
        asperity.study("absent.json")
    with pytest.raises(asperity.ScenarioError, match="no such observable"):
        RIG.study(STUDY, exceed={"frequency": 1})
    with pytest.raises(ValueError, match="needs the folder"):
        RIG.study(STUDY, resume=True)


def test_runs_that_fail_are_told() -> None:
    broken = {
        "inputs": [{"pointer": "/excitation/rise_s", "distribution": {"kind": "choice", "values": [3e-4, -1]}}],
        "design": {"kind": "grid", "levels": [2]},
    }
    with pytest.warns(asperity.AsperityWarning, match="1 of 2 runs failed; row 1") as told:
        found = RIG.study(broken)
    assert found.failed == 1 and found["error"][0] == ""
    assert [warning.filename for warning in told] == [__file__]
    assert np.isnan(found["fundamental.frequency_hz"][1])
