"""Figures of results on axes of matplotlib.

Each function draws one panel in the style of the figures of the command, takes any axes as ``ax`` and
returns the axes; without ``ax`` it makes a figure in `STYLE`. Further keywords go to the line that is
drawn. The package matplotlib comes with ``pip install asperity[plot]``.

>>> ax = asperity.plot.frf(run)                               # doctest: +SKIP
>>> asperity.plot.frf(stronger, ax, color="C1", label="20 N") # doctest: +SKIP
>>> ax.legend()                                               # doctest: +SKIP
"""

# The types of matplotlib differ by its version: its objects are used as Any.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import functools
import importlib
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from . import _asperity
from ._analyse import Analysis, DecayAnalysis, ResponseAnalysis
from ._identify import Identification
from ._law import LawTables, laws, tabulate
from ._simulate import Simulation
from ._steady import SteadyResponses
from ._study import Study
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes  # type: ignore[import-not-found,unused-ignore]

__all__ = ["STYLE", "backbone", "features", "frf", "history", "law"]

_Floats = NDArray[np.float64]
_Draw = TypeVar("_Draw", bound=Callable[..., Any])

#: Style of the figures, as parameters of matplotlib: ``matplotlib.rcParams.update(plot.STYLE)``.
STYLE: dict[str, Any] = {
    "axes.labelsize": 8,
    "axes.formatter.use_mathtext": True,
    "axes.linewidth": 0.6,
    "axes.titlesize": 8,
    "figure.figsize": (4.7, 2.7),
    "figure.constrained_layout.use": True,
    "font.size": 7,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "xtick.direction": "in",
    "xtick.minor.visible": True,
    "xtick.top": True,
    "ytick.direction": "in",
    "ytick.minor.visible": True,
    "ytick.right": True,
}

_GREY = "#7a7a7a"

#: Shaded ranges.
_SHADE: dict[str, Any] = {"color": "#d9d9d9", "alpha": 0.5, "linewidth": 0, "zorder": 0}

#: Parameters of `STYLE` that axes of the caller get too.
_OF_LINES = ("lines.linewidth", "lines.markersize")


def _drawn(draw: _Draw) -> _Draw:
    """The function in the style of the figures, of lines alone on axes of the caller."""

    @functools.wraps(draw)
    def styled(found: Any, ax: Axes | None = None, **options: Any) -> Axes:
        style = STYLE if ax is None else {name: STYLE[name] for name in _OF_LINES}
        with _matplotlib("matplotlib").rc_context(style):
            return draw(found, ax, **options)

    return cast(_Draw, styled)


#: Label, unit and factor of the columns that end with a name.
_COLUMNS = {
    "force_n": ("Force", "N", 1.0),
    "base_acceleration_m_per_s2": ("Base acceleration", "m/s²", 1.0),
    "displacement_m": ("Displacement", "µm", 1e6),
    "velocity_m_per_s": ("Velocity", "m/s", 1.0),
    "acceleration_m_per_s2": ("Acceleration", "m/s²", 1.0),
    "pressure_pa": ("Contact pressure", "MPa", 1e-6),
    "closure_m": ("Closure", "µm", 1e6),
    "stiffness_pa_per_m": ("Contact stiffness", "Pa/m", 1.0),
}

#: Columns of hits with a feature, and of its standard deviations.
_OF_HITS = {
    "fundamental.frequency_hz": ("frequency_hz", "frequency_uncertainty_hz"),
    "fundamental.receptance_m_per_n": ("magnitude_m_per_n", "magnitude_uncertainty_m_per_n"),
    "fundamental.damping_ratio": ("damping_ratio", "damping_ratio_uncertainty"),
    "harmonic_ratio": ("harmonic_ratio", "harmonic_ratio_uncertainty"),
}

#: Units of frequency response functions by the ends of their columns.
_FRF_UNITS = {"m_per_n": "m/N", "s2": "s²"}

#: Symbols of special points: kind, name and marker.
_SPECIAL = (
    ("fold", "fold", "o"),
    ("period_doubling", "period doubling", "s"),
    ("neimark_sacker", "Neimark-Sacker", "D"),
    ("branch_point", "branch point", "^"),
)


