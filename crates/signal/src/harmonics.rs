//! The fundamental and the second harmonic of a hit.

use crate::peak::{Peak, PowerGrid, refine};
use crate::response::FrequencyResponse;
use crate::spectra::{COVERED, HitSpectra, Ripples};

/// Window of the second harmonic over the fundamental, of simulated and of measured hits.
///
/// The frequency of a contact changes along the decay, and zeros of the force move the peaks beside them,
/// so the second harmonic is not at exactly twice the fundamental. Of 236 simulated hits (gamma pulses, half
/// sines and haversines of 0.5 to 250 N, six structures, damping ratios of 0.01 to 0.06) 166 have a peak
/// between 1.5 and 2.3 of f1. All 103 that keep contact have the largest at 1.717 to 2.231 of f1. Of the 63
/// that lose contact 48 have it above 1.74, and 15 at 1.506 to 1.665: the harmonic of order 3/2, which is
/// not the second. The band is also that of [`HarmonicTest`](crate::HarmonicTest), which tells a harmonic
/// from a mode along the decay.
pub const SECOND_HARMONIC_WINDOW: (f64, f64) = (1.7, 2.3);

/// Options of [`find_harmonics`].
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicOptions {
    /// Window of the fundamental, over the static frequency.
    pub fundamental_window: (f64, f64),
    /// Window of the second harmonic, over the fundamental found; [`SECOND_HARMONIC_WINDOW`] by default.
    pub second_window: (f64, f64),
    /// Zero padding of the grid on which maxima are detected, at least 2.
    ///
    /// The resolution of a rectangular window is `1 / T`, so a padding of 4 gives several points to
    /// every maximum.
    pub padding: usize,
    /// Smallest height of a peak above the higher minimum beside it, over its magnitude.
    ///
    /// The default 1e-3 (0.01 dB) is far below any peak visible in
    /// a measured curve and far above the errors of the grid.
    pub minimum_prominence: f64,
    /// Smallest height above the minimum in units of the window's leakage.
    ///
    /// A record that has not decayed ends in a step `x_end`, whose transform
    /// adds ripples of amplitude `x_end / (2 pi f)`, times up to 1.8 above 1.5
    /// times the fundamental, and of spacing `1 / T`. Beside the frequency f0 at which the response is largest, from a distance
    /// of `1 / T` on, they are taken to be larger, `max(f, f0) f / |f0^2 - f^2|` times.
    /// The default 4 just exceeds their height from trough to crest where the force is as strong at both; a minimum where it
    /// is weaker counts as higher by half of what its ripples are larger.
    /// `x_end` is the size of the slow motion in the last period; motion far above the frequency counts by its integral.
    /// A record that has decayed is not affected.
    pub leakage_margin: f64,
    /// Smallest magnitude of the force's transform at a peak, over its largest from zero to the end
    /// of the search.
    ///
    /// Maxima below it are masked, see [`ForceMask`](crate::ForceMask). The
    /// default 0.02 keeps the whole main lobe of a hammer pulse.
    pub force_threshold: f64,
}

impl Default for HarmonicOptions {
    fn default() -> Self {
        Self {
            fundamental_window: (0.4, 1.4),
            second_window: SECOND_HARMONIC_WINDOW,
            padding: 4,
            minimum_prominence: 1e-3,
            leakage_margin: 4.0,
            force_threshold: 0.02,
        }
    }
}

/// The fundamental and the second harmonic, found by [`find_harmonics`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Harmonics {
    /// The fundamental: the largest peak in its window.
    pub fundamental: Option<Peak>,
    /// The second harmonic: the largest peak in its window; `None` for a shoulder.
    pub second: Option<Peak>,
    /// Frequencies (Hz) of maxima in either window where the force is too weak.
    pub masked_hz: Vec<f64>,
    /// Frequencies (Hz) of maxima, of those no lower than the peak in either window, that a slightly longer record or pulse may
    /// decide otherwise about: whose height is within 10 % of the least that tells a peak from ripples; where the force is within
    /// 10 % of too weak; and maxima that are lower than the fundamental by less than 0.3 %.
    pub marginal_hz: Vec<f64>,
    /// Frequency (Hz) in the window of the fundamental at which the response itself is largest, if the force is too weak for a
    /// maximum there and the fundamental found is another: it need not be the resonance.
    pub hidden_hz: Option<f64>,
}

