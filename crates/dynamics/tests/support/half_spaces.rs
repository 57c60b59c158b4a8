//! Two long bars on one interface: half-spaces until an end reflects.

use std::sync::Arc;

use asperity_dynamics::{Excitation, FiniteDifference, Transient};
use asperity_mesh::{Body, Interface, Stack, Support};

use super::{AREA, Law, constant, run_at};

/// Length of each bar [m].
pub const LENGTH: f64 = 1.0;
const MODULUS: f64 = 71e9;
const DENSITY: f64 = 2710.0;

/// Courant number of all runs: far from 1, where the scheme's dispersion would
/// vanish and hide the order of the rest.
pub const COURANT: f64 = 0.5;

/// Wave speed [m/s].
pub fn wave_speed() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

/// Impedance per area, rho c [Pa s/m].
pub fn impedance() -> f64 {
    DENSITY * wave_speed()
}

/// Time from the top to the interface [s].
pub fn delay() -> f64 {
    LENGTH / wave_speed()
}

/// The bars, with gravity such that `law` carries `pressure` [Pa] at rest.
pub fn stack(law: &Law, pressure: f64) -> Stack {
    let bar = |name| Body::new(name, LENGTH, AREA, MODULUS, DENSITY).unwrap();
    Stack::new(
        vec![bar("above"), bar("below")],
        vec![
            Interface::new("interface", AREA, Arc::clone(law)).unwrap(),
            Interface::new("far end", AREA, constant()).unwrap(),
        ],
        Support::Rigid,
        pressure / (DENSITY * LENGTH),
    )
    .unwrap()
}

/// An undamped run on `cells` cells a bar, every step recorded, over `crossings`
/// times the delay. The first echo returns to the interface after three.
pub fn run(stack: &Stack, cells: usize, excitation: &Excitation, crossings: f64) -> Transient {
    let cell = LENGTH / cells as f64;
    let rate = wave_speed() / (COURANT * cell);
    // A hair more than the Courant number meant, so that one step fills a sample.
    let method =
        FiniteDifference { cell, courant: COURANT * (1.0 + 1e-9), ..FiniteDifference::default() };
    let transient = run_at(stack, &method, 0.0, excitation, (crossings * delay(), rate));
    assert_eq!(transient.steps, transient.history.time.len());
    transient
}
