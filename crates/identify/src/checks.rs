//! Posterior predictive checks of groups of observations.

use asperity_inference::{Agreement, chi_square_tail};
use serde::Serialize;

use crate::identification::Identification;

/// Number of groups of force.
const FORCE_GROUPS: usize = 3;

/// Groups in the order of the measurement, and the fewest hits for them.
const TIMES: [&str; 3] = ["first", "middle", "last"];
const LEAST_HITS: usize = 6;

/// Comparison of a group of observations with repetitions that the posterior predicts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictiveCheck {
    /// The group in words: a feature, a range of forces, or the place in the order of the measurement.
    pub group: String,
    /// Number of its observations.
    pub observations: usize,
    /// Mean over the posterior of chi-square of the group.
    pub chi_square: f64,
    /// Posterior predictive p-value: the probability that chi-square of repeated measurements exceeds
    /// chi-square of the measurements, both about the same draw,
    ///
    /// ```text
    /// p = sum_d weight_d P(chi-square(n) > chi-square_d).
    /// ```
    ///
    /// Values near zero mean that the group disagrees with the law. Source: A. Gelman, X.-L. Meng, H.
    /// Stern, Statistica Sinica 6, 733 (1996).
    pub p_value: f64,
}

impl Identification {
    /// Agreement of the fit with the data by the p-value of its chi-square; none if a prediction is
    /// missing.
    pub fn agreement(&self) -> Agreement {
        if self.fit.missing.is_empty() { self.goodness.agreement() } else { Agreement::None }
    }

    /// Checks of every feature, of hits of small, middle and large force, and of the first, middle and
    /// last hits of each data.
    pub fn checks(&self) -> Vec<PredictiveCheck> {
        let mut features: Vec<&str> = Vec::new();
        for about in &self.about {
            if !features.contains(&about.feature.as_str()) {
                features.push(&about.feature);
            }
        }
        let of_feature = |feature: &&str| {
            let own = |i: &usize| self.about[*i].feature == *feature;
            ((*feature).to_owned(), (0..self.about.len()).filter(own).collect())
        };
        let mut groups: Vec<(String, Vec<usize>)> = features.iter().map(of_feature).collect();
        groups.extend(self.force_groups());
        groups.extend(self.time_groups());
        groups.into_iter().filter_map(|(group, own)| self.check(group, &own)).collect()
    }

    /// Observations of hits in order of their force, in parts of equal numbers of forces.
    fn force_groups(&self) -> Vec<(String, Vec<usize>)> {
        let force = |i: usize| self.about[i].at.filter(|_| self.of_force[i]);
        let mut forces: Vec<f64> = (0..self.about.len()).filter_map(force).collect();
        forces.sort_by(f64::total_cmp);
        forces.dedup();
        if forces.len() < FORCE_GROUPS {
            return Vec::new();
        }
        let parts = forces.chunks(forces.len().div_ceil(FORCE_GROUPS));
        let group = |part: &[f64]| {
            let [low, high] = [part[0], part[part.len() - 1]];
            let own = |i: &usize| force(*i).is_some_and(|force| (low..=high).contains(&force));
            let own = (0..self.about.len()).filter(own).collect();
            (format!("forces of {low:.1} to {high:.1} N"), own)
        };
        parts.map(group).collect()
    }

    /// Hits of each data in the order of their measurement, in parts of equal numbers: contacts wear, and
    /// sensors drift.
    fn time_groups(&self) -> Vec<(String, Vec<usize>)> {
        let mut groups = Vec::new();
        let mut names: Vec<&str> = self.about.iter().map(|about| about.data.as_str()).collect();
        names.dedup();
        for name in names {
            let own = |i: &usize| self.about[*i].data == name;
            let own: Vec<usize> = (0..self.about.len()).filter(own).collect();
            let mut blocks: Vec<usize> = own.iter().map(|&i| self.observations[i].block).collect();
            blocks.sort_unstable();
            blocks.dedup();
            if blocks.len() < LEAST_HITS {
                continue;
            }
            let parts = blocks.chunks(blocks.len().div_ceil(TIMES.len()));
            for (part, word) in parts.zip(TIMES) {
                let inside = |i: &usize| part.contains(&self.observations[*i].block);
                let group = own.iter().copied().filter(inside).collect();
                groups.push((format!("{word} {} hits of {name}", part.len()), group));
            }
        }
        groups
    }

    fn check(&self, group: String, own: &[usize]) -> Option<PredictiveCheck> {
        let (mut total, mut chi_square, mut p_value) = (0.0, 0.0, 0.0);
        for (predictions, weight) in self.posterior.predictions.iter().zip(&self.posterior.weights)
        {
            let residual = |&i: &usize| {
                let observation = &self.observations[i];
                let predicted = predictions.get(i).copied().flatten()?;
                Some((predicted - observation.value) / observation.standard_deviation)
            };
            // Draws without a prediction of the group are left out.
            let residuals: Option<Vec<f64>> = own.iter().map(residual).collect();
            let Some(residuals) = residuals else { continue };
            let sum: f64 = residuals.iter().map(|r| r * r).sum();
            total += weight;
            chi_square += weight * sum;
            p_value += weight * chi_square_tail(sum, own.len())?;
        }
        (total > 0.0).then(|| PredictiveCheck {
            group,
            observations: own.len(),
            chi_square: chi_square / total,
            p_value: p_value / total,
        })
    }
}
