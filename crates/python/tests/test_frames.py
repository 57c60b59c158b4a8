"""Masked arrays, and data frames of other packages."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS

SCENARIO = asperity.Scenario(SCENARIOS / "nouira2020-modified.json").with_({"/method": "modal"})
BAND = (700, 1100)


@pytest.fixture(scope="module")
def history() -> asperity.Table:
    """Force and displacement of a hit."""
    found = SCENARIO.simulate().history
    return asperity.Table({name: found[name] for name in ("time_s", "force_n", "displacement_m")})


@pytest.fixture(params=["pandas", "polars"])
def frame_of(request: pytest.FixtureRequest) -> Any:
    """The class of data frames of a package."""
    pytest.importorskip(request.param)
    return importlib.import_module(request.param).DataFrame


def columns(table: asperity.Table) -> dict[str, Any]:
    return {name: np.array(column) for name, column in table.items()}


def test_masked_samples_are_dropouts(history: asperity.Table) -> None:
    rate = 1.0 / (history["time_s"][1] - history["time_s"][0])
    force, response = history["force_n"], np.ma.array(history["displacement_m"])
    settings: dict[str, Any] = {"sample_rate_hz": rate, "units": ["N", "m"], "band_hz": BAND}
    whole = asperity.analyse([[force, response], [force, response]], **settings)
    assert whole.hits["averaged"].tolist() == [True, True]
    masked = response.copy()
    masked[1000:1010] = np.ma.masked
    of_lists = [[force, masked], [force, response]]
    of_arrays = [np.ma.stack(record) for record in of_lists]
    sources: list[Any] = [of_lists, of_arrays, np.ma.stack(of_arrays)]
    for source in sources:
        found = asperity.analyse(source, **settings)
        assert found.hits["dropout"].tolist() == [True, False]
        assert found.hits["averaged"].tolist() == [False, True]
    # The values under the mask are the right ones, and are not read.
    assert masked.data[1000] == history["displacement_m"][1000]


def test_masked_pressures_have_no_stiffness() -> None:
    law = asperity.laws(SCENARIO)["modified"]
    for masked in (np.ma.array([1e5, 2e5], mask=[False, True]), np.ma.array([100_000, 7], mask=[False, True])):
        found = law.stiffness(masked)
        assert found[0] == law.stiffness(1e5) and np.isnan(found[1])


def test_masked_values_cannot_be_varied() -> None:
    masked = np.ma.array([9.0, 20.0], mask=[False, True])
    for name in ("vary", "rows"):
        asked: dict[str, Any] = {name: {"/excitation/peak_n": masked}}
        with pytest.raises(ValueError, match="/excitation/peak_n: a masked value"):
            SCENARIO.sweep(**asked)
    unmasked = np.ma.array([9.0, 20.0])
    assert SCENARIO.sweep({"/excitation/peak_n": unmasked}).rows == 2


def test_channels_of_a_frame_have_the_names_of_its_columns(
    history: asperity.Table, frame_of: Any
) -> None:
    expected = asperity.analyse(asperity.to_sep005(history), band_hz=BAND)
    frame = frame_of(columns(history))
    for source in (frame, history, [frame], [history]):
        found = asperity.analyse(source, band_hz=BAND)
        assert found.hits["frequency_hz"].tolist() == expected.hits["frequency_hz"].tolist()
        assert found.responses[0].name == "displacement_m"
    # Without times, and with names that tell no unit.
    bare = frame_of({"hammer": columns(history)["force_n"], "top": columns(history)["displacement_m"]})
    rate = 1.0 / (history["time_s"][1] - history["time_s"][0])
    series = [bare["hammer"], bare["top"]]
    for source in (bare, series):
        found = asperity.analyse(
            source, sample_rate_hz=rate, units=["N", "m"], force="hammer", band_hz=BAND
        )
        assert found.responses[0].name == "top"
        assert found.hits["frequency_hz"] == pytest.approx(expected.hits["frequency_hz"], rel=1e-9)
    with pytest.raises(ValueError, match="no column 'time_s' and no sample rate"):
        asperity.analyse(bare)
    with pytest.raises(TypeError, match="'note'"):
        asperity.analyse(frame_of({"time_s": [0.0, 1.0], "note": ["a", "b"]}))


def test_a_frame_is_written_and_becomes_channels(
    history: asperity.Table, frame_of: Any, tmp_path: Path
) -> None:
    frame = frame_of(columns(history))
    path = tmp_path / "hits.npz"
    asperity.write(path, frame)
    (record,) = asperity.read(path)
    assert [(one["name"], one["unit_str"]) for one in record] == [
        ("force_n", "N"),
        ("displacement_m", "m"),
    ]
    assert record[0]["data"].tolist() == history["force_n"].tolist()
    channels = asperity.to_sep005(frame)
    assert [one["name"] for one in channels] == ["force", "displacement"]
    with pytest.raises(FileExistsError, match="overwrite"):
        asperity.write(path, frame)


def test_a_frame_is_a_table_and_the_rows_of_a_sweep(frame_of: Any) -> None:
    frame = frame_of({"/excitation/peak_n": [9.0, 20.0], "/damping/ratio": [0.03, 0.04]})
    assert list(asperity.Table(frame)) == list(frame.columns)
    expected = SCENARIO.sweep(rows={"/excitation/peak_n": [9.0, 20.0], "/damping/ratio": [0.03, 0.04]})
    assert SCENARIO.sweep(rows=asperity.Table(frame)) == expected
    assert SCENARIO.sweep(rows=frame) == expected
    assert SCENARIO.sweep({"/excitation/peak_n": frame["/excitation/peak_n"]}).rows == 2


def test_nullable_columns_of_pandas_are_numbers() -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"x": pandas.array([1, None, 3], dtype="Int64")})
    assert np.isnan(asperity.Table(frame)["x"][1])
    law = asperity.laws(SCENARIO)["modified"]
    assert np.isnan(law.stiffness(frame["x"])[1])


@pytest.mark.parametrize("other", [3, "x", None, [1], 1.5])
def test_columns_of_other_types_are_type_errors(other: Any) -> None:
    with pytest.raises(TypeError, match="columns cannot be of the type .*; accepted"):
        asperity.Table(other)
    if other is not None:
        with pytest.raises(TypeError, match="vary cannot be of the type .*; accepted"):
            SCENARIO.sweep(other)
        with pytest.raises(TypeError, match="rows cannot be of the type .*; accepted"):
            SCENARIO.sweep(rows=other)
    if not isinstance(other, int | float):
        with pytest.raises(TypeError, match="from_hz is .*; accepted: a number"):
            SCENARIO.steady(0.2, other, 900)
    if not isinstance(other, list | None):
        with pytest.raises(TypeError, match="band_hz is .*; accepted: two frequencies"):
            asperity.analyse([np.ones(3)], sample_rate_hz=1.0, band_hz=other)


def test_paths_that_lead_nowhere_are_missing_files(tmp_path: Path) -> None:
    for path in (tmp_path / "none.npy", tmp_path / "*.npy"):
        for function in (asperity.analyse, asperity.read, asperity.decay):
            with pytest.raises(FileNotFoundError, match="npy"):
                function(path)
    with pytest.raises(FileNotFoundError, match="none"):
        SCENARIO.simulate().history_figure.save(tmp_path / "none" / "modes.svg")
    with pytest.raises(FileNotFoundError, match="none"):
        asperity.write(tmp_path / "none" / "x.npz", [np.ones(3)], sample_rate_hz=1.0)
