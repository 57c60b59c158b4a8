//! Steady responses of a random scenario: harmonic balance against exact and integrated ones.
//!
//! | response | truth |
//! |---|---|
//! | static pressures | weights above over areas |
//! | lowest natural frequency | zero of the exact dynamic stiffness of the stack |
//! | steady responses to a small force | exact receptance of the stack linearised at rest |
//! | a steady response to a large force | integration by finite differences, extrapolated in the step; by small modal steps where that would take long |
//!
//! Where harmonic balance and finite differences differ, a modal integration with a small step
//! decides between them, or one that begins in the state of the response; without an agreement there is no truth.

use std::f64::consts::TAU;
use std::panic::{AssertUnwindSafe, catch_unwind};

use asperity_dynamics::{FiniteDifference, Integrator, Modal, Sampling};
use asperity_harmonic::{Branch, PeriodicResponse, SpecialPointKind};
use asperity_law::{Draw as _, rounded};
use asperity_mesh::{Body, Port};
use asperity_scenario::{Document, Scenario, SensorKind};
use asperity_simulation::assemble::{Assembly, Sensor};
use asperity_simulation::steady::{
    BodyModel, SettledAmplitude, Steady, SteadyLevel, SteadyMotion, SteadyRequest, TimeCheck,
    first_periods, steady,
};
use asperity_simulation::warning::Warning;
use asperity_structure::{LoadCase, PreloadedStructure, TimeFunction};
use serde::Serialize;
use serde_json::{Value, json};

use super::draw::Draw;
use super::judgement::Class;
use super::linear_oracle::{is_lowest_frequency, receptance};

/// Largest relative error of the amplitude of a steady response.
pub(super) const AMPLITUDE: f64 = 1e-2;

/// Largest relative error of the amplitude of a linear response, and of a static pressure.
pub(super) const LINEAR: f64 = 1e-3;

/// Most node updates of an integration to a steady response.
const MOST_NODE_STEPS: f64 = 4e8;

/// Relative distances in frequency and amplitude up to which a response beside a fold stands for the peak there: steps of
/// the integration move the fold by a few millionths.
const BESIDE: f64 = 1e-3;
const ALIKE: f64 = 0.5 * AMPLITUDE;

/// Truncation of harmonics above which a branch says that it may be wrong.
const TRUNCATION: f64 = 1e-3;

/// Quantities compared.
const LARGE: &str = "steady response to a large force";
const LOST: &str = "steady response of a stack that loses contact";

/// Stream of random numbers of the force.
const STREAM: u64 = 1 << 32;

/// A comparison with its class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct SteadyJudgement {
    /// Quantity compared.
    pub(super) of: &'static str,
    pub(super) class: Class,
    /// Largest relative error, if there is a number.
    pub(super) error: Option<f64>,
    /// Conditions, or the words of an error.
    pub(super) remark: String,
}

impl SteadyJudgement {
    pub(super) fn new(of: &'static str, error: f64, tolerance: f64, remark: String) -> Self {
        let class = if error <= tolerance { Class::Right } else { Class::SilentlyWrong };
        Self { of, class, error: Some(error), remark }
    }

    pub(super) fn without(of: &'static str, class: Class, remark: String) -> Self {
        Self { of, class, error: None, remark }
    }
}

/// Judges the static state, the lowest natural frequency, and the steady responses to a small and a
/// large force. Two numbers determine the forces.
pub(super) fn judge(
    document: &Document,
    scenario: &Scenario,
    seed: u64,
    number: u64,
) -> Vec<SteadyJudgement> {
    let attempt = || judge_all(document, scenario, &mut Draw::new(seed, number, STREAM));
    catch_unwind(AssertUnwindSafe(attempt)).unwrap_or_else(|_| {
        let remark = "panic".to_owned();
        vec![SteadyJudgement::without("steady responses", Class::SilentlyWrong, remark)]
    })
}

