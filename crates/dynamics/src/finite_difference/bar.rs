//! One body's nodes in vector lanes.
//!
//! Lane `l` of `W` lanes holds the nodes `l V .. (l + 1) V`, where `V` is the
//! number of vectors: the neighbours of all nodes of vector `i` are then the
//! vectors `i - 1` and `i + 1`, already in registers during the sweep, and only
//! the first and last vector need a lane rotation. A sweep costs two loads, one
//! store, an addition and three multiply-adds per vector; no load is unaligned.
//! The grid makes the node count a multiple of every `W`, so the first node is
//! the first lane of the first vector and the last the last of the last. Internal damping costs two
//! loads and two operations more.
//!
//! The two states of the leapfrog lie in two buffers. Step number `m` reads
//! buffer `m % 2` and overwrites the other; the parity is a constant of the
//! code, so that no pointer changes hands between steps.
//!
//! The end nodes are kept as numbers as well: their update is what the contact
//! solve waits for, and it must not wait for a vector to be stored and read back.

use asperity_mesh::BarGrid;
use pulp::Simd;

use super::lanes::{Lanes, numbers};

/// Storage of one body's two states and of the share of its nodes in the kinetic energy.
pub(super) struct BarStorage {
    even: Lanes,
    odd: Lanes,
    share: Lanes,
}

impl BarStorage {
    pub(super) fn new(grid: &BarGrid) -> Self {
        let zeros = || Lanes::zeros(grid.nodes());
        Self { even: zeros(), odd: zeros(), share: zeros() }
    }
}

pub(super) struct Bar<'r, S: Simd> {
    even: &'r mut [S::f64s],
    odd: &'r mut [S::f64s],
    /// Coefficients of Eq. (4) for the node, its neighbours, and its past.
    own: f64,
    neighbour: f64,
    past: f64,
    /// Coefficient of the neighbours' past: that of the internal damping, zero without it.
    viscous: f64,
    /// Share of each node in the kinetic energy: 1 inside, 1/2 at the ends.
    share: &'r [S::f64s],
    top: End<S>,
    bottom: End<S>,
    /// Displacement of an end per force on it and step, `dt^2 / (m_end (1 + a2))` \[m/N\].
    pub(super) compliance: f64,
    cell_mass: f64,
    cell_stiffness: f64,
    retardation_time: f64,
    nodes: usize,
}

/// An end node: its displacement at the newest state and before, and its place.
struct End<S: Simd> {
    now: f64,
    before: f64,
    lane: S::m64s,
    /// Slot of the node next to it, which is also its mirror image beyond the end.
    inner: usize,
}

impl<'r, S: Simd> Bar<'r, S> {
    pub(super) fn new(
        simd: S,
        grid: &BarGrid,
        storage: &'r mut BarStorage,
        step: f64,
        rate: f64,
    ) -> Self {
        let lanes = S::F64_LANES;
        let nodes = grid.nodes();
        let vectors = nodes / lanes;
        let slot_of = |node: usize| (node % vectors) * lanes + node / vectors;
        let mut lane_numbers = Lanes::zeros(lanes);
        for (lane, number) in lane_numbers.numbers_mut().iter_mut().enumerate() {
            *number = lane as f64;
        }
        let lane_numbers = lane_numbers.vectors_mut::<S>()[0];
        let end = |lane: usize, inner: usize| End {
            now: 0.0,
            before: 0.0,
            lane: simd.equal_f64s(lane_numbers, simd.splat_f64s(lane as f64)),
            inner: slot_of(inner),
        };
        for node in 0..nodes {
            let at_end = node == 0 || node == nodes - 1;
            storage.share.numbers_mut()[slot_of(node)] = if at_end { 0.5 } else { 1.0 };
        }
        let a1 = (step / grid.crossing_time()).powi(2);
        let a2 = rate * step;
        // a1 (b / dt) times the second differences of w - w- belongs to Eq. (4) with E (1 + b d/dt).
        let viscous = a1 * grid.retardation_time() / (step * (1.0 + a2));
        Self {
            even: storage.even.vectors_mut::<S>(),
            odd: storage.odd.vectors_mut::<S>(),
            own: (2.0 * (1.0 - a1) + a2) / (1.0 + a2) - 2.0 * viscous,
            neighbour: a1 / (1.0 + a2) + viscous,
            past: -1.0 / (1.0 + a2) + 2.0 * viscous,
            viscous,
            share: storage.share.vectors_mut::<S>(),
            top: end(0, 1),
            bottom: end(lanes - 1, nodes - 2),
            compliance: step * step / (grid.end_mass() * (1.0 + a2)),
            cell_mass: grid.cell_mass(),
            cell_stiffness: grid.cell_stiffness(),
            retardation_time: grid.retardation_time(),
            nodes,
        }
    }

