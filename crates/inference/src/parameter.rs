//! Parameters: name, bounds, working coordinate and prior.

use crate::error::InferenceError;

/// The working coordinate `x` in which a parameter is fitted and has its prior.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterScale {
    /// `x = value`.
    Linear,
    /// `x = ln(value)`, for positive parameters of unknown magnitude.
    Logarithmic,
}

/// The normal distribution of the working coordinate before the measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Mean, in the working coordinate.
    pub mean: f64,
    /// Standard deviation, in the working coordinate, positive.
    pub standard_deviation: f64,
}

/// One parameter of a model. Models are never evaluated outside its bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    name: String,
    start: f64,
    lower: f64,
    upper: f64,
    scale: ParameterScale,
    prior: Option<Prior>,
    length: Option<f64>,
    latent: bool,
}

/// Bounds of a latent, in standard deviations: the prior has less than 1e-32 outside.
const LATENT_RANGE: f64 = 12.0;

impl Parameter {
    /// A parameter in `bounds = [lower, upper]` (values, in the parameter's own unit).
    ///
    /// # Errors
    ///
    /// [`InferenceError::Bounds`] unless the bounds are finite and increasing, and positive on a
    /// logarithmic scale; [`InferenceError::Start`] if `start` is outside them;
    /// [`InferenceError::Prior`] unless the prior's mean is finite and its standard deviation
    /// positive and finite.
    pub fn new(
        name: impl Into<String>,
        start: f64,
        bounds: [f64; 2],
        scale: ParameterScale,
        prior: Option<Prior>,
    ) -> Result<Self, InferenceError> {
        let (name, [lower, upper]) = (name.into(), bounds);
        let width = upper - lower;
        if !(lower.is_finite() && upper.is_finite() && width > 0.0 && width.is_finite()) {
            let expected = "finite, increasing";
            return Err(InferenceError::Bounds { name, lower, upper, expected });
        }
        if scale == ParameterScale::Logarithmic && lower <= 0.0 {
            let expected = "positive on a logarithmic scale";
            return Err(InferenceError::Bounds { name, lower, upper, expected });
        }
        if !(lower..=upper).contains(&start) {
            return Err(InferenceError::Start { name, start, lower, upper });
        }
        if let Some(Prior { mean, standard_deviation }) = prior {
            if !mean.is_finite() {
                let (quantity, expected) = ("mean", "finite");
                return Err(InferenceError::Prior { name, quantity, value: mean, expected });
            }
            if !(standard_deviation.is_finite() && standard_deviation > 0.0) {
                let (quantity, expected) = ("standard deviation", "positive and finite");
                let value = standard_deviation;
                return Err(InferenceError::Prior { name, quantity, value, expected });
            }
        }
        Ok(Self { name, start, lower, upper, scale, prior, length: None, latent: false })
    }

    /// A parameter on a linear scale, without a prior.
    ///
    /// # Errors
    ///
    /// Those of [`new`](Self::new).
    pub fn linear(
        name: impl Into<String>,
        start: f64,
        bounds: [f64; 2],
    ) -> Result<Self, InferenceError> {
        Self::new(name, start, bounds, ParameterScale::Linear, None)
    }

    /// A parameter on a logarithmic scale, without a prior.
    ///
    /// # Errors
    ///
    /// Those of [`new`](Self::new).
    pub fn logarithmic(
        name: impl Into<String>,
        start: f64,
        bounds: [f64; 2],
    ) -> Result<Self, InferenceError> {
        Self::new(name, start, bounds, ParameterScale::Logarithmic, None)
    }

    /// A coordinate of a function that is unknown as a whole: standard normal before the measurement,
    /// started at zero, without bounds of its own. A [`LatentPrior`](crate::LatentPrior) replaces the
    /// standard normal distribution of several latents by a mixture in [`Fit::latent_posterior`](crate::Fit::latent_posterior).
    pub fn latent(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            start: 0.0,
            lower: -LATENT_RANGE,
            upper: LATENT_RANGE,
            scale: ParameterScale::Linear,
            prior: Some(Prior { mean: 0.0, standard_deviation: 1.0 }),
            length: Some(1.0),
            latent: true,
        }
    }

    /// True for a [latent](Self::latent).
    pub fn is_latent(&self) -> bool {
        self.latent
    }

    /// The parameter with a length of change of its working coordinate, for the steps of difference
    /// derivatives; for values near zero whose predictions do not scale with them.
    #[must_use]
    pub fn with_length(self, length: f64) -> Self {
        Self { length: (length > 0.0 && length.is_finite()).then_some(length), ..self }
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The start of the first search.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// The lowest and highest value.
    pub fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    /// The kind of working coordinate.
    pub fn scale(&self) -> ParameterScale {
        self.scale
    }

    /// The prior, in the working coordinate.
    pub fn prior(&self) -> Option<Prior> {
        self.prior
    }

    /// The working coordinate of a value; not finite where there is none.
    pub fn to_working(&self, value: f64) -> f64 {
        match self.scale {
            ParameterScale::Linear => value,
            ParameterScale::Logarithmic => value.ln(),
        }
    }

    /// The value at a working coordinate, clamped to the bounds.
    pub fn from_working(&self, coordinate: f64) -> f64 {
        self.value_at(coordinate).clamp(self.lower, self.upper)
    }

    /// The value at a working coordinate, inside the bounds or not.
    pub(crate) fn value_at(&self, coordinate: f64) -> f64 {
        match self.scale {
            ParameterScale::Linear => coordinate,
            ParameterScale::Logarithmic => coordinate.exp(),
        }
    }

    /// The bounds in the working coordinate.
    pub(crate) fn working_bounds(&self) -> [f64; 2] {
        [self.to_working(self.lower), self.to_working(self.upper)]
    }

    /// The standard deviation of the working coordinate before the measurement: that of the prior, or
    /// `(upper - lower) / sqrt(12)` of a uniform distribution between the bounds.
    pub(crate) fn initial_deviation(&self) -> f64 {
        let [lower, upper] = self.working_bounds();
        self.prior.map_or((upper - lower) / 12.0_f64.sqrt(), |prior| prior.standard_deviation)
    }

    /// The derivative of the value with respect to the working coordinate, at a value.
    pub fn d_value_d_working(&self, value: f64) -> f64 {
        match self.scale {
            ParameterScale::Linear => 1.0,
            ParameterScale::Logarithmic => value,
        }
    }

    /// A scale of the working coordinate over which predictions change: the least of
    /// a quarter of the range, the prior's standard deviation, and the given length, or else one
    /// (logarithmic) or `|x|` plus a thousandth of the range (linear).
    pub(crate) fn length(&self, coordinate: f64) -> f64 {
        let [lower, upper] = self.working_bounds();
        let natural = match self.scale {
            ParameterScale::Linear => coordinate.abs() + 1e-3 * (upper - lower),
            ParameterScale::Logarithmic => 1.0,
        };
        let natural = self.length.unwrap_or(natural);
        let spread = self.prior.map_or(f64::INFINITY, |prior| prior.standard_deviation);
        natural.min(spread).min(0.25 * (upper - lower))
    }
}
