//! Changes of the model that would explain the data better, ranked by their score and tried in short fits.
//!
//! A number t that the model does not have, or has as given, lowers chi-square by about
//!
//! ```text
//! u^2 / I,    u = d^T W r,    I = d^T W d - d^T W J C J^T W d,
//! ```
//!
//! with its derivative d of the standardised residuals r: the score test (C. R. Rao, Proc. Camb. Phil. Soc.
//! 44, 50, 1948). One or two evaluations of the model give d; the best are fitted.

use asperity_inference::{
    Agreement, Covariance, FitOptions, FitSolution, ForwardModel, GoodnessOfFit, Linearisation,
    Observation, Predictions, ProgressCallback, Strain, fit_with_progress,
};
use asperity_scenario::{JsonPointer, four_digits, has_matrices};
use serde::Serialize;
use serde_json::{Value, json};
use std::f64::consts::PI;

use crate::error::IdentificationError;
use crate::given_numbers::GivenNumbers;
use crate::identification_problem::IdentificationProblem;
use crate::problem::{CandidateSpec, Changes, ParameterSpec};
use crate::problem_parameters::is_within;
use crate::response_factor::{ResponseFactor, predicted};
use crate::scenario_model::ScenarioModel;

/// Distance of a parameter from the mean of its prior, in its standard deviations, from which prior and data
/// contradict each other.
pub(super) const CONTRADICTED: f64 = 5.0;

/// Steps of a short fit.
const ITERATIONS: usize = 12;

/// Most short fits.
const MOST_FITS: usize = 3;

/// Most explanations in the list.
const MOST_LISTED: usize = 6;

/// Least part of the excess of chi-square that an explanation takes away.
const LEAST_PART: f64 = 0.1;

/// Least part for a short fit.
const FITTED_PART: f64 = 0.3;

/// Largest change of a given number, as a logarithm.
const LARGEST_CHANGE: f64 = 0.7;

/// Damping ratio at the natural frequency of the first loss that is tried.
const TRIED_RATIO: f64 = 1e-3;

/// Least and largest part of the damping of the bodies that a loss takes over where its fit starts.
const TAKEN: [f64; 2] = [0.3, 0.8];

/// A change of the model that would explain the data better.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// The change in words.
    pub cause: String,
    /// Chi-square that the linearised model expects with it; none for a factor of the data.
    pub expected_chi_square: Option<f64>,
    /// Chi-square of a short fit with it, where it was tried.
    pub chi_square: Option<f64>,
}

impl Explanation {
    /// Chi-square with it: of the fit, or else the expected one.
    fn least(&self) -> f64 {
        self.chi_square.or(self.expected_chi_square).unwrap_or(f64::INFINITY)
    }
}

/// A loss that the scenario does not have, at one place or several of one kind.
struct Loss {
    cause: String,
    places: Vec<JsonPointer>,
    /// The loss of the size that is tried first, and the key of that size.
    value: Value,
    key: &'static str,
    size: f64,
}

impl Loss {
    fn pointer(&self, place: usize) -> String {
        self.places[place].child(self.key).to_string()
    }

    /// Places and values of the loss at a part of its size.
    fn values(&self, part: f64) -> impl Iterator<Item = (String, Value)> {
        let mut value = self.value.clone();
        value[self.key] = json!(part * self.size);
        self.places.iter().map(move |place| (place.to_string(), value.clone()))
    }
}

/// The losses that a scenario does not have: damping of the contacts of each law, friction of the upper body.
fn losses(scenario: &Value, natural: Option<f64>) -> Vec<Loss> {
    if has_matrices(scenario) {
        return Vec::new();
    }
    let list = |section: &str| scenario[section].as_array().cloned().unwrap_or_default();
    let name = |one: &Value, place: usize| {
        one["name"].as_str().map_or_else(|| place.to_string(), str::to_owned)
    };
    let time = TRIED_RATIO / (PI * natural.unwrap_or(1e3));
    let mut found: Vec<(Value, Loss)> = Vec::new();
    for (place, interface) in list("interfaces").iter().enumerate() {
        if interface.get("damping").is_some_and(|damping| !damping.is_null()) {
            continue;
        }
        let at = JsonPointer::root().child("interfaces").child(place.to_string()).child("damping");
        let named = format!("\"{}\"", name(interface, place));
        let law = interface["law"].clone();
        // Contacts of one law dissipate alike.
        if let Some((_, loss)) =
            found.iter_mut().find(|(known, _)| known.is_string() && *known == law)
        {
            loss.places.push(at);
            loss.cause = format!("{} and {named}", loss.cause);
        } else {
            let value = json!({"kind": "kelvin_voigt", "time_s": time});
            let cause = format!("contact damping of {named}");
            found.push((law, Loss { cause, places: vec![at], value, key: "time_s", size: time }));
        }
    }
    let mut found: Vec<Loss> = found.into_iter().map(|(_, loss)| loss).collect();
    let upper = list("bodies").into_iter().next();
    if let Some(body) = upper.filter(|body| body.get("friction").is_none_or(Value::is_null)) {
        let at = JsonPointer::root().child("bodies").child("0").child("friction");
        found.push(Loss {
            cause: format!("friction of the guide of \"{}\"", name(&body, 0)),
            places: vec![at],
            value: json!({"stiffness_n_per_m": STUCK, "coefficient": COEFFICIENT}),
            key: "coefficient",
            size: COEFFICIENT,
        });
    }
    found
}

