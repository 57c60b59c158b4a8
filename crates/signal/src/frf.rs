//! Frequency response functions and their conversion.

use crate::form::FrfForm;
use realfft::num_complex::{Complex64, ComplexFloat};
use std::f64::consts::TAU;

/// A frequency response function sampled at given frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Frf {
    /// Frequencies, in hertz.
    pub frequency_hz: Vec<f64>,
    /// Values at these frequencies, in the unit of [`FrfForm::unit`].
    pub values: Vec<Complex64>,
    /// What is divided by what.
    pub form: FrfForm,
}

impl Frf {
    /// The same function in another form: `i w` per derivative, and the reciprocal.
    ///
    /// Exact up to rounding at every frequency but zero. There `i w = 0`, and
    /// only what exists is returned: forms of more derivatives of the motion
    /// are zero (a mobility at rest), and conversions that would divide by
    /// zero, such as accelerance to receptance or receptance to mechanical
    /// impedance, are NaN. [`Frf::without_dc`] drops that value. A function
    /// that is itself zero has NaN as its reciprocal.
    #[must_use]
    pub fn to(&self, form: FrfForm) -> Self {
        let values = self
            .frequency_hz
            .iter()
            .zip(&self.values)
            .map(|(&frequency, &value)| convert(value, frequency, self.form, form))
            .collect();
        Self { frequency_hz: self.frequency_hz.clone(), values, form }
    }

    /// The function without its values at zero frequency.
    #[must_use]
    pub fn without_dc(&self) -> Self {
        let (frequency_hz, values) = self
            .frequency_hz
            .iter()
            .zip(&self.values)
            .filter(|(frequency, _)| **frequency != 0.0)
            .unzip();
        Self { frequency_hz, values, form: self.form }
    }

    /// Magnitudes, in the unit of the form.
    pub fn magnitude(&self) -> Vec<f64> {
        self.values.iter().map(|value| value.norm()).collect()
    }

    /// Phases in `(-pi, pi]`, in radians; a receptance falls from 0 to `-pi` through resonance.
    pub fn phase(&self) -> Vec<f64> {
        self.values.iter().map(|value| value.arg()).collect()
    }

    /// Number of frequencies that have a value.
    pub fn len(&self) -> usize {
        self.values.len().min(self.frequency_hz.len())
    }

    /// Whether there is no frequency.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Frequencies at which a frequency response function can be believed.
///
/// A force pulse has a spectrum with zeros (a half-sine at 1.5, 2.5, ... over
/// its duration) and a fall-off; there `U / F` divides noise, or a nonlinear
/// response, by nothing. A frequency is valid where
///
/// ```text
/// |F(f)| >= threshold * max |F|
/// ```
///
/// with the maximum over the grid of the mask, zero to half the sample rate.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceMask {
    /// Frequencies, in hertz.
    pub frequency_hz: Vec<f64>,
    /// Whether the force is strong enough there.
    pub valid: Vec<bool>,
    /// The smallest `|F|` accepted: the threshold times the maximum, in N s.
    pub floor: f64,
}

impl ForceMask {
    /// The mask of the magnitudes `|F|` \[N s\] of a force spectrum.
    pub(crate) fn new(frequency_hz: Vec<f64>, magnitude: &[f64], threshold: f64) -> Self {
        let floor = threshold * magnitude.iter().copied().fold(0.0, f64::max);
        Self { frequency_hz, valid: magnitude.iter().map(|&value| value >= floor).collect(), floor }
    }

    /// Fraction of the frequencies that are valid, 0 to 1; NaN for no frequency.
    pub fn coverage(&self) -> f64 {
        let valid = self.valid.iter().filter(|valid| **valid).count();
        valid as f64 / self.valid.len() as f64
    }

    /// The lowest frequency that is not valid, in hertz.
    pub fn first_masked_hz(&self) -> Option<f64> {
        let index = self.valid.iter().position(|valid| !valid)?;
        self.frequency_hz.get(index).copied()
    }
}

/// One value, from one form to another; NaN where a division by zero is asked.
pub(crate) fn convert(value: Complex64, frequency: f64, from: FrfForm, to: FrfForm) -> Complex64 {
    // Each derivative multiplies a motion by i w and divides its reciprocal by it.
    let derivatives = to.derivatives() - from.derivatives();
    match (from.is_inverse(), to.is_inverse()) {
        (false, false) => differentiate(value, frequency, derivatives),
        (true, true) => differentiate(value, frequency, -derivatives),
        (false, true) => reciprocal(differentiate(value, frequency, derivatives)),
        (true, false) => differentiate(reciprocal(value), frequency, derivatives),
    }
}

/// `value (i w)^order`, NaN for a negative order at `w = 0`.
fn differentiate(value: Complex64, frequency: f64, order: i32) -> Complex64 {
    let omega = TAU * frequency;
    let imaginary_unit = Complex64::I;
    match order {
        0 => value,
        _ if order < 0 && omega == 0.0 => Complex64::new(f64::NAN, f64::NAN),
        1 => value * imaginary_unit * omega,
        -1 => value * -imaginary_unit / omega,
        2 => value * -(omega * omega),
        _ => value / -(omega * omega),
    }
}

/// `1 / value`, NaN for zero.
fn reciprocal(value: Complex64) -> Complex64 {
    if value == Complex64::ZERO { Complex64::new(f64::NAN, f64::NAN) } else { value.recip() }
}
