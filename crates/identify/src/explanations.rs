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
use asperity_scenario::{JsonPointer, four_digits};
use serde::Serialize;
use serde_json::{Value, json};
use std::f64::consts::PI;

use crate::error::IdentificationError;
use crate::given_numbers::GivenNumbers;
use crate::identification_problem::IdentificationProblem;
use crate::observed_quantity::ObservedQuantity;
use crate::problem::{CandidateSpec, Changes, ParameterSpec};
use crate::problem_parameters::is_within;
use crate::scenario_model::ScenarioModel;

/// Distance of a parameter from the mean of its prior, in its standard deviations, from which prior and data
/// contradict each other.
pub(super) const CONTRADICTED: f64 = 5.0;

/// Steps of a short fit.
const ITERATIONS: usize = 8;

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
const TRIED_RATIO: f64 = 2e-3;

/// Factors of the response that faults of sensors, units and polarity bring.
const FACTORS: [(f64, &str); 6] = [
    (-1.0, "the response, or the force, has the other polarity"),
    (1e3, "the response is too large by a factor of 1000"),
    (1e-3, "the response is too small by a factor of 1000"),
    (9.81, "the response is too large by a factor of 9.81: m/s^2 taken for g"),
    (1.0 / 9.81, "the response is too small by a factor of 9.81: g taken for m/s^2"),
    (1e-6, "the response is too small by a factor of 1e6"),
];

/// Ratio of the distances of measured and predicted receptances by which a factor has to be nearer.
const NEARER: f64 = 0.5;

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
        scored.extend(self.of_losses()?);
        let excess = self.goodness.chi_square - self.goodness.degrees_of_freedom as f64;
        let part = |one: &Scored| (self.goodness.chi_square - one.expected) / excess.max(1.0);
        scored.retain(|one| part(one) >= LEAST_PART);
        scored.sort_by(|a, b| a.expected.total_cmp(&b.expected));
        scored.truncate(MOST_LISTED);
        let mut found: Vec<Explanation> =
            self.of_factor(progress).map(|one| vec![one]).unwrap_or_default();
        // With the wrong factor nothing else is worth a fit.
        let mut fits = if found.is_empty() { MOST_FITS } else { 0 };
        for one in scored {
            let mut chi_square = None;
            if fits > 0 && part(&one) >= FITTED_PART && !self.problem.work.is_stopped() {
                fits -= 1;
                chi_square = self.fitted(&one.candidate, progress);
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

    /// Losses that the scenario does not have: contacts that dissipate, and friction of a guide.
    fn of_losses(&self) -> Result<Vec<Scored>, IdentificationError> {
        let scenario = &self.forward.scenario;
        let list = |section: &str| scenario[section].as_array().cloned().unwrap_or_default();
        let natural = self.forward.natural_frequency(&self.best.point).unwrap_or(1e3);
        let time = TRIED_RATIO / (PI * natural);
        let name = |one: &Value, place: usize| {
            one["name"].as_str().map_or_else(|| place.to_string(), str::to_owned)
        };
        let mut tried = Vec::new();
        for (place, interface) in list("interfaces").iter().enumerate() {
            if interface.get("damping").is_none_or(Value::is_null) {
                let at = JsonPointer::root().child("interfaces").child(place.to_string());
                let damping = json!({"kind": "kelvin_voigt", "time_s": time});
                let cause = format!("contact damping of \"{}\"", name(interface, place));
                tried.push((cause, at.child("damping"), "time_s", damping, time));
            }
        }
        for (place, body) in list("bodies").iter().enumerate().take(1) {
            if body.get("friction").is_none_or(Value::is_null) {
                let at = JsonPointer::root().child("bodies").child(place.to_string());
                let friction = json!({"stiffness_n_per_m": STUCK, "coefficient": COEFFICIENT});
                let cause = format!("friction of the guide of \"{}\"", name(body, place));
                tried.push((cause, at.child("friction"), "coefficient", friction, COEFFICIENT));
            }
        }
        let Some(base) = predicted(self.forward, &self.best.point) else { return Ok(Vec::new()) };
        let mut scored = Vec::new();
        for (cause, at, key, value, size) in tried {
            let pointer = at.to_string();
            let with = self.forward.with_set(&pointer, &value);
            let Some(with) = predicted(&with, &self.best.point) else { continue };
            let change = change(&base, &with, self.observations);
            let (step, expected) = self.score(&change, [0.0, LARGEST_LOSS])?;
            let found = (size * step).max(1e-2 * size);
            let mut set = Changes::new();
            let mut value = value.clone();
            value[key] = json!(found);
            set.insert(pointer, value);
            let unknown = scalar(at.child(key).to_string(), [1e-3 * found, 1e3 * found], found);
            let candidate = CandidateSpec { name: cause.clone(), set, unknowns: vec![unknown] };
            let cause = format!("{cause} ({key} near {})", four_digits(found));
            scored.push(Scored { cause, expected, candidate });
        }
        Ok(scored)
    }

    /// Chi-square of a short fit of a candidate from the best fit; `None` if it cannot be set up or run.
    fn fitted(&self, candidate: &CandidateSpec, progress: &ProgressCallback<'_>) -> Option<f64> {
        let mut trial = self.problem.clone();
        trial.scenario =
            self.problem.scenario_at(&self.problem.spec.unknowns, &self.best.point).ok()?;
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

    /// A factor of the response with which the start of the parameters is much nearer to the data.
    fn of_factor(&self, progress: &ProgressCallback<'_>) -> Option<Explanation> {
        let forward = self.forward;
        let start = forward.start();
        let predicted = predicted(forward, &start)?;
        let is_receptance = |quantity: &ObservedQuantity| quantity.is_receptance(&forward.columns);
        let of: Vec<usize> =
            (0..predicted.len()).filter(|&i| is_receptance(&forward.quantities[i])).collect();
        let distance = |factor: f64| {
            let pairs = of
                .iter()
                .filter_map(|&i| Some((forward.observations[i].value / factor, predicted[i]?)));
            // Between 0 for equal and 2 for opposite ones, whatever their sizes.
            let parts = pairs.map(|(a, b)| ((a - b).powi(2), a * a + b * b));
            let (apart, size) = parts.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
            if size > 0.0 { apart / size } else { f64::INFINITY }
        };
        let nearest = FACTORS.iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)))?;
        if of.is_empty() || distance(nearest.0) > NEARER * distance(1.0) {
            return None;
        }
        let mut trial = forward.with_scaled("", 1.0);
        for &i in &of {
            trial.observations[i].value /= nearest.0;
            trial.observations[i].standard_deviation /= nearest.0.abs();
        }
        let chi_square = self.short_fit(&trial, progress)?;
        let cause = nearest.1.to_owned();
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

fn predicted(forward: &ScenarioModel, point: &[f64]) -> Option<Predictions> {
    forward.predict(&[point.to_vec()]).pop()?.ok()
}

/// Change of predictions in standard deviations of the observations; zero where one is missing.
fn change(base: &Predictions, with: &Predictions, observations: &[Observation]) -> Vec<f64> {
    let one = |(i, observation): (usize, &Observation)| {
        let change = with.get(i).copied().flatten()? - base.get(i).copied().flatten()?;
        Some(change / observation.standard_deviation)
    };
    observations.iter().enumerate().map(|pair| one(pair).unwrap_or(0.0)).collect()
}