impl Harmonics {
    /// The second-harmonic ratio `A2/A1 = |H(f2)| / |H(f1)|`, if both peaks exist.
    ///
    /// A ratio of receptances \[m/N\], not of displacement amplitudes: each displacement is divided
    /// by the force at its own frequency. Limiting case: as the force tends to zero the ratio tends
    /// to that of the linear system, not to zero; one mode of damping ratio `zeta` has
    /// `|H(2 f1)| / |H(f1)|` of about `2 zeta / 3`.
    pub fn ratio(&self) -> Option<f64> {
        Some(self.second?.magnitude / self.fundamental?.magnitude)
    }
}

/// Finds the fundamental and the second harmonic in the receptance of a hit.
///
/// Each is the largest local maximum of `|H|` in its window that is prominent enough
/// ([`HarmonicOptions::minimum_prominence`], [`HarmonicOptions::leakage_margin`])
/// and excited by the force ([`HarmonicOptions::force_threshold`]). Maxima
/// are detected on a zero-padded grid and refined on the exact transform, as roots
/// of `d|H|^2/df`, to 1e-9 of their frequency or better. A shoulder, or a value
/// that only rises towards a limit of the window, is not a peak.
///
/// - `static_frequency_hz`: expected fundamental, in hertz; nothing is found unless it is positive
///   and finite.
///
/// Limiting case: a linear oscillator of natural frequency `f0` has its
/// fundamental at `f0 sqrt(1 - 2 zeta^2)` and no second harmonic.
///
/// ```
/// use asperity_signal::{FrequencyResponse, HarmonicOptions, find_harmonics};
///
/// // Impulse response with a fundamental at 200 Hz and half of it at 400 Hz.
/// let rate = 2e4;
/// let sine = |f: f64, t: f64| (std::f64::consts::TAU * f * t).sin();
/// let displacement: Vec<f64> = (0..10_000)
///     .map(|n| f64::from(n) / rate)
///     .map(|t| 1e-6 * (-40.0 * t).exp() * (sine(200.0, t) + 0.5 * sine(400.0, t)))
///     .collect();
/// let mut force = vec![0.0; displacement.len()];
/// force[0] = 10.0;
/// let hit = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
/// let found = find_harmonics(&hit, 190.0, &HarmonicOptions::default());
/// let second = found.second.ok_or("a second harmonic")?;
/// assert!((second.frequency_hz - 400.0).abs() < 2.0);
/// assert!((found.ratio().ok_or("and a ratio")? - 0.5).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find_harmonics(
    response: &FrequencyResponse,
    static_frequency_hz: f64,
    options: &HarmonicOptions,
) -> Harmonics {
    harmonics_of(response, static_frequency_hz, options)
}

/// [`find_harmonics`] of any spectra of a hit.
pub(crate) fn harmonics_of(
    response: &impl HitSpectra,
    static_frequency_hz: f64,
    options: &HarmonicOptions,
) -> Harmonics {
    let mut found = Harmonics::default();
    if !(static_frequency_hz.is_finite() && static_frequency_hz > 0.0) {
        return found;
    }
    let scaled = |(low, high): (f64, f64), by: f64| (low * by, high * by);
    let window = scaled(options.fundamental_window, static_frequency_hz);
    let top = window.1 * options.second_window.1.max(1.0);
    let search = HarmonicSearch::new(response, (window.0, top), options);

    let (fundamental, equals) = search.largest(window, 1.0 / static_frequency_hz, &mut found);
    found.fundamental = fundamental;
    // That of a second harmonic is one magnitude with any of them.
    found.marginal_hz.extend(equals);
    if let Some(first) = found.fundamental {
        found.hidden_hz = search.hidden(window, first, &found.masked_hz);
        let window = scaled(options.second_window, first.frequency_hz);
        (found.second, _) = search.largest(window, 1.0 / first.frequency_hz, &mut found);
    }
    found
}

/// The second harmonic of a fundamental of a known frequency (Hz), as in [`find_harmonics`].
pub(crate) fn second_harmonic(
    response: &impl HitSpectra,
    fundamental_hz: f64,
    options: &HarmonicOptions,
) -> Option<Peak> {
    let (low, high) = options.second_window;
    let window = (low * fundamental_hz, high * fundamental_hz);
    // The strength of the force is compared with its largest from the fundamental on, where the response is largest.
    let band = (fundamental_hz.min(window.0), window.1);
    let oscillation_hz = Some(fundamental_hz);
    let search = HarmonicSearch { oscillation_hz, ..HarmonicSearch::new(response, band, options) };
    search.largest(window, 1.0 / fundamental_hz, &mut Harmonics::default()).0
}

