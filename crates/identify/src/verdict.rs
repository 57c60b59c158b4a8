//! What an identification says, in words.

use asperity_inference::{ModelVerdict, ProfileEnd};
use serde::Serialize;

use crate::model::CONSTANT;
use crate::run::Identification;
use asperity_scenario::four_digits;

/// What the data say of the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Dependence {
    /// The stiffness depends on pressure: a constant one is rejected.
    Shown,
    /// They do not tell it from a constant stiffness.
    NotShown,
    /// No law that was compared explains them, so nothing is said.
    Unexplained,
    /// No unknown is of a law.
    NotAsked,
}

/// The probability of residuals as large as they are below which the data are called unexplained.
const LEAST_PROBABILITY: f64 = 1e-3;

/// Least share of effective draws, and largest R-hat, of a posterior that is called converged.
const LEAST_DRAWS: f64 = 0.2;
const MOST_R_HAT: f64 = 1.02;

impl Identification {
    /// Whether the law explains the data: the residuals are no larger than the standard deviations
    /// say, with a probability of at least 0.001.
    pub fn explains(&self) -> bool {
        let p = self.goodness.p_value;
        p.is_none_or(|p| p >= LEAST_PROBABILITY) && self.fit.missing.is_empty()
    }

    /// Whether the posterior is to be trusted: R-hat of every unknown below 1.02, a fifth of the
    /// draws effective, and nothing left out that the profiles allow.
    pub fn has_converged(&self) -> bool {
        let found = &self.posterior.diagnostics;
        let share = found.effective_draws / self.posterior.draws.len().max(1) as f64;
        let mixed = found.r_hat.iter().all(|r| *r < MOST_R_HAT);
        self.fit.converged && share >= LEAST_DRAWS && mixed && found.unreached.is_empty()
    }

    /// Whether the data show that stiffness depends on pressure.
    pub fn dependence(&self) -> Dependence {
        let Some(choice) = &self.choice else { return Dependence::NotAsked };
        let constant = choice.candidates.iter().find(|candidate| candidate.name == CONSTANT);
        match constant.map(|constant| constant.verdict) {
            None => Dependence::NotAsked,
            Some(verdict) if !verdict.is_rejected() => Dependence::NotShown,
            Some(_) if self.choice_noise_factor > MOST_FACTOR => Dependence::Unexplained,
            Some(_) => Dependence::Shown,
        }
    }

    /// The answer in sentences, the most important first.
    pub fn words(&self) -> Vec<String> {
        let mut words = vec![self.about_dependence()];
        words.extend(self.about_law());
        words.extend(self.about_choice());
        words.push(self.about_fit());
        words.extend(self.about_unknowns());
        if !self.has_converged() {
            let found = &self.posterior.diagnostics;
            let lost: Vec<&str> =
                found.unreached.iter().map(|unknown| self.names[*unknown].as_str()).collect();
            let lost = if lost.is_empty() {
                String::new()
            } else {
                format!(
                    ", and the draws leave out much of what the profiles allow of {}",
                    lost.join(", ")
                )
            };
            words.push(format!(
                "The posterior has not converged: {:.0} of {} draws are effective, the largest R-hat is {:.3}{lost}; take its bands for estimates.",
                found.effective_draws,
                self.posterior.draws.len(),
                found.r_hat.iter().copied().fold(1.0, f64::max),
            ));
        }
        words
    }

    fn about_dependence(&self) -> String {
        match self.dependence() {
            Dependence::Shown => {
                "The data show a contact stiffness that depends on pressure: a constant stiffness is rejected.".to_owned()
            }
            Dependence::NotShown => {
                "The data do not show a contact stiffness that depends on pressure: a constant stiffness predicts data that were left out as well. The law below is not to be relied on.".to_owned()
            }
            Dependence::Unexplained => format!(
                "No law that was compared explains the data: residuals are {:.1} times as large as the standard deviations say. Whether the stiffness depends on pressure cannot be said.",
                self.choice_noise_factor
            ),
            Dependence::NotAsked => "No contact law was in question.".to_owned(),
        }
    }

