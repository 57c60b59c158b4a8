//! The result of an identification that was stopped.

use std::time::Instant;

use asperity_inference::{Covariance, FitSolution, ForwardModel as _, Parameter, Profile, Strain};

use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::scenario_model::ScenarioModel;
use crate::starts::about_starts;
use crate::work::{WorkStage, expected_evaluations};
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
    /// Strains of the priors.
    pub strains: Vec<Strain>,
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
        let mut words = self.judgement().words("the result");
        words.push(format!("Incomplete: stopped in the {}; {missing}.", self.stage.name()));
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
}

/// The part of an incomplete identification that is known from the beginning.
pub(super) struct Unfinished {
    parameters: Vec<Parameter>,
    pub(super) names: Vec<String>,
    pub(super) labels: Vec<String>,
    law: String,
    started: Instant,
}

impl Unfinished {
    /// Begins the work of a problem.
    pub(super) fn begin(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        law: &str,
        started: Instant,
    ) -> Self {
        let spec = &problem.spec;
        let (parameters, compared) = (forward.parameters(), spec.compare.len() + 1);
        let latents = parameters.iter().filter(|parameter| parameter.is_latent()).count();
        let counts = [parameters.len(), latents];
        let mut expected = expected_evaluations(counts, spec.starts, spec.draws, compared);
        if problem.is_fast {
            expected[WorkStage::Profiles as usize] = 0.0;
            expected[WorkStage::Comparison as usize] = 0.0;
        }
        problem.work.plan(expected);
        Self {
            parameters: parameters.to_vec(),
            names: parameters.iter().map(|parameter| parameter.name().to_owned()).collect(),
            labels: forward.parameters.labels(&forward.scenario),
            law: law.to_owned(),
            started,
        }
    }

    /// The identification stopped in a part.
    pub(super) fn stopped(
        &self,
        stage: WorkStage,
        fit: FitSolution,
        covariance: Option<Covariance>,
        profiles: Vec<Profile>,
        laws: Laws,
    ) -> IdentificationError {
        let strains = Strain::of_priors(&self.parameters, &fit.point);
        IdentificationError::Stopped(Box::new(IncompleteIdentification {
            stage,
            names: self.names.clone(),
            labels: self.labels.clone(),
            fit,
            covariance,
            profiles,
            strains,
            laws,
            law: self.law.clone(),
            wall_s: self.started.elapsed().as_secs_f64(),
        }))
    }
}
