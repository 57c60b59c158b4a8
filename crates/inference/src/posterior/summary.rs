//! Weighted draws: means, quantiles and bands.

use super::chains::PosteriorDiagnostics;
use crate::model::Predictions;

/// Pointwise quantiles of a curve over the posterior.
#[derive(Debug, Clone, PartialEq)]
pub struct CredibleBand {
    /// The probabilities.
    pub levels: Vec<f64>,
    /// The curve of quantiles for every level; NaN where no draw has a value.
    pub quantiles: Vec<Vec<f64>>,
}

/// Draws from the posterior distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Values of the parameters, a row per draw.
    pub draws: Vec<Vec<f64>>,
    /// Weight of every draw; they sum to 1.
    pub weights: Vec<f64>,
    /// The model's predictions at every draw; empty where it has none (weight 0).
    pub predictions: Vec<Predictions>,
    /// Diagnostics.
    pub diagnostics: PosteriorDiagnostics,
}

impl Posterior {
    /// The mean of a parameter's value; NaN for an index without a parameter.
    pub fn mean(&self, parameter: usize) -> f64 {
        let values = self.draws.iter().map(|draw| draw.get(parameter).copied().unwrap_or(f64::NAN));
        values.zip(&self.weights).map(|(value, weight)| value * weight).sum()
    }

    /// The standard deviation of a parameter's value.
    pub fn standard_deviation(&self, parameter: usize) -> f64 {
        self.covariance(parameter, parameter).max(0.0).sqrt()
    }

    /// The correlation of two parameters' values.
    pub fn correlation(&self, one: usize, other: usize) -> f64 {
        let spread = self.standard_deviation(one) * self.standard_deviation(other);
        self.covariance(one, other) / spread
    }

    fn covariance(&self, one: usize, other: usize) -> f64 {
        let (a, b) = (self.mean(one), self.mean(other));
        if a.is_nan() || b.is_nan() {
            return f64::NAN;
        }
        let draws = self.draws.iter().zip(&self.weights);
        draws.map(|(draw, weight)| weight * (draw[one] - a) * (draw[other] - b)).sum()
    }

    /// The quantile of a parameter's value at a probability.
    pub fn quantile(&self, parameter: usize, probability: f64) -> f64 {
        let values = self.draws.iter().map(|draw| draw.get(parameter).copied().unwrap_or(f64::NAN));
        quantiles(values.zip(self.weights.iter().copied()).collect(), &[probability])[0]
    }

    /// The Monte Carlo standard error of [`Self::quantile`]: half the distance of the quantiles at the
    /// probabilities p - s and p + s, where s = sqrt(p (1 - p) / n) is the standard error of the
    /// share of n independent draws below the quantile, and n the smaller of the effective numbers
    /// of weighted draws and of the parameter's chains (Vehtari et al. 2021, Bayesian Analysis 16,
    /// 667-718). NaN for an index without a parameter.
    pub fn quantile_error(&self, parameter: usize, probability: f64) -> f64 {
        let found = &self.diagnostics;
        let Some(chains) = found.effective_sample_size.get(parameter) else { return f64::NAN };
        let effective = chains.min(found.effective_draws);
        let error = (probability * (1.0 - probability) / effective).sqrt();
        let at = |level: f64| self.quantile(parameter, level.clamp(0.0, 1.0));
        0.5 * (at(probability + error) - at(probability - error))
    }

    /// Pointwise quantiles of a curve computed from the parameters' values. Draws are left out where
    /// their curve is not finite; the first draw gives the number of points.
    pub fn band(&self, curve: &dyn Fn(&[f64]) -> Vec<f64>, levels: &[f64]) -> CredibleBand {
        let curves: Vec<Vec<f64>> = self.draws.iter().map(|draw| curve(draw)).collect();
        let value = |draw: usize, point: usize| curves[draw].get(point).copied();
        self.band_of(curves.first().map_or(0, Vec::len), levels, &value)
    }

    /// Quantiles of every prediction, from the uncertainty of the parameters without the noise of a
    /// measurement.
    pub fn prediction_band(&self, levels: &[f64]) -> CredibleBand {
        let value = |draw: usize, i: usize| self.predictions[draw].get(i).copied().flatten();
        // A draw without predictions has an empty row.
        let points = self.predictions.iter().map(Vec::len).max().unwrap_or(0);
        self.band_of(points, levels, &value)
    }

    fn band_of(
        &self,
        points: usize,
        levels: &[f64],
        value: &dyn Fn(usize, usize) -> Option<f64>,
    ) -> CredibleBand {
        let mut band = vec![Vec::with_capacity(points); levels.len()];
        for point in 0..points {
            let pairs = self.weights.iter().enumerate().filter_map(|(draw, &weight)| {
                value(draw, point).filter(|value| value.is_finite()).map(|value| (value, weight))
            });
            let at = quantiles(pairs.collect(), levels);
            band.iter_mut().zip(at).for_each(|(row, value)| row.push(value));
        }
        CredibleBand { levels: levels.to_vec(), quantiles: band }
    }
}

/// Quantiles of weighted values: the cumulative weight at a value counts half its own, with
/// straight lines between.
fn quantiles(mut pairs: Vec<(f64, f64)>, levels: &[f64]) -> Vec<f64> {
    pairs.retain(|pair| pair.1 > 0.0 && pair.0.is_finite());
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = pairs.iter().map(|pair| pair.1).sum();
    let mut below = 0.0;
    let middles: Vec<f64> = pairs
        .iter()
        .map(|pair| {
            below += pair.1;
            (below - 0.5 * pair.1) / total
        })
        .collect();
    let at = |&level: &f64| {
        let next = middles.partition_point(|&middle| middle < level);
        match (next.checked_sub(1), pairs.get(next)) {
            (_, None) => pairs.last().map_or(f64::NAN, |pair| pair.0),
            (None, Some(first)) => first.0,
            (Some(last), Some(upper)) => {
                let along = (level - middles[last]) / (middles[next] - middles[last]);
                pairs[last].0 + along * (upper.0 - pairs[last].0)
            }
        }
    };
    levels.iter().map(at).collect()
}
