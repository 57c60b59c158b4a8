"""Many runs of one scenario."""

from __future__ import annotations

import json
import warnings
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _asperity
from ._json import text_of
from ._numbers import columns_of, is_frame, is_series, unmasked
from ._simulate import ScenarioLike
from ._table import Table
from ._warning import AsperityWarning, tell

Values = str | Sequence[Any] | NDArray[Any]


class Sweep(Table):
    """Table of the runs of a sweep, a row each, with a figure.

    The columns are those of ``sweep.csv``: the varied values under their pointers, the observables
    (NaN where a response has none), ``error`` (the text of a run that failed, else empty) and
    ``warnings`` (kinds, separated by blanks).

    Attributes
    ----------
    figure : Figure or None
        The figure of the command; None if no variation is numeric, and for rows.
    """

    __slots__ = ("figure",)

    def __init__(
        self, columns: Mapping[str, ArrayLike], figure: _asperity.Figure | None = None
    ) -> None:
        super().__init__(columns)
        self.figure = figure

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.to_dict(), self.figure)

    @property
    def failed(self) -> int:
        """Number of runs that failed."""
        return int(np.count_nonzero(self["error"]))

    def _repr_html_(self) -> str:
        drawn = "" if self.figure is None else self.figure.svg()
        return drawn + super()._repr_html_()


def sweep(
    scenario: ScenarioLike,
    vary: Mapping[str, Values] | None = None,
    *,
    rows: Mapping[str, Values] | None = None,
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> Sweep:
    """Simulate many runs, without a loop in Python.

    Runs go over all cores; modal ones many at a time in the lanes of vectors. Results do not depend
    on the number of threads. A run that fails does not end the others: its error is in its row, and
    an `AsperityWarning` tells the number of such runs. For each kind of warning in the
    column ``warnings`` one warning of Python tells the number of its runs.

    Parameters
    ----------
    scenario : Scenario, str, os.PathLike or dict
        Anything that `Scenario` accepts.
    vary : mapping
        Values by JSON Pointer; all combinations are run, the last pointer varying fastest. Values
        are an array, a list of anything that a scenario may hold there, or text as the command
        takes it, such as ``"9:32:24"``.
    rows : mapping
        Instead of `vary`: arrays or lists of equal lengths by JSON Pointer, or a data frame whose
        columns have pointers as names; run ``i`` takes the
        value ``i`` of each. An invalid value is an error of its row.
    threads : int, optional
        Number of threads; all cores by default.
    progress : callable, optional
        Called with the fraction done, 0 to 1, some times a second. An exception that it raises
        stops the computation and is passed on.

    Returns
    -------
    Sweep
        A table of a row per run.

    Raises
    ------
    ScenarioError
        If the scenario, or with `vary` a combination of values, is not valid.
    TypeError
        If both or none of `vary` and `rows` are given, they are no mapping, or values are no array,
        list or text.
    ValueError
        If a value is masked or not finite, there is nothing to vary, the lengths of `rows` differ, or the sweep is too large.

    Examples
    --------
    >>> found = sweep("rig.json", {"/excitation/peak_n": [9, 20, 32]})   # doctest: +SKIP
    >>> found["fundamental.frequency_hz"]                                # doctest: +SKIP
    """
    if (vary is None) == (rows is None):
        raise TypeError("sweep takes either `vary` or `rows`")
    if is_frame(rows):
        rows = columns_of(rows)
    for name, values in (("vary", vary), ("rows", rows)):
        if values is not None and not isinstance(values, Mapping):
            kind = type(values).__name__
            raise TypeError(f"{name} cannot be of the type {kind}; accepted: a mapping by JSON Pointer")
    cores = _arrays.threads(threads)
    if rows is not None:
        columns = [(_pointer(key), _texts(key, values)) for key, values in rows.items()]
        lengths = sorted({len(values) for _, values in columns})
        if len(lengths) != 1 or lengths[0] == 0:
            raise ValueError(f"rows have the lengths {lengths}; expected one length from 1 on")
        found = Sweep(_asperity.sweep_rows(scenario, columns, cores, progress))
    else:
        assert vary is not None
        varied = [
            (_pointer(key), values if isinstance(values, str) else _texts(key, values))
            for key, values in vary.items()
        ]
        if not varied:
            raise ValueError("`vary` is empty; expected values by JSON Pointer")
        found = Sweep(*_asperity.sweep(scenario, varied, cores, progress))
    tell_of_runs(found, stacklevel=3)
    return found


def tell_of_runs(found: Table, stacklevel: int) -> None:
    """Warns of runs of a table that failed, and of the kinds of warnings of the others."""
    failed = np.flatnonzero(found["error"])
    if failed.size:
        first = int(failed[0])
        text = f"{failed.size} of {found.rows} runs failed; row {first}: {found['error'][first]}"
        warnings.warn(text, AsperityWarning, stacklevel=stacklevel)
    kinds = Counter(kind for text in found["warnings"].tolist() for kind in text.split())
    tell(
        (
            (kind, f"{runs} of {found.rows} runs; the column 'warnings' names them")
            for kind, runs in kinds.items()
        ),
        stacklevel=stacklevel + 1,
    )


def _pointer(key: object) -> str:
    if not isinstance(key, str):
        raise TypeError(f"{key!r} is not a JSON Pointer; expected a str such as /excitation/peak_n")
    return key


def _texts(key: str, values: Values) -> list[str]:
    """JSON text of each value; a text that is not JSON stands for itself, as in the command."""
    if np.ma.is_masked(values):
        raise ValueError(f"{key}: a masked value cannot be in a scenario")
    if is_series(values):
        values = unmasked(values)
    if isinstance(values, np.ndarray) and values.ndim > 0:
        if values.dtype.kind == "f" and values.ndim == 1:
            if not np.all(np.isfinite(values)):
                raise ValueError(f"{key}: numbers that are not finite cannot be in a scenario")
            return [repr(value) for value in values.astype(np.float64).tolist()]
        values = values.tolist()
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Sequence | range):
        raise TypeError(
            f"{key}: values cannot be of the type {type(values).__name__}; accepted: an array or a list"
        )
    return [_text(value) for value in values]


def _text(value: Any) -> str:
    if isinstance(value, str):
        try:
            json.loads(value)
        except ValueError:
            if not value.lstrip().startswith(("{", "[", '"')):
                return value
        return json.dumps(value)
    return text_of(value)