/// All admissible peaks in a band (Hz), in the order of frequency, as [`find_harmonics`] admits them.
pub(crate) fn peaks_within(
    response: &impl HitSpectra,
    band: (f64, f64),
    options: &HarmonicOptions,
) -> Vec<Peak> {
    let search = HarmonicSearch::new(response, band, options);
    let maxima = search.grid.maxima(band);
    let peak = |index| {
        let ripples = response.ripples(1.0 / search.grid.frequency(index));
        search.peak(index, band, &ripples, &mut Harmonics::default())
    };
    maxima.into_iter().filter_map(peak).collect()
}

/// Ripples of a record that ends in an oscillation of frequency f0, over those far above it, where they are
/// `x_end / w`; the margin covers 1.8 of it:
///
/// ```text
/// x_end max(w, w0) / |w0^2 - w^2|
/// ```
fn leakage_beside(oscillation_hz: f64, frequency_hz: f64) -> f64 {
    let (f0, f) = (oscillation_hz, frequency_hz);
    f.max(f0) * f / ((f0 * f0 - f * f).abs() * COVERED)
}

/// Relative distance of a height from the least one within which its minima are found exactly, at least.
const NEAR: f64 = 0.25;

/// Relative distance of a height, and of the force, from the least one up to which a maximum is marginal.
const MARGINAL: f64 = 0.1;

/// Magnitude of a maximum over that on the grid at most, unless it is narrower than a step of it.
const BETWEEN: f64 = 1.1;

/// Relative difference of two maxima up to which either may be the largest, three times the usual accuracy of a response.
const EQUAL: f64 = 3e-3;

/// The search in the receptance on a grid over both windows.
struct HarmonicSearch<'a, R> {
    response: &'a R,
    options: &'a HarmonicOptions,
    grid: PowerGrid,
    /// Frequency of the largest oscillation of the response.
    oscillation_hz: Option<f64>,
    /// Distance from it of the next zero of the transform of a lasting one.
    lobe_hz: f64,
}

impl<'a, R: HitSpectra> HarmonicSearch<'a, R> {
    fn new(response: &'a R, (low, high): (f64, f64), options: &'a HarmonicOptions) -> Self {
        let band = response.band(options.padding.max(2), high);
        let grid = PowerGrid::of(&band, response.kind(), low, options.force_threshold);
        let oscillation_hz = grid.oscillation_hz();
        Self { response, options, grid, oscillation_hz, lobe_hz: 1.0 / band.duration }
    }

    /// The largest admissible peak in a window, and the frequencies (Hz) of lower maxima that equal it; those of masked and
    /// marginal maxima are added to those of `found`.
    fn largest(
        &self,
        window: (f64, f64),
        period: f64,
        found: &mut Harmonics,
    ) -> (Option<Peak>, Vec<f64>) {
        let mut maxima = self.grid.maxima(window);
        if maxima.is_empty() {
            return (None, Vec::new());
        }
        let ripples = self.response.ripples(period);
        maxima.sort_by(|&a, &b| self.grid.heights[b].total_cmp(&self.grid.heights[a]));
        let mut maxima = maxima.into_iter();
        let first = maxima.find_map(|index| self.peak(index, window, &ripples, found));
        let Some(mut largest) = first else { return (None, Vec::new()) };
        let mut near_it = Vec::new();
        // The order on the grid need not be that of the maxima between its points.
        let near = |index: &usize| self.grid.heights[*index].sqrt() * BETWEEN >= largest.magnitude;
        for index in maxima.take_while(near).collect::<Vec<_>>() {
            let refined = refine(self.response, &self.grid, index);
            let Some(other_hz) = refined.filter(|f| window.0 < *f && *f < window.1) else {
                continue;
            };
            let magnitude = self.response.receptance_at(other_hz).norm();
            let is_strong = self.response.force_magnitude(other_hz) >= self.grid.force_floor;
            if !is_strong || magnitude <= (1.0 - EQUAL) * largest.magnitude {
                continue;
            }
            // Of two equal maxima the lower one may be no more than a ripple beside the other.
            let mut with_other = found.clone();
            let other = self.peak(index, window, &ripples, &mut with_other);
            let other = other.filter(|other| other.magnitude > largest.magnitude);
            near_it.push((other_hz, magnitude));
            if let Some(other) = other {
                *found = with_other;
                near_it.push((largest.frequency_hz, largest.magnitude));
                largest = other;
            }
        }
        let is_equal = |(frequency, magnitude): (f64, f64)| {
            let is_other = frequency != largest.frequency_hz;
            (is_other && magnitude > (1.0 - EQUAL) * largest.magnitude).then_some(frequency)
        };
        let equals = near_it.into_iter().filter_map(is_equal).collect();
        (Some(largest), equals)
    }

