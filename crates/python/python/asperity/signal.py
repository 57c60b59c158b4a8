"""Single steps of an analysis, for arrays: hits, quality, windows, averages, damping, backbones.

Each function takes arrays of any real dtype, of shape ``(samples,)``, in SI units, and a sample rate
in Hz; a step of another tool is replaced without the rest. Numbers are those of the same steps in
`asperity.analyse`. A response is a ``"displacement"`` (m), a ``"velocity"`` (m/s) or an
``"acceleration"`` (m/s^2).

>>> from asperity import signal
>>> average = signal.FrfAverage(len(force), 25600)                      # doctest: +SKIP
>>> average.push(force, acceleration)                                   # doctest: +SKIP
>>> average.frequency_hz, average.h1(), average.coherence()             # doctest: +SKIP
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _asperity
from ._asperity import Peak
from ._result import same
from ._table import Table

__all__ = [
    "CircleFit",
    "ExponentialWindow",
    "ForceWindow",
    "FrequencyResponse",
    "FrfAverage",
    "HalfPower",
    "Harmonics",
    "Hit",
    "Hits",
    "LogarithmicDecrement",
    "Peak",
    "Pulse",
    "QualityIssue",
    "ResponseWindow",
    "backbone",
    "circle_fit",
    "convert_frf",
    "find_hits",
    "logarithmic_decrement",
    "pulse",
    "quality_issues",
]

_Floats = NDArray[np.float64]
_Complex = NDArray[np.complex128]


def _responses(value: ArrayLike | Sequence[ArrayLike], samples: int) -> list[_Floats]:
    """One or several responses, each as long as the force."""
    if isinstance(value, np.ndarray):
        separate: list[Any] = list(value) if value.ndim == 2 else [value]
    else:
        listed = list(value)  # type: ignore[arg-type]
        is_one = bool(listed) and all(np.isscalar(item) for item in listed)
        separate = [listed] if is_one else listed
    found = [_arrays.real("a response", one) for one in separate]
    for one in found:
        if len(one) != samples:
            raise ValueError(
                f"{samples} force samples but {len(one)} response samples; "
                "the numbers must be equal"
            )
    return found


@dataclass(frozen=True, eq=False)
class Hit:
    """Samples of one hit.

    Attributes
    ----------
    start : int
        Index in the record of the first sample.
    trigger : int
        Index in the hit of the first sample at or above the trigger level.
    force : ndarray, shape (samples,)
        Force in N.
    responses : tuple of ndarray, each of shape (samples,)
        Responses in their own units.
    sample_rate_hz : float
        Sample rate in Hz.
    missing : int
        Samples missing because the record ended inside the hit.
    """

    start: int
    trigger: int
    force: _Floats = field(repr=False)
    responses: tuple[_Floats, ...] = field(repr=False)
    sample_rate_hz: float
    missing: int

    @property
    def time_s(self) -> float:
        """Time of the trigger in the record, in s."""
        return (self.start + self.trigger) / self.sample_rate_hz

    def quality_issues(self) -> list[QualityIssue]:
        """The result of the function `quality_issues` for the hit, with its defaults."""
        return quality_issues(
            self.force, self.responses, self.sample_rate_hz, missing=self.missing
        )


@dataclass(frozen=True, eq=False)
class Hits(Sequence[Hit]):
    """The hits of a record, and the trigger that found them.

    Attributes
    ----------
    level_n, noise_n, largest_n : float
        Trigger level, robust standard deviation of the force, and largest force, in N.
    """

    _hits: tuple[Hit, ...] = field(repr=False)
    level_n: float
    noise_n: float
    largest_n: float

    @overload
    def __getitem__(self, index: int) -> Hit: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Hit, ...]: ...
    def __getitem__(self, index: int | slice) -> Hit | tuple[Hit, ...]:
        return self._hits[index]

    def __len__(self) -> int:
        return len(self._hits)


def find_hits(
    force: ArrayLike,
    responses: ArrayLike | Sequence[ArrayLike] = (),
    sample_rate_hz: float = 1.0,
    *,
    level_n: float | None = None,
    level_fraction: float | None = None,
    pre_trigger_s: float = 5e-3,
    length_s: float = 1.0,
    until_next: bool = True,
    hold_off_s: float = 0.2,
) -> Hits:
    """Find the hits of a record.

    Parameters
    ----------
    force : array_like, shape (samples,)
        Force in N, positive when the hammer pushes.
    responses : array_like, shape (samples,) or (channels, samples), or several arrays
        Signals measured with it, in any unit.
    sample_rate_hz : float
        Sample rate in Hz.
    level_n : float, optional
        Trigger level in N; by default in the widest gap between the noise and the hits.
    level_fraction : float, optional
        Trigger level as a fraction of the largest force, instead.
    pre_trigger_s : float
        Time kept before the trigger, in s.
    length_s : float
        Length of a hit in s, the time before the trigger included.
    until_next : bool
        End a hit where the next begins, if that is earlier; else further pulses inside the length
        belong to the same hit.
    hold_off_s : float
        Time after a trigger in which no further hit begins, in s.

    Returns
    -------
    Hits
        A sequence of `Hit`, with the trigger level.

    Raises
    ------
    TypeError
        For signals and options that are not real numbers.
    ValueError
        For options out of range, signals of unequal length, and a force that does not rise above its
        noise.
    """
    force = _arrays.real("force", force)
    rate = _rate(sample_rate_hz)
    if level_n is not None and level_fraction is not None:
        raise ValueError("level_n and level_fraction exclude each other")
    if level_n is not None:
        level_of, level = "force", _arrays.number("level_n", level_n)
    elif level_fraction is not None:
        level_of, level = "largest", _arrays.number("level_fraction", level_fraction)
    else:
        level_of, level = "automatic", 0.0
    found, trigger = _asperity.find_hits(
        force,
        _responses(responses, len(force)),
        rate,
        level,
        level_of,
        _arrays.samples_of("pre_trigger_s", pre_trigger_s, rate),
        _arrays.samples_of("length_s", length_s, rate),
        bool(until_next),
        _arrays.samples_of("hold_off_s", hold_off_s, rate),
    )
    hits = tuple(
        Hit(
            start=one["start"],
            trigger=one["trigger"],
            force=one["force"],
            responses=tuple(one["responses"]),
            sample_rate_hz=rate,
            missing=one["missing"],
        )
        for one in found
    )
    return Hits(hits, *trigger)


@dataclass(frozen=True)
class QualityIssue:
    """A defect of a hit.

    Attributes
    ----------
    kind : str
        ``"double hit"``, ``"overload"``, ``"clipped"``, ``"dropout"``, ``"not finite"``,
        ``"truncated"`` or ``"not decayed"``.
    text : str
        The issue with its evidence, in words.
    is_disqualifying : bool
        True if the frequency response of the hit is invalid; a hit that is truncated or not decayed
        has leakage only.
    response : int or None
        Index of the response; None for the force.
    time_s : float or None
        Time after the first sample, in s.
    """

    kind: str
    text: str
    is_disqualifying: bool
    response: int | None
    time_s: float | None

    def __str__(self) -> str:
        return self.text


def quality_issues(
    force: ArrayLike,
    responses: ArrayLike | Sequence[ArrayLike],
    sample_rate_hz: float,
    *,
    missing: int = 0,
    second_fraction: float = 0.1,
    full_scale_n: float | None = None,
    full_scale_response: float | None = None,
    undecayed_ratio: float = 0.01,
) -> list[QualityIssue]:
    """Check the quality of a hit: double hits, overloads, dropouts, leakage.

    Parameters
    ----------
    force : array_like, shape (samples,)
        Force in N.
    responses : array_like, shape (samples,) or (channels, samples), or several arrays
        Responses in any unit.
    sample_rate_hz : float
        Sample rate in Hz.
    missing : int
        Samples missing at the end of the hit.
    second_fraction : float
        Smallest height of a further force maximum of a double hit, over the first.
    full_scale_n, full_scale_response : float, optional
        Full scale of the force in N, and of the responses in their unit.
    undecayed_ratio : float
        Largest root mean square of the last twentieth of a response, over its largest value.

    Returns
    -------
    list of QualityIssue
        Empty for a good hit.

    Raises
    ------
    TypeError
        For signals and options that are not real numbers.
    ValueError
        For signals of unequal length, a sample rate that is not positive, and a negative `missing`.
    """
    force = _arrays.real("force", force)
    rate = _rate(sample_rate_hz)
    full_scales = [
        None if value is None else _arrays.number(name, value)
        for name, value in (
            ("full_scale_n", full_scale_n),
            ("full_scale_response", full_scale_response),
        )
    ]
    found = _asperity.quality_issues(
        force,
        _responses(responses, len(force)),
        rate,
        _arrays.count("missing", missing),
        _arrays.number("second_fraction", second_fraction),
        full_scales[0],
        full_scales[1],
        _arrays.number("undecayed_ratio", undecayed_ratio),
    )
    return [QualityIssue(**issue) for issue in found]


def _rate(sample_rate_hz: float) -> float:
    rate = _arrays.number("sample_rate_hz", sample_rate_hz)
    if not (rate > 0 and np.isfinite(rate)):
        raise ValueError(f"sample_rate_hz is {rate}; accepted: a positive number")
    return rate


@dataclass(frozen=True)
class Pulse:
    """The pulse of a force.

    Attributes
    ----------
    force_peak_n : float
        Largest force in N.
    peak_time_s : float
        Its time in s after the first sample.
    impulse_ns : float
        Integral of the force over time in N s.
    pulse_width_s : float
        Width at half height in s.
    begin_s, end_s : float
        Ends of the pulse in s after the first sample.
    """

    force_peak_n: float
    peak_time_s: float
    impulse_ns: float
    pulse_width_s: float
    begin_s: float
    end_s: float


def pulse(force: ArrayLike, sample_rate_hz: float) -> Pulse | None:
    """Find the pulse of a force.

    Parameters
    ----------
    force : array_like, shape (samples,)
        Force in N, without offset.
    sample_rate_hz : float
        Sample rate in Hz.

    Returns
    -------
    Pulse or None
        None for a force without a pulse, and for samples that are not finite.

    Raises
    ------
    TypeError
        For samples that are not real numbers.
    ValueError
        For samples of another shape, and a sample rate that is not positive.
    """
    found = _asperity.pulse(_arrays.real("force", force), _rate(sample_rate_hz))
    return None if found is None else Pulse(**found)


def _taper(taper_s: float) -> None:
    if not 0 <= _arrays.number("taper_s", taper_s) < np.inf:
        raise ValueError(f"taper_s is {taper_s}; accepted: 0 s and above")


@dataclass(frozen=True)
class ForceWindow:
    """A window that is one from `begin_s` to `end_s` and zero beyond a cosine taper of `taper_s`.

    The offset of the force must be subtracted first.

    Parameters
    ----------
    begin_s, end_s : float
        Ends of the window in s after the first sample.
    taper_s : float
        Length of each taper in s.
    """

    begin_s: float
    end_s: float
    taper_s: float = 0.5e-3

    def __post_init__(self) -> None:
        begin, end = _arrays.number("begin_s", self.begin_s), _arrays.number("end_s", self.end_s)
        if not begin <= end:
            raise ValueError(f"begin_s is {begin} and end_s {end}; accepted: an end after the begin")
        _taper(self.taper_s)

    @classmethod
    def around(
        cls,
        force: ArrayLike,
        sample_rate_hz: float,
        *,
        margin_s: float = 0.5e-3,
        taper_s: float = 0.5e-3,
    ) -> ForceWindow:
        """The window about the pulse of a force, with a margin on either side.

        Parameters
        ----------
        force : array_like, shape (samples,)
            Force in N, without offset.
        sample_rate_hz : float
            Sample rate in Hz.
        margin_s, taper_s : float
            Margin on either side, and length of each taper, in s.

        Raises
        ------
        ValueError
            If the force has no pulse.
        """
        found = pulse(force, sample_rate_hz)
        if found is None:
            raise ValueError("the force has no pulse")
        return cls(found.begin_s - margin_s, found.end_s + margin_s, taper_s)

    def apply(self, force: ArrayLike, sample_rate_hz: float) -> _Floats:
        """The force times the window.

        Parameters
        ----------
        force : array_like, shape (samples,)
            Force in any unit.
        sample_rate_hz : float
            Sample rate in Hz.

        Returns
        -------
        ndarray, shape (samples,)
            In the unit of the force.

        Raises
        ------
        TypeError
            For samples that are not real numbers.
        ValueError
            For samples of another shape, and a sample rate that is not positive.
        """
        window = tuple(
            _arrays.number(name, getattr(self, name)) for name in ("begin_s", "end_s", "taper_s")
        )
        return _asperity.force_window(
            _arrays.real("force", force), _rate(sample_rate_hz), (window[0], window[1], window[2])
        )


@dataclass(frozen=True)
class ResponseWindow:
    """A window that is one until `end_s` and zero after a cosine taper of `taper_s`.

    Parameters
    ----------
    end_s : float
        End of the window in s after the first sample.
    taper_s : float
        Length of the taper in s.
    """

    end_s: float
    taper_s: float

    def __post_init__(self) -> None:
        _arrays.number("end_s", self.end_s)
        _taper(self.taper_s)

    @classmethod
    def until_noise(
        cls,
        response: ArrayLike,
        sample_rate_hz: float,
        *,
        frequency_hz: float,
        noise_density: float,
    ) -> ResponseWindow | None:
        """The window at whose end a resonance has decayed into noise; None if it has not.

        Parameters
        ----------
        response : array_like, shape (samples,)
            Response in any unit.
        sample_rate_hz : float
            Sample rate in Hz.
        frequency_hz : float
            Frequency of the resonance in Hz.
        noise_density : float
            One-sided density of the noise there, in the squared unit of the samples per Hz.

        Raises
        ------
        TypeError
            For samples that are not real numbers.
        ValueError
            For samples of another shape, and a sample rate that is not positive.
        """
        found = _asperity.until_noise(
            _arrays.real("response", response),
            _rate(sample_rate_hz),
            _arrays.number("frequency_hz", frequency_hz),
            _arrays.number("noise_density", noise_density),
        )
        return None if found is None else cls(*found)

    def apply(self, response: ArrayLike, sample_rate_hz: float) -> _Floats:
        """The response times the window.

        Parameters
        ----------
        response : array_like, shape (samples,)
            Response in any unit.
        sample_rate_hz : float
            Sample rate in Hz.

        Returns
        -------
        ndarray, shape (samples,)
            In the unit of the response.

        Raises
        ------
        TypeError
            For samples that are not real numbers.
        ValueError
            For samples of another shape, and a sample rate that is not positive.
        """
        window = (
            _arrays.number("end_s", self.end_s),
            _arrays.number("taper_s", self.taper_s),
        )
        return _asperity.response_window(
            _arrays.real("response", response), _rate(sample_rate_hz), window
        )


@dataclass(frozen=True)
class ExponentialWindow:
    """An exponential window ``exp(-t / tau_s)`` on force and response, with its exact correction.

    The windowed signals give ``H(i w + 1/tau)`` in place of ``H(i w)``: a mode keeps its damped
    frequency and its residue, and its decay rate rises by ``1/tau``. A time constant that is not
    positive and finite is a ValueError of each method.

    Parameters
    ----------
    tau_s : float
        Time constant in s.
    """

    tau_s: float

    @classmethod
    def falling_to(cls, fraction: float, after_s: float) -> ExponentialWindow:
        """The window that falls to a fraction after a time.

        Parameters
        ----------
        fraction : float
            Above 0 and below 1.
        after_s : float
            Time in s after which the window has this value.

        Raises
        ------
        ValueError
            For a fraction or a time out of range.
        """
        fraction, after = _arrays.number("fraction", fraction), _arrays.number("after_s", after_s)
        return cls(_asperity.exponential_falling_to(fraction, after))

    def apply(self, samples: ArrayLike, sample_rate_hz: float, *, origin: int = 0) -> _Floats:
        """The samples times the window.

        Parameters
        ----------
        samples : array_like, shape (samples,)
            Force or response in any unit.
        sample_rate_hz : float
            Sample rate in Hz.
        origin : int
            Index of the sample at which the window is one, for both signals the same.

        Returns
        -------
        ndarray, shape (samples,)
            In the unit of the samples.

        Raises
        ------
        TypeError
            For samples that are not real numbers.
        ValueError
            For samples of another shape, and a sample rate or an origin out of range.
        """
        return _asperity.exponential_window(
            _arrays.real("samples", samples),
            _rate(sample_rate_hz),
            _arrays.number("tau_s", self.tau_s),
            _arrays.count("origin", origin),
        )

    def _corrected(
        self, quantity: str, natural_frequency_hz: float, damping_ratio: float, value: float
    ) -> float:
        return _asperity.exponential_corrected(
            quantity,
            _arrays.number("tau_s", self.tau_s),
            _arrays.number("natural_frequency_hz", natural_frequency_hz),
            _arrays.number("damping_ratio", damping_ratio),
            _arrays.number("the value", value),
        )

    def corrected_damping_ratio(self, natural_frequency_hz: float, damping_ratio: float) -> float:
        """The damping ratio without the window, from frequency (Hz) and ratio found with it."""
        return self._corrected("damping_ratio", natural_frequency_hz, damping_ratio, 0.0)

    def corrected_natural_frequency_hz(
        self, natural_frequency_hz: float, damping_ratio: float
    ) -> float:
        """The undamped natural frequency in Hz without the window, from frequency (Hz) and ratio
        found with it."""
        return self._corrected("natural_frequency_hz", natural_frequency_hz, damping_ratio, 0.0)

    def corrected_peak_frequency_hz(
        self, natural_frequency_hz: float, damping_ratio: float, peak_frequency_hz: float
    ) -> float:
        """The frequency in Hz of a single mode's receptance peak without the window, from natural
        frequency (Hz), damping ratio and peak frequency (Hz) found with it."""
        mode = natural_frequency_hz, damping_ratio
        return self._corrected("peak_frequency_hz", *mode, peak_frequency_hz)

    def corrected_peak_magnitude(
        self, natural_frequency_hz: float, damping_ratio: float, magnitude: float
    ) -> float:
        """The height of a single mode's receptance peak without the window, in the unit of
        `magnitude`; NaN if the damping ratio is not larger than that of the window."""
        return self._corrected("peak_magnitude", natural_frequency_hz, damping_ratio, magnitude)

    def corrected_receptance(
        self, frequency_hz: ArrayLike, receptance: ArrayLike, response: str = "acceleration"
    ) -> _Complex:
        """The receptance at ``i w + 1/tau`` from that of the windowed response divided at ``i w``.

        Parameters
        ----------
        frequency_hz : array_like, shape (lines,)
            Frequencies in Hz.
        receptance : array_like, shape (lines,)
            Complex receptances in m/N.
        response : {"acceleration", "velocity", "displacement"}
            Quantity of the response that was windowed.

        Returns
        -------
        ndarray, shape (lines,)
            In m/N.

        Raises
        ------
        ValueError
            For unequal numbers of frequencies and receptances, and an unknown quantity.
        """
        frequencies = _arrays.real("frequency_hz", frequency_hz)
        values = _arrays.complex_("receptance", receptance)
        _equal_lengths(frequencies, values)
        tau = _arrays.number("tau_s", self.tau_s)
        return _asperity.exponential_receptance(frequencies, values, response, tau)


def _equal_lengths(frequencies: _Floats, values: _Complex) -> None:
    if len(frequencies) != len(values):
        raise ValueError(
            f"{len(frequencies)} frequencies but {len(values)} values; the numbers must be equal"
        )


class FrfAverage:
    """The average of hits: spectra, frequency response function by H1, H2 or Hv, coherence.

    All arrays of results have the shape (lines,). The functions are in the unit of the response per N. A result
    for which there are too few hits is a ValueError: one is needed, two for coherence and spread.

    Parameters
    ----------
    samples : int
        Nominal number of samples of a hit; shorter ones are padded with zeros.
    sample_rate_hz : float
        Sample rate in Hz.
    response : {"acceleration", "velocity", "displacement"}
        Quantity of the responses. The functions are accelerances, mobilities or receptances;
        `convert_frf` gives the other forms.
    padding : int
        Zero padding, 1 (none) to 1024.

    Raises
    ------
    ValueError
        For arguments out of range.
    """

    __slots__ = ("_native", "_settings")

    def __init__(
        self,
        samples: int,
        sample_rate_hz: float,
        response: str = "acceleration",
        *,
        padding: int = 1,
    ) -> None:
        self._settings = (
            _arrays.count("samples", samples),
            _arrays.number("sample_rate_hz", sample_rate_hz),
            response,
            _arrays.count("padding", padding),
        )
        self._native = _asperity.FrfAverage(*self._settings)

    def __getstate__(self) -> tuple[Any, ...]:
        return self._settings, self._native.sums()

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self._settings, sums = state
        self._native = _asperity.FrfAverage(*self._settings)
        self._native.restore(*sums)

    def __eq__(self, other: object) -> bool:
        """True for an average of the same settings with the same sums."""
        if not isinstance(other, FrfAverage):
            return NotImplemented
        return same(self.__getstate__(), other.__getstate__())

    __hash__ = None  # type: ignore[assignment]

    def push(self, force: ArrayLike, response: ArrayLike) -> _Complex:
        """Add a hit.

        Parameters
        ----------
        force, response : array_like, shape (samples,)
            Force in N; response in m/s^2, m/s or m.

        Returns
        -------
        ndarray, shape (lines,)
            The complex function of this hit alone.

        Raises
        ------
        ValueError
            For samples that are not finite, too many or of unequal number, and a force that is zero
            throughout; the hit is then not added.
        """
        return self._native.push(_arrays.real("force", force), _arrays.real("response", response))

    @property
    def averages(self) -> int:
        """Number of hits."""
        return self._native.averages

    @property
    def form(self) -> str:
        """Form of the functions: accelerance, mobility or receptance."""
        return self._native.form

    @property
    def frequency_hz(self) -> _Floats:
        """Frequencies of the lines in Hz, from zero to half the sample rate."""
        return self._native.frequency_hz

    def h1(self) -> _Complex:
        """``Gfx / Gff``, for noise on the response, shape (lines,)."""
        return self._native.frf("h1", None)

    def h2(self) -> _Complex:
        """``Gxx / conj(Gfx)``, for noise on the force, shape (lines,)."""
        return self._native.frf("h2", None)

    def hv(self, noise_ratio: float | None = None) -> _Complex:
        """Total least squares, for noise on both, shape (lines,).

        `noise_ratio` is the standard deviation of the response's noise over that of the force's, in
        the response's unit per N; by default both have the same noise-to-signal ratio. One that is
        not positive and finite is a ValueError.
        """
        ratio = None if noise_ratio is None else _arrays.number("noise_ratio", noise_ratio)
        return self._native.frf("hv", ratio)

    def coherence(self) -> _Floats:
        """Ordinary coherence, 0 to 1, shape (lines,); ValueError for fewer than two hits."""
        return self._native.coherence()[0]

    def random_errors(self) -> tuple[_Floats, _Floats]:
        """Standard deviations of the relative magnitude and of the phase (rad), by the coherence,
        each of shape (lines,); ValueError for fewer than two hits."""
        _, magnitude, phase = self._native.coherence()
        return magnitude, phase

    def spread(self) -> tuple[_Floats, _Floats]:
        """Mean and standard deviation over the hits of the magnitude of their functions, each of
        shape (lines,); ValueError for fewer than two hits."""
        mean, deviation = self._native.spread()
        return mean, deviation

    def valid(self, threshold: float = 0.02) -> NDArray[np.bool_]:
        """True where the force spectrum is at least `threshold` of its maximum, shape (lines,)."""
        return self._native.force_mask(_arrays.number("threshold", threshold))

    def spectra(self, density: str = "power") -> tuple[_Floats, _Floats, _Complex]:
        """One-sided ``Gff``, ``Gxx`` and ``Gfx``, each of shape (lines,).

        As densities of ``"power"``, in the product of the units per Hz such as N^2/Hz, or of
        ``"energy"``, the same times s. Another density is a ValueError.
        """
        return self._native.spectra(density)

    def response(self, estimator: str = "h1") -> FrequencyResponse:
        """The averaged function at every frequency, for peaks and damping between the lines.

        `estimator` is ``"h1"``, ``"h2"`` or ``"hv"``; another one is a ValueError.
        """
        native = self._native.response(estimator, None)
        return FrequencyResponse._of(native, *self._settings[1:3])


def convert_frf(
    frequency_hz: ArrayLike, values: ArrayLike, from_form: str, to_form: str
) -> _Complex:
    """A frequency response function in another form.

    Parameters
    ----------
    frequency_hz : array_like, shape (lines,)
        Frequencies in Hz.
    values : array_like, shape (lines,)
        Complex values in SI units.
    from_form, to_form : str
        ``"receptance"``, ``"mobility"``, ``"accelerance"``, ``"dynamic stiffness"``,
        ``"mechanical impedance"`` or ``"apparent mass"``.

    Returns
    -------
    ndarray, shape (lines,)
        In SI units. Not finite at zero frequency where the form is not defined there.

    Raises
    ------
    TypeError
        For frequencies that are not real numbers, and values that are no numbers.
    ValueError
        For unequal numbers of frequencies and values, and unknown forms.
    """
    frequencies = _arrays.real("frequency_hz", frequency_hz)
    return _asperity.convert_frf(
        frequencies, _arrays.complex_("values", values), from_form, to_form
    )


@dataclass(frozen=True, eq=False)
class Harmonics:
    """Fundamental and second harmonic of a receptance.

    Attributes
    ----------
    fundamental, second : Peak or None
        None for one without a peak.
    masked_hz : ndarray
        Frequencies in Hz of maxima in either window that were left out, since the force spectrum is
        too small there.
    """

    fundamental: Peak | None
    second: Peak | None
    masked_hz: _Floats = field(repr=False)

    @property
    def ratio(self) -> float | None:
        """Ratio of the receptances, second over fundamental."""
        if self.fundamental is None or self.second is None:
            return None
        return self.second.magnitude / self.fundamental.magnitude


@dataclass(frozen=True)
class HalfPower:
    """Damping by the half-power frequencies on either side of a peak.

    Attributes
    ----------
    damping_ratio : float
        Damping ratio.
    lower_hz, upper_hz : float
        Half-power frequencies in Hz.
    """

    damping_ratio: float
    lower_hz: float
    upper_hz: float


@dataclass(frozen=True)
class CircleFit:
    """A circle through the mobilities about a resonance (Kennedy and Pancu).

    Attributes
    ----------
    natural_frequency_hz, damping_ratio : float
        Undamped natural frequency in Hz; damping ratio.
    modal_constant_per_kg : complex
        Modal constant in 1/kg.
    centre, radius : complex, float
        Of the circle, in m/(N s).
    scatter, angle_scatter_rad : float
        Root mean square distance of the points from the circle over its radius, and of their angles
        from those of the mode in rad.
    arc_rad : float
        Angle between the first and the last point in rad.
    """

    natural_frequency_hz: float
    damping_ratio: float
    modal_constant_per_kg: complex
    centre: complex
    radius: float
    scatter: float
    angle_scatter_rad: float
    arc_rad: float


class FrequencyResponse:
    """Force and response of one hit, whose receptance is evaluated at any frequency.

    Parameters
    ----------
    force, response : array_like, shape (samples,)
        Force in N; response in m, m/s or m/s^2.
    sample_rate_hz : float
        Sample rate in Hz.
    quantity : {"acceleration", "velocity", "displacement"}
        Quantity of the response.

    Raises
    ------
    ValueError
        For samples that are not finite or of unequal number, and a force that is zero throughout.
    """

    __slots__ = ("_native", "_settings")
    _native: _asperity.FrequencyResponse
    _settings: tuple[float, str]

    def __init__(
        self,
        force: ArrayLike,
        response: ArrayLike,
        sample_rate_hz: float,
        quantity: str = "acceleration",
    ) -> None:
        self._settings = (_arrays.number("sample_rate_hz", sample_rate_hz), quantity)
        self._native = _asperity.FrequencyResponse(
            _arrays.real("force", force), _arrays.real("response", response), *self._settings
        )

    @classmethod
    def _of(
        cls, native: _asperity.FrequencyResponse, sample_rate_hz: float, quantity: str
    ) -> FrequencyResponse:
        response = cls.__new__(cls)
        response._native = native
        response._settings = (sample_rate_hz, quantity)
        return response

    def __getstate__(self) -> tuple[Any, ...]:
        return self._settings, self._native.parts()

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self._settings, (force, response, interpolated) = state
        native = _asperity.FrequencyResponse(force, response, *self._settings)
        self._native = native.interpolated() if interpolated else native

    def __eq__(self, other: object) -> bool:
        """True for a response of the same samples."""
        if not isinstance(other, FrequencyResponse):
            return NotImplemented
        return same(self.__getstate__(), other.__getstate__())

    __hash__ = None  # type: ignore[assignment]

    def receptance(self, frequency_hz: ArrayLike) -> _Complex:
        """Receptances in m/N at frequencies in Hz, both of shape (frequencies,); NaN at zero for
        velocities and accelerations."""
        return self._native.receptance_at(_arrays.real("frequency_hz", frequency_hz))

    def dominant_frequency(
        self,
        band_hz: tuple[float, float],
        *,
        form: str = "receptance",
        force_threshold: float = 0.02,
    ) -> float | None:
        """Frequency in Hz of the largest peak in a band; None without one.

        Parameters
        ----------
        band_hz : (float, float)
            Band in Hz.
        form : str
            Form of the function whose peak is sought, as for `convert_frf`.
        force_threshold : float
            Smallest force spectrum at a peak, over its maximum.

        Raises
        ------
        ValueError
            For an unknown form, and a band that is not two numbers.
        """
        threshold = _arrays.number("force_threshold", force_threshold)
        return self._native.dominant_frequency(_pair("band_hz", band_hz), form, threshold)

    def find_harmonics(
        self,
        near_hz: float,
        *,
        fundamental_window: tuple[float, float] = (0.4, 1.4),
        second_window: tuple[float, float] = (1.7, 2.3),
        force_threshold: float = 0.02,
    ) -> Harmonics:
        """The fundamental and the second harmonic, as maxima of the receptance.

        Parameters
        ----------
        near_hz : float
            Expected fundamental in Hz.
        fundamental_window : (float, float)
            Window of the fundamental, over `near_hz`.
        second_window : (float, float)
            Window of the second harmonic, over the fundamental found.
        force_threshold : float
            Smallest force spectrum at a peak, over its maximum.

        Returns
        -------
        Harmonics
            With the peaks that were found.

        Raises
        ------
        ValueError
            For a window that is not two numbers.
        """
        found = self._native.find_harmonics(
            _arrays.number("near_hz", near_hz),
            _pair("fundamental_window", fundamental_window),
            _pair("second_window", second_window),
            _arrays.number("force_threshold", force_threshold),
        )
        return Harmonics(*found)

    def half_power(self, peak: Peak) -> HalfPower | None:
        """Damping of a peak by its half-power width; None if it does not fall to half power."""
        found = self._native.half_power(peak)
        return None if found is None else HalfPower(*found)

    def circle_fit(self, peak: Peak) -> CircleFit | None:
        """Circle fit between the half-power frequencies of a peak; None without one."""
        found = self._native.circle_fit(peak)
        return None if found is None else CircleFit(**found)


def _pair(name: str, value: tuple[float, float]) -> tuple[float, float]:
    try:
        low, high = value
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; accepted: two numbers") from None
    return _arrays.number(name, low), _arrays.number(name, high)


def circle_fit(
    frequency_hz: ArrayLike, values: ArrayLike, form: str = "mobility"
) -> CircleFit | None:
    """Circle fit of the points of a frequency response function about one resonance.

    Parameters
    ----------
    frequency_hz : array_like, shape (points,)
        Frequencies in Hz, above zero and increasing; at least 5.
    values : array_like, shape (points,)
        Complex values of the function in SI units.
    form : str
        Form of the function, as for `convert_frf`.

    Returns
    -------
    CircleFit or None
        None for fewer than 5 points, frequencies that do not increase, points that are not on a
        circle, and values that are not finite.

    Raises
    ------
    ValueError
        For unequal numbers of frequencies and values, and an unknown form.
    """
    frequencies = _arrays.real("frequency_hz", frequency_hz)
    mobility = convert_frf(frequencies, values, form, "mobility")
    found = _asperity.circle_fit(frequencies, mobility)
    return None if found is None else CircleFit(**found)


@dataclass(frozen=True)
class LogarithmicDecrement:
    """Damping of a free decay by its extrema.

    Attributes
    ----------
    damping_ratio, decrement : float
        Damping ratio; decrease of the logarithm of the amplitude per cycle.
    frequency_hz : float
        Damped natural frequency in Hz.
    cycles : float
        Number of cycles fitted.
    scatter : float
        Root mean square residual of the logarithms of the amplitudes.
    """

    damping_ratio: float
    decrement: float
    frequency_hz: float
    cycles: float
    scatter: float


def logarithmic_decrement(
    samples: ArrayLike, sample_rate_hz: float, near_hz: float
) -> LogarithmicDecrement | None:
    """Damping of a free decay by the logarithmic decrement of its extrema.

    Parameters
    ----------
    samples : array_like, shape (samples,)
        Free decay of one mode, in any unit.
    sample_rate_hz : float
        Sample rate in Hz.
    near_hz : float
        Frequency in Hz, to within a quarter.

    Returns
    -------
    LogarithmicDecrement or None
        None for fewer than 8 samples a cycle or four extrema, and for samples that are not finite.

    Raises
    ------
    TypeError
        For samples that are not real numbers.
    ValueError
        For samples of another shape, and a sample rate that is not positive.
    """
    found = _asperity.logarithmic_decrement(
        _arrays.real("samples", samples),
        _rate(sample_rate_hz),
        _arrays.number("near_hz", near_hz),
    )
    return None if found is None else LogarithmicDecrement(**found)


def backbone(
    decay: ArrayLike,
    sample_rate_hz: float,
    band_hz: tuple[float, float],
    *,
    edge_hz: float | None = None,
    cycles: float = 4.0,
    edge_level: float = 3e-4,
    noise_density: float = 0.0,
    noise_factor: float = 5.0,
    response: str = "displacement",
) -> Table:
    """Frequency and damping over amplitude along a free decay (ring-down) of one mode.

    Parameters
    ----------
    decay : array_like, shape (samples,)
        Free decay from the first sample on, any unit, without offset.
    sample_rate_hz : float
        Sample rate in Hz.
    band_hz : (float, float)
        Band about the mode in Hz.
    edge_hz : float, optional
        Width of the edges of the band in Hz; by default a twelfth of its width.
    cycles : float
        Cycles over which a line is fitted, at least 1.
    edge_level : float
        Largest part of the filtered signal that the ends of the record may contribute.
    noise_density : float
        One-sided density of the noise, in the squared unit of the samples per Hz.
    noise_factor : float
        Smallest envelope over that of the filtered noise.
    response : {"displacement", "velocity", "acceleration"}
        What the samples are. The amplitude is theirs; decay rate and damping are those of the
        displacement, whose amplitude falls at another rate where the frequency changes.

    Returns
    -------
    Table
        ``time_s``, ``amplitude`` (in the unit of the samples), ``frequency_hz``,
        ``decay_rate_per_s`` and ``damping_ratio``.

    Raises
    ------
    ValueError
        For options out of range, and samples that are not finite.
    """
    low, high = _pair("band_hz", band_hz)
    edge = (high - low) / 12.0 if edge_hz is None else _arrays.number("edge_hz", edge_hz)
    columns = _asperity.backbone(
        _arrays.real("decay", decay),
        _arrays.number("sample_rate_hz", sample_rate_hz),
        (low, high, edge),
        _arrays.number("cycles", cycles),
        _arrays.number("edge_level", edge_level),
        _arrays.number("noise_density", noise_density),
        _arrays.number("noise_factor", noise_factor),
        response,
    )
    return _arrays.table(columns)