fn judge_all(document: &Document, scenario: &Scenario, draw: &mut Draw) -> Vec<SteadyJudgement> {
    let assembly = match Assembly::new(scenario, document.folder()) {
        Ok(assembly) => assembly,
        Err(error) => {
            let remark = error.to_string();
            return vec![SteadyJudgement::without("static state", Class::Refused, remark)];
        }
    };
    let structure = &assembly.structure;
    let Some(natural) = structure.natural_frequency() else { return Vec::new() };
    let mut found = vec![static_pressures(structure)];
    let error = if is_lowest_frequency(structure, natural) { 0.0 } else { f64::INFINITY };
    let remark = format!("{natural:.6} Hz");
    found.push(SteadyJudgement::new("lowest natural frequency", error, LINEAR, remark));

    let ratio = structure.damping_rate() / (2.0 * TAU * natural);
    let weights = structure.contacts().iter().map(|contact| contact.pressure() * contact.area());
    let smallest = weights.clone().fold(f64::INFINITY, f64::min);
    let largest = weights.fold(0.0, f64::max);
    // At resonance a force is amplified by 1/(2 ratio).
    // The exact linear response is the response of the top to a force there.
    let kind = SensorKind::Displacement;
    let top = Assembly {
        load: LoadCase::none(),
        sensors: vec![Sensor { name: None, port: Port::TOP, kind, base_share: 1.0 }],
        ..assembly.clone()
    };
    found.push(small_force(&top, natural, 1e-4 * 2.0 * ratio * smallest));
    let force = draw.log_uniform(0.01, 1.0) * 2.0 * ratio * largest;
    // A moving base pushes with the mass of the whole.
    let mass: f64 = structure.stack().bodies().iter().map(Body::mass).sum();
    let amplitude = if assembly.load.base().is_some() { force / mass } else { force };
    found.push(large_force(LARGE, &assembly, natural, amplitude));
    found.extend(lost_contact(draw));
    found
}

/// A stack of two or three bodies of 5 g to 6 kg, on contacts that open under a force of a twentieth to
/// half of the weight of the uppermost. `None` for a stack without a natural frequency.
fn lost_contact(draw: &mut Draw) -> Option<SteadyJudgement> {
    let count = draw.whole(2..=3);
    let body = |draw: &mut Draw, number: usize| {
        let [modulus, density] = *draw.one_of(&[[71e9, 2700.0], [2e11, 7850.0]]);
        json!({
            "name": format!("body {number}"),
            "length_m": rounded(draw.uniform(0.01, 0.1)),
            "mass_kg": rounded(draw.log_uniform(5e-3, 6.0)),
            "youngs_modulus_pa": modulus,
            "density_kg_per_m3": density
        })
    };
    let interface = |draw: &mut Draw, number: usize| {
        let law = if draw.chance(0.5) {
            let coefficient = rounded(draw.log_uniform(1e9, 2e10));
            json!({"kind": "power", "coefficient": coefficient, "exponent": rounded(draw.uniform(0.3, 0.6))})
        } else {
            let stiffness = rounded(draw.log_uniform(1e12, 3e13));
            json!({"kind": "constant", "stiffness_pa_per_m": stiffness, "unilateral": draw.chance(0.7)})
        };
        let area = rounded(draw.log_uniform(1e-4, 1e-3));
        json!({"name": format!("contact {number}"), "area_m2": area, "law": law})
    };
    let bodies: Vec<Value> = (0..count).map(|number| body(draw, number)).collect();
    let interfaces: Vec<Value> = (0..count).map(|number| interface(draw, number)).collect();
    let ratio = rounded(draw.uniform(0.01, 0.05));
    let weight = 9.81 * bodies[0]["mass_kg"].as_f64()?;
    let force = rounded(draw.log_uniform(0.05, 0.5) * weight);
    let scenario = json!({
        "schema": "asperity/scenario/1",
        "bodies": bodies,
        "interfaces": interfaces,
        "damping": {"kind": "mass_proportional", "ratio": ratio},
        "duration_s": 0.1
    });
    let refused = |remark| Some(SteadyJudgement::without(LOST, Class::Refused, remark));
    let document = match Document::parse(&scenario.to_string(), "stack.json") {
        Ok(document) => document,
        Err(error) => return refused(error.to_string()),
    };
    let assembly = match document.scenario().map(|found| Assembly::new(&found, document.folder())) {
        Ok(Ok(assembly)) => assembly,
        Ok(Err(error)) => return refused(error.to_string()),
        Err(error) => return refused(error.to_string()),
    };
    let natural = assembly.structure.natural_frequency()?;
    let mut found = large_force(LOST, &assembly, natural, force);
    // The stack itself, of what is not right: it has no file.
    if found.class != Class::Right {
        found.remark = format!("{}; {force} N on {scenario}", found.remark);
    }
    Some(found)
}

