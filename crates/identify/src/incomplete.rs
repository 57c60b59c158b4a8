//! The result of an identification that was stopped.

use asperity_inference::{Covariance, FitSolution, Profile, ProfileEnd};
use serde_json::{Value, json};

use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::report::IDENTIFICATION_SCHEMA;
use crate::starts::{StartAgreement, about_starts, starts_at_best};
use crate::work::WorkStage;
use asperity_scenario::Laws;

/// Everything that was finished before a request to stop.
#[derive(Debug)]
pub struct IncompleteIdentification {
    /// The part that was under way.
    pub stage: WorkStage,
    /// Names of the parameters.
    pub names: Vec<String>,
    /// Their names in words.
    pub labels: Vec<String>,
    /// The best fit so far; its searches may not have converged.
    pub fit: FitSolution,
    /// Uncertainty near the optimum, if the fit was finished.
    pub covariance: Option<Covariance>,
    /// Profiles, if they were finished.
    pub profiles: Vec<Profile>,
    /// The laws at the best fit so far.
    pub laws: Laws,
    /// Name of the law to report.
    pub law: String,
    /// Wall-clock time \[s\].
    pub wall_s: f64,
}

impl IncompleteIdentification {
    /// The finished parts, in sentences.
    pub fn conclusions(&self) -> Vec<String> {
        let missing = match self.stage {
            WorkStage::Fit => "the fit has not ended, and its values are not an estimate",
            WorkStage::Profiles => {
                "the fit has ended; profiles, posterior and comparison are missing"
            }
            WorkStage::Posterior => {
                "fit and profiles have ended; posterior and comparison are missing"
            }
            WorkStage::Comparison => "the comparison with other laws is missing",
        };
        let mut words =
            vec![format!("Incomplete: stopped in the {}; {missing}.", self.stage.name())];
        words.push(format!(
            "Chi-square is {:.1} for {} observations.",
            self.fit.chi_square,
            self.fit.residuals.len()
        ));
        if self.stage != WorkStage::Fit {
            words.push(about_starts(&self.fit));
        }
        words
    }

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

    /// The scenario at the best fit so far.
    ///
    /// # Errors
    /// [`IdentificationError`] as for the problem itself.
    pub fn scenario_json(
        &self,
        problem: &IdentificationProblem,
    ) -> Result<Value, IdentificationError> {
        problem.scenario_at(&problem.with_pressures()?.spec.unknowns, &self.fit.point)
    }
}