@_drawn
def frf(
    found: Simulation | Analysis | ResponseAnalysis | Study | Table,
    ax: Axes | None = None,
    *,
    part: Literal["magnitude", "phase", "coherence"] = "magnitude",
    scale: Literal["log", "linear", "db"] = "log",
    **line: Any,
) -> Axes:
    """Draw a frequency response function over frequency in Hz.

    Of a simulation the natural frequency at rest and the peaks are marked, of an analysis the mean
    fundamental, with its band shaded; frequencies without force are left out. Of a study the median is
    drawn with its bands of 50 % and 95 %.

    Parameters
    ----------
    found : Simulation, Analysis, ResponseAnalysis, Study or Table
        The result, or a table such as its ``frf``.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; new ones by default.
    part : {"magnitude", "phase", "coherence"}
        The part that is drawn; phases in degrees.
    scale : {"log", "linear", "db"}
        Axis of magnitudes; decibels relative to one unit.
    **line
        Properties of the line.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    TypeError
        If `found` is something else.
    ValueError
        If it has no such function or part.
    ImportError
        If matplotlib is not installed.
    """
    _choice("part", part, ("magnitude", "phase", "coherence"))
    _choice("scale", scale, ("log", "linear", "db"))
    if isinstance(found, Study):
        if found.frf is None or part != "magnitude":
            raise ValueError("a study has magnitudes only, and those if it asks for `frf`")
        return _frf_of_study(found.frf, _axes(ax), scale, line)
    table, name, marks, top = _function_of(found)
    columns = [one for one in table if re.fullmatch(rf"(relative_)?{part}(_rad|_m_per_n|_s2)?", one)]
    if "frequency_hz" not in table or not columns:
        raise ValueError(f"no {part} over frequency; the table has {', '.join(table)}")
    frequency, values = table["frequency_hz"], table[columns[0]]
    kept = frequency > 0
    if "valid" in table:
        values = np.where(table["valid"], values, np.nan)
    if np.isfinite(top):
        kept &= frequency <= top
    frequency, values = frequency[kept], values[kept]
    axes = _axes(ax)
    line = {"color": _colors()[1], **line}
    if part == "magnitude":
        unit = _frf_unit(found, columns[0])
        if unit == "s²":
            name = "Relative displacement per base acceleration"
        axes.plot(frequency, _scaled(values, scale), **line)
        _magnitudes(axes, name, unit, scale, values)
    elif part == "phase":
        degrees = np.degrees(values)
        jumps = np.flatnonzero(np.abs(np.diff(degrees)) > 180) + 1
        at, degrees = np.insert(frequency, jumps, np.nan), np.insert(degrees, jumps, np.nan)
        axes.plot(at, degrees, **line)
        axes.set(ylabel="Phase (°)", ylim=(-180, 180), yticks=range(-180, 181, 90))
    else:
        axes.plot(frequency, values, **line)
        axes.set(ylabel="Coherence", ylim=(0, 1.02))
    axes.set_xlabel("Frequency (Hz)")
    if ax is None:
        axes.set_xlim(0, float(frequency[-1]))
        _mark(axes, marks, named=part == "magnitude")
        if isinstance(found, Analysis | ResponseAnalysis):
            axes.axvspan(*found.report["settings"]["band_hz"], **_SHADE)
    return axes


