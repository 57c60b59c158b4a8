//! `identification.json`, `law.json` and the tables.

use asperity_inference::{Agreement, Covariance, FitTermination, ModelAssessment, ProfileEnd};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::design::{CandidateMeasurement, MeasurementKind};
use crate::error::IdentificationError;
use crate::identification::Identification;
use crate::identification_problem::IdentificationProblem;
use crate::incomplete::IncompleteIdentification;
use crate::law_band::StiffnessOrigin;
use crate::starts::{StartAgreement, starts_at_best};
use crate::work::WorkStage;
use asperity_table::DataTable;

/// Identifier of the format.
pub const IDENTIFICATION_SCHEMA: &str = "asperity/identification/1";

/// Identifier of the format of `draws.json`.
pub const DRAWS_SCHEMA: &str = "asperity/draws/1";

/// The estimate of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Its name in words: a step of a monotone law by the stiffnesses that it relates.
    pub label: String,
    /// True for a step or stiffness of a monotone law, which
    /// [`Identification::stiffnesses`] gives in Pa/m.
    pub in_steps: bool,
    /// Best fit.
    pub value: f64,
    /// Standard deviation near the optimum.
    pub standard_deviation: f64,
    /// Interval of the profile likelihood; null at an open end.
    pub profile_interval: [Option<f64>; 2],
    /// Mean of the posterior.
    pub posterior_mean: f64,
    /// Interval of the posterior, with equal tails.
    pub posterior_interval: [f64; 2],
    /// Monte Carlo standard error of both ends of the posterior interval.
    pub posterior_interval_error: [f64; 2],
    /// R-hat of its chains.
    pub r_hat: f64,
    /// Effective sample size of its chains.
    pub effective_sample_size: f64,
    /// True if it is on a bound.
    pub at_bound: bool,
}

impl Identification {
    /// Estimates of the parameters.
    pub fn estimates(&self) -> Vec<Estimate> {
        let deviations = self.covariance.value_standard_deviations();
        let tail = 0.5 * (1.0 - self.level);
        let tails = [tail, 1.0 - tail];
        let found = &self.posterior.diagnostics;
        let end = |parameter: usize, side: usize| {
            let profile = self.profiles.iter().find(|profile| profile.parameter == parameter)?;
            (profile.ends[side] == ProfileEnd::Crossed).then_some(profile.interval[side])
        };
        let names = self.names.iter().enumerate().filter(|(parameter, _)| !self.latent[*parameter]);
        let one = |(parameter, name): (usize, &String)| Estimate {
            name: name.clone(),
            label: self.labels[parameter].clone(),
            in_steps: self.in_steps[parameter],
            value: self.fit.point[parameter],
            standard_deviation: deviations[parameter],
            profile_interval: [end(parameter, 0), end(parameter, 1)],
            posterior_mean: self.posterior.mean(parameter),
            posterior_interval: tails.map(|tail| self.posterior.quantile(parameter, tail)),
            posterior_interval_error: tails
                .map(|tail| self.posterior.quantile_error(parameter, tail)),
            r_hat: found.r_hat[parameter],
            effective_sample_size: found.effective_sample_size[parameter],
            at_bound: self.fit.at_bound[parameter],
        };
        names.map(one).collect()
    }

