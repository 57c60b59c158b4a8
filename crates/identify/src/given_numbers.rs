//! Numbers of the scenario that an identification takes as given, and their effect on the law.
//!
//! The optimum x of a fit with standardised Jacobian J and covariance C moves with a given number g by
//!
//! ```text
//! dx = -C J^T W dr,    d ln K / d ln g = (d ln K / dx) dx / d ln g,
//! ```
//!
//! where `dr` is the change of the standardised residuals at fixed x.

use asperity_inference::{Covariance, ForwardModel, Linearisation, Predictions, normal_quantile};
use asperity_scenario::JsonPointer;
use asperity_simulation::parameter::is_of_reduction;
use serde::Serialize;
use serde_json::Value;
use std::f64::consts::PI;

use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::law_band::{LawBand, StiffnessEstimate, StiffnessOrigin};
use crate::problem::GivenSpec;
use crate::problem_parameters::is_within;
use crate::scenario_model::ScenarioModel;

/// Relative step to either side of a given number.
const STEP: f64 = 1e-2;

/// Largest relative standard deviation by the digits of a number: fewer digits do not mean that less is
/// known.
const MOST_BY_DIGITS: f64 = 5e-3;

/// Least sensitivity of ln K to the logarithm of a number that the law depends on.
const LEAST_SENSITIVITY: f64 = 0.02;

/// Most numbers of a scenario that are varied.
const MOST_NUMBERS: usize = 80;

/// Sections of a scenario whose numbers describe the rig, but for the laws.
const SECTIONS: [&str; 9] = [
    "gravity_m_per_s2",
    "bodies",
    "loads",
    "springs",
    "interfaces",
    "laws",
    "support",
    "damping",
    "excitation",
];

/// Pointer to the support, which is rigid for certain where its tolerance is zero.
const SUPPORT: &str = "/support";

/// A number of the scenario that the identified law depends on and that no parameter changes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GivenNumber {
    /// Its JSON Pointer.
    pub pointer: String,
    /// Its name in words, such as `mass_kg of "block"`.
    pub label: String,
    /// Its value in the scenario.
    pub value: f64,
    /// Standard deviation over the value: of the problem, or by its digits.
    pub relative: f64,
    /// True if the problem gives that tolerance.
    pub is_stated: bool,
    /// Pressure \[Pa\] of the sensitivity.
    pub pressure_pa: f64,
    /// d ln K / d ln g: the change of the stiffness in per cent for one per cent of the number.
    pub sensitivity: f64,
}

/// The given numbers, and the uncertainty that they bring to a law.
#[derive(Debug, Default)]
pub(super) struct GivenNumbers {
    /// Those that the law depends on, the most important first.
    pub(super) list: Vec<GivenNumber>,
    /// All that were varied, with the changes of the standardised residuals for each over its logarithm.
    pub(super) columns: Vec<(GivenNumber, Vec<f64>)>,
    /// Standard deviation of ln K at each pressure of the band.
    pub(super) deviation: Vec<f64>,
    /// Change of ln K for a compliance below the stack \[N/m\], and its pressure \[Pa\], under a rigid support.
    in_series: Option<(f64, f64)>,
    /// True if the problem states that the support is rigid.
    rigid_is_stated: bool,
}

/// The assumption of a rigid support.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RigidSupport {
    /// Stiffness \[N/m\] of a support that would move ln K by half of the width of its band.
    pub stiffness_n_per_m: f64,
    /// Pressure \[Pa\] at which it would.
    pub pressure_pa: f64,
    /// Stiffness \[N/m\] of a half-space of steel under the lowest contact: `2 E a / (1 - nu^2)` with the radius a
    /// of a circle of its area. Source: K. L. Johnson, *Contact Mechanics*, 1985, section 3.4.
    pub half_space_n_per_m: f64,
    /// Change of ln K with a support of that stiffness.
    pub half_space_shift: f64,
    /// True if the problem states that the support is rigid: a tolerance of zero of `/support`.
    pub is_stated: bool,
}

