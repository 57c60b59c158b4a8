"""Identification of contact laws from measurements."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from . import _arrays, _asperity
from ._analyse import _rate_of
from ._measurement import records_in_place
from ._result import Result
from ._table import Table
from ._warning import JudgementWarning, note


@dataclass(frozen=True, eq=False)
class Identification(Result):
    """An identified contact law with its uncertainty.

    Attributes
    ----------
    report : dict
        All results, as in ``identification.json``: ``estimates``, ``stiffnesses``, ``fit``,
        ``identifiability``, ``posterior``, ``comparison`` with other laws, ``design`` of further
        hits, ``words``.
    law : dict or None
        The law at the best fit, as ``law.json`` holds it: a value for ``laws`` of a scenario.
    scenario : dict
        The scenario at the best fit, as in ``scenario.json``.
    law_band : Table
        Stiffness over pressure with its credible band, as in ``law.csv``: ``pressure_pa``,
        ``stiffness_pa_per_m`` (best fit), ``median_pa_per_m``, ``lower_pa_per_m``,
        ``upper_pa_per_m``, ``informed`` (bool: the data narrow it), ``origin``, and more.
    data : Table
        Observations with their predictions, as in ``data.csv``: ``data``, ``feature``, ``at``,
        ``value``, ``standard_deviation``, ``predicted``, ``lower``, ``upper``, ``residual`` (in
        standard deviations), ``weight``.
    posterior : Table
        Draws from the posterior, as in ``posterior.csv``: ``weight``, and a column for each
        parameter.
    draws : dict
        The draws as changes of the scenario, as in ``draws.json``, for predictions by a study.
    figures : dict of Figure
        Those of the command: ``law``, ``features``, ``residuals``, ``profiles`` and more, those with
        something to draw.
    """

    report: dict[str, Any] = field(repr=False)
    law: dict[str, Any] | None
    scenario: dict[str, Any] = field(repr=False)
    law_band: Table
    data: Table
    posterior: Table
    draws: dict[str, Any] = field(repr=False)
    figures: dict[str, _asperity.Figure] = field(repr=False)

    def _repr_html_(self) -> str:
        return "".join(figure.svg() for figure in self.figures.values())

    @property
    def conclusions(self) -> list[str]:
        """The answer in sentences."""
        return list(self.report["words"])

    @property
    def estimates(self) -> list[dict[str, Any]]:
        """Estimates of the parameters: ``name``, ``value``, ``standard_deviation``, intervals."""
        return list(self.report["estimates"])

    @property
    def notices(self) -> list[str]:
        """Replaced or omitted data and settings, and warnings."""
        return list(self.report["notices"])


def identify(
    problem: str | os.PathLike[str] | dict[str, Any],
    *,
    folder: str | os.PathLike[str] | None = None,
    progress: Callable[[float], object] | None = None,
    fast: bool = False,
) -> Identification:
    """Identify a contact law, or any numbers of a scenario, from measurements.

    The same as ``asperity identify``, with the same numbers. Other Python threads run meanwhile, and
    Ctrl-C stops the call.

    Parameters
    ----------
    problem : str, os.PathLike or dict
        Path of a JSON file, JSON text (which starts with ``{``), or the problem as a dict. Results
        of an analysis enter without a file: hits as ``{"kind": "analysis", "file": found.report}``,
        and tables in place of those that other data name, such as
        ``{"kind": "backbone", "file": found.backbone, "spread": {"relative": 1e-3}}``. ``files`` of
        records may be anything that `analyse` accepts: arrays, data frames, SEP005 channels; the
        sample rate, names and units of arrays are those of ``rig``.
    folder : str or os.PathLike, optional
        Folder that relative file names in a text or a dict start from; the current one by default.
    progress : callable, optional
        Called with the estimated fraction done, 0 to 1. An exception that it raises stops the
        identification and is passed on.
    fast : bool, optional
        Leave out profiles, the comparison with other laws and the explanations of a misfit.

    Returns
    -------
    Identification
        The law with its band, the fit of the data, and draws from the posterior; ``report["judgement"]``
        states whether the law may be used (``yes``, ``with_care`` or ``no``), with the reasons; a law
        that may not be used without care is a `JudgementWarning` too, but for what `fast` left out.

    Raises
    ------
    ScenarioError
        If the problem or its scenario is not valid, with all faults.
    ValueError
        If the data do not fit the scenario.
    OSError
        If a file cannot be read.
    ComputationError
        If the scenario cannot be run at any start.

    Examples
    --------
    >>> found = asperity.identify("problem.json")                              # doctest: +SKIP
    >>> scenario.with_({"/laws/contact": found.law})                           # doctest: +SKIP
    """
    found = _asperity.identify(_document(problem), folder, progress, bool(fast))
    _tell(found["report"], fast)
    return _result(found)


def identify_in(
    scenario: _asperity.Scenario,
    problem: Mapping[str, Any],
    *,
    folder: str | os.PathLike[str] | None,
    progress: Callable[[float], object] | None,
    fast: bool,
) -> Identification:
    """`Scenario.identify`."""
    if not isinstance(problem, Mapping):
        kind = type(problem).__name__
        raise TypeError(f"a problem cannot be of the type {kind}; accepted: a mapping")
    if "scenario" in problem:
        raise ValueError("the problem has a scenario of its own; use asperity.identify, or leave it out")
    whole = {"schema": "asperity/identify/1", **problem, "scenario": scenario.to_dict()}
    start = scenario.folder if folder is None else folder
    found = _asperity.identify(_document(whole), start, progress, fast)
    _tell(found["report"], fast)
    return _result(found)


def _document(problem: Any) -> Any:
    """The problem, with records in memory as a document holds them."""
    if not isinstance(problem, dict) or not isinstance(problem.get("data"), list | tuple):
        return problem
    return {**problem, "data": [_data(one) for one in problem["data"]]}


def _data(data: Any) -> Any:
    if not isinstance(data, Mapping) or data.get("kind") != "records" or "files" not in data:
        return data
    files = data["files"]
    if isinstance(files, list) and all(isinstance(one, str | dict) for one in files):
        # A document already: paths, and records in place, but for one record of SEP005 channels.
        if not any(isinstance(one, dict) and "data" in one for one in files):
            return data
    return {**data, "files": records_in_place(files, _rate_of(data.get("rig")))}


def _tell(report: dict[str, Any], fast: bool) -> None:
    """Passes notices on to the caller of the function that calls this one, and warns it of a law that
    is not free to use; what was left out on request is no reason."""
    note(report["notices"], stacklevel=4)
    judgement = report["judgement"]
    reasons = [
        reason["words"]
        for reason in judgement["reasons"]
        if reason["use"] != "yes" and not (fast and reason["kind"] == "incomplete")
    ]
    if reasons:
        words = "is not to be used" if judgement["use"] == "no" else "may be used with care"
        warnings.warn(f"the result {words}: {' '.join(reasons)}", JudgementWarning, stacklevel=3)


def _result(found: dict[str, Any]) -> Identification:
    return Identification(
        report=found["report"],
        law=found["law"],
        scenario=found["scenario"],
        law_band=_arrays.table(found["law_band"]),
        data=_arrays.table(found["data"]),
        posterior=_arrays.table(found["posterior"]),
        draws=found["draws"],
        figures=found["figures"],
    )
