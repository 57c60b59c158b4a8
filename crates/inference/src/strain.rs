//! Strain between data and prior knowledge: distances from priors, and forces against bounds.

use crate::error::{InferenceError, check_size};
use crate::fit::FitSolution;
use crate::linear_algebra::inverse_normal;
use crate::linearisation::Linearisation;
use crate::parameter::Parameter;

/// Prior knowledge that data may strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StrainKind {
    /// A prior with this mean, in values, and this standard deviation, in the working coordinate.
    Prior {
        /// Mean, as a value of the parameter.
        mean: f64,
        /// Standard deviation in the working coordinate.
        standard_deviation: f64,
    },
    /// The bound on which the parameter is, in values.
    Bound(f64),
}

/// Strain of one parameter at the optimum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strain {
    /// Index of the parameter.
    pub parameter: usize,
    /// The prior or the bound.
    pub kind: StrainKind,
    /// Of a prior, the distance from its mean in its standard deviations, with its sign. Of a bound,
    /// the distance beyond it, in standard deviations of the parameter, at which the data alone
    /// would have the optimum; negative if they pull the parameter inside.
    pub deviations: f64,
}

impl Strain {
    /// Strains of the priors of all parameters that are no latents, at a point in values.
    pub fn of_priors(parameters: &[Parameter], point: &[f64]) -> Vec<Self> {
        let own = parameters.iter().zip(point).enumerate();
        let own = own.filter(|(_, (parameter, _))| !parameter.is_latent());
        let strain = |(index, (parameter, value)): (usize, (&Parameter, &f64))| {
            let prior = parameter.prior()?;
            let standard_deviation = prior.standard_deviation;
            let mean = parameter.value_at(prior.mean);
            Some(Self {
                parameter: index,
                kind: StrainKind::Prior { mean, standard_deviation },
                deviations: (parameter.to_working(*value) - prior.mean) / standard_deviation,
            })
        };
        own.filter_map(strain).collect()
    }
}

impl Linearisation {
    /// Strains of all priors of parameters that are no latents, and of all bounds on which
    /// parameters are.
    ///
    /// With the gradient g of the cost at the optimum and the inverse C of its second derivatives with
    /// respect to the parameters inside their bounds and the one on its bound, a step without that
    /// bound leads beyond it by `|C_jj g_j|`, which is `sqrt(C_jj) |g_j|` standard deviations, and
    /// lowers twice the cost by the square of that number.
    ///
    /// # Errors
    ///
    /// [`InferenceError::Size`] for a fit of another model; [`InferenceError::Singular`] if the
    /// normal matrix is singular to rounding.
    ///
    /// # Example
    ///
    /// The mean of two numbers is 2 with a deviation of 0.1, and the bound 1.5 is five deviations away:
    /// ```
    /// # use asperity_inference::*;
    /// let model = FunctionModel {
    ///     parameters: vec![Parameter::linear("mean", 1.0, [0.0, 1.5])?],
    ///     observations: Observation::list(&[2.0, 2.0], 0.1 * 2.0_f64.sqrt()),
    ///     function: |x: &[f64]| vec![x[0]; 2],
    /// };
    /// let best = fit(&model, &FitOptions::default())?;
    /// let strains = best.linearise()?.strains(&best)?;
    /// assert_eq!(strains[0].kind, StrainKind::Bound(1.5));
    /// assert!((strains[0].deviations - 5.0).abs() < 0.2);
    /// # Ok::<(), InferenceError>(())
    /// ```
    pub fn strains(&self, fit: &FitSolution) -> Result<Vec<Strain>, InferenceError> {
        check_size("parameters of the fit", fit.point.len(), self.parameters.len())?;
        check_size("observations of the fit", fit.residuals.len(), self.jacobian.len())?;
        let mut found = Strain::of_priors(&self.parameters, &fit.point);
        for (j, parameter) in self.parameters.iter().enumerate() {
            if fit.at_bound[j] && !parameter.is_latent() {
                let [lower, upper] = parameter.bounds();
                let is_upper = (upper - fit.point[j]).abs() < (fit.point[j] - lower).abs();
                let outwards = if is_upper { -1.0 } else { 1.0 };
                let deviations = outwards * self.gradient(fit, j) * self.free_deviation(fit, j)?;
                let kind = StrainKind::Bound(if is_upper { upper } else { lower });
                found.push(Strain { parameter: j, kind, deviations });
            }
        }
        Ok(found)
    }

    /// Derivative of the cost with respect to a working coordinate.
    fn gradient(&self, fit: &FitSolution, parameter: usize) -> f64 {
        let rows = self.jacobian.iter().zip(&fit.residuals).zip(&self.weights);
        let of_data: f64 = rows.map(|((row, r), weight)| weight * r * row[parameter]).sum();
        let prior = self.parameters[parameter].prior();
        let of_prior = prior.map_or(0.0, |prior| {
            (self.optimum[parameter] - prior.mean) / prior.standard_deviation.powi(2)
        });
        of_data + of_prior
    }

    /// Standard deviation of a parameter with those inside their bounds free as well.
    fn free_deviation(&self, fit: &FitSolution, parameter: usize) -> Result<f64, InferenceError> {
        let count = self.parameters.len();
        let free: Vec<usize> = (0..count).filter(|&j| j == parameter || !fit.at_bound[j]).collect();
        let of_data = self.weighted_rows();
        let mut rows: Vec<Vec<f64>> =
            of_data.iter().map(|row| free.iter().map(|&j| row[j]).collect()).collect();
        for (place, &j) in free.iter().enumerate() {
            let mut row = vec![0.0; free.len()];
            row[place] = 1.0 / self.parameters[j].initial_deviation();
            rows.push(row);
        }
        let place = free.iter().position(|&j| j == parameter).unwrap_or(0);
        let inverse = inverse_normal(&rows, free.len(), "normal matrix")?;
        Ok(inverse.matrix[place][place].sqrt())
    }
}
