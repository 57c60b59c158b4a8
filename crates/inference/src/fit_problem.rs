//! Residuals and cost of a model in working coordinates.

use std::collections::HashSet;

use crate::error::{InferenceError, check_positive};
use crate::loss::Loss;
use crate::model::{ForwardModel, Observation, Predictions};
use crate::parameter::Parameter;

/// A model with its loss, both checked. Residuals are `(prediction - value) / standard deviation`; the cost is
///
/// ```text
/// cost(x) = 1/2 sum_i rho(r_i^2) / noise_variance + 1/2 sum_j ((x_j - mean_j) / sd_j)^2.
/// ```
#[derive(Clone)]
pub(crate) struct FitProblem<'a> {
    model: &'a dyn ForwardModel,
    pub(crate) parameters: &'a [Parameter],
    pub(crate) observations: &'a [Observation],
    pub(crate) loss: Loss,
    /// The residual that replaces a missing prediction.
    pub(crate) missing_residual: f64,
    /// Factor of the observations' variances; the priors' are not scaled.
    pub(crate) noise_variance: f64,
    /// True for the observations that count; empty if all do.
    counted: Vec<bool>,
    /// Working coordinates that parameters without a prior are near; empty where they have none.
    near: Vec<f64>,
    /// Bounds in working coordinates.
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
}

impl<'a> FitProblem<'a> {
    pub(crate) fn new(
        model: &'a dyn ForwardModel,
        loss: Loss,
        missing_residual: f64,
    ) -> Result<Self, InferenceError> {
        let (parameters, observations) = (model.parameters(), model.observations());
        if parameters.is_empty() {
            return Err(InferenceError::NoParameters);
        }
        let mut names = HashSet::new();
        if let Some(twice) = parameters.iter().find(|parameter| !names.insert(parameter.name())) {
            return Err(InferenceError::DuplicateName(twice.name().to_owned()));
        }
        if observations.is_empty() {
            return Err(InferenceError::NoObservations);
        }
        observations.iter().try_for_each(check_observation)?;
        let priors = parameters.iter().filter(|parameter| parameter.prior().is_some()).count();
        if observations.len() + priors < parameters.len() {
            let (observations, parameters) = (observations.len(), parameters.len());
            return Err(InferenceError::TooFew { observations, priors, parameters });
        }
        loss.check()?;
        check_positive("the residual of a missing prediction", missing_residual)?;
        let bounds = |end: usize| parameters.iter().map(|u| u.working_bounds()[end]).collect();
        let (lower, upper) = (bounds(0), bounds(1));
        let noise_variance = 1.0;
        Ok(Self {
            model,
            parameters,
            observations,
            loss,
            missing_residual,
            noise_variance,
            counted: Vec::new(),
            near: Vec::new(),
            lower,
            upper,
        })
    }

    /// The problem with the observations that `counted` marks alone; `None` if they are too few for
    /// the parameters.
    pub(crate) fn with_counted(&self, counted: Vec<bool>) -> Option<Self> {
        let count = counted.iter().filter(|&&counts| counts).count();
        let enough = count > 0 && count + self.priors() >= self.parameters.len();
        enough.then(|| Self { counted, ..self.clone() })
    }

    /// True if an observation counts.
    pub(crate) fn counts(&self, observation: usize) -> bool {
        self.counted.get(observation).copied().unwrap_or(true)
    }

    /// The problem with the observations' variances multiplied by the square of `factor`.
    pub(crate) fn with_noise_factor(&self, factor: f64) -> Self {
        Self { noise_variance: factor.powi(2), ..self.clone() }
    }

    /// The problem with priors about working coordinates for parameters without one: their standard deviations are
    /// the parameters' lengths of change.
    pub(crate) fn held_near(&self, x: &[f64]) -> Self {
        Self { near: x.to_vec(), ..self.clone() }
    }