    fn about_law(&self) -> Option<String> {
        if self.dependence() == Dependence::NotAsked {
            return None;
        }
        Some(match self.law.informed_range() {
            None => format!(
                "The stiffness of law \"{}\" is not informed by the data at any pressure.",
                self.law.name
            ),
            Some([low, high]) => {
                let widest = self
                    .law
                    .informed
                    .iter()
                    .enumerate()
                    .filter(|(_, informed)| **informed)
                    .map(|(i, _)| {
                        0.5 * (self.law.upper[i] - self.law.lower[i]) / self.law.median[i]
                    })
                    .fold(0.0, f64::max);
                format!(
                    "The stiffness of law \"{}\" is informed from {} to {} MPa; there its {} % band is at most {:.1} % to either side.",
                    self.law.name,
                    four_digits(1e-6 * low),
                    four_digits(1e-6 * high),
                    four_digits(100.0 * self.level),
                    100.0 * widest,
                )
            }
        })
    }

    fn about_choice(&self) -> Vec<String> {
        let Some(choice) = &self.choice else { return Vec::new() };
        let best = &choice.candidates[choice.best].name;
        choice
            .candidates
            .iter()
            .map(|candidate| match candidate.verdict {
                ModelVerdict::Best => format!("Of the laws compared, {best} does best."),
                ModelVerdict::Rejected { standard_errors, aicc_difference } => format!(
                    "Rejected: {}; it predicts data that were left out worse by {:.1} standard errors, and its AICc is {:.0} larger than that of {best}.",
                    candidate.name, standard_errors, aicc_difference
                ),
                ModelVerdict::Misfit { p_value, aicc_difference } => format!(
                    "Rejected: {}; residuals as large as its own have a probability of {p_value:.0e}, and its AICc is {aicc_difference:.0} larger than that of {best}.",
                    candidate.name
                ),
                ModelVerdict::Undecided => format!(
                    "Undecided: the data do not tell {} from {best}{}.",
                    candidate.name,
                    difference_words(candidate.score_difference, candidate.difference_error),
                ),
            })
            .collect()
    }

    fn about_fit(&self) -> String {
        let goodness = &self.goodness;
        let base = format!(
            "Chi-square is {:.1} for {} degrees of freedom",
            goodness.chi_square, goodness.degrees_of_freedom
        );
        let missing = match self.fit.missing.len() {
            0 => String::new(),
            count => format!(" {count} of the data are peaks that the model does not have."),
        };
        if self.explains() {
            return format!("{base}: the law explains the data.");
        }
        let scaled = if self.noise_factor > 1.0 {
            format!("; all uncertainties were multiplied by {:.2} for it", self.noise_factor)
        } else {
            String::new()
        };
        format!(
            "{base}: the residuals are larger than the standard deviations say{scaled}.{missing}"
        )
    }

    fn about_unknowns(&self) -> Vec<String> {
        let mut words = Vec::new();
        for undetermined in &self.identifiability.undetermined {
            let parts: Vec<String> = undetermined
                .weights
                .iter()
                .filter(|(_, weight)| weight.abs() > LEAST_WEIGHT)
                .map(|(name, weight)| format!("{weight:+.2} {name}"))
                .collect();
            words.push(format!(
                "The data do not determine: {} (each over its range); {:.0} % of the uncertainty beforehand is left.",
                parts.join(" "),
                100.0 * undetermined.remaining
            ));
        }
        for profile in &self.profiles {
            for (end, side) in profile.ends.iter().zip(["below", "above"]) {
                if *end != ProfileEnd::Crossed {
                    let name = &self.names[profile.unknown];
                    words.push(format!(
                        "The data set no limit {side} to {name}: {}.",
                        end_words(*end)
                    ));
                }
            }
        }
        words
    }
}

/// Noise factor of a comparison beyond which not even the best law is near the data.
const MOST_FACTOR: f64 = 5.0;

/// Weight of an unknown in a combination below which it is not named.
const LEAST_WEIGHT: f64 = 0.2;

fn difference_words(difference: Option<f64>, error: Option<f64>) -> String {
    match (difference, error) {
        (Some(difference), Some(error)) => {
            format!(" (score differs by {difference:.1} with a standard error of {error:.1})")
        }
        _ => String::new(),
    }
}

fn end_words(end: ProfileEnd) -> &'static str {
    match end {
        ProfileEnd::Crossed => "it is inside its bounds",
        ProfileEnd::Bound => "its interval ends at the bound",
        ProfileEnd::Refused => "the scenario cannot be run further out",
        ProfileEnd::NotReached => "its profile is too flat to be followed",
    }
}
