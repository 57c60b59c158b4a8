"""Studies of one scenario over a design of its inputs."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _asperity
from ._sweep import tell_of_runs
from ._table import Table
from ._warning import JudgementWarning


class Study(Table):
    """Table of the runs of a study, a row each, with their statistics.

    The columns are those of ``study.csv``: the inputs under their names, the observables (NaN where a
    response has none), ``error`` (the text of a run that failed, else empty) and ``warnings`` (kinds,
    separated by blanks).

    Attributes
    ----------
    answers : dict
        Statistics of each observable, as in ``answers.json``: mean, deviation, quantiles and exceedance
        probabilities with confidence intervals, Sobol indices of Saltelli's design.
    histograms, exceedance : Table
        As in ``histograms.csv`` and ``exceedance.csv``.
    frf : Table or None
        Bands of the receptance over frequency, as in ``frf.csv``; None unless the study asks for it.
    figures : dict of Figure
        ``distributions``, ``exceedance``, ``sobol-indices`` and ``frf``, those with something to draw.
    """

    __slots__ = ("answers", "exceedance", "figures", "frf", "histograms")

    def __init__(
        self,
        columns: Mapping[str, ArrayLike],
        answers: dict[str, Any],
        histograms: Table,
        exceedance: Table,
        frf: Table | None,
        figures: dict[str, _asperity.Figure],
    ) -> None:
        super().__init__(columns)
        self.answers = answers
        self.histograms = histograms
        self.exceedance = exceedance
        self.frf = frf
        self.figures = figures

    def __reduce__(self) -> tuple[Any, ...]:
        parts = (self.answers, self.histograms, self.exceedance, self.frf, self.figures)
        return type(self), (self.to_dict(), *parts)

    @property
    def failed(self) -> int:
        """Number of runs that failed."""
        return int(np.count_nonzero(self["error"]))

    @property
    def quantiles(self) -> Table:
        """Statistics of the observables, a row each: ``name``, ``unit``, ``runs_without``, ``mean``,
        ``standard_deviation``, and a column for each probability, such as ``0.05``; NaN for an
        observable that no run has."""
        found = self.answers["observables"]
        probabilities = dict.fromkeys(
            quantile["probability"] for one in found for quantile in one["quantiles"]
        )
        columns: dict[str, ArrayLike] = {
            name: np.array([one[name] for one in found], dtype=np.str_) for name in ("name", "unit")
        }
        columns["runs_without"] = np.array([one["runs_without"] for one in found], dtype=np.int64)
        for name in ("mean", "standard_deviation"):
            columns[name] = np.array([one[name] for one in found], dtype=np.float64)
        for at, probability in enumerate(probabilities):
            values = [one["quantiles"][at]["value"] if one["quantiles"] else None for one in found]
            columns[f"{probability:g}"] = np.array(values, dtype=np.float64)
        return Table(columns)

    @property
    def sobol_indices(self) -> Table:
        """Sobol indices, a row for each observable that varies and each input: ``name``, ``input``,
        ``first``, ``first_low``, ``first_high``, ``total``, ``total_low``, ``total_high``; without rows
        unless the design is Saltelli's."""
        found = [
            (one["name"], index)
            for one in self.answers["observables"]
            if one["sobol_indices"] is not None
            for index in one["sobol_indices"]["inputs"]
        ]
        columns: dict[str, ArrayLike] = {
            "name": np.array([name for name, _ in found], dtype=np.str_),
            "input": np.array([index["input"] for _, index in found], dtype=np.str_),
        }
        for order in ("first", "total"):
            columns[order] = np.array([index[order] for _, index in found], dtype=np.float64)
            for end, name in enumerate(("low", "high")):
                ends = [index[f"{order}_interval"][end] for _, index in found]
                columns[f"{order}_{name}"] = np.array(ends, dtype=np.float64)
        return Table(columns)

    def _repr_html_(self) -> str:
        drawn = "".join(figure.svg() for figure in self.figures.values())
        return drawn + super()._repr_html_()