    /// The displacements \[m\] that the top and bottom end would reach in the
    /// step that reads buffer `PARITY`, without forces on them.
    #[inline(always)]
    pub(super) fn unloaded_ends<const PARITY: usize>(&self) -> (f64, f64) {
        let (now, past): (&[_], &[_]) =
            if PARITY == 0 { (self.even, self.odd) } else { (self.odd, self.even) };
        let (now, past) = (numbers::<S>(now), numbers::<S>(past));
        let of = |end: &End<S>| {
            let mut inner = 2.0 * self.neighbour * now[end.inner];
            if self.viscous > 0.0 {
                inner -= 2.0 * self.viscous * past[end.inner];
            }
            // The newest end is known last, so it enters last.
            fused::<S>(self.own, end.now, fused::<S>(self.past, end.before, inner))
        };
        (of(&self.top), of(&self.bottom))
    }

    /// Moves the ends on to the displacements \[m\] that they reach in this step.
    #[inline(always)]
    pub(super) fn advance_ends(&mut self, top: f64, bottom: f64) {
        for (end, reached) in [(&mut self.top, top), (&mut self.bottom, bottom)] {
            (end.before, end.now) = (end.now, reached);
        }
    }

    /// Eq. (4) for all nodes but the ends, which have been moved on already,
    /// from buffer `PARITY` into the other.
    #[inline(always)]
    pub(super) fn sweep<const PARITY: usize>(&mut self, simd: S) {
        if self.viscous > 0.0 {
            self.sweep_viscous::<PARITY>(simd);
        } else {
            self.sweep_elastic::<PARITY>(simd);
        }
    }

    #[inline(always)]
    fn sweep_elastic<const PARITY: usize>(&mut self, simd: S) {
        let (top, bottom) = (self.top.now, self.bottom.now);
        let (now, next) =
            if PARITY == 0 { (&*self.even, &mut *self.odd) } else { (&*self.odd, &mut *self.even) };
        // Mirror images stand in for the neighbours beyond the ends.
        let image = |end: &End<S>, wrapped| {
            let mirrored = numbers::<S>(now)[end.inner];
            simd.select_f64s(end.lane, simd.splat_f64s(mirrored), wrapped)
        };
        let (Some((&first, rest)), Some(&last)) = (now.split_first(), now.last()) else { return };
        let above = image(&self.top, simd.rotate_right_f64s(last, 1));
        let below = image(&self.bottom, simd.rotate_left_f64s(first, 1));
        let own = simd.splat_f64s(self.own);
        let neighbour = simd.splat_f64s(self.neighbour);
        let past = simd.splat_f64s(self.past);
        let update = |left, middle, right, old| {
            let sides = simd.add_f64s(left, right);
            let inertia = simd.mul_add_e_f64s(own, middle, simd.mul_f64s(past, old));
            simd.mul_add_e_f64s(neighbour, sides, inertia)
        };
        // The end nodes are put in before their vectors are stored: a second,
        // partial store would make the next sweep wait for it.
        let put = |end: &End<S>, reached, vector| {
            simd.select_f64s(end.lane, simd.splat_f64s(reached), vector)
        };
        let (Some((next_first, next_rest)), Some((&second, after))) =
            (next.split_first_mut(), rest.split_first())
        else {
            // All nodes in one vector.
            let new = put(&self.top, top, update(above, first, below, next[0]));
            next[0] = put(&self.bottom, bottom, new);
            return;
        };
        *next_first = put(&self.top, top, update(above, first, second, *next_first));
        let (mut left, mut middle) = (first, second);
        if let Some((next_last, inside)) = next_rest.split_last_mut() {
            for (&right, state) in after.iter().zip(inside) {
                *state = update(left, middle, right, *state);
                (left, middle) = (middle, right);
            }
            *next_last = put(&self.bottom, bottom, update(left, middle, below, *next_last));
        }
    }

