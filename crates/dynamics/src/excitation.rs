//! The force on the top of the stack.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use crate::DynamicsError;
use crate::error::positive;

/// A force over time, zero before `t = 0`; positive forces push down.
///
/// ```
/// use asperity_dynamics::Excitation;
///
/// let pulse = Excitation::GammaPulse { peak: 32.0, rise: 0.34e-3 };
/// assert_eq!(pulse.force(0.34e-3), 32.0);
/// assert_eq!(pulse.force(-1.0), 0.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Excitation {
    /// No force.
    None,
    /// `F (t/tr)^2 exp(2 (1 - t/tr))`: a hammer pulse with its peak F at the
    /// rise time, a smooth start, and a spectrum without zeros.
    GammaPulse {
        /// Peak force F \[N\].
        peak: f64,
        /// Time of the peak tr \[s\].
        rise: f64,
    },
    /// `F sin(pi t / T)` for `0 < t < T`; its spectrum has zeros from 1.5 / T on.
    HalfSine {
        /// Peak force F \[N\].
        peak: f64,
        /// Duration T \[s\].
        duration: f64,
    },
    /// `F sin^2(pi t / T)` for `0 < t < T`; its spectrum has zeros from 2 / T on.
    Haversine {
        /// Peak force F \[N\].
        peak: f64,
        /// Duration T \[s\].
        duration: f64,
    },
    /// `F sin(2 pi f t)` from `t = 0` on.
    Harmonic {
        /// Amplitude F \[N\].
        amplitude: f64,
        /// Frequency f \[Hz\].
        frequency: f64,
    },
    /// A measured record, linear between its samples, zero outside.
    Record(ForceRecord),
    /// A sine of one frequency after another.
    Frequencies(FrequencySequence),
}

/// Past this many rise times a gamma pulse is below 1e-19 of its peak, less
/// than half a unit in the last place of any sum it enters, and counts as over.
const GAMMA_PULSE_END: f64 = 25.5;

impl Excitation {
    /// Force \[N\] at `time` \[s\].
    pub fn force(&self, time: f64) -> f64 {
        if time < 0.0 || time > self.ends_at() {
            return 0.0;
        }
        match *self {
            Self::None => 0.0,
            Self::GammaPulse { peak, rise } => {
                let s = time / rise;
                peak * s * s * (2.0 * (1.0 - s)).exp()
            }
            Self::HalfSine { peak, duration } => peak * (PI * time / duration).sin(),
            Self::Haversine { peak, duration } => peak * (PI * time / duration).sin().powi(2),
            Self::Harmonic { amplitude, frequency } => amplitude * (TAU * frequency * time).sin(),
            Self::Record(ref record) => record.force(time),
            Self::Frequencies(ref sequence) => sequence.force(time),
        }
    }

    /// Fills `forces` with the force \[N\] at `start`, `start + step`, ... \[s\].
    pub fn sample_into(&self, start: f64, step: f64, forces: &mut [f64]) {
        if start > self.ends_at() {
            forces.fill(0.0);
            return;
        }
        for (n, force) in forces.iter_mut().enumerate() {
            *force = self.force(start + n as f64 * step);
        }
    }

