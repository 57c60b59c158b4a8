"""Arrays of any kind as the contiguous ones that the native part reads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._numbers import unmasked
from ._table import Table


def _one_dimension(name: str, value: object, wanted: str) -> NDArray[Any]:
    try:
        array = np.asarray(unmasked(value))
    except ValueError as error:
        raise ValueError(f"{name} cannot be an array: {error}") from None
    if array.ndim != 1:
        raise ValueError(f"{name} has shape {array.shape}; expected one dimension")
    if array.size == 0 and array.dtype == np.float64:
        return array
    if array.dtype.kind not in wanted:
        accepted = "real or complex numbers" if "c" in wanted else "real numbers"
        raise TypeError(f"{name} holds {array.dtype}; accepted: {accepted}")
    return array


def real(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Contiguous float64 of shape (n,); TypeError for anything but real numbers."""
    return np.ascontiguousarray(_one_dimension(name, value, "fiu"), dtype=np.float64)


def complex_(name: str, value: ArrayLike) -> NDArray[np.complex128]:
    """Contiguous complex128 of shape (n,); TypeError for anything but numbers."""
    return np.ascontiguousarray(_one_dimension(name, value, "fiuc"), dtype=np.complex128)


def number(name: str, value: float) -> float:
    """A float; TypeError for anything but a real number."""
    if isinstance(value, bool | np.bool_ | str | bytes):
        raise TypeError(f"{name} is {value!r}; accepted: a number")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {value!r}; accepted: a number") from None


def count(name: str, value: int, least: int = 0, most: int | None = None) -> int:
    """An int from `least` on, to `most` if given."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name} is {value!r}; accepted: a whole number")
    if not least <= value <= (2**62 if most is None else most):
        accepted = f"{least} and above" if most is None else f"{least} to {most}"
        raise ValueError(f"{name} is {value!r}; accepted: {accepted}")
    return int(value)


def threads(value: int | None) -> int | None:
    """A number of threads, None for all cores."""
    return None if value is None else count("threads", value, 1, 1024)


def samples_of(name: str, seconds: float, sample_rate_hz: float) -> int:
    """Number of samples in a time."""
    samples = number(name, seconds) * number("sample_rate_hz", sample_rate_hz)
    if not (0 <= samples < 2**53):
        raise ValueError(f"{name} is {seconds} s at {sample_rate_hz} Hz; accepted: 0 s and above")
    return round(samples)


def table(columns: Mapping[str, NDArray[Any] | list[str]]) -> Table:
    """A table of native columns; lists of text become arrays of text."""
    return Table(
        {
            name: np.array(values, dtype=np.str_) if isinstance(values, list) else values
            for name, values in columns.items()
        }
    )
