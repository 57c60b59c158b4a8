//! One number to identify: its name, bounds, working coordinate and prior.

use crate::error::IdentifyError;

/// The working coordinate `x` in which an unknown is fitted and has its prior.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// `x = value`.
    Linear,
    /// `x = ln(value)`, for positive unknowns whose magnitude is in question.
    Logarithmic,
}

/// What is known before the measurement: a normal distribution of the working coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Mean, in the working coordinate.
    pub mean: f64,
    /// Standard deviation, in the working coordinate, positive.
    pub standard_deviation: f64,
}

/// One unknown of a model. Its bounds are hard: no point outside is ever asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    name: String,
    start: f64,
    lower: f64,
    upper: f64,
    scale: Scale,
    prior: Option<Prior>,
}

impl Unknown {
    /// An unknown in `bounds = [lower, upper]` (values, in the unknown's own unit).
    ///
    /// # Errors
    ///
    /// [`IdentifyError::Bounds`] unless the bounds are finite and increasing, and positive on a
    /// logarithmic scale; [`IdentifyError::Start`] if `start` is outside them;
    /// [`IdentifyError::Prior`] unless the prior's mean is finite and its standard deviation
    /// positive and finite.
    pub fn new(
        name: impl Into<String>,
        start: f64,
        bounds: [f64; 2],
        scale: Scale,
        prior: Option<Prior>,
    ) -> Result<Self, IdentifyError> {
        let (name, [lower, upper]) = (name.into(), bounds);
        let width = upper - lower;
        if !(lower.is_finite() && upper.is_finite() && width > 0.0 && width.is_finite()) {
            return Err(IdentifyError::Bounds {
                name,
                lower,
                upper,
                expected: "finite, increasing",
            });
        }
        if scale == Scale::Logarithmic && lower <= 0.0 {
            let expected = "positive on a logarithmic scale";
            return Err(IdentifyError::Bounds { name, lower, upper, expected });
        }
        if !(lower..=upper).contains(&start) {
            return Err(IdentifyError::Start { name, start, lower, upper });
        }
        if let Some(Prior { mean, standard_deviation }) = prior {
            if !mean.is_finite() {
                let (quantity, expected) = ("mean", "finite");
                return Err(IdentifyError::Prior { name, quantity, value: mean, expected });
            }
            if !(standard_deviation.is_finite() && standard_deviation > 0.0) {
                let (quantity, expected) = ("standard deviation", "positive and finite");
                let value = standard_deviation;
                return Err(IdentifyError::Prior { name, quantity, value, expected });
            }
        }
        Ok(Self { name, start, lower, upper, scale, prior })
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The value where the first search starts.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// The lowest and highest value.
    pub fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    /// The kind of working coordinate.
    pub fn scale(&self) -> Scale {
        self.scale
    }

    /// What is known beforehand, in the working coordinate.
    pub fn prior(&self) -> Option<Prior> {
        self.prior
    }

    /// The working coordinate of a value; not finite for a value that has none.
    pub fn to_working(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            Scale::Logarithmic => value.ln(),
        }
    }

    /// The value at a working coordinate, held to the bounds.
    pub fn from_working(&self, coordinate: f64) -> f64 {
        let value = match self.scale {
            Scale::Linear => coordinate,
            Scale::Logarithmic => coordinate.exp(),
        };
        value.clamp(self.lower, self.upper)
    }

    /// The bounds in the working coordinate.
    pub(crate) fn working_bounds(&self) -> [f64; 2] {
        [self.to_working(self.lower), self.to_working(self.upper)]
    }

    /// The standard deviation of the working coordinate before the measurement: the prior's, or
    /// `(upper - lower) / sqrt(12)` of a uniform distribution between the bounds.
    pub(crate) fn initial_deviation(&self) -> f64 {
        let [lower, upper] = self.working_bounds();
        self.prior.map_or((upper - lower) / 12.0_f64.sqrt(), |prior| prior.standard_deviation)
    }

    /// The derivative of the value by the working coordinate at a value.
    pub fn value_slope(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => 1.0,
            Scale::Logarithmic => value,
        }
    }

    /// A length in the working coordinate over which models change noticeably: the least of
    /// a quarter of the range, the prior's standard deviation, and one (logarithmic) or
    /// `|x|` plus a thousandth of the range (linear).
    pub(crate) fn length(&self, coordinate: f64) -> f64 {
        let [lower, upper] = self.working_bounds();
        let natural = match self.scale {
            Scale::Linear => coordinate.abs() + 1e-3 * (upper - lower),
            Scale::Logarithmic => 1.0,
        };
        let spread = self.prior.map_or(f64::INFINITY, |prior| prior.standard_deviation);
        natural.min(spread).min(0.25 * (upper - lower))
    }
}
