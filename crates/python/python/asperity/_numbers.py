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


def like(values: Any, found: NDArray[np.float64], name: str) -> Any:
    """The numbers as a Series of pandas or polars, or a DataArray of xarray, where the values are one."""
    if not is_series(values):
        return found
    if hasattr(values, "dims"):
        return type(values)(found, coords=values.coords, dims=values.dims, name=name)
    if hasattr(values, "index"):
        return type(values)(found, index=values.index, name=name)
    return type(values)(name, found) if hasattr(values, "n_chunks") else found


def is_series(value: object) -> bool:
    """True for a column of a data frame: of pandas, polars and the like."""
    return hasattr(value, "to_numpy") and hasattr(value, "name") and not is_frame(value)


def is_frame(value: object) -> bool:
    """True for a data frame of pandas, polars and the like, and for a Dataset of xarray."""
    return hasattr(value, "to_numpy") and hasattr(value, "columns") or hasattr(value, "data_vars")


def columns_of(frame: Any) -> dict[str, Any]:
    """The columns of a data frame by their names; coordinates and variables of a Dataset."""
    names = frame.variables if hasattr(frame, "data_vars") else frame.columns
    return {name: frame[name] for name in names}


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


def unit_of(column: str) -> tuple[str, str]:
    """Ending of a column's name and its unit; both empty for an unknown one."""
    ending = max((one for one in _UNITS if column.endswith(one)), key=len, default="")
    return ending, _UNITS.get(ending, "")


#: Endings of column names, and their units.
_UNITS = {
    "_n": "N",
    "_hz": "Hz",
    "_s": "s",
    "_rad": "rad",
    "_m_per_n": "m/N",
    "_m": "m",
    "_m_per_s": "m/s",
    "_m_per_s2": "m/s^2",
    "_pa": "Pa",
    "_pa_per_m": "Pa/m",
    "_j": "J",
}
