"""Steady responses and modes: equal to the command."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS, assert_same_columns, without_times

RIG = SCENARIOS / "nouira2020-modified.json"


def test_branches_equal_those_of_the_command(
    command: Callable[..., dict[str, Any]], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    options = ["--amplitude", "0.2,0.6", "--from", "700", "--to", "1000", "--harmonics", "5"]
    sweep = ["--backbone", "--sweep", "up", "--sweep-points", "5"]
    answer = command("steady", RIG, *options, *sweep, "--out", out)
    found = asperity.steady(
        RIG,
        [0.2, 0.6],
        700,
        1000,
        harmonics=5,
        backbone=True,
        time_sweep="up",
        time_sweep_points=5,
    )
    assert without_times(found.summary) == without_times(answer)
    assert_same_columns(found.points, out / "steady.csv")
    assert found.backbones is not None and found.time_sweeps is not None
    assert_same_columns(found.backbones, out / "backbone.csv")
    assert_same_columns(found.time_sweeps, out / "steady_time.csv")
    assert found.figure is not None
    assert found.figure.svg() == (out / "steady.svg").read_text(encoding="utf-8")
    levels = answer["levels"]
    assert found.peaks["peak_frequency_hz"].tolist() == [
        level["peak_frequency_hz"] for level in levels
    ]
    assert found.peaks["peak_is_inside"].dtype == np.bool_
    kinds = [point["kind"] for level in levels for point in level["bifurcations"]]
    assert found.special_points["kind"].tolist() == kinds
    assert "<svg" in found._repr_html_()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"amplitudes_n": []}, "at least 1"),
        ({"amplitudes_n": np.nan}, "positive and finite"),
        ({"amplitudes_n": [[0.2]]}, "one dimension"),
        ({"amplitudes_n": ["a"]}, "real numbers"),
        ({"amplitudes_n": [1j]}, "real numbers"),
        ({"from_hz": -1.0}, "frequency"),
        ({"to_hz": 700.0}, "frequency"),
        ({"harmonics": 0}, "1 to 400"),
        ({"harmonics": -3}, "harmonics|convert"),
        ({"bodies": "soft"}, "auto, elastic, condensed"),
        ({"time_sweep": "left"}, "up, down, both"),
        ({"threads": 0}, "1 to 1024"),
    ],
)
def test_requests_out_of_range_are_errors_in_words(arguments: dict[str, Any], words: str) -> None:
    request = {"amplitudes_n": 0.2, "from_hz": 700.0, "to_hz": 1000.0, "harmonics": 3} | arguments
    with pytest.raises((TypeError, ValueError, OverflowError), match=words):
        asperity.steady(RIG, **request)


def test_an_exception_of_the_progress_function_stops_the_branches() -> None:
    def stop(fraction: float) -> None:
        raise LookupError("stopped")

    with pytest.raises(LookupError, match="stopped"):
        asperity.steady(RIG, np.full(40, 0.2), 700, 1000, progress=stop)


def test_modes_equal_those_of_the_command(
    command: Callable[..., dict[str, Any]], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    answer = command("modes", RIG, "--count", "5", "--out", out)
    found = asperity.modes(RIG, 5)
    assert without_times(found.summary) == without_times(answer)
    assert_same_columns(found.shapes, out / "modes.csv")
    assert found.figure is not None
    assert found.figure.svg() == (out / "modes.svg").read_text(encoding="utf-8")
    assert found.table["frequency_hz"].tolist() == [m["frequency_hz"] for m in answer["modes"]]


@pytest.mark.parametrize("count", [0, -1, 1001, "a", None, 2.5])
def test_a_number_of_modes_out_of_range_is_an_error(count: Any) -> None:
    with pytest.raises((TypeError, ValueError)):
        asperity.modes(RIG, count)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: asperity.steady(RIG, 0.5, 700, 1000, harmonics=-1), ValueError, "harmonics is -1"),
        (lambda: asperity.steady(RIG, 0.5, 700, 1000, threads=0), ValueError, "threads is 0"),
        (lambda: asperity.modes(RIG, "a"), TypeError, "count is 'a'"),  # type: ignore[arg-type]
        (
            lambda: asperity.sweep(RIG, {"/excitation/peak_n": [9]}, threads=-1),
            ValueError,
            "threads is -1; accepted: 1 to 1024",
        ),
        (lambda: asperity.read(5), TypeError, "paths is 5"),  # type: ignore[arg-type]
        (lambda: asperity.signal.ForceWindow(2.0, 1.0), ValueError, "an end after the begin"),
        (lambda: asperity.signal.ResponseWindow(1.0, -1.0), ValueError, "taper_s is -1"),
    ],
)
def test_numbers_out_of_range_are_named(
    call: Callable[[], object], error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        call()


def test_motions_of_branches_that_end_early_are_a_table() -> None:
    found = asperity.steady(RIG, [0.5, 0.6], 700, 1000, harmonics=5)
    assert found.motions.rows == 0
    motion = {
        "frequency_hz": 900.0,
        "motion": "subharmonic",
        "periods": 3,
        "amplitude_1_m": 1e-7,
        "scatter": 0.2,
        "lost_share": None,
    }
    found.summary["levels"][1]["motions"] = [motion]
    rows = found.motions
    assert rows["branch"].tolist() == [2] and rows["force_n"].tolist() == [0.6]
    assert rows["motion"].tolist() == ["subharmonic"] and rows["periods"].tolist() == [3.0]
    assert np.isnan(rows["lost_share"][0])


def test_a_moving_base_has_accelerations() -> None:
    scenario = asperity.Scenario(SCENARIOS / "nouira2020-modified.json").with_({"/method": "modal"})
    moved = {"kind": "harmonic", "amplitude_m_per_s2": 1, "frequency_hz": 300}
    moving = scenario.with_({"/excitation": {"kind": "base_motion", "acceleration": moved}})
    found = moving.steady([0.2, 0.6], 700, 1000, harmonics=5)
    assert found.peaks["base_acceleration_m_per_s2"].tolist() == [0.2, 0.6]
    assert found.special_points.rows > 0
    assert set(found.special_points["base_acceleration_m_per_s2"]) == {0.6}