    /// The sweep with internal damping, which the past of the neighbours enters too.
    #[inline(always)]
    fn sweep_viscous<const PARITY: usize>(&mut self, simd: S) {
        let (top, bottom) = (self.top.now, self.bottom.now);
        let (now, next) =
            if PARITY == 0 { (&*self.even, &mut *self.odd) } else { (&*self.odd, &mut *self.even) };
        let count = now.len();
        let (Some(&first), Some(&last)) = (now.first(), now.last()) else { return };
        let (past_first, past_last) = (next[0], next[count - 1]);
        // Mirror images stand in for the neighbours beyond the ends, in the past too.
        let image = |end: &End<S>, state: &[S::f64s], wrapped| {
            let mirrored = numbers::<S>(state)[end.inner];
            simd.select_f64s(end.lane, simd.splat_f64s(mirrored), wrapped)
        };
        let above = image(&self.top, now, simd.rotate_right_f64s(last, 1));
        let below = image(&self.bottom, now, simd.rotate_left_f64s(first, 1));
        let past_above = image(&self.top, next, simd.rotate_right_f64s(past_last, 1));
        let past_below = image(&self.bottom, next, simd.rotate_left_f64s(past_first, 1));
        let own = simd.splat_f64s(self.own);
        let neighbour = simd.splat_f64s(self.neighbour);
        let past = simd.splat_f64s(self.past);
        let viscous = simd.splat_f64s(-self.viscous);
        let put = |end: &End<S>, reached, vector| {
            simd.select_f64s(end.lane, simd.splat_f64s(reached), vector)
        };
        let (mut left, mut past_left) = (above, past_above);
        for i in 0..count {
            let (middle, old) = (now[i], next[i]);
            let inside = i + 1 < count;
            let right = if inside { now[i + 1] } else { below };
            let past_right = if inside { next[i + 1] } else { past_below };
            let inertia = simd.mul_add_e_f64s(own, middle, simd.mul_f64s(past, old));
            let spring = simd.mul_add_e_f64s(neighbour, simd.add_f64s(left, right), inertia);
            let pasts = simd.add_f64s(past_left, past_right);
            let mut new = simd.mul_add_e_f64s(viscous, pasts, spring);
            if i == 0 {
                new = put(&self.top, top, new);
            }
            if !inside {
                new = put(&self.bottom, bottom, new);
            }
            next[i] = new;
            (left, past_left) = (middle, old);
        }
    }

    /// Power that the internal damping dissipates \[W\] half a step before the newest state, for
    /// `step` \[s\]: the retardation time times the stretching rates squared times the cells'
    /// stiffness.
    #[inline(always)]
    pub(super) fn internal_loss(&self, step: f64) -> f64 {
        if self.retardation_time == 0.0 {
            return 0.0;
        }
        let (even, odd) = (numbers::<S>(self.even), numbers::<S>(self.odd));
        let vectors = self.even.len();
        let travel = |node: usize| {
            let slot = (node % vectors) * S::F64_LANES + node / vectors;
            even[slot] - odd[slot]
        };
        let (mut sum, mut before) = (0.0, travel(0));
        for node in 1..self.nodes {
            let here = travel(node);
            sum += (here - before) * (here - before);
            before = here;
        }
        self.retardation_time * self.cell_stiffness * sum / (step * step)
    }

    /// Newest displacement of the top end, and the one before \[m\].
    #[inline(always)]
    pub(super) fn top(&self) -> (f64, f64) {
        (self.top.now, self.top.before)
    }

    /// Twice the kinetic energy \[J\] half a step before the newest state, for `step` \[s\].
    #[inline(always)]
    pub(super) fn twice_kinetic_energy(&self, simd: S, step: f64) -> f64 {
        let mut sum = simd.splat_f64s(0.0);
        for ((&a, &b), &share) in self.even.iter().zip(&*self.odd).zip(self.share) {
            let travel = simd.sub_f64s(a, b);
            sum = simd.mul_add_e_f64s(simd.mul_f64s(share, travel), travel, sum);
        }
        self.cell_mass * simd.reduce_sum_f64s(sum) / (step * step)
    }

    /// Kinetic and elastic energy \[J\] half a step before the newest state: the
    /// pair whose sum the undamped scheme conserves exactly.
    pub(super) fn energy(&self, step: f64) -> (f64, f64) {
        let (even, odd) = (self.in_order(self.even), self.in_order(self.odd));
        let last = self.nodes - 1;
        let mut kinetic = 0.0;
        let mut elastic = 0.0;
        for node in 0..self.nodes {
            let share = if node == 0 || node == last { 0.5 } else { 1.0 };
            let velocity = (even[node] - odd[node]) / step;
            kinetic += 0.5 * share * self.cell_mass * velocity * velocity;
            if node < last {
                let stretch = (even[node + 1] - even[node]) * (odd[node + 1] - odd[node]);
                elastic += 0.5 * self.cell_stiffness * stretch;
            }
        }
        (kinetic, elastic)
    }

    fn in_order(&self, state: &[S::f64s]) -> Vec<f64> {
        let vectors = state.len();
        let slot_of = |node: usize| (node % vectors) * S::F64_LANES + node / vectors;
        (0..self.nodes).map(|node| numbers::<S>(state)[slot_of(node)]).collect()
    }
}

/// `a b + c`, in one rounding where the instruction set does that in one instruction.
#[inline(always)]
pub(super) fn fused<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    if S::F64_LANES > 1 { a.mul_add(b, c) } else { a * b + c }
}
