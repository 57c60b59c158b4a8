"""Identifications: equal to the command, from files and from analyses in memory, stopped at once."""

from __future__ import annotations

import importlib.util
import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import ROOT, SCENARIOS, without_times
from test_analyse import assert_same_table

Command = Callable[..., dict[str, Any]]

#: True values of the power law, in Pa^0.65/m and 1.
COEFFICIENT, EXPONENT = 1.81e10, 0.35


def rig() -> dict[str, Any]:
    """The paper's rig with a power law, by the fast method."""
    document = json.loads((SCENARIOS / "nouira2020-power.json").read_text(encoding="utf-8"))
    return {**document, "method": "modal"}


@pytest.fixture(scope="module")
def problem() -> dict[str, Any]:
    """Three simulated hits, whose law is asked for."""
    hits = []
    for peak in (5.0, 12.0, 28.0):
        summary = asperity.simulate(
            asperity.Scenario(rig()).with_({"/excitation/peak_n": peak})
        ).summary
        features = {
            "fundamental.frequency_hz": summary["fundamental"]["frequency_hz"],
            "fundamental.receptance_m_per_n": summary["fundamental"]["receptance_m_per_n"],
        }
        spread = {"fundamental.frequency_hz": 1e-4, "fundamental.receptance_m_per_n": 2e-3}
        hits.append(
            {
                "force_peak_n": peak,
                "features": {
                    name: {"value": value, "standard_deviation": spread[name] * value}
                    for name, value in features.items()
                },
            }
        )
    return {
        "schema": "asperity/identify/1",
        "scenario": rig(),
        "unknowns": [
            {"kind": "scalar", "pointer": "/laws/pl/coefficient", "bounds": [1e9, 1e11]},
            {"kind": "scalar", "pointer": "/laws/pl/exponent", "bounds": [0.05, 0.9]},
        ],
        "data": [{"kind": "hits", "hits": hits}],
        "given": [{"pointer": "/support", "relative": 0}],
        "pressures_pa": [5e4, 3e5],
        "starts": 1,
        "draws": 100,
    }


@pytest.fixture(scope="module")
def solved(
    problem: dict[str, Any], tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, asperity.Identification, list[float]]:
    """The problem as a file, its identification, and the progress on the way."""
    path = tmp_path_factory.mktemp("identify") / "problem.json"
    path.write_text(json.dumps(problem), encoding="utf-8")
    told: list[float] = []
    return path, asperity.identify(path, progress=told.append), told


def test_an_identification_equals_that_of_the_command(
    solved: tuple[Path, asperity.Identification, list[float]], command: Command, tmp_path: Path
) -> None:
    path, found, _ = solved
    out = tmp_path / "out"
    answer = command("identify", path, "--out", out)
    assert without_times(found.report) == without_times(answer)
    assert_same_table(found.law_band, out / "law.csv")
    assert_same_table(found.data, out / "data.csv")
    assert_same_table(found.posterior, out / "posterior.csv")
    for name, document in (
        ("law", found.law),
        ("scenario", found.scenario),
        ("draws", found.draws),
    ):
        written = json.loads((out / f"{name}.json").read_text(encoding="utf-8"))
        assert document == written, name


def test_an_identification_is_pickled(
    solved: tuple[Path, asperity.Identification, list[float]],
) -> None:
    _, found, _ = solved
    other = pickle.loads(pickle.dumps(found))
    assert other == found
    assert list(other.figures) == list(found.figures)
    assert other.draws == found.draws


def test_a_scenario_identifies_its_own_numbers(problem: dict[str, Any]) -> None:
    scenario = asperity.Scenario(problem["scenario"])
    rest = {key: value for key, value in problem.items() if key not in ("schema", "scenario")}
    found = scenario.identify(rest, fast=True)
    assert found.estimates == asperity.identify(problem, fast=True).estimates


