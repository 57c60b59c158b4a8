"""Contact laws: of a scenario, from functions, fitted."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _asperity
from ._asperity import Law
from ._numbers import column
from ._simulate import ScenarioLike
from ._table import Table

# Points of a law from functions: at first, and at most.
_FIRST_POINTS = 65
_MOST_POINTS = 20_000
# Share of the highest pressure at which the points begin to crowd above zero pressure.
_NEAR_ZERO = 1e-6
# Largest relative difference between a step of the closure and the integral of dp/K over it.
_CONSISTENT = 1e-3


class LawTables(Mapping[str, Table]):
    """Tables of the laws of a scenario by name, with a figure of all.

    Each has the columns of ``law-NAME.csv``: ``pressure_pa``, ``stiffness_pa_per_m``, ``closure_m``,
    ``energy_j_per_m2``. A name that is not in the scenario is a KeyError.

    Attributes
    ----------
    figure : Figure or None
        The figure of the command; None for a scenario without named laws.
    """

    __slots__ = ("_tables", "figure")

    def __init__(self, tables: Mapping[str, Table], figure: _asperity.Figure | None) -> None:
        self._tables = dict(tables)
        self.figure = figure

    def __getitem__(self, name: str) -> Table:
        try:
            return self._tables[name]
        except KeyError:
            known = ", ".join(self._tables)
            raise KeyError(f"no law {name!r}; the scenario has {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    def _ipython_key_completions_(self) -> list[str]:
        """The names of the laws, for notebooks."""
        return list(self)

    def __repr__(self) -> str:
        return f"<asperity.LawTables: {', '.join(self._tables)}>"

    def _repr_html_(self) -> str:
        return "" if self.figure is None else self.figure.svg()


def laws(scenario: ScenarioLike) -> dict[str, Law]:
    """The named laws of a scenario.

    The closure of a law that never separates counts from the static pressure of the first interface
    that uses it.

    Parameters
    ----------
    scenario : Scenario, str, os.PathLike or dict
        Anything that `Scenario` accepts.

    Returns
    -------
    dict of str to Law
        The laws by their names in the scenario.

    Raises
    ------
    ScenarioError
        If the scenario is not valid.
    ValueError
        If a law cannot be built.
    """
    return _asperity.laws(scenario)


def tabulate(scenario: ScenarioLike) -> LawTables:
    """Tabulate every named law of a scenario, from zero pressure to at least 1 MPa.

    Parameters
    ----------
    scenario : Scenario, str, os.PathLike or dict
        Anything that `Scenario` accepts.

    Returns
    -------
    LawTables
        A table for each law, by its name.

    Raises
    ------
    ScenarioError
        If the scenario is not valid.
    ValueError
        If a law cannot be built.
    """
    tables, figure = _asperity.tabulate(scenario)
    return LawTables({name: Table(columns) for name, columns in tables.items()}, figure)


@dataclass(frozen=True)
class PowerFit:
    """Power law K = C p^m fitted to points, in logarithms.

    Attributes
    ----------
    coefficient : float
        C in Pa^(1-m)/m.
    exponent : float
        m.
    residual_log_rms : float
        Scatter of ln K about the law.
    standard_error_log_coefficient, standard_error_exponent : float or None
        Standard errors of ln C and m; None for two points.
    """

    coefficient: float
    exponent: float
    residual_log_rms: float
    standard_error_log_coefficient: float | None
    standard_error_exponent: float | None

    @property
    def law(self) -> Law:
        """The law; ValueError for exponents from 1 on, whose law never separates."""
        return Law(
            {"kind": "power", "coefficient": self.coefficient, "exponent": self.exponent}
        )


def fit_power(pressure_pa: ArrayLike, stiffness_pa_per_m: ArrayLike) -> PowerFit:
    """Fit ln K = ln C + m ln p by least squares.

    Parameters
    ----------
    pressure_pa, stiffness_pa_per_m : array of shape (points,)
        Positive pressures in Pa and stiffnesses in Pa/m; two points at least.

    Raises
    ------
    TypeError
        If they are not real numbers.
    ValueError
        If the lengths differ, a number is not positive and finite, or the pressures do not differ.
    """
    pressure = column(pressure_pa, "pressure_pa")
    stiffness = column(stiffness_pa_per_m, "stiffness_pa_per_m")
    if len(pressure) != len(stiffness):
        raise ValueError(
            f"pressure_pa has {len(pressure)} points, stiffness_pa_per_m {len(stiffness)}; "
            "expected equal lengths"
        )
    coefficient, exponent, scatter, errors = _asperity.fit_power(pressure, stiffness)
    of_coefficient, of_exponent = (None, None) if errors is None else errors
    return PowerFit(coefficient, exponent, scatter, of_coefficient, of_exponent)


def law_from_stiffness(
    stiffness: Callable[[float], float],
    pressures_pa: tuple[float, float],
    *,
    tolerance: float = 1e-6,
) -> Law:
    """Law from a function K(p), as a table that follows it.

    The function is called with single pressures, at points that are added until the table differs
    from it by at most `tolerance` between any two of them; outside the range the stiffness is
    constant, and contact is lost at zero pressure. A scenario with the law can be saved, and run by
    the command.

    Parameters
    ----------
    stiffness : callable
        Stiffness in Pa/m, positive and finite, of a pressure in Pa.
    pressures_pa : (float, float)
        Lowest and highest pressure in Pa; the lowest may be zero.
    tolerance : float
        Largest relative difference of the stiffness, 1e-12 to 0.1.

    Raises
    ------
    TypeError
        If the range does not hold two numbers, or the function returns no number.
    ValueError
        If a stiffness is not positive and finite, or jumps; if the range or the tolerance is not
        valid.
    Exception
        Any exception of the function.

    Examples
    --------
    >>> law = law_from_stiffness(lambda p: 1e11 + 1e6 * p, (0, 1e7))
    >>> law.kind
    'table'
    """
    low, high = _range(pressures_pa, "pressures_pa")
    _check_tolerance(tolerance)

    def sample(pressure: float) -> tuple[float, float]:
        return pressure, _called(stiffness, pressure, "stiffness", "pressure", "Pa")

    start = max(low, _NEAR_ZERO * high)
    grid = np.geomspace(start, high, _FIRST_POINTS).tolist()
    grid[0], grid[-1] = start, high
    return _followed(sample, grid if low == start else [low, *grid], tolerance)[0]


def law_from_pressure(
    pressure: Callable[[float], float],
    stiffness: Callable[[float], float],
    closures_m: tuple[float, float],
    *,
    tolerance: float = 1e-6,
) -> Law:
    """Law from two functions of the closure, p(d) and its derivative, as a table that follows them.

    As `law_from_stiffness`, for laws that are given as pressures. The closures of the law count from
    zero pressure, those of the functions from anywhere.

    Parameters
    ----------
    pressure : callable
        Pressure in Pa, not negative and increasing, of a closure in m.
    stiffness : callable
        Its derivative dp/dd in Pa/m, positive, of a closure in m.
    closures_m : (float, float)
        Lowest and highest closure in m.
    tolerance : float
        Largest relative difference of the stiffness, 1e-12 to 0.1.

    Raises
    ------
    TypeError
        If the range does not hold two numbers, or a function returns no number.
    ValueError
        If the pressure does not increase, a number is not finite, or the stiffness is not the
        derivative of the pressure; if the range or the tolerance is not valid.
    Exception
        Any exception of the functions.

    Examples
    --------
    >>> law = law_from_pressure(lambda d: 1e5 * d + 1e12 * d**2, lambda d: 1e5 + 2e12 * d, (0, 1e-3))
    >>> round(law.pressure(1e-3))
    1000100
    """
    low, high = _range(closures_m, "closures_m", negative=True)
    _check_tolerance(tolerance)

    def sample(closure: float) -> tuple[float, float]:
        at = _called(pressure, closure, "pressure", "closure", "m", zero=True)
        return at, _called(stiffness, closure, "stiffness", "closure", "m")

    grid = np.linspace(low, high, _FIRST_POINTS).tolist()
    law, closures, pressures = _followed(sample, grid, tolerance)
    steps = np.diff(closures)
    found = np.diff(law.closure(pressures))
    wrong = np.abs(found - steps) > _CONSISTENT * steps
    if np.any(wrong):
        at = int(np.flatnonzero(wrong)[0])
        raise ValueError(
            f"the stiffness is not the derivative of the pressure: from closure {closures[at]:g} m "
            f"to {closures[at + 1]:g} m the pressure rises by {pressures[at + 1] - pressures[at]:g} Pa, "
            f"which takes a closure of {found[at]:g} m by the stiffness"
        )
    return law


def _followed(
    sample: Callable[[float], tuple[float, float]], grid: list[float], tolerance: float
) -> tuple[Law, NDArray[np.float64], NDArray[np.float64]]:
    """Table law through samples, with points added where it differs from them; the arguments and
    pressures of its points."""
    points = {x: sample(x) for x in grid}
    known = dict(points)
    settled: set[float] = set()
    while True:
        places = sorted(points)
        pairs = [points[x] for x in places]
        for x, before, after in zip(places[1:], pairs, pairs[1:], strict=False):
            if after[0] <= before[0]:
                raise ValueError(
                    f"the pressure does not increase: {after[0]:g} Pa at {x:g}, "
                    f"after {before[0]:g} Pa"
                )
        law = Law({"kind": "table", "points": [list(pair) for pair in pairs]})
        parts = [part for part in zip(places, places[1:], strict=False) if part[0] not in settled]
        # Errors of the slopes at both ends cancel in the middle of a part, not in its quarters.
        inner = [x for part in parts for x in _quarters(*part)]
        for x in inner:
            if x not in known:
                known[x] = sample(x)
        pressures = np.array([known[x][0] for x in inner])
        exact = np.array([known[x][1] for x in inner])
        errors = np.abs(law.stiffness(pressures) - exact) / exact
        error = np.max(errors.reshape(-1, 3), axis=1, initial=0.0)
        off = error > tolerance
        if not np.any(off):
            return law, np.array(places), np.array([pair[0] for pair in pairs])
        # A jump is still there in the narrowest part.
        narrow = [b - a <= 1e-2 * tolerance * max(abs(a), abs(b)) for a, b in parts]
        if np.any(off & narrow) or len(points) + int(np.sum(off)) > _MOST_POINTS:
            worst = int(np.argmax(errors))
            raise ValueError(
                f"the stiffness changes too fast near {pressures[worst]:g} Pa: a table of "
                f"{len(points)} points differs from it by {errors[worst]:.1g}; accepted: continuous "
                f"functions, or a larger tolerance than {tolerance:g}"
            )
        # A part that is far better than needed is left alone.
        settled |= {a for (a, _), e in zip(parts, error, strict=True) if e <= 1e-3 * tolerance}
        for x in np.array(inner).reshape(-1, 3)[off, 1].tolist():
            points[x] = known[x]


def _quarters(a: float, b: float) -> tuple[float, float, float]:
    """Places that divide a part, by their ratios between positive numbers."""
    middle = _middle(a, b)
    return _middle(a, middle), middle, _middle(middle, b)


def _middle(a: float, b: float) -> float:
    return math.sqrt(a) * math.sqrt(b) if a > 0.0 else 0.5 * (a + b)


def _range(pair: tuple[float, float], name: str, *, negative: bool = False) -> tuple[float, float]:
    try:
        low, high = (float(value) for value in pair)
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {pair!r}; expected two numbers, the lowest and the highest") from None
    if not (math.isfinite(low) and math.isfinite(high) and low < high and (negative or low >= 0.0)):
        bound = "" if negative else ", the lowest not negative"
        raise ValueError(f"{name} is {pair!r}; expected two increasing finite numbers{bound}")
    return low, high


def _check_tolerance(tolerance: float) -> None:
    if not 1e-12 <= tolerance <= 0.1:
        raise ValueError(f"tolerance is {tolerance}; accepted: 1e-12 to 0.1")


def _called(
    function: Callable[[float], float], at: float, name: str, argument: str, unit: str, *, zero: bool = False
) -> float:
    value = function(at)
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(
            f"the {name} is {value!r} at a {argument} of {at:g} {unit}; expected a number"
        ) from None
    if not math.isfinite(number) or number < 0.0 or (number == 0.0 and not zero):
        accepted = "zero or more" if zero else "positive"
        raise ValueError(
            f"the {name} is {number:g} at a {argument} of {at:g} {unit}; it must be finite and {accepted}"
        )
    return number
