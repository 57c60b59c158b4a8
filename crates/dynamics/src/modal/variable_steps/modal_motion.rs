//! Motion of the modes over a step, some of them side by side.
//!
//! Registers go through plain loops alone: where there are many rows, closures of `map` and `fold` become functions
//! of their own, without the instructions of the caller, and take ten times as long.

use std::array;

use pulp::Simd;

use super::bend::Bends;
use super::contact_solve::rows_of;
use crate::modal::row_modes::RowMode;
use crate::modal::step_coefficients::{LANES, Lanes, ModeBlock, StepCoefficients};

/// Participations of some modes side by side.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Shape<const N: usize> {
    /// Of the closure of each row.
    closure: [Lanes; N],
    load: Lanes,
    /// Damping rate.
    rate: Lanes,
}

/// States of some modes side by side.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
struct State {
    displacement: Lanes,
    velocity: Lanes,
    acceleration: Lanes,
    /// Contact force and its rate.
    force: Lanes,
    force_rate: Lanes,
    /// Displacement and velocity at the end of the step without the tractions there.
    free: [Lanes; 2],
}

/// The load in a step: its coefficients, a quadratic of the part of the step, and its value and its rate at the end.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepLoad {
    pub(super) coefficients: [f64; 3],
    pub(super) end: [f64; 2],
}

/// A completed step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Completed {
    /// Viscous loss \[J\].
    pub(super) loss: f64,
    /// Displacement and velocity of the load port at its end by the modes.
    pub(super) load_port: [f64; 2],
}

/// Closures of the rows, their rates and accelerations by the modes alone.
pub(super) type RowMotion<const N: usize> = [[f64; N]; 3];

/// The modes with their participations; lanes behind the last one stay at rest.
#[derive(Debug)]
pub(super) struct ModalMotion<const N: usize> {
    /// Number of rows, and their contact areas \[m2\]; the rest of the N are unused.
    rows: usize,
    areas: [f64; N],
    shapes: Vec<Shape<N>>,
    states: Vec<State>,
}

impl<const N: usize> ModalMotion<N> {
    /// `modes` at rest, with contact areas \[m2\] of the rows under a mass-proportional damping rate \[1/s\].
    pub(super) fn at_rest(modes: &[RowMode], areas: &[f64], rate: f64) -> Self {
        let shape = |modes: &[RowMode]| Shape {
            closure: array::from_fn(|i| {
                lanes(modes, |mode| mode.closure.get(i).copied().unwrap_or(0.0))
            }),
            load: lanes(modes, |mode| mode.load),
            rate: lanes(modes, |mode| mode.total_damping(rate)),
        };
        let shapes: Vec<Shape<N>> = modes.chunks(LANES).map(shape).collect();
        let area = |i: usize| areas.get(i).copied().unwrap_or(0.0);
        let states = vec![State::default(); shapes.len()];
        Self { rows: areas.len(), areas: array::from_fn(area), shapes, states }
    }

    /// Forces \[N\] of the rows by two sets of tractions \[Pa\], on all lanes.
    #[inline(always)]
    fn forces<S: Simd>(&self, simd: S, tractions: &[[f64; N]; 2]) -> [[S::f64s; N]; 2] {
        let mut forces = [[simd.splat_f64s(0.0); N]; 2];
        for k in 0..2 {
            for i in 0..rows_of::<N>(self.rows) {
                forces[k][i] = simd.splat_f64s(-self.areas[i] * tractions[k][i]);
            }
        }
        forces
    }

