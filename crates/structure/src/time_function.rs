//! Functions of time for loads, of unit amplitude, with derivatives and integrals in closed form.

use std::f64::consts::{E, PI, TAU};
use std::sync::Arc;

use crate::StructureError;

/// A function of time of unit amplitude, zero before `t = 0`.
///
/// ```
/// use asperity_structure::TimeFunction;
///
/// let pulse = TimeFunction::GammaPulse { rise: 0.34e-3 };
/// assert_eq!(pulse.value(0.34e-3), 1.0);
/// assert_eq!(pulse.value(-1.0), 0.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TimeFunction {
    /// Zero.
    Zero,
    /// `(t/tr)^2 exp(2 (1 - t/tr))`: a hammer pulse with its peak at the rise time, a smooth start,
    /// and a spectrum without zeros.
    GammaPulse {
        /// Time of the peak tr \[s\].
        rise: f64,
    },
    /// `sin(pi t / T)` for `0 < t < T`; its spectrum has zeros from 1.5 / T on.
    HalfSine {
        /// Duration T \[s\].
        duration: f64,
    },
    /// `sin^2(pi t / T)` for `0 < t < T`; its spectrum has zeros from 2 / T on.
    Haversine {
        /// Duration T \[s\].
        duration: f64,
    },
    /// `sin(2 pi f t)` from `t = 0` on.
    Harmonic {
        /// Frequency f \[Hz\].
        frequency: f64,
    },
    /// Samples, linear between them, zero outside.
    Samples(Arc<SampledFunction>),
    /// A sine of one frequency after another.
    SteppedSine(SteppedSine),
}

/// Derivative or integral of a function of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The integral of the integral.
    SecondIntegral,
    /// The integral.
    Integral,
    /// The function itself.
    Value,
    /// The derivative.
    Derivative,
    /// The second derivative.
    SecondDerivative,
}

impl Order {
    /// The integral of what this order is.
    #[must_use]
    pub fn integral(self) -> Self {
        match self {
            Self::SecondIntegral | Self::Integral => Self::SecondIntegral,
            Self::Value => Self::Integral,
            Self::Derivative => Self::Value,
            Self::SecondDerivative => Self::Derivative,
        }
    }
}

/// Past this many rise times a gamma pulse is below 1e-19 of its peak, less
/// than half a unit in the last place of any sum it enters, and counts as over.
const GAMMA_PULSE_END: f64 = 25.5;

impl TimeFunction {
    /// The value at `time` \[s\].
    pub fn value(&self, time: f64) -> f64 {
        self.at(Order::Value, time)
    }

    /// The derivative or integral of this order at `time` \[s\].
    ///
    /// Integrals begin at zero with `t = 0`, but for the integral of a sine, which is `-cos(2 pi f t)
    /// / (2 pi f)` and has no drift. Derivatives do not contain the impulses at jumps; the first
    /// derivative of samples is constant between them, and has no second.
    pub fn at(&self, order: Order, time: f64) -> f64 {
        let differentiates = matches!(order, Order::Derivative | Order::SecondDerivative);
        let over = time > self.ends_at() && (differentiates || order == Order::Value);
        if time < 0.0 || over {
            return 0.0;
        }
        match *self {
            Self::Zero => 0.0,
            Self::GammaPulse { rise } => gamma_pulse(order, time / rise) * scale(order, rise),
            Self::HalfSine { duration } => {
                half_sine(order, (time / duration).min(1.0), time / duration)
                    * scale(order, duration)
            }
            Self::Haversine { duration } => {
                haversine(order, (time / duration).min(1.0), time / duration)
                    * scale(order, duration)
            }
            Self::Harmonic { frequency } => {
                let (sine, cosine) = (TAU * frequency * time).sin_cos();
                sine_of(order, sine, cosine) * scale(order, 1.0 / (TAU * frequency))
            }
            Self::Samples(ref samples) => samples.at(order, time),
            Self::SteppedSine(ref sequence) => sequence.at(order, time),
        }
    }

    /// Time \[s\] after which the function is zero for good; infinite for a lasting one.
    pub fn ends_at(&self) -> f64 {
        match *self {
            Self::Zero => 0.0,
            Self::GammaPulse { rise } => GAMMA_PULSE_END * rise,
            Self::HalfSine { duration } | Self::Haversine { duration } => duration,
            Self::Harmonic { .. } | Self::SteppedSine(_) => f64::INFINITY,
            Self::Samples(ref samples) => samples.time[samples.time.len() - 1],
        }
    }

