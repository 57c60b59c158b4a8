//! Structures with many contacts: equations in modes against equations with matrices.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use asperity_law::{ContactDamping, ContactLaw, Power};
use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
use asperity_structure::{
    Damping, PreloadedContact, PreloadedStructure, UnloadedContact, contacts_at_rest,
};

use crate::arc_length::ArcLength;
use crate::balance::{Balance, Conditions};
use crate::continuation_problem::ContinuationProblem;
use crate::factorization::{Factorization, dot};
use crate::{
    Branch, ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings,
    LawEvaluation, PeriodicResponse, StepControl, SystemPort, Termination, trace,
};

/// A block on a grid of cells: heave, two rocking motions, elastic modes, a flexibility about each cell, gaps that leave
/// some cells open at rest, a load near a corner and sensors. A motion along the ground is free.
#[derive(Clone, Copy)]
pub(crate) struct Block {
    pub(crate) cells: [usize; 2],
    pub(crate) elastic: usize,
    /// Largest gap over the closure at 100 kPa.
    pub(crate) roughness: f64,
    pub(crate) damping: Option<ContactDamping>,
    pub(crate) retardation: f64,
    /// Mass-proportional damping rate.
    pub(crate) rate: f64,
}

const MASS: f64 = 2.0;
const SIDE: [f64; 2] = [0.12, 0.08];
const AREA: f64 = 4e-3;

impl Block {
    pub(crate) fn structure(&self) -> PreloadedStructure<ComponentModes> {
        let [columns, rows] = self.cells;
        let count = columns * rows;
        let place = |cell: usize| {
            let (i, j) = (cell % columns, cell / columns);
            let share = |i: usize, n: usize| (i as f64 + 0.5) / n as f64 - 0.5;
            [share(i, columns) * SIDE[0], share(j, rows) * SIDE[1]]
        };
        // The load, a sensor, and a sensor on the free motion.
        let others =
            [[0.4 * SIDE[0], 0.35 * SIDE[1]], [-0.45 * SIDE[0], 0.1 * SIDE[1]], [0.0, 0.0]];
        let places: Vec<[f64; 2]> = (0..count).map(place).chain(others).collect();
        let ports = |shape: &dyn Fn([f64; 2]) -> f64| -> Vec<f64> {
            places.iter().map(|&at| shape(at)).collect()
        };
        let radius = |side: f64| side * (1.0 / 12.0_f64).sqrt();
        let unit = MASS.sqrt().recip();
        let mut free = vec![0.0; places.len()];
        free[count + 2] = unit;
        free[count] = 0.2 * unit;
        let mut modes = vec![
            NormalMode::rigid(ports(&|_| unit)),
            NormalMode::rigid(ports(&|[x, _]| unit * x / radius(SIDE[0]))),
            NormalMode::rigid(ports(&|[_, y]| unit * y / radius(SIDE[1]))),
            NormalMode::rigid(free),
        ];
        for n in 0..self.elastic {
            let (a, b) = ((n + 2) as f64 * PI, (n % 3) as f64 * PI);
            let shape = move |[x, y]: [f64; 2]| {
                2.0 * unit * (a * (x / SIDE[0] + 0.5)).cos() * (b * (y / SIDE[1] + 0.5)).cos()
            };
            let w = TAU * 2600.0 * (1.0 + 0.8 * n as f64);
            modes.push(NormalMode {
                damping_rate: self.retardation * w * w,
                ..NormalMode::elastic(w, ports(&shape))
            });
        }
        let near = |a: usize, b: usize| {
            let ([x, y], [u, v]) = (places[a], places[b]);
            let distance = (x - u).hypot(y - v);
            1.2e-10 * (-distance / 0.01).exp() * (count as f64 / 12.0).sqrt()
        };
        let row = |a: usize| (0..places.len()).map(|b| near(a, b)).collect();
        let rows: Vec<Vec<f64>> = (0..places.len()).map(row).collect();
        let residual = ResidualFlexibility::from_rows(&rows).unwrap();
        let pairs = (0..count).map(PortPair::on_ground).collect();
        let modes = ComponentModes::new(modes, residual, pairs, vec![]).unwrap();
        let law: Arc<dyn ContactLaw> = Arc::new(Power::new(4e9, 0.5, 0.0).unwrap());
        let gap = |cell: usize| {
            let turn = ((cell * 7919 + 13) % 1009) as f64 / 1009.0;
            self.roughness * turn * turn * law.closure(1e5)
        };
        let contacts: Vec<UnloadedContact> = (0..count)
            .map(|cell| UnloadedContact {
                name: format!("cell {cell}"),
                area: AREA / count as f64,
                law: Arc::clone(&law),
                gap: gap(cell),
                damping: self.damping,
            })
            .collect();
        let at_rest = contacts_at_rest(
            &modes,
            &contacts,
            &[(count + 1, 90.0), (0, 60.0), (count - 1, 180.0)],
        )
        .unwrap();
        PreloadedStructure::of_components(modes, at_rest, Damping::Rate(self.rate)).unwrap()
    }

