"""Columns of equal length."""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _asperity
from ._numbers import columns_of, is_frame, unit_of, unmasked
from ._result import same

# Rows that a notebook shows: so many from the start and from the end of a longer table.
_SHOWN = 5


class Table(Mapping[str, NDArray[Any]]):
    """Columns of equal length by their names; each name of numbers ends with its unit.

    A table is a mapping: ``table["time_s"]`` is a read-only array of shape ``(rows,)`` and of the
    type float64 (NaN where there is no value), int64, bool or str. It offers the Arrow C stream:
    ``polars.DataFrame(table)``, ``pyarrow.table(table)`` and
    ``pandas.DataFrame.from_arrow(table)`` take its numbers without a copy, and
    ``table.to_pandas()`` works in all versions. Notebooks show its first and last rows.

    Parameters
    ----------
    columns : mapping or data frame
        One-dimensional arrays, or lists, by name: numbers, integers, truth values or texts; or a
        ``DataFrame`` of pandas or polars.
        Numbers of other widths and byte orders become float64 and int64.

    Raises
    ------
    ValueError
        If a column does not have one dimension, or the lengths are not equal.
    TypeError
        If a column has another type, such as complex numbers or dates.
    KeyError
        If a column is asked for that the table does not have.
    """

    __slots__ = ("_columns",)

    def __init__(self, columns: Mapping[str, ArrayLike]) -> None:
        if is_frame(columns):
            columns = {name: unmasked(values) for name, values in columns_of(columns).items()}
        if not isinstance(columns, Mapping):
            kind = type(columns).__name__
            raise TypeError(f"columns cannot be of the type {kind}; accepted: a mapping from names to columns")
        arrays = {name: _column(name, values) for name, values in columns.items()}
        lengths = {len(values) for values in arrays.values()}
        if len(lengths) > 1:
            raise ValueError(f"columns have {sorted(lengths)} rows; expected equal lengths")
        self._columns = arrays

    def __getitem__(self, name: str) -> NDArray[Any]:
        try:
            return self._columns[name]
        except KeyError:
            known = ", ".join(self._columns)
            raise KeyError(f"no column {name!r}; the table has {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return next((len(values) for values in self._columns.values()), 0)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """The arrays by name; they share the memory of the table."""
        return dict(self._columns)

    def to_complex(self) -> NDArray[np.complex128]:
        """The frequency response of a table such as ``frf``, as one array.

        Returns
        -------
        ndarray of shape (rows,)
            Of the columns ``real`` and ``imag``, which may end with a unit, in their unit.

        Raises
        ------
        KeyError
            If the table does not have one pair of such columns.
        """
        real = [name for name in self if name == "real" or name.startswith("real_")]
        pairs = [(name, "imag" + name.removeprefix("real")) for name in real]
        pairs = [pair for pair in pairs if pair[1] in self]
        if len(pairs) != 1:
            raise KeyError(f"no pair of columns 'real' and 'imag'; the table has {', '.join(self)}")
        ((real_name, imag_name),) = pairs
        found = np.empty(self.rows, dtype=np.complex128)
        found.real, found.imag = self[real_name], self[imag_name]
        return found

    def to_pandas(self) -> Any:
        """The table as a ``pandas.DataFrame``, with its columns in their order.

        Raises
        ------
        ImportError
            If pandas is not installed; the package does not install it.
        """
        try:
            import pandas  # type: ignore[import-not-found,import-untyped,unused-ignore]
        except ImportError as error:
            raise ImportError("to_pandas needs the package pandas: pip install pandas") from error
        return pandas.DataFrame(self._columns)

    def to_xarray(self) -> Any:
        """The table as an ``xarray.Dataset``.

        Returns
        -------
        xarray.Dataset
            A variable for each column, over the times, frequencies or pressures of the table
            (``time_s``, ``frequency_hz``, ``pressure_pa``), or else over ``row``; the attribute
            ``units`` is that at the end of the name.

        Raises
        ------
        ImportError
            If xarray is not installed; the package does not install it.
        """
        try:
            import xarray  # type: ignore[import-not-found,import-untyped,unused-ignore]
        except ImportError as error:
            raise ImportError("to_xarray needs the package xarray: pip install xarray") from error
        over = next((name for name in _ABSCISSAE if name in self and _rises(self[name])), "row")
        columns = {
            name: (over, values, {"units": unit} if (unit := unit_of(name)[1]) else {})
            for name, values in self._columns.items()
        }
        coordinates = {name: columns.pop(name) for name in (over,) if name in columns}
        return xarray.Dataset(columns, coords=coordinates)

    def __eq__(self, other: object) -> bool:
        """True for a table of the same columns in the same order; NaN equals NaN."""
        if not isinstance(other, Table):
            return NotImplemented
        return list(self) == list(other) and same(self._columns, other._columns)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.to_dict(),)

    def _ipython_key_completions_(self) -> list[str]:
        """The names of the columns, for notebooks."""
        return list(self)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The columns as a stream of one batch (Arrow PyCapsule interface)."""
        return _asperity.arrow_stream(
            [
                (name, values.tolist() if values.dtype.kind == "U" else _contiguous(values))
                for name, values in self._columns.items()
            ]
        )

    def __repr__(self) -> str:
        return f"<asperity.{type(self).__name__} of {self.rows} rows: {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        """The first and the last rows, for notebooks."""
        rows = self.rows
        if rows > 2 * _SHOWN:
            shown: list[int | None] = [*range(_SHOWN), None, *range(rows - _SHOWN, rows)]
        else:
            shown = [*range(rows)]
        head = "".join(f"<th>{html.escape(name)}</th>" for name in self._columns)
        body = "".join(
            "<tr>"
            + "".join(
                f"<td>{'…' if row is None else html.escape(_text(values[row]))}</td>"
                for values in self._columns.values()
            )
            + "</tr>"
            for row in shown
        )
        return (
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
            f"<p>{rows} rows, {len(self._columns)} columns</p>"
        )


#: Columns that the others are over.
_ABSCISSAE = ("time_s", "frequency_hz", "pressure_pa")


def _rises(values: NDArray[Any]) -> bool:
    return bool(np.all(np.diff(values) > 0))


def _text(value: Any) -> str:
    if isinstance(value, np.floating):
        return "" if np.isnan(value) else f"{value:.6g}"
    return str(value)


def _contiguous(values: NDArray[Any]) -> NDArray[Any]:
    return np.require(values, requirements=["C", "A"])


def _column(name: str, values: ArrayLike) -> NDArray[Any]:
    """The values as a read-only array of a type that tables hold."""
    if not isinstance(name, str):
        raise TypeError(f"the column name {name!r} is a {type(name).__name__}; expected a str")
    if isinstance(values, np.ma.MaskedArray):
        if np.ma.is_masked(values) and values.dtype.kind != "f":
            raise TypeError(f"column {name!r} has masked values; only floats can be masked")
        values = values.filled(np.nan) if values.dtype.kind == "f" else values.data
    array = np.asarray(values)
    if array.ndim != 1:
        raise ValueError(f"column {name!r} has shape {array.shape}; expected one dimension")
    kind = array.dtype.kind
    if kind == "O" and all(isinstance(value, str) for value in array):
        kind = "U"
    if kind == "f":
        array = array.astype(np.float64, copy=False)
    elif kind in "iu":
        if array.dtype == np.uint64 and np.any(array > np.uint64(np.iinfo(np.int64).max)):
            raise ValueError(f"column {name!r} has integers of 64 bits; at most 2^63 - 1 is accepted")
        array = array.astype(np.int64, copy=False)
    elif kind in "UT":
        array = array.astype(np.str_, copy=False)
    elif kind != "b":
        raise TypeError(
            f"column {name!r} has the type {array.dtype}; "
            "accepted: numbers, integers, truth values or texts"
        )
    view = array.view()
    view.flags.writeable = False
    return view
