//! The paper's rig under a hit, and the peaks of its response.

use asperity_dynamics::{Integrator, Transient};
use asperity_mesh::Stack;

use super::receptance::{Peak, peak};
use super::{Law, at_rest, pulse, rig, run};

const DURATION: f64 = 0.12;

pub struct Response {
    pub transient: Transient,
    pub first: Peak,
    pub second: Option<Peak>,
}

/// The response at `force` [N], with its fundamental in 0.4 to 1.4 of the
/// static frequency and its second harmonic in 1.5 to 2.3 of the fundamental.
pub fn respond(law: &Law, force: f64, method: &(impl Into<Integrator> + Copy)) -> Response {
    respond_on(&rig(law), force, method)
}

/// As [`respond`], of any stack.
pub fn respond_on(stack: &Stack, force: f64, method: &(impl Into<Integrator> + Copy)) -> Response {
    let at_rest = at_rest(stack).natural_frequency().unwrap();
    let transient = run(stack, method, &pulse(force), DURATION);
    let first = peak(&transient.history, (0.4 * at_rest, 1.4 * at_rest)).unwrap();
    let second = peak(&transient.history, (1.5 * first.frequency, 2.3 * first.frequency));
    Response { transient, first, second }
}

/// Prints what was found and holds it to a relative tolerance.
pub fn close(found: f64, value: f64, tolerance: f64, what: &str) {
    assert!((found / value - 1.0).abs() < tolerance, "{what}: {found} for {value}");
}