    /// Moves the modes to the end of a step without the tractions there, by the load and the bends of the tractions, and
    /// gives the closures; with dampers their accelerations too.
    #[inline(always)]
    pub(super) fn move_freely<S: Simd>(
        &mut self,
        simd: S,
        step: &StepCoefficients,
        (load, bends): (Option<StepLoad>, Option<&Bends<N>>),
        is_damped: bool,
    ) -> RowMotion<N> {
        let rows = rows_of::<N>(self.rows);
        let is_bent = bends.is_some();
        let bends = self.forces(simd, bends.unwrap_or(&[[0.0; N]; 2]));
        let mut sums = [[simd.splat_f64s(0.0); N]; 3];
        for ((state, shares), shape) in self.states.iter_mut().zip(&step.blocks).zip(&self.shapes) {
            for r in 0..LANES / S::F64_LANES {
                let from = [
                    register::<S>(&state.displacement, r),
                    register::<S>(&state.velocity, r),
                    register::<S>(&state.force, r),
                    register::<S>(&state.force_rate, r),
                ];
                let mut free = [simd.splat_f64s(0.0); 2];
                add_products(simd, &mut free, (&shares.free, r), &from);
                if let Some(StepLoad { coefficients: [a, b, c], .. }) = load {
                    let numbers = [simd.splat_f64s(a), simd.splat_f64s(b), simd.splat_f64s(c)];
                    add_products(simd, &mut free, (&shares.load, r), &numbers);
                }
                if is_bent {
                    let forces = modal_forces(simd, (shape, r), rows, &bends);
                    add_products(simd, &mut free, (&shares.bend, r), &forces);
                }
                for i in 0..rows {
                    let closure = register::<S>(&shape.closure[i], r);
                    for k in 0..2 {
                        sums[k][i] = simd.mul_add_e_f64s(closure, free[k], sums[k][i]);
                    }
                }
                if is_damped {
                    let moved = acceleration(simd, (shares, shape, r), (free, None), load);
                    for i in 0..rows {
                        let closure = register::<S>(&shape.closure[i], r);
                        sums[2][i] = simd.mul_add_e_f64s(closure, moved, sums[2][i]);
                    }
                }
                for k in 0..2 {
                    set_register::<S>(&mut state.free[k], r, free[k]);
                }
            }
        }
        let mut motion = [[0.0; N]; 3];
        for (motion, sums) in motion.iter_mut().zip(&sums) {
            for i in 0..rows {
                motion[i] = simd.reduce_sum_f64s(sums[i]);
            }
        }
        motion
    }

    /// Completes the step that was [moved freely](Self::move_freely) by the tractions and their rates at its end, and
    /// changes of their bends, if they change.
    #[inline(always)]
    pub(super) fn complete<S: Simd>(
        &mut self,
        simd: S,
        step: &StepCoefficients,
        load: Option<StepLoad>,
        (tractions, bends): (&[[f64; N]; 2], Option<&Bends<N>>),
    ) -> Completed {
        let rows = rows_of::<N>(self.rows);
        let is_bent = bends.is_some();
        let bends = self.forces(simd, bends.unwrap_or(&[[0.0; N]; 2]));
        let tractions = self.forces(simd, tractions);
        let (half, sixth) = (simd.splat_f64s(0.5), simd.splat_f64s(step.step / 6.0));
        let mut loss = simd.splat_f64s(0.0);
        let mut load_port = [simd.splat_f64s(0.0); 2];
        for ((state, shares), shape) in self.states.iter_mut().zip(&step.blocks).zip(&self.shapes) {
            for r in 0..LANES / S::F64_LANES {
                let forces = modal_forces(simd, (shape, r), rows, &tractions);
                let [free, of_free] = &state.free;
                let mut moved = [register::<S>(free, r), register::<S>(of_free, r)];
                add_products(simd, &mut moved, (&shares.end, r), &forces);
                if is_bent {
                    let forces = modal_forces(simd, (shape, r), rows, &bends);
                    add_products(simd, &mut moved, (&shares.bend, r), &forces);
                }
                let participation = register::<S>(&shape.load, r);
                for k in 0..2 {
                    load_port[k] = simd.mul_add_e_f64s(participation, moved[k], load_port[k]);
                }
                let accelerated =
                    acceleration(simd, (shares, shape, r), (moved, Some(forces)), load);
                let [a, b] = [register::<S>(&state.velocity, r), moved[1]];
                let squares = simd.mul_add_e_f64s(a, a, simd.mul_f64s(b, b));
                let slopes = simd.sub_f64s(
                    simd.mul_f64s(a, register::<S>(&state.acceleration, r)),
                    simd.mul_f64s(b, accelerated),
                );
                let mean = simd.mul_add_e_f64s(sixth, slopes, simd.mul_f64s(half, squares));
                loss = simd.mul_add_e_f64s(register::<S>(&shape.rate, r), mean, loss);
                set_register::<S>(&mut state.displacement, r, moved[0]);
                set_register::<S>(&mut state.velocity, r, moved[1]);
                set_register::<S>(&mut state.acceleration, r, accelerated);
                set_register::<S>(&mut state.force, r, forces[0]);
                set_register::<S>(&mut state.force_rate, r, forces[1]);
            }
        }
        let [displacement, velocity] = load_port;
        Completed {
            loss: step.step * simd.reduce_sum_f64s(loss),
            load_port: [simd.reduce_sum_f64s(displacement), simd.reduce_sum_f64s(velocity)],
        }
    }