    /// Time in which the function changes \[s\]: the rise of a pulse, a sixth of a period, of samples
    /// twice the integral of their magnitude over their total variation; infinite for zero.
    pub fn time_scale(&self) -> f64 {
        match *self {
            Self::Zero => f64::INFINITY,
            Self::GammaPulse { rise } => rise,
            Self::HalfSine { duration } | Self::Haversine { duration } => 0.5 * duration,
            Self::Harmonic { frequency } => 1.0 / (TAU * frequency),
            Self::Samples(ref samples) => samples.time_scale(),
            Self::SteppedSine(ref sequence) => 1.0 / (TAU * sequence.highest()),
        }
    }

    /// Largest magnitude of the function or a derivative.
    pub fn peak(&self, order: Order) -> f64 {
        let harmonic = |frequency: f64| scale(order, 1.0 / (TAU * frequency));
        match *self {
            Self::Zero => 0.0,
            Self::GammaPulse { rise } => {
                let peak = match order {
                    Order::Derivative => gamma_pulse(order, 1.0 - 0.5 * 2.0_f64.sqrt()),
                    Order::SecondDerivative => 2.0 * E * E,
                    _ => 1.0,
                };
                peak * scale(order, rise)
            }
            Self::HalfSine { duration } => harmonic(0.5 / duration),
            Self::Haversine { duration } if order == Order::Value => scale(order, duration),
            Self::Haversine { duration } => 0.5 * harmonic(1.0 / duration),
            Self::Harmonic { frequency } => harmonic(frequency),
            Self::Samples(ref samples) => samples.peak(order),
            Self::SteppedSine(ref sequence) => harmonic(sequence.highest()),
        }
    }

    /// Checks that every parameter is in its range.
    ///
    /// # Errors
    /// [`StructureError::Setting`] for a time or frequency that is not positive and finite.
    pub fn check(&self) -> Result<(), StructureError> {
        let (value, quantity) = match *self {
            Self::Zero | Self::Samples(_) | Self::SteppedSine(_) => return Ok(()),
            Self::GammaPulse { rise } => (rise, "rise time [s]"),
            Self::HalfSine { duration } | Self::Haversine { duration } => {
                (duration, "pulse duration [s]")
            }
            Self::Harmonic { frequency } => (frequency, "frequency [Hz]"),
        };
        positive(quantity, value).map(|_| ())
    }
}

/// Unit of a derivative or integral of a function of `t / scale`.
fn scale(order: Order, scale: f64) -> f64 {
    match order {
        Order::SecondIntegral => scale * scale,
        Order::Integral => scale,
        Order::Value => 1.0,
        Order::Derivative => scale.recip(),
        Order::SecondDerivative => (scale * scale).recip(),
    }
}

/// `s^2 exp(2 - 2 s)`.
fn gamma_pulse(order: Order, s: f64) -> f64 {
    let decay = (2.0 * (1.0 - s)).exp();
    match order {
        Order::SecondIntegral => {
            0.25 * E * E * s + decay * (0.25 * s * s + 0.5 * s + 0.375) - 0.375 * E * E
        }
        Order::Integral => 0.25 * E * E - decay * (0.5 * s * s + 0.5 * s + 0.25),
        Order::Value => s * s * decay,
        Order::Derivative => 2.0 * s * (1.0 - s) * decay,
        Order::SecondDerivative => (2.0 - 8.0 * s + 4.0 * s * s) * decay,
    }
}

/// `sin(pi s)` up to s = 1; `whole` is s beyond that too.
fn half_sine(order: Order, s: f64, whole: f64) -> f64 {
    let (sine, cosine) = (PI * s).sin_cos();
    match order {
        Order::SecondIntegral => s / PI - sine / (PI * PI) + 2.0 / PI * (whole - s),
        Order::Integral => (1.0 - cosine) / PI,
        Order::Value => sine,
        Order::Derivative => PI * cosine,
        Order::SecondDerivative => -PI * PI * sine,
    }
}

