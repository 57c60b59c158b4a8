//! A model with its loss as residuals and cost in working coordinates.

use std::collections::HashSet;

use crate::error::{IdentifyError, check_positive, check_size};
use crate::fit::Fit;
use crate::loss::Loss;
use crate::model::{ForwardModel, Observation, Predictions};
use crate::unknown::Unknown;

/// A checked model. Residuals are `(prediction - value) / standard deviation`; the cost is
///
/// ```text
/// cost(x) = 1/2 sum_i rho(r_i^2) / noise_variance + 1/2 sum_j ((x_j - mean_j) / sd_j)^2.
/// ```
pub(crate) struct Problem<'a> {
    model: &'a dyn ForwardModel,
    pub(crate) unknowns: &'a [Unknown],
    pub(crate) observations: &'a [Observation],
    pub(crate) loss: Loss,
    /// The residual that stands for a missing prediction.
    pub(crate) missing_residual: f64,
    /// What the observations' variances are multiplied by; the priors' are not.
    pub(crate) noise_variance: f64,
    /// Bounds in working coordinates.
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
}

impl<'a> Problem<'a> {
    pub(crate) fn new(
        model: &'a dyn ForwardModel,
        loss: Loss,
        missing_residual: f64,
    ) -> Result<Self, IdentifyError> {
        let (unknowns, observations) = (model.unknowns(), model.observations());
        if unknowns.is_empty() {
            return Err(IdentifyError::NoUnknowns);
        }
        let mut names = HashSet::new();
        if let Some(twice) = unknowns.iter().find(|unknown| !names.insert(unknown.name())) {
            return Err(IdentifyError::DuplicateName { name: twice.name().to_owned() });
        }
        if observations.is_empty() {
            return Err(IdentifyError::NoObservations);
        }
        observations.iter().try_for_each(check_observation)?;
        let priors = unknowns.iter().filter(|unknown| unknown.prior().is_some()).count();
        if observations.len() + priors < unknowns.len() {
            let (observations, unknowns) = (observations.len(), unknowns.len());
            return Err(IdentifyError::TooFew { observations, priors, unknowns });
        }
        loss.check()?;
        check_positive("the residual of a missing prediction", missing_residual)?;
        let bounds = |end: usize| unknowns.iter().map(|u| u.working_bounds()[end]).collect();
        let (lower, upper) = (bounds(0), bounds(1));
        let noise_variance = 1.0;
        Ok(Self {
            model,
            unknowns,
            observations,
            loss,
            missing_residual,
            noise_variance,
            lower,
            upper,
        })
    }

    /// The problem a fit solved, with the observations' variances multiplied.
    pub(crate) fn of_fit(
        model: &'a dyn ForwardModel,
        fit: &Fit,
        noise_variance: f64,
    ) -> Result<Self, IdentifyError> {
        let problem = Self::new(model, fit.options.loss, fit.options.missing_residual)?;
        check_size("values of the fit", fit.point.len(), problem.unknowns.len())?;
        check_size("residuals of the fit", fit.residuals.len(), problem.observations.len())?;
        check_size("predictions of the fit", fit.predictions.len(), problem.observations.len())?;
        Ok(Self { noise_variance, ..problem })
    }

    pub(crate) fn model(&self) -> &'a dyn ForwardModel {
        self.model
    }

    /// The working coordinates of a point given by its values.
    pub(crate) fn to_working(&self, point: &[f64]) -> Vec<f64> {
        self.unknowns.iter().zip(point).map(|(unknown, &value)| unknown.to_working(value)).collect()
    }

    /// The values of a point given by its working coordinates.
    pub(crate) fn values_at(&self, x: &[f64]) -> Vec<f64> {
        self.unknowns.iter().zip(x).map(|(unknown, &x)| unknown.from_working(x)).collect()
    }

    pub(crate) fn clamp(&self, x: &mut [f64]) {
        for (j, x) in x.iter_mut().enumerate() {
            *x = x.clamp(self.lower[j], self.upper[j]);
        }
    }

    pub(crate) fn inside(&self, x: &[f64]) -> bool {
        x.iter().enumerate().all(|(j, x)| (self.lower[j]..=self.upper[j]).contains(x))
    }

    /// Predictions at working coordinates, or why there are none. Numbers that are not finite
    /// count as missing, answers of a wrong size as refusals.
    pub(crate) fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, String>> {
        if points.is_empty() {
            return Vec::new();
        }
        let values: Vec<Vec<f64>> = points.iter().map(|x| self.values_at(x)).collect();
        let mut answers = self.model.predict(&values).into_iter();
        let expected = self.observations.len();
        let answer = |_| match answers.next() {
            Some(Ok(predictions)) if predictions.len() == expected => {
                Ok(predictions.into_iter().map(|p| p.filter(|p| p.is_finite())).collect())
            }
            Some(Ok(predictions)) => Err(format!(
                "it gave {} predictions for {expected} observations",
                predictions.len()
            )),
            Some(Err(refusal)) => Err(refusal.reason),
            None => Err("it gave no answer".to_owned()),
        };
        points.iter().map(answer).collect()
    }

    /// Standardised residuals.
    pub(crate) fn residuals(&self, predictions: &[Option<f64>]) -> Vec<f64> {
        let residual = |(observation, prediction): (&Observation, &Option<f64>)| match prediction {
            Some(value) => (value - observation.value) / observation.standard_deviation,
            None => self.missing_residual,
        };
        self.observations.iter().zip(predictions).map(residual).collect()
    }

    /// Half the sum of the losses over the noise variance.
    pub(crate) fn data_cost(&self, residuals: &[f64]) -> f64 {
        0.5 * residuals.iter().map(|&residual| self.loss.value(residual)).sum::<f64>()
            / self.noise_variance
    }

    /// Half the sum of the squared standardised distances from the priors' means.
    pub(crate) fn prior_cost(&self, x: &[f64]) -> f64 {
        0.5 * self.prior_rows(x).map(|(_, residual, _)| residual * residual).sum::<f64>()
    }

    pub(crate) fn cost(&self, residuals: &[f64], x: &[f64]) -> f64 {
        self.data_cost(residuals) + self.prior_cost(x)
    }

    /// Index of the unknown, standardised residual and its derivative, for every prior.
    pub(crate) fn prior_rows(&self, x: &[f64]) -> impl Iterator<Item = (usize, f64, f64)> {
        self.unknowns.iter().zip(x).enumerate().filter_map(|(j, (unknown, x))| {
            let prior = unknown.prior()?;
            Some((j, (x - prior.mean) / prior.standard_deviation, 1.0 / prior.standard_deviation))
        })
    }

    pub(crate) fn priors(&self) -> usize {
        self.unknowns.iter().filter(|unknown| unknown.prior().is_some()).count()
    }
}

fn check_observation(observation: &Observation) -> Result<(), IdentifyError> {
    let refuse = |quantity, value, expected| {
        let label = observation.label.clone();
        Err(IdentifyError::Observation { label, quantity, value, expected })
    };
    let deviation = observation.standard_deviation;
    if !observation.value.is_finite() {
        refuse("value", observation.value, "finite")
    } else if !(deviation.is_finite() && deviation > 0.0) {
        refuse("standard deviation", deviation, "positive and finite")
    } else {
        Ok(())
    }
}
