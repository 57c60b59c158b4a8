//! Exact result 7: the rig in other consistent units gives the same dimensionless answers.

use std::sync::Arc;

use crate::support::{AREA, Law, difference};
use asperity_dynamics::{FiniteDifference, Integrator, Modal, Sampling, Transient};
use asperity_law::{Constant, Exponential, ModifiedPower, Power};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

/// Number of new units in one metre, one second, one kilogram.
#[derive(Debug, Clone, Copy)]
struct Units {
    length: f64,
    time: f64,
    mass: f64,
}

impl Units {
    fn force(self) -> f64 {
        self.mass * self.length / (self.time * self.time)
    }

    fn pressure(self) -> f64 {
        self.force() / (self.length * self.length)
    }
}

const SI: Units = Units { length: 1.0, time: 1.0, mass: 1.0 };

#[derive(Debug, Clone, Copy)]
enum Kind {
    Constant,
    Power,
    Modified,
    Exponential,
}

fn law(kind: Kind, units: Units) -> Law {
    let p = units.pressure();
    let k = p / units.length;
    // C has the unit of a pressure to the 1 - m, per length.
    let c = 1.81e10 * p.powf(0.65) / units.length;
    match kind {
        Kind::Constant => Arc::new(Constant::new(8.5e11 * k).unwrap()),
        Kind::Power => Arc::new(Power::new(c, 0.35, 0.0).unwrap()),
        Kind::Modified => {
            let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)]
                .map(|(pressure, stiffness)| (pressure * p, stiffness * k));
            Arc::new(ModifiedPower::new(c, 0.35, 2e5 * p, &knots).unwrap())
        }
        Kind::Exponential => Arc::new(Exponential::new(1.4e-7 * units.length, 1.4e5 * p).unwrap()),
    }
}

fn rig(kind: Kind, units: Units) -> Stack {
    let law = law(kind, units);
    let Units { length, time, mass } = units;
    let area = AREA * length * length;
    let modulus = 71e9 * units.pressure();
    let density = 2710.0 * mass / length.powi(3);
    Stack::new(
        vec![
            Body::with_mass("guide bar", 0.229 * length, 1.61 * mass, modulus, density).unwrap(),
            Body::new("sample", 0.015 * length, area, modulus, density).unwrap(),
        ],
        vec![
            Interface::new("guide-sample", area, Arc::clone(&law)).unwrap(),
            Interface::new("sample-disc", area, law).unwrap(),
        ],
        Support::SpringMass {
            stiffness: 1e9 * units.force() / length,
            mass: 40.0 * mass,
            damping_ratio: 0.02,
        },
        9.81 * length / (time * time),
    )
    .unwrap()
}

fn response(kind: Kind, units: Units, method: &Integrator) -> Transient {
    let structure = PreloadedStructure::new(rig(kind, units), Damping::Ratio(0.035)).unwrap();
    let pulse = LoadCase::force(
        TimeFunction::GammaPulse { rise: 0.34e-3 * units.time },
        32.0 * units.force(),
    );
    let sampling = Sampling::new(0.02 * units.time, 2e5 / units.time).unwrap();
    method.integrate(&structure, &pulse, &[Port::TOP], &sampling).unwrap()
}

/// Centimetre-gram-second; millimetre-tonne-second, the engineer's newton and megapascal;
/// millimetre, millisecond, kilogram (gigapascal, kilonewton); and a system of large pressures.
const SYSTEMS: [(&str, Units); 4] = [
    ("cm g s", Units { length: 1e2, time: 1.0, mass: 1e3 }),
    ("mm t s", Units { length: 1e3, time: 1.0, mass: 1e-3 }),
    ("mm kg ms", Units { length: 1e3, time: 1e3, mass: 1.0 }),
    ("mm g min", Units { length: 1e3, time: 1.0 / 60.0, mass: 1e3 }),
];

/// Frequencies and static state scale exactly, to round-off.
#[test]
fn equilibrium_and_modes_do_not_depend_on_units() {
    for kind in [Kind::Constant, Kind::Power, Kind::Modified, Kind::Exponential] {
        let of = |units: Units| {
            let damping = Damping::Rate(352.0 / units.time);
            let structure = PreloadedStructure::new(rig(kind, units), damping).unwrap();
            let found = structure.modes(4).unwrap();
            let mut numbers: Vec<f64> =
                found.iter().map(|mode| mode.frequency_hz * units.time).collect();
            numbers.extend(found.iter().map(|mode| mode.damping_ratio));
            numbers.extend(structure.contacts().iter().map(|c| c.closure() / units.length));
            let faces = structure.static_displacement().faces;
            numbers.extend(faces.iter().map(|face| face.0 / units.length));
            numbers
        };
        let reference = of(SI);
        for (name, units) in SYSTEMS {
            for (a, b) in of(units).iter().zip(&reference) {
                assert!((a - b).abs() <= 1e-11 * b.abs(), "{kind:?} in {name}: {a} {b}");
            }
        }
    }
}

/// Finite differences at 1 mm and modal steps of 5 us.
fn methods(units: Units) -> [Integrator; 2] {
    let grid = FiniteDifference { cell: 1e-3 * units.length, ..FiniteDifference::default() };
    [grid.into(), Modal { step: Some(5e-6 * units.time), ..Modal::default() }.into()]
}

/// Whole responses scale, contact loss included. Round-off grows along 1e5
/// steps, and tables in other units are other roundings: 1e-9. The tables of modal steps reach a
/// power of two of the unit of pressure, and so err otherwise by up to 1e-5 of the static pressure.
#[test]
fn responses_do_not_depend_on_units() {
    let mut failures = Vec::new();
    for kind in [Kind::Constant, Kind::Power, Kind::Modified, Kind::Exponential] {
        for (which, tolerance) in [(0, 1e-9), (1, 2e-4)] {
            let reference = response(kind, SI, &methods(SI)[which]);
            let scaled = |column: &[f64], unit: f64| -> Vec<f64> {
                column.iter().map(|value| value / unit).collect()
            };
            for (name, units) in SYSTEMS {
                let run = response(kind, units, &methods(units)[which]);
                assert_eq!(run.steps, reference.steps);
                let offs = [
                    difference(
                        &scaled(&run.history.sensors[0].displacement, units.length),
                        &reference.history.sensors[0].displacement,
                    ),
                    difference(
                        &scaled(&run.history.interfaces[0].pressure, units.pressure()),
                        &reference.history.interfaces[0].pressure,
                    ),
                    (run.energy.input / (units.force() * units.length) / reference.energy.input
                        - 1.0)
                        .abs(),
                    (run.contacts[0].pressure_max
                        / units.pressure()
                        / reference.contacts[0].pressure_max
                        - 1.0)
                        .abs(),
                ];
                if !offs.iter().all(|off| *off < tolerance) {
                    failures.push((kind, name, which, offs));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}
