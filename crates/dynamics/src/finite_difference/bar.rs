//! The nodes of one body, and Eq. (4) over them.

use asperity_mesh::BarGrid;

/// Partial sums of a sum over nodes: a compiler may not reorder additions, but may carry these out
/// side by side.
const PARTS: usize = 8;

/// Displacements of the nodes of a body from rest at three successive states, the first node at its top.
///
/// The functions that each step calls are written into the loop over time, and so compiled for each set of
/// vector instructions. No operation is contracted or reordered: the numbers are the same on all of them.
pub(super) struct Bar {
    /// Displacements \[m\] at the state that the latest step reached, and one and two steps earlier.
    next: Vec<f64>,
    now: Vec<f64>,
    before: Vec<f64>,
    /// Coefficients of Eq. (4) for the node, its neighbours, and its past.
    own: f64,
    neighbour: f64,
    past: f64,
    /// Coefficient of the neighbours' past, from the internal damping; zero without it.
    viscous: f64,
    /// Displacement per acceleration and step, `dt^2 / (1 + a2)` \[s2\].
    response: f64,
    /// Displacement of an end per force on it and step, `dt^2 / (m_end (1 + a2))` \[m/N\].
    pub(super) end_compliance: f64,
    cell_mass: f64,
    cell_stiffness: f64,
    retardation_time: f64,
    step: f64,
}

impl Bar {
    /// The nodes of `grid` at rest, for steps of `step` \[s\] under the damping `rate` \[1/s\].
    pub(super) fn new(grid: &BarGrid, step: f64, rate: f64) -> Self {
        let rest = || vec![0.0; grid.nodes()];
        let a1 = (step / grid.crossing_time()).powi(2);
        let a2 = rate * step;
        // a1 (b / dt) times the second differences of w - w- belongs to Eq. (4) with E (1 + b d/dt).
        let viscous = a1 * grid.retardation_time() / (step * (1.0 + a2));
        Self {
            next: rest(),
            now: rest(),
            before: rest(),
            own: (2.0 * (1.0 - a1) + a2) / (1.0 + a2) - 2.0 * viscous,
            neighbour: a1 / (1.0 + a2) + viscous,
            past: -1.0 / (1.0 + a2) + 2.0 * viscous,
            viscous,
            response: step * step / (1.0 + a2),
            end_compliance: step * step / (grid.end_mass() * (1.0 + a2)),
            cell_mass: grid.cell_mass(),
            cell_stiffness: grid.cell_stiffness(),
            retardation_time: grid.retardation_time(),
            step,
        }
    }

    /// A step by Eq. (4) of all nodes under `acceleration` \[m/s2\], the same for all, without forces.
    #[inline(always)]
    pub(super) fn advance(&mut self, acceleration: f64) {
        std::mem::swap(&mut self.before, &mut self.now);
        std::mem::swap(&mut self.now, &mut self.next);
        let push = self.response * acceleration;
        eq4(&mut self.next, &self.now, &self.before, [self.own, self.neighbour, self.past, push]);
        if self.viscous > 0.0 {
            damp(&mut self.next, &self.before, self.viscous);
        }
    }

    /// Adds what `force` \[N\] on a node does in this step.
    #[inline(always)]
    pub(super) fn push(&mut self, node: usize, force: f64) {
        let at_end = node == 0 || node == self.last();
        self.next[node] += force * if at_end { 1.0 } else { 0.5 } * self.end_compliance;
    }

    /// Number of the last node.
    pub(super) fn last(&self) -> usize {
        self.next.len() - 1
    }

    /// Displacements of a node \[m\] at the state reached, and one and two steps earlier.
    pub(super) fn states(&self, node: usize) -> [f64; 3] {
        [self.next[node], self.now[node], self.before[node]]
    }

    /// Mass \[kg\].
    pub(super) fn mass(&self) -> f64 {
        self.last() as f64 * self.cell_mass
    }

    /// Displacement of the centre of mass at the state reached \[m\].
    #[inline(always)]
    pub(super) fn mean(&self) -> f64 {
        self.mean_of(&self.next)
    }

    /// Travel of the centre of mass \[m\] over the last two steps.
    #[inline(always)]
    pub(super) fn travel(&self) -> f64 {
        self.mean_of(&self.next) - self.mean_of(&self.before)
    }

    #[inline(always)]
    fn mean_of(&self, state: &[f64]) -> f64 {
        let ends = state[0] + state[self.last()];
        (sum(state, state, |w, _| w) - 0.5 * ends) / self.last() as f64
    }

    /// Viscous power \[W\] half a step before the state reached, under the damping `rate` \[1/s\]; that
    /// of the internal damping is the retardation time times the stretching rates squared times the
    /// stiffness of the cells.
    #[inline(always)]
    pub(super) fn viscous_power(&self, rate: f64) -> f64 {
        let mut power = 2.0 * rate * self.kinetic_energy();
        if self.retardation_time > 0.0 {
            let stretches = self.next.windows(2).zip(self.now.windows(2));
            let squares =
                stretches.map(|(next, now)| ((next[1] - next[0]) - (now[1] - now[0])).powi(2));
            power += self.retardation_time * self.cell_stiffness * squares.sum::<f64>()
                / (self.step * self.step);
        }
        power
    }

