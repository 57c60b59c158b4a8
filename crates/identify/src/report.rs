//! `identification.json`, `law.json` and the tables.

use asperity_inference::{Ending, ModelVerdict, ProfileEnd};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::error::ProblemError;
use crate::read::Problem;
use crate::run::Identification;
use asperity_table::{CsvWriter, columns_to_csv};

/// Identifier of the format.
pub const IDENTIFICATION_SCHEMA: &str = "asperity/identification/1";

/// One unknown, identified.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Best fit.
    pub value: f64,
    /// Standard deviation near the optimum.
    pub standard_deviation: f64,
    /// Interval of the profile likelihood; null at an end where the data set no limit.
    pub profile_interval: [Option<f64>; 2],
    /// Mean of the posterior.
    pub posterior_mean: f64,
    /// Interval of the posterior, with equal tails.
    pub posterior_interval: [f64; 2],
    /// R-hat of its chains.
    pub r_hat: f64,
    /// Effective sample size of its chains.
    pub effective_sample_size: f64,
    /// Whether it is on a bound.
    pub at_bound: bool,
}

impl Identification {
    /// The unknowns, identified.
    pub fn estimates(&self) -> Vec<Estimate> {
        let deviations = self.covariance.value_standard_deviations();
        let tail = 0.5 * (1.0 - self.level);
        let found = &self.posterior.diagnostics;
        let end = |unknown: usize, side: usize| {
            let profile = self.profiles.iter().find(|profile| profile.unknown == unknown)?;
            (profile.ends[side] == ProfileEnd::Crossed).then_some(profile.interval[side])
        };
        let one = |(unknown, name): (usize, &String)| Estimate {
            name: name.clone(),
            value: self.fit.point[unknown],
            standard_deviation: deviations[unknown],
            profile_interval: [end(unknown, 0), end(unknown, 1)],
            posterior_mean: self.posterior.mean(unknown),
            posterior_interval: [tail, 1.0 - tail]
                .map(|probability| self.posterior.quantile(unknown, probability)),
            r_hat: found.r_hat[unknown],
            effective_sample_size: found.effective_sample_size[unknown],
            at_bound: self.fit.at_bound[unknown],
        };
        self.names.iter().enumerate().map(one).collect()
    }

    /// `identification.json`.
    pub fn report(&self, problem: &Problem) -> Value {
        let goodness = &self.goodness;
        let found = &self.posterior.diagnostics;
        let undetermined = self.identifiability.undetermined.iter().map(|undetermined| {
            let weights: Map<String, Value> =
                undetermined.weights.iter().map(|(name, w)| (name.clone(), json!(w))).collect();
            json!({"weights": weights, "remaining": undetermined.remaining})
        });
        json!({
            "schema": IDENTIFICATION_SCHEMA,
            "title": problem.spec.title,
            "pressure_dependence": self.dependence(),
            "explains_data": self.explains(),
            "converged": self.has_converged(),
            "words": self.words(),
            "level": self.level,
            "estimates": self.estimates(),
            "law": {
                "name": self.law.name,
                "informed_pa": self.law.informed_range(),
                "reached_pa": self.law.reached,
                "static_pressure_pa": self.law.at_rest,
            },
            "fit": {
                "chi_square": goodness.chi_square,
                "degrees_of_freedom": goodness.degrees_of_freedom,
                "p_value": goodness.p_value,
                "noise_factor": self.noise_factor,
                "missing": self.fit.missing.len(),
                "ending": ending_words(self.fit.ending),
                "iterations": self.fit.iterations,
                "starts": self.fit.starts.iter().map(|start| json!({
                    "cost": Some(start.cost).filter(|cost| cost.is_finite()),
                    "ending": ending_words(start.ending),
                })).collect::<Vec<_>>(),
                "distinct_optima": self.fit.distinct_optima.iter().map(|optimum| json!({
                    "cost": optimum.cost, "starts": optimum.starts, "point": optimum.point,
                })).collect::<Vec<_>>(),
            },
            "identifiability": {
                "singular_values": self.identifiability.singular_values,
                "condition": self.identifiability.condition,
                "undetermined": undetermined.collect::<Vec<_>>(),
                "exact_derivatives": self.linearisation.exact,
                "derivative_difference": self.linearisation.derivative_difference,
            },
            "correlation": self.covariance.correlation,
            "posterior": {
                "draws": self.posterior.draws.len(),
                "effective_draws": found.effective_draws,
                "pareto_shape": found.pareto_shape,
                "acceptance": found.acceptance,
                "rounds": found.rounds,
                "surface_error": found.surrogate_error,
                "r_hat": found.r_hat,
                "effective_sample_size": found.effective_sample_size,
                "autocorrelation_time": found.autocorrelation_time,
                "unreached": found.unreached.iter().map(|u| &self.names[*u]).collect::<Vec<_>>(),
            },
            "comparison": self.comparison(),
            "design": self.designed(),
            "notices": self.notices,
            "numerics": {
                "evaluations": self.fit.evaluations + found.evaluations,
                "wall_s": self.wall_s,
            },
            "provenance": {
                "version": env!("CARGO_PKG_VERSION"),
                "problem_sha256": problem.document.sha256(),
                "scenario_sha256": problem.scenario_sha256,
            },
        })
    }

