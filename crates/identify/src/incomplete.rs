//! The result of an identification that was stopped.

use asperity_inference::{Covariance, FitSolution, Profile, Strain};

use crate::starts::about_starts;
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
