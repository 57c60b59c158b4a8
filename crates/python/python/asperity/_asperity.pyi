import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, Protocol, TypeVar, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._identify import Identification
from ._simulate import Simulation
from ._steady import Modes, SteadyResponses
from ._study import Study
from ._sweep import Sweep, Values

__all__ = [
    "ComputationError",
    "Figure",
    "FrequencyResponse",
    "FrfAverage",
    "Law",
    "LivePage",
    "Peak",
    "Scenario",
    "ScenarioError",
    "__version__",
    "analyse",
    "arrow_stream",
    "backbone",
    "circle_fit",
    "command",
    "convert_frf",
    "decay",
    "decay_length",
    "even_rate",
    "exponential_corrected",
    "exponential_falling_to",
    "exponential_receptance",
    "exponential_window",
    "feature_name",
    "find_hits",
    "fit_power",
    "force_window",
    "identify",
    "laws",
    "logarithmic_decrement",
    "modes",
    "palette",
    "pulse",
    "quality_issues",
    "read",
    "response_window",
    "restore_figure",
    "restore_law",
    "restore_peak",
    "restore_scenario",
    "simulate",
    "steady",
    "study",
    "sweep",
    "sweep_rows",
    "tabulate",
    "until_noise",
    "write",
]
__version__: str

_ScenarioLike = Scenario | str | os.PathLike[str] | dict[str, Any]
_Progress = Callable[[float], object] | None
_Columns = Mapping[str, NDArray[Any]]
_Numbers = Mapping[str, NDArray[np.float64]]
_Floats = NDArray[np.float64]
_Complex = NDArray[np.complex128]
_Sources = list[str] | list[list[dict[str, Any]]]

class _IsSeries(Protocol):
    @property
    def name(self) -> Any: ...
    def to_numpy(self) -> Any: ...

_Series = TypeVar("_Series", bound=_IsSeries)

class ScenarioError(ValueError):
    pointer: str
    accepted: str | None
    faults: list[dict[str, str | None]]

class ComputationError(Exception): ...

