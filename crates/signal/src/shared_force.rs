//! Harmonics and damping of many hits under forces of one shape.

use std::borrow::Cow;
use std::f64::consts::TAU;

use asperity_transform::{fast_length, forward};
use num_complex::Complex64;

use crate::damping::{STEP, half_power_of};
use crate::form::ResponseKind;
use crate::harmonics::{HarmonicOptions, harmonics_of};
use crate::receptance_features::ReceptanceFeatures;
use crate::spectra::{BandSpectra, HitSpectra, Ripples, UnfilteredEnd};
use crate::transform::transform_at;

/// Zero padding of the grid of transforms.
const PADDING: usize = 3;

/// Points of the interpolation between grid frequencies.
const POINTS: usize = 10;

/// Largest accepted relative error of the interpolated `|H|` beside the fundamental.
const ACCEPTED: f64 = 1e-6;

/// The analysis of many hits whose forces are one time history times a factor.
///
/// The transform of the force is computed once. The transform of each response
/// is computed on a grid by one short FFT about the centre of its energy, where it varies slowly
/// from point to point; peaks and half-power crossings are found on its interpolation, which is
/// verified against the exact transform beside the fundamental, or beside the static frequency where there is none, midway
/// between two points. Intended for records decimated by a [`DecimationFilter`](crate::DecimationFilter) to the band of
/// interest.
///
/// The results equal the results of [`find_harmonics`](crate::find_harmonics) and
/// [`half_power`](crate::half_power) to 1e-6.
///
/// ```
/// use asperity_signal::{HarmonicOptions, SharedForce};
///
/// let (rate, omega, zeta) = (1e4, std::f64::consts::TAU * 800.0, 0.03);
/// let mut force = vec![0.0; 2000];
/// force[0] = rate;
/// let shared = SharedForce::new(&force, rate, 2500.0).ok_or("a force with content")?;
/// for factor in [1.0, 2.0] {
///     let displacement: Vec<f64> = (0..2000)
///         .map(|n| f64::from(n) / rate)
///         .map(|t| factor * 1e-6 * (-zeta * omega * t).exp() * (omega * t).sin())
///         .collect();
///     let features = shared
///         .analyse((&displacement, None), factor, 800.0, &HarmonicOptions::default())
///         .ok_or("a record that has decayed")?;
///     let ratio = features.damping_ratio().ok_or("a peak with a width")?;
///     assert!((ratio - zeta).abs() < 1e-3);
/// }
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone)]
pub struct SharedForce {
    rate: f64,
    samples: Vec<f64>,
    /// Points of the transforms.
    length: usize,
    force: CentredTransform,
    keep: usize,
}

impl SharedForce {
    /// The analysis for a time history `force` \[N\] of unit factor, sampled at `sample_rate_hz`, and
    /// peaks up to `high` (Hz); `None` if the force is zero or an argument is not finite.
    pub fn new(force: &[f64], sample_rate_hz: f64, high: f64) -> Option<Self> {
        let finite = force.iter().all(|sample| sample.is_finite());
        if !(finite && sample_rate_hz.is_finite() && sample_rate_hz > 0.0 && high > 0.0) {
            return None;
        }
        let length = fast_length(PADDING * force.len().max(POINTS));
        let step = sample_rate_hz / length as f64;
        let keep = ((high / step).ceil() as usize).saturating_add(POINTS).min(length / 2 + 1);
        let force_transform = CentredTransform::of(force, 1.0 / sample_rate_hz, length, keep)?;
        Some(Self {
            rate: sample_rate_hz,
            samples: force.to_vec(),
            length,
            force: force_transform,
            keep,
        })
    }

    /// The fundamental near `static_frequency_hz`, its second harmonic and its damping, from a
    /// `displacement` \[m\] under `factor` times the force, and the end of its motion before a filter. `None` if the
    /// interpolation is not accurate enough, as for a record that has not decayed; use the exact analysis then.
    pub fn analyse(
        &self,
        (displacement, end): (&[f64], Option<UnfilteredEnd<'_>>),
        factor: f64,
        static_frequency_hz: f64,
        options: &HarmonicOptions,
    ) -> Option<ReceptanceFeatures> {
        if displacement.len() != self.samples.len() || factor == 0.0 {
            return None;
        }
        // Normalised to a factor of one.
        let scale = 1.0 / (self.rate * factor);
        let response = CentredTransform::of(displacement, scale, self.length, self.keep)?;
        let hit = SharedHit { shared: self, displacement, end, response, factor };
        let harmonics = harmonics_of(&hit, static_frequency_hz, options);
        let f = harmonics.fundamental.map_or(static_frequency_hz, |first| first.frequency_hz);
        // Between two points of the grid, at which it is exact.
        let between = ((f / hit.step()).floor() + 0.5) * hit.step();
        let exact = transform_at(displacement, self.rate, between).norm()
            / (transform_at(&self.samples, self.rate, between).norm() * factor.abs());
        let off = (hit.power(between).sqrt() / exact - 1.0).abs();
        if off.is_nan() || off > ACCEPTED {
            return None;
        }
        if harmonics.fundamental.is_none() {
            return Some(ReceptanceFeatures { harmonics, ..ReceptanceFeatures::default() });
        }
        let power = |frequency| hit.power(frequency);
        let step = STEP * self.rate / displacement.len() as f64;
        let highest = (self.keep - POINTS) as f64 * hit.step();
        let half_power = half_power_of(power, f, step, highest);
        Some(ReceptanceFeatures { harmonics, half_power, ..ReceptanceFeatures::default() })
    }
}

/// A transform on a grid of frequencies, about the centre of the signal's energy.
#[derive(Debug, Clone)]
struct CentredTransform {
    values: Vec<Complex64>,
    /// Grid spacing in cycles a sample, and the index of the sample at time zero.
    cycles: f64,
    centre: f64,
}

impl CentredTransform {
    /// The transform of `length` points times `scale`, up to point `keep`.
    fn of(samples: &[f64], scale: f64, length: usize, keep: usize) -> Option<Self> {
        let (mut energy, mut moment) = (0.0, 0.0);
        for (n, sample) in samples.iter().enumerate() {
            energy += sample * sample;
            moment += n as f64 * (sample * sample);
        }
        if !(energy > 0.0 && energy.is_finite()) {
            return None;
        }
        let centre = (moment / energy).round() as usize;
        let mut padded = vec![0.0; length];
        padded[..samples.len() - centre].copy_from_slice(&samples[centre..]);
        padded[length - centre..].copy_from_slice(&samples[..centre]);
        let mut values = forward(padded);
        values.truncate(keep);
        for value in &mut values {
            *value *= scale;
        }
        Some(Self { values, cycles: 1.0 / length as f64, centre: centre as f64 })
    }