def study(
    study: str | os.PathLike[str] | dict[str, Any],
    *,
    folder: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    level: float = 0.95,
    probabilities: Sequence[float] = (0.05, 0.25, 0.5, 0.75, 0.95),
    exceed: Mapping[str, float] | Sequence[tuple[str, float]] = (),
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> Study:
    """Run a scenario over a design of its inputs, and summarise the runs.

    The same as ``asperity study`` and ``asperity study answers``, with the same numbers. All rows are in
    memory at the end; studies that are too large for that, and shards on several machines, are for the
    command. Other Python threads run meanwhile, and Ctrl-C stops the call. A run that fails does not
    end the others: its error is in its row, and an `AsperityWarning` tells the number of such runs. For
    each kind of warning in the column ``warnings`` one warning of Python tells the number of its runs.

    Parameters
    ----------
    study : str, os.PathLike or dict
        Path of a study file, JSON text (which starts with ``{``), or the study as a dict;
        ``asperity schema --study`` prints what it may hold.
    folder : str or os.PathLike, optional
        Folder that relative file names in a text or a dict start from; the current one by default.
    out : str or os.PathLike, optional
        Folder that keeps the runs, as that of the command, which can go on with it. Without one
        nothing is kept on disk.
    resume : bool
        Continue the study that `out` holds: chunks that were complete are not computed again.
    level : float
        Confidence level of the intervals.
    probabilities : sequence of float
        Probabilities of the quantiles, in ascending order.
    exceed : mapping or sequence of (str, float)
        Also give the probability that an observable, by its column, exceeds a value.
    threads : int, optional
        Number of threads; all cores by default.
    progress : callable, optional
        Called with the fraction of the runs that are done, 0 to 1, after each chunk. An exception that
        it raises stops the study and is passed on.

    Returns
    -------
    Study
        A table of a row per run, with quantiles, exceedance probabilities and Sobol indices.

    Raises
    ------
    ScenarioError
        If the study or its scenario is not valid, with the places of the faults.
    FileExistsError
        If `out` holds other files or another study, or has begun and `resume` is not set.
    ValueError
        If a file of draws or rows, a probability or an observable of `exceed` cannot be used.
    OSError
        If a file cannot be read or written.

    Examples
    --------
    >>> found = asperity.study({"schema": "asperity/study/1", "scenario": "rig.json",
    ...     "inputs": [{"pointer": "/damping/ratio",
    ...                 "distribution": {"kind": "uniform", "lower": 0.01, "upper": 0.05}}],
    ...     "design": {"kind": "saltelli", "base_rows": 64}})               # doctest: +SKIP
    >>> found.quantiles["name"], found.sobol_indices["total"]               # doctest: +SKIP
    """
    options = _options(out, resume, level, probabilities, exceed, threads, progress)
    return _told(_asperity.study(study, folder, **options))


def study_of(
    scenario: _asperity.Scenario,
    study: Mapping[str, Any],
    *,
    folder: str | os.PathLike[str] | None,
    **options: Any,
) -> Study:
    """`Scenario.study`."""
    if not isinstance(study, Mapping):
        kind = type(study).__name__
        raise TypeError(f"a study cannot be of the type {kind}; accepted: a mapping")
    if "scenario" in study:
        raise ValueError("the study has a scenario of its own; use asperity.study, or leave it out")
    whole = {"schema": "asperity/study/1", **study, "scenario": scenario.to_dict()}
    start = scenario.folder if folder is None else folder
    return _told(_asperity.study(whole, start, **_options(**options)))


def _options(
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    level: float = 0.95,
    probabilities: Sequence[float] = (0.05, 0.25, 0.5, 0.75, 0.95),
    exceed: Mapping[str, float] | Sequence[tuple[str, float]] = (),
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> dict[str, Any]:
    """The options as the native part takes them."""
    if resume and out is None:
        raise ValueError("resume needs the folder of the study, `out`")
    pairs = exceed.items() if isinstance(exceed, Mapping) else exceed
    return {
        "out": out,
        "resume": bool(resume),
        "level": _arrays.number("level", level),
        "probabilities": _arrays.real("probabilities", probabilities).tolist(),
        "exceed": [(str(name), _arrays.number("a value of exceed", value)) for name, value in pairs],
        "threads": _arrays.threads(threads),
        "progress": progress,
    }


def _told(found: dict[str, Any]) -> Study:
    """The study, after warnings to the caller of the function that calls this one."""
    table = Study(
        _arrays.table(found["results"]),
        found["answers"],
        _arrays.table(found["histograms"]),
        _arrays.table(found["exceedance"]),
        None if found["frf"] is None else _arrays.table(found["frf"]),
        found["figures"],
    )
    if found["answers"]["warning"] is not None:
        warnings.warn(found["answers"]["warning"], JudgementWarning, stacklevel=3)
    tell_of_runs(table, stacklevel=4)
    return table
