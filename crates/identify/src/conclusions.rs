//! Conclusions of an identification, in sentences.

use asperity_inference::{Agreement, ModelAssessment, ProfileEnd, RELIABLE_SHAPE};
use serde::Serialize;

use crate::build::CONSTANT;
use crate::identification::Identification;
use crate::law_band::{LawBand, StiffnessOrigin};
use crate::problem::SlopeSmoothness;
use crate::starts::{about_starts, starts_at_best};
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

/// Least share of effective draws, and largest R-hat, of a converged posterior.
const MIN_DRAWS: f64 = 0.2;
const MOST_R_HAT: f64 = 1.02;

/// Effective draws of which no band can be made.
const FEW_DRAWS: f64 = 20.0;

impl Identification {
    /// True if the law explains the data: their [agreement](Self::agreement) is good.
    pub fn explains(&self) -> bool {
        self.agreement() == Agreement::Good
    }

    /// True if fit and posterior have converged: R-hat of every parameter below 1.02, at least a
    /// fifth of the draws effective (with a Pareto shape of at most 0.7 where their weights were cut), and
    /// the profile intervals covered.
    pub fn has_converged(&self) -> bool {
        self.fit.converged && self.sampler_has_converged()
    }

    /// True if the posterior has converged.
    pub(crate) fn sampler_has_converged(&self) -> bool {
        let found = &self.posterior.diagnostics;
        let share = found.effective_draws / self.posterior.draws.len().max(1) as f64;
        let mixed = found.r_hat.iter().all(|r| *r < MOST_R_HAT);
        let is_whole = found.truncated.is_empty() && !self.has_heavy_weights(RELIABLE_SHAPE);
        share >= MIN_DRAWS && mixed && is_whole
    }

    /// True if weights were cut whose tail has a Pareto shape above this.
    pub(crate) fn has_heavy_weights(&self, shape: f64) -> bool {
        let found = &self.posterior.diagnostics;
        let is_cut = found.evaluated_draws > self.posterior.draws.len();
        is_cut && found.pareto_shape.is_some_and(|found| found > shape)
    }

    /// Evidence in the data for a stiffness that depends on pressure.
    pub fn pressure_dependence(&self) -> PressureDependence {
        let Some(comparison) = &self.comparison else { return PressureDependence::NotAsked };
        let constant = comparison.candidates.iter().find(|candidate| candidate.name == CONSTANT);
        match constant.map(|constant| constant.assessment) {
            None => PressureDependence::NotAsked,
            Some(assessment) if !assessment.is_rejected() => PressureDependence::NotShown,
            Some(_) if self.comparison_noise_factor > MAX_FACTOR => PressureDependence::Unexplained,
            Some(_) => PressureDependence::Shown,
        }
    }

    /// Number of starts of the fit that reached its lowest cost: their deviance is at most one above.
    pub fn starts_at_best(&self) -> usize {
        starts_at_best(&self.fit)
    }

    /// The conclusions in sentences, the most important first.
    pub fn conclusions(&self) -> Vec<String> {
        let mut words = self.judgement().words(&self.subject());
        words.extend(self.about_explanations());
        if self.stopped {
            words.push(
                "Incomplete: stopped before the comparison with other laws had ended, which is missing."
                    .to_owned(),
            );
        } else if !self.is_fast {
            words.push(self.about_dependence());
        }
        words.extend(self.about_law());
        words.extend(self.about_given());
        words.extend(self.about_comparison());
        words.push(self.about_fit());
        words.push(about_starts(&self.fit));
        words.extend(self.about_parameters());
        words
    }

