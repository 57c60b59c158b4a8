//! An identification under way, as it is told where it is stopped.

use std::time::Instant;

use asperity_inference::{Covariance, FitSolution, ForwardModel as _, Parameter, Profile, Strain};
use asperity_scenario::Laws;

use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::incomplete::IncompleteIdentification;
use crate::latent_sampling::posterior_options;
use crate::scenario_model::ScenarioModel;
use crate::work::{Forecast, Sizes, WorkStage};

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
        let (spec, parameters) = (&problem.spec, forward.parameters());
        let sizes = Sizes {
            parameters: parameters.len(),
            latents: parameters.iter().filter(|parameter| parameter.is_latent()).count(),
            observations: forward.observations().len(),
            starts: spec.starts,
            compared: spec.compare.len() + 1,
        };
        let mut expected = Forecast::new(sizes, &posterior_options(problem, sizes.latents > 0));
        if problem.is_fast {
            (expected.profiles, expected.comparison) = (0.0, 0.0);
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
