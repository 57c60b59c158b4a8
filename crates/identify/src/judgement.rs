//! The judgement of an identification: whether its law may be used, and the reasons.

mod intervals;
mod premises;

use std::collections::BTreeMap;

use asperity_inference::{Agreement, ModelAssessment, Strain, StrainKind};
use serde::Serialize;

use crate::build::CONSTANT;
use crate::explanations::CONTRADICTED;
use crate::identification::Identification;
use crate::incomplete::IncompleteIdentification;
use crate::starts::{StartAgreement, starts_at_best};
use asperity_scenario::four_digits;

/// Use that a result allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Usability {
    /// The result may be used with its intervals.
    Yes,
    /// It may be used with regard to the reasons.
    WithCare,
    /// Values and intervals are void.
    No,
}

/// Subject of a reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ReasonKind {
    /// The identification was stopped.
    Incomplete,
    /// Chi-square, or observations that the model does not have.
    Misfit,
    /// There are no degrees of freedom, so that the agreement was not tested.
    Untested,
    /// A group of observations disagrees.
    GroupMisfit,
    /// A parameter is far from the mean of its prior.
    Prior,
    /// The data push a parameter against a bound.
    Bound,
    /// The fit has not converged.
    Fit,
    /// The starts of the fit disagree.
    Starts,
    /// The model's derivatives disagree with differences.
    Derivatives,
    /// The sampler has not converged.
    Sampler,
    /// An interval does not hold its best value.
    Interval,
    /// The data inform the law at no pressure.
    Uninformed,
    /// The data do not determine a combination of numbers of the law.
    Undetermined,
    /// A compared law explains the data better.
    OtherLaw,
    /// A constant stiffness is not rejected.
    ConstantStiffness,
    /// A support that is taken as rigid.
    RigidSupport,
    /// Errors of the integration in observed features.
    Numerics,
    /// The standard deviations of the data are far larger than the residuals.
    Spreads,
}

/// A reason of a judgement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reason {
    /// Subject.
    pub kind: ReasonKind,
    /// The use that it allows; a remark allows all.
    #[serde(rename = "use")]
    pub usability: Usability,
    /// The reason in a sentence.
    pub words: String,
    /// The numbers on which it rests.
    pub numbers: BTreeMap<&'static str, f64>,
}

/// The judgement of a result: the least use that its reasons allow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judgement {
    /// The use that the result allows.
    #[serde(rename = "use")]
    pub usability: Usability,
    /// The reasons, the gravest first.
    pub reasons: Vec<Reason>,
}

/// Distance of a parameter from the mean of its prior, in its standard deviations, from which care is
/// needed.
const STRAINED: f64 = 3.0;

/// Distance beyond a bound of the optimum without it, in standard deviations, from which the bound
/// matters, and from which it carries the result.
const PUSHED: f64 = 1.0;
const CARRIED: f64 = 3.0;

/// Relative difference of the derivatives from differences from which care is needed, and from which
/// they are wrong.
const DERIVATIVES_DIFFER: f64 = 0.1;
const DERIVATIVES_WRONG: f64 = 1.0;

/// Fewest effective draws, largest R-hat, and largest Pareto shape of weights that were cut, of a posterior that has not
/// quite converged: beyond it the weights have no mean.
const FEWEST_DRAWS: f64 = 100.0;
const LARGEST_R_HAT: f64 = 1.05;
const LARGEST_SHAPE: f64 = 1.0;

/// Least share of a number of the law in an undetermined combination.
const LEAST_SHARE: f64 = 0.1;

impl Reason {
    fn new(
        kind: ReasonKind,
        usability: Usability,
        words: String,
        numbers: impl IntoIterator<Item = (&'static str, f64)>,
    ) -> Self {
        Self { kind, usability, words, numbers: numbers.into_iter().collect() }
    }
}

impl Judgement {
    /// The judgement of these reasons.
    pub fn of(mut reasons: Vec<Reason>) -> Self {
        reasons.sort_by_key(|reason| std::cmp::Reverse(reason.usability));
        let usability = reasons.first().map_or(Usability::Yes, |reason| reason.usability);
        Self { usability, reasons }
    }

    /// True if values and intervals are void.
    pub fn is_void(&self) -> bool {
        self.usability == Usability::No
    }

