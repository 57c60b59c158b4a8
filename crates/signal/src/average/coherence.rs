//! How much of the response the force explains.

/// Ordinary coherence `|Gfx|^2 / (Gff Gxx)` of at least two hits.
///
/// High by about `(1 - g2)^2 / n` on average; two hits say little.
#[derive(Debug, Clone, PartialEq)]
pub struct Coherence {
    /// Frequencies, in hertz.
    pub frequency_hz: Vec<f64>,
    /// Coherence `g2`, 0 to 1; NaN where force or response has no content at all.
    pub values: Vec<f64>,
    /// Number of hits `n`.
    pub averages: usize,
}

impl Coherence {
    /// Normalised random error of `|H|`: its standard deviation over its value.
    ///
    /// ```text
    /// e = sqrt((1 - g2) / (2 n g2))
    /// ```
    ///
    /// For noise on the response and `e` well below one; infinite where the
    /// coherence is zero. Source: Bendat and Piersol, *Random Data*, 4th ed. 2010, eq. (9.90).
    pub fn magnitude_error(&self) -> Vec<f64> {
        let twice = 2.0 * self.averages as f64;
        let error = |g2: &f64| ((1.0 - g2).max(0.0) / (twice * g2)).sqrt();
        self.values.iter().map(error).collect()
    }

    /// Standard deviation of the phase, in radians: for small errors that of the magnitude.
    ///
    /// At most `pi / sqrt(3)`, that of a phase that is anything.
    pub fn phase_error(&self) -> Vec<f64> {
        let most = std::f64::consts::PI / 3.0_f64.sqrt();
        self.magnitude_error().iter().map(|error| error.min(most)).collect()
    }
}