    /// Time \[s\] after which the force is zero for good; infinite for a lasting one.
    pub fn ends_at(&self) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::GammaPulse { rise, .. } => GAMMA_PULSE_END * rise,
            Self::HalfSine { duration, .. } | Self::Haversine { duration, .. } => duration,
            Self::Harmonic { .. } | Self::Frequencies(_) => f64::INFINITY,
            Self::Record(ref record) => record.time[record.time.len() - 1],
        }
    }

    /// Largest magnitude of the force \[N\].
    pub fn peak(&self) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::GammaPulse { peak, .. }
            | Self::HalfSine { peak, .. }
            | Self::Haversine { peak, .. } => peak.abs(),
            Self::Harmonic { amplitude, .. }
            | Self::Frequencies(FrequencySequence { amplitude, .. }) => amplitude.abs(),
            Self::Record(ref record) => record.force.iter().fold(0.0, |m, f| f.abs().max(m)),
        }
    }

    /// Time in which the force changes \[s\]: the rise of a pulse, a sixth of a period, of a record
    /// twice the integral of its magnitude over its total variation; infinite for no force.
    pub fn time_scale(&self) -> f64 {
        match *self {
            Self::None => f64::INFINITY,
            Self::GammaPulse { rise, .. } => rise,
            Self::HalfSine { duration, .. } | Self::Haversine { duration, .. } => 0.5 * duration,
            Self::Harmonic { frequency, .. } => 1.0 / (TAU * frequency),
            Self::Record(ref record) => record.time_scale(),
            Self::Frequencies(ref sequence) => 1.0 / (TAU * sequence.highest()),
        }
    }

    /// The same force with a peak or amplitude of one, and the factor on it; a record, and a
    /// force of zero, stay as they are.
    pub fn unit(&self) -> (Self, f64) {
        match *self {
            Self::GammaPulse { peak, rise } if peak != 0.0 => {
                (Self::GammaPulse { peak: 1.0, rise }, peak)
            }
            Self::HalfSine { peak, duration } if peak != 0.0 => {
                (Self::HalfSine { peak: 1.0, duration }, peak)
            }
            Self::Haversine { peak, duration } if peak != 0.0 => {
                (Self::Haversine { peak: 1.0, duration }, peak)
            }
            Self::Harmonic { amplitude, frequency } if amplitude != 0.0 => {
                (Self::Harmonic { amplitude: 1.0, frequency }, amplitude)
            }
            Self::Frequencies(ref sequence) if sequence.amplitude != 0.0 => {
                let unit = FrequencySequence { amplitude: 1.0, ..sequence.clone() };
                (Self::Frequencies(unit), sequence.amplitude)
            }
            ref other => (other.clone(), 1.0),
        }
    }

    /// The same force times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        match &mut scaled {
            Self::None => {}
            Self::GammaPulse { peak, .. }
            | Self::HalfSine { peak, .. }
            | Self::Haversine { peak, .. }
            | Self::Harmonic { amplitude: peak, .. }
            | Self::Frequencies(FrequencySequence { amplitude: peak, .. }) => *peak *= factor,
            Self::Record(record) => record.force.iter_mut().for_each(|force| *force *= factor),
        }
        scaled
    }

    /// Checks that every parameter is in its range.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for a force that is not finite, or a time or
    /// frequency that is not positive and finite.
    pub fn check(&self) -> Result<(), DynamicsError> {
        let (force, scale, quantity) = match *self {
            Self::None | Self::Record(_) | Self::Frequencies(_) => return Ok(()),
            Self::GammaPulse { peak, rise } => (peak, rise, "rise time [s]"),
            Self::HalfSine { peak, duration } | Self::Haversine { peak, duration } => {
                (peak, duration, "pulse duration [s]")
            }
            Self::Harmonic { amplitude, frequency } => (amplitude, frequency, "frequency [Hz]"),
        };
        if !force.is_finite() {
            let quantity = "force [N]";
            return Err(DynamicsError::Setting { quantity, value: force, accepted: "finite" });
        }
        positive(quantity, scale).map(|_| ())
    }
}

/// `F sin(2 pi f t)` with one frequency f after another, each for a number of whole periods, so that
/// neither force nor phase jumps; the last frequency lasts.
///
/// ```
/// use asperity_dynamics::{Excitation, FrequencySequence};
///
/// // Two periods at 100 Hz, then 200 Hz.
/// let sequence = FrequencySequence::new(3.0, &[(100.0, 2), (200.0, 1)])?;
/// assert_eq!(sequence.start(1), Some(0.02));
/// let force = Excitation::Frequencies(sequence);
/// assert!((force.force(0.0025) - 3.0).abs() < 1e-12);
/// assert!((force.force(0.02125) - 3.0).abs() < 1e-12);
/// # Ok::<(), asperity_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencySequence {
    amplitude: f64,
    /// Start \[s\] and frequency \[Hz\] of each part.
    parts: Arc<[(f64, f64)]>,
    end: f64,
}

