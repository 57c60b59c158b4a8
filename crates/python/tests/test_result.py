"""Results are compared, copied and pickled."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS

SCENARIO = asperity.Scenario(SCENARIOS / "nouira2020-modified.json").with_({"/method": "modal"})


def hits() -> asperity.Analysis:
    run = SCENARIO.simulate()
    channels = asperity.to_sep005(run.history)
    return asperity.analyse(channels, response="displacement", band_hz=(700, 1100))


RESULTS: dict[str, Callable[[], Any]] = {
    "simulate": SCENARIO.simulate,
    "sweep": lambda: SCENARIO.sweep({"/excitation/peak_n": [9, 20]}),
    "steady": lambda: SCENARIO.steady(0.2, 850, 900, harmonics=3, backbone=True),
    "modes": SCENARIO.modes,
    "laws": lambda: asperity.laws(SCENARIO),
    "tabulate": lambda: asperity.tabulate(SCENARIO),
    "analyse": hits,
    "fit": lambda: asperity.fit_power([1e5, 2e5, 4e5], [1e12, 1.3e12, 1.7e12]),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_equals_its_copies_and_its_repetition(name: str) -> None:
    found = RESULTS[name]()
    for other in (copy.copy(found), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert type(other) is type(found)
        assert other == found
    # The time that it took is not compared.
    assert RESULTS[name]() == found
    assert found != None  # noqa: E711
    assert found != {}


def test_results_with_other_values_differ() -> None:
    run = SCENARIO.simulate()
    assert run != SCENARIO.with_({"/excitation/peak_n": 20}).simulate()
    assert run != dataclasses.replace(run, frf=None)
    summary = copy.deepcopy(run.summary)
    summary["fundamental"]["frequency_hz"] += 1e-9
    assert run != dataclasses.replace(run, summary=summary)


def test_copies_of_tables_are_read_only() -> None:
    table = asperity.Table({"a": [1.0, np.nan], "b": ["x", "y"]})
    for other in (copy.deepcopy(table), pickle.loads(pickle.dumps(table))):
        assert other == table
        assert not other["a"].flags.writeable
    assert table != asperity.Table({"b": ["x", "y"], "a": [1.0, np.nan]})
    assert table != asperity.Table({"a": [1.0, 2.0], "b": ["x", "y"]})
    assert table != asperity.Table({"a": [1, 2], "b": ["x", "y"]})


def test_a_figure_from_a_pickle_is_written_as_the_first() -> None:
    figure = SCENARIO.modes().figure
    other = pickle.loads(pickle.dumps(figure))
    assert other == figure and hash(other) == hash(figure)
    assert (other.svg(), other.png()) == (figure.svg(), figure.png())
    assert other != SCENARIO.simulate().history_figure


def test_equal_laws_have_equal_hashes() -> None:
    document = {"kind": "power", "coefficient": 1.81e10, "exponent": 0.35}
    law = asperity.Law(document)
    same = {law, asperity.Law(dict(reversed(document.items()))), pickle.loads(pickle.dumps(law))}
    assert same == {law}
    assert len(same | {asperity.Law(document, reference_pa=1e5)}) == 2
    assert len(same | {asperity.Law({**document, "exponent": 0.36})}) == 2


def test_errors_are_pickled_with_their_faults() -> None:
    with pytest.raises(asperity.ScenarioError) as raised:
        SCENARIO.with_({"/duration_s": -1})
    other = pickle.loads(pickle.dumps(raised.value))
    assert (other.faults, str(other)) == (raised.value.faults, str(raised.value))
