//! Derivatives of a hit against central differences of whole hits at the same step, marched with
//! the exact laws and solved to rounding; and against the closed form for a linear contact.

use std::sync::Arc;

use crate::support::{AREA, Law, difference};
use asperity_dynamics::{
    Batch, ModalModel, ParameterVariation, RELATIVE_STEP, STENCIL, Sampling, Sensitivity,
    StepHistory, TransientCase, central_difference,
};
use asperity_law::{ContactDamping, Friction, ModifiedPower, Power};
use asperity_mesh::{Body, BodyDamping, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

const DURATION: f64 = 0.03;

/// Everything that is varied.
#[derive(Debug, Clone, Copy)]
struct Case {
    modified: bool,
    coefficient: f64,
    exponent: f64,
    knots: [f64; 4],
    peak: f64,
    rise: f64,
    ratio: f64,
    mass: f64,
    length: f64,
    area: f64,
    support: f64,
    gravity: f64,
    /// Of the upper contact, the lower one's coefficient and exponent, and of the bodies; all or none.
    retardation_time: f64,
    damping_coefficient: f64,
    damping_exponent: f64,
    body_time: f64,
    /// Of the guide of the bar and across the lower contact: stuck stiffness, and the coefficient of
    /// the guide and the slip force of the contact; all or none.
    guide_stiffness: f64,
    guide_coefficient: f64,
    contact_stiffness: f64,
    slip_force: f64,
    step: f64,
}

type Place = fn(&mut Case) -> &mut f64;

const PARAMETERS: [(&str, Place); 14] = [
    ("coefficient", |case| &mut case.coefficient),
    ("exponent", |case| &mut case.exponent),
    ("knot 0", |case| &mut case.knots[0]),
    ("knot 1", |case| &mut case.knots[1]),
    ("knot 2", |case| &mut case.knots[2]),
    ("knot 3", |case| &mut case.knots[3]),
    ("peak", |case| &mut case.peak),
    ("rise", |case| &mut case.rise),
    ("damping ratio", |case| &mut case.ratio),
    ("mass", |case| &mut case.mass),
    ("length", |case| &mut case.length),
    ("area", |case| &mut case.area),
    ("support", |case| &mut case.support),
    ("gravity", |case| &mut case.gravity),
];

const CASE: Case = Case {
    modified: true,
    coefficient: 1.81e10,
    exponent: 0.35,
    knots: [0.02e12, 0.12e12, 0.40e12, 0.97e12],
    peak: 20.0,
    rise: 0.34e-3,
    ratio: 0.035,
    mass: 1.61,
    length: 0.229,
    area: AREA,
    support: 2e8,
    gravity: 9.81,
    retardation_time: 0.0,
    damping_coefficient: 0.0,
    damping_exponent: 0.0,
    body_time: 0.0,
    guide_stiffness: 0.0,
    guide_coefficient: 0.0,
    contact_stiffness: 0.0,
    slip_force: 0.0,
    step: 1e-5,
};

const DAMPED: Case = Case {
    retardation_time: 4e-6,
    damping_coefficient: 3e6,
    damping_exponent: 1.4,
    body_time: 2e-6,
    ..CASE
};

/// Friction that sticks and slips, without and with viscous damping of the contacts.
const FRICTION: Case = Case {
    guide_stiffness: 4e7,
    guide_coefficient: 0.02,
    contact_stiffness: 3e7,
    slip_force: 0.3,
    ..CASE
};

/// The numbers that are varied in a case.
fn parameters(case: &Case) -> Vec<(&'static str, Place)> {
    let mut parameters = PARAMETERS.to_vec();
    if case.body_time > 0.0 {
        parameters.extend([
            ("retardation time", (|case| &mut case.retardation_time) as Place),
            ("damping coefficient", |case| &mut case.damping_coefficient),
            ("damping exponent", |case| &mut case.damping_exponent),
            ("body time", |case| &mut case.body_time),
        ]);
    }
    if case.guide_stiffness > 0.0 {
        parameters.extend([
            ("guide stiffness", (|case| &mut case.guide_stiffness) as Place),
            ("guide coefficient", |case| &mut case.guide_coefficient),
            ("contact stiffness", |case| &mut case.contact_stiffness),
            ("slip force", |case| &mut case.slip_force),
        ]);
    }
    parameters
}

impl Case {
    fn law(&self) -> Law {
        if self.modified {
            let [a, b, c, d] = self.knots;
            let knots = [(0.0, a), (0.025e6, b), (0.078e6, c), (0.14e6, d)];
            Arc::new(ModifiedPower::new(self.coefficient, self.exponent, 2e5, &knots).unwrap())
        } else {
            Arc::new(Power::new(self.coefficient, self.exponent, 0.0).unwrap())
        }
    }

    fn hit(&self, law: &Law) -> TransientCase {
        let mut contacts = [
            Interface::new("guide-sample", self.area, Arc::clone(law)).unwrap(),
            Interface::new("sample-disc", self.area, Arc::clone(law)).unwrap(),
        ];
        if self.body_time > 0.0 {
            let [time, c, n] =
                [self.retardation_time, self.damping_coefficient, self.damping_exponent];
            let dampings = [
                ContactDamping::kelvin_voigt(time).unwrap(),
                ContactDamping::power(c, 1.4e5, n).unwrap(),
            ];
            let pairs = contacts.into_iter().zip(dampings);
            contacts = pairs
                .map(|(contact, damping)| contact.with_damping(damping))
                .collect::<Vec<_>>()
                .try_into()
                .unwrap();
        }
        let mut bar = Body::with_mass("guide bar", self.length, self.mass, 71e9, 2710.0).unwrap();
        if self.guide_stiffness > 0.0 {
            let [upper, lower] = contacts;
            let own = Friction::slip_force(self.contact_stiffness, self.slip_force).unwrap();
            contacts = [upper, lower.with_friction(own)];
            let share = Friction::coefficient(self.guide_stiffness, self.guide_coefficient);
            bar = bar.with_friction(share.unwrap());
        }
        let stack = Stack::new(
            vec![bar, Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap()],
            contacts.to_vec(),
            Support::SpringMass { stiffness: self.support, mass: 3.0, damping_ratio: 0.05 },
            self.gravity,
        )
        .unwrap()
        .with_body_damping(BodyDamping::kelvin_voigt(self.body_time).unwrap());
        let structure = PreloadedStructure::new(stack, Damping::Ratio(self.ratio)).unwrap();
        let rig =
            Arc::new(ModalModel::of_stack(&structure, &[2, 1], Port::TOP, &[Port::TOP]).unwrap());
        let excitation = LoadCase::force(TimeFunction::GammaPulse { rise: self.rise }, self.peak);
        TransientCase {
            model: rig,
            load: excitation,
            sensor: 0,
            duration: DURATION,
            step: Some(self.step),
            tolerance: None,
        }
    }

    fn varied(mut self, place: Place, shift: f64) -> Self {
        *place(&mut self) += shift;
        self
    }
}

fn variations(case: &Case, law: &Law) -> Vec<ParameterVariation> {
    let vary = |(number, (_, place)): (usize, (&str, Place))| {
        let step = RELATIVE_STEP * *place(&mut case.clone());
        let cases = STENCIL.map(|at| {
            let varied = case.varied(place, at * step);
            varied.hit(&if number < 6 { varied.law() } else { Arc::clone(law) })
        });
        ParameterVariation { cases, step }
    };
    parameters(case).into_iter().enumerate().map(vary).collect()
}

/// Every number of a course in columns.
fn columns(course: &StepHistory) -> Vec<Vec<f64>> {
    let mut columns = vec![course.force.clone(), course.displacement.clone()];
    columns.extend(course.pressure.iter().cloned());
    for contact in &course.contacts {
        columns.push(vec![contact.pressure_min]);
        columns.push(vec![contact.pressure_max]);
        columns.push(vec![contact.stiffness_average]);
        columns.push(vec![contact.stiffness_at_pressure_min]);
    }
    columns
}

/// The derivatives of whole hits, by central differences of fourth order.
fn whole_hits(case: &Case, place: Place, relative: f64) -> Vec<Vec<f64>> {
    let step = relative * *place(&mut case.clone());
    let four = STENCIL.map(|at| {
        let varied = case.varied(place, at * step);
        let found = Batch::default().sensitivity(&varied.hit(&varied.law()), &[]).unwrap();
        columns(&found.values)
    });
    let at = |column: usize, n: usize| {
        central_difference(four.each_ref().map(|columns| columns[column][n]), step)
    };
    let lengths = four[0].iter().map(Vec::len).enumerate();
    lengths.map(|(column, length)| (0..length).map(|n| at(column, n)).collect()).collect()
}

/// The largest difference of every column from whole hits, over the column's largest derivative
/// and a hundredth of its largest value over the parameter's: derivatives of zero count as
/// noise.
fn off(
    found: &StepHistory,
    expected: &[Vec<f64>],
    values: &StepHistory,
    parameter: f64,
) -> Vec<f64> {
    let largest = |column: &[f64]| column.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let pairs = columns(found).into_iter().zip(expected).zip(columns(values));
    pairs
        .map(|((a, b), values)| {
            let scale = largest(b).max(1e-2 * largest(&values) / parameter);
            let worst = a.iter().zip(b).fold(0.0_f64, |most, (a, b)| {
                let off = (a - b).abs();
                if off.is_nan() { f64::NAN } else { most.max(off) }
            });
            if worst == 0.0 { 0.0 } else { worst / scale }
        })
        .collect()
}

fn compare(case: &Case, relative: f64, tolerance: f64) {
    let law = case.law();
    let found: Sensitivity =
        Batch::default().sensitivity(&case.hit(&law), &variations(case, &law)).unwrap();
    let mut worst = 0.0_f64;
    for ((name, place), rates) in parameters(case).iter().zip(&found.derivatives) {
        if name.starts_with("knot") && !case.modified {
            assert!(columns(rates).iter().flatten().all(|rate| *rate == 0.0));
            continue;
        }
        let parameter = *place(&mut case.clone());
        let each = off(rates, &whole_hits(case, *place, relative), &found.values, parameter);
        let most =
            each.iter().fold(0.0_f64, |most, x| if x.is_nan() { f64::NAN } else { most.max(*x) });
        assert!(most < tolerance, "{name}: {most} {each:?}");
        worst = if most.is_nan() { most } else { worst.max(most) };
    }
    assert!(worst < tolerance, "{worst}");
}

/// At every step and for every measure, to 1e-7: whole hits 1e-5 apart have a rounding of 1e-9 and
/// a truncation, where the laws' cubics join, of 1e-8.
#[test]
fn derivatives_are_those_of_whole_hits() {
    compare(&CASE, 1e-5, 1e-7);
    compare(&Case { modified: false, peak: 9.0, ..CASE }, 1e-5, 1e-7);
}

/// Damped contacts and bodies: every number of the damping too.
#[test]
fn derivatives_of_damped_hits_are_those_of_whole_hits() {
    compare(&DAMPED, 1e-5, 1e-6);
    compare(&Case { modified: false, peak: 9.0, ..DAMPED }, 1e-5, 1e-7);
}

/// Friction in a guide, a share of a contact's force, and across a contact: every number of it too. The
/// motion is continuous between stick and slip, its derivative is not: whole hits 1e-7 apart (rounding
/// 1e-7) see a reversal in another step now and then.
#[test]
fn derivatives_with_friction_are_those_of_whole_hits() {
    compare(&FRICTION, 1e-7, 1e-5);
    compare(&Case { modified: false, peak: 9.0, ..FRICTION }, 1e-7, 1e-5);
    let damped = Case { guide_stiffness: 4e7, guide_coefficient: 0.02, ..DAMPED };
    compare(&Case { contact_stiffness: 3e7, slip_force: 0.3, ..damped }, 1e-7, 1e-5);
}

/// Contact lost and found again: the map is smooth only between such steps, so whole hits must be
/// so near, 1e-7, that hardly any opens or closes; their rounding is then 1e-7, of the highest
/// pressure 1e-6. A step next to loss, where stiffness rises without bound, leaves 1e-5 in the mean
/// stiffness of whole hits (found between 50 N and 60 N).
#[test]
fn derivatives_are_those_of_whole_hits_with_loss_of_contact() {
    let case = Case { modified: false, peak: 60.0, step: 2e-6, ..CASE };
    let found = Batch::default().sensitivity(&case.hit(&case.law()), &[]).unwrap();
    assert_eq!(found.values.contacts[0].pressure_min, 0.0);
    compare(&case, 1e-7, 3e-5);
}

/// The response that is differentiated is the usual one, to the tolerance of its tables and of its
/// unfinished corrections.
#[test]
fn the_response_is_that_of_the_vector_kernel() {
    for case in [CASE, DAMPED, FRICTION] {
        the_response_of(&case);
    }
}

fn the_response_of(case: &Case) {
    let hit = case.hit(&case.law());
    let sampling = Sampling::new(DURATION, 1e5).unwrap();
    let fast = Batch::default().transient(&hit, &sampling).unwrap();
    let found = Batch::default().sensitivity(&hit, &[]).unwrap().values;
    let samples = fast.history.sensors[0].displacement.len();
    let off = difference(&fast.history.sensors[0].displacement, &found.displacement[..samples]);
    assert!(off < 1e-4);
    let average = |k: f64| (k / fast.contacts[0].pressure_min - 1.0).abs();
    assert!(average(found.contacts[0].pressure_min) < 1e-4);
}

/// Nothing moves a rig at rest but a force.
#[test]
fn at_rest_only_forces_have_derivatives() {
    let law = CASE.law();
    let still = |mut hit: TransientCase| {
        hit.load = LoadCase::none();
        hit
    };
    let mut all = variations(&CASE, &law);
    for (number, variation) in all.iter_mut().enumerate() {
        if number != 6 {
            variation.cases = variation.cases.each_ref().map(|hit| still(hit.clone()));
        }
    }
    // The peak, about zero: its derivative is the response to a force of one newton.
    all[6].cases = STENCIL.map(|at| Case { peak: at * 1e-3, ..CASE }.hit(&law));
    all[6].step = 1e-3;
    let found = Batch::default().sensitivity(&still(CASE.hit(&law)), &all).unwrap();
    for (number, rates) in found.derivatives.iter().enumerate() {
        let moves = rates.displacement.iter().any(|u| *u != 0.0);
        assert_eq!(moves, number == 6, "{}", PARAMETERS[number].0);
    }
    let light = Case { peak: 1e-4, ..CASE }.hit(&law);
    let small = Batch::default().sensitivity(&light, &[]).unwrap().values.displacement;
    let scaled: Vec<f64> = small.iter().map(|u| u / 1e-4).collect();
    // A force of 1e-5 of the weight has a response linear to as much.
    assert!(difference(&scaled, &found.derivatives[6].displacement) < 1e-4);
}
