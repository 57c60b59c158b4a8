//! The nodes of a table: the law inverted along a grid.

use super::grid::{ClosureGrid, TableRange};
use crate::contact_law::{ContactLaw, Pressure};

/// Relative correction of a [`march`] whose square is below rounding.
const SETTLED: f64 = 1e-7;

/// The increments, with tangents, at `places` in coarse cells above the lowest node, found from
/// the state outwards, each from its neighbour.
pub(super) fn nodes(
    law: &dyn ContactLaw,
    state: f64,
    range: &TableRange,
    grid: &ClosureGrid,
    places: &[f64],
) -> Vec<Pressure> {
    let below = grid.below as f64;
    let at_state = places.partition_point(|place| *place < below);
    let node = |place: f64, from: f64, last: Option<Pressure>| {
        if place == 0.0 && range.separates {
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

/// The pressure increment \[Pa\] over a closure increment `x` \[m\] of either sign from `pressure`
/// \[Pa\], with the tangent there: a Runge-Kutta step of `dp/dx = K(p)`, corrected by Newton steps
/// on the closure, which is far cheaper than inverting a law without a closed inverse. `None` where
/// pressure or stiffness is not positive, or two corrections do not suffice.
pub(super) fn march(law: &dyn ContactLaw, pressure: f64, x: f64) -> Option<Pressure> {
    let k1 = law.stiffness(pressure);
    let k2 = law.stiffness(pressure + 0.5 * x * k1);
    let k3 = law.stiffness(pressure + 0.5 * x * k2);
    let k4 = law.stiffness(pressure + x * k3);
    let mut increment = x * (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
    for _ in 0..2 {
        let reached = pressure + increment;
        // A step down by more than half of the pressure is too coarse next to zero.
        if !(pressure > 0.0 && k1 > 0.0 && increment.is_finite() && reached > 0.5 * pressure) {
            return None;
        }
        let off = law.stiffness(reached) * (x - law.closure_increment(pressure, increment));
        increment += off;
        // The remaining error is of the order of the square, times the curvature of the law.
        if off.abs() <= SETTLED * increment.abs() {
            return Some(Pressure {
                value: increment,
                tangent: law.stiffness(pressure + increment),
            });
        }
    }
    None
}