    /// The judgement of `subject`, such as "law \"rough\"", in sentences: the use, then a reason each.
    pub fn words(&self, subject: &str) -> Vec<String> {
        let count =
            |usability| self.reasons.iter().filter(|reason| reason.usability == usability).count();
        let reasons = |count: usize| {
            if count == 1 { "1 reason".to_owned() } else { format!("{count} reasons") }
        };
        let first = match self.usability {
            Usability::Yes => format!("May be used: {subject}, within its intervals."),
            Usability::WithCare => {
                let count = reasons(count(Usability::WithCare));
                format!("May be used with care: {subject}, for {count}.")
            }
            Usability::No => format!(
                "Not to be used: {subject}, for {}. Its values and intervals are void.",
                reasons(count(Usability::No))
            ),
        };
        let word = |usability| match usability {
            Usability::Yes => "Remark",
            Usability::WithCare => "Care",
            Usability::No => "Void",
        };
        let each = self.reasons.iter();
        let each = each.map(|reason| format!("{}: {}", word(reason.usability), reason.words));
        std::iter::once(first).chain(each).collect()
    }
}

/// Reasons from the strains of priors and bounds of parameters with these labels.
fn of_strains<'a>(
    strains: &'a [Strain],
    labels: &'a [String],
) -> impl Iterator<Item = Reason> + 'a {
    let grade = |size: f64, care: f64, void: f64| {
        if size >= void {
            Some(Usability::No)
        } else if size >= care {
            Some(Usability::WithCare)
        } else {
            None
        }
    };
    strains.iter().filter_map(move |strain| {
        let label = &labels[strain.parameter];
        let deviations = strain.deviations;
        match strain.kind {
            StrainKind::Prior { mean, standard_deviation } => {
                let usability = grade(deviations.abs(), STRAINED, CONTRADICTED)?;
                let words = format!(
                    "{label} is {:.1} standard deviations {} the mean of its prior, {}.",
                    deviations.abs(),
                    if deviations > 0.0 { "above" } else { "below" },
                    four_digits(mean)
                );
                let numbers = [
                    ("deviations", deviations),
                    ("mean", mean),
                    ("standard_deviation", standard_deviation),
                ];
                Some(Reason::new(ReasonKind::Prior, usability, words, numbers))
            }
            StrainKind::Bound(bound) => {
                let usability = grade(deviations, PUSHED, CARRIED)?;
                let words = format!(
                    "{label} is on its bound {}, and the data alone would have it {deviations:.1} standard deviations beyond: the bound carries the result.",
                    four_digits(bound)
                );
                let numbers = [("deviations", deviations), ("bound", bound)];
                Some(Reason::new(ReasonKind::Bound, usability, words, numbers))
            }
        }
    })
}

impl Identification {
    /// May the result be used, and why not.
    ///
    /// | reason | care | void |
    /// |---|---|---|
    /// | p-value of chi-square | below 0.05 | below 0.001; a peak is missing |
    /// | degrees of freedom | none | |
    /// | p-value of one of `n` groups | below `0.05 / n` | below `0.001 / n` |
    /// | distance from the mean of a prior, in its standard deviations | 3 | 5 |
    /// | distance beyond a bound of the optimum without it | 1 | 3 |
    /// | derivatives off differences, over the largest | 0.1 | 1 |
    /// | sampler | R-hat above 1.02, less than a fifth of the draws effective, weights cut with a Pareto shape above 0.7 | R-hat above 1.05, fewer than 100 effective, weights cut with a Pareto shape above 1, draws that leave out a part of a profile |
    /// | best value, or another optimum as good, outside its interval: one with two ends, or the band where the data inform it | by half of its width at most, with draws that converged and data that are explained | any other |
    /// | starts | one alone reached the lowest cost | and the law does not agree |
    /// | rigid support that is not stated | a half-space of steel in its place moves the law by more than five half widths of its band | |
    /// | errors of the integration in a feature, in standard deviations (root mean square) | 1 | |
    /// | compared laws | a constant stiffness is not rejected | another is the best, and the law is rejected |
    pub fn judgement(&self) -> Judgement {
        let mut reasons = Vec::new();
        reasons.extend(self.stopped.then(|| {
            let words = "the comparison with other laws is missing: it was stopped.".to_owned();
            Reason::new(ReasonKind::Incomplete, Usability::WithCare, words, [])
        }));
        reasons.extend(self.is_fast.then(|| {
            let words = "profiles and the comparison with other laws were left out on request.";
            Reason::new(ReasonKind::Incomplete, Usability::WithCare, words.to_owned(), [])
        }));
        reasons.extend(self.of_misfit());
        reasons.extend(self.of_groups());
        reasons.extend(of_strains(&self.strains, &self.labels));
        reasons.extend(self.of_fit());
        reasons.extend(self.of_derivatives());
        reasons.extend(self.of_sampler());
        reasons.extend(self.of_intervals());
        reasons.extend(self.of_law());
        reasons.extend(self.of_comparison());
        reasons.extend(self.of_support());
        reasons.extend(self.of_numerics());
        reasons.extend(self.of_spreads());
        Judgement::of(reasons)
    }