    fn comparison(&self) -> Value {
        let Some(choice) = &self.choice else { return Value::Null };
        let best = &choice.candidates[choice.best];
        let candidates = choice.candidates.iter().map(|candidate| {
            json!({
                "name": candidate.name,
                "verdict": match candidate.verdict {
                    ModelVerdict::Best => "best",
                    ModelVerdict::Rejected { .. } | ModelVerdict::Misfit { .. } => "rejected",
                    ModelVerdict::Undecided => "undecided",
                },
                "chi_square": candidate.goodness.chi_square,
                "p_value": candidate.goodness.p_value,
                "missing": candidate.fit.missing.len(),
                "aicc_difference": finite(candidate.aicc - best.aicc),
                "bic_difference": finite(candidate.bic - best.bic),
                "score_difference": candidate.score_difference.and_then(finite),
                "score_error": candidate.difference_error.and_then(finite),
                "point": candidate.fit.point,
            })
        });
        json!({
            "noise_factor": self.choice_noise_factor,
            "candidates": candidates.collect::<Vec<_>>(),
        })
    }

    fn designed(&self) -> Value {
        let Some(design) = &self.design else { return Value::Null };
        let list = |hits: &[crate::design::DesignedHit]| {
            let one = |hit: &crate::design::DesignedHit| {
                json!({
                    "force_peak_n": hit.force_peak_n,
                    "set": hit.set,
                    "remaining": hit.remaining,
                    "information_nats": hit.information,
                })
            };
            hits.iter().map(one).collect::<Vec<_>>()
        };
        json!({
            "hits": design.hits,
            "candidates": list(&design.candidates),
            "sequence": list(&design.sequence),
        })
    }

    /// `law.json`: the law at the best fit, as a scenario writes it.
    pub fn law_json(&self) -> Option<Value> {
        serde_json::to_value(self.laws.get(&self.law.name)?).ok()
    }

    /// The scenario at the best fit.
    ///
    /// # Errors
    /// [`ProblemError`] as for the problem itself.
    pub fn scenario_json(&self, problem: &Problem) -> Result<Value, ProblemError> {
        problem.scenario_at(&self.fit.point)
    }

    /// `law.csv`: stiffness over pressure with its band.
    pub fn law_csv(&self) -> String {
        let informed: Vec<f64> =
            self.law.informed.iter().map(|informed| f64::from(u8::from(*informed))).collect();
        columns_to_csv([
            ("pressure_pa", &self.law.pressure),
            ("stiffness_pa_per_m", &self.law.stiffness),
            ("median_pa_per_m", &self.law.median),
            ("lower_pa_per_m", &self.law.lower),
            ("upper_pa_per_m", &self.law.upper),
            ("remaining", &self.law.remaining),
            ("informed", &informed),
        ])
    }

    /// `data.csv`: what was measured against what is predicted.
    pub fn data_csv(&self) -> String {
        let mut csv = CsvWriter::with_header([
            "data",
            "feature",
            "at",
            "value",
            "standard_deviation",
            "predicted",
            "lower",
            "upper",
            "residual",
            "weight",
        ]);
        let [lower, upper] = self.predicted_band();
        for (i, (about, observation)) in self.about.iter().zip(&self.observations).enumerate() {
            let numbers = [
                about.at,
                Some(observation.value),
                Some(observation.standard_deviation),
                self.fit.predictions[i],
                lower.get(i).copied(),
                upper.get(i).copied(),
                Some(self.fit.residuals[i]),
                Some(self.fit.weights[i]),
            ];
            csv.text(&about.data).text(&about.feature).numbers(numbers).end_row();
        }
        csv.into_string()
    }

    /// `posterior.csv`: the draws with their weights.
    pub fn posterior_csv(&self) -> String {
        let mut columns: Vec<(String, Vec<f64>)> =
            vec![("weight".to_owned(), self.posterior.weights.clone())];
        for (unknown, name) in self.names.iter().enumerate() {
            let values = self.posterior.draws.iter().map(|draw| draw[unknown]);
            columns.push((name.clone(), values.collect()));
        }
        columns_to_csv(columns)
    }

    /// Lower and upper end of the interval of every prediction.
    pub fn predicted_band(&self) -> [Vec<f64>; 2] {
        let tail = 0.5 * (1.0 - self.level);
        let band = self.posterior.prediction_band(&[tail, 1.0 - tail]);
        band.quantiles.try_into().unwrap_or_default()
    }

    /// One row for every observation: its data, its feature, and the force (or frequency,
    /// amplitude or pressure) that it is for.
    pub fn observed(&self) -> impl Iterator<Item = Observed<'_>> {
        self.about.iter().zip(&self.observations).enumerate().map(|(i, (about, observation))| {
            Observed {
                data: &about.data,
                feature: &about.feature,
                at: about.at,
                value: observation.value,
                standard_deviation: observation.standard_deviation,
                predicted: self.fit.predictions[i],
                residual: self.fit.residuals[i],
            }
        })
    }
}

/// One observation with its prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed<'a> {
    /// Name of the data.
    pub data: &'a str,
    /// The feature.
    pub feature: &'a str,
    /// Peak force \[N\], frequency \[Hz\], amplitude \[m\] or pressure \[Pa\].
    pub at: Option<f64>,
    /// As measured.
    pub value: f64,
    /// Its standard deviation.
    pub standard_deviation: f64,
    /// As predicted by the best fit.
    pub predicted: Option<f64>,
    /// In standard deviations.
    pub residual: f64,
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn ending_words(ending: Ending) -> &'static str {
    match ending {
        Ending::SmallGradient => "no direction lowers the cost",
        Ending::SmallReduction => "the cost no longer falls",
        Ending::SmallStep => "the steps are too short",
        Ending::MostIterations => "the iterations were used up",
        Ending::NoProgress => "no step lowers the cost",
        Ending::Refused => "the start cannot be run",
    }
}