impl FrequencySequence {
    /// A force of `amplitude` \[N\] at frequencies \[Hz\] for numbers of periods.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for an amplitude that is not finite, no frequency, or one that is not
    /// positive and finite.
    pub fn new(amplitude: f64, frequencies: &[(f64, usize)]) -> Result<Self, DynamicsError> {
        if !amplitude.is_finite() {
            let (quantity, accepted) = ("force [N]", "finite");
            return Err(DynamicsError::Setting { quantity, value: amplitude, accepted });
        }
        if frequencies.is_empty() {
            let (quantity, accepted) = ("number of frequencies", "at least 1");
            return Err(DynamicsError::Setting { quantity, value: 0.0, accepted });
        }
        let mut parts = Vec::with_capacity(frequencies.len());
        let mut end = 0.0;
        for &(frequency, periods) in frequencies {
            parts.push((end, positive("frequency [Hz]", frequency)?));
            end += periods as f64 / frequency;
        }
        Ok(Self { amplitude, parts: parts.into(), end })
    }

    /// Start \[s\] of a frequency by its place; none beyond the last.
    pub fn start(&self, place: usize) -> Option<f64> {
        self.parts.get(place).map(|part| part.0)
    }

    /// End of the periods of the last frequency \[s\].
    pub fn end(&self) -> f64 {
        self.end
    }

    fn highest(&self) -> f64 {
        self.parts.iter().fold(0.0, |highest, part| part.1.max(highest))
    }

    fn force(&self, time: f64) -> f64 {
        let after = self.parts.partition_point(|part| part.0 <= time);
        let (start, frequency) = self.parts[after.max(1) - 1];
        self.amplitude * (TAU * frequency * (time - start)).sin()
    }
}

/// A measured force over time, with increasing times.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceRecord {
    time: Vec<f64>,
    force: Vec<f64>,
}

impl ForceRecord {
    /// A record of `force` \[N\] at `time` \[s\].
    ///
    /// # Errors
    /// [`DynamicsError::ForceRecord`] for fewer than two samples, columns of
    /// unequal length, values that are not finite, or times that do not increase.
    pub fn new(time: Vec<f64>, force: Vec<f64>) -> Result<Self, DynamicsError> {
        let refuse = |row, quantity, value, accepted| {
            Err(DynamicsError::ForceRecord { row, quantity, value, accepted })
        };
        if time.len() < 2 || time.len() != force.len() {
            let accepted = "at least 2, and equal for time and force";
            return refuse(0, "number of samples", force.len() as f64, accepted);
        }
        for (row, (&t, &f)) in time.iter().zip(&force).enumerate() {
            if !f.is_finite() {
                return refuse(row, "force [N]", f, "finite");
            }
            if !t.is_finite() || (row > 0 && t <= time[row - 1]) {
                return refuse(row, "time [s]", t, "finite and later than the row before");
            }
        }
        Ok(Self { time, force })
    }

    /// Twice the integral of the magnitude over the total variation \[s\]: about the rise time of
    /// a pulse, about a step of noise; at least the mean spacing.
    fn time_scale(&self) -> f64 {
        let last = self.time.len() - 1;
        let spacing = (self.time[last] - self.time[0]) / last as f64;
        let (mut area, mut variation) = (0.0, self.force[0].abs() + self.force[last].abs());
        for (times, forces) in self.time.windows(2).zip(self.force.windows(2)) {
            area += 0.5 * (forces[0].abs() + forces[1].abs()) * (times[1] - times[0]);
            variation += (forces[1] - forces[0]).abs();
        }
        if variation > 0.0 { spacing.max(2.0 * area / variation) } else { spacing }
    }