@_drawn
def history(
    found: Simulation | Table,
    ax: Axes | None = None,
    *,
    column: str = "displacement_m",
    **line: Any,
) -> Axes:
    """Draw a time history of a simulation over time in ms, until the motion has decayed.

    Parameters
    ----------
    found : Simulation or Table
        The result, or a table such as its ``history``.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; new ones by default.
    column : str
        A column, such as ``force_n`` or ``guide-sample:pressure_pa``, or the end of several, such as
        ``pressure_pa`` for all interfaces. Lengths are drawn in µm, pressures in MPa.
    **line
        Properties of the lines.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    KeyError
        If there is no such column.
    TypeError
        If `found` is something else.
    ImportError
        If matplotlib is not installed.
    """
    table = found.history if isinstance(found, Simulation) else found
    if not isinstance(table, Table):
        raise _no("a history", found, "Simulation, Table")
    names = [name for name in table if name == column or name.endswith(f":{column}")]
    if not names or "time_s" not in table:
        raise KeyError(f"no column {column!r} over time_s; the table has {', '.join(table)}")
    key = column.rpartition(":")[2]
    label, unit, factor = _COLUMNS.get(key, (key, "", 1.0))
    time = 1e3 * table["time_s"]
    axes = _axes(ax)
    colors = _colors()
    for index, name in enumerate(names):
        sensor = name.rpartition(":")[0]
        style: dict[str, Any] = {
            "color": colors[index % len(colors)],
            "linestyle": "-" if index == 0 else "--",
            "label": sensor if len(names) > 1 else None,
        }
        axes.plot(time, factor * table[name], **{**style, **line})
    if len(names) == 1 and names[0] != key:
        label = f"{label}, {names[0].rpartition(':')[0]}"
    axes.set(xlabel="Time (ms)", ylabel=_titled(label, unit))
    moves = [name for name in table if name.rpartition(":")[2] in _MOTIONS]
    ends = [_asperity.decay_length(np.ascontiguousarray(table[name])) for name in moves]
    if ax is None and time.size:
        axes.set_xlim(time[0], time[max(1, min(max(ends, default=time.size), time.size)) - 1])
    if len(names) > 1:
        axes.legend()
    return axes


#: Motions of sensors in a history.
_MOTIONS = ("displacement_m", "velocity_m_per_s", "acceleration_m_per_s2")


@_drawn
def law(
    found: Any,
    ax: Axes | None = None,
    *,
    pressure_pa: tuple[float, float] | None = None,
    relative: bool = False,
    **line: Any,
) -> Axes:
    """Draw the contact stiffness in Pa/m over the pressure in MPa.

    Of an identification the best fit is drawn with its credible band and the band of 50 %, with the
    measured stiffnesses if there are some; pressures that the data do not inform are shaded.

    Parameters
    ----------
    found : Identification, Law, mapping of laws, LawTables, or scenario
        An identified law, one law, laws by their names such as those of `laws`, or anything that
        `Scenario` accepts.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; new ones by default.
    pressure_pa : (float, float), optional
        Range of pressures of a `Law`; by default that of its measurement, else 0 to 1 MPa.
    relative : bool
        Draw an identified law as its deviation from the median in %, which shows a narrow band.
    **line
        Properties of the lines.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    TypeError, ScenarioError
        If `found` is something else.
    ImportError
        If matplotlib is not installed.
    """
    if isinstance(found, Identification):
        return _law_with_band(found, _axes(ax), ax is None, relative, line)
    else:
        curves = _curves(found, pressure_pa)
        axes = _axes(ax)
        colors, dashes = _colors(), ("-", "--", "-.")
        for index, (name, pressure, stiffness) in enumerate(curves):
            style = {"color": colors[index % len(colors)], "linestyle": dashes[index % 3], "label": name}
            axes.plot(1e-6 * pressure, stiffness, **{**style, **line})
        if any(name for name, _, _ in curves):
            axes.legend()
        if ax is None:
            axes.set_xlim(1e-6 * min(p[0] for _, p, _ in curves), 1e-6 * max(p[-1] for _, p, _ in curves))
            axes.set_ylim(bottom=0)
    axes.set(xlabel="Contact pressure (MPa)", ylabel="Contact stiffness (Pa/m)")
    return axes


@_drawn
def backbone(
    found: SteadyResponses | Analysis | ResponseAnalysis | DecayAnalysis,
    ax: Axes | None = None,
    *,
    quantity: Literal["frequency", "damping"] = "frequency",
    **line: Any,
) -> Axes:
    """Draw steady responses with their backbones, or the backbones of measured decays.

    Of steady responses this is the amplitude in µm over frequency in Hz: a branch for each force, stable
    parts solid and unstable ones dashed, bifurcations as symbols, the phase resonance and the damped mode
    if they were asked for, and stepped sines as points. Of decays it is the frequency in Hz, or the damping
    ratio in %, over the amplitude in m, a line for each decay in the colour of its force.

    Parameters
    ----------
    found : SteadyResponses, Analysis, ResponseAnalysis or DecayAnalysis
        The result.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; new ones by default.
    quantity : {"frequency", "damping"}
        What is drawn of decays.
    **line
        Properties of the lines.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    TypeError
        If `found` is something else.
    ValueError
        If there is no branch or decay.
    ImportError
        If matplotlib is not installed.
    """
    _choice("quantity", quantity, ("frequency", "damping"))
    if isinstance(found, SteadyResponses):
        return _branches(found, ax, line)
    if isinstance(found, Analysis | ResponseAnalysis | DecayAnalysis):
        return _decays(found.backbone, ax, quantity, line)
    raise _no("backbones", found, "SteadyResponses, Analysis, ResponseAnalysis, DecayAnalysis")


