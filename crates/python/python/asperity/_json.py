"""JSON text of Python values, with the numbers and arrays of NumPy, laws and tables."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _asperity
from ._table import Table


def _plain(value: object) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    if isinstance(value, _asperity.Law):
        return value.to_dict()
    if isinstance(value, Table):
        return {name: _cells(column) for name, column in value.items()}
    raise TypeError(
        f"a document cannot hold a {type(value).__name__}; "
        "accepted: dict, list, tuple, str, int, float, bool, None, numbers and arrays of NumPy, Law, Table"
    )


def _cells(column: NDArray[Any]) -> list[Any]:
    """The cells of a column, None where there is no value."""
    if column.dtype.kind != "f":
        return column.tolist()  # type: ignore[no-any-return]
    return [number if number == number else None for number in column.tolist()]


def text_of(value: object) -> str:
    """JSON text of `value`; numbers that are not finite are a ValueError."""
    return json.dumps(value, allow_nan=False, default=_plain)