    fn force(&self, time: f64) -> f64 {
        let after = self.time.partition_point(|&t| t <= time);
        if after == 0 {
            return 0.0;
        }
        if after == self.time.len() {
            return if time == self.time[after - 1] { self.force[after - 1] } else { 0.0 };
        }
        let (t0, t1) = (self.time[after - 1], self.time[after]);
        let (f0, f1) = (self.force[after - 1], self.force[after]);
        f0 + (f1 - f0) * (time - t0) / (t1 - t0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn impulse(excitation: &Excitation, until: f64) -> f64 {
        let n = 200_000;
        let step = until / f64::from(n);
        (0..n).map(|i| excitation.force((f64::from(i) + 0.5) * step)).sum::<f64>() * step
    }

    /// Impulses in closed form: gamma F tr e^2 / 4, half-sine 2 F T / pi, haversine F T / 2.
    #[test]
    fn pulses_have_their_closed_form_impulse_and_peak() {
        let gamma = Excitation::GammaPulse { peak: 32.0, rise: 0.34e-3 };
        let expected = 32.0 * 0.34e-3 * 2.0_f64.exp() / 4.0;
        assert!((impulse(&gamma, 0.01) / expected - 1.0).abs() < 1e-9);
        assert!((gamma.force(0.34e-3) - 32.0).abs() < 1e-12);
        let half = Excitation::HalfSine { peak: 9.0, duration: 1e-3 };
        assert!((impulse(&half, 1e-3) / (2.0 * 9e-3 / PI) - 1.0).abs() < 1e-9);
        let haversine = Excitation::Haversine { peak: 9.0, duration: 1e-3 };
        assert!((impulse(&haversine, 1e-3) / 4.5e-3 - 1.0).abs() < 1e-9);
        for pulse in [gamma, half, haversine] {
            assert_eq!(pulse.force(-1e-9), 0.0);
            assert_eq!(pulse.force(1.0), 0.0);
        }
    }

    #[test]
    fn the_cut_of_the_gamma_pulse_is_below_round_off() {
        let gamma = Excitation::GammaPulse { peak: 1.0, rise: 1.0 };
        assert!(gamma.force(GAMMA_PULSE_END) < 1e-18);
    }

    #[test]
    fn a_record_is_linear_between_samples_and_zero_outside() {
        let record = ForceRecord::new(vec![0.0, 1.0, 3.0], vec![0.0, 4.0, -2.0]).unwrap();
        let excitation = Excitation::Record(record);
        let expected = [(-0.1, 0.0), (0.5, 2.0), (1.0, 4.0), (2.0, 1.0), (3.0, -2.0), (3.1, 0.0)];
        for (time, force) in expected {
            assert_eq!(excitation.force(time), force);
        }
        assert_eq!(excitation.peak(), 4.0);
    }

    /// Whole periods: no jump of the force, and its slope changes with the frequency only.
    #[test]
    fn frequencies_follow_without_a_jump() {
        let parts = [(100.0, 3), (130.0, 5), (170.0, 2)];
        let force = FrequencySequence::new(-2.0, &parts).unwrap();
        assert_eq!(force.start(3), None);
        let sine = Excitation::Frequencies(force.clone());
        for (place, pair) in parts.windows(2).enumerate() {
            let at = force.start(place + 1).unwrap();
            let slope = |sign: f64| sign * sine.force(at + sign * 1e-7) / 1e-7 / (-2.0 * TAU);
            assert!((slope(-1.0) / pair[0].0 - 1.0).abs() < 1e-6);
            assert!((slope(1.0) / pair[1].0 - 1.0).abs() < 1e-6);
        }
        assert!((force.end() - (0.03 + 5.0 / 130.0 + 2.0 / 170.0)).abs() < 1e-15);
        let (unit, factor) = sine.unit();
        assert_eq!((unit.peak(), factor), (1.0, -2.0));
        assert_eq!(unit.scaled(factor), sine);
        assert_eq!(sine.time_scale(), 1.0 / (TAU * 170.0));
        for wrong in [&[][..], &[(0.0, 3)], &[(f64::NAN, 1)]] {
            assert!(FrequencySequence::new(1.0, wrong).is_err());
        }
        assert!(FrequencySequence::new(f64::INFINITY, &parts).is_err());
    }

    #[test]
    fn unusable_records_and_parameters_are_refused() {
        assert!(ForceRecord::new(vec![0.0], vec![1.0]).is_err());
        assert!(ForceRecord::new(vec![0.0, 0.0], vec![1.0, 1.0]).is_err());
        assert!(ForceRecord::new(vec![0.0, 1.0], vec![1.0, f64::NAN]).is_err());
        assert!(ForceRecord::new(vec![0.0, f64::NAN], vec![1.0, 1.0]).is_err());
        assert!(ForceRecord::new(vec![0.0, 1.0], vec![1.0]).is_err());
        assert!(Excitation::GammaPulse { peak: 1.0, rise: 0.0 }.check().is_err());
        assert!(Excitation::Harmonic { amplitude: f64::NAN, frequency: 1.0 }.check().is_err());
        assert!(Excitation::HalfSine { peak: -3.0, duration: 1e-3 }.check().is_ok());
    }
}