fn static_pressures(structure: &PreloadedStructure) -> SteadyJudgement {
    let (mut weight, mut worst) = (0.0, 0.0_f64);
    for (body, contact) in structure.stack().bodies().iter().zip(structure.contacts()) {
        let mass = body.density() * body.section() * body.length();
        weight += mass * structure.stack().gravity();
        worst = worst.max((contact.pressure() * contact.area() / weight - 1.0).abs());
    }
    SteadyJudgement::new("static pressures", worst, LINEAR, String::new())
}

fn request(natural: f64, force: f64, verify: bool) -> SteadyRequest {
    SteadyRequest {
        amplitudes: vec![force],
        from_hz: 0.7 * natural,
        to_hz: 1.3 * natural,
        harmonics: None,
        backbone: false,
        verify,
        bodies: BodyModel::Auto,
        time_sweep: None,
    }
}

/// The branch of a request of one level, and its check by integration.
fn branch(found: &Steady) -> Result<(&Branch, Option<TimeCheck>), String> {
    let level = found.levels.first().ok_or("no level")?;
    let branch = level.outcome.as_ref().map_err(ToString::to_string)?;
    Ok((branch, level.check))
}

/// Responses to a force so small that contacts act as springs.
fn small_force(assembly: &Assembly, natural: f64, force: f64) -> SteadyJudgement {
    const OF: &str = "steady response to a small force";
    let refused = |remark| SteadyJudgement::without(OF, Class::Refused, remark);
    let found = match steady(assembly, &request(natural, force, false)) {
        Ok(found) => found,
        Err(error) => return refused(error.to_string()),
    };
    let points = match branch(&found) {
        Ok((branch, _)) => &branch.points,
        Err(error) => return refused(error),
    };
    let error = |point: &PeriodicResponse| {
        let exact = receptance(&assembly.structure, point.angular_frequency).norm() * force;
        (point.amplitude(1) / exact - 1.0).abs()
    };
    let worst = points.iter().map(error).fold(0.0, f64::max);
    SteadyJudgement::new(OF, worst, LINEAR, format!("{force:.3e} N, {} points", points.len()))
}

/// A response to a force that makes pressures vary much, where integration is affordable.
fn large_force(of: &'static str, assembly: &Assembly, natural: f64, force: f64) -> SteadyJudgement {
    let without = |class, remark| SteadyJudgement::without(of, class, remark);
    let verify = integration_cost(assembly, natural).is_some_and(|cost| cost <= MOST_NODE_STEPS);
    let found = match steady(assembly, &request(natural, force, verify)) {
        Ok(found) => found,
        Err(error) => return without(Class::Refused, error.to_string()),
    };
    let (branch, check) = match branch(&found) {
        Ok(found) => found,
        Err(error) => return without(Class::Refused, error),
    };
    let level = &found.levels[0];
    let (points, truncation) = (branch.points.len(), branch.truncation());
    let state = format!(
        "{force:.3e} N, {points} points, {:?}, {} harmonics, truncation {truncation:.1e}{}",
        branch.termination,
        branch.harmonics,
        if branch.points.iter().any(PeriodicResponse::contact_lost) {
            ", contact lost"
        } else {
            ""
        }
    );
    let Some(check) = check else {
        return by_modes(of, assembly, (level, branch), &state);
    };
    let TimeCheck {
        frequency_hz, amplitude_1_m, integrated_1_m, relative_difference, settled, ..
    } = check;
    let remark = format!("at {frequency_hz:.3} Hz {amplitude_1_m:.4e} m; {state}");
    if !settled {
        return without(Class::NamedUndecided, format!("{remark}; integration has not settled"));
    }
    if relative_difference <= AMPLITUDE || may_be_shifted(level, branch, &check) {
        return SteadyJudgement {
            of,
            class: Class::Right,
            error: Some(relative_difference),
            remark,
        };
    }
    // From rest the stack settles on another motion, from its own state on this one.
    if level.warnings.iter().any(|one| matches!(one, Warning::AnotherMotion { .. })) {
        let remark = format!("{remark}; another motion from rest, {integrated_1_m:.4e} m");
        return SteadyJudgement { of, class: Class::Right, error: None, remark };
    }
    let named = truncation > TRUNCATION;
    let integrated = modal_amplitude(assembly, force, frequency_hz);
    let decided = integrated.is_some_and(|modal| (modal / integrated_1_m - 1.0).abs() <= 5e-3);
    let class = match (decided, named) {
        (true, true) => Class::NamedWrong,
        (true, false) => Class::SilentlyWrong,
        (false, true) => Class::NamedUndecided,
        (false, false) => Class::SilentlyUndecided,
    };
    let by_modes = integrated.map_or("refused".to_owned(), |modal| format!("{modal:.4e} m"));
    let remark = format!("{remark}; by cells {integrated_1_m:.4e} m, by modes {by_modes}");
    SteadyJudgement { of, class, error: Some(relative_difference), remark }
}