    pub(crate) fn model(&self) -> &'a dyn ForwardModel {
        self.model
    }

    /// The working coordinates of a point given by its values.
    pub(crate) fn to_working(&self, point: &[f64]) -> Vec<f64> {
        self.parameters
            .iter()
            .zip(point)
            .map(|(parameter, &value)| parameter.to_working(value))
            .collect()
    }

    /// The values of a point given by its working coordinates.
    pub(crate) fn values_at(&self, x: &[f64]) -> Vec<f64> {
        self.parameters.iter().zip(x).map(|(parameter, &x)| parameter.from_working(x)).collect()
    }

    pub(crate) fn clamp(&self, x: &mut [f64]) {
        for (j, x) in x.iter_mut().enumerate() {
            *x = x.clamp(self.lower[j], self.upper[j]);
        }
    }

    pub(crate) fn inside(&self, x: &[f64]) -> bool {
        x.iter().enumerate().all(|(j, x)| (self.lower[j]..=self.upper[j]).contains(x))
    }

    /// Predictions at working coordinates, or the reason for their absence. Numbers that are not
    /// finite count as missing, results of a wrong size as errors.
    pub(crate) fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, String>> {
        if points.is_empty() {
            return Vec::new();
        }
        let values: Vec<Vec<f64>> = points.iter().map(|x| self.values_at(x)).collect();
        let mut results = self.model.predict(&values).into_iter();
        let expected = self.observations.len();
        let result = |_| match results.next() {
            Some(Ok(predictions)) if predictions.len() == expected => {
                Ok(predictions.into_iter().map(|p| p.filter(|p| p.is_finite())).collect())
            }
            Some(Ok(predictions)) => Err(format!(
                "it returned {} predictions for {expected} observations",
                predictions.len()
            )),
            Some(Err(error)) => Err(error.reason),
            None => Err("it returned too few results".to_owned()),
        };
        points.iter().map(result).collect()
    }

    /// The predictions that the model gives with its derivatives at working coordinates.
    pub(crate) fn values_with_derivatives(&self, x: &[f64]) -> Result<Predictions, String> {
        match self.model.differentiate(&self.values_at(x)) {
            Some(Ok(derivatives)) => Ok(derivatives.values),
            Some(Err(error)) => Err(error.reason),
            None => Err("it has no derivatives there".to_owned()),
        }
    }

    /// Standardised residuals; zero for observations that do not count.
    pub(crate) fn residuals(&self, predictions: &[Option<f64>]) -> Vec<f64> {
        let residual = |(i, prediction): (usize, &Option<f64>)| {
            if self.counts(i) { self.residual(i, *prediction) } else { 0.0 }
        };
        predictions.iter().take(self.observations.len()).enumerate().map(residual).collect()
    }

    /// The standardised residual of observation `i`.
    pub(crate) fn residual(&self, i: usize, prediction: Option<f64>) -> f64 {
        let observation = &self.observations[i];
        prediction.map_or(self.missing_residual, |value| {
            (value - observation.value) / observation.standard_deviation
        })
    }

    /// Half the sum of the losses over the noise variance.
    pub(crate) fn data_cost(&self, residuals: &[f64]) -> f64 {
        0.5 * residuals.iter().map(|&residual| self.loss.value(residual)).sum::<f64>()
            / self.noise_variance
    }

    /// Half the sum of the squared standardised distances from the priors' means.
    pub(crate) fn prior_cost(&self, x: &[f64]) -> f64 {
        self.prior_cost_of(x, &|_| true)
    }

    /// The same of the parameters that count.
    fn prior_cost_of(&self, x: &[f64], counts: &dyn Fn(&Parameter) -> bool) -> f64 {
        let rows = self.prior_rows(x).filter(|(j, ..)| counts(&self.parameters[*j]));
        0.5 * rows.map(|(_, residual, _)| residual * residual).sum::<f64>()
    }

    pub(crate) fn cost(&self, residuals: &[f64], x: &[f64]) -> f64 {
        self.cost_of(residuals, x, &|_| true)
    }

    /// The cost with the priors of the parameters that count.
    pub(crate) fn cost_of(
        &self,
        residuals: &[f64],
        x: &[f64],
        counts: &dyn Fn(&Parameter) -> bool,
    ) -> f64 {
        self.data_cost(residuals) + self.prior_cost_of(x, counts)
    }

    /// Index of the parameter, standardised residual and its derivative, for every prior.
    pub(crate) fn prior_rows(&self, x: &[f64]) -> impl Iterator<Item = (usize, f64, f64)> {
        self.parameters.iter().zip(x).enumerate().filter_map(|(j, (parameter, x))| {
            let (mean, deviation) = match (parameter.prior(), self.near.get(j)) {
                (Some(prior), _) => (prior.mean, prior.standard_deviation),
                (None, Some(&near)) => (near, parameter.length(near)),
                (None, None) => return None,
            };
            Some((j, (x - mean) / deviation, 1.0 / deviation))
        })
    }

    pub(crate) fn priors(&self) -> usize {
        self.parameters.iter().filter(|parameter| parameter.prior().is_some()).count()
    }
}

fn check_observation(observation: &Observation) -> Result<(), InferenceError> {
    let invalid = |quantity, value, expected| {
        let label = observation.label.clone();
        Err(InferenceError::Observation { label, quantity, value, expected })
    };
    let deviation = observation.standard_deviation;
    if !observation.value.is_finite() {
        invalid("value", observation.value, "finite")
    } else if !(deviation.is_finite() && deviation > 0.0) {
        invalid("standard deviation", deviation, "positive and finite")
    } else {
        Ok(())
    }
}