    pub(crate) fn system(&self) -> ContactSystem {
        let count = self.cells[0] * self.cells[1];
        let system = ContactSystem::of_structure(&self.structure(), LawEvaluation::Exact).unwrap();
        let sensors = [count + 1, count + 2].map(SystemPort::Number);
        system.with_ports(SystemPort::Number(count), &sensors).unwrap()
    }
}

/// A block of 4 times 3 cells with gaps.
fn small() -> Block {
    Block {
        cells: [4, 3],
        elastic: 6,
        roughness: 1.5,
        damping: None,
        retardation: 1e-6,
        rate: 300.0,
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| most.max(v.abs()))
}

/// A motion of three harmonics that opens and closes cells.
fn motion(system: &ContactSystem, terms: usize) -> Vec<f64> {
    let deepest = system.contacts().iter().map(PreloadedContact::closure).fold(0.0, f64::max);
    let of = |at: usize| {
        let (i, k) = (at / terms, at % terms);
        0.5 * deepest * (1.0 + 3.0 * i as f64 + 0.7 * k as f64).sin() / (1.0 + k as f64)
    };
    (0..system.contacts().len() * terms).map(of).collect()
}

/// The residual of equations in modes is that of the matrices, multiplied from the left: both give the same Newton
/// step. Derivatives are those of differences.
#[test]
fn equations_in_modes_have_the_newton_step_of_the_matrices() {
    let damping = Some(ContactDamping::kelvin_voigt(2e-6).unwrap());
    for block in [small(), Block { damping, ..small() }] {
        let system = block.system();
        let resolution = (3, 96);
        let at = Conditions { angular_frequency: 11e3, anti_damping: 30.0, force: 25.0 };
        let x = motion(&system, 7);
        let n = x.len();
        let mut dense = Balance::new(&system, resolution.0, resolution.1);
        let mut many = Balance::of_many(&system, resolution, 1.0).unwrap();
        let (mut step, mut found) = (vec![0.0; n], vec![0.0; n]);
        dense.evaluate(&x, &at).unwrap();
        dense.residual(&x, &at, &mut step);
        let mut matrix = Factorization::new(n);
        dense.d_residual_d_closures(n, matrix.matrix());
        assert!(matrix.factorize());
        matrix.solve(&mut step);
        many.evaluate(&x, &at).unwrap();
        many.residual(&x, &at, &mut found);
        let (mut along, mut alike) = (vec![0.0; n], vec![0.0; n]);
        many.d_residual_along(&step, &mut along);
        let off = found.iter().zip(&along).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-10 * largest(&found), "{off:.1e} of {:.1e}", largest(&found));
        // The products of the matrices, too.
        dense.residual(&x, &at, &mut found);
        dense.d_residual_along(&step, &mut alike);
        let off = found.iter().zip(&alike).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-10 * largest(&found), "{off:.1e} of {:.1e}", largest(&found));
        assert_slopes(&mut many, &x, at);
    }
}

