//! Structures with many contacts: equations in modes against equations with matrices.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use asperity_law::{ContactDamping, ContactLaw, Power};
use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
use asperity_structure::{Damping, PreloadedStructure, UnloadedContact, contacts_at_rest};

use crate::arc_length::{ArcLength, Curve, CurvePoint};
use crate::balance::{Balance, Conditions};
use crate::continuation_problem::ContinuationProblem;
use crate::{
    ContactSystem, Continuation, FourierResolution, HarmonicSettings, LawEvaluation,
    PeriodicResponse, SpecialPointKind, StepControl, SystemPort, Termination, trace,
};

/// A block on a grid of cells: heave, two rocking motions, elastic modes, a flexibility about each cell, gaps that leave
/// some cells open at rest, a load near a corner and sensors. A motion along the ground is free.
pub(crate) struct Block {
    pub(crate) cells: [usize; 2],
    pub(crate) elastic: usize,
    /// Share of the length of a cell that gaps are of, in closures at rest.
    pub(crate) roughness: f64,
    pub(crate) damping: Option<ContactDamping>,
    pub(crate) retardation: f64,
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
        let at_rest = contacts_at_rest(&modes, &contacts, &[(count, 120.0), (0, 130.0)]).unwrap();
        PreloadedStructure::of_components(modes, at_rest, Damping::Rate(60.0)).unwrap()
    }

    pub(crate) fn system(&self) -> ContactSystem {
        let count = self.cells[0] * self.cells[1];
        let system = ContactSystem::of_structure(&self.structure(), LawEvaluation::Exact).unwrap();
        let sensors = [count + 1, count + 2].map(SystemPort::Number);
        system.with_ports(SystemPort::Number(count), &sensors).unwrap()
    }
}

#[test]
#[ignore]
fn measure() {
    let side: usize = std::env::var("SIDE").unwrap().parse().unwrap();
    let harmonics: usize = std::env::var("H").unwrap().parse().unwrap();
    let force: f64 = std::env::var("F").unwrap().parse().unwrap();
    let block = Block {
        cells: [side, side],
        elastic: 40,
        roughness: 1.5,
        damping: None,
        retardation: 1e-7,
    };
    let structure = block.structure();
    let f = structure.natural_frequency().unwrap();
    let open = structure.contacts().iter().filter(|c| c.gap() > 0.0).count();
    println!("f1 {f}, {open} open of {}", side * side);
    let t = std::time::Instant::now();
    let system = block.system();
    println!("system {:?}", t.elapsed());
    let resolution = FourierResolution::Fixed { harmonics, samples: 16 * harmonics };
    let stability = std::env::var("FLOQUET").ok().map(|_| crate::Floquet::default());
    let settings = HarmonicSettings { resolution, stability, ..HarmonicSettings::default() };
    let sweep = Continuation::Frequency { force, from: 0.7 * f, to: 1.15 * f };
    let t = std::time::Instant::now();
    let branch = trace(&system, &sweep, &settings).unwrap();
    let e = t.elapsed().as_secs_f64();
    let n = branch.points.len();
    let lost = branch.points.iter().filter(|p| p.contact_lost()).count();
    println!(
        "{:?} {n} points, {lost} with loss, {:.3} s, {:.4} s a point; its {:.2}",
        branch.termination,
        e,
        e / n as f64,
        branch.points.iter().map(|p| p.iterations).sum::<usize>() as f64 / n as f64
    );
    for s in &branch.special {
        println!("{:?} {} Hz {:e}", s.kind, s.response.frequency_hz(), s.response.amplitude(1));
    }
}
