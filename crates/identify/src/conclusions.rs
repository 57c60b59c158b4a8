//! Conclusions of an identification, in sentences.

use asperity_inference::{ModelAssessment, ProfileEnd};
use serde::Serialize;

use crate::build::CONSTANT;
use crate::identification::Identification;
use asperity_scenario::four_digits;

/// Evidence for a stiffness that depends on pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PressureDependence {
    /// The stiffness depends on pressure: a constant one is rejected.
    Shown,
    /// The law is not distinguished from a constant stiffness.
    NotShown,
    /// No compared law explains the data.
    Unexplained,
    /// No parameter belongs to a law.
    NotAsked,
}

/// p-value of the residuals below which the data are unexplained.
const LEAST_PROBABILITY: f64 = 1e-3;

/// Least share of effective draws, and largest R-hat, of a converged posterior.
const MIN_DRAWS: f64 = 0.2;
const MOST_R_HAT: f64 = 1.02;

impl Identification {
    /// True if the law explains the data: the p-value of the residuals is at least 0.001 and no
    /// prediction is missing.
    pub fn explains(&self) -> bool {
        let p = self.goodness.p_value;
        p.is_none_or(|p| p >= LEAST_PROBABILITY) && self.fit.missing.is_empty()
    }

    /// True if fit and posterior have converged: R-hat of every parameter below 1.02, at least a
    /// fifth of the draws effective, and the profile intervals covered.
    pub fn has_converged(&self) -> bool {
        let found = &self.posterior.diagnostics;
        let share = found.effective_draws / self.posterior.draws.len().max(1) as f64;
        let mixed = found.r_hat.iter().all(|r| *r < MOST_R_HAT);
        self.fit.converged && share >= MIN_DRAWS && mixed && found.truncated.is_empty()
    }

    /// Evidence in the data for a stiffness that depends on pressure.
    pub fn pressure_dependence(&self) -> PressureDependence {
        let Some(comparison) = &self.comparison else { return PressureDependence::NotAsked };
        let constant = comparison.candidates.iter().find(|candidate| candidate.name == CONSTANT);
        match constant.map(|constant| constant.assessment) {
            None => PressureDependence::NotAsked,
            Some(verdict) if !verdict.is_rejected() => PressureDependence::NotShown,
            Some(_) if self.comparison_noise_factor > MAX_FACTOR => PressureDependence::Unexplained,
            Some(_) => PressureDependence::Shown,
        }
    }

    /// The conclusions in sentences, the most important first.
    pub fn conclusions(&self) -> Vec<String> {
        let mut words = vec![self.about_dependence()];
        words.extend(self.about_law());
        words.extend(self.about_choice());
        words.push(self.about_fit());
        words.extend(self.about_parameters());
        if !self.has_converged() {
            let found = &self.posterior.diagnostics;
            let lost: Vec<&str> =
                found.truncated.iter().map(|parameter| self.names[*parameter].as_str()).collect();
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
        match self.pressure_dependence() {
            PressureDependence::Shown => {
                "The data show a contact stiffness that depends on pressure: a constant stiffness is rejected.".to_owned()
            }
            PressureDependence::NotShown => {
                "The data do not show a contact stiffness that depends on pressure: a constant stiffness predicts data that were left out as well. The law below is not to be relied on.".to_owned()
            }
            PressureDependence::Unexplained => format!(
                "No law that was compared explains the data: residuals are {:.1} times as large as the standard deviations say. Whether the stiffness depends on pressure cannot be said.",
                self.comparison_noise_factor
            ),
            PressureDependence::NotAsked => "No contact law was in question.".to_owned(),
        }
    }

    fn about_law(&self) -> Option<String> {
        if self.pressure_dependence() == PressureDependence::NotAsked {
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
        let Some(comparison) = &self.comparison else { return Vec::new() };
        let best = &comparison.candidates[comparison.best].name;
        comparison
            .candidates
            .iter()
            .map(|candidate| match candidate.assessment {
                ModelAssessment::Best => format!("Of the laws compared, {best} does best."),
                ModelAssessment::Rejected { standard_errors, aicc_difference } => format!(
                    "Rejected: {}; it predicts data that were left out worse by {:.1} standard errors, and its AICc is {:.0} larger than that of {best}.",
                    candidate.name, standard_errors, aicc_difference
                ),
                ModelAssessment::Misfit { p_value, aicc_difference } => format!(
                    "Rejected: {}; residuals as large as its own have a probability of {p_value:.0e}, and its AICc is {aicc_difference:.0} larger than that of {best}.",
                    candidate.name
                ),
                ModelAssessment::Undecided => format!(
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

    fn about_parameters(&self) -> Vec<String> {
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
                    let name = &self.names[profile.parameter];
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

/// Noise factor of a comparison above which no law explains the data.
const MAX_FACTOR: f64 = 5.0;

/// Least weight of a parameter that is named in a combination.
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
        ProfileEnd::NoPrediction => "the scenario cannot be run further out",
        ProfileEnd::NotReached => "its profile is too flat to be followed",
    }
}