/// `sin^2(pi s)` up to s = 1; `whole` is s beyond that too.
fn haversine(order: Order, s: f64, whole: f64) -> f64 {
    let (sine, cosine) = (TAU * s).sin_cos();
    match order {
        Order::SecondIntegral => {
            0.25 * s * s + (cosine - 1.0) / (2.0 * TAU * TAU) + 0.5 * (whole - s)
        }
        Order::Integral => 0.5 * s - sine / (2.0 * TAU),
        Order::Value => (PI * s).sin().powi(2),
        Order::Derivative => PI * sine,
        Order::SecondDerivative => 2.0 * PI * PI * cosine,
    }
}

/// A sine in radians.
fn sine_of(order: Order, sine: f64, cosine: f64) -> f64 {
    match order {
        Order::SecondIntegral | Order::SecondDerivative => -sine,
        Order::Integral => -cosine,
        Order::Value => sine,
        Order::Derivative => cosine,
    }
}

/// `sin(2 pi f t)` with one frequency f after another, each for a number of whole periods, so that
/// neither the function nor its phase jumps; the last frequency lasts.
///
/// ```
/// use asperity_structure::{SteppedSine, TimeFunction};
///
/// // Two periods at 100 Hz, then 200 Hz.
/// let sequence = SteppedSine::new(&[(100.0, 2), (200.0, 1)])?;
/// assert_eq!(sequence.start(1), Some(0.02));
/// let sine = TimeFunction::SteppedSine(sequence);
/// assert!((sine.value(0.0025) - 1.0).abs() < 1e-12);
/// assert!((sine.value(0.02125) - 1.0).abs() < 1e-12);
/// # Ok::<(), asperity_structure::StructureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SteppedSine {
    /// Start \[s\] and frequency \[Hz\] of each part.
    parts: Arc<[(f64, f64)]>,
    end: f64,
}

impl SteppedSine {
    /// Frequencies \[Hz\] for numbers of periods.
    ///
    /// # Errors
    /// [`StructureError::Setting`] for no frequency, or one that is not positive and finite.
    pub fn new(frequencies: &[(f64, usize)]) -> Result<Self, StructureError> {
        if frequencies.is_empty() {
            let (quantity, accepted) = ("number of frequencies", "at least 1");
            return Err(StructureError::Setting { quantity, value: 0.0, accepted });
        }
        let mut parts = Vec::with_capacity(frequencies.len());
        let mut end = 0.0;
        for &(frequency, periods) in frequencies {
            parts.push((end, positive("frequency [Hz]", frequency)?));
            end += periods as f64 / frequency;
        }
        Ok(Self { parts: parts.into(), end })
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

    /// Integrals are those of the sine of the present frequency, without drift.
    fn at(&self, order: Order, time: f64) -> f64 {
        let after = self.parts.partition_point(|part| part.0 <= time);
        let (start, frequency) = self.parts[after.max(1) - 1];
        let (sine, cosine) = (TAU * frequency * (time - start)).sin_cos();
        sine_of(order, sine, cosine) * scale(order, 1.0 / (TAU * frequency))
    }
}

/// Samples of a function at increasing times, linear between them.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledFunction {
    time: Vec<f64>,
    value: Vec<f64>,
    /// Integral and second integral at each time.
    integrals: Vec<[f64; 2]>,
}

impl SampledFunction {
    /// The function through `value` at `time` \[s\].
    ///
    /// # Errors
    /// [`StructureError::Samples`] for fewer than two samples, columns of unequal length, values that
    /// are not finite, or times that do not increase.
    pub fn new(time: Vec<f64>, value: Vec<f64>) -> Result<Self, StructureError> {
        let refuse = |row, quantity, value, accepted| {
            Err(StructureError::Samples { row, quantity, value, accepted })
        };
        if time.len() < 2 || time.len() != value.len() {
            let accepted = "at least 2, and equal for time and value";
            return refuse(0, "number of samples", value.len() as f64, accepted);
        }
        for (row, (&t, &v)) in time.iter().zip(&value).enumerate() {
            if !v.is_finite() {
                return refuse(row, "value", v, "finite");
            }
            if !t.is_finite() || (row > 0 && t <= time[row - 1]) {
                return refuse(row, "time [s]", t, "finite and later than the row before");
            }
        }
        Ok(Self::with_integrals(time, value))
    }

