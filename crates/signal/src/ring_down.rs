//! Frequency and damping against amplitude, from one free decay.
//!
//! [`BandPass`] isolates a mode without shifting its phase, its analytic signal
//! gives envelope and phase, and [`backbone`] fits lines to both.

mod analytic;
mod band_pass;
mod local;

pub use analytic::analytic_signal;
pub use band_pass::BandPass;

use crate::error::{Result, SignalError, check_positive, check_rate, check_samples};
use local::Polar;
use realfft::num_complex::Complex64;

/// How [`backbone`] looks at a decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackboneOptions {
    /// The band around the mode.
    pub band: BandPass,
    /// Cycles (of the band's middle) over which a line is fitted, at least 1.
    ///
    /// What ripples on the envelope, noise or a neighbouring mode, counts
    /// against its fall over a line, `2 pi zeta` a cycle: light damping needs more cycles.
    pub cycles: f64,
    /// Largest part of the filtered signal that may come from the record's ends.
    pub edge_level: f64,
    /// One-sided spectral density of the noise, in the samples' unit squared per hertz.
    pub noise_density: f64,
    /// Smallest envelope over the root mean square of the filtered noise's envelope.
    pub noise_factor: f64,
}

impl BackboneOptions {
    /// Four cycles, edges to 3e-4, no noise known, five times it.
    pub fn new(band: BandPass) -> Self {
        Self { band, cycles: 4.0, edge_level: 3e-4, noise_density: 0.0, noise_factor: 5.0 }
    }

    fn check(&self) -> Result<()> {
        check_positive("the edge level", self.edge_level)?;
        if !(self.cycles >= 1.0 && self.cycles.is_finite()) {
            let (value, expected) = (self.cycles, "at least 1 and finite");
            return Err(SignalError::Option { quantity: "the cycles of a line", value, expected });
        }
        let named =
            [("the noise density", self.noise_density), ("the noise factor", self.noise_factor)];
        for (quantity, value) in named {
            if !(value >= 0.0 && value.is_finite()) {
                let expected = "not negative, and finite";
                return Err(SignalError::Option { quantity, value, expected });
            }
        }
        Ok(())
    }
}

/// A moment of a decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackbonePoint {
    /// Time after the first sample, in seconds.
    pub time_s: f64,
    /// Amplitude of the oscillation, in the samples' unit.
    pub amplitude: f64,
    /// Instantaneous frequency (of the damped oscillation), in hertz.
    pub frequency_hz: f64,
    /// Decay rate `-d ln A / dt`, in 1/s.
    pub decay_rate: f64,
    /// Damping ratio `sigma / sqrt(sigma^2 + w_d^2)`.
    pub damping_ratio: f64,
}

/// The backbone: frequency and damping along a decay, and what was left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Backbone {
    /// In the order of time, a quarter of a line apart.
    pub points: Vec<BackbonePoint>,
    /// Points left out because the record's ends reach them.
    pub masked_edges: usize,
    /// Points left out because the envelope is below the floor.
    pub masked_noise: usize,
    /// Points left out because their frequency is outside the band: something
    /// else leaks in louder than what is left of the mode.
    pub masked_outside: usize,
    /// The smallest amplitude accepted, in the samples' unit.
    pub floor: f64,
    /// Time for which an end of the record is felt, before counting that the
    /// signal decays: [`BandPass::settling_s`] of the edge level, in seconds.
    pub settling_s: f64,
}

/// The transforms' rounding, over the largest sample, with room for three digits above it.
const ROUNDING: f64 = 1e-11;

/// Instantaneous frequency and damping of a free decay.
///
/// The band-passed signal is made analytic, `z = A exp(i phi)`; over each
/// window of some cycles lines are fitted to `phi(t)` and `ln A(t)` by least squares:
///
/// ```text
/// f = phi' / 2 pi,   sigma = -(ln A)',   zeta = sigma / sqrt(sigma^2 + (2 pi f)^2)
/// ```
///
/// The ends of the record are jumps, which the filter rings with. A jump of
/// size `x` is felt for a time `t` as `(4/pi) x exp(-2 pi^2 edge t)`; points
/// where that is more than [`BackboneOptions::edge_level`] of the envelope are
/// left out. So are points whose envelope is below the noise, and those whose
/// frequency is not in the band. All are counted.
///
/// - `decay`: without force from the first sample on, any unit, without offset.
///
/// A linear oscillator has one frequency and one damping ratio at every
/// amplitude. No band, no backbone: with two modes inside, they beat.
///
/// # Errors
/// [`SignalError::Empty`], [`SignalError::NotFinite`], [`SignalError::SampleRate`],
/// [`SignalError::Option`] also for a band beyond half the sample rate.
///
/// Source: M. Feldman, "Non-linear free vibration identification via the
/// Hilbert transform", J. Sound Vib. 208 (1997), 475-489.
pub fn backbone(decay: &[f64], sample_rate_hz: f64, options: &BackboneOptions) -> Result<Backbone> {
    backbone_and_signal(decay, sample_rate_hz, options).map(|(found, _)| found)
}

/// [`backbone`], and the analytic signal it was read from.
pub(crate) fn backbone_and_signal(
    decay: &[f64],
    sample_rate_hz: f64,
    options: &BackboneOptions,
) -> Result<(Backbone, Vec<Complex64>)> {
    check_samples("decay", decay)?;
    check_rate(sample_rate_hz)?;
    options.check()?;
    let band = options.band;
    let signal = analytic_signal(decay, sample_rate_hz, Some(&band))?;
    let polar = Polar::of(&signal);

    let centre_hz = band.centre_hz();
    let half = (0.5 * options.cycles * sample_rate_hz / centre_hz).ceil().max(2.0) as usize;
    let most = |part: &[f64]| part.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let noise = (2.0 * options.noise_density * band.noise_width_hz()).sqrt();
    let floor = (options.noise_factor * noise).max(ROUNDING * most(decay));
    let mut found = Backbone {
        points: Vec::new(),
        masked_edges: 0,
        masked_noise: 0,
        masked_outside: 0,
        floor,
        settling_s: band.settling_s(options.edge_level),
    };
    let cycle = ((sample_rate_hz / band.low_hz()) as usize).clamp(1, decay.len());
    let (head, tail) = (most(&decay[..cycle]), most(&decay[decay.len() - cycle..]));
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
        let amplitude = line.amplitude / band.gain(line.frequency_hz);
        // The line's own end is what the jump reaches first.
        let reach = |samples: usize| band.ringing(samples as f64 / sample_rate_hz);
        let edge = head * reach(middle - half) + tail * reach(decay.len() - 1 - middle - half);
        if edge > options.edge_level * amplitude {
            found.masked_edges += 1;
        } else if amplitude < floor {
            found.masked_noise += 1;
        } else {
            let omega = std::f64::consts::TAU * line.frequency_hz;
            found.points.push(BackbonePoint {
                time_s: middle as f64 / sample_rate_hz,
                amplitude,
                frequency_hz: line.frequency_hz,
                decay_rate: line.decay_rate,
                damping_ratio: line.decay_rate / line.decay_rate.hypot(omega),
            });
        }
    }
    Ok((found, signal))
}
