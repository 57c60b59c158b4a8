"""Analyses of measured hits and of free decays."""

from __future__ import annotations

import json
import os
import pathlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _asperity
from ._measurement import sources, texts
from ._result import Result
from ._table import Table
from ._warning import note

Rig = str | os.PathLike[str] | dict[str, Any]


@dataclass(frozen=True, eq=False)
class ResponseAnalysis(Result):
    """Results of an analysis for one response.

    Attributes
    ----------
    name : str
        Name of the channel.
    report : dict
        All results, as in ``analysis.json``: ``settings``, ``hits`` with their ``verdicts``,
        ``average``, ``levels``, ``second_peak``, ``conclusions``, ``notices``, ``provenance``.
    hits : Table
        A row for each hit, as in ``hits.csv``: ``force_peak_n``, ``impulse_ns``, ``frequency_hz``,
        ``magnitude_m_per_n``, damping ratios by three methods, their standard deviations due to
        noise, ``harmonic_ratio``, the flags ``double_hit``, ``overload``, ``dropout`` and
        ``averaged`` (bool), and ``verdicts``, the quality issues in words. NaN where there is none.
    frf : Table
        Average over the hits, as in ``frf.csv``: ``frequency_hz``, ``real``, ``imag``,
        ``magnitude`` (in m/N, m/(N s) or m/(N s^2), by the form), ``phase_rad``, ``coherence`` (NaN
        for one hit), ``valid`` (bool: the force spectrum has at least 2 % of its maximum).
    backbone : Table
        Frequency and damping over amplitude along the decay of each hit, as in ``backbone.csv``:
        ``index`` of the hit, ``force_peak_n``, ``time_s``, ``amplitude_m``, ``frequency_hz``,
        ``decay_rate_per_s``, ``damping_ratio``.
    figures : dict of Figure
        ``records``, ``frf``, ``features`` and ``backbone``, those with something to draw.
    """

    name: str
    report: dict[str, Any] = field(repr=False)
    hits: Table
    frf: Table
    backbone: Table
    figures: dict[str, _asperity.Figure] = field(repr=False)

    def _repr_html_(self) -> str:
        return "".join(figure.svg() for figure in self.figures.values())


@dataclass(frozen=True, eq=False)
class Analysis(Result):
    """Results of an analysis of hits; those without a response's name are of the first response.

    Attributes
    ----------
    responses : tuple of ResponseAnalysis
        One for each response, in the order asked for.
    modes : Table
        Modes in the band, a row for each mode and response, as in ``modes.csv``.
    frfs : dict of ndarray, each of shape (lines,)
        ``frequency_hz`` and complex functions from the first line above zero: ``average H1`` (or H2,
        Hv) and, with ``frfs=True``, ``hit 1`` and so on, as the channels of ``frfs.npz``. With
        several responses the names begin with that of the response.
    """

    responses: tuple[ResponseAnalysis, ...]
    modes: Table
    frfs: dict[str, NDArray[Any]] = field(repr=False)

    @property
    def report(self) -> dict[str, Any]:
        """All results of the first response, as in ``analysis.json``."""
        return self.responses[0].report

    @property
    def hits(self) -> Table:
        """A row for each hit of the first response, as in `ResponseAnalysis`."""
        return self.responses[0].hits

    @property
    def frf(self) -> Table:
        """Average over the hits of the first response, as in `ResponseAnalysis`."""
        return self.responses[0].frf

    @property
    def backbone(self) -> Table:
        """Frequency and damping over amplitude of the first response, as in `ResponseAnalysis`."""
        return self.responses[0].backbone

    @property
    def figures(self) -> dict[str, _asperity.Figure]:
        """Figures of the first response."""
        return self.responses[0].figures

    def _repr_html_(self) -> str:
        return "".join(response._repr_html_() for response in self.responses)

    @property
    def conclusions(self) -> list[str]:
        """Results over all hits, in words."""
        return list(self.report["conclusions"])

    @property
    def notices(self) -> list[str]:
        """Assumptions and omissions."""
        return list(self.report["notices"])


