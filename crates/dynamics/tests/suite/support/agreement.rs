//! Modal steps against finite differences.

use asperity_dynamics::{DynamicsError, FiniteDifference, Integrator, Modal, Sampling, Transient};
use asperity_mesh::{Port, Stack};
use asperity_structure::{Damping, LoadCase, PreloadedStructure};

use super::difference;

/// Damping [1/s].
pub const RATE: f64 = 300.0;

/// A run at 200 kHz, or why there is none.
pub fn attempt(
    stack: &Stack,
    method: impl Into<Integrator>,
    excitation: &LoadCase,
    duration: f64,
) -> Result<Transient, DynamicsError> {
    let structure = PreloadedStructure::new(stack.clone(), Damping::Rate(RATE)).unwrap();
    let sampling = Sampling::new(duration, 2e5).unwrap();
    method.into().integrate(&structure, excitation, &[Port::TOP], &sampling)
}

/// Differences of displacement and of closures over their largest motions.
pub fn off(found: &Transient, expected: &Transient) -> (f64, f64) {
    let gained = |column: &[f64]| column.iter().map(|x| x - column[0]).collect::<Vec<_>>();
    let pairs = found.history.interfaces.iter().zip(&expected.history.interfaces);
    let closures = pairs.map(|(a, b)| difference(&gained(&a.closure), &gained(&b.closure)));
    let displacement = difference(
        &found.history.sensors[0].displacement,
        &expected.history.sensors[0].displacement,
    );
    (displacement, closures.fold(0.0, f64::max))
}

/// The default modal steps against finite differences of `cell` [m].
pub fn agrees(
    name: &str,
    stack: &Stack,
    excitation: &LoadCase,
    (duration, cell): (f64, f64),
    bounds: (f64, f64),
) {
    let modal = attempt(stack, Modal::default(), excitation, duration).unwrap();
    let grid = FiniteDifference { cell, ..FiniteDifference::default() };
    let grid = attempt(stack, grid, excitation, duration).unwrap();
    let found = off(&modal, &grid);
    assert!(found.0 < bounds.0 && found.1 < bounds.1, "{name}: {found:?}");
}
