//! Backbone curves: frequency and damping against amplitude from a free decay.

mod analytic;
mod band_pass;
mod displacement_filter;
mod line_noise;
mod local;

pub use analytic::analytic_signal;
pub use band_pass::BandPass;
pub(crate) use displacement_filter::DisplacementFilter;
pub use line_noise::BackboneUncertainty;
pub(crate) use local::{LocalFit, Polar};

use crate::error::{Result, SignalError, check_positive, check_rate, check_samples};
use crate::sums::largest_magnitude;
use num_complex::Complex64;

/// Options of [`backbone`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackboneOptions {
    /// The band around the mode.
    pub band: BandPass,
    /// Cycles (of the centre of the band) over which a line is fitted, at least 1.
    ///
    /// Ripples of the envelope from noise or a neighbouring mode compete with its decrease
    /// of `2 pi zeta` a cycle: light damping needs more cycles.
    pub cycles: f64,
    /// Largest part of the filtered signal that the ends of the record may contribute.
    pub edge_level: f64,
    /// One-sided spectral density of the noise, in the samples' unit squared per hertz.
    pub noise_density: f64,
    /// Smallest envelope, over the root mean square of the envelope of the filtered noise.
    pub noise_factor: f64,
    /// Smallest envelope beside that, in the samples' unit.
    pub floor: f64,
    /// Derivatives of the displacement that the samples are: 0 to 2.
    pub derivatives: i32,
}

impl BackboneOptions {
    /// Four cycles, edge level 3e-4, no noise, noise factor 5, samples of a displacement.
    pub fn new(band: BandPass) -> Self {
        Self {
            band,
            cycles: 4.0,
            edge_level: 3e-4,
            noise_density: 0.0,
            noise_factor: 5.0,
            floor: 0.0,
            derivatives: 0,
        }
    }

    /// The filter of the decay: the band, and the integration to a displacement.
    pub(crate) fn filter(&self) -> DisplacementFilter {
        DisplacementFilter::new(self.band, self.derivatives)
    }

    fn check(&self) -> Result<()> {
        check_positive("the edge level", self.edge_level)?;
        if !(self.cycles >= 1.0 && self.cycles.is_finite()) {
            let (value, expected) = (self.cycles, "at least 1 and finite");
            return Err(SignalError::Option { quantity: "the cycles of a line", value, expected });
        }
        if !(0..=2).contains(&self.derivatives) {
            let (quantity, value) =
                ("the derivatives of the displacement", self.derivatives.into());
            return Err(SignalError::Option { quantity, value, expected: "0, 1 or 2" });
        }
        let named = [
            ("the noise density", self.noise_density),
            ("the noise factor", self.noise_factor),
            ("the floor", self.floor),
        ];
        for (quantity, value) in named {
            if !(value >= 0.0 && value.is_finite()) {
                let expected = "not negative, and finite";
                return Err(SignalError::Option { quantity, value, expected });
            }
        }
        Ok(())
    }
}

/// Frequency and damping at one amplitude of a decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackbonePoint {
    /// Time after the first sample, in seconds.
    pub time_s: f64,
    /// Amplitude of the oscillation, in the samples' unit.
    pub amplitude: f64,
    /// Instantaneous frequency of the damped oscillation of the displacement, in hertz.
    pub frequency_hz: f64,
    /// Decay rate `-d ln A / dt` of the amplitude of the displacement, in 1/s.
    pub decay_rate: f64,
    /// Damping ratio `sigma / sqrt(sigma^2 + w_d^2)`.
    pub damping_ratio: f64,
}

/// Frequency and damping along a decay, and the number of points left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Backbone {
    /// In the order of time, a quarter of a line apart.
    pub points: Vec<BackbonePoint>,
    /// Points left out because of the ends of the record.
    pub masked_edges: usize,
    /// Points left out because the envelope is below the floor.
    pub masked_noise: usize,
    /// Points left out because their frequency is outside the band: a neighbour exceeds the mode.
    pub masked_outside: usize,
    /// The smallest amplitude accepted, in the samples' unit.
    pub floor: f64,
    /// Time after which the response of the filter to a step is below the edge level, in seconds: the
    /// longest effect of an end of the record.
    pub settling_s: f64,
}

/// Rounding of the transforms over the largest sample, with a margin of three digits.
const ROUNDING: f64 = 1e-11;

