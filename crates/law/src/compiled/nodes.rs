//! The nodes of a table: the law inverted along a grid.

use super::span::{Grid, Span};
use crate::law::{ContactLaw, Pressure};

/// Relative correction of a [`march`] after which the next, of the order of its square, is below
/// rounding.
const SETTLED: f64 = 1e-7;

/// The increments, with tangents, at `places` in coarse cells above the lowest node, found from
/// the state outwards, each from its neighbour.
pub(super) fn nodes(
    law: &dyn ContactLaw,
    state: f64,
    span: &Span,
    grid: &Grid,
    places: &[f64],
) -> Vec<Pressure> {
    let below = grid.below as f64;
    let at_state = places.partition_point(|place| *place < below);
    let node = |place: f64, from: f64, last: Option<Pressure>| {
        if place == 0.0 && span.separates {
            return Pressure { value: 0.0 - state, tangent: law.stiffness(0.0) };
        }
        let near = last.and_then(|last| {
            let at = march(law, state + last.value, (place - from) * grid.width)?;
            Some(Pressure { value: last.value + at.value, ..at })
        });
        near.unwrap_or_else(|| law.pressure_increment(state, grid.closure(place)))
    };
    let mut nodes = vec![Pressure::OPEN; places.len()];
    let mut last = None;
    for i in at_state..places.len() {
        let found = node(places[i], if i > 0 { places[i - 1] } else { 0.0 }, last);
        nodes[i] = if places[i] == below { Pressure { value: 0.0, ..found } } else { found };
        last = Some(nodes[i]);
    }
    let mut last = nodes.get(at_state).copied();
    for i in (0..at_state).rev() {
        let from = places.get(i + 1).copied().unwrap_or(below);
        nodes[i] = node(places[i], from, last);
        last = Some(nodes[i]);
    }
    nodes
}

/// The pressure gained \[Pa\] over a further closure `x` \[m\], of either sign, from `pressure` \[Pa\],
/// with the tangent there: a step of Runge and Kutta on `dp/dx = K(p)`, corrected by Newton on the
/// closure it takes, which for a law without a closed inverse is far cheaper than inverting it.
/// `None` where pressure or stiffness is not positive, or the step is too far off for one or two
/// corrections.
pub(super) fn march(law: &dyn ContactLaw, pressure: f64, x: f64) -> Option<Pressure> {
    let k1 = law.stiffness(pressure);
    let k2 = law.stiffness(pressure + 0.5 * x * k1);
    let k3 = law.stiffness(pressure + 0.5 * x * k2);
    let k4 = law.stiffness(pressure + x * k3);
    let mut gained = x * (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
    for _ in 0..2 {
        let reached = pressure + gained;
        // Beyond half of the pressure down, a step is too coarse for what comes next to zero.
        if !(pressure > 0.0 && k1 > 0.0 && gained.is_finite() && reached > 0.5 * pressure) {
            return None;
        }
        let off = law.stiffness(reached) * (x - law.closure_increment(pressure, gained));
        gained += off;
        // What is left is of the order of the square, times the bend of the law.
        if off.abs() <= SETTLED * gained.abs() {
            return Some(Pressure { value: gained, tangent: law.stiffness(pressure + gained) });
        }
    }
    None
}
