//! Statistics over the hits of an average: coherence, mean and deviation of the magnitude.

/// Ordinary coherence `|Gfx|^2 / (Gff Gxx)` of at least two hits.
///
/// Biased by about `(1 - g2)^2 / n`, much for two hits.
#[derive(Debug, Clone, PartialEq)]
pub struct Coherence {
    /// Frequencies, in hertz.
    pub frequency_hz: Vec<f64>,
    /// Coherence `g2`, 0 to 1; NaN where force or response is zero.
    pub values: Vec<f64>,
    /// Number of hits `n`.
    pub averages: usize,
}

impl Coherence {
    /// Normalised random error of `|H|`, its standard deviation over its value.
    ///
    /// ```text
    /// e = sqrt((1 - g2) / (2 n g2))
    /// ```
    ///
    /// Valid for noise on the response and `e` well below one; infinite where the
    /// coherence is zero. Source: Bendat and Piersol, *Random Data*, 4th ed. 2010, eq. (9.90),
    /// doi 10.1002/9781118032428.
    pub fn magnitude_error(&self) -> Vec<f64> {
        let twice = 2.0 * self.averages as f64;
        let error = |g2: &f64| ((1.0 - g2).max(0.0) / (twice * g2)).sqrt();
        self.values.iter().map(error).collect()
    }

    /// Standard deviation of the phase, in radians: the magnitude's for small errors, at most
    /// `pi / sqrt(3)`, the deviation of a uniformly distributed phase.
    pub fn phase_error(&self) -> Vec<f64> {
        let most = std::f64::consts::PI / 3.0_f64.sqrt();
        self.magnitude_error().iter().map(|error| error.min(most)).collect()
    }
}

/// Mean and standard deviation over the hits of the magnitude `|X/F|` of each.
///
/// For a nonlinear structure under different forces the deviation is not noise.
#[derive(Debug, Clone, PartialEq)]
pub struct MagnitudeSpread {
    /// Frequencies, in hertz.
    pub frequency_hz: Vec<f64>,
    /// Mean of `|X/F|`.
    pub mean: Vec<f64>,
    /// Standard deviation of `|X/F|`, with `n - 1`.
    pub standard_deviation: Vec<f64>,
}

/// Running means and sums of squared deviations, one for each frequency.
///
/// Source: B. P. Welford, Technometrics 4 (1962), 419-420, doi 10.1080/00401706.1962.10490022.
#[derive(Debug, Clone)]
pub(super) struct RunningVariance {
    mean: Vec<f64>,
    square: Vec<f64>,
}

impl RunningVariance {
    pub(super) fn new(bins: usize) -> Self {
        Self { mean: vec![0.0; bins], square: vec![0.0; bins] }
    }

    /// Means and sums of squared deviations.
    pub(super) fn into_parts(self) -> [Vec<f64>; 2] {
        [self.mean, self.square]
    }

    pub(super) fn from_parts([mean, square]: [Vec<f64>; 2]) -> Self {
        Self { mean, square }
    }

    /// Adds the value number `count` (from one) of a bin.
    pub(super) fn push(&mut self, bin: usize, value: f64, count: usize) {
        let difference = value - self.mean[bin];
        self.mean[bin] += difference / count as f64;
        self.square[bin] += difference * (value - self.mean[bin]);
    }

    /// Adds the `more` values in each bin of `other` to the `count` here.
    ///
    /// Source: T. F. Chan and others, Am. Stat. 37 (1983), 242-247,
    /// doi 10.1080/00031305.1983.10483115.
    pub(super) fn merge(&mut self, count: usize, other: &Self, more: usize) {
        let (a, b) = (count as f64, more as f64);
        let bins = self.mean.iter_mut().zip(&mut self.square);
        let others = other.mean.iter().zip(&other.square);
        for ((mean, square), (other_mean, other_square)) in bins.zip(others) {
            let difference = other_mean - *mean;
            *mean += difference * b / (a + b);
            *square += other_square + difference * difference * a * b / (a + b);
        }
    }

    /// The spread of at least two values.
    pub(super) fn spread(&self, frequency_hz: Vec<f64>, count: usize) -> MagnitudeSpread {
        let degrees = count as f64 - 1.0;
        let deviation = |square: &f64| (square / degrees).sqrt();
        MagnitudeSpread {
            frequency_hz,
            mean: self.mean.clone(),
            standard_deviation: self.square.iter().map(deviation).collect(),
        }
    }
}