    /// Kinetic energy \[J\] half a step before the state reached.
    #[inline(always)]
    pub(super) fn kinetic_energy(&self) -> f64 {
        let square = |next: f64, now: f64| (next - now) * (next - now);
        let end = |node: usize| square(self.next[node], self.now[node]);
        let sum = sum(&self.next, &self.now, square) - 0.5 * (end(0) + end(self.last()));
        0.5 * self.cell_mass * sum / (self.step * self.step)
    }

    /// Elastic energy \[J\] half a step before the state reached: with the kinetic energy the sum that
    /// the undamped scheme conserves exactly.
    pub(super) fn elastic_energy(&self) -> f64 {
        let stretches = self.next.windows(2).zip(self.now.windows(2));
        let products = stretches.map(|(next, now)| (next[1] - next[0]) * (now[1] - now[0]));
        0.5 * self.cell_stiffness * products.sum::<f64>()
    }
}

/// Sum over all nodes of a term of their displacements at two states.
#[inline(always)]
fn sum(one: &[f64], other: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    let (one, one_rest) = one.as_chunks::<PARTS>();
    let (other, other_rest) = other.as_chunks::<PARTS>();
    let mut parts = [0.0; PARTS];
    for (one, other) in one.iter().zip(other) {
        for i in 0..PARTS {
            parts[i] += term(one[i], other[i]);
        }
    }
    let rest = one_rest.iter().zip(other_rest).map(|(one, other)| term(*one, *other));
    parts.iter().sum::<f64>() + rest.sum::<f64>()
}

/// Eq. (4) for all nodes. Beyond a free end lies the mirror image of the node next to it.
#[inline(always)]
fn eq4(next: &mut [f64], now: &[f64], before: &[f64], [own, neighbour, past, push]: [f64; 4]) {
    let last = next.len() - 1;
    next[0] = own * now[0] + 2.0 * neighbour * now[1] + past * before[0] + push;
    next[last] = own * now[last] + 2.0 * neighbour * now[last - 1] + past * before[last] + push;
    let (left, middle, right) = (&now[..last - 1], &now[1..last], &now[2..=last]);
    let (next, before) = (&mut next[1..last], &before[1..last]);
    for i in 0..next.len() {
        next[i] = own * middle[i] + neighbour * (left[i] + right[i]) + past * before[i] + push;
    }
}

/// The part of the internal damping in Eq. (4) that the past of the neighbours has.
#[inline(always)]
fn damp(next: &mut [f64], before: &[f64], viscous: f64) {
    let n = next.len();
    assert!(n >= 2 && before.len() == n);
    next[0] -= 2.0 * viscous * before[1];
    for i in 1..n - 1 {
        next[i] -= viscous * (before[i - 1] + before[i + 1]);
    }
    next[n - 1] -= 2.0 * viscous * before[n - 2];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InstructionSet;
    use asperity_law::Constant;
    use asperity_mesh::{Body, BodyDamping, Grid, Interface, Stack, Support};
    use std::sync::Arc;

    /// Displacements and energies are the same on every instruction set, to the last bit.
    #[test]
    fn every_instruction_set_gives_the_same_numbers() {
        let law = Arc::new(Constant::new(1e12).unwrap());
        let bodies = [0.229, 0.015, 1e-3].map(|length| {
            let body = Body::new("body", length, 1e-4, 71e9, 2710.0).unwrap();
            body.with_damping(BodyDamping::kelvin_voigt(1e-9).unwrap())
        });
        for body in bodies {
            let contact = Interface::new("contact", 1e-4, law.clone()).unwrap();
            let stack = Stack::new(vec![body], vec![contact], Support::Rigid, 9.81).unwrap();
            let grid = Grid::new(&stack, 1e-3).unwrap();
            let (step, _) = grid.step_within(5e-6, 0.95).unwrap();
            let march = || {
                let mut bar = Bar::new(&grid.bars()[0], step, 352.0);
                for n in 0..200 {
                    bar.advance(9.81);
                    bar.push(n % 2, f64::from(n as u8).sin());
                }
                let states: Vec<_> = (0..=bar.last()).map(|node| bar.states(node)).collect();
                let energy = [bar.kinetic_energy(), bar.elastic_energy()];
                (states, energy, bar.viscous_power(352.0), bar.mean())
            };
            let sets = InstructionSet::available();
            let on = |set: &InstructionSet| set.arch().unwrap().dispatch(march);
            let outcomes: Vec<_> = sets.iter().map(on).collect();
            assert!(outcomes.iter().all(|outcome| *outcome == outcomes[0]));
            assert!(outcomes[0].1[0] > 0.0);
        }
    }
}