    /// The failure of the sampler to converge.
    pub(crate) fn about_sampler(&self) -> String {
        if let Some(reason) = &self.unsampled {
            return format!(
                "the posterior could not be sampled, so that there are no intervals: {reason}."
            );
        }
        let found = &self.posterior.diagnostics;
        let lost: Vec<&str> =
            found.truncated.iter().map(|parameter| self.labels[*parameter].as_str()).collect();
        let lost = match lost.join(", ") {
            none if none.is_empty() => none,
            lost => format!(
                ", and the draws leave out more than a quarter of the profile interval of {lost}"
            ),
        };
        let heavy = match found.pareto_shape {
            Some(shape) if self.has_heavy_weights(RELIABLE_SHAPE) => {
                format!(", their weights have a heavy tail (Pareto shape {shape:.2})")
            }
            _ => String::new(),
        };
        format!(
            "the posterior has not converged: {:.0} of {} draws are effective{heavy}, the largest R-hat is {:.3}{lost}; its bands {}.",
            found.effective_draws,
            self.posterior.draws.len(),
            found.r_hat.iter().copied().fold(1.0, f64::max),
            if found.effective_draws < FEW_DRAWS { "say nothing" } else { "are estimates" },
        )
    }

    fn about_dependence(&self) -> String {
        match self.pressure_dependence() {
            PressureDependence::Shown => {
                "The data show a contact stiffness that depends on pressure: a constant stiffness is rejected.".to_owned()
            }
            PressureDependence::NotShown => {
                "The data do not show a contact stiffness that depends on pressure: a constant stiffness is not rejected. The data do not support the law below.".to_owned()
            }
            PressureDependence::Unexplained => format!(
                "None of the compared laws explains the data: the standard deviations are too small by a factor of {:.1}. The data do not decide if the stiffness depends on pressure.",
                self.comparison_noise_factor
            ),
            PressureDependence::NotAsked => "No parameter belongs to a contact law.".to_owned(),
        }
    }

    fn about_law(&self) -> Vec<String> {
        let is_unasked = self.pressure_dependence() == PressureDependence::NotAsked;
        if !self.stopped && !self.acts_on_law && is_unasked {
            return Vec::new();
        }
        let mut words = vec![self.about_informed()];
        words.push(self.about_form());
        let ranges = |origin: StiffnessOrigin| {
            let words = |range: [f64; 2]| match range.map(|p| four_digits(1e-6 * p)) {
                [low, high] if low == high => format!("at {low} MPa"),
                [low, high] => format!("from {low} to {high} MPa"),
            };
            self.law.ranges(origin).into_iter().map(words).collect::<Vec<_>>().join(" and ")
        };
        let name = &self.law.name;
        let given = ranges(StiffnessOrigin::Given);
        if !given.is_empty() {
            words.push(format!(
                "Law \"{name}\" is the scenario's {given}: no parameter acts on it there, so that its band has no width, and it was not measured."
            ));
        }
        let smoothness = ranges(StiffnessOrigin::Smoothness);
        if !smoothness.is_empty() {
            words.push(format!(
                "The stiffness of law \"{name}\" {smoothness} follows from the data at other pressures by the smoothness of the law: the averaging kernel is wider than a decade of pressure there."
            ));
        }
        let open = ranges(StiffnessOrigin::Open);
        if !open.is_empty() {
            words.push(format!(
                "The data leave law \"{name}\" open {open}: its band there is that of bounds, priors and the form of the law."
            ));
        }
        words
    }

    /// The change of the model that would explain the data best.
    fn about_explanations(&self) -> Option<String> {
        let best = self.explanations.first()?;
        let chi_square = match (best.chi_square, best.expected_chi_square) {
            (Some(found), _) => format!("{found:.1} in a short fit"),
            (None, Some(expected)) => format!("about {expected:.1} by the linearised model"),
            (None, None) => return None,
        };
        Some(format!(
            "What would explain the data better: {}, with a chi-square of {chi_square} instead of {:.1}. It is a suggestion, to be checked on the rig.",
            best.cause, self.goodness.chi_square
        ))
    }

    /// The given numbers on which the law depends.
    fn about_given(&self) -> Option<String> {
        let first = self.given.first()?;
        let each = self.given.iter().take(MOST_GIVEN).map(|one| {
            format!(
                "{:+.2} % for {}, known to {} %",
                one.sensitivity,
                one.label,
                four_digits(100.0 * one.relative)
            )
        });
        Some(format!(
            "The law rests on given numbers. One per cent of a number changes K({} MPa) by: {}. Their tolerances are in the band of the law.",
            four_digits(1e-6 * first.pressure_pa),
            each.collect::<Vec<_>>().join("; ")
        ))
    }

