"""Steady responses to a shaker, backbones, and linearised modes."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _asperity
from ._numbers import column, numbers
from ._result import Result
from ._simulate import ScenarioLike
from ._table import Table
from ._warning import AsperityWarning, tell


@dataclass(frozen=True, eq=False)
class SteadyResponses(Result):
    """Branches of periodic responses to a harmonic force or motion of the base.

    Attributes
    ----------
    summary : dict
        Peaks, special points and ends of the branches, as in ``summary.json``.
    points : Table
        A row per point of every branch, as in ``steady.csv``: ``branch``, ``point``, ``force_n`` or
        ``base_acceleration_m_per_s2``, ``frequency_hz``, ``amplitude_K_m``, ``phase_1_rad``, the extremes of the pressure at each
        interface, ``stable`` (1, 0, NaN where it is not known) and ``contact_lost``.
    backbones : Table or None
        Phase resonance and damped mode, as in ``backbone.csv``; None unless asked for.
    time_sweeps : Table or None
        Stepped sines by time integration, as in ``steady_time.csv``; None unless asked for.
    cells : Table or None
        The cells of the patches of a structure of matrices in the highest response of each branch, as in
        ``cells.csv``; None for bars.
    figure : Figure or None
        The figure of the command; None without a branch.
    """

    summary: dict[str, Any] = field(repr=False)
    points: Table
    backbones: Table | None
    time_sweeps: Table | None
    cells: Table | None
    figure: _asperity.Figure | None = field(repr=False)

    @property
    def _load(self) -> str:
        """Name of the amplitudes of the load."""
        return "force_n" if "force_n" in self.points else "base_acceleration_m_per_s2"

    @property
    def peaks(self) -> Table:
        """Largest response of each branch, a row per amplitude.

        ``force_n`` or ``base_acceleration_m_per_s2``, ``peak_frequency_hz``, ``peak_amplitude_1_m``,
        ``displacement_ratio``, ``peak_truncation`` (NaN where there is none), ``peak_is_inside`` (true if it is a peak of a branch
        that covers the whole range), ``contact_lost``, and ``error`` (text, empty for a branch that was found). With
        ``peak_truncation`` above 2e-3 the harmonics do not suffice.
        """
        levels = self.summary["levels"]
        peak = ("peak_frequency_hz", "peak_amplitude_1_m", "displacement_ratio", "peak_truncation")
        numeric = (self._load, *peak)
        columns: dict[str, ArrayLike] = {
            name: np.array([_number(level.get(name)) for level in levels]) for name in numeric
        }
        for name in ("peak_is_inside", "contact_lost"):
            columns[name] = np.array([bool(level.get(name, False)) for level in levels])
        columns["error"] = np.array([level.get("error", "") for level in levels], dtype=np.str_)
        return Table(columns)

    @property
    def _parts(self) -> list[dict[str, Any]]:
        """The branches as ``points`` numbers them: of all forces, then the other parts."""
        return [*self.summary["levels"], *self.summary["other_parts"]]

    @property
    def special_points(self) -> Table:
        """Bifurcations along the branches: ``branch``, ``force_n`` or ``base_acceleration_m_per_s2``,
        ``kind``, ``frequency_hz``, ``amplitude_1_m``; kinds are ``fold``, ``period_doubling``,
        ``neimark_sacker`` and ``branch_point``."""
        found = [
            (number, level[self._load], point)
            for number, level in enumerate(self._parts, start=1)
            for point in level.get("bifurcations", ())
        ]
        return Table(
            {
                "branch": np.array([number for number, _, _ in found], dtype=np.int64),
                self._load: np.array([force for _, force, _ in found], dtype=np.float64),
                "kind": np.array([point["kind"] for _, _, point in found], dtype=np.str_),
                **{
                    name: np.array([point[name] for _, _, point in found], dtype=np.float64)
                    for name in ("frequency_hz", "amplitude_1_m")
                },
            }
        )

    @property
    def motions(self) -> Table:
        """Motions by time integration from rest, at frequencies at which the branch has no stable response.

        ``branch``, ``force_n`` or ``base_acceleration_m_per_s2``, ``frequency_hz``, ``motion`` (``periodic``,
        ``subharmonic``, ``non_periodic``, ``apart`` or ``not_settled``), ``periods`` (its period in periods of the force),
        ``amplitude_1_m``, ``scatter`` of the fundamental from period to period, and ``lost_share``, the largest share of the
        time without contact; NaN where there is none.
        """
        found = [
            (number, level[self._load], motion)
            for number, level in enumerate(self.summary["levels"], start=1)
            for motion in level.get("motions", ())
        ]
        numeric = ("frequency_hz", "periods", "amplitude_1_m", "scatter", "lost_share")
        return Table(
            {
                "branch": np.array([number for number, _, _ in found], dtype=np.int64),
                self._load: np.array([force for _, force, _ in found], dtype=np.float64),
                "motion": np.array([motion["motion"] for _, _, motion in found], dtype=np.str_),
                **{
                    name: np.array(
                        [_number(motion[name]) for _, _, motion in found], dtype=np.float64
                    )
                    for name in numeric
                },
            }
        )

    def _repr_html_(self) -> str:
        drawn = "" if self.figure is None else self.figure.svg()
        return drawn + self.peaks._repr_html_()


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def steady(
    scenario: ScenarioLike,
    amplitudes_n: ArrayLike,
    from_hz: float,
    to_hz: float,
    *,
    harmonics: int | None = None,
    backbone: bool = False,
    verify: bool = False,
    bodies: Literal["auto", "elastic", "condensed"] = "auto",
    time_sweep: Literal["up", "down", "both"] | None = None,
    time_sweep_points: int = 201,
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> SteadyResponses:
    """Follow branches of steady responses to a harmonic force or motion of the base.

    Of the excitation of the scenario its place counts (the top by default), or that it is a motion of
    the base; its time function has no part in them. An amplitude whose branch is not found does
    not end the others: its error is in the summary, and an `AsperityWarning` tells of it;
    warnings about the responses, in the summary too, are an `AsperityWarning` or `AccuracyWarning`.

    Parameters
    ----------
    scenario : Scenario, str, os.PathLike or dict
        Anything that `Scenario` accepts.
    amplitudes_n : float or array of shape (branches,)
        Force amplitudes in N; with a motion of the base amplitudes of its acceleration in m/s^2.
    from_hz, to_hz : float
        Frequencies in Hz at which each branch starts and ends; either may be the lower.
    harmonics : int, optional
        Number of harmonics; chosen by their truncation, up to 30, by default.
    backbone : bool
        Also follow the phase resonance and the damped nonlinear mode.
    verify : bool
        Also integrate one response of each branch in time, and state the difference.
    bodies : {"auto", "elastic", "condensed"}
        Light bodies between contacts: condensed where contact is lost, never, or always.
    time_sweep : {"up", "down", "both"}, optional
        Also integrate a stepped sine of `time_sweep_points` frequencies in time.
    threads : int, optional
        Number of threads; all cores by default.
    progress : callable, optional
        Called with the fraction of the branches that are done, 0 to 1. An exception that it raises
        stops the computation and is passed on.

    Returns
    -------
    SteadyResponses
        Branches, backbones and stepped sines as tables.

    Raises
    ------
    ScenarioError
        If the scenario is not valid.
    TypeError
        If the amplitudes or frequencies are not real numbers.
    ValueError
        If the request is out of range.
    ComputationError
        If there is no static equilibrium.
    """
    asked = {
        "amplitudes_n": column(np.atleast_1d(numbers(amplitudes_n, "amplitudes_n")), "amplitudes_n"),
        "from_hz": _arrays.number("from_hz", from_hz),
        "to_hz": _arrays.number("to_hz", to_hz),
        "harmonics": None if harmonics is None else _arrays.count("harmonics", harmonics, 1, 400),
        "backbone": bool(backbone),
        "verify": bool(verify),
        "bodies": bodies,
        "time_sweep": time_sweep,
        "time_sweep_points": time_sweep_points,
    }
    summary, points, backbones, sweeps, cells, figure, doubts = _asperity.steady(
        scenario, asked, _arrays.threads(threads), progress
    )
    failed = [level for level in summary["levels"] if "error" in level]
    if failed:
        text = f"{len(failed)} of {len(summary['levels'])} amplitudes have no branch; "
        force, base = failed[0].get("force_n"), failed[0].get("base_acceleration_m_per_s2")
        text += f"{base} m/s^2" if force is None else f"{force} N"
        text += f": {failed[0]['error']}"
        warnings.warn(text, AsperityWarning, stacklevel=2)
    tell(doubts)
    return SteadyResponses(
        summary,
        Table(points),
        None if backbones is None else Table(backbones),
        None if sweeps is None else Table(sweeps),
        None if cells is None else Table(cells),
        figure,
    )


@dataclass(frozen=True, eq=False)
class Modes(Result):
    """Modes linearised about static equilibrium.

    Attributes
    ----------
    summary : dict
        State at rest, frequencies and damping ratios, as in ``modes.json``.
    shapes : Table
        Displacement along the stack, as in ``modes.csv``: ``position_m`` from the top, and a column
        ``mode_N:FREQUENCY_hz`` for each mode; empty for a structure of matrices, whose participations
        are in the summary.
    figure : Figure or None
        The shapes; None for a structure of matrices.
    """

    summary: dict[str, Any] = field(repr=False)
    shapes: Table
    figure: _asperity.Figure | None = field(repr=False)

    @property
    def table(self) -> Table:
        """Natural frequencies ``frequency_hz`` and ``damping_ratio``, a row per mode."""
        modes = self.summary["modes"]
        return Table(
            {
                name: np.array([mode[name] for mode in modes], dtype=np.float64)
                for name in ("frequency_hz", "damping_ratio")
            }
        )

    def _repr_html_(self) -> str:
        drawn = "" if self.figure is None else self.figure.svg()
        return drawn + self.table._repr_html_()


def modes(scenario: ScenarioLike, count: int = 4) -> Modes:
    """Compute natural frequencies, damping ratios and mode shapes about static equilibrium.

    Parameters
    ----------
    scenario : Scenario, str, os.PathLike or dict
        Anything that `Scenario` accepts.
    count : int
        Number of modes, 1 to 1000; a structure may have fewer.

    Returns
    -------
    Modes
        Frequencies in Hz, damping ratios and shapes.

    Raises
    ------
    ScenarioError
        If the scenario is not valid.
    ValueError
        If the count is out of range.
    ComputationError
        If there is no static equilibrium.
    """
    number = _arrays.count("count", count, 1, 1000)
    summary, shapes, figure = _asperity.modes(scenario, number)
    return Modes(summary, Table(shapes), figure)