@_drawn
def features(
    found: Analysis | ResponseAnalysis | Identification | Table,
    ax: Axes | None = None,
    *,
    feature: str = "fundamental.frequency_hz",
    force: str = "/excitation/peak_n",
    **line: Any,
) -> Axes:
    """Draw a feature of hits over their peak force in N.

    Of an analysis these are the averaged hits with two standard deviations to either side where they are
    known; of an identification the measured ones with the best fit and its band; of a sweep or study its
    runs, joined by a line for each combination of the other varied values.

    Parameters
    ----------
    found : Analysis, ResponseAnalysis, Identification, Sweep, Study or Table
        The result.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; new ones by default.
    feature : str
        The feature, by the column of a sweep: ``fundamental.frequency_hz``,
        ``fundamental.receptance_m_per_n``, ``fundamental.damping_ratio``, ``harmonic_ratio``, and others
        that a sweep has.
    force : str
        Column of the peak force of a sweep or study.
    **line
        Properties of the points, or of the lines of a sweep.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    KeyError
        If there is no such feature or force.
    TypeError
        If `found` is something else.
    ImportError
        If matplotlib is not installed.
    """
    factor = 100.0 if feature.endswith("damping_ratio") else 1.0
    if isinstance(found, Analysis | ResponseAnalysis):
        axes = _hits(found.hits, ax, feature, factor, line)
    elif isinstance(found, Identification):
        axes = _fitted(found.data, ax, feature, factor, line)
    elif isinstance(found, Table):
        axes = _runs(found, ax, (force, feature), factor, line)
    else:
        raise _no("features", found, "Analysis, ResponseAnalysis, Identification, Sweep, Study, Table")
    label, unit = _asperity.feature_name(feature)
    axes.set(xlabel="Peak force (N)", ylabel=_titled(label, "%" if factor == 100.0 else unit))
    return axes


