//! Quantiles, cumulative probabilities and moments of the distributions.

use std::f64::consts::FRAC_1_SQRT_2;

use statrs::distribution::{ContinuousCDF, Normal};

/// A distribution with parameters that have been checked.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Kind {
    Uniform { lower: f64, upper: f64 },
    LogUniform { lower: f64, upper: f64 },
    Normal { mean: f64, standard_deviation: f64 },
    Lognormal { median: f64, log_standard_deviation: f64 },
    Triangular { lower: f64, mode: f64, upper: f64 },
    Choice { cumulative: Vec<f64> },
}

impl Kind {
    pub(super) fn quantile(&self, p: f64) -> f64 {
        let p = p.clamp(0.0, 1.0);
        match self {
            Self::Uniform { lower, upper } => {
                // Rounding must not pass the upper end, nor miss it.
                if p < 1.0 { (lower + (upper - lower) * p).min(*upper) } else { *upper }
            }
            Self::LogUniform { lower, upper } => {
                // From the nearer end, so that both are met exactly.
                let range = upper.ln() - lower.ln();
                let value = if p < 0.5 {
                    lower * (range * p).exp()
                } else {
                    upper * (-range * (1.0 - p)).exp()
                };
                value.clamp(*lower, *upper)
            }
            Self::Normal { mean, standard_deviation: s } => mean + s * normal_quantile(p),
            Self::Lognormal { median, log_standard_deviation: s } => {
                median * (s * normal_quantile(p)).exp()
            }
            Self::Triangular { lower, mode, upper } => {
                let width = upper - lower;
                let rising = mode - lower;
                if p * width <= rising {
                    lower + (p * width * rising).sqrt()
                } else {
                    upper - ((1.0 - p) * width * (upper - mode)).sqrt()
                }
            }
            Self::Choice { cumulative } => {
                let below = cumulative.partition_point(|&reached| reached <= p);
                below.min(cumulative.len() - 1) as f64
            }
        }
    }

    pub(super) fn cumulative(&self, x: f64) -> f64 {
        match self {
            Self::Uniform { lower, upper } => ((x - lower) / (upper - lower)).clamp(0.0, 1.0),
            Self::LogUniform { lower, upper } => {
                let x = x.clamp(*lower, *upper);
                (x.ln() - lower.ln()) / (upper.ln() - lower.ln())
            }
            Self::Normal { mean, standard_deviation: s } => normal_cumulative((x - mean) / s),
            Self::Lognormal { median, log_standard_deviation: s } => {
                if x > 0.0 {
                    normal_cumulative((x / median).ln() / s)
                } else {
                    0.0
                }
            }
            Self::Triangular { lower, mode, upper } => {
                let x = x.clamp(*lower, *upper);
                let width = upper - lower;
                if x < *mode {
                    (x - lower).powi(2) / (width * (mode - lower))
                } else if x < *upper {
                    1.0 - (upper - x).powi(2) / (width * (upper - mode))
                } else {
                    1.0
                }
            }
            Self::Choice { cumulative } => {
                if x < 0.0 {
                    return 0.0;
                }
                let last = cumulative.len() - 1;
                if x >= last as f64 { 1.0 } else { cumulative[x as usize] }
            }
        }
    }

    pub(super) fn mean(&self) -> f64 {
        match self {
            Self::Uniform { lower, upper } => lower + 0.5 * (upper - lower),
            Self::LogUniform { lower, upper } => (upper - lower) / (upper.ln() - lower.ln()),
            Self::Normal { mean, .. } => *mean,
            Self::Lognormal { median, log_standard_deviation: s } => median * (0.5 * s * s).exp(),
            Self::Triangular { lower, mode, upper } => (lower + mode + upper) / 3.0,
            Self::Choice { cumulative } => {
                probabilities(cumulative).enumerate().map(|(i, p)| i as f64 * p).sum()
            }
        }
    }

    pub(super) fn variance(&self) -> f64 {
        match self {
            Self::Uniform { lower, upper } => (upper - lower).powi(2) / 12.0,
            Self::LogUniform { lower, upper } => {
                let range = upper.ln() - lower.ln();
                let square = (upper - lower) * (upper + lower) / (2.0 * range);
                square - self.mean().powi(2)
            }
            Self::Normal { standard_deviation, .. } => standard_deviation.powi(2),
            Self::Lognormal { log_standard_deviation: s, .. } => {
                self.mean().powi(2) * (s * s).exp_m1()
            }
            Self::Triangular { lower: a, mode: c, upper: b } => {
                ((c - a).powi(2) + (b - a).powi(2) + (b - c).powi(2)) / 36.0
            }
            Self::Choice { cumulative } => {
                let mean = self.mean();
                let squares = probabilities(cumulative).enumerate();
                squares.map(|(i, p)| (i as f64 - mean).powi(2) * p).sum()
            }
        }
    }
}

fn probabilities(cumulative: &[f64]) -> impl Iterator<Item = f64> + '_ {
    let mut below = 0.0;
    cumulative.iter().map(move |&reached| reached - std::mem::replace(&mut below, reached))
}

/// The quantile of the standard normal distribution.
pub(crate) fn normal_quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}

/// The probability of a standard normal number up to `z`.
pub(crate) fn normal_cumulative(z: f64) -> f64 {
    // That of statrs has a relative error of 1e-10.
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}