/// True if the integrated amplitude is that of the branch where the inertia left out may move its frequency to: by half
/// of its share of the kinetic energy, as the branch says.
fn may_be_shifted(level: &SteadyLevel, branch: &Branch, check: &TimeCheck) -> bool {
    let Some(condensed) = &level.condensed else { return false };
    let share: f64 = condensed.light.bodies().iter().map(|body| body.inertia_share).sum();
    let (low, high) =
        ((1.0 - 0.5 * share) * check.frequency_hz, (1.0 + 0.5 * share) * check.frequency_hz);
    let amplitudes = branch.points.windows(2).flat_map(|pair| {
        let [a, b] = [0, 1].map(|n| (pair[n].frequency_hz(), pair[n].at_sensor(0, 1).norm()));
        let at = move |frequency: f64| {
            let part = (frequency - a.0) / (b.0 - a.0);
            (0.0..=1.0).contains(&part).then_some(a.1 + part * (b.1 - a.1))
        };
        let inside = (low..=high).contains(&a.0).then_some(a.1);
        [at(low), at(high), inside].into_iter().flatten()
    });
    let (least, most) = amplitudes.fold((f64::INFINITY, 0.0_f64), |(least, most), amplitude| {
        (least.min(amplitude), most.max(amplitude))
    });
    ((1.0 - AMPLITUDE) * least..=(1.0 + AMPLITUDE) * most).contains(&check.integrated_1_m)
}

/// The largest stable response of a branch that loses contact against time integration from its own state; of one that
/// keeps it, the highest response against a modal integration from rest. Where several exist that may settle on another, and
/// an integration from its own state decides; where it leaves a peak beside a fold, one from the state of a response a little
/// further from the fold. A branch without a stable response says so.
fn by_modes(
    of: &'static str,
    assembly: &Assembly,
    (level, branch): (&SteadyLevel, &Branch),
    state: &str,
) -> SteadyJudgement {
    let without =
        |class, remark: String| SteadyJudgement::without(of, class, format!("{remark}; {state}"));
    if let Some(own) = &level.from_own_state {
        let left = level.warnings.iter().any(|one| matches!(one, Warning::NotKept { .. }));
        let remark = format!(
            "at {:.3} Hz {:.4e} m, {:?} from its own state",
            own.frequency_hz, own.amplitude_1_m, own.motion
        );
        let settles = own.motion != SteadyMotion::NotSettled;
        return match (left, own.relative_difference <= AMPLITUDE) {
            (true, _) => without(Class::NamedWrong, remark),
            (false, true) if settles => {
                let remark = format!("{remark}; {state}");
                SteadyJudgement::new(of, own.relative_difference, AMPLITUDE, remark)
            }
            _ => without(Class::SilentlyUndecided, remark),
        };
    }
    let Some(peak) = branch.highest().filter(|peak| peak.stable() == Some(true)) else {
        return without(Class::NamedUndecided, "no stable peak".to_owned());
    };
    let (frequency, amplitude) = (peak.frequency_hz(), peak.at_sensor(0, 1).norm());
    let remark = format!("at {frequency:.3} Hz {amplitude:.4e} m");
    let from_rest = modal_amplitude(assembly, level.force_n, frequency);
    let error = from_rest.map(|integrated| (amplitude / integrated - 1.0).abs());
    if let Some(error) = error.filter(|error| *error <= AMPLITUDE) {
        return SteadyJudgement::new(of, error, AMPLITUDE, format!("{remark}; {state}"));
    }
    let own = TimeCheck::from_own_state(assembly, peak);
    let words = from_rest.map_or("not settled".to_owned(), |modal| format!("{modal:.4e} m"));
    let remark = format!("{remark}, from rest {words}");
    let Some(own) = own else { return without(Class::SilentlyUndecided, remark) };
    let remark =
        format!("{remark}, from its own state {:.4e} m, {:?}", own.integrated_1_m, own.motion);
    let error = own.relative_difference;
    if own.settled && error <= AMPLITUDE {
        return SteadyJudgement::new(of, error, AMPLITUDE, format!("{remark}; {state}"));
    }
    if let Some((near, apart)) = beside_fold(branch, peak)
        && let Some(own) = TimeCheck::from_own_state(assembly, near)
        && own.settled
        && own.relative_difference + apart <= AMPLITUDE
    {
        let place =
            format!("beside a fold, at {:.3} Hz {:.4e} m", own.frequency_hz, own.amplitude_1_m);
        let remark = format!("{remark}; {place}, stays at {:.4e} m; {state}", own.integrated_1_m);
        return SteadyJudgement::new(of, own.relative_difference + apart, AMPLITUDE, remark);
    }
    // Left for the one that is reached from rest too, the response does not exist.
    let is_left = |rest: f64| own.settled && (own.integrated_1_m / rest - 1.0).abs() <= AMPLITUDE;
    let is_wrong = from_rest.is_some_and(is_left);
    let class = if is_wrong { Class::SilentlyWrong } else { Class::SilentlyUndecided };
    without(class, remark)
}