/// The backbone curve of a mode from its free decay (ring-down).
///
/// From the analytic signal `z = A exp(i phi)` of the band-passed samples, with the slopes of the
/// least-squares lines of `phi(t)` and `ln A(t)` over windows of some cycles:
///
/// ```text
/// f = phi' / 2 pi,   sigma = -(ln A)',   zeta = sigma / sqrt(sigma^2 + (2 pi f)^2)
/// ```
///
/// `z` is the analytic signal of the displacement. The amplitude of an acceleration is
/// `A (2 pi f)^2`, which falls by `2 f' / f` more slowly where the frequency rises along the decay;
/// samples of a velocity or an
/// acceleration ([`BackboneOptions::derivatives`]) are therefore integrated inside the band. The change
/// of the band's gain along the decay is taken out likewise.
///
/// The filter responds to the steps at the ends of the record: to one of
/// size `x` with `(4/pi) x exp(-2 pi^2 edge t)`. Points
/// where that exceeds [`BackboneOptions::edge_level`] of the envelope are
/// left out and counted, and likewise points with an envelope below the noise or a
/// frequency outside the band.
///
/// - `decay`: free decay from the first sample on, any unit, without offset.
///
/// Valid for one mode in the band; two modes beat. Limiting case: a linear oscillator has one
/// frequency and one damping ratio at every amplitude.
///
/// # Errors
/// [`SignalError::Empty`], [`SignalError::NotFinite`], [`SignalError::SampleRate`],
/// [`SignalError::Option`] also for a band beyond half the sample rate.
///
/// Source: M. Feldman, "Non-linear free vibration identification via the
/// Hilbert transform", J. Sound Vib. 208 (1997), 475-489.
///
/// ```
/// use asperity_signal::{BackboneOptions, BandPass, backbone};
///
/// let (rate, omega, zeta) = (1e4, std::f64::consts::TAU * 200.0, 0.01);
/// let decay: Vec<f64> = (0..4000)
///     .map(|n| f64::from(n) / rate)
///     .map(|t| (-zeta * omega * t).exp() * (omega * t).cos())
///     .collect();
/// let curve = backbone(&decay, rate, &BackboneOptions::new(BandPass::around(200.0, 0.3)?))?;
/// for point in &curve.points {
///     assert!((point.frequency_hz - 200.0).abs() < 0.1 && (point.damping_ratio - zeta).abs() < 1e-3);
/// }
/// assert!(curve.points.len() > 20);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
pub fn backbone(decay: &[f64], sample_rate_hz: f64, options: &BackboneOptions) -> Result<Backbone> {
    backbone_and_signal(decay, sample_rate_hz, options).map(|(found, _)| found)
}

/// Samples on either side of the middle of a line.
pub(crate) fn half_line(sample_rate_hz: f64, options: &BackboneOptions) -> usize {
    (0.5 * options.cycles * sample_rate_hz / options.band.centre_hz()).ceil().max(2.0) as usize
}

impl BackbonePoint {
    /// The point of a line through a filtered decay.
    pub(crate) fn of_line(line: &LocalFit, time_s: f64, filter: &DisplacementFilter) -> Self {
        let omega = std::f64::consts::TAU * line.frequency_hz;
        Self {
            time_s,
            amplitude: line.amplitude / filter.gain(line.frequency_hz),
            frequency_hz: line.frequency_hz,
            decay_rate: line.decay_rate,
            damping_ratio: line.decay_rate / line.decay_rate.hypot(omega),
        }
    }
}

/// [`backbone`] and its analytic signal.
pub(crate) fn backbone_and_signal(
    decay: &[f64],
    sample_rate_hz: f64,
    options: &BackboneOptions,
) -> Result<(Backbone, Vec<Complex64>)> {
    check_samples("decay", decay)?;
    check_rate(sample_rate_hz)?;
    options.check()?;
    let (band, filter) = (options.band, options.filter());
    let signal = filter.analytic_signal(decay, sample_rate_hz)?;
    let polar = Polar::of(&signal);

    let centre_hz = band.centre_hz();
    let half = half_line(sample_rate_hz, options);
    let noise = (2.0 * options.noise_density * filter.noise_width_hz()).sqrt();
    let floor = (options.noise_factor * noise).max(options.floor);
    let floor = floor.max(ROUNDING * largest_magnitude(decay));
    let mut found = Backbone {
        points: Vec::new(),
        masked_edges: 0,
        masked_noise: 0,
        masked_outside: 0,
        floor,
        settling_s: filter.settling_s(options.edge_level),
    };
    let cycle = ((sample_rate_hz / band.low_hz()) as usize).clamp(1, decay.len());
    let head = largest_magnitude(&decay[..cycle]);
    let tail = largest_magnitude(&decay[decay.len() - cycle..]);
    for middle in (half..decay.len().saturating_sub(half)).step_by((half / 2).max(1)) {
        let Some(line) = polar.line(middle - half..=middle + half, sample_rate_hz, centre_hz)
        else {
            found.masked_noise += 1;
            continue;
        };
        if !(band.low_hz()..=band.high_hz()).contains(&line.frequency_hz) {
            found.masked_outside += 1;
            continue;
        }
        let amplitude = line.amplitude / filter.gain(line.frequency_hz);
        // The nearest sample of the line is affected most.
        let ringing = |samples: usize| filter.ringing(samples as f64 / sample_rate_hz);
        let edge = head * ringing(middle - half) + tail * ringing(decay.len() - 1 - middle - half);
        if edge > options.edge_level * amplitude {
            found.masked_edges += 1;
        } else if amplitude < floor {
            found.masked_noise += 1;
        } else {
            let time_s = middle as f64 / sample_rate_hz;
            found.points.push(BackbonePoint::of_line(&line, time_s, &filter));
        }
    }
    take_out_gain(&mut found.points, &band);
    Ok((found, signal))
}

/// Points on either side, half of a line, over which the change of the gain is taken.
const BESIDE: usize = 2;

/// Takes the change of the gain of the band along the decay out of the decay rates: the filtered
/// amplitude is `A G(f)`, and falls faster than A where f moves away from the centre.
fn take_out_gain(points: &mut [BackbonePoint], band: &BandPass) {
    let gains: Vec<(f64, f64)> =
        points.iter().map(|point| (point.time_s, band.gain(point.frequency_hz).ln())).collect();
    for (n, point) in points.iter_mut().enumerate() {
        let (from, to) =
            (gains[n.saturating_sub(BESIDE)], gains[(n + BESIDE).min(gains.len() - 1)]);
        if to.0 > from.0 {
            point.decay_rate += (to.1 - from.1) / (to.0 - from.0);
            let omega = std::f64::consts::TAU * point.frequency_hz;
            point.damping_ratio = point.decay_rate / point.decay_rate.hypot(omega);
        }
    }
}