/// A change with its score.
struct Scored {
    cause: String,
    expected: f64,
    candidate: CandidateSpec,
}

/// The fit that is to be explained.
pub(super) struct Unexplained<'a> {
    pub(super) problem: &'a IdentificationProblem,
    pub(super) forward: &'a ScenarioModel,
    pub(super) linear: (&'a Linearisation, &'a Covariance),
    pub(super) given: &'a GivenNumbers,
    pub(super) observations: &'a [Observation],
    /// The best fit of these observations.
    pub(super) best: &'a FitSolution,
    /// Factor of the standard deviations of the observations over those given.
    pub(super) factor: f64,
    /// With the standard deviations as given.
    pub(super) goodness: &'a GoodnessOfFit,
}

impl Unexplained<'_> {
    /// Explanations, the best first; none that takes away less than a tenth of the excess of chi-square,
    /// and none where chi-square and these strains are fair.
    pub(super) fn explained(
        &self,
        strains: &[Strain],
        progress: &ProgressCallback<'_>,
    ) -> Result<Vec<Explanation>, IdentificationError> {
        let contradicted = strains.iter().any(|strain| strain.deviations.abs() >= CONTRADICTED);
        let is_odd = contradicted || self.goodness.agreement() == Agreement::None;
        if !is_odd || self.problem.is_fast || self.problem.work.is_stopped() {
            return Ok(Vec::new());
        }
        let mut scored = self.of_given_numbers()?;
        let excess = self.goodness.chi_square - self.goodness.degrees_of_freedom as f64;
        let part = |one: &Scored| (self.goodness.chi_square - one.expected) / excess.max(1.0);
        scored.retain(|one| part(one) >= LEAST_PART);
        scored.sort_by(|a, b| a.expected.total_cmp(&b.expected));
        scored.truncate(MOST_LISTED);
        let mut found: Vec<Explanation> =
            self.of_factor(progress).map(|one| vec![one]).unwrap_or_default();
        // With the wrong factor nothing else is worth a fit.
        let mut fits = if found.is_empty() { MOST_FITS } else { 0 };
        if fits > 0 {
            let least = self.goodness.chi_square - LEAST_PART * excess.max(1.0);
            let tried = self.of_losses(progress)?.into_iter().chain(self.of_opening_hits(progress));
            found.extend(tried.filter(|one| one.least() <= least));
        }
        for one in scored {
            let mut chi_square = None;
            if fits > 0 && part(&one) >= FITTED_PART && !self.problem.work.is_stopped() {
                fits -= 1;
                chi_square = self.fitted((&one.candidate, &self.best.point), progress);
            }
            let expected_chi_square = Some(one.expected);
            found.push(Explanation { cause: one.cause, expected_chi_square, chi_square });
        }
        // A fit counts more than an expectation.
        let rank = |one: &Explanation| (one.chi_square.is_none(), one.least());
        found.sort_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        Ok(found)
    }

    /// Change of a number in units of `change`, from `least` to `greatest`, and chi-square with it.
    fn score(
        &self,
        change: &[f64],
        [least, greatest]: [f64; 2],
    ) -> Result<(f64, f64), IdentificationError> {
        let shift = self.linear.1.shift(self.linear.0, change)?;
        let (mut force, mut information) = (0.0, 0.0);
        for ((row, weight), (d, r)) in
            self.linear.0.weighted().zip(change.iter().zip(&self.best.residuals))
        {
            let moved: f64 = row.iter().zip(&shift).map(|(entry, x)| entry * x).sum();
            force += weight * d * r;
            information += weight * d * (d + moved);
        }
        if information <= 0.0 {
            return Ok((0.0, self.goodness.chi_square));
        }
        let step = (-force / information).clamp(least, greatest);
        let fall = -(2.0 * force * step + information * step * step) * self.factor.powi(2);
        Ok((step, (self.goodness.chi_square - fall).max(0.0)))
    }

    /// Given numbers with other values.
    fn of_given_numbers(&self) -> Result<Vec<Scored>, IdentificationError> {
        let mut scored = Vec::new();
        // The form of the law itself is the business of a free law.
        let law = JsonPointer::root().child("laws").child(self.problem.law()?).to_string();
        for (number, change) in &self.given.columns {
            if is_within(&number.pointer, &law) {
                continue;
            }
            let limits = [-LARGEST_CHANGE, LARGEST_CHANGE];
            let (step, expected) = self.score(change, limits)?;
            let (value, pointer) = (number.value, number.pointer.clone());
            let found = value * step.exp();
            let mut bounds = [0.25 * value, 4.0 * value];
            bounds.sort_by(f64::total_cmp);
            let cause = format!(
                "{} near {} instead of {}",
                number.label,
                four_digits(found),
                four_digits(value)
            );
            let candidate = CandidateSpec {
                name: cause.clone(),
                set: Changes::new(),
                unknowns: vec![scalar(pointer, bounds, found)],
            };
            scored.push(Scored { cause, expected, candidate });
        }
        Ok(scored)
    }

    /// Losses that the scenario does not have: of the contacts of each law, and friction of a guide. Each is
    /// fitted: far from the best fit, where a loss takes the place of the damping of the bodies, scores do not hold.
    fn of_losses(
        &self,
        progress: &ProgressCallback<'_>,
    ) -> Result<Vec<Explanation>, IdentificationError> {
        let Some(base) = predicted(self.forward, &self.best.point) else { return Ok(Vec::new()) };
        let mut found = Vec::new();
        for loss in losses(&self.forward.scenario, self.forward.natural_frequency(&self.best.point))
        {
            if self.problem.work.is_stopped() {
                break;
            }
            // Differences of second order at an end of the range.
            let [Some(whole), Some(half)] = [1.0, 0.5].map(|part| {
                let with =
                    loss.values(part).fold(self.forward.with_scaled("", 1.0), |with, one| {
                        with.with_set(&one.0, &one.1)
                    });
                predicted(&with, &self.best.point)
            }) else {
                continue;
            };
            let [whole, half] = [whole, half].map(|with| change(&base, &with, self.observations));
            let slope: Vec<f64> = half.iter().zip(&whole).map(|(h, w)| 4.0 * h - w).collect();
            let (step, expected) = self.score(&slope, [0.0, LARGEST_LOSS])?;
            let (step, start) = self.in_place_of_body_damping(&slope, step)?;
            let size = loss.size * step;
            let mut unknown = scalar(loss.pointer(0), [1e-3 * size, 1e3 * size], size);
            if let ParameterSpec::Scalar { also, .. } = &mut unknown {
                also.extend((1..loss.places.len()).map(|place| loss.pointer(place)));
            }
            let candidate = CandidateSpec {
                name: loss.cause.clone(),
                set: loss.values(step).collect(),
                unknowns: vec![unknown],
            };
            let chi_square = self.fitted((&candidate, &start), progress);
            let cause = loss.cause.clone();
            found.push(Explanation { cause, expected_chi_square: Some(expected), chi_square });
        }
        Ok(found)
    }

    /// The size of a loss in units of `slope`, and the parameters from which it is fitted: it takes the place of
    /// the part of the identified damping of the bodies that `step` is worth, within limits.
    fn in_place_of_body_damping(
        &self,
        slope: &[f64],
        step: f64,
    ) -> Result<(f64, Vec<f64>), IdentificationError> {
        let mut point = self.best.point.clone();
        let shift = self.linear.1.shift(self.linear.0, slope)?;
        let parameters = self.forward.parameters();
        let fall = self.forward.parameters.body_damping().map(|body| {
            let parameter = &parameters[body];
            (body, -shift[body] * parameter.d_value_d_working(point[body]) / point[body])
        });
        let Some((body, fall)) = fall.filter(|(_, fall)| *fall > 0.0) else {
            return Ok((step.max(1e-2), point));
        };
        // The damping of the bodies falls in proportion to the step.
        let part = (step * fall).clamp(TAKEN[0], TAKEN[1]);
        let step = part / fall;
        for (j, parameter) in parameters.iter().enumerate() {
            let moved = shift[j] * step * parameter.d_value_d_working(point[j]);
            let [low, high] = parameter.bounds();
            let value = if j == body { point[j] * (1.0 - part) } else { point[j] + moved };
            point[j] = value.clamp(low, high);
        }
        Ok((step, point))
    }

    /// Chi-square of a short fit of a candidate from `start`; `None` if it cannot be set up or run.
    fn fitted(
        &self,
        (candidate, start): (&CandidateSpec, &[f64]),
        progress: &ProgressCallback<'_>,
    ) -> Option<f64> {
        let mut trial = self.problem.clone();
        trial.scenario = self.problem.scenario_at(&self.problem.spec.unknowns, start).ok()?;
        for unknown in &mut trial.spec.unknowns {
            if let ParameterSpec::Scalar { start, .. } = unknown {
                *start = None;
            }
        }
        let mut forward = trial.candidate(candidate).ok()?.forward;
        forward.hold_as(self.forward);
        self.short_fit(&forward, progress)
    }

    fn short_fit(&self, forward: &ScenarioModel, progress: &ProgressCallback<'_>) -> Option<f64> {
        let options = FitOptions { max_iterations: ITERATIONS, ..self.problem.fit_options(1) };
        let found = fit_with_progress(forward, &options, progress).ok()?;
        if self.problem.work.is_stopped() {
            return None;
        }
        Some(found.chi_square + found.prior_chi_square)
    }

    /// The hits in which contact opens at the best fit, left out: how the rig moves while a contact is open (it tilts, its
    /// guide takes part) the model may not know, though it fits the others. Chi-square has the expected part of the
    /// observations left out, one each.
    fn of_opening_hits(&self, progress: &ProgressCallback<'_>) -> Option<Explanation> {
        if self.problem.work.is_stopped() {
            return None;
        }
        let forward = self.forward;
        let outcomes = forward.outcomes(std::slice::from_ref(&self.best.point)).pop()?.ok()?;
        let is_open = |pressures: &[[f64; 2]]| pressures.iter().any(|[lowest, _]| *lowest <= 0.0);
        let opens: Vec<bool> = outcomes.hits.iter().map(|hit| is_open(&hit.pressures)).collect();
        let mut trial = forward.with_scaled("", 1.0);
        let (quantities, observations) = (trial.quantities, trial.observations);
        let kept = quantities.into_iter().zip(observations);
        let kept = kept.filter(|(quantity, _)| !quantity.is_of_hit(|hit| opens[hit]));
        (trial.quantities, trial.observations) = kept.unzip();
        let left_out = forward.observations.len() - trial.observations.len();
        if left_out == 0 || trial.observations.len() <= forward.parameters().len() {
            return None;
        }
        let chi_square = self.short_fit(&trial, progress)? + left_out as f64;
        let count = opens.iter().filter(|opens| **opens).count();
        let cause = format!(
            "contact is without pressure at times in {count} of {} hits, and the model fits the others alone",
            opens.len()
        );
        Some(Explanation { cause, expected_chi_square: None, chi_square: Some(chi_square) })
    }

    /// A factor of the response that explains the data better.
    fn of_factor(&self, progress: &ProgressCallback<'_>) -> Option<Explanation> {
        let factor = ResponseFactor::of(self.forward)?;
        let chi_square = self.short_fit(&factor.without(self.forward), progress)?;
        let cause = factor.cause.to_owned();
        (chi_square < self.goodness.chi_square).then_some(Explanation {
            cause,
            expected_chi_square: None,
            chi_square: Some(chi_square),
        })
    }
}

/// Stuck stiffness \[N/m\] and coefficient of the friction that is tried.
const STUCK: f64 = 2e8;
const COEFFICIENT: f64 = 1e-3;

/// Largest loss over the tried one.
const LARGEST_LOSS: f64 = 50.0;

/// A number of the scenario as an unknown.
fn scalar(pointer: String, bounds: [f64; 2], start: f64) -> ParameterSpec {
    let start = Some(start.clamp(bounds[0], bounds[1]));
    let (also, name, scale, prior) = (Vec::new(), None, None, None);
    ParameterSpec::Scalar { pointer, also, name, bounds, start, scale, prior }
}

/// Change of predictions in standard deviations of the observations; zero where one is missing.
fn change(base: &Predictions, with: &Predictions, observations: &[Observation]) -> Vec<f64> {
    let one = |(i, observation): (usize, &Observation)| {
        let change = with.get(i).copied().flatten()? - base.get(i).copied().flatten()?;
        Some(change / observation.standard_deviation)
    };
    observations.iter().enumerate().map(|pair| one(pair).unwrap_or(0.0)).collect()
}