def _matplotlib(module: str) -> Any:
    """A module of matplotlib, whose types differ by its version."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        text = "asperity.plot needs the package matplotlib: pip install asperity[plot]"
        raise ImportError(text) from error


def _axes(ax: Axes | None) -> Any:
    """The axes, or new ones."""
    return _matplotlib("matplotlib.pyplot").subplots()[1] if ax is None else ax


def _colors() -> list[str]:
    """Colours of lines of different kinds: black, blue, red, green and more."""
    return _asperity.palette(0)[0]


def _titled(label: str, unit: str) -> str:
    """The title of an axis; subscripts such as ``f_{1}`` are set."""
    label = label.replace("_{", "$_{").replace("}", "}$")
    return f"{label} ({unit})" if unit else label


def _choice(name: str, value: str, accepted: Sequence[str]) -> None:
    if value not in accepted:
        raise ValueError(f"{name} is {value!r}; accepted: {', '.join(map(repr, accepted))}")


def _no(what: str, found: object, accepted: str) -> TypeError:
    return TypeError(f"{what} cannot be drawn of the type {type(found).__name__}; accepted: {accepted}")


def _function_of(found: Any) -> tuple[Table, str, dict[str, float | None], float]:
    """Table, label, marked frequencies and highest frequency drawn of a function."""
    if isinstance(found, Simulation):
        if found.frf is None:
            raise ValueError("the simulation has no frequency response function: it has no force")
        peaks = {name: found.summary.get(key) for name, key in _PEAKS.items()}
        marks = {name: peak and peak["frequency_hz"] for name, peak in peaks.items()}
        at_rest = found.summary["static"].get("natural_frequency_hz")
        return found.frf, "Receptance", {"at rest": at_rest, **marks}, np.inf
    if isinstance(found, Analysis | ResponseAnalysis):
        first = found.report["average"].get("frequency_hz")
        first = first["mean"] if first else None
        form = found.report["settings"]["frf_form"]
        top = np.inf if first is None else 4 * first
        return found.frf, f"Mean {form}", {"f$_{1}$": first}, top
    if isinstance(found, Table):
        return found, "Receptance", {}, np.inf
    raise _no("a frequency response function", found, "Simulation, Analysis, ResponseAnalysis, Study, Table")


_PEAKS = {"f$_{1}$": "fundamental", "f$_{2}$": "second_harmonic"}


def _frf_unit(found: Any, column: str) -> str:
    if isinstance(found, Analysis | ResponseAnalysis):
        form = found.report["settings"]["frf_form"]
        return {"receptance": "m/N", "mobility": "m/(N s)", "accelerance": "m/(N s²)"}.get(form, "")
    return _FRF_UNITS.get(column.partition("magnitude_")[2], "")


def _scaled(values: Any, scale: str) -> Any:
    if scale != "db":
        return values
    with np.errstate(divide="ignore"):
        return 20 * np.log10(values)


def _magnitudes(axes: Any, label: str, unit: str, scale: str, values: Any) -> None:
    """The axis of magnitudes, over at most six decades."""
    shown = values[np.isfinite(values) & (values > 0)]
    axes.set_ylabel(f"{label} (dB re 1 {unit})" if scale == "db" else _titled(label, unit))
    if scale == "log":
        axes.set_yscale("log")
    if shown.size and scale != "linear" and not axes.lines[1:]:
        low = max(float(shown.min()) / 1.3, float(shown.max()) / 1e6)
        axes.set_ylim(_scaled(low, scale), _scaled(3.5 * float(shown.max()), scale))


def _mark(axes: Any, marks: Mapping[str, float | None], named: bool) -> None:
    """Dashed lines at frequencies, with their names at the top: of the first to its left."""
    known = sorted((at, name) for name, at in marks.items() if at is not None)
    for index, (at, name) in enumerate(known):
        axes.axvline(at, color=_GREY, linestyle="--", linewidth=0.7)
        if not named:
            continue
        near = index + 1 < len(known) and index == 0
        axes.annotate(
            name,
            (at, 1),
            xycoords=("data", "axes fraction"),
            xytext=(-3 if near else 3, -4),
            textcoords="offset points",
            ha="right" if near else "left",
            va="top",
            color="#4d4d4d",
        )


def _frf_of_study(table: Table, axes: Any, scale: str, line: dict[str, Any]) -> Any:
    x, blue = table["frequency_hz"], _colors()[1]
    for ends, name, alpha in ((("lower", "upper"), "95 %", 0.22), (("lower_50", "upper_50"), "50 %", 0.4)):
        low, high = (_scaled(table[f"{end}_m_per_n"], scale) for end in ends)
        axes.fill_between(x, low, high, color=blue, alpha=alpha, linewidth=0, label=name)
    median = table["median_m_per_n"]
    style = {"color": blue, "linewidth": 0.8, "label": "median"}
    axes.plot(x, _scaled(median, scale), **{**style, **line})
    if scale == "log":
        axes.set_yscale("log")
    axes.set(xlabel="Frequency (Hz)", xlim=(x[0], x[-1]))
    axes.set_ylabel("Receptance (dB re 1 m/N)" if scale == "db" else "Receptance (m/N)")
    axes.legend()
    return axes


def _curves(
    found: Any, pressure_pa: tuple[float, float] | None
) -> list[tuple[str | None, _Floats, _Floats]]:
    """Name, pressures and stiffnesses of laws."""
    if isinstance(found, Mapping) and found and all(isinstance(one, _asperity.Law) for one in found.values()):
        return [_curve(name, one, pressure_pa) for name, one in found.items()]
    if isinstance(found, _asperity.Law):
        return [_curve(None, found, pressure_pa)]
    if isinstance(found, Table):
        return [(None, found["pressure_pa"], found["stiffness_pa_per_m"])]
    if pressure_pa is not None and not isinstance(found, LawTables):
        return [_curve(name, one, pressure_pa) for name, one in laws(found).items()]
    tables = found if isinstance(found, LawTables) else tabulate(found)
    return [(name, one["pressure_pa"], one["stiffness_pa_per_m"]) for name, one in tables.items()]


def _curve(
    name: str | None, one: _asperity.Law, pressure_pa: tuple[float, float] | None
) -> tuple[str | None, _Floats, _Floats]:
    low, high = pressure_pa or one.measured_range_pa or (0.0, 1e6)
    pressure = np.linspace(low, high, 401)
    return name, pressure, one.stiffness(pressure)


def _law_with_band(
    found: Identification, axes: Any, own: bool, relative: bool, line: dict[str, Any]
) -> Any:
    table, blue = found.law_band, _colors()[1]
    pressure, median = table["pressure_pa"], table["median_pa_per_m"]

    def shown(stiffness: Any, at: Any = pressure) -> Any:
        if not relative:
            return stiffness
        # A law may start at zero.
        with np.errstate(divide="ignore", invalid="ignore"):
            return 100 * (stiffness / np.interp(at, pressure, median) - 1)

    ends = [table[f"{end}_pa_per_m"] for end in ("lower", "upper", "lower_50", "upper_50")]
    best, (low, high, first, third) = table["stiffness_pa_per_m"], ends
    void = found.report["judgement"]["use"] == "no"
    name = f"{100 * found.report['level']:.0f} % band" + (", void: not to be used" if void else "")
    across = 1e-6 * pressure
    if void:
        axes.vlines(across, shown(low), shown(high), color=blue, linewidth=0.5, label=name)
    else:
        band: dict[str, Any] = {"color": blue, "linewidth": 0}
        axes.fill_between(across, shown(low), shown(high), alpha=0.22, label=name, **band)
        axes.fill_between(across, shown(first), shown(third), alpha=0.35, label="50 % band", **band)
    axes.plot(across, shown(best), **{"color": blue, "linewidth": 1.2, "label": "best fit", **line})
    of_law = np.char.startswith(found.data["feature"].astype(np.str_), "stiffness of ")
    if of_law.any():
        at, value, deviation = (found.data[name][of_law] for name in ("at", "value", "standard_deviation"))
        errors = np.abs(shown(value + deviation, at) - shown(value, at))
        points = (1e-6 * at, shown(value, at), errors)
        _points(axes, points, "black", "measured, ±2 standard deviations")
    axes.set_xlabel("Contact pressure (MPa)")
    if relative:
        axes.set_ylabel("Deviation from the median (%)")
    else:
        axes.set(ylabel="Contact stiffness (Pa/m)", yscale="log")
    if own:
        axes.set_xlim(0, across[-1])
        usable = np.concatenate([best, np.maximum(low, best / 6), np.minimum(high, 6 * best)])
        usable = usable[np.isfinite(usable) & (usable > 0)]
        if usable.size and not relative:
            axes.set_ylim(0.9 * usable.min(), 1.1 * usable.max())
        for start, end in _runs_of(~table["informed"]):
            left = 0.0 if start == 0 else across[start - 1]
            right = across[-1] if end == across.size else across[end]
            axes.axvspan(left, right, **_SHADE)
    axes.legend()
    return axes


def _runs_of(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Start and end of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist()))


def _branches(found: SteadyResponses, ax: Axes | None, line: dict[str, Any]) -> Any:
    points = found.points
    if points.rows == 0:
        raise ValueError("there is no branch of steady responses")
    axes = _axes(ax)
    (drive,) = (name for name in ("force_n", "base_acceleration_m_per_s2") if name in points)
    unit = "N" if drive == "force_n" else "m/s²"
    numbers = np.unique(points["branch"])
    forces = [float(points[drive][points["branch"] == number][0]) for number in numbers]
    # All parts of the branch of a force have its colour, and the first its name.
    colors = dict(zip(dict.fromkeys(forces), _asperity.palette(len(set(forces)))[1]))
    for place, (number, force) in enumerate(zip(numbers, forces)):
        of, color = points["branch"] == number, colors[force]
        frequency, amplitude = points["frequency_hz"][of], 1e6 * points["amplitude_1_m"][of]
        unstable = points["stable"][of] == 0
        label = None if force in forces[:place] else f"{force:g} {unit}"
        # Parts of equal stability; each ends with the first point of the next.
        edges = [0, *(np.flatnonzero(np.diff(unstable)) + 1).tolist(), unstable.size]
        for start, end in zip(edges, edges[1:]):
            style = {"color": color, "linestyle": "--" if unstable[start] else "-", "label": label}
            part = slice(start, end + 1)
            axes.plot(frequency[part], amplitude[part], **{**style, **line})
            label = None
            line.pop("label", None)
    special = found.special_points
    for kind, name, marker in _SPECIAL:
        of = special["kind"] == kind
        if of.any():
            at = (special["frequency_hz"][of], 1e6 * special["amplitude_1_m"][of])
            axes.plot(*at, marker, color="black", markerfacecolor="white", markersize=4, label=name)
    lost = points["contact_lost"].astype(bool)
    changes = np.diff(lost) & (np.diff(points["branch"]) == 0)
    ends = np.unique(np.flatnonzero(changes) + lost[1:][changes])
    if ends.size:
        at = (points["frequency_hz"][ends], 1e6 * points["amplitude_1_m"][ends])
        axes.plot(*at, "x", color="black", markersize=4, label="contact lost")
    levels = {level for level, one in enumerate(found._parts, 1) if one.get("end") != "reached"}
    last = np.flatnonzero(np.append(np.diff(points["branch"]) != 0, True))
    last = last[[int(number) in levels for number in points["branch"][last]]]
    if last.size:
        at = (points["frequency_hz"][last], 1e6 * points["amplitude_1_m"][last])
        axes.plot(*at, "s", color="black", markersize=4, label="end of the branch")
    if found.backbones is not None:
        for kind, name, dash in _BACKBONES:
            of = found.backbones["backbone"] == kind
            if of.any():
                at = (found.backbones["frequency_hz"][of], 1e6 * found.backbones["amplitude_1_m"][of])
                axes.plot(*at, color="black", linestyle=dash, label=name)
    if found.time_sweeps is not None:
        _stepped(found.time_sweeps, axes, colors)
    axes.set(xlabel="Frequency (Hz)", ylabel="Amplitude u$_{1}$ (µm)")
    if ax is None:
        low, high = points["frequency_hz"].min(), points["frequency_hz"].max()
        axes.set(xlim=(float(low), float(high)))
        axes.set_ylim(bottom=0)
    axes.legend()
    return axes


#: Curves of backbones: kind, name and line.
_BACKBONES = (
    ("phase_resonance", "phase resonance", "-."),
    ("mode", "damped mode", ":"),
)


def _stepped(sweeps: Table, axes: Any, colors: Mapping[float, str]) -> None:
    """Stepped sines as small symbols in the colours of their forces, rising and falling."""
    (drive,) = (name for name in ("force_n", "base_acceleration_m_per_s2") if name in sweeps)
    for direction, marker in (("up", "^"), ("down", "v")):
        label: str | None = f"time integration, {direction}"
        for force in np.unique(sweeps[drive]).tolist():
            of = (sweeps["direction"] == direction) & (sweeps[drive] == force)
            if of.any():
                at = (sweeps["frequency_hz"][of], 1e6 * sweeps["amplitude_1_m"][of])
                style = {"color": colors.get(force, "black"), "markerfacecolor": "none", "markersize": 2.5}
                axes.plot(*at, marker, markeredgewidth=0.6, label=label, **style)
                label = None


def _decays(table: Table, ax: Axes | None, quantity: str, line: dict[str, Any]) -> Any:
    amplitude = table["amplitude_m"] if "amplitude_m" in table else table["amplitude"]
    if not table.rows or not np.isfinite(amplitude).any():
        raise ValueError("there is no decay with an amplitude in m")
    axes = _axes(ax)
    numbers = np.unique(table["index"])
    forces = table["force_peak_n"] if "force_peak_n" in table else None
    order = numbers if forces is None else sorted(numbers, key=lambda n: forces[table["index"] == n][0])
    for number, color in zip(order, _asperity.palette(len(numbers))[1]):
        of = table["index"] == number
        column = "frequency_hz" if quantity == "frequency" else "damping_ratio"
        y = table[column][of] * (1 if quantity == "frequency" else 100)
        label = None if forces is None else f"{forces[of][0]:.3g} N"
        axes.plot(amplitude[of], y, **{"color": color, "linewidth": 0.8, "label": label, **line})
    axes.set_xscale("log")
    axes.set(xlabel="Amplitude (m)")
    axes.set_ylabel("Frequency (Hz)" if quantity == "frequency" else "Damping ratio (%)")
    if forces is not None and len(numbers) <= 8:
        axes.legend()
    return axes


def _points(
    axes: Any, points: tuple[Any, Any, Any], color: str, label: str | None, **line: Any
) -> None:
    """Points with two standard deviations to either side."""
    x, y, deviation = points
    known = np.where(np.isfinite(deviation), 2 * deviation, 0.0)
    style = {"color": color, "fmt": "o", "elinewidth": 0.7, "capsize": 2, "label": label, "markersize": 3.5}
    axes.errorbar(x, y, known, **{**style, **line})


def _hits(
    table: Table, ax: Axes | None, feature: str, factor: float, line: dict[str, Any]
) -> Any:
    if feature not in _OF_HITS:
        raise KeyError(f"no feature {feature!r} of hits; accepted: {', '.join(_OF_HITS)}")
    value, deviation = _OF_HITS[feature]
    of = table["averaged"].astype(bool) & np.isfinite(table[value])
    axes = _axes(ax)
    points = (table["force_peak_n"][of], factor * table[value][of], factor * table[deviation][of])
    _points(axes, points, _colors()[1], None, **line)
    return axes


def _fitted(
    data: Table, ax: Axes | None, feature: str, factor: float, line: dict[str, Any]
) -> Any:
    of = (data["feature"] == feature) & np.isfinite(data["at"])
    if not of.any():
        known = ", ".join(dict.fromkeys(data["feature"].tolist()))
        raise KeyError(f"no feature {feature!r} of hits; the data have {known}")
    axes = _axes(ax)
    order = np.flatnonzero(of)[np.argsort(data["at"][of], kind="stable")]
    column = {name: factor * data[name][order] for name in ("value", "standard_deviation", "predicted")}
    lower, upper = (factor * data[name][order] for name in ("lower", "upper"))
    force, blue = data["at"][order], _colors()[1]
    axes.fill_between(force, lower, upper, color=blue, alpha=0.22, linewidth=0, label="band of the fit")
    axes.plot(force, column["predicted"], color=blue, label="best fit")
    points = (force, column["value"], column["standard_deviation"])
    _points(axes, points, "black", "measured", **line)
    axes.legend()
    return axes


def _runs(
    table: Table, ax: Axes | None, names: tuple[str, str], factor: float, line: dict[str, Any]
) -> Any:
    force, feature = names
    x, y = table[force], table[feature]
    if x.dtype.kind not in "fi" or y.dtype.kind not in "fi":
        raise KeyError(f"{force!r} and {feature!r} must be columns of numbers")
    axes = _axes(ax)
    colors = _colors()
    # Values that a sweep varies: each combination is a line. The many values of a study are points.
    others = [name for name in table if name.startswith("/") and name != force]
    groups = _groups([table[name].tolist() for name in others], table.rows)
    if len(groups) > len(colors):
        axes.plot(x, factor * y, "o", **{"color": colors[1], "markersize": 2.5, **line})
        return axes
    for index, (values, rows) in enumerate(groups.items()):
        order = np.array(rows)[np.argsort(x[rows], kind="stable")]
        label = ", ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in values)
        style = {"color": colors[index % len(colors)], "marker": "o", "label": label or None}
        axes.plot(x[order], factor * y[order], **{**style, **line})
    if len(groups) > 1:
        axes.legend()
    return axes


def _groups(columns: list[list[Any]], rows: int) -> dict[tuple[Any, ...], list[int]]:
    """Rows by their values in these columns."""
    keys: Iterable[tuple[Any, ...]] = zip(*columns) if columns else [()] * rows
    groups: dict[tuple[Any, ...], list[int]] = {}
    for row, key in enumerate(keys):
        groups.setdefault(key, []).append(row)
    return groups
