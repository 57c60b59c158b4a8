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
    try:
        array: NDArray[Any] = np.asarray(unmasked(values))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has the type {array.dtype}; accepted: real numbers")
    shape = array.shape
    found = np.require(array, dtype=np.float64, requirements=["C", "A"])
    return found.reshape(shape)


def unmasked(values: Any) -> Any:
    """The values with NaN where they are masked; a column of a data frame as an array."""
    if isinstance(values, np.ma.MaskedArray):
        if not np.ma.is_masked(values) or values.dtype.kind not in "fiuc":
            return values.data
        wanted = values.dtype if values.dtype.kind in "fc" else np.dtype(np.float64)
        return np.ma.filled(values.astype(wanted), np.nan)
    if is_series(values):
        array = values.to_numpy()
        if array.dtype.kind == "O" and hasattr(values, "isna"):
            # Nullable numbers of pandas.
            try:
                return values.to_numpy(dtype=np.float64, na_value=np.nan)
            except (TypeError, ValueError):
                return array
        return array
    return values


def is_series(value: object) -> bool:
    """True for a column of a data frame: of pandas, polars and the like."""
    return hasattr(value, "to_numpy") and hasattr(value, "name") and not is_frame(value)


def is_frame(value: object) -> bool:
    """True for a data frame: of pandas, polars and the like."""
    return hasattr(value, "to_numpy") and hasattr(value, "columns")


def columns_of(frame: Any) -> dict[str, Any]:
    """The columns of a data frame by their names."""
    return {name: frame[name] for name in frame.columns}


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