def test_the_law_is_found_and_used(
    solved: tuple[Path, asperity.Identification, list[float]],
) -> None:
    _, found, told = solved
    assert told == sorted(told) and told[-1] == 1.0
    values = {estimate["name"]: estimate for estimate in found.estimates}
    assert len(values) == 2
    for estimate, true in zip(found.estimates, (COEFFICIENT, EXPONENT), strict=True):
        low, high = estimate["posterior_interval"]
        assert low < true < high
        assert estimate["value"] == pytest.approx(true, rel=1e-2)
    band = found.law_band
    law = COEFFICIENT * band["pressure_pa"] ** EXPONENT
    assert np.all((band["lower_pa_per_m"] < law) & (law < band["upper_pa_per_m"]))
    assert band["informed"].dtype == np.bool_
    assert found.law is not None and found.law["kind"] == "power"
    scenario = asperity.Scenario(rig()).with_({"/laws/pl": found.law})
    assert scenario.to_dict()["laws"]["pl"] == found.law
    assert asperity.Scenario(found.scenario).to_dict()["laws"]["pl"] == found.law
    assert np.abs(found.data["residual"]).max() < 1.0
    assert found.conclusions and isinstance(found.notices, list)
    assert found.posterior.rows == len(found.draws["draws"])


@pytest.mark.filterwarnings("ignore::asperity.JudgementWarning")
def test_an_analysis_enters_without_a_file(tmp_path: Path) -> None:
    hits = []
    for peak in (6.0, 24.0):
        run = asperity.simulate(asperity.Scenario(rig()).with_({"/excitation/peak_n": peak}))
        hits.append(asperity.to_sep005(run.history))
    analysis = asperity.analyse(hits, response="displacement", band_hz=(700, 1100))
    assert analysis.hits["averaged"].all()
    (tmp_path / "analysis.json").write_text(json.dumps(analysis.report), encoding="utf-8")
    floor = {"fundamental.frequency_hz": {"relative": 1e-3}}
    whole = {
        "schema": "asperity/identify/1",
        "scenario": rig(),
        "unknowns": [
            {"kind": "scalar", "pointer": "/laws/pl/coefficient", "bounds": [1e9, 1e11]}
        ],
        "starts": 1,
        "draws": 100,
    }

    def with_data(file: Any) -> dict[str, Any]:
        features = ["fundamental.frequency_hz"]
        data = {"kind": "analysis", "file": file, "features": features, "floor": floor}
        return {**whole, "data": [data]}

    of_file = asperity.identify(with_data("analysis.json"), folder=tmp_path)
    # As text, which is the same problem.
    in_place = asperity.identify(json.dumps(with_data(analysis.report)))
    assert in_place.estimates == of_file.estimates
    assert in_place.data["value"].tolist() == analysis.hits["frequency_hz"].tolist()
    assert in_place.report["provenance"]["files"] == []
    assert in_place.estimates[0]["value"] == pytest.approx(COEFFICIENT, rel=0.02)
    with pytest.raises(ValueError, match="/data/0/file.*schema"):
        asperity.identify(with_data({"schema": "asperity/decay/1"}))
    assert list(analysis.figures) == ["records", "frf", "features", "backbone"]
    assert "<svg" in analysis._repr_html_() and "<svg" in in_place._repr_html_()
    assert {"law", "features", "residuals", "profiles"} <= set(in_place.figures)

    # Tables of the same analysis, from a file and in memory.
    def with_backbone(file: Any) -> dict[str, Any]:
        hit, spread = {"force_peak_n": 24.0}, {"relative": 1e-3}
        backbone = {"kind": "backbone", "file": file, "index": 2, "hit": hit, "spread": spread}
        return {**whole, "data": [backbone]}

    columns = {name: np.asarray(column) for name, column in analysis.backbone.items()}
    rows = [",".join(columns)]
    for row in zip(*columns.values(), strict=True):
        rows.append(",".join("" if value != value else repr(float(value)) for value in row))
    (tmp_path / "backbone.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    of_file = asperity.identify(with_backbone("backbone.csv"), folder=tmp_path)
    in_place = asperity.identify(with_backbone(analysis.backbone))
    assert in_place.estimates == of_file.estimates
    assert in_place.data["value"].tolist() == of_file.data["value"].tolist()
    with pytest.raises(ValueError, match="/data/0/file.*frequency_hz"):
        asperity.identify(with_backbone({"index": [2.0], "amplitude_m": [1e-7]}))


def test_faults_of_a_problem_are_exceptions_in_words(problem: dict[str, Any]) -> None:
    for change, words in (
        ({"unknowns": []}, "unknowns"),
        ({"darws": 100}, "draws"),
        ({"draws": -1}, "draws"),
        ({"scenario": {"schema": "asperity/scenario/1"}}, "/scenario"),
    ):
        with pytest.raises(asperity.ScenarioError, match=words):
            asperity.identify({**problem, **change})
    unknown = {"kind": "scalar", "pointer": "/laws/none/coefficient", "bounds": [1, 2]}
    with pytest.raises(asperity.ScenarioError, match="/laws/none") as caught:
        asperity.identify({**problem, "unknowns": [unknown]})
    assert caught.value.pointer == "/unknowns"
    missing = {"kind": "analysis", "file": "none.json"}
    with pytest.raises(FileNotFoundError, match="none.json"):
        asperity.identify({**problem, "data": [missing]})
    for other in (None, 3, [1], np.zeros(3)):
        with pytest.raises(TypeError, match="accepted"):
            asperity.identify(other)  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError):
        asperity.identify("none.json")