def _settings(
    rig: Rig | None,
    changes: dict[str, Any],
    sample_rate_hz: float | None,
    names: Sequence[str],
    units: Sequence[str],
    sample_axis: str | None,
    sensitivity: str | Sequence[str],
) -> dict[str, Any]:
    """Settings as the native part takes them."""
    if sample_axis not in (None, "first", "last"):
        raise ValueError(f'sample_axis is {sample_axis!r}; accepted: "first", "last"')
    if not (rig is None or isinstance(rig, str | os.PathLike | dict)):
        raise TypeError(f"a rig cannot be of the type {type(rig).__name__}; accepted: a path or a dict")
    return {
        "rig": rig,
        "changes": {key: value for key, value in changes.items() if value is not None},
        "sample_rate_hz": (
            None if sample_rate_hz is None else _arrays.number("sample_rate_hz", sample_rate_hz)
        ),
        "names": texts("names", names),
        "units": texts("units", units),
        "sample_axis": sample_axis,
        "sensitivity": texts("sensitivity", sensitivity),
    }


def _rate_of(rig: Rig | None) -> float | None:
    """The sample rate that the settings of a rig give to arrays; their faults are found later."""
    if rig is not None and not isinstance(rig, dict):
        try:
            rig = json.loads(pathlib.Path(rig).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
    rate = rig.get("sample_rate_hz") if isinstance(rig, dict) else None
    return rate if isinstance(rate, int | float) and not isinstance(rate, bool) else None


def _band(band_hz: tuple[float, float]) -> list[float]:
    if isinstance(band_hz, str | bytes) or not hasattr(band_hz, "__iter__"):
        raise TypeError(f"band_hz is {band_hz!r}; accepted: two frequencies in Hz")
    return [_arrays.number("band_hz", frequency) for frequency in band_hz]


def _selector(name: str, channel: str | int) -> str:
    if isinstance(channel, str):
        return channel
    return f"#{_arrays.count(name, channel)}"


def _selectors(
    response: str | int | Sequence[str | int] | None,
) -> list[str] | None:
    if response is None:
        return None
    if isinstance(response, str | int | np.integer):
        return [_selector("response", int(response) if not isinstance(response, str) else response)]
    return [_selector("response", channel) for channel in response]


def analyse(
    source: Any,
    *,
    rig: Rig | None = None,
    sample_rate_hz: float | None = None,
    names: Sequence[str] = (),
    units: Sequence[str] = (),
    sample_axis: str | None = None,
    sensitivity: str | Sequence[str] = (),
    force: str | int | None = None,
    response: str | int | Sequence[str | int] | None = None,
    flip_force: bool | None = None,
    hits: int | str = "auto",
    level_n: float | None = None,
    length_s: float | None = None,
    pre_trigger_s: float | None = None,
    hold_off_s: float | None = None,
    estimator: str | None = None,
    window: str | None = None,
    band_hz: tuple[float, float] | None = None,
    high_pass_hz: float | None = None,
    invalid_cells: str | None = None,
    reject: Sequence[int] = (),
    form: str = "receptance",
    keep_all: bool | None = None,
    frfs: bool = False,
    progress: Callable[[float], object] | None = None,
) -> Analysis:
    """Analyse the hits of one hammer test.

    The same as ``asperity analyse``, with the same numbers. Other Python threads run meanwhile, and
    Ctrl-C stops the call. Assumptions and omissions are a `NoticeWarning`.

    Parameters
    ----------
    source : path, array, SEP005 channels, or several of them
        - Paths of files, folders, and patterns such as ``"hits/*.npy"``; or
        - arrays: of shape (channels, samples) or (samples, channels), or one-dimensional ones that
          were sampled together, with `sample_rate_hz` and `units`; a list of such for several
          records, or an array of shape (records, channels, samples); masked samples are missing
          ones, whose hits are dropouts; or
        - data frames of pandas or polars, or a `Table`: channels have the names of the columns, and
          the units of names that end with one (``force_n``); times are a column ``time_s``; or
        - SEP005 channels: dicts with ``data``, ``name``, ``unit_str``, and ``fs`` or ``time``; a
          list of lists for several records.
    rig : path or dict, optional
        Settings of the rig, as ``asperity schema --rig`` describes them. Other arguments win.
    sample_rate_hz : float, optional
        Sample rate in Hz of arrays, and of files without one; that of the rig by default.
    names, units : sequence of str, optional
        Of the channels in their order, such as ``["hammer", "top"]`` and ``["N", "m/s^2"]``; an
        empty one keeps that of the file.
    sample_axis : {"first", "last"}, optional
        Axis of an array along which the samples run; by default the longer one.
    sensitivity : str or sequence of str, optional
        Sensors of channels in volts, such as ``"hammer=2.25mV/N"``.
    force : str or int, optional
        Channel of the force: its name, its number from 1, or its quantity. By default the only one.
    response : str, int or sequence, optional
        Channels of the responses, or ``"all"``. By default the only one.
    flip_force : bool, optional
        True for a force that is negative when the hammer pushes.
    hits : int or "auto"
        Number of hits: the strongest, or all above the widest gap.
    level_n, length_s : float, optional
        Trigger level in N; longest hit in s.
    pre_trigger_s, hold_off_s : float, optional
        Time kept before the trigger, 5 ms by default; time after a trigger in which a second impact
        makes a double hit, 0.2 s by default.
    estimator : {"h1", "h2", "hv"}, optional
        Estimator of the averaged function.
    window : str, optional
        ``"auto"``, ``"none"``, ``"force"``, ``"exponential"`` or ``"force+exponential"``, the
        latter two also with ``":"`` and a time constant in s. Features are corrected for the
        damping that the exponential window adds.
    band_hz : (float, float), optional
        Band of the fundamental in Hz. By default about the strongest resonance of the first hit.
    high_pass_hz : float, optional
        Corner in Hz of a high-pass of second order for the responses, which takes out drifts. The mean
        before each blow is always taken out.
    invalid_cells : {"refuse", "dropout", "overload"}, optional
        Cells of texts that are no number: an error that names the row, the default, or missing or
        infinite samples, whose hits are left out of averages.
    reject : sequence of int
        Numbers of hits, from 1, to leave out of averages.
    form : {"receptance", "mobility", "accelerance"}
        Form of the functions.
    keep_all : bool, optional
        Also average double hits, overloads and dropouts.
    frfs : bool
        Keep the function of each averaged hit.
    progress : callable, optional
        Called with the fraction done, 0 to 1. An exception that it raises stops the analysis and is
        passed on.

    Returns
    -------
    Analysis
        Hits, averaged functions, backbones and modes as tables.

    Raises
    ------
    TypeError
        If `source` is none of the above, or an array does not hold real numbers.
    ScenarioError
        If a setting of the rig is not valid, with all faults.
    ValueError
        If a file, an option or a channel is not valid.
    OSError
        If a file cannot be read.
    ComputationError
        If there is no hit, or none that can be averaged.

    Examples
    --------
    >>> found = asperity.analyse("hits/*.uff", band_hz=(600, 1000))            # doctest: +SKIP
    >>> found.hits["force_peak_n"], found.hits["frequency_hz"]                 # doctest: +SKIP
    >>> asperity.analyse([force, acceleration], sample_rate_hz=25600,
    ...                  units=["N", "m/s^2"])                                 # doctest: +SKIP
    """
    changes = {
        "force": None if force is None else _selector("force", force),
        "responses": _selectors(response),
        "flip_force": flip_force,
        "level_n": level_n,
        "length_s": length_s,
        "pre_trigger_s": pre_trigger_s,
        "hold_off_s": hold_off_s,
        "estimator": estimator,
        "window": window,
        "band_hz": None if band_hz is None else _band(band_hz),
        "high_pass_hz": high_pass_hz,
        "invalid_cells": invalid_cells,
        "keep_all": keep_all,
    }
    settings = _settings(rig, changes, sample_rate_hz, names, units, sample_axis, sensitivity)
    rate = _rate_of(rig) if sample_rate_hz is None else sample_rate_hz
    read = sources(source, rate, sample_axis)
    number = hits if isinstance(hits, str) else str(_arrays.count("hits", hits))
    rejected = [_arrays.count("reject", hit) for hit in reject]
    found = _asperity.analyse(read, settings, number, rejected, form, bool(frfs), progress)
    responses = tuple(
        ResponseAnalysis(
            name=one["name"],
            report=one["report"],
            hits=_arrays.table(one["hits"]),
            frf=_arrays.table(one["frf"]),
            backbone=_arrays.table(one["backbone"]),
            figures=one["figures"],
        )
        for one in found["responses"]
    )
    note(notice for one in responses for notice in one.report["notices"])
    return Analysis(responses, _arrays.table(found["modes"]), found["frfs"])


@dataclass(frozen=True, eq=False)
class DecayAnalysis(Result):
    """Results of an analysis of free decays.

    Attributes
    ----------
    report : dict
        All results, as in ``decay.json``.
    decays : Table
        A row for each decay, band and response, as in ``decays.csv``.
    backbone : Table
        Frequency, damping and harmonics over amplitude, as in ``backbone.csv``: ``index`` of the
        curve, ``decay``, ``response``, ``unit``, ``time_s``, ``amplitude`` (in the unit),
        ``amplitude_m`` (NaN for an unknown unit), ``frequency_hz``, ``damping_ratio``, and standard
        deviations due to noise.
    figures : dict of Figure
        The decays and their backbones, as the command draws them.
    """

    report: dict[str, Any] = field(repr=False)
    decays: Table
    backbone: Table
    figures: dict[str, _asperity.Figure] = field(repr=False)

    def _repr_html_(self) -> str:
        return "".join(figure.svg() for figure in self.figures.values())

    @property
    def conclusions(self) -> list[str]:
        """Results over all decays, in words."""
        return list(self.report["conclusions"])

    @property
    def notices(self) -> list[str]:
        """Assumptions and omissions."""
        return list(self.report["notices"])


def decay(
    source: Any,
    *,
    rig: Rig | None = None,
    sample_rate_hz: float | None = None,
    names: Sequence[str] = (),
    units: Sequence[str] = (),
    sample_axis: str | None = None,
    sensitivity: str | Sequence[str] = (),
    response: str | int | Sequence[str | int] | None = None,
    bands_hz: Sequence[tuple[float, float]] = (),
    progress: Callable[[float], object] | None = None,
) -> DecayAnalysis:
    """Analyse free decays, without their force.

    The same as ``asperity decay``, with the same numbers. Assumptions and omissions are a
    `NoticeWarning`.

    Parameters
    ----------
    source, rig, sample_rate_hz, names, units, sample_axis, sensitivity, progress
        As for `analyse`.
    response : str, int or sequence, optional
        Channels of the responses, of any quantity. By default all accelerations, velocities and
        displacements.
    bands_hz : sequence of (float, float), optional
        Bands in Hz with one mode each. By default one about the strongest resonance of the first
        decay.

    Returns
    -------
    DecayAnalysis
        Decays and their backbones as tables.

    Raises
    ------
    TypeError, ScenarioError, ValueError, OSError
        As for `analyse`.
    ComputationError
        If there is no free decay.

    Examples
    --------
    >>> found = asperity.decay("blow.csv", bands_hz=[(70, 90)])                # doctest: +SKIP
    >>> found.backbone["amplitude_m"], found.backbone["frequency_hz"]          # doctest: +SKIP
    """
    changes = {"responses": _selectors(response)}
    settings = _settings(rig, changes, sample_rate_hz, names, units, sample_axis, sensitivity)
    rate = _rate_of(rig) if sample_rate_hz is None else sample_rate_hz
    read = sources(source, rate, sample_axis)
    bands = [
        [_arrays.number("a limit of bands_hz", limit) for limit in (low, high)]
        for low, high in bands_hz
    ]
    report, decays, backbone, figures = _asperity.decay(read, settings, bands, progress)
    note(report["notices"])
    return DecayAnalysis(report, _arrays.table(decays), _arrays.table(backbone), figures)