/// The stable response furthest in frequency of those that stand for a peak beside a fold, and the relative difference of
/// the amplitudes.
fn beside_fold<'a>(
    branch: &'a Branch,
    peak: &PeriodicResponse,
) -> Option<(&'a PeriodicResponse, f64)> {
    let apart = |a: f64, b: f64| (a / b - 1.0).abs();
    let distance = |one: &PeriodicResponse| apart(one.frequency_hz(), peak.frequency_hz());
    let amplitude = |one: &PeriodicResponse| one.at_sensor(0, 1).norm();
    let is_near_it = |fold: &PeriodicResponse| distance(fold) <= BESIDE;
    if !branch.of_kind(SpecialPointKind::Fold).any(is_near_it) {
        return None;
    }
    let alike = branch.points.iter().filter_map(|one| {
        let apart = apart(amplitude(one), amplitude(peak));
        let stands = one.stable() == Some(true) && distance(one) <= BESIDE && apart <= ALIKE;
        stands.then_some((one, apart))
    });
    alike.max_by(|a, b| distance(a.0).total_cmp(&distance(b.0)))
}

/// Node updates of an integration to the steady response in cells of 1 mm.
fn integration_cost(assembly: &Assembly, frequency: f64) -> Option<f64> {
    let sampling =
        Sampling::new(first_periods(assembly, frequency) / frequency, 64.0 * frequency).ok()?;
    let method = Integrator::from(FiniteDifference::default());
    let outline = method.outline(&assembly.structure, &LoadCase::none(), &sampling).ok()?;
    Some(outline.unknowns as f64 * outline.steps as f64)
}

/// Fundamental of the first sensor \[m\] by modal steps of a quarter of the default, if it settles.
fn modal_amplitude(assembly: &Assembly, amplitude: f64, frequency: f64) -> Option<f64> {
    let shaker = LoadCase::force(TimeFunction::Harmonic { frequency }, amplitude);
    let shaker = shaker.at(assembly.load.port());
    let sampling = Sampling::new(20.0 / frequency, 64.0 * frequency).ok()?;
    let default = Integrator::default().outline(&assembly.structure, &shaker, &sampling).ok()?;
    let (step, modes_per_body) = (Some(default.step / 4.0), Some(20));
    let method = Modal { step, modes_per_body, ..Modal::default() }.into();
    let found = SettledAmplitude::of(assembly, &method, amplitude, frequency).ok()?;
    found.is_settled().then_some(found.amplitude_1_m)
}
