"""Numbers and arrays of a caller as float64."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def numbers(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """The values as a contiguous float64 array of the same shape, without a copy where they are one.

    Raises
    ------
    TypeError
        If they are not real numbers.
    ValueError
        If nested lists have unequal lengths.
    """
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    try:
        array: NDArray[Any] = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has the type {array.dtype}; accepted: real numbers")
    shape = array.shape
    found = np.require(array, dtype=np.float64, requirements=["C", "A"])
    return found.reshape(shape)


def column(values: ArrayLike, name: str) -> list[float]:
    """The values as a list of floats.

    Raises
    ------
    ValueError
        If they do not have one dimension.
    """
    array = numbers(values, name)
    if array.ndim != 1:
        raise ValueError(f"{name} has shape {array.shape}; expected one dimension")
    found: list[float] = array.tolist()
    return found
