//! The covariance of the parameters from the curvature at the optimum.

use crate::error::{InferenceError, check_level, check_size};
use crate::fit::Fit;
use crate::goodness::GoodnessOfFit;
use crate::linear_algebra::{InverseNormal, correlation, inverse_normal};
use crate::linearisation::Linearisation;
use crate::parameter::Parameter;
use crate::random::normal_half_width;

/// The scale of the observations' standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseScale {
    /// As given.
    Given,
    /// Multiplied by the [Birge ratio](GoodnessOfFit::noise_factor), at least one.
    AtLeastGiven,
}

/// The normal approximation at the optimum, in working coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// Working coordinates of the optimum.
    pub centre: Vec<f64>,
    /// Covariance matrix.
    pub matrix: Vec<Vec<f64>>,
    /// Square roots of its diagonal.
    pub standard_deviations: Vec<f64>,
    /// Correlation of the parameters.
    pub correlation: Vec<Vec<f64>>,
    /// Factor of the observations' standard deviations; 1 when taken as given.
    pub noise_factor: f64,
    /// Goodness of the fit, with the standard deviations as given.
    pub goodness: GoodnessOfFit,
    /// `root root^T = matrix`.
    pub(crate) root: Vec<Vec<f64>>,
    parameters: Vec<Parameter>,
}

impl Fit<'_> {
    /// The covariance at the optimum, with the standard deviations as given.
    ///
    /// # Errors
    ///
    /// Those of [`linearise`](Self::linearise) and [`Linearisation::covariance`].
    pub fn covariance(&self) -> Result<Covariance, InferenceError> {
        self.linearise()?.covariance(NoiseScale::Given)
    }
}

impl Linearisation {
    /// The covariance in working coordinates,
    ///
    /// ```text
    /// C = (J^T W J / noise_factor^2 + P)^-1,
    /// ```
    ///
    /// with the standardised Jacobian `J`, the robust weights `W`, and `P` diagonal: `1 / sd^2` of
    /// the prior of a parameter, or `12 / range^2` of its bounds without a prior, so that an
    /// undetermined direction stays finite.
    ///
    /// # Errors
    ///
    /// [`InferenceError::Singular`] if the normal matrix is singular to rounding.
    pub fn covariance(&self, noise: NoiseScale) -> Result<Covariance, InferenceError> {
        let noise_factor = match noise {
            NoiseScale::Given => 1.0,
            NoiseScale::AtLeastGiven => self.goodness.noise_factor,
        };
        let mut rows = self.weighted_rows();
        rows.iter_mut().flatten().for_each(|entry| *entry /= noise_factor);
        let count = self.parameters.len();
        for (j, parameter) in self.parameters.iter().enumerate() {
            let mut row = vec![0.0; count];
            row[j] = 1.0 / parameter.initial_deviation();
            rows.push(row);
        }
        let InverseNormal { matrix, root } = inverse_normal(&rows, count, "normal matrix")?;
        Ok(Covariance {
            centre: self.optimum.clone(),
            standard_deviations: (0..count).map(|j| matrix[j][j].sqrt()).collect(),
            correlation: correlation(&matrix),
            matrix,
            noise_factor,
            goodness: self.goodness,
            root,
            parameters: self.parameters.clone(),
        })
    }
}

impl Covariance {
    /// The central interval of a parameter at a level such as 0.95, in values, within its bounds.
    ///
    /// # Errors
    ///
    /// [`InferenceError::Size`] for a parameter that does not exist, [`InferenceError::Option`] for
    /// a level outside (0, 1).
    pub fn interval(&self, parameter: usize, level: f64) -> Result<[f64; 2], InferenceError> {
        check_level(level)?;
        let Some(which) = self.parameters.get(parameter) else {
            let (quantity, expected) = ("as index of a parameter", self.parameters.len());
            return Err(InferenceError::Size { quantity, found: parameter, expected });
        };
        let half_width = normal_half_width(level) * self.standard_deviations[parameter];
        let centre = self.centre[parameter];
        Ok([which.from_working(centre - half_width), which.from_working(centre + half_width)])
    }

    /// Change of the optimum, in working coordinates, where the predictions change by these parts of the
    /// standard deviations of the observations: `-C J^T W dr` with the Jacobian `J` and this covariance `C`.
    ///
    /// # Errors
    ///
    /// [`InferenceError::Size`] for another number of observations or parameters.
    ///
    /// # Example
    ///
    /// A sum of one known and one unknown number that was measured: they compensate.
    /// ```
    /// # use asperity_inference::*;
    /// let model = FunctionModel {
    ///     parameters: vec![Parameter::linear("x", 0.5, [-100.0, 100.0])?],
    ///     observations: Observation::list(&[2.0], 0.1),
    ///     function: |x: &[f64]| vec![x[0] + 1.0],
    /// };
    /// let best = fit(&model, &FitOptions::default())?;
    /// let linearisation = best.linearise()?;
    /// let covariance = linearisation.covariance(NoiseScale::Given)?;
    /// // The known number is larger by 0.3, three standard deviations of the sum.
    /// let moved = covariance.shift(&linearisation, &[3.0])?;
    /// assert!((moved[0] + 0.3).abs() < 1e-4);
    /// # Ok::<(), InferenceError>(())
    /// ```
    pub fn shift(
        &self,
        linearisation: &Linearisation,
        change: &[f64],
    ) -> Result<Vec<f64>, InferenceError> {
        let count = self.matrix.len();
        check_size("changes of predictions", change.len(), linearisation.jacobian.len())?;
        check_size("parameters", linearisation.parameters.len(), count)?;
        let scale = self.noise_factor.powi(2).recip();
        let mut force = vec![0.0; count];
        for ((row, weight), change) in
            linearisation.jacobian.iter().zip(&linearisation.weights).zip(change)
        {
            for (sum, entry) in force.iter_mut().zip(row) {
                *sum += scale * weight * entry * change;
            }
        }
        let moved = |row: &Vec<f64>| -row.iter().zip(&force).map(|(c, f)| c * f).sum::<f64>();
        Ok(self.matrix.iter().map(moved).collect())
    }

    /// Standard deviations of the values, to first order.
    pub fn value_standard_deviations(&self) -> Vec<f64> {
        let deviation = |(j, parameter): (usize, &Parameter)| {
            let value = parameter.from_working(self.centre[j]);
            parameter.d_value_d_working(value) * self.standard_deviations[j]
        };
        self.parameters.iter().enumerate().map(deviation).collect()
    }
}