    /// The result in words: its law, or its values where no parameter belongs to a law.
    pub(crate) fn subject(&self) -> String {
        if self.acts_on_law {
            format!("law \"{}\"", self.law.name)
        } else {
            "the values found".to_owned()
        }
    }

    fn of_misfit(&self) -> Option<Reason> {
        let usability = match self.agreement() {
            Agreement::Good if self.goodness.degrees_of_freedom == 0 => {
                let words =
                    "there are as many parameters as observations, so that nothing tests the model."
                        .to_owned();
                let numbers = [("degrees_of_freedom", 0.0)];
                let care = Usability::WithCare;
                return Some(Reason::new(ReasonKind::Untested, care, words, numbers));
            }
            Agreement::Good => return None,
            Agreement::Doubtful => Usability::WithCare,
            Agreement::None => Usability::No,
        };
        let goodness = &self.goodness;
        let p_value = goodness.p_value.unwrap_or(1.0);
        let missing = self.fit.missing.len();
        let mut words = format!(
            "chi-square is {:.1} for {} degrees of freedom (p {}): ",
            goodness.chi_square,
            goodness.degrees_of_freedom,
            if p_value > 1e-300 { format!("= {p_value:.1e}") } else { "< 1e-300".to_owned() }
        );
        words.push_str(match usability {
            Usability::No if p_value < Agreement::DOUBTFUL => {
                "model and data contradict each other."
            }
            Usability::No => "the model does not have all that was measured.",
            _ => "it is doubtful that model and data agree.",
        });
        if missing > 0 {
            let peaks = format!(" {missing} measured peaks are not in the model's responses.");
            words.push_str(&peaks);
        }
        let numbers = [
            ("chi_square", goodness.chi_square),
            ("degrees_of_freedom", goodness.degrees_of_freedom as f64),
            ("p_value", p_value),
            ("missing", missing as f64),
        ];
        Some(Reason::new(ReasonKind::Misfit, usability, words, numbers))
    }

    fn of_groups(&self) -> Vec<Reason> {
        let checks = self.checks();
        let count = checks.len().max(1) as f64;
        let reason = |check: &crate::checks::PredictiveCheck| {
            let usability = match Agreement::of(Some((count * check.p_value).min(1.0))) {
                Agreement::Good => return None,
                Agreement::Doubtful => Usability::WithCare,
                Agreement::None => Usability::No,
            };
            let words = format!(
                "the group \"{}\" disagrees: the posterior predictive p-value of its {} observations is {:.1e}.",
                check.group, check.observations, check.p_value
            );
            let numbers = [
                ("p_value", check.p_value),
                ("chi_square", check.chi_square),
                ("observations", check.observations as f64),
            ];
            Some(Reason::new(ReasonKind::GroupMisfit, usability, words, numbers))
        };
        checks.iter().filter_map(reason).collect()
    }

    fn of_fit(&self) -> Vec<Reason> {
        let mut found = Vec::new();
        if !self.fit.converged {
            let words = "the search for the best fit has not converged.".to_owned();
            let numbers = [("iterations", self.fit.iterations as f64)];
            found.push(Reason::new(ReasonKind::Fit, Usability::No, words, numbers));
        }
        let (all, reached) = (self.fit.starts.len(), starts_at_best(&self.fit));
        if StartAgreement::of(&self.fit) == StartAgreement::One {
            let good = self.explains();
            let usability = if good { Usability::WithCare } else { Usability::No };
            let words = format!(
                "one of {all} starts of the fit alone reached the lowest cost: a better optimum may exist; more starts would tell."
            );
            let numbers = [("starts", all as f64), ("reached", reached as f64)];
            found.push(Reason::new(ReasonKind::Starts, usability, words, numbers));
        }
        found.extend(self.of_second_optimum());
        found
    }

    fn of_derivatives(&self) -> Option<Reason> {
        let difference = self.linearisation.derivative_difference?;
        let usability = match difference {
            _ if difference < DERIVATIVES_DIFFER => return None,
            _ if difference < DERIVATIVES_WRONG => Usability::WithCare,
            // One that is no number, too.
            _ => Usability::No,
        };
        let words = format!(
            "the derivatives of the model and differences of its predictions are apart by {} of the largest: its predictions jump near the best fit, and covariance and intervals follow from them.",
            four_digits(difference)
        );
        Some(Reason::new(ReasonKind::Derivatives, usability, words, [("difference", difference)]))
    }