@final
class Scenario:
    def __new__(
        cls,
        source: _ScenarioLike,
        *,
        folder: str | os.PathLike[str] | None = None,
    ) -> Scenario: ...
    def with_(self, values: Mapping[str, Any]) -> Scenario: ...
    def simulate(self, *, progress: _Progress = None) -> Simulation: ...
    def sweep(
        self,
        vary: Mapping[str, Values] | None = None,
        *,
        rows: Mapping[str, Values] | None = None,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> Sweep: ...
    def study(
        self,
        study: Mapping[str, Any],
        *,
        folder: str | os.PathLike[str] | None = None,
        out: str | os.PathLike[str] | None = None,
        resume: bool = False,
        level: float = 0.95,
        probabilities: Sequence[float] = ...,
        exceed: Mapping[str, float] | Sequence[tuple[str, float]] | None = None,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> Study: ...
    def steady(
        self,
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
        progress: _Progress = None,
    ) -> SteadyResponses: ...
    def modes(self, count: int = 4) -> Modes: ...
    def identify(
        self,
        problem: Mapping[str, Any],
        *,
        folder: str | os.PathLike[str] | None = None,
        progress: _Progress = None,
        fast: bool = False,
    ) -> Identification: ...
    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None: ...
    @property
    def folder(self) -> Path: ...
    def to_dict(self) -> dict[str, Any]: ...
    @property
    def title(self) -> str | None: ...
    @property
    def sha256(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Law:
    def __new__(
        cls, source: Law | str | dict[str, Any], *, reference_pa: float | None = None
    ) -> Law: ...
    @overload
    def stiffness(self, pressure: float) -> float: ...
    @overload
    def stiffness(self, pressure: _Series) -> _Series: ...
    @overload
    def stiffness(self, pressure: ArrayLike) -> NDArray[np.float64]: ...
    @overload
    def stiffness_slope(self, pressure: float) -> float: ...
    @overload
    def stiffness_slope(self, pressure: _Series) -> _Series: ...
    @overload
    def stiffness_slope(self, pressure: ArrayLike) -> NDArray[np.float64]: ...
    @overload
    def closure(self, pressure: float) -> float: ...
    @overload
    def closure(self, pressure: _Series) -> _Series: ...
    @overload
    def closure(self, pressure: ArrayLike) -> NDArray[np.float64]: ...
    @overload
    def pressure(self, closure: float) -> float: ...
    @overload
    def pressure(self, closure: _Series) -> _Series: ...
    @overload
    def pressure(self, closure: ArrayLike) -> NDArray[np.float64]: ...
    @overload
    def energy(self, closure: float) -> float: ...
    @overload
    def energy(self, closure: _Series) -> _Series: ...
    @overload
    def energy(self, closure: ArrayLike) -> NDArray[np.float64]: ...
    def to_dict(self) -> dict[str, Any]: ...
    @property
    def kind(self) -> str: ...
    @property
    def reference_pa(self) -> float: ...
    @property
    def closure_lost_m(self) -> float | None: ...
    @property
    def closure_limit_m(self) -> float: ...
    @property
    def measured_range_pa(self) -> tuple[float, float] | None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class LivePage:
    def __new__(
        cls, scenario: _ScenarioLike, data: Path | None, out: Path | None, temporary: bool = False
    ) -> LivePage: ...
    @staticmethod
    def page() -> str: ...
    def answer(self, place: str, body: str, send: Callable[[int | str], bool]) -> None: ...
    def serve(self, port: int | None, announce: Callable[[str], object]) -> None: ...
    def scenario(self) -> Scenario: ...
    def close(self) -> None: ...

@final
class Figure:
    def svg(self) -> str: ...
    def png(self) -> bytes: ...
    def save(self, path: str | os.PathLike[str]) -> None: ...
    def _repr_svg_(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

def arrow_stream(columns: list[tuple[str, NDArray[Any] | list[str]]]) -> object: ...
def restore_figure(svg: str) -> Figure: ...
def restore_peak(
    frequency_hz: float, magnitude: float, real: float, imag: float, prominence: float
) -> Peak: ...
def restore_scenario(text: str, path: str | os.PathLike[str]) -> Scenario: ...
def restore_law(text: str, reference_pa: float | None) -> Law: ...

def read(
    paths: list[str],
    sample_rate_hz: float | None,
    names: list[str],
    units: list[str],
    sample_axis: str | None,
    si: bool,
    progress: _Progress,
) -> tuple[list[list[dict[str, Any]]], list[str]]: ...
def write(
    path: str | os.PathLike[str],
    records: list[list[dict[str, Any]]],
    format: str | None,
    title: str,
    overwrite: bool,
) -> None: ...
def even_rate(time_s: _Floats) -> float | None: ...
def analyse(
    sources: _Sources,
    settings: dict[str, Any],
    hits: str,
    rejected: list[int],
    form: str,
    frfs: bool,
    progress: _Progress,
) -> dict[str, Any]: ...
def decay(
    sources: _Sources, settings: dict[str, Any], bands_hz: list[list[float]], progress: _Progress
) -> tuple[dict[str, Any], _Columns, _Columns, dict[str, Figure]]: ...
def identify(
    problem: str | os.PathLike[str] | dict[str, Any],
    folder: str | os.PathLike[str] | None,
    progress: _Progress,
    fast: bool,
) -> dict[str, Any]: ...
def find_hits(
    force: _Floats,
    responses: list[_Floats],
    sample_rate_hz: float,
    level: float,
    level_of: str,
    pre_trigger: int,
    length: int,
    until_next: bool,
    hold_off: int,
) -> tuple[list[dict[str, Any]], tuple[float, float, float]]: ...
def quality_issues(
    force: _Floats,
    responses: list[_Floats],
    sample_rate_hz: float,
    missing: int,
    second_fraction: float,
    full_scale_n: float | None,
    full_scale_response: float | None,
    undecayed_ratio: float,
) -> list[dict[str, Any]]: ...
def pulse(force: _Floats, sample_rate_hz: float) -> dict[str, float] | None: ...
def force_window(
    force: _Floats, sample_rate_hz: float, window: tuple[float, float, float]
) -> _Floats: ...
def response_window(
    response: _Floats, sample_rate_hz: float, window: tuple[float, float]
) -> _Floats: ...
def until_noise(
    response: _Floats, sample_rate_hz: float, frequency_hz: float, noise_density: float
) -> tuple[float, float] | None: ...
def exponential_window(
    samples: _Floats, sample_rate_hz: float, tau_s: float, origin: int
) -> _Floats: ...
def exponential_falling_to(fraction: float, after_s: float) -> float: ...
def exponential_corrected(
    quantity: str, tau_s: float, natural_hz: float, ratio: float, value: float
) -> float: ...
def exponential_receptance(
    frequency_hz: _Floats, receptance: _Complex, response: str, tau_s: float
) -> _Complex: ...
def convert_frf(frequency_hz: _Floats, values: _Complex, form: str, to: str) -> _Complex: ...
def decay_length(samples: _Floats) -> int: ...
def palette(count: int) -> tuple[list[str], list[str]]: ...
def feature_name(feature: str) -> tuple[str, str]: ...
def circle_fit(frequency_hz: _Floats, mobility: _Complex) -> dict[str, Any] | None: ...
def logarithmic_decrement(
    samples: _Floats, sample_rate_hz: float, frequency_hz: float
) -> dict[str, float] | None: ...
def backbone(
    decay: _Floats,
    sample_rate_hz: float,
    band: tuple[float, float, float],
    cycles: float,
    edge_level: float,
    noise_density: float,
    noise_factor: float,
    response: str,
) -> _Columns: ...

@final
class FrfAverage:
    def __new__(
        cls, samples: int, sample_rate_hz: float, response: str, padding: int
    ) -> FrfAverage: ...
    def push(self, force: _Floats, response: _Floats) -> _Complex: ...
    def sums(self) -> tuple[int, _Floats, _Floats, _Complex, _Floats, _Floats]: ...
    def restore(
        self,
        averages: int,
        force: _Floats,
        response: _Floats,
        cross: _Complex,
        mean: _Floats,
        square: _Floats,
    ) -> None: ...
    @property
    def averages(self) -> int: ...
    @property
    def form(self) -> str: ...
    @property
    def frequency_hz(self) -> _Floats: ...
    def frf(self, name: str, noise_ratio: float | None) -> _Complex: ...
    def response(self, name: str, noise_ratio: float | None) -> FrequencyResponse: ...
    def coherence(self) -> list[_Floats]: ...
    def spread(self) -> list[_Floats]: ...
    def force_mask(self, threshold: float) -> NDArray[np.bool_]: ...
    def spectra(self, density: str) -> tuple[_Floats, _Floats, _Complex]: ...

@final
class Peak:
    @property
    def frequency_hz(self) -> float: ...
    @property
    def magnitude(self) -> float: ...
    @property
    def value(self) -> complex: ...
    @property
    def prominence(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class FrequencyResponse:
    def __new__(
        cls, force: _Floats, response: _Floats, sample_rate_hz: float, kind: str
    ) -> FrequencyResponse: ...
    def parts(self) -> tuple[_Floats, _Floats, bool]: ...
    def interpolated(self) -> FrequencyResponse: ...
    def receptance_at(self, frequency_hz: _Floats) -> _Complex: ...
    def dominant_frequency(
        self, band_hz: tuple[float, float], form: str, force_threshold: float
    ) -> float | None: ...
    def find_harmonics(
        self,
        near_hz: float,
        fundamental_window: tuple[float, float],
        second_window: tuple[float, float],
        force_threshold: float,
    ) -> tuple[Peak | None, Peak | None, _Floats]: ...
    def half_power(self, peak: Peak) -> tuple[float, float, float] | None: ...
    def circle_fit(self, peak: Peak) -> dict[str, Any] | None: ...

def simulate(
    scenario: _ScenarioLike, progress: _Progress
) -> tuple[
    dict[str, Any],
    tuple[_Numbers, Figure],
    tuple[_Numbers, Figure] | None,
    _Columns | None,
    tuple[_Numbers, Figure] | None,
    list[tuple[str, dict[str, NDArray[Any]], Figure | None]],
    Figure | None,
    list[tuple[str, str]],
]: ...
def sweep(
    scenario: _ScenarioLike,
    vary: list[tuple[str, str | list[str]]],
    threads: int | None,
    progress: _Progress,
) -> tuple[_Columns, Figure | None]: ...
def sweep_rows(
    scenario: _ScenarioLike,
    rows: list[tuple[str, list[str]]],
    threads: int | None,
    progress: _Progress,
) -> _Columns: ...
def steady(
    scenario: _ScenarioLike,
    asked: dict[str, Any],
    threads: int | None,
    progress: _Progress,
) -> tuple[
    dict[str, Any],
    _Columns,
    _Columns | None,
    _Columns | None,
    _Columns | None,
    Figure | None,
    list[tuple[str, str]],
]: ...
def study(
    study: str | os.PathLike[str] | dict[str, Any],
    folder: str | os.PathLike[str] | None,
    out: str | os.PathLike[str] | None,
    resume: bool,
    level: float,
    probabilities: list[float],
    exceed: list[tuple[str, float]],
    threads: int | None,
    progress: _Progress,
) -> dict[str, Any]: ...
def command(arguments: list[str]) -> int: ...
def modes(
    scenario: _ScenarioLike, count: int
) -> tuple[dict[str, Any], _Numbers, Figure | None]: ...
def laws(scenario: _ScenarioLike) -> dict[str, Law]: ...
def tabulate(scenario: _ScenarioLike) -> tuple[dict[str, _Numbers], Figure | None]: ...
def fit_power(
    pressure: list[float], stiffness: list[float]
) -> tuple[float, float, float, tuple[float, float] | None]: ...
