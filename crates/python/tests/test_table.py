"""Tables as mappings of columns, and as streams of Arrow."""

from __future__ import annotations

import gc
import sys
from typing import Any

import numpy as np
import pytest

import asperity


def test_a_table_is_a_mapping_of_its_columns() -> None:
    table = asperity.Table({"time_s": np.arange(3.0), "force_n": np.zeros(3)})
    assert list(table) == ["time_s", "force_n"]
    assert len(table) == 2
    assert table.rows == 3
    assert "time_s" in table
    assert dict(table).keys() == table.keys()
    assert "3 rows" in repr(table)
    assert asperity.Table({}).rows == 0


def test_an_unknown_column_names_those_that_exist() -> None:
    table = asperity.Table({"time_s": np.arange(3.0)})
    with pytest.raises(KeyError, match="time_s"):
        table["force_n"]
    assert table.get("force_n") is None


def test_columns_of_other_shapes_are_errors() -> None:
    with pytest.raises(ValueError, match="equal lengths"):
        asperity.Table({"a": np.zeros(3), "b": np.zeros(2)})
    with pytest.raises(ValueError, match="one dimension"):
        asperity.Table({"a": np.zeros((3, 1))})


def typed() -> asperity.Table:
    return asperity.Table(
        {
            "time_s": np.array([0.0, 0.5, np.nan]),
            "branch": np.arange(3),
            "stable": np.array([True, False, True]),
            "kind": ["fold", "", "naïve ☃"],
        }
    )


def test_columns_have_one_of_four_types() -> None:
    table = asperity.Table(
        {
            "narrow": np.array([1.0, 2.0], dtype=np.float32),
            "big": np.array([1.0, 2.0], dtype=">f8"),
            "small": np.array([1, 2], dtype="u1"),
            "strided": np.arange(4.0)[::2],
            "objects": np.array(["a", "b"], dtype=object),
            "list": [1, 2],
            "masked": np.ma.masked_invalid([1.0, np.nan]),
        }
    )
    types = [column.dtype.str for column in table.values()]
    assert types == ["<f8", "<f8", "<i8", "<f8", "<U1", "<i8", "<f8"]
    assert table["big"].tolist() == [1.0, 2.0]
    assert np.isnan(table["masked"][1])


@pytest.mark.parametrize(
    "values",
    [
        np.array([1j]),
        np.array(["2026-01-01"], dtype="datetime64[D]"),
        np.array([None]),
        np.array([{}, []], dtype=object),
        np.ma.array([1, 2], mask=[True, False]),
        np.array([(1, 2.0)], dtype=[("a", int), ("b", float)]),
        b"ab",
    ],
)
def test_columns_of_other_types_are_errors(values: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="column 'x'"):
        asperity.Table({"x": values})
    with pytest.raises(TypeError, match="expected a str"):
        asperity.Table({3: [1.0]})  # type: ignore[dict-item]
    with pytest.raises(ValueError, match="at most"):
        asperity.Table({"x": np.array([2**64 - 1], dtype=np.uint64)})


def test_columns_are_read_only_and_leave_the_array_of_the_caller() -> None:
    mine = np.zeros(3)
    table = asperity.Table({"x": mine})
    with pytest.raises(ValueError, match="read-only"):
        table["x"][0] = 1.0
    mine[0] = 1.0
    assert table.to_dict()["x"][0] == 1.0


def test_notebooks_show_first_and_last_rows() -> None:
    shown = asperity.Table({"x<y": np.arange(100.0)})._repr_html_()
    assert "x&lt;y" in shown and "<td>4</td>" in shown and "<td>95</td>" in shown
    assert "<td>50</td>" not in shown and "100 rows" in shown
    assert "0 rows" in asperity.Table({})._repr_html_()


def test_polars_takes_every_type() -> None:
    polars = pytest.importorskip("polars")
    frame = polars.DataFrame(typed())
    assert [str(one) for one in frame.dtypes] == ["Float64", "Int64", "Boolean", "String"]
    assert frame["branch"].to_list() == [0, 1, 2]
    assert frame["stable"].to_list() == [True, False, True]
    assert frame["kind"].to_list() == ["fold", "", "naïve ☃"]
    assert frame["time_s"][1] == 0.5 and np.isnan(frame["time_s"][2])
    assert polars.DataFrame(asperity.Table({"x": np.zeros(0)})).shape == (0, 1)
    assert polars.DataFrame(asperity.Table({})).shape == (0, 0)


def test_arrow_shares_the_memory_of_numbers_and_keeps_it_alive() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    numbers = np.random.default_rng(1).normal(size=100_000)
    address = numbers.__array_interface__["data"][0]
    expected = numbers.copy()
    table = asperity.Table({"x": numbers, "n": np.arange(100_000)})
    found = pyarrow.table(table)
    assert found["x"].chunk(0).buffers()[1].address == address
    del table, numbers
    gc.collect()
    other = [np.full(100_000, 7.0) for _ in range(20)]
    np.testing.assert_array_equal(found["x"].to_numpy(), expected)
    assert found["n"].to_pylist()[-1] == 99_999
    del other
    found.validate(full=True)


def test_a_stream_that_nobody_takes_frees_its_memory() -> None:
    for _ in range(100):
        asperity.Table({"x": np.zeros(1000)}).__arrow_c_stream__()
    strided = asperity.Table({"x": np.arange(10.0)[::-2]})
    assert strided.__arrow_c_stream__(None) is not None


def test_a_frequency_response_is_one_complex_array() -> None:
    columns = {"frequency_hz": [1.0, 2.0], "real_m_per_n": [1.0, np.nan], "imag_m_per_n": [-2.0, 0.0]}
    found = asperity.Table(columns).to_complex()
    assert found.dtype == np.complex128
    assert found[0] == 1.0 - 2.0j and np.isnan(found[1].real)
    with pytest.raises(KeyError, match="frequency_hz"):
        asperity.Table({"frequency_hz": [1.0]}).to_complex()


def test_names_of_columns_are_completed() -> None:
    table = asperity.Table({"time_s": [1.0], "force_n": [2.0]})
    assert table._ipython_key_completions_() == ["time_s", "force_n"]


def test_a_table_becomes_a_frame() -> None:
    pandas = pytest.importorskip("pandas")
    table = asperity.Table({"n": [1, 2], "x": [1.0, np.nan], "ok": [True, False], "t": ["a", "b"]})
    frame = table.to_pandas()
    assert list(frame.columns) == list(table) and len(frame) == 2
    assert asperity.Table(frame) == table
    assert isinstance(frame, pandas.DataFrame)


def test_without_pandas_the_error_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        asperity.Table({"x": [1.0]}).to_pandas()


def test_a_table_becomes_a_dataset_over_its_times() -> None:
    pytest.importorskip("xarray")
    table = asperity.Table({"time_s": [0.0, 0.1], "force_n": [1.0, 2.0], "kind": ["a", "b"]})
    found = table.to_xarray()
    assert found["force_n"].dims == ("time_s",)
    assert found["force_n"].attrs == {"units": "N"} and found["time_s"].attrs == {"units": "s"}
    assert found["kind"].attrs == {}
    np.testing.assert_array_equal(found["force_n"].sel(time_s=0.1), 2.0)
    assert asperity.Table({"time_s": [0.1, 0.1]}).to_xarray()["time_s"].dims == ("row",)
