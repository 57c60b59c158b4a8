"""Runs: equal to the command, with progress, stopped by exceptions and signals."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS, assert_same_columns, without_times


@pytest.mark.filterwarnings("ignore::asperity.AccuracyWarning")
@pytest.mark.parametrize(
    "name", ["nouira2020-modified", "nouira2020-compliant-disc", "measured-hammer", "three-body"]
)
def test_results_equal_those_of_the_command(
    name: str, command: Callable[..., dict[str, Any]], tmp_path: Path
) -> None:
    path = SCENARIOS / f"{name}.json"
    answer = command("simulate", path, "--out", tmp_path / "out")
    run = asperity.simulate(path)
    assert without_times(run.summary) == without_times(answer)
    assert_same_columns(run.history, tmp_path / "out" / "history.csv")
    assert run.frf is not None
    assert_same_columns(run.frf, tmp_path / "out" / "frf.csv")


@pytest.mark.filterwarnings("ignore::asperity.AccuracyWarning")
def test_finite_differences_equal_those_of_the_command(
    command: Callable[..., dict[str, Any]], tmp_path: Path
) -> None:
    path = SCENARIOS / "nouira2020-power.json"
    changes = {"/method": "finite_difference", "/duration_s": 0.01}
    options = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
    answer = command("simulate", path, "--out", tmp_path / "out", *options)
    run = asperity.simulate(asperity.Scenario(path).with_(changes))
    assert without_times(run.summary) == without_times(answer)
    assert_same_columns(run.history, tmp_path / "out" / "history.csv")


def test_a_run_without_force_has_no_frf() -> None:
    scenario = asperity.Scenario(SCENARIOS / "nouira2020-power.json")
    run = asperity.simulate(scenario.with_({"/excitation": {"kind": "none"}, "/duration_s": 0.01}))
    assert run.frf is None
    assert not np.any(run.history["displacement_m"])


def slow_scenario() -> asperity.Scenario:
    """Some minutes of finite differences."""
    return asperity.Scenario(SCENARIOS / "nouira2020-power.json").with_(
        {
            "/method": {"kind": "finite_difference", "cell_m": 5e-4},
            "/duration_s": 5.0,
            "/output_rate_hz": 20000,
        }
    )


@pytest.mark.filterwarnings("ignore::asperity.AccuracyWarning")
def test_progress_rises_to_one() -> None:
    told: list[float] = []
    asperity.simulate(SCENARIOS / "nouira2020-power.json", progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_an_exception_of_the_progress_function_stops_the_run() -> None:
    def stop(fraction: float) -> None:
        raise LookupError(f"stopped at {fraction}")

    with pytest.raises(LookupError, match="stopped at"):
        asperity.simulate(slow_scenario(), progress=stop)


def test_a_progress_function_that_is_none_is_an_error() -> None:
    with pytest.raises(TypeError):
        asperity.simulate(SCENARIOS / "nouira2020-power.json", progress=3)  # type: ignore[arg-type]


@pytest.mark.filterwarnings("ignore::asperity.AccuracyWarning")
def test_threads_that_call_at_once_get_the_same_result() -> None:
    path = SCENARIOS / "nouira2020-power.json"
    alone = asperity.simulate(path)
    results: list[asperity.Simulation] = []
    threads = [
        threading.Thread(target=lambda: results.append(asperity.simulate(path))) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 4
    for result in results:
        assert without_times(result.summary) == without_times(alone.summary)
        for name, column in alone.history.items():
            np.testing.assert_array_equal(result.history[name], column)


def test_other_threads_run_meanwhile() -> None:
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.wait(0.001):
            counted += 1

    thread = threading.Thread(target=count)
    thread.start()
    seen: list[int] = []

    def stop_after_some(fraction: float) -> None:
        seen.append(counted)
        if len(seen) > 3 and seen[-1] > seen[0]:
            raise StopIteration

    with pytest.raises(StopIteration):
        asperity.simulate(slow_scenario(), progress=stop_after_some)
    done.set()
    thread.join()
    assert seen[-1] > seen[0]