def slow_problem() -> Path:
    """An identification of a minute and more."""
    return ROOT / "fixtures" / "problems" / "twin.json"


def test_an_exception_of_the_progress_function_stops_the_identification() -> None:
    def stop(fraction: float) -> None:
        raise LookupError(f"stopped at {fraction}")

    with pytest.raises(LookupError, match="stopped at"):
        asperity.identify(slow_problem(), progress=stop)


# Fixed steps keep it short.
@pytest.mark.filterwarnings("ignore::asperity.AccuracyWarning", "ignore::asperity.JudgementWarning")
def test_records_may_be_arrays(tmp_path: Path) -> None:
    """Samples in memory give the law of the same samples in a file."""
    scenario = asperity.Scenario(rig()).with_(
        {"/method": {"kind": "modal", "step_s": 1e-5, "modes_per_body": 3}, "/output_rate_hz": 50_000}
    )
    history = scenario.with_({"/laws/pl/coefficient": 1.6e10}).simulate().history
    hit = asperity.Table({name: history[name] for name in ("time_s", "force_n", "acceleration_m_per_s2")})
    asperity.write(tmp_path / "hit.npz", hit)
    arrays = np.stack([hit["force_n"], hit["acceleration_m_per_s2"]])
    channels = [{"name": "hammer", "unit": "N"}, {"name": "top", "unit": "m/s^2"}]
    settings = {"sample_rate_hz": 50_000, "channels": channels}
    laws = []
    for files, rig_settings in [
        ([str(tmp_path / "hit.npz")], {}),
        (hit, {}),
        ([hit.to_pandas()] if importlib.util.find_spec("pandas") else [hit], {}),
        (asperity.to_sep005(hit), {}),
        (arrays, {"rig": {"schema": "asperity/rig/1", **settings}}),
    ]:
        data = {"kind": "records", "files": files, "band_hz": [600, 1100], **rig_settings}
        problem = {
            "unknowns": [{"kind": "scalar", "pointer": "/laws/pl/coefficient", "bounds": [1e10, 3e10]}],
            "data": [{**data, "spread": {"relative": 1e-3}}],
            "starts": 1,
            "draws": 100,
        }
        laws.append(scenario.identify(problem, fast=True).law)
    assert laws[0] is not None
    assert laws[0]["coefficient"] == pytest.approx(1.6e10, rel=5e-3)
    assert all(law == laws[0] for law in laws)
    uneven = asperity.Table({**hit.to_dict(), "time_s": hit["time_s"] ** 1.2})
    with pytest.raises(ValueError, match="even times"):
        scenario.identify({"unknowns": [], "data": [{"kind": "records", "files": uneven}]})