    /// Displacement, velocity and acceleration of a port with these participations by the modes.
    pub(super) fn port(&self, participations: &[Lanes]) -> [f64; 3] {
        let mut port = [0.0; 3];
        for (participation, state) in participations.iter().zip(&self.states) {
            port[0] += sum_product(participation, &state.displacement);
            port[1] += sum_product(participation, &state.velocity);
            port[2] += sum_product(participation, &state.acceleration);
        }
        port
    }

    /// Displacement of every mode \[m kg^(1/2)\], and zeros behind the last.
    pub(super) fn displacements(&self) -> impl Iterator<Item = f64> {
        self.states.iter().flat_map(|state| state.displacement)
    }

    /// Velocity of every mode \[m kg^(1/2)/s\], and zeros behind the last.
    pub(super) fn velocities(&self) -> impl Iterator<Item = f64> {
        self.states.iter().flat_map(|state| state.velocity)
    }

    /// Displacement, velocity and contact force of mode `n`.
    pub(super) fn of_mode(&self, n: usize) -> [f64; 3] {
        let (state, lane) = (&self.states[n / LANES], n % LANES);
        [state.displacement[lane], state.velocity[lane], state.force[lane]]
    }
}

/// Modal forces of some modes by two sets of forces of the rows.
#[inline(always)]
fn modal_forces<S: Simd, const N: usize>(
    simd: S,
    (shape, r): (&Shape<N>, usize),
    rows: usize,
    forces: &[[S::f64s; N]; 2],
) -> [S::f64s; 2] {
    let mut sums = [simd.splat_f64s(0.0); 2];
    for i in 0..rows {
        let closure = register::<S>(&shape.closure[i], r);
        for k in 0..2 {
            sums[k] = simd.mul_add_e_f64s(closure, forces[k][i], sums[k]);
        }
    }
    sums
}

/// Accelerations of modes with these displacements and velocities under a contact force and its rate, and
/// the load and its rate.
#[inline(always)]
fn acceleration<S: Simd, const N: usize>(
    simd: S,
    (shares, shape, r): (&ModeBlock, &Shape<N>, usize),
    (moved, forces): ([S::f64s; 2], Option<[S::f64s; 2]>),
    load: Option<StepLoad>,
) -> S::f64s {
    let [displacement, velocity, others @ ..] = &shares.acceleration;
    let mut sum = simd.mul_f64s(register::<S>(displacement, r), moved[0]);
    sum = simd.mul_add_e_f64s(register::<S>(velocity, r), moved[1], sum);
    for k in 0..2 {
        let share = register::<S>(&others[k], r);
        if let Some(forces) = forces {
            sum = simd.mul_add_e_f64s(share, forces[k], sum);
        }
        if let Some(load) = load {
            let end = simd.splat_f64s(load.end[k]);
            let force = simd.mul_f64s(register::<S>(&shape.load, r), end);
            sum = simd.mul_add_e_f64s(share, force, sum);
        }
    }
    sum
}

/// Some of the lanes, side by side in register `r`.
#[inline(always)]
fn register<S: Simd>(lanes: &Lanes, r: usize) -> S::f64s {
    S::as_simd_f64s(lanes).0[r]
}

#[inline(always)]
fn set_register<S: Simd>(lanes: &mut Lanes, r: usize, numbers: S::f64s) {
    S::as_mut_simd_f64s(lanes).0[r] = numbers;
}

/// Adds to displacements and velocities the products of shares, in register `r`, with some numbers.
#[inline(always)]
fn add_products<S: Simd, const K: usize>(
    simd: S,
    sums: &mut [S::f64s; 2],
    (shares, r): (&[[Lanes; K]; 2], usize),
    numbers: &[S::f64s; K],
) {
    for k in 0..2 {
        for j in 0..K {
            sums[k] = simd.mul_add_e_f64s(register::<S>(&shares[k][j], r), numbers[j], sums[k]);
        }
    }
}

/// A number of each of at most [`LANES`] modes.
pub(super) fn lanes(modes: &[RowMode], of: impl Fn(&RowMode) -> f64) -> Lanes {
    array::from_fn(|lane| modes.get(lane).map_or(0.0, &of))
}

#[inline(always)]
fn sum_product(a: &Lanes, b: &Lanes) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
