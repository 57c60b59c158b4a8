//! How the hits of an average differ.

/// Mean and standard deviation over the hits of the magnitude of each hit's own function.
///
/// In a nonlinear structure struck with different forces this is physics, not noise.
#[derive(Debug, Clone, PartialEq)]
pub struct MagnitudeSpread {
    /// Frequencies, in hertz.
    pub frequency_hz: Vec<f64>,
    /// Mean of `|X/F|`.
    pub mean: Vec<f64>,
    /// Standard deviation of `|X/F|` about it, with `n - 1`.
    pub standard_deviation: Vec<f64>,
}

/// Running means and sums of squares, one for each frequency.
///
/// Source: B. P. Welford, Technometrics 4 (1962), 419-420.
#[derive(Debug, Clone)]
pub(super) struct Welford {
    mean: Vec<f64>,
    square: Vec<f64>,
}

impl Welford {
    pub(super) fn new(bins: usize) -> Self {
        Self { mean: vec![0.0; bins], square: vec![0.0; bins] }
    }

    /// Adds the value number `count` (from one) of a bin.
    pub(super) fn push(&mut self, bin: usize, value: f64, count: usize) {
        let difference = value - self.mean[bin];
        self.mean[bin] += difference / count as f64;
        self.square[bin] += difference * (value - self.mean[bin]);
    }

    /// Joins the values behind `other` (`more` in each bin) to those here (`count`).
    ///
    /// Source: T. F. Chan and others, Am. Stat. 37 (1983), 242-247.
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
