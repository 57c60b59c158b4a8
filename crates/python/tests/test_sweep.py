"""Sweeps: equal to the command, with errors of rows, progress and threads."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS, assert_same_columns

PATH = SCENARIOS / "nouira2020-modified.json"
# The file asks for finite differences, which take a hundred times as long.
MODAL = {"/method": "modal"}
RIG = asperity.Scenario(PATH).with_(MODAL)
PEAKS = "/excitation/peak_n"
LAW = "/interfaces/0/law"


def test_columns_equal_those_of_the_command(
    command: Callable[..., dict[str, Any]], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    vary = ["--vary", f"{LAW}=modified,pl", "--vary", f"{PEAKS}=9:32:7"]
    command("sweep", PATH, "--set", "/method=modal", *vary, "--out", out)
    found = asperity.sweep(RIG, {LAW: ["modified", "pl"], PEAKS: "9:32:7"})
    assert_same_columns(found, out / "sweep.csv")
    assert found.failed == 0
    assert found.figure is not None
    assert found.figure.svg() == (out / "sweep.svg").read_text(encoding="utf-8")
    assert "<svg" in found._repr_html_() and "14 rows" in found._repr_html_()


def test_values_may_be_arrays_lists_and_ranges() -> None:
    expected = asperity.sweep(RIG, {PEAKS: [9.0, 20.0]})
    for values in (np.array([9, 20]), np.array([9.0, 20.0], dtype=">f4"), (9, 20), range(9, 21, 11)):
        found = asperity.sweep(RIG, {PEAKS: values})
        for name, column in expected.items():
            np.testing.assert_array_equal(found[name], column)
    assert found[PEAKS].tolist() == [9.0, 20.0]


def test_rows_are_the_runs_of_their_values() -> None:
    peaks, ratios = [9.0, 32.0, 20.0], [0.03, 0.04, 0.05]
    found = asperity.sweep(RIG, rows={PEAKS: peaks, "/damping/ratio": np.array(ratios)})
    assert found.rows == 3
    for row, (peak, ratio) in enumerate(zip(peaks, ratios, strict=True)):
        alone = asperity.sweep(RIG, {PEAKS: [peak], "/damping/ratio": [ratio]})
        assert list(alone) == list(found)
        for name, column in alone.items():
            np.testing.assert_array_equal(found[name][row], column[0], err_msg=name)


def test_a_row_that_fails_leaves_the_others() -> None:
    with pytest.warns(asperity.AsperityWarning, match="1 of 2 runs failed; row 0"):
        found = asperity.sweep(RIG, rows={PEAKS: ["loud", 9]})
    assert found.failed == 1
    assert "/excitation/peak_n" in found["error"][0]
    assert np.isnan(found["fundamental.frequency_hz"][0])
    assert found["fundamental.frequency_hz"][1] > 0.0


def test_invalid_values_name_their_place() -> None:
    with pytest.raises(asperity.ScenarioError) as raised:
        asperity.sweep(RIG, {PEAKS: [9, "loud"]})
    assert raised.value.pointer == PEAKS
    assert "loud" in str(raised.value)
    with pytest.raises(asperity.ScenarioError, match="did you mean /excitation/peak_n") as raised:
        asperity.sweep(RIG, {"/excitations/peak_n": [9]})
    assert raised.value.pointer == "/excitations/peak_n"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"vary": {}}, "empty"),
        ({"vary": {PEAKS: []}}, "no values"),
        ({"vary": {PEAKS: np.zeros(0)}}, "no values"),
        ({"vary": {PEAKS: "9:x:2"}}, "not a range"),
        ({"vary": {PEAKS: [np.nan]}}, "JSON"),
        ({"vary": {PEAKS: np.array([np.inf])}}, "not finite"),
        ({"vary": {PEAKS: range(1_000_001)}}, "at most 1000000"),
        ({"vary": {PEAKS: 3.0}}, "accepted"),
        ({"vary": {PEAKS: {"a": 1}}}, "accepted"),
        ({"vary": {PEAKS: b"12"}}, "accepted"),
        ({"vary": {PEAKS: [object()]}}, "cannot hold"),
        ({"vary": {3: [1]}}, "JSON Pointer"),
        ({"vary": {PEAKS: [9]}, "rows": {PEAKS: [9]}}, "either"),
        ({}, "either"),
        ({"rows": {}}, "one length"),
        ({"rows": {PEAKS: [1, 2], "/duration_s": [0.1]}}, "one length"),
        ({"vary": {PEAKS: [9]}, "threads": 0}, "1 to 1024"),
        ({"vary": {PEAKS: [9]}, "threads": 10**6}, "1 to 1024"),
    ],
)
def test_requests_that_make_no_sense_are_errors_in_words(
    arguments: dict[str, Any], words: str
) -> None:
    with pytest.raises((TypeError, ValueError), match=words):
        asperity.sweep(RIG, **arguments)


def test_results_do_not_depend_on_threads_and_calls_at_once() -> None:
    values = {PEAKS: np.linspace(9, 32, 40)}
    one = asperity.sweep(RIG, values, threads=1)
    found: list[asperity.Sweep] = []
    threads = [
        threading.Thread(target=lambda: found.append(asperity.sweep(RIG, values, threads=2)))
        for _ in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 3
    for other in found:
        for name, column in one.items():
            np.testing.assert_array_equal(other[name], column)


def test_progress_rises_and_its_exception_stops_the_sweep() -> None:
    told: list[float] = []
    asperity.sweep(RIG, {PEAKS: np.linspace(9, 32, 200)}, progress=told.append)
    assert told == sorted(told) and told[-1] == 1.0

    def stop(fraction: float) -> None:
        raise LookupError(f"stopped at {fraction}")

    with pytest.raises(LookupError, match="stopped at"):
        asperity.sweep(RIG, {PEAKS: np.linspace(9, 32, 4_000)}, progress=stop)
    with pytest.raises(LookupError, match="stopped at"):
        asperity.sweep(RIG, rows={PEAKS: np.linspace(9, 32, 2_000)}, progress=stop)


def test_texts_that_look_like_numbers_stay_texts() -> None:
    document = json.loads(PATH.read_text(encoding="utf-8")) | {"method": "modal"}
    document["laws"]["12"] = document["laws"]["pl"]
    found = asperity.sweep(document, {LAW: ["12", "pl"]})
    np.testing.assert_array_equal(
        found["fundamental.frequency_hz"][0], found["fundamental.frequency_hz"][1]
    )
