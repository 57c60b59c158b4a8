//! The law that a table is made of, inverted at many closures.

use super::grid::{ClosureGrid, TableRange};
use crate::contact_law::{ContactLaw, INTERPOLATION_ERROR, Pressure};

/// Least error of a table over the error of its nodes.
const FINER: f64 = 100.0;

/// A law about a state.
pub(super) struct Source<'a> {
    pub(super) law: &'a dyn ContactLaw,
    pub(super) state: f64,
    /// Closure of the state \[m\], if pressures interpolated by the law are exact enough.
    closure: Option<f64>,
}

impl<'a> Source<'a> {
    /// The law about `state` for a table up to `top` \[Pa\] with errors of `limit` \[Pa\].
    pub(super) fn new(law: &'a dyn ContactLaw, (state, top): (f64, f64), limit: f64) -> Self {
        let is_coarse = limit >= FINER * INTERPOLATION_ERROR * top.abs();
        let is_interpolated = is_coarse && law.interpolate(&[], &mut Vec::new());
        let closure = is_interpolated.then(|| law.closure(state));
        Self { law, state, closure }
    }

    /// True if the law gives pressures that are interpolated.
    pub(super) fn is_interpolated(&self) -> bool {
        self.closure.is_some()
    }

    /// Pressure increments at closure increments from the state, interpolated; `false` without such.
    pub(super) fn interpolate(&self, increments: &mut [f64], found: &mut Vec<Pressure>) -> bool {
        let Some(closure) = self.closure else { return false };
        for x in increments.iter_mut() {
            *x += closure;
        }
        let is_found = self.law.interpolate(increments, found);
        for at in found.iter_mut() {
            at.value -= self.state;
        }
        is_found
    }

    /// The increments, with tangents, at `places` in coarse cells above the lowest node.
    pub(super) fn nodes(
        &self,
        range: &TableRange,
        grid: &ClosureGrid,
        places: &[f64],
    ) -> Vec<Pressure> {
        let mut closures: Vec<f64> = places.iter().map(|&place| grid.closure(place)).collect();
        let mut nodes = Vec::with_capacity(places.len());
        if !self.interpolate(&mut closures, &mut nodes) {
            return self.neighbours(range, grid, places);
        }
        let below = grid.below as f64;
        if let Ok(at) = places.binary_search_by(|place| place.total_cmp(&below)) {
            nodes[at] = Pressure { value: 0.0, tangent: self.law.stiffness(self.state) };
        }
        if let (Some(first), true) = (nodes.first_mut(), range.separates && places[0] == 0.0) {
            *first = self.lost();
        }
        nodes
    }

    /// The node at loss of contact.
    fn lost(&self) -> Pressure {
        Pressure { value: 0.0 - self.state, tangent: self.law.stiffness(0.0) }
    }

    /// The nodes from the state outwards, each from its neighbour.
    fn neighbours(&self, range: &TableRange, grid: &ClosureGrid, places: &[f64]) -> Vec<Pressure> {
        let (law, state) = (self.law, self.state);
        let below = grid.below as f64;
        let at_state = places.partition_point(|place| *place < below);
        let node = |place: f64, from: f64, last: Option<Pressure>| {
            if place == 0.0 && range.separates {
                return self.lost();
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
}