/// Derivatives of the residual and of the load's displacement by closures, frequency and force against differences.
fn assert_slopes(balance: &mut Balance<'_>, x: &[f64], at: Conditions) {
    let n = x.len();
    let mut value = |x: &[f64], at: &Conditions| {
        let mut residual = vec![0.0; n];
        balance.evaluate(x, at).unwrap();
        balance.residual(x, at, &mut residual);
        let u = balance.load_displacement(1, at);
        (residual, [u.re, u.im])
    };
    let direction: Vec<f64> = (0..n).map(|i| (1.9 * i as f64 + 0.3).cos()).collect();
    let size = 1e-6 * largest(x);
    let moved = |sign: f64| -> Vec<f64> {
        x.iter().zip(&direction).map(|(x, d)| x + sign * size * d).collect()
    };
    let by_w =
        |sign: f64| Conditions { angular_frequency: at.angular_frequency + sign * 0.05, ..at };
    let by_xi = |sign: f64| Conditions { anti_damping: at.anti_damping + sign, ..at };
    let pairs = [
        (value(&moved(1.0), &at), value(&moved(-1.0), &at), 2.0 * size),
        (value(x, &by_w(1.0)), value(x, &by_w(-1.0)), 0.1),
        (value(x, &by_xi(1.0)), value(x, &by_xi(-1.0)), 2.0),
    ];
    value(x, &at);
    let mut slopes = [(); 3].map(|()| vec![0.0; n]);
    balance.d_residual_along(&direction, &mut slopes[0]);
    balance.d_residual_d_frequency(&at, &mut slopes[1]);
    balance.d_residual_d_anti_damping(&at, &mut slopes[2]);
    let [mut real, mut imaginary] = [vec![0.0; n], vec![0.0; n]];
    balance.d_displacement_d_closures(&mut real, &mut imaginary);
    let [by_frequency, by_rate, _] = balance.d_displacement_d_conditions(&at);
    let along = [dot(&real, &direction), dot(&imaginary, &direction)];
    let outputs = [along, [by_frequency.re, by_frequency.im], [by_rate.re, by_rate.im]];
    for (number, ((up, down, width), (own, output))) in
        pairs.iter().zip(slopes.iter().zip(outputs)).enumerate()
    {
        let expected: Vec<f64> = up.0.iter().zip(&down.0).map(|(a, b)| (a - b) / width).collect();
        let off = own.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 2e-5 * largest(&expected), "{number}: {off:.1e}");
        let expected = [0, 1].map(|part| (up.1[part] - down.1[part]) / width);
        let off = (output[0] - expected[0]).hypot(output[1] - expected[1]);
        assert!(off < 2e-5 * expected[0].hypot(expected[1]), "{number}: {output:?} {expected:?}");
    }
}

/// The solution of the equations with matrices next to a response of a branch in modes.
fn by_matrices(
    system: &ContactSystem,
    path: Continuation,
    (harmonics, samples): (usize, usize),
    (near, value): (&PeriodicResponse, f64),
) -> PeriodicResponse {
    let balance = Balance::new(system, harmonics, samples);
    let problem = ContinuationProblem::of(balance, path).unwrap();
    let at = Conditions {
        angular_frequency: near.angular_frequency,
        anti_damping: near.anti_damping,
        force: near.force,
    };
    let guess = problem.unknowns(&near.closures, &at, value);
    let mut arc = ArcLength::new(problem, StepControl::default());
    let found = arc.solve_at(&guess, 1.0).unwrap();
    let at = arc.curve.conditions(&found.unknowns);
    PeriodicResponse::of(arc.curve.balance(), arc.curve.closures(), &at, 0)
}

/// Branches over frequency and force, phase resonance and mode of structures with some tens of cells, most of which open or
/// close, against the equations with matrices at every fourth point.
#[test]
fn branches_in_modes_solve_the_equations_with_matrices() {
    let damping = Some(ContactDamping::kelvin_voigt(2e-7).unwrap());
    let smooth = Block { cells: [6, 4], roughness: 0.2, rate: 20.0, ..small() };
    let rough = Block { cells: [6, 4], ..small() };
    let damped = Block { cells: [5, 5], roughness: 0.5, damping, ..small() };
    let mut lost = 0;
    for (block, free) in [(smooth, true), (rough, false), (damped, false)] {
        let system = block.system();
        let near = block.structure().natural_frequency().unwrap();
        let mut paths = vec![
            Continuation::Frequency { force: 8.0, from: 0.8 * near, to: 1.1 * near },
            Continuation::Force { frequency: 0.9 * near, from: 0.5, to: 12.0 },
        ];
        if free {
            paths.push(Continuation::PhaseResonance { near, from: 0.01, to: 0.3 });
            paths.push(Continuation::Mode { near, from: 1e-9, to: 5e-9 });
        }
        let (harmonics, samples) = (9, 144);
        let resolution = FourierResolution::Fixed { harmonics, samples };
        let settings = HarmonicSettings { resolution, ..HarmonicSettings::default() };
        for path in paths {
            let branch = trace(&system, &path, &settings).unwrap();
            assert_eq!(branch.termination, Termination::Reached, "{path:?}");
            for point in branch.points.iter().step_by(4) {
                let value = match path {
                    Continuation::Frequency { .. } => point.frequency_hz(),
                    Continuation::Mode { .. } => point.amplitude(1),
                    _ => point.force,
                };
                let exact = by_matrices(&system, path, (harmonics, samples), (point, value));
                assert_same(point, &exact);
                lost += usize::from(point.contact_lost());
            }
        }
    }
    assert!(lost > 40, "{lost}");
}