    fn about_informed(&self) -> String {
        match self.law.informed_range() {
            None => format!(
                "The data inform the stiffness of law \"{}\" at no pressure.",
                self.law.name
            ),
            Some([low, high]) => {
                let name = &self.law.name;
                let range = match [low, high].map(|p| four_digits(1e-6 * p)) {
                    [low, high] if low == high => format!("at {low} MPa"),
                    [low, high] => format!("from {low} to {high} MPa"),
                };
                let LawBand { median, lower, upper, informed, .. } = &self.law;
                let informed = (0..informed.len()).filter(|&i| informed[i]);
                if self.judgement().is_void() {
                    return format!(
                        "The data bear on the stiffness of law \"{name}\" {range}; its band is void."
                    );
                }
                let half_widths = informed.map(|i| 0.5 * (upper[i] - lower[i]) / median[i]);
                let widest = half_widths.fold(0.0, f64::max);
                format!(
                    "The data inform the stiffness of law \"{name}\" {range}; the half width of its {} % band there is at most {:.1} % of the median.",
                    four_digits(100.0 * self.level),
                    100.0 * widest,
                )
            }
        }
    }

    /// The assumption of the band about the form.
    fn about_form(&self) -> String {
        let name = &self.law.name;
        let Some(free) = self.free_law.as_ref().filter(|free| free.law == *name) else {
            let knots = self.assumed_knots();
            return format!(
                "The band of law \"{name}\" is conditional on the form of the law{knots}: it does not contain the error of a form that the true law does not have. A free_law assumes none."
            );
        };
        let finest = free.pressures_pa.iter().zip(&free.resolution_ln_p);
        let [low, high] = self.law.reached;
        let finest = finest.filter(|(pressure, _)| (low..=high).contains(*pressure));
        let finest = finest.min_by(|a, b| a.1.total_cmp(b.1));
        let resolved = finest.map(|(pressure, width)| {
            format!(
                " The resolution is best at {} MPa, where the averaging kernel is as wide as a factor of {:.2} in pressure; a shoulder or a bump narrower than that is not seen.",
                four_digits(1e-6 * pressure),
                width.exp()
            )
        });
        let few = if self.lacks_second_harmonics() {
            " Fewer than half of the hits have a second harmonic: frequency and receptance over \
             force alone hardly separate the slope of the law from its curvature, and the band \
             may be too narrow."
        } else {
            ""
        };
        let rough = free.smoothness.iter().find(|one| one.kind == SlopeSmoothness::Continuous);
        let rough = rough.filter(|_| free.smoothness.len() > 1).map(|one| {
            format!(" (a slope without a derivative, as of a law with kinks, has a probability of {:.2})", one.probability)
        });
        let tends = match free.form_unknowns.len() {
            0 => "the law tends to that of the scenario".to_owned(),
            count => format!(
                "the law tends to the form of the scenario's law, of which {count} numbers are unknown"
            ),
        };
        format!(
            "The form of law \"{name}\" is free: only smoothness was assumed, with a roughness of {} to {} that the data chose{}; where the data say nothing, {tends}.{}{few}",
            four_digits(free.roughness[0]),
            four_digits(free.roughness[2]),
            rough.unwrap_or_default(),
            resolved.unwrap_or_default()
        )
    }

    /// The knots of a monotone law in words, which the problem assumes; empty without any.
    fn assumed_knots(&self) -> String {
        let own = self.stiffnesses.iter().filter(|one| one.law == self.law.name);
        let knots: Vec<String> = own.map(|one| four_digits(1e-6 * one.pressure_pa)).collect();
        match knots.len() {
            0 => String::new(),
            count => {
                format!(" and on its {count} knots, at {} MPa, which are assumed", knots.join(", "))
            }
        }
    }

    /// True if hits have a fundamental, and fewer than half as many a second harmonic.
    fn lacks_second_harmonics(&self) -> bool {
        let count = |name: &str| self.about.iter().filter(|label| label.feature == name).count();
        let hits = count("fundamental.frequency_hz");
        hits > 0 && 2 * count("harmonic_ratio") < hits
    }

