//! Two long bars on one interface: half-spaces until an end reflects.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_dynamics::{FiniteDifference, InterfaceHistory, Modal, Transient};
use asperity_mesh::{Body, Interface, Stack, Support};
use asperity_structure::{LoadCase, TimeFunction};

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
pub fn run(stack: &Stack, cells: usize, excitation: &LoadCase, crossings: f64) -> Transient {
    let cell = LENGTH / cells as f64;
    let rate = wave_speed() / (COURANT * cell);
    // A hair more than the Courant number meant, so that one step fills a sample.
    let method =
        FiniteDifference { cell, courant: COURANT * (1.0 + 1e-9), ..FiniteDifference::default() };
    let transient = run_at(stack, &method, 0.0, excitation, (crossings * delay(), rate));
    assert_eq!(transient.steps, transient.history.time.len());
    transient
}

/// An undamped run with `modes` of each bar at `step` [s], over `crossings` times the delay,
/// sampled every step.
pub fn modal_run(
    stack: &Stack,
    (modes, step): (usize, f64),
    excitation: &LoadCase,
    crossings: f64,
) -> Transient {
    let method = Modal { step: Some(step), modes_per_body: Some(modes), ..Modal::default() };
    run_at(stack, &method, 0.0, excitation, (crossings * delay(), 1.0 / step))
}

/// Pulse duration [s]: half a metre of wave, a quarter of the window.
pub const PULSE: f64 = 1e-4;

/// A pulse whose incident pressure peaks at `pressure` [Pa].
pub fn pulse(pressure: f64) -> LoadCase {
    LoadCase::force(TimeFunction::Haversine { duration: PULSE }, pressure * AREA)
}

/// Samples of the interface from the arrival of the wave to its first echo, and
/// their times after arrival [s].
pub fn window(transient: &Transient) -> (Vec<f64>, InterfaceHistory) {
    let history = &transient.history;
    let arrival = history.time.iter().position(|&t| t >= delay()).unwrap();
    let end = history.time.iter().position(|&t| t >= 2.9 * delay()).unwrap();
    let cut = |column: &[f64]| column[arrival..end].to_vec();
    let times = history.time[arrival..end].iter().map(|t| t - delay()).collect();
    let interface = &history.interfaces[0];
    let samples = InterfaceHistory {
        pressure: cut(&interface.pressure),
        closure: cut(&interface.closure),
        stiffness: cut(&interface.stiffness),
    };
    (times, samples)
}

/// `sqrt(sum (a - b)^2 / sum b^2)`.
pub fn relative_norm(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let off: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (off / b.iter().map(|b| b * b).sum::<f64>()).sqrt()
}

/// `f * alpha exp(-alpha t)` for `f = sin^2(pi t / T)` on `0 < t < T`.
pub fn transmitted_haversine(alpha: f64, time: f64) -> f64 {
    let w = TAU / PULSE;
    let during = |t: f64| {
        let forced = alpha * (alpha * (w * t).cos() + w * (w * t).sin());
        let free = alpha * alpha * (-alpha * t).exp();
        0.5 * (1.0 - (-alpha * t).exp() - (forced - free) / (alpha * alpha + w * w))
    };
    if time <= PULSE { during(time) } else { during(PULSE) * (-alpha * (time - PULSE)).exp() }
}