    /// Value, and derivative with respect to the position on the grid, by the polynomial of
    /// `stencil`.
    fn at(&self, stencil: &PolynomialStencil) -> (Complex64, Complex64) {
        let Some(values) = self.values.get(stencil.first..stencil.first + POINTS) else {
            return (Complex64::new(f64::NAN, 0.0), Complex64::new(f64::NAN, 0.0));
        };
        let (mut value, mut slope) = (Complex64::ZERO, Complex64::ZERO);
        for (point, (weight, weight_slope)) in values.iter().zip(&stencil.weights) {
            value += point * weight;
            slope += point * weight_slope;
        }
        (value, slope)
    }
}

/// Weights of the grid points around a position in the polynomial through them, and their
/// derivatives with respect to the position.
struct PolynomialStencil {
    first: usize,
    weights: [(f64, f64); POINTS],
}

impl PolynomialStencil {
    fn at(position: f64, count: usize) -> Self {
        let last = count.saturating_sub(POINTS);
        let first = (position as usize).saturating_sub(POINTS / 2 - 1).min(last);
        let u = position - first as f64;
        // Products of (u - m) from below and from above, with their derivatives.
        let mut below = [(1.0, 0.0); POINTS + 1];
        let mut above = [(1.0, 0.0); POINTS + 1];
        for m in 0..POINTS {
            let (value, slope): (f64, f64) = below[m];
            let factor = u - m as f64;
            below[m + 1] = (value * factor, slope * factor + value);
            let n = POINTS - 1 - m;
            let (value, slope): (f64, f64) = above[n + 1];
            let factor = u - n as f64;
            above[n] = (value * factor, slope * factor + value);
        }
        let weights = std::array::from_fn(|j| {
            let ((low, low_slope), (high, high_slope)) = (below[j], above[j + 1]);
            (NORMS[j] * low * high, NORMS[j] * (low_slope * high + low * high_slope))
        });
        Self { first, weights }
    }
}

/// `1 / product of (j - m)` over the other points m.
const NORMS: [f64; POINTS] = {
    let mut norms = [1.0; POINTS];
    let mut j = 0;
    while j < POINTS {
        let mut m = 0;
        while m < POINTS {
            if m != j {
                norms[j] /= j as f64 - m as f64;
            }
            m += 1;
        }
        j += 1;
    }
    norms
};

/// One hit under the shared force, its response divided by the factor.
struct SharedHit<'a> {
    shared: &'a SharedForce,
    displacement: &'a [f64],
    end: Option<UnfilteredEnd<'a>>,
    response: CentredTransform,
    factor: f64,
}

impl SharedHit<'_> {
    fn step(&self) -> f64 {
        self.response.cycles * self.shared.rate
    }

    fn stencil(&self, frequency_hz: f64) -> PolynomialStencil {
        PolynomialStencil::at(frequency_hz / self.step(), self.shared.keep)
    }

    fn power(&self, frequency_hz: f64) -> f64 {
        let stencil = self.stencil(frequency_hz);
        self.response.at(&stencil).0.norm_sqr() / self.shared.force.at(&stencil).0.norm_sqr()
    }
}

impl HitSpectra for SharedHit<'_> {
    fn band(&self, _: usize, _: f64) -> BandSpectra<'_> {
        BandSpectra {
            step: self.step(),
            duration: self.displacement.len() as f64 / self.shared.rate,
            samples: Cow::Borrowed(&self.response.values),
            force: Cow::Borrowed(&self.shared.force.values),
        }
    }

    fn kind(&self) -> ResponseKind {
        ResponseKind::Displacement
    }

    fn force_magnitude(&self, frequency_hz: f64) -> f64 {
        self.shared.force.at(&self.stencil(frequency_hz)).0.norm()
    }

    fn receptance_at(&self, frequency_hz: f64) -> Complex64 {
        let stencil = self.stencil(frequency_hz);
        let ratio = self.response.at(&stencil).0 / self.shared.force.at(&stencil).0;
        let delay = self.response.centre - self.shared.force.centre;
        ratio * Complex64::from_polar(1.0, -TAU * frequency_hz / self.shared.rate * delay)
    }

    fn power_and_slope(&self, frequency_hz: f64) -> (f64, f64) {
        let stencil = self.stencil(frequency_hz);
        let (x, dx) = self.response.at(&stencil);
        let (f, df) = self.shared.force.at(&stencil);
        ((x / f).norm_sqr(), 2.0 * (dx / x - df / f).re / self.step())
    }

    fn ripples(&self, period: f64) -> Ripples {
        let sampling = (self.shared.rate, self.kind());
        Ripples::of(self.displacement, sampling, self.end, period).over(self.factor.abs())
    }
}
