//! Distributions of one input by their quantile function.

mod kind;

use kind::Kind;
pub(crate) use kind::{normal_cumulative, normal_quantile};

use crate::error::DesignError;

/// The distribution of one input, given by its quantile function `F^-1`.
///
/// | distribution | quantile at `p` |
/// |---|---|
/// | uniform | `a + (b - a) p` |
/// | log-uniform | `a (b/a)^p` |
/// | normal | `mean + sd Phi^-1(p)` |
/// | lognormal | `median exp(s Phi^-1(p))` |
/// | triangular | piecewise square roots, with the mode as peak of the density |
/// | choice | number of the option, from 0 |
///
/// ```
/// use asperity_sampling::Distribution;
///
/// let ratio = Distribution::log_uniform(0.001, 0.1)?;
/// assert!((ratio.quantile(0.5) - 0.01).abs() < 1e-15);
/// # Ok::<(), asperity_sampling::DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    kind: Kind,
}

impl Distribution {
    /// All values between `lower` and `upper` are equally likely.
    ///
    /// # Errors
    /// [`DesignError::Distribution`] unless both are finite and increasing.
    pub fn uniform(lower: f64, upper: f64) -> Result<Self, DesignError> {
        increasing("uniform", lower, upper)?;
        Ok(Self { kind: Kind::Uniform { lower, upper } })
    }

    /// The logarithm is uniform between those of `lower` and `upper`.
    ///
    /// # Errors
    /// [`DesignError::Distribution`] unless both are positive, finite and increasing.
    pub fn log_uniform(lower: f64, upper: f64) -> Result<Self, DesignError> {
        positive("log-uniform", "the lower end", lower)?;
        increasing("log-uniform", lower, upper)?;
        Ok(Self { kind: Kind::LogUniform { lower, upper } })
    }

    /// Normal distribution.
    ///
    /// # Errors
    /// [`DesignError::Distribution`] unless both are finite and the standard deviation is positive.
    pub fn normal(mean: f64, standard_deviation: f64) -> Result<Self, DesignError> {
        finite("normal", "the mean", mean)?;
        positive("normal", "the standard deviation", standard_deviation)?;
        Ok(Self { kind: Kind::Normal { mean, standard_deviation } })
    }

    /// The logarithm of the value over `median` is normal with mean 0 and standard deviation
    /// `log_standard_deviation`, which for small values is the relative standard deviation.
    ///
    /// # Errors
    /// [`DesignError::Distribution`] unless both are positive and finite.
    pub fn lognormal(median: f64, log_standard_deviation: f64) -> Result<Self, DesignError> {
        positive("lognormal", "the median", median)?;
        positive("lognormal", "the standard deviation of the logarithm", log_standard_deviation)?;
        Ok(Self { kind: Kind::Lognormal { median, log_standard_deviation } })
    }

    /// The density rises linearly from `lower` to `mode` and falls linearly to `upper`.
    ///
    /// # Errors
    /// [`DesignError::Distribution`] unless the ends are finite and increasing, and the mode is
    /// between them or equal to one.
    pub fn triangular(lower: f64, mode: f64, upper: f64) -> Result<Self, DesignError> {
        increasing("triangular", lower, upper)?;
        if !(lower..=upper).contains(&mode) {
            return Err(DesignError::Distribution {
                distribution: "triangular",
                quantity: "the mode",
                value: mode,
                expected: "between the ends",
            });
        }
        Ok(Self { kind: Kind::Triangular { lower, mode, upper } })
    }

    /// One of several options, with probabilities in proportion to `weights`. Its values are the
    /// numbers of the options, from 0.
    ///
    /// # Errors
    /// [`DesignError::Distribution`] without weights, or for one that is not positive and finite.
    pub fn choice(weights: &[f64]) -> Result<Self, DesignError> {
        if weights.is_empty() {
            return Err(DesignError::Distribution {
                distribution: "choice",
                quantity: "the number of options",
                value: 0.0,
                expected: "at least 1",
            });
        }
        for &weight in weights {
            positive("choice", "a weight", weight)?;
        }
        let total: f64 = weights.iter().sum();
        finite("choice", "the sum of the weights", total)?;
        let mut reached = 0.0;
        let cumulative = weights.iter().map(|weight| {
            reached += weight / total;
            reached
        });
        Ok(Self { kind: Kind::Choice { cumulative: cumulative.collect() } })
    }

    /// The value that is not exceeded with `probability`, which is in (0, 1).
    ///
    /// At 0 and 1 it is an end of the distribution, which may be infinite.
    pub fn quantile(&self, probability: f64) -> f64 {
        self.kind.quantile(probability)
    }

    /// The probability of values up to `value`.
    pub fn cumulative(&self, value: f64) -> f64 {
        self.kind.cumulative(value)
    }

    /// Mean; of a choice that of the options' numbers.
    pub fn mean(&self) -> f64 {
        self.kind.mean()
    }

    /// Variance; of a choice that of the options' numbers.
    pub fn variance(&self) -> f64 {
        self.kind.variance()
    }

    /// Number of options of a choice; none for the other distributions.
    pub fn options(&self) -> Option<usize> {
        match &self.kind {
            Kind::Choice { cumulative } => Some(cumulative.len()),
            _ => None,
        }
    }
}

fn finite(
    distribution: &'static str,
    quantity: &'static str,
    value: f64,
) -> Result<(), DesignError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(DesignError::Distribution { distribution, quantity, value, expected: "finite" })
}

fn positive(
    distribution: &'static str,
    quantity: &'static str,
    value: f64,
) -> Result<(), DesignError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(DesignError::Distribution {
        distribution,
        quantity,
        value,
        expected: "positive and finite",
    })
}

fn increasing(distribution: &'static str, lower: f64, upper: f64) -> Result<(), DesignError> {
    finite(distribution, "the lower end", lower)?;
    finite(distribution, "the upper end", upper)?;
    let width = upper - lower;
    if width > 0.0 && width.is_finite() {
        return Ok(());
    }
    Err(DesignError::Distribution {
        distribution,
        quantity: "the upper end minus the lower one",
        value: width,
        expected: "positive and finite",
    })
}