impl GivenNumbers {
    /// The given numbers of a problem at its best fit.
    pub(super) fn of(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        (linearisation, covariance): (&Linearisation, &Covariance),
        (law, observations): (&LawBand, &[asperity_inference::Observation]),
        best: &[f64],
    ) -> Result<Self, IdentificationError> {
        let numbers = given(forward);
        let is_rigid = |spec: &GivenSpec| spec.pointer == SUPPORT && spec.relative == 0.0;
        for spec in problem.spec.given.iter().filter(|spec| !is_rigid(spec)) {
            if !numbers.iter().any(|(pointer, _)| *pointer == spec.pointer) {
                let known: Vec<&str> =
                    numbers.iter().map(|(pointer, _)| pointer.as_str()).collect();
                let (pointer, known) = (spec.pointer.clone(), known.join(", "));
                return Err(IdentificationError::NotGiven { pointer, known });
            }
        }
        let gradients = forward.log_stiffness_gradients(&law.name, &law.pressure, best)?;
        let place = reference(law);
        let deviation = vec![0.0; law.pressure.len()];
        let rigid_is_stated = problem.spec.given.iter().any(is_rigid);
        let mut found = Self { deviation, rigid_is_stated, ..Self::default() };
        for (pointer, value) in numbers.into_iter().take(MOST_NUMBERS) {
            let [below, above] = [-STEP, STEP].map(|step| {
                let moved = forward.with_scaled(&pointer, 1.0 + step);
                moved.predict(&[best.to_vec()]).pop().and_then(Result::ok)
            });
            let (Some(below), Some(above)) = (below, above) else { continue };
            let change = |i: usize, ends: [&Predictions; 2]| {
                let [low, high] = ends.map(|end| end.get(i).copied().flatten());
                let change = high? - low?;
                Some(change / (2.0 * STEP * observations[i].standard_deviation))
            };
            let change: Vec<f64> = (0..observations.len())
                .map(|i| change(i, [&below, &above]).unwrap_or(0.0))
                .collect();
            let moved = covariance.shift(linearisation, &change)?;
            let slope = |gradient: &Vec<f64>| -> f64 {
                let terms = gradient.iter().zip(&moved);
                terms.filter(|(g, _)| g.is_finite()).map(|(g, x)| g * x).sum()
            };
            let slopes: Vec<f64> = gradients.iter().map(slope).collect();
            let stated = problem.spec.given.iter().find(|spec| spec.pointer == pointer);
            let relative = stated.map_or_else(|| by_digits(value), |spec| spec.relative);
            for (sum, slope) in found.deviation.iter_mut().zip(&slopes) {
                *sum = sum.hypot(slope * relative);
            }
            let number = GivenNumber {
                label: label(&forward.scenario, &pointer),
                pointer,
                value,
                relative,
                is_stated: stated.is_some(),
                pressure_pa: law.pressure[place],
                sensitivity: slopes[place],
            };
            if number.sensitivity.abs() >= LEAST_SENSITIVITY {
                found.list.push(number.clone());
            }
            found.in_series =
                found.in_series.or_else(|| series_compliance(&forward.scenario, &number));
            found.columns.push((number, change));
        }
        found.list.sort_by(|a, b| b.sensitivity.abs().total_cmp(&a.sensitivity.abs()));
        Ok(found)
    }
}

impl GivenNumbers {
    /// The least stiffness of a support that may be taken as rigid for this law and its band.
    pub(super) fn rigid_support(&self, scenario: &Value, law: &LawBand) -> Option<RigidSupport> {
        let (slope, pressure_pa) = self.in_series?;
        let place = law.pressure.iter().position(|p| *p == pressure_pa)?;
        let half_width = 0.5 * (law.upper[place] / law.lower[place]).ln();
        let area = scenario["interfaces"].as_array()?.last()?["area_m2"].as_f64()?;
        let half_space_n_per_m = 2.0 * STEEL / (1.0 - POISSON.powi(2)) * (area / PI).sqrt();
        let stiffness_n_per_m = slope.abs() / half_width;
        stiffness_n_per_m.is_finite().then_some(RigidSupport {
            stiffness_n_per_m,
            pressure_pa,
            half_space_n_per_m,
            half_space_shift: slope / half_space_n_per_m,
            is_stated: self.rigid_is_stated,
        })
    }

    /// Widens the intervals of stiffnesses of the law of the band, as the band.
    pub(super) fn widen(&self, stiffnesses: &mut [StiffnessEstimate], law: &LawBand, level: f64) {
        let width = normal_quantile(0.5 + 0.5 * level);
        for one in stiffnesses.iter_mut().filter(|one| one.law == law.name) {
            let next = law.pressure.partition_point(|p| *p < one.pressure_pa);
            let Some(deviation) = self.deviation.get(next).filter(|d| d.is_finite()) else {
                continue;
            };
            let value = one.stiffness_pa_per_m;
            let [low, high] = one.interval_pa_per_m.map(|end| (end / value).ln());
            let factor = width * deviation;
            // The sides of an interval that does not hold its value stay as they are.
            if low <= 0.0 && high >= 0.0 {
                one.interval_pa_per_m =
                    [value * (-low.hypot(factor)).exp(), value * high.hypot(factor).exp()];
            }
        }
    }
}

impl LawBand {
    /// Widens the band by an independent normal error of ln K with these standard deviations: the
    /// distances of its ends from the median are added in squares.
    pub(super) fn widen(&mut self, deviation: &[f64], level: f64) {
        let ends = [0.5 + 0.5 * level, 0.75].map(normal_quantile);
        let [first, third] = &mut self.quartiles;
        for (lower, upper, width) in
            [(&mut self.lower, &mut self.upper, ends[0]), (first, third, ends[1])]
        {
            for (i, deviation) in deviation.iter().enumerate().filter(|(_, d)| d.is_finite()) {
                let own = |end: f64| (end / self.median[i]).ln().hypot(width * deviation);
                let (low, high) = (own(lower[i]), own(upper[i]));
                if self.origin[i] != StiffnessOrigin::Given && low.is_finite() && high.is_finite() {
                    lower[i] = self.median[i] * (-low).exp();
                    upper[i] = self.median[i] * high.exp();
                }
            }
        }
    }
}

