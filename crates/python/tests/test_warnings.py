"""Doubts about results are warnings of their own classes; healthy results have none."""

from __future__ import annotations

import warnings
from typing import Any

import pytest

import asperity
from conftest import SCENARIOS
from test_identify import rig

RIG = SCENARIOS / "nouira2020-modified.json"


def test_the_classes_are_told_apart() -> None:
    assert issubclass(asperity.AsperityWarning, RuntimeWarning)
    for derived in (asperity.AccuracyWarning, asperity.JudgementWarning):
        assert issubclass(derived, asperity.AsperityWarning)


def test_an_accuracy_that_was_not_reached_is_a_warning() -> None:
    # Cells of 1 mm, as the paper's.
    scenario = asperity.Scenario(SCENARIOS / "nouira2020-power.json")
    with pytest.warns(asperity.AccuracyWarning, match="accuracy_not_reached: the estimated") as told:
        run = scenario.simulate()
    assert [warning["kind"] for warning in run.summary["warnings"]] == ["accuracy_not_reached"]
    # It is told where the caller is.
    assert [warning.filename for warning in told] == [__file__]


def test_a_sweep_tells_each_kind_once() -> None:
    vary = {"/excitation/peak_n": [9, 20, 32]}
    with pytest.warns(asperity.AccuracyWarning) as told:
        found = asperity.sweep(SCENARIOS / "nouira2020-power.json", vary)
    runs = found["warnings"].tolist().count("accuracy_not_reached")
    assert runs > 0
    assert str(told[0].message).startswith(f"accuracy_not_reached: {runs} of 3 runs")
    assert [warning.filename for warning in told] == [__file__]


def test_pressures_outside_a_measurement_are_not_about_accuracy() -> None:
    points = [[1e5, 9e11], [2e5, 1.3e12]]
    changes = {"/laws/few": {"kind": "table", "points": points}, "/interfaces/0/law": "few"}
    scenario = asperity.Scenario(RIG).with_({"/method": "modal", **changes})
    with pytest.warns(asperity.AsperityWarning, match="outside_measured_range: pressures") as told:
        scenario.simulate()
    assert {warning.category for warning in told} == {asperity.AsperityWarning}


def problem(coefficient: float) -> dict[str, Any]:
    """Frequencies at three forces, from a law with this coefficient."""
    true = asperity.Scenario(rig()).with_({"/laws/pl/coefficient": coefficient})
    hits = []
    for peak in (6.0, 12.0, 24.0):
        run = true.with_({"/excitation/peak_n": peak}).simulate()
        hertz = run.summary["fundamental"]["frequency_hz"]
        frequency = {"value": hertz, "standard_deviation": 1e-3 * hertz}
        hits.append({"force_peak_n": peak, "features": {"fundamental.frequency_hz": frequency}})
    unknown = {"kind": "scalar", "pointer": "/laws/pl/coefficient", "bounds": [1e9, 1e11]}
    data = [{"kind": "hits", "hits": hits}]
    return {"unknowns": [unknown], "data": data, "starts": 1, "draws": 100}


def test_a_law_that_may_not_be_used_is_a_warning() -> None:
    # The frequencies are beyond any coefficient within the bounds.
    asked = problem(2e10)
    for hit in asked["data"][0]["hits"]:
        feature = hit["features"]["fundamental.frequency_hz"]
        feature["value"] *= 1.0 + 0.02 * hit["force_peak_n"]
    with pytest.warns(asperity.JudgementWarning, match="the result is not to be used: ") as told:
        found = asperity.Scenario(rig()).identify(asked, fast=True)
    assert found.report["judgement"]["use"] == "no"
    assert [warning.filename for warning in told] == [__file__]


def test_healthy_results_have_no_warnings() -> None:
    scenario = asperity.Scenario(RIG).with_({"/method": "modal"})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert scenario.simulate().summary["warnings"] == []
        assert scenario.sweep({"/excitation/peak_n": [9, 20]}).failed == 0
        scenario.steady(0.2, 850, 900, harmonics=3)
        scenario.modes()
