//! Frequency response functions, their conversion and their validity.

use crate::form::FrfForm;
use num_complex::{Complex64, ComplexFloat};
use std::f64::consts::TAU;

/// A frequency response function sampled at given frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Frf {
    /// Frequencies, in hertz.
    pub frequency_hz: Vec<f64>,
    /// Values at these frequencies, in the unit of [`FrfForm::unit`].
    pub values: Vec<Complex64>,
    /// The form.
    pub form: FrfForm,
}

impl Frf {
    /// The function in another form: a factor `i w` per time derivative, and the reciprocal for
    /// force over motion.
    ///
    /// At zero frequency a conversion that multiplies by `i w` gives zero, and one that divides by
    /// it, such as accelerance to receptance, gives NaN; [`Frf::without_dc`] removes that value. The
    /// reciprocal of zero is NaN.
    ///
    /// ```
    /// use asperity_signal::{Complex64, Frf, FrfForm};
    ///
    /// let spring = Frf {
    ///     frequency_hz: vec![0.0, 50.0],
    ///     values: vec![Complex64::new(1e-6, 0.0); 2],
    ///     form: FrfForm::Receptance,
    /// };
    /// assert_eq!(spring.to(FrfForm::DynamicStiffness).values[1].re, 1e6);
    /// ```
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

    /// The function without zero frequency.
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

    /// Number of frequencies with a value.
    pub fn len(&self) -> usize {
        self.values.len().min(self.frequency_hz.len())
    }

    /// True without frequencies.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Frequencies at which the force is strong enough for a valid frequency response function.
///
/// The spectrum of a force pulse has zeros (a half-sine at 1.5, 2.5, ... over
/// its duration) and decreases with frequency; `U / F` is meaningless near a zero. A frequency is
/// valid where
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
    /// Validity at each frequency.
    pub valid: Vec<bool>,
    /// Smallest valid `|F|`, the threshold times the maximum, in N s.
    pub floor: f64,
}

impl ForceMask {
    /// The mask of the magnitudes `|F|` \[N s\] of a force spectrum.
    pub(crate) fn new(frequency_hz: Vec<f64>, magnitude: &[f64], threshold: f64) -> Self {
        let floor = threshold * magnitude.iter().copied().fold(0.0, f64::max);
        Self { frequency_hz, valid: magnitude.iter().map(|&value| value >= floor).collect(), floor }
    }

    /// Valid fraction of the frequencies, 0 to 1; NaN without frequencies.
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

/// Converts one value to another form; NaN for a division by zero.
pub(crate) fn convert(value: Complex64, frequency: f64, from: FrfForm, to: FrfForm) -> Complex64 {
    // Each time derivative multiplies a motion by i w and divides its reciprocal by it.
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