/// Young's modulus \[Pa\] and Poisson's ratio of steel.
const STEEL: f64 = 210e9;
const POISSON: f64 = 0.3;

/// Change of ln K for a compliance below the lowest body \[N/m\], if this number is the modulus of that body, which
/// stands on a rigid support: the compliance of the body, length / (modulus area), is in series with it.
fn series_compliance(scenario: &Value, number: &GivenNumber) -> Option<(f64, f64)> {
    let is_rigid = scenario.pointer("/support/kind").is_none_or(|kind| kind == "rigid");
    let bodies = scenario["bodies"].as_array()?;
    let last = bodies.len().checked_sub(1).filter(|last| is_rigid && *last > 0)?;
    if number.pointer != format!("/bodies/{last}/youngs_modulus_pa") {
        return None;
    }
    let of = |key: &str| bodies[last][key].as_f64();
    let length = of("length_m")?;
    let area = of("area_m2").or_else(|| Some(of("mass_kg")? / (of("density_kg_per_m3")? * length)));
    let slope = -number.sensitivity * number.value * area? / length;
    Some((slope, number.pressure_pa))
}

/// Place of the informed pressure next to the static one, or of the static one.
fn reference(law: &LawBand) -> usize {
    let distance = |&i: &usize| (law.pressure[i] - law.at_rest).abs();
    let nearest = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
    let informed = (0..law.pressure.len()).filter(|&i| law.informed[i]).min_by(nearest);
    informed.or_else(|| (0..law.pressure.len()).min_by(nearest)).unwrap_or(0)
}

/// Pointers and values of the numbers that no parameter changes, without the law of a free law, which its
/// table replaces, and without the measured peak of the force.
fn given(forward: &ScenarioModel) -> Vec<(String, f64)> {
    let mut all = Vec::new();
    for section in SECTIONS {
        if let Some(value) = forward.scenario.get(section) {
            leaves(value, &JsonPointer::root().child(section), &mut all);
        }
    }
    let is_known = |pointer: &str| {
        forward.parameters.pointers().any(|known| is_within(pointer, known))
            || pointer.ends_with("/peak_n")
            || is_of_reduction(&forward.scenario, pointer)
    };
    all.retain(|(pointer, value)| *value != 0.0 && !is_known(pointer));
    all
}

/// The numbers of a value, with their pointers.
fn leaves(value: &Value, pointer: &JsonPointer, all: &mut Vec<(String, f64)>) {
    match value {
        Value::Number(number) => {
            all.extend(number.as_f64().map(|number| (pointer.to_string(), number)));
        }
        Value::Object(members) => {
            members.iter().for_each(|(key, value)| leaves(value, &pointer.child(key), all));
        }
        Value::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(i, value)| leaves(value, &pointer.child(i.to_string()), all));
        }
        _ => {}
    }
}

/// Relative standard deviation of a number that is rounded to its last digit other than zero, at most
/// [`MOST_BY_DIGITS`].
fn by_digits(value: f64) -> f64 {
    let text = format!("{:e}", value.abs());
    let mantissa = text.split('e').next().unwrap_or_default();
    let decimals = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    let leading: f64 = mantissa.parse().unwrap_or(1.0);
    let unit = 10.0_f64.powi(-i32::try_from(decimals).unwrap_or(i32::MAX));
    (unit / 12.0_f64.sqrt() / leading).min(MOST_BY_DIGITS)
}

/// The last key of a pointer, and the name of the body or interface that it belongs to.
fn label(scenario: &Value, pointer: &str) -> String {
    let parts: Vec<&str> = pointer.split('/').skip(1).collect();
    let named = |section: &str, place: &str| {
        scenario.pointer(&format!("/{section}/{place}/name"))?.as_str().map(str::to_owned)
    };
    match parts.as_slice() {
        [section @ ("bodies" | "interfaces"), place, rest @ ..] => match named(section, place) {
            Some(name) => format!("{} of \"{name}\"", rest.join("/")),
            None => pointer.to_owned(),
        },
        ["laws", name, rest @ ..] => format!("{} of law \"{name}\"", rest.join("/")),
        _ => parts.join("/"),
    }
}

#[cfg(test)]
mod tests {
    use super::by_digits;

    #[test]
    fn digits_tell_the_tolerance_up_to_a_limit() {
        let rounding = |value: f64, half: f64| half / 3.0_f64.sqrt() / value;
        assert!((by_digits(1.61) - rounding(1.61, 0.005)).abs() < 1e-12);
        assert!((by_digits(7850.0) - rounding(7850.0, 5.0)).abs() < 1e-12);
        assert!((by_digits(1.15e-4) - rounding(1.15e-4, 0.005e-4)).abs() < 1e-9);
        for few in [2.0, 0.1, 5e13, -2e-4] {
            assert_eq!(by_digits(few), 5e-3);
        }
    }
}