    /// `identification.json`.
    pub fn report(&self, problem: &IdentificationProblem) -> Value {
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
            "complete": !self.stopped,
            "fast": self.is_fast,
            "judgement": self.judgement(),
            "pressure_dependence": self.pressure_dependence(),
            "explains_data": self.explains(),
            "agreement": match self.agreement() {
                Agreement::Good => "good",
                Agreement::Doubtful => "doubtful",
                Agreement::None => "none",
            },
            "checks": self.checks(),
            "converged": self.has_converged(),
            "words": self.conclusions(),
            "level": self.level,
            "estimates": self.estimates(),
            "stiffnesses": self.stiffnesses,
            "free_law": self.free_law,
            "law": {
                "name": self.law.name,
                "informed_pa": self.law.informed_range(),
                "given_pa": self.law.ranges(StiffnessOrigin::Given),
                "smoothness_pa": self.law.ranges(StiffnessOrigin::Smoothness),
                "open_pa": self.law.ranges(StiffnessOrigin::Open),
                "reached_pa": self.law.reached,
                "static_pressure_pa": self.law.at_rest,
            },
            "explanations": self.explanations,
            "given": self.given,
            "rigid_support": self.rigid_support,
            "fit": {
                "chi_square": goodness.chi_square,
                "degrees_of_freedom": goodness.degrees_of_freedom,
                "p_value": goodness.p_value,
                "noise_factor": self.noise_factor,
                "missing": self.fit.missing.len(),
                "ending": termination_text(self.fit.termination),
                "iterations": self.fit.iterations,
                "starts_at_best": starts_at_best(&self.fit),
                "start_agreement": StartAgreement::of(&self.fit),
                "starts": self.fit.starts.iter().map(|start| json!({
                    "cost": Some(start.cost).filter(|cost| cost.is_finite()),
                    "ending": termination_text(start.termination),
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
                "unreached": found.truncated.iter().map(|u| &self.names[*u]).collect::<Vec<_>>(),
            },
            "comparison": self.comparison(),
            "design": self.designed(),
            "notices": self.notices,
            "numerics": {
                "evaluations": self.fit.evaluations + found.evaluations,
                "hits": self.hits,
                "feature_errors": self.feature_errors,
                "wall_s": self.wall_s,
            },
            "provenance": {
                "version": env!("CARGO_PKG_VERSION"),
                "problem_sha256": problem.document.sha256(),
                "scenario_sha256": problem.scenario_sha256,
                "files": self.files,
            },
        })
    }

    fn comparison(&self) -> Value {
        let Some(comparison) = &self.comparison else { return Value::Null };
        let best = &comparison.candidates[comparison.best];
        let candidates = comparison.candidates.iter().map(|candidate| {
            json!({
                "name": candidate.name,
                "verdict": match candidate.assessment {
                    ModelAssessment::Best => "best",
                    ModelAssessment::Rejected { .. } | ModelAssessment::Misfit { .. } => "rejected",
                    ModelAssessment::Undecided => "undecided",
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
            "noise_factor": self.comparison_noise_factor,
            "candidates": candidates.collect::<Vec<_>>(),
        })
    }

    fn designed(&self) -> Value {
        let Some(design) = &self.design else { return Value::Null };
        let list = |all: &[CandidateMeasurement]| {
            let one = |one: &CandidateMeasurement| {
                let mut shown = match &one.kind {
                    MeasurementKind::Hits { force_peak_n, set } => {
                        json!({"force_peak_n": force_peak_n, "set": set})
                    }
                    MeasurementKind::Stiffness { pressure_pa } => {
                        json!({"stiffness_at_pa": pressure_pa})
                    }
                };
                shown["remaining"] = json!(one.remaining);
                shown["information_nats"] = json!(one.information);
                shown
            };
            all.iter().map(one).collect::<Vec<_>>()
        };
        json!({
            "hits": design.hits,
            "pressures_pa": design.pressures_pa,
            "candidates": list(&design.candidates),
            "sequence": list(&design.sequence),
        })
    }

    /// `law.json`: the law at the best fit, as a scenario writes it.
    pub fn law_json(&self) -> Option<Value> {
        serde_json::to_value(self.laws.get(&self.law.name)?).ok()
    }

    /// The scenario at the best fit, with absolute names of its files.
    ///
    /// # Errors
    /// [`IdentificationError`] as for the problem itself.
    pub fn scenario_json(
        &self,
        problem: &IdentificationProblem,
    ) -> Result<Value, IdentificationError> {
        problem.scenario_for_any_folder(&self.unknowns, &self.fit.point)
    }

    /// `draws.json`: the draws of the posterior as changes of the scenario, for predictions by
    /// `asperity study`. Gains are no part of a scenario.
    ///
    /// # Errors
    /// [`IdentificationError`] as for the problem itself.
    pub fn draws_json(
        &self,
        problem: &IdentificationProblem,
    ) -> Result<Value, IdentificationError> {
        let (pointers, draws) = problem.changes_at(&self.unknowns, &self.posterior.draws)?;
        Ok(json!({
            "schema": DRAWS_SCHEMA,
            "judgement": self.judgement(),
            "pointers": pointers,
            "weights": self.posterior.weights,
            "draws": draws,
        }))
    }

    /// `law.csv`: stiffness over pressure with its band.
    pub fn law_table(&self) -> DataTable {
        let law = &self.law;
        let [first, third] = &law.quartiles;
        let resolution = |pressure: &f64| self.free_law.as_ref()?.resolution(*pressure);
        let all = |values: &'_ [f64]| values.to_vec();
        DataTable::new()
            .numbers("pressure_pa", all(&law.pressure))
            .numbers("stiffness_pa_per_m", all(&law.stiffness))
            .numbers("median_pa_per_m", all(&law.median))
            .numbers("lower_pa_per_m", all(&law.lower))
            .numbers("upper_pa_per_m", all(&law.upper))
            .numbers("remaining", all(&law.remaining))
            .flags("informed", law.informed.iter().copied())
            .texts("origin", law.origin.iter().map(|origin| origin.name()))
            .numbers("lower_50_pa_per_m", all(first))
            .numbers("upper_50_pa_per_m", all(third))
            .numbers("resolution_ln_p", law.pressure.iter().map(resolution))
    }

    /// `data.csv`: observations with their predictions.
    pub fn data_table(&self) -> DataTable {
        let [lower, upper] = self.predicted_band();
        let band = |ends: &[f64]| -> Vec<Option<f64>> {
            (0..self.observations.len()).map(|i| ends.get(i).copied()).collect()
        };
        DataTable::new()
            .texts("data", self.about.iter().map(|about| &about.data))
            .texts("feature", self.about.iter().map(|about| &about.feature))
            .numbers("at", self.about.iter().map(|about| about.at))
            .numbers("value", self.observations.iter().map(|one| one.value))
            .numbers(
                "standard_deviation",
                self.observations.iter().map(|one| one.standard_deviation),
            )
            .numbers("predicted", self.fit.predictions.iter().copied())
            .numbers("lower", band(&lower))
            .numbers("upper", band(&upper))
            .numbers("residual", self.fit.residuals.iter().copied())
            .numbers("weight", self.fit.weights.iter().copied())
    }

    /// `posterior.csv`: the draws with their weights.
    pub fn posterior_table(&self) -> DataTable {
        let weights = self.posterior.weights.iter().copied();
        let table = DataTable::new().numbers("weight", weights);
        self.names.iter().enumerate().fold(table, |table, (parameter, name)| {
            table.numbers(name, self.posterior.draws.iter().map(|draw| draw[parameter]))
        })
    }

    /// Lower and upper end of the interval of every prediction.
    pub fn predicted_band(&self) -> [Vec<f64>; 2] {
        let tail = 0.5 * (1.0 - self.level);
        let band = self.posterior.prediction_band(&[tail, 1.0 - tail]);
        band.quantiles.try_into().unwrap_or_default()
    }

    /// The observations with their predictions at the best fit.
    pub fn observations(&self) -> impl Iterator<Item = PredictedObservation<'_>> {
        self.about.iter().zip(&self.observations).enumerate().map(|(i, (about, observation))| {
            PredictedObservation {
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

impl IncompleteIdentification {
    /// `identification.json`, with `"complete": false`.
    pub fn report(&self, problem: &IdentificationProblem) -> Value {
        let deviations = self.covariance.as_ref().map(Covariance::value_standard_deviations);
        let estimate = |(parameter, name): (usize, &String)| {
            let profile = self.profiles.iter().find(|profile| profile.parameter == parameter);
            let ends = profile.map(|profile| {
                [0, 1].map(|side| {
                    (profile.ends[side] == ProfileEnd::Crossed).then_some(profile.interval[side])
                })
            });
            json!({
                "name": name,
                "label": self.labels[parameter],
                "value": self.fit.point[parameter],
                "standard_deviation": deviations.as_ref().map(|all| all[parameter]),
                "profile_interval": ends,
                "at_bound": self.fit.at_bound[parameter],
            })
        };
        json!({
            "schema": IDENTIFICATION_SCHEMA,
            "title": problem.spec.title,
            "complete": false,
            "judgement": self.judgement(),
            "stopped_in": self.stage.name(),
            "words": self.conclusions(),
            "estimates": self.names.iter().enumerate().map(estimate).collect::<Vec<_>>(),
            "law": {"name": self.law},
            "fit": {
                "chi_square": self.fit.chi_square,
                "observations": self.fit.residuals.len(),
                "missing": self.fit.missing.len(),
                "converged": self.stage != WorkStage::Fit && self.fit.converged,
                "iterations": self.fit.iterations,
                "starts_at_best": starts_at_best(&self.fit),
                "start_agreement": StartAgreement::of(&self.fit),
            },
            "numerics": {"evaluations": self.fit.evaluations, "wall_s": self.wall_s},
            "provenance": {
                "version": env!("CARGO_PKG_VERSION"),
                "problem_sha256": problem.document.sha256(),
                "scenario_sha256": problem.scenario_sha256,
            },
        })
    }

    /// `law.json`: the law at the best fit so far, as a scenario writes it.
    pub fn law_json(&self) -> Option<Value> {
        serde_json::to_value(self.laws.get(&self.law)?).ok()
    }

    /// The scenario at the best fit so far, with absolute names of its files.
    ///
    /// # Errors
    /// [`IdentificationError`] as for the problem itself.
    pub fn scenario_json(
        &self,
        problem: &IdentificationProblem,
    ) -> Result<Value, IdentificationError> {
        problem.scenario_for_any_folder(&problem.with_pressures()?.spec.unknowns, &self.fit.point)
    }
}

/// One observation with its prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedObservation<'a> {
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

fn termination_text(termination: FitTermination) -> &'static str {
    match termination {
        FitTermination::SmallGradient => "no direction lowers the cost",
        FitTermination::SmallReduction => "the cost no longer falls",
        FitTermination::SmallStep => "the steps are too short",
        FitTermination::SlowReduction => "it fell too slowly, far from the data",
        FitTermination::IterationLimit => "the iterations were used up",
        FitTermination::NoReduction => "no step lowers the cost",
        FitTermination::NoPrediction => "the start cannot be run",
    }
}
