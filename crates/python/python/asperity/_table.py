"""Columns of equal length."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Table(Mapping[str, NDArray[Any]]):
    """Columns of equal length by their names; each name ends with its unit.

    A table is a mapping: ``table["time_s"]`` is an array of shape ``(rows,)``,
    ``pandas.DataFrame(dict(table))`` and ``polars.DataFrame(dict(table))`` are data frames.
    """

    __slots__ = ("_columns",)

    def __init__(self, columns: Mapping[str, NDArray[Any]]) -> None:
        arrays = {name: np.asarray(values) for name, values in columns.items()}
        for name, values in arrays.items():
            if values.ndim != 1:
                raise ValueError(f"column {name!r} has shape {values.shape}; expected one dimension")
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

    def __repr__(self) -> str:
        return f"<asperity.Table of {self.rows} rows: {', '.join(self._columns)}>"