    /// The largest oscillation in a window, if it is another than a peak and larger, and one of these masked maxima is there.
    fn hidden(&self, (low, high): (f64, f64), peak: Peak, masked_hz: &[f64]) -> Option<f64> {
        let oscillation = self.oscillation_hz.filter(|hz| low < *hz && *hz < high)?;
        let is_there = |hz: f64| (hz - oscillation).abs() < self.lobe_hz;
        let is_masked = masked_hz.iter().any(|&hz| is_there(hz));
        let motion = |hz: f64, receptance: f64| receptance * self.response.force_magnitude(hz);
        let largest = motion(oscillation, self.response.receptance_at(oscillation).norm());
        let is_larger = largest > motion(peak.frequency_hz, peak.magnitude);
        (is_masked && is_larger && !is_there(peak.frequency_hz)).then_some(oscillation)
    }

    fn peak(
        &self,
        index: usize,
        (low, high): (f64, f64),
        ripples: &Ripples,
        Harmonics { masked_hz, marginal_hz, .. }: &mut Harmonics,
    ) -> Option<Peak> {
        let on_grid = self.grid.heights[index].sqrt();
        let saddle = self.grid.saddle(index);
        // Ripples are rejected before the costly refinement, at half the prominence required since
        // the maximum lies above its grid point.
        if on_grid - saddle < 0.5 * self.options.minimum_prominence * on_grid {
            return None;
        }
        // Beside a zero of the force it may be weak at the point of the grid and not at the maximum.
        let refined = refine(self.response, &self.grid, index);
        let frequency_hz = refined.unwrap_or_else(|| self.grid.frequency(index));
        if !(low < frequency_hz && frequency_hz < high) {
            return None;
        }
        let (force, floor) = (self.response.force_magnitude(frequency_hz), self.grid.force_floor);
        let is_weak = force < floor;
        let is_near_floor = (force - floor).abs() < MARGINAL * floor;
        if is_weak {
            masked_hz.push(frequency_hz);
        }
        if refined.is_none() || (is_weak && !is_near_floor) {
            return None;
        }
        let value = self.response.receptance_at(frequency_hz);
        let magnitude = value.norm();
        let is_beside = |other: &f64| (frequency_hz - other).abs() >= self.lobe_hz;
        let oscillation = self.oscillation_hz.filter(is_beside);
        let beside = oscillation.map_or(1.0, |other| leakage_beside(other, frequency_hz).max(1.0));
        let ripple = ripples.at(frequency_hz, force);
        let leak = self.options.leakage_margin * ripple.leakage * beside;
        let least = (self.options.minimum_prominence * magnitude).max(leak).max(ripple.rounding);
        // Half of the least height is for the ripple at the maximum, and half for that at a minimum, which is
        // larger where the force is weaker: beside a zero of it a deep minimum tells nothing.
        let order = 1 + self.response.kind().derivatives();
        let further = |other_hz: f64, other_force: f64| {
            let ratio = (frequency_hz / other_hz).powi(order) * force / other_force;
            if leak > 0.0 { 0.5 * leak * (ratio - 1.0) } else { 0.0 }
        };
        let mut height = magnitude - self.grid.saddle_above(index, &further);
        // Beside a zero of the force minima lie deep between the points of the grid, and the height may be any up to this.
        let most = if beside > 1.0 { magnitude } else { height };
        // No minimum is higher than its point of the grid. Where they decide, they are found exactly.
        let sure = magnitude - self.grid.saddle_above_points(index, &further);
        let near = NEAR * least;
        if (sure.min(height - near)..most + near).contains(&least) {
            height = magnitude - self.grid.exact_saddle_above(self.response, index, &further);
        }
        let is_by_ripples = least > self.options.minimum_prominence * magnitude;
        let is_hardly_higher = is_by_ripples && (height - least).abs() < MARGINAL * least;
        let is_high = height >= least;
        // Beyond a zero of the force there is another resonance, or this is a ripple on the flank of its pole.
        let is_on_flank = magnitude - self.grid.saddle_to_poles(index, &further) < least;
        if is_hardly_higher || (is_high && (is_near_floor || is_on_flank)) {
            marginal_hz.push(frequency_hz);
        }
        (is_high && !is_weak).then_some(Peak {
            frequency_hz,
            magnitude,
            value,
            prominence: 1.0 - saddle / magnitude,
        })
    }
}