    fn of_sampler(&self) -> Option<Reason> {
        let found = &self.posterior.diagnostics;
        if self.sampler_has_converged() {
            return None;
        }
        let largest = found.r_hat.iter().copied().filter(|r| !r.is_nan()).fold(1.0, f64::max);
        let mixed = found.r_hat.iter().all(|r| *r <= LARGEST_R_HAT);
        let fair = found.effective_draws >= FEWEST_DRAWS
            && mixed
            && found.truncated.is_empty()
            && !self.has_heavy_weights(LARGEST_SHAPE);
        let usability = if fair { Usability::WithCare } else { Usability::No };
        let words = self.about_sampler();
        let numbers = [
            ("effective_draws", found.effective_draws),
            ("draws", self.posterior.draws.len() as f64),
            ("largest_r_hat", largest),
        ];
        Some(Reason::new(ReasonKind::Sampler, usability, words, numbers))
    }

    fn of_law(&self) -> Vec<Reason> {
        let mut found = Vec::new();
        if self.acts_on_law && self.law.informed_range().is_none() {
            let words = format!(
                "the data inform the stiffness of law \"{}\" at no pressure.",
                self.law.name
            );
            found.push(Reason::new(ReasonKind::Uninformed, Usability::No, words, []));
        }
        for combination in &self.identifiability.undetermined {
            let share = |(name, weight): &(String, f64)| {
                let place = self.names.iter().position(|known| known == name);
                let of_law = place.is_some_and(|place| self.of_law[place] && !self.latent[place]);
                if of_law { weight * weight } else { 0.0 }
            };
            let share: f64 = combination.weights.iter().map(share).sum();
            if share < LEAST_SHARE {
                continue;
            }
            let named =
                combination.weights.iter().filter(|(_, weight)| weight * weight >= LEAST_SHARE);
            let named: Vec<&str> = named.map(|(name, _)| self.label(name)).collect();
            let words = format!(
                "the data do not determine {}: {:.0} % of the uncertainty before the measurement remains{}. Only what the band of the law shows is known.",
                named.join(" and "),
                100.0 * combination.remaining,
                if named.len() > 1 { " along one combination of them" } else { "" }
            );
            let numbers = [("remaining", combination.remaining), ("share_of_law", share)];
            found.push(Reason::new(ReasonKind::Undetermined, Usability::WithCare, words, numbers));
        }
        found
    }

    fn of_comparison(&self) -> Option<Reason> {
        let comparison = self.comparison.as_ref()?;
        let own = comparison.candidates.first()?;
        let best = &comparison.candidates[comparison.best];
        if own.assessment.is_rejected() {
            let words = format!(
                "the law is rejected in favour of {}, whose chi-square is {:.1} against {:.1}.",
                best.name, best.goodness.chi_square, own.goodness.chi_square
            );
            let numbers = [
                ("chi_square", own.goodness.chi_square),
                ("chi_square_of_best", best.goodness.chi_square),
            ];
            return Some(Reason::new(ReasonKind::OtherLaw, Usability::No, words, numbers));
        }
        let constant = comparison.candidates.iter().find(|candidate| candidate.name == CONSTANT)?;
        if matches!(constant.assessment, ModelAssessment::Best | ModelAssessment::Undecided) {
            let words = format!(
                "a constant stiffness is not rejected (chi-square {:.1} against {:.1}): the data do not show that the stiffness depends on pressure.",
                constant.goodness.chi_square, own.goodness.chi_square
            );
            let numbers = [
                ("chi_square", own.goodness.chi_square),
                ("chi_square_of_constant", constant.goodness.chi_square),
            ];
            let care = Usability::WithCare;
            return Some(Reason::new(ReasonKind::ConstantStiffness, care, words, numbers));
        }
        None
    }
}

impl IncompleteIdentification {
    /// Its result is void: the reasons that are known so far.
    pub fn judgement(&self) -> Judgement {
        let words = format!("the identification was stopped in the {}.", self.stage.name());
        let mut reasons = vec![Reason::new(ReasonKind::Incomplete, Usability::No, words, [])];
        reasons.extend(of_strains(&self.strains, &self.labels));
        let bound = (0..self.labels.len()).filter(|&parameter| self.fit.at_bound[parameter]);
        reasons.extend(bound.map(|parameter| {
            let value = self.fit.point[parameter];
            let label = &self.labels[parameter];
            let words = format!("{label} is on its bound {}.", four_digits(value));
            Reason::new(ReasonKind::Bound, Usability::WithCare, words, [("bound", value)])
        }));
        Judgement::of(reasons)
    }
}