fn assert_same(a: &PeriodicResponse, b: &PeriodicResponse) {
    let off = a.closures.iter().zip(&b.closures).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let size = largest(&a.closures);
    assert!(off < 1e-8 * size, "{} Hz: {off:.1e} of {size:.1e}", a.frequency_hz());
    assert!((a.angular_frequency / b.angular_frequency - 1.0).abs() < 1e-9);
    assert!((a.anti_damping - b.anti_damping).abs() <= 1e-7 * b.anti_damping.abs());
    assert!((a.modal_mass / b.modal_mass - 1.0).abs() < 1e-7, "{} {}", a.modal_mass, b.modal_mass);
    for (a, b) in a.sensors.iter().zip(&b.sensors) {
        assert!((a.mean - b.mean).abs() < 1e-8 * size, "{} {}", a.mean, b.mean);
        for (a, b) in a.harmonics.iter().zip(&b.harmonics) {
            assert!((a - b).norm() < 1e-8 * size, "{a} {b}");
        }
    }
    // On springs of other stiffness an estimate.
    assert!(a.truncation < 3.0 * b.truncation && b.truncation < 3.0 * a.truncation);
}

/// Responses of a block over frequency with 9 harmonics.
pub(crate) fn responses(block: &Block, force: f64, stability: Option<Floquet>) -> Branch {
    let near = block.structure().natural_frequency().unwrap();
    let resolution = FourierResolution::Fixed { harmonics: 9, samples: 144 };
    let settings = HarmonicSettings { resolution, stability, ..HarmonicSettings::default() };
    let path = Continuation::Frequency { force, from: 0.85 * near, to: 1.05 * near };
    trace(&block.system(), &path, &settings).unwrap()
}

/// Residual flexibilities that no structure has, of negative energy on the springs: matrices take the place of iterations,
/// up to 2000 unknowns.
#[test]
fn matrices_take_the_place_of_iterations_within_their_bound() {
    const COUNT: usize = 12;
    let law: Arc<dyn ContactLaw> = Arc::new(Power::new(4e9, 0.5, 0.0).unwrap());
    let area = AREA / COUNT as f64;
    let pressure = 1e5;
    let spring = area * law.stiffness(pressure);
    let negative = |i: usize, j: usize| if i == j && i < COUNT { -1.5 / spring } else { 0.0 };
    let row = |i: usize| (0..=COUNT).map(|j| negative(i, j)).collect();
    let rows: Vec<Vec<f64>> = (0..=COUNT).map(row).collect();
    let modes = ComponentModes::new(
        vec![NormalMode::rigid(vec![MASS.sqrt().recip(); COUNT + 1])],
        ResidualFlexibility::from_rows(&rows).unwrap(),
        (0..COUNT).map(PortPair::on_ground).collect(),
        vec![],
    )
    .unwrap();
    let contact = |i: usize| {
        PreloadedContact::new(&format!("cell {i}"), area, Arc::clone(&law), pressure).unwrap()
    };
    let contacts: Vec<PreloadedContact> = (0..COUNT).map(contact).collect();
    let linear = PreloadedStructure::of_components(modes, contacts, Damping::Rate(40.0)).unwrap();
    let system = ContactSystem::of_structure(&linear, LawEvaluation::default()).unwrap();
    let system = system.with_ports(SystemPort::Number(COUNT), &[]).unwrap();
    assert!(system.is_modal() && Balance::of_many(&system, (10, 64), 1.0).is_none());
    let problem = |harmonics: usize| {
        let at = Continuation::Frequency { force: 1.0, from: 300.0, to: 400.0 };
        ContinuationProblem::new(&system, at, harmonics, 4 * harmonics + 2).map(|_| ())
    };
    assert_eq!(problem(10), Ok(()));
    let refused = problem(100).unwrap_err().to_string();
    assert!(refused.contains("not positive definite") && refused.contains("2412"), "{refused}");
}
