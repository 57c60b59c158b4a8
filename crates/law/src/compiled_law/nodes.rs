//! The nodes of a table: the law inverted along a grid.

use super::grid::{ClosureGrid, TableRange};
use crate::contact_law::{ContactLaw, Pressure};

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
            let at = law.pressure_step(state + last.value, (place - from) * grid.width)?;
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
