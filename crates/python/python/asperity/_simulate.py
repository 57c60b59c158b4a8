"""One transient run."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _asperity
from ._result import Result
from ._table import Table
from ._warning import tell

ScenarioLike = _asperity.Scenario | str | os.PathLike[str] | dict[str, Any]


@dataclass(frozen=True, eq=False)
class MeshMotion(Result):
    """Motion of the mesh of a body at instants of a response.

    Attributes
    ----------
    time_s : ndarray
        Time of each instant.
    node : ndarray
        Number of each node, ascending.
    place_m : ndarray
        Places of the nodes, nodes by 3.
    displacement_m : ndarray
        Displacements of the nodes from rest, instants by nodes by 3.
    figure : Figure or None
        The mesh at up to six of the instants, as in ``motion-1.svg``; None without elements.
    """

    time_s: NDArray[np.float64]
    node: NDArray[np.int64]
    place_m: NDArray[np.float64]
    displacement_m: NDArray[np.float64]
    figure: _asperity.Figure | None = field(repr=False)


@dataclass(frozen=True, eq=False)
class Simulation(Result):
    """Response of a scenario to its force.

    Attributes
    ----------
    summary : dict
        Observables, as in ``summary.json``.
    history : Table
        Time history, as in ``history.csv``: ``time_s``, ``force_n``, ``displacement_m``,
        ``acceleration_m_per_s2`` (or ``SENSOR:displacement_m`` and the like for each sensor of
        the scenario), and for each interface ``NAME:pressure_pa``, ``NAME:closure_m``
        and ``NAME:stiffness_pa_per_m``; with contact damping or friction also ``NAME:traction_pa``.
    frf : Table or None
        Receptance of the first sensor, or with a moving base its transmissibility, as in ``frf.csv``: ``frequency_hz``, ``real_m_per_n``,
        ``imag_m_per_n``, ``magnitude_m_per_n``, ``phase_rad``; None without a force.
    cells : Table or None
        A row for each cell of the patches of a structure of matrices, as in ``cells.csv``: pressure at rest, gap,
        extremes of the pressure, time without contact; None for bars.
    cells_history : Table or None
        Cells of the patches over time, as in ``cells-history.csv``: ``time_s``, and ``INTERFACE:CELL:pressure_pa``,
        ``INTERFACE:CELL:closure_m`` and ``INTERFACE:CELL:stiffness_pa_per_m`` of the cells in the ``output`` of
        the scenario; None without such cells.
    motions : dict of MeshMotion
        Motion of the mesh of each body that has one at the instants in the ``output`` of the scenario, by the
        name of the body; empty for bars.
    history_figure : Figure
        The response over time, as in ``history.svg``.
    frf_figure : Figure or None
        The receptance, as in ``frf.svg``; None without a force.
    cells_history_figure : Figure or None
        Pressure and closure of the cells over time, as in ``cells-history.svg``; None without such cells.
    pressure_closure_figure : Figure or None
        Traction of each contact over its closure, with its law, as in ``pressure-closure.svg``; None without contacts.
    """

    summary: dict[str, Any] = field(repr=False)
    history: Table
    frf: Table | None
    cells: Table | None
    cells_history: Table | None
    motions: dict[str, MeshMotion]
    history_figure: _asperity.Figure = field(repr=False)
    frf_figure: _asperity.Figure | None = field(repr=False)
    cells_history_figure: _asperity.Figure | None = field(repr=False)
    pressure_closure_figure: _asperity.Figure | None = field(repr=False)

    def _repr_html_(self) -> str:
        figures = (self.frf_figure, self.history_figure)
        return "".join(figure.svg() for figure in figures if figure is not None)


def simulate(
    scenario: ScenarioLike, *, progress: Callable[[float], object] | None = None
) -> Simulation:
    """Simulate the response to the force of a scenario.

    Other Python threads run meanwhile, and Ctrl-C stops the call. What ``summary["warnings"]`` has is
    also a warning of Python, an `AsperityWarning`.

    Parameters
    ----------
    scenario : Scenario, str, os.PathLike or dict
        Anything that `Scenario` accepts.
    progress : callable, optional
        Called with the fraction done, 0 to 1, some times a second. An exception that it raises
        stops the computation and is passed on.

    Returns
    -------
    Simulation
        Observables, time history and receptance.

    Raises
    ------
    ScenarioError
        If the scenario is not valid.
    OSError
        If a file of the scenario cannot be read.
    ValueError
        If the structure cannot be built, or a setting is out of range.
    ComputationError
        If the integration fails.
    """
    found = _asperity.simulate(scenario, progress)
    summary, (history, history_figure), frf, cells, over_time, meshes, paths, doubts = found
    tell(doubts)
    receptance, frf_figure = (None, None) if frf is None else (Table(frf[0]), frf[1])
    of_cells = None if cells is None else Table(cells)
    recorded, recorded_figure = (None, None) if over_time is None else (Table(over_time[0]), over_time[1])
    motions = {body: MeshMotion(**arrays, figure=figure) for body, arrays, figure in meshes}
    return Simulation(
        summary,
        Table(history),
        receptance,
        of_cells,
        recorded,
        motions,
        history_figure,
        frf_figure,
        recorded_figure,
        paths,
    )
