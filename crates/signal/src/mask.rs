//! Where the force has enough content to divide by.

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