    fn with_integrals(time: Vec<f64>, value: Vec<f64>) -> Self {
        let mut integrals = Vec::with_capacity(time.len());
        let [mut first, mut second] = [0.0, 0.0];
        for (row, &v) in value.iter().enumerate() {
            if row > 0 {
                let (step, before) = (time[row] - time[row - 1], value[row - 1]);
                second += step * (first + step * (before / 3.0 + v / 6.0));
                first += 0.5 * step * (before + v);
            }
            integrals.push([first, second]);
        }
        Self { time, value, integrals }
    }

    /// The samples over their largest magnitude, and that magnitude; samples of zero stay.
    #[must_use]
    pub fn normalised(&self) -> (Self, f64) {
        let peak = self.value.iter().fold(0.0, |most: f64, value| value.abs().max(most));
        if peak == 0.0 {
            return (self.clone(), 0.0);
        }
        let value = self.value.iter().map(|value| value / peak).collect();
        (Self::with_integrals(self.time.clone(), value), peak)
    }

    /// First time \[s\] and value.
    pub fn first(&self) -> (f64, f64) {
        (self.time[0], self.value[0])
    }

    /// The second derivative of the natural cubic spline through the samples, which is linear between
    /// them and zero at both ends, and the slope of the spline at the first.
    #[must_use]
    pub fn spline(&self) -> (Self, f64) {
        let n = self.time.len();
        let step = |i: usize| self.time[i + 1] - self.time[i];
        let slope = |i: usize| (self.value[i + 1] - self.value[i]) / step(i);
        // Thomas's elimination of `h_(i-1) m_(i-1) + 2 (h_(i-1) + h_i) m_i + h_i m_(i+1) = 6 (...)`.
        let (mut upper, mut right) = (vec![0.0; n], vec![0.0; n]);
        for i in 1..n - 1 {
            let pivot = 2.0 * (step(i - 1) + step(i)) - step(i - 1) * upper[i - 1];
            upper[i] = step(i) / pivot;
            right[i] = (6.0 * (slope(i) - slope(i - 1)) - step(i - 1) * right[i - 1]) / pivot;
        }
        let mut bend = vec![0.0; n];
        for i in (1..n - 1).rev() {
            bend[i] = right[i] - upper[i] * bend[i + 1];
        }
        let start = slope(0) - step(0) * bend[1] / 6.0;
        (Self::with_integrals(self.time.clone(), bend), start)
    }

    /// The derivative of the polygon through the samples: constant between them.
    #[must_use]
    pub fn derivative(&self) -> Self {
        let (mut time, mut value) = (Vec::new(), Vec::new());
        for (times, values) in self.time.windows(2).zip(self.value.windows(2)) {
            time.extend(times);
            value.extend([(values[1] - values[0]) / (times[1] - times[0]); 2]);
        }
        Self::with_integrals(time, value)
    }

    /// Twice the integral of the magnitude over the total variation \[s\]: about the rise time of
    /// a pulse, about a step of noise; at least the mean spacing.
    fn time_scale(&self) -> f64 {
        let last = self.time.len() - 1;
        let spacing = (self.time[last] - self.time[0]) / last as f64;
        let (mut area, mut variation) = (0.0, self.value[0].abs() + self.value[last].abs());
        for (times, values) in self.time.windows(2).zip(self.value.windows(2)) {
            area += 0.5 * (values[0].abs() + values[1].abs()) * (times[1] - times[0]);
            variation += (values[1] - values[0]).abs();
        }
        if variation > 0.0 { spacing.max(2.0 * area / variation) } else { spacing }
    }

    fn peak(&self, order: Order) -> f64 {
        let slopes = || {
            let pairs = self.time.windows(2).zip(self.value.windows(2));
            pairs.map(|(t, v)| ((v[1] - v[0]) / (t[1] - t[0])).abs())
        };
        match order {
            Order::Value => self.value.iter().fold(0.0, |most, value| value.abs().max(most)),
            Order::Derivative => slopes().fold(0.0, f64::max),
            _ => 0.0,
        }
    }

    fn at(&self, order: Order, time: f64) -> f64 {
        let after = self.time.partition_point(|&t| t <= time);
        if after == 0 {
            return 0.0;
        }
        let before = after - 1;
        let [first, second] = self.integrals[before];
        let past = time - self.time[before];
        if after == self.time.len() {
            return match order {
                Order::SecondIntegral => second + first * past,
                Order::Integral => first,
                Order::Value if past == 0.0 => self.value[before],
                _ => 0.0,
            };
        }
        let (v0, v1) = (self.value[before], self.value[after]);
        let slope = (v1 - v0) / (self.time[after] - self.time[before]);
        match order {
            Order::SecondIntegral => {
                second + past * (first + past * (0.5 * v0 + slope * past / 6.0))
            }
            Order::Integral => first + past * (v0 + 0.5 * slope * past),
            Order::Value => v0 + (v1 - v0) * past / (self.time[after] - self.time[before]),
            Order::Derivative => slope,
            Order::SecondDerivative => 0.0,
        }
    }
}

