"""The signal toolbox: against exact oscillators, SciPy and pyFRF, and at its boundary."""

from __future__ import annotations

import copy
import pickle
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import asperity
import hammer
from asperity import signal

RATE = 20_000.0
HZ, RATIO = 200.0, 0.02
OMEGA = 2 * np.pi * HZ
DAMPED = OMEGA * np.sqrt(1 - RATIO**2)


def impulse(samples: int = 20_000) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Unit impulse and displacement of 1 kg at 200 Hz with 2 % of critical damping."""
    t = np.arange(samples) / RATE
    force = np.zeros(samples)
    force[0] = RATE
    return force, np.exp(-RATIO * OMEGA * t) * np.sin(DAMPED * t) / DAMPED


def mobility(frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    w = 2 * np.pi * frequency
    return np.asarray(1j * w / (OMEGA**2 - w**2 + 2j * RATIO * OMEGA * w))


def test_hits_are_found_where_they_are() -> None:
    force, acceleration = hammer.record()
    hits = signal.find_hits(force, acceleration, hammer.RATE)
    assert len(hits) == 4
    assert hits.noise_n == pytest.approx(1e-3, rel=0.05) and 0.1 < hits.level_n < 10.0
    assert hits.largest_n == force.max()
    for number, hit in enumerate(hits):
        assert hit.time_s == pytest.approx(number + 0.05, abs=1e-3)
        begin = hit.start
        np.testing.assert_array_equal(hit.force, force[begin : begin + len(hit.force)])
        np.testing.assert_array_equal(
            hit.responses[0], acceleration[begin : begin + len(hit.force)]
        )
        assert hit.missing == 0 and hit.quality_issues() == []
    whole = signal.find_hits(force, acceleration, hammer.RATE, until_next=False)
    assert [hit.missing for hit in whole] == [0, 0, 0, 226]
    (issue,) = whole[3].quality_issues()
    assert (issue.kind, issue.is_disqualifying) == ("truncated", False)
    two = signal.find_hits(force, [acceleration, force], hammer.RATE, level_n=15)
    assert [len(hit.responses) for hit in two] == [2, 2]
    rows = signal.find_hits(force, np.stack([acceleration, force]), hammer.RATE, level_fraction=0.9)
    assert len(rows) == 1 and len(rows[0].responses) == 2
    pulse = signal.pulse(force[:1000], hammer.RATE)
    assert pulse is not None and pulse.force_peak_n == pytest.approx(10.0, rel=1e-2)
    # Half a sine of 2 ms.
    assert pulse.pulse_width_s == pytest.approx(2e-3 * 2 / 3, rel=0.02)
    assert signal.pulse(np.zeros(100), 1e3) is None


def test_verdicts_name_their_evidence() -> None:
    force, acceleration = (one[:5000].copy() for one in hammer.record((10.0,)))
    assert signal.quality_issues(force, acceleration, hammer.RATE) == []
    double = force.copy()
    double[300:311] += 4 * np.sin(np.linspace(0, np.pi, 11))
    (issue,) = signal.quality_issues(double, acceleration, hammer.RATE)
    assert (issue.kind, issue.is_disqualifying, issue.response) == ("double hit", True, None)
    assert issue.text == str(issue) and "40 %" in issue.text
    (full,) = signal.quality_issues(
        force, acceleration, hammer.RATE, full_scale_response=0.99 * np.abs(acceleration).max()
    )[:1]
    assert (full.kind, full.response) == ("overload", 0)
    acceleration[1000] = np.nan
    assert {issue.kind for issue in signal.quality_issues(force, acceleration, hammer.RATE)} >= {
        "not finite"
    }


def test_averages_agree_with_scipy() -> None:
    scipy_signal = pytest.importorskip("scipy.signal")
    noise = np.random.default_rng(7)
    force = noise.standard_normal((5, 4096))
    response = noise.standard_normal((5, 4096)) + force
    average = signal.FrfAverage(4096, 1e4)
    for f, x in zip(force, response, strict=True):
        own = average.push(f, x)
    np.testing.assert_allclose(own, np.fft.rfft(response[4]) / np.fft.rfft(force[4]), rtol=1e-9)
    assert average.averages == 5 and average.form == "accelerance"
    settings = {
        "fs": 1e4, "window": "boxcar", "nperseg": 4096, "noverlap": 0, "detrend": False,
    }
    f, x = force.ravel(), response.ravel()
    frequency, gfx = scipy_signal.csd(f, x, scaling="density", **settings)
    _, gff = scipy_signal.welch(f, scaling="density", **settings)
    _, gxx = scipy_signal.welch(x, scaling="density", **settings)
    _, coherence = scipy_signal.coherence(f, x, **settings)
    np.testing.assert_allclose(average.frequency_hz, frequency, rtol=1e-12)
    for ours, theirs in zip(average.spectra("power"), (gff, gxx, gfx), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-9)
    np.testing.assert_allclose(average.h1(), gfx / gff, rtol=1e-9)
    np.testing.assert_allclose(average.h2(), gxx / np.conj(gfx), rtol=1e-9)
    np.testing.assert_allclose(average.coherence(), coherence, rtol=1e-9)
    np.testing.assert_allclose(np.abs(average.hv()), np.sqrt(np.abs(gxx / gff)), rtol=1e-9)
    # Much noise on one side is H1, or H2.
    np.testing.assert_allclose(average.hv(1e8), average.h1(), rtol=1e-6)
    np.testing.assert_allclose(average.hv(1e-8), average.h2(), rtol=1e-6)
    magnitudes = np.abs(np.fft.rfft(response) / np.fft.rfft(force))
    mean, deviation = average.spread()
    np.testing.assert_allclose(mean, magnitudes.mean(axis=0), rtol=1e-9)
    np.testing.assert_allclose(deviation, magnitudes.std(axis=0, ddof=1), rtol=1e-9)
    # Bendat and Piersol, eq. 9.81.
    relative = np.sqrt((1 - coherence) / (2 * 5 * coherence))
    np.testing.assert_allclose(average.random_errors()[0][1:], relative[1:], rtol=1e-7)
    spectrum = np.sqrt((np.abs(np.fft.rfft(force)) ** 2).sum(axis=0))
    np.testing.assert_array_equal(average.valid(0.5), spectrum >= 0.5 * spectrum.max())


def receptance(average: signal.FrfAverage, values: Any) -> Any:
    """Functions of an average as receptances, in which pyFRF states them."""
    return signal.convert_frf(average.frequency_hz, values, average.form, "receptance")


def test_averages_agree_with_pyfrf() -> None:
    frf = pytest.importorskip("pyFRF").FRF
    force, acceleration = hammer.record((10.0, 12.0))
    other = frf(
        sampling_freq=int(hammer.RATE), exc_type="f", resp_type="a", window="none", fft_len=5000,
        weighting="linear",
    )
    average = signal.FrfAverage(5000, hammer.RATE)
    for hit in (slice(0, 5000), slice(5000, 10_000)):
        other.add_data(force[hit], acceleration[hit])
        average.push(force[hit], acceleration[hit])
    inside = slice(10, 1000)
    for ours, theirs in (
        (receptance(average, average.h1()), other.get_H1()),
        (receptance(average, average.h2()), other.get_H2()),
        (average.coherence(), other.get_coherence()),
    ):
        np.testing.assert_allclose(ours[inside], np.squeeze(theirs)[inside], rtol=1e-9)


def test_forms_are_quotients_and_their_reciprocals() -> None:
    frequency = np.linspace(100.0, 300.0, 41)
    w = 2 * np.pi * frequency
    values = mobility(frequency)
    for form, expected in {
        "receptance": values / (1j * w),
        "accelerance": values * 1j * w,
        "mechanical impedance": 1 / values,
        "dynamic stiffness": 1j * w / values,
        "apparent mass": 1 / (1j * w * values),
    }.items():
        np.testing.assert_allclose(
            signal.convert_frf(frequency, values, "mobility", form), expected, rtol=1e-12
        )
        back = signal.convert_frf(frequency, expected, form, "mobility")
        np.testing.assert_allclose(back, values, rtol=1e-12)


def test_one_mode_is_found_by_three_methods() -> None:
    force, displacement = impulse()
    response = signal.FrequencyResponse(force, displacement, RATE, "displacement")
    found = response.find_harmonics(190.0)
    assert found.fundamental is not None and found.second is None and found.ratio is None
    peak = found.fundamental
    assert peak.frequency_hz == pytest.approx(HZ * np.sqrt(1 - 2 * RATIO**2), rel=1e-5)
    assert peak.magnitude == pytest.approx(1 / (2 * RATIO * OMEGA * DAMPED), rel=1e-3)
    assert abs(peak.value) == pytest.approx(peak.magnitude) and 0 < peak.prominence <= 1
    assert "Hz" in repr(peak)
    half_power = response.half_power(peak)
    assert half_power is not None
    assert half_power.damping_ratio == pytest.approx(RATIO, abs=1e-5)
    assert half_power.lower_hz < peak.frequency_hz < half_power.upper_hz
    circle = response.circle_fit(peak)
    assert circle is not None
    assert circle.damping_ratio == pytest.approx(RATIO, abs=1e-5)
    assert circle.modal_constant_per_kg.real == pytest.approx(1.0, abs=1e-2)
    decrement = signal.logarithmic_decrement(displacement, RATE, HZ)
    assert decrement is not None
    assert decrement.damping_ratio == pytest.approx(RATIO, rel=1e-4)
    assert decrement.frequency_hz == pytest.approx(DAMPED / (2 * np.pi), rel=1e-5)
    dominant = response.dominant_frequency((100, 400), form="mobility")
    assert dominant == pytest.approx(HZ, rel=5e-3)
    np.testing.assert_allclose(
        response.receptance(np.array([peak.frequency_hz])), [peak.value], rtol=1e-12
    )
    # An average of one hit is that hit, between the lines too.
    average = signal.FrfAverage(20_000, RATE, "displacement")
    average.push(force, displacement)
    again = average.response("h1").find_harmonics(190.0).fundamental
    assert again is not None
    assert again.frequency_hz == pytest.approx(peak.frequency_hz, rel=1e-9)


def test_points_on_a_circle_are_fitted_exactly() -> None:
    frequency = np.linspace(195.0, 205.0, 21)
    for form in ("mobility", "receptance", "accelerance"):
        values = signal.convert_frf(frequency, mobility(frequency), "mobility", form)
        fit = signal.circle_fit(frequency, values, form)
        assert fit is not None
        assert fit.damping_ratio == pytest.approx(RATIO, abs=1e-9)
        assert fit.natural_frequency_hz == pytest.approx(HZ, rel=1e-9)
        assert fit.modal_constant_per_kg == pytest.approx(1.0, abs=1e-6)
    assert signal.circle_fit(frequency[:4], mobility(frequency[:4])) is None
    assert signal.circle_fit(frequency, np.full(21, np.nan)) is None


def test_a_linear_decay_has_one_frequency_and_damping() -> None:
    decay = np.exp(-0.01 * OMEGA * np.arange(8000) / RATE) * np.cos(OMEGA * np.arange(8000) / RATE)
    curve = signal.backbone(decay, RATE, (140.0, 260.0))
    assert curve.rows > 20
    np.testing.assert_allclose(curve["frequency_hz"], HZ, rtol=5e-4)
    np.testing.assert_allclose(curve["damping_ratio"], 0.01, atol=1e-3)
    assert np.all(np.diff(curve["amplitude"]) < 0)
    # Twice the derivative in time: the same damping, with the amplitude of the samples.
    faster = signal.backbone(-(OMEGA**2) * decay, RATE, (140.0, 260.0), response="acceleration")
    np.testing.assert_allclose(faster["damping_ratio"], 0.01, atol=1e-3)
    np.testing.assert_allclose(faster["amplitude"][0], OMEGA**2 * curve["amplitude"][0], rtol=2e-2)
    with pytest.raises(ValueError, match="acceleration"):
        signal.backbone(decay, RATE, (140.0, 260.0), response="force")


def test_windows_and_their_exact_correction() -> None:
    force, displacement = impulse(4000)
    window = signal.ExponentialWindow.falling_to(0.01, 0.2)
    assert window.tau_s == pytest.approx(0.2 / np.log(100))
    windowed = window.apply(displacement, RATE)
    np.testing.assert_allclose(
        windowed, displacement * np.exp(-np.arange(4000) / RATE / window.tau_s), rtol=1e-12
    )
    response = signal.FrequencyResponse(force, windowed, RATE, "displacement")
    peak = response.find_harmonics(190.0).fundamental
    assert peak is not None
    circle = response.circle_fit(peak)
    assert circle is not None
    mode = circle.natural_frequency_hz, circle.damping_ratio
    assert mode[1] > 1.5 * RATIO
    assert window.corrected_damping_ratio(*mode) == pytest.approx(RATIO, rel=1e-3)
    assert window.corrected_natural_frequency_hz(*mode) == pytest.approx(HZ, rel=1e-4)
    assert window.corrected_peak_frequency_hz(*mode, peak.frequency_hz) == pytest.approx(
        HZ * np.sqrt(1 - 2 * RATIO**2), rel=1e-4
    )
    assert window.corrected_peak_magnitude(*mode, peak.magnitude) == pytest.approx(
        1 / (2 * RATIO * OMEGA * DAMPED), rel=1e-3
    )
    # Divided by (i w)^2 in place of (i w + 1/tau)^2.
    frequency = np.array([50.0, 200.0])
    s = 2j * np.pi * frequency
    corrected = window.corrected_receptance(frequency, [1.0, 1j], "acceleration")
    np.testing.assert_allclose(
        corrected, np.array([1.0, 1j]) * (s / (s + 1 / window.tau_s)) ** 2, rtol=1e-12
    )
    noisy, _ = hammer.record((10.0,))
    around = signal.ForceWindow.around(noisy, hammer.RATE)
    kept = around.apply(noisy, hammer.RATE)
    assert not kept[:200].any() and not kept[300:].any()
    np.testing.assert_array_equal(kept[250:261], noisy[250:261])
    flat = signal.ResponseWindow(2e-3, 2e-3).apply([1.0, -1.0, 1.0, -1.0, 1.0], 1e3)
    np.testing.assert_allclose(flat, [1.0, -1.0, 1.0, -0.5, 0.0], atol=1e-12)
    t = np.arange(40_000) / RATE
    ring = np.exp(-20.0 * t) * np.sin(OMEGA * t)
    ring += 1e-4 * np.random.default_rng(3).standard_normal(len(t))
    end = signal.ResponseWindow.until_noise(
        ring, RATE, frequency_hz=HZ, noise_density=2e-8 / RATE
    )
    assert end is not None and 0.2 < end.end_s < 1.5
    silent = signal.ResponseWindow.until_noise(
        ring[:4000], RATE, frequency_hz=HZ, noise_density=1e-20
    )
    assert silent is None


BAD_ARRAYS: list[tuple[Any, type[Exception], str]] = [
    (None, ValueError, "dimension"),
    ("abc", ValueError, "dimension"),
    (3.0, ValueError, "dimension"),
    (object(), ValueError, "dimension"),
    (np.zeros((3, 3)), ValueError, "dimension"),
    ([[1.0], [1.0, 2.0]], ValueError, "array"),
    (["a", "b"], TypeError, "real"),
    (np.array([1 + 1j] * 40), TypeError, "real"),
    (np.array([None] * 40), TypeError, "real"),
    (np.array(["2020-01-01"] * 40, dtype="datetime64[D]"), TypeError, "real"),
    (np.array([True] * 40), TypeError, "real"),
    (np.zeros(40, dtype=[("a", "f8")]), TypeError, "real"),
]


@pytest.mark.parametrize(("samples", "error", "words"), BAD_ARRAYS)
def test_arrays_that_hold_no_samples_are_errors_in_words(
    samples: Any, error: type[Exception], words: str
) -> None:
    good = np.ones(40)
    calls: list[Callable[[], object]] = [
        lambda: signal.find_hits(samples, (), 100.0),
        lambda: signal.quality_issues(samples, good, 100.0),
        lambda: signal.pulse(samples, 100.0),
        lambda: signal.FrequencyResponse(samples, good, 100.0),
        lambda: signal.FrequencyResponse(good, samples, 100.0),
        lambda: signal.FrfAverage(40, 100.0).push(samples, good),
        lambda: signal.logarithmic_decrement(samples, 100.0, 10.0),
        lambda: signal.backbone(samples, 100.0, (5.0, 10.0)),
        lambda: signal.ForceWindow(0.0, 1.0).apply(samples, 100.0),
        lambda: signal.ResponseWindow(0.0, 1.0).apply(samples, 100.0),
        lambda: signal.ExponentialWindow(1.0).apply(samples, 100.0),
        lambda: signal.circle_fit(samples, good),
    ]
    for call in calls:
        with pytest.raises(error, match=words):
            call()


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan, np.inf])
def test_rates_that_are_none_are_errors(rate: float) -> None:
    good = np.sin(np.arange(400.0))
    calls: list[Callable[[], object]] = [
        lambda: signal.find_hits(good, (), rate),
        lambda: signal.quality_issues(good, good, rate),
        lambda: signal.pulse(good, rate),
        lambda: signal.FrequencyResponse(good, good, rate),
        lambda: signal.FrfAverage(400, rate),
        lambda: signal.logarithmic_decrement(good, rate, 10.0),
        lambda: signal.backbone(good, rate, (5.0, 10.0)),
        lambda: signal.ForceWindow(0.0, 1.0).apply(good, rate),
        lambda: signal.ExponentialWindow(1.0).apply(good, rate),
    ]
    for call in calls:
        with pytest.raises(ValueError, match="positive|above|accepted"):
            call()


def test_options_out_of_range_are_errors_in_words() -> None:
    good = np.sin(np.arange(400.0))
    response = signal.FrequencyResponse(good, good, 100.0)
    average = signal.FrfAverage(400, 100.0)
    calls: list[tuple[Callable[[], object], type[Exception], str]] = [
        (lambda: signal.FrfAverage(0, 100.0), ValueError, "no samples"),
        (lambda: signal.FrfAverage(-1, 100.0), ValueError, "0 and above"),
        (lambda: signal.FrfAverage(2**60, 100.0), ValueError, "at most"),
        (lambda: signal.FrfAverage(400, 100.0, padding=0), ValueError, "padding"),
        (lambda: signal.FrfAverage(400, 100.0, "force"), ValueError, "acceleration"),
        (lambda: signal.FrfAverage(400, "fast"), TypeError, "a number"),  # type: ignore[arg-type]
        (lambda: average.h1(), ValueError, "averages"),
        (lambda: average.coherence(), ValueError, "averages"),
        (lambda: average.push(good, good[:10]), ValueError, "equal"),
        (lambda: average.push(np.zeros(400), good), ValueError, "zero"),
        (lambda: average.push(np.ones(500), np.ones(500)), ValueError, "at most"),
        (lambda: average.push([], []), ValueError, "no samples"),
        (lambda: average.push([np.nan], [1.0]), ValueError, "finite"),
        (lambda: average.spectra("amplitude"), ValueError, "power"),
        (lambda: average.response("h4"), ValueError, "h1"),
        (lambda: signal.FrequencyResponse([], [], 100.0), ValueError, "no samples"),
        (lambda: response.half_power(3), TypeError, "Peak"),  # type: ignore[arg-type]
        (lambda: response.find_harmonics("x"), TypeError, "a number"),  # type: ignore[arg-type]
        (lambda: response.dominant_frequency(3), ValueError, "two numbers"),  # type: ignore[arg-type]
        (lambda: signal.convert_frf([1.0], [1.0, 2.0], "mobility", "receptance"), ValueError, "equal"),
        (lambda: signal.convert_frf([1.0], [1.0], "mobility", "stiffness"), ValueError, "accepted"),
        (lambda: signal.backbone(good, 100.0, (10.0, 5.0)), ValueError, "band"),
        (lambda: signal.backbone(good, 100.0, (5.0, 90.0)), ValueError, "band|rate"),
        (lambda: signal.backbone(good, 100.0, (5.0, 10.0), cycles=0), ValueError, "cycles"),
        (lambda: signal.backbone([], 100.0, (5.0, 10.0)), ValueError, "no samples"),
        (lambda: signal.ExponentialWindow(-1.0).apply(good, 100.0), ValueError, "positive"),
        (lambda: signal.ExponentialWindow.falling_to(2.0, 1.0), ValueError, "positive"),
        (lambda: signal.find_hits(good, good[:3], 100.0), ValueError, "equal"),
        (lambda: signal.find_hits(np.zeros(100), (), 100.0), ValueError, "noise"),
        (lambda: signal.find_hits(good, (), 100.0, level_n=-1), ValueError, "positive"),
        (lambda: signal.find_hits(good, (), 100.0, level_fraction=2), ValueError, "at most 1"),
        (lambda: signal.find_hits(good, (), 100.0, level_n=1, level_fraction=1), ValueError, "exclude"),
        (lambda: signal.find_hits(good, (), 100.0, level_n=0.5, length_s=0), ValueError, "longer"),
        (lambda: signal.find_hits(good, (), 100.0, level_n=0.5, hold_off_s=0), ValueError, "longer"),
        (lambda: signal.ForceWindow.around(np.zeros(10), 100.0), ValueError, "no pulse"),
    ]
    for call, error, words in calls:
        with pytest.raises(error, match=words):
            call()
    assert average.averages == 0


def test_samples_of_any_layout_are_the_same() -> None:
    force, displacement = impulse(4000)
    expected = signal.FrfAverage(4000, RATE).push(force, displacement)
    read_only = displacement.copy()
    read_only.flags.writeable = False
    for other in (
        displacement.astype(">f8"),
        np.repeat(displacement, 2)[::2],
        displacement[::-1].copy()[::-1],
        np.asfortranarray(np.stack([displacement, force]))[0],
        read_only,
        displacement.tolist(),
    ):
        np.testing.assert_array_equal(signal.FrfAverage(4000, RATE).push(force, other), expected)


def test_threads_may_share_an_average() -> None:
    force, displacement = impulse(4000)
    average = signal.FrfAverage(4000, RATE)

    def push() -> None:
        for _ in range(20):
            average.push(force, displacement)
            average.h1()

    threads = [threading.Thread(target=push) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert average.averages == 80
    alone = signal.FrfAverage(4000, RATE)
    alone.push(force, displacement)
    np.testing.assert_allclose(average.h1(), alone.h1(), rtol=1e-12)


def test_the_toolbox_is_part_of_the_package() -> None:
    assert asperity.signal is signal
    assert all(getattr(signal, name).__doc__ for name in signal.__all__)


def test_native_objects_are_copied_pickled_and_compared() -> None:
    force, acceleration = hammer.record()
    samples = round(hammer.RATE)
    hits = [slice(number * samples, (number + 1) * samples) for number in range(3)]
    average = signal.FrfAverage(samples, hammer.RATE)
    for hit in hits[:2]:
        average.push(force[hit], acceleration[hit])
    same = pickle.loads(pickle.dumps(average))
    assert same == average == copy.deepcopy(average)
    # Each has sums of its own.
    same.push(force[hits[2]], acceleration[hits[2]])
    assert (same.averages, average.averages) == (3, 2) and same != average
    average.push(force[hits[2]], acceleration[hits[2]])
    assert same == average
    np.testing.assert_array_equal(same.spread(), average.spread())
    for response in (average.response(), signal.FrequencyResponse(force, acceleration, hammer.RATE)):
        again = pickle.loads(pickle.dumps(response))
        assert again == response
        np.testing.assert_array_equal(again.receptance([99.0, 100.0]), response.receptance([99.0, 100.0]))
    peak = average.response().find_harmonics(100.0).fundamental
    assert peak is not None
    assert pickle.loads(pickle.dumps(peak)) == peak and hash(copy.copy(peak)) == hash(peak)
    assert peak != average.response() and average != peak
