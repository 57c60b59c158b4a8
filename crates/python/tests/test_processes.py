"""Calls in processes that were forked or spawned."""

from __future__ import annotations

import multiprocessing
from multiprocessing.process import BaseProcess
from typing import Any

import pytest

import asperity
from conftest import SCENARIOS
from test_identify import COEFFICIENT, rig
from test_warnings import problem as problem_of

RIG = SCENARIOS / "nouira2020-modified.json"
VARY = {"/excitation/peak_n": [9, 20, 32]}
METHODS = [name for name in ("fork", "spawn") if name in multiprocessing.get_all_start_methods()]


def calls(scenario: asperity.Scenario) -> list[Any]:
    """Results of calls that use several threads."""
    return [
        scenario.sweep(VARY),
        scenario.sweep(VARY, threads=2),
        scenario.sweep(rows=VARY),
        scenario.steady([0.2, 0.4], 850, 900, harmonics=3),
        scenario.modes(),
        scenario.simulate(),
        asperity.analyse(asperity.to_sep005(scenario.simulate().history), response="displacement"),
    ]


def law_found(problem: dict[str, Any]) -> asperity.Identification:
    return asperity.Scenario(rig()).identify(problem, fast=True)


def child(scenario: asperity.Scenario, answers: Any) -> None:
    answers.put(calls(scenario))


def grandchild(scenario: asperity.Scenario, answers: Any) -> None:
    calls(scenario)
    wait_for(multiprocessing.get_context("fork").Process(target=child, args=(scenario, answers)))


def wait_for(process: BaseProcess) -> None:
    process.start()
    # The limit only ends a test that failed.
    process.join(timeout=60)
    if process.is_alive():
        process.kill()
        process.join()
    assert process.exitcode == 0


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
@pytest.mark.parametrize("method", METHODS)
def test_a_child_computes_what_its_parent_does(method: str) -> None:
    scenario = asperity.Scenario(RIG).with_({"/method": "modal"})
    # The parent has threads when it forks.
    expected = calls(scenario)
    context: Any = multiprocessing.get_context(method)
    with context.Manager() as manager:
        answers = manager.Queue()
        wait_for(context.Process(target=child, args=(scenario, answers)))
        assert answers.get(timeout=60) == expected
        if method == "fork":
            wait_for(context.Process(target=grandchild, args=(scenario, answers)))
            assert answers.get(timeout=60) == expected


@pytest.mark.skipif("fork" not in METHODS, reason="processes cannot be forked")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_a_pool_of_forked_processes_computes() -> None:
    scenario = asperity.Scenario(RIG).with_({"/method": "modal"})
    scenarios = [scenario.with_({"/excitation/peak_n": peak}) for peak in (9, 20, 32)]
    expected = [asperity.simulate(one) for one in scenarios]
    problem = problem_of(COEFFICIENT)
    found = law_found(problem)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(asperity.simulate, scenarios).get(timeout=60) == expected
        (other,) = pool.map_async(law_found, [problem]).get(timeout=60)
    assert other.estimates == found.estimates