    fn about_comparison(&self) -> Vec<String> {
        let Some(comparison) = &self.comparison else { return Vec::new() };
        let best = &comparison.candidates[comparison.best].name;
        let others = comparison.candidates.iter().filter(|candidate| candidate.name != *best);
        let next = others.min_by(|a, b| a.aicc.total_cmp(&b.aicc));
        comparison
            .candidates
            .iter()
            .map(|candidate| match candidate.assessment {
                ModelAssessment::Best => match next.map(|next| (next, next.aicc - candidate.aicc)) {
                    Some((next, difference)) if difference >= 0.0 => format!(
                        "Of those compared, {best} has the lowest AICc, {difference:.1} below that of {}.",
                        next.name
                    ),
                    Some((_, difference)) if !difference.is_finite() => format!(
                        "There are too few observations for an information criterion; {best} stands first by residuals alone."
                    ),
                    _ => format!(
                        "Of those whose cross-validation score is within one standard error of the highest, {best} has the lowest AICc."
                    ),
                },
                ModelAssessment::Rejected { standard_errors, aicc_difference } => format!(
                    "Rejected: {}; its cross-validation score is {:.1} standard errors lower, and its AICc is {:.0} larger than that of {best}.",
                    candidate.name, standard_errors, aicc_difference
                ),
                ModelAssessment::Misfit { p_value, .. } => format!(
                    "Rejected: {}; its chi-square is {:.1}, and the p-value of its residuals {p_value:.0e}.",
                    candidate.name, candidate.goodness.chi_square
                ),
                ModelAssessment::Undecided => format!(
                    "Undecided: the data do not distinguish {} from {best}{}.",
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
            count => format!(" {count} observations are peaks that the model does not have."),
        };
        match (self.agreement(), self.goodness.p_value) {
            (Agreement::Good, _) => return format!("{base}: the law explains the data."),
            (Agreement::Doubtful, Some(p)) => {
                return format!(
                    "{base} (p = {p:.2}): it is doubtful that the law explains the data; all uncertainties are multiplied by {:.2}, for the size of the residuals and their correlation.",
                    self.noise_factor
                );
            }
            _ => {}
        }
        let scaled = if self.noise_factor > 1.0 {
            format!(
                "; all uncertainties are multiplied by {:.2}, for their size and the correlation of residuals",
                self.noise_factor
            )
        } else {
            String::new()
        };
        format!("{base}: the residuals exceed the standard deviations{scaled}.{missing}")
    }

    /// The name of a parameter in words.
    pub(crate) fn label<'a>(&'a self, name: &'a str) -> &'a str {
        let place = self.names.iter().position(|known| known == name);
        place.map_or(name, |place| self.labels[place].as_str())
    }

    fn about_parameters(&self) -> Vec<String> {
        let mut words = Vec::new();
        for undetermined in &self.identifiability.undetermined {
            // The law's band and resolution tell about its latents.
            let is_latent = |name: &str| {
                let place = self.names.iter().position(|known| known == name);
                place.is_some_and(|place| self.latent[place])
            };
            let of_latents = undetermined.weights.iter().filter(|(name, _)| is_latent(name));
            if of_latents.map(|(_, weight)| weight * weight).sum::<f64>() > 0.5 {
                continue;
            }
            let parts: Vec<String> = undetermined
                .weights
                .iter()
                .filter(|(_, weight)| weight.abs() > LEAST_WEIGHT)
                .map(|(name, weight)| format!("{weight:+.2} ({})", self.label(name)))
                .collect();
            words.push(format!(
                "The data do not determine {} (each over its range): {:.0} % of the prior standard deviation remains.",
                parts.join(" "),
                100.0 * undetermined.remaining
            ));
        }
        for profile in &self.profiles {
            for (end, side) in profile.ends.iter().zip(["lower", "upper"]) {
                if *end != ProfileEnd::Crossed {
                    let name = &self.labels[profile.parameter];
                    words.push(format!(
                        "The data give no {side} limit of {name}: {}.",
                        end_words(*end)
                    ));
                }
            }
        }
        words
    }
}

/// Most given numbers in words.
const MOST_GIVEN: usize = 6;

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
        ProfileEnd::NotReached => {
            "its profile does not reach the level within the points of the search"
        }
    }
}