fn positive(quantity: &'static str, value: f64) -> Result<f64, StructureError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(StructureError::Setting { quantity, value, accepted: "positive and finite" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrals in closed form: gamma tr e^2 / 4, half-sine 2 T / pi, haversine T / 2.
    #[test]
    fn pulses_have_their_closed_form_integral_and_peak() {
        let gamma = TimeFunction::GammaPulse { rise: 0.34e-3 };
        let half = TimeFunction::HalfSine { duration: 1e-3 };
        let haversine = TimeFunction::Haversine { duration: 1e-3 };
        let expected = [0.34e-3 * 2.0_f64.exp() / 4.0, 2e-3 / PI, 0.5e-3];
        for (pulse, expected) in [gamma, half, haversine].into_iter().zip(expected) {
            let n = 1_000_000;
            let step = 0.01 / f64::from(n);
            let value = |i: u32| pulse.value((f64::from(i) + 0.5) * step);
            let integral = (0..n).map(value).sum::<f64>() * step;
            assert!((integral / expected - 1.0).abs() < 1e-9);
            assert!((pulse.at(Order::Integral, 0.02) / expected - 1.0).abs() < 1e-12);
            assert_eq!(pulse.value(-1e-9), 0.0);
            assert_eq!(pulse.value(1.0), 0.0);
        }
    }

    #[test]
    fn the_cut_of_the_gamma_pulse_is_below_round_off() {
        assert!(TimeFunction::GammaPulse { rise: 1.0 }.value(GAMMA_PULSE_END) < 1e-18);
    }

    /// The peaks of functions and derivatives against dense samples.
    #[test]
    fn peaks_are_the_largest_magnitudes() {
        for function in [
            TimeFunction::GammaPulse { rise: 0.3 },
            TimeFunction::HalfSine { duration: 0.7 },
            TimeFunction::Haversine { duration: 0.7 },
            TimeFunction::Harmonic { frequency: 1.3 },
        ] {
            for order in [Order::Value, Order::Derivative, Order::SecondDerivative] {
                let values = (0..200_000).map(|n| function.at(order, 1e-5 * f64::from(n)).abs());
                let found = values.fold(0.0, f64::max);
                assert!(
                    (function.peak(order) / found - 1.0).abs() < 1e-6,
                    "{function:?} {order:?}"
                );
            }
        }
    }

    /// Whole periods: no jump, and the slope changes with the frequency only.
    #[test]
    fn frequencies_follow_without_a_jump() {
        let parts = [(100.0, 3), (130.0, 5), (170.0, 2)];
        let sequence = SteppedSine::new(&parts).unwrap();
        assert_eq!(sequence.start(3), None);
        let sine = TimeFunction::SteppedSine(sequence.clone());
        for (place, pair) in parts.windows(2).enumerate() {
            let at = sequence.start(place + 1).unwrap();
            let slope = |sign: f64| sign * sine.value(at + sign * 1e-7) / 1e-7 / TAU;
            assert!((slope(-1.0) / pair[0].0 - 1.0).abs() < 1e-6);
            assert!((slope(1.0) / pair[1].0 - 1.0).abs() < 1e-6);
        }
        assert!((sequence.end() - (0.03 + 5.0 / 130.0 + 2.0 / 170.0)).abs() < 1e-15);
    }

    #[test]
    fn samples_that_make_no_function_are_errors() {
        let of = |time: &[f64], value: &[f64]| SampledFunction::new(time.to_vec(), value.to_vec());
        for (time, value) in [
            (&[0.0][..], &[1.0][..]),
            (&[0.0, 1.0], &[1.0]),
            (&[0.0, 0.0], &[1.0, 1.0]),
            (&[0.0, f64::NAN], &[1.0, 1.0]),
            (&[0.0, 1.0], &[1.0, f64::INFINITY]),
        ] {
            assert!(matches!(of(time, value), Err(StructureError::Samples { .. })));
        }
    }
}
