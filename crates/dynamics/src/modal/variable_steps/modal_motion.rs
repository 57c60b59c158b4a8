//! Motion of the modes over a step, some of them side by side.

use std::array;

use pulp::Simd;

use super::bend::Bends;
use crate::modal::row_modes::RowMode;
use crate::modal::step_coefficients::{LANES, Lanes, ModeBlock, StepCoefficients};

/// Participations of some modes side by side.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Shape<const N: usize> {
    /// Of the closure of each row, and modal force per traction at each row.
    closure: [Lanes; N],
    force: [Lanes; N],
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
    shapes: Vec<Shape<N>>,
    states: Vec<State>,
}

impl<const N: usize> ModalMotion<N> {
    /// `modes` at rest, with contact areas \[m2\] under a mass-proportional damping rate \[1/s\].
    pub(super) fn at_rest(modes: &[RowMode], area: impl Fn(usize) -> f64, rate: f64) -> Self {
        let shape = |modes: &[RowMode]| Shape {
            closure: array::from_fn(|i| {
                lanes(modes, |mode| mode.closure.get(i).copied().unwrap_or(0.0))
            }),
            force: array::from_fn(|i| {
                lanes(modes, |mode| mode.closure.get(i).map_or(0.0, |g| g * area(i)))
            }),
            load: lanes(modes, |mode| mode.load),
            rate: lanes(modes, |mode| mode.total_damping(rate)),
        };
        let shapes: Vec<Shape<N>> = modes.chunks(LANES).map(shape).collect();
        Self { states: vec![State::default(); shapes.len()], shapes }
    }

    /// Moves the modes to the end of a step without the tractions there, by the load and the bends of the tractions, and
    /// gives the closures; with dampers their accelerations too.
    #[inline(always)]
    pub(super) fn move_freely<S: Simd>(
        &mut self,
        simd: S,
        step: &StepCoefficients,
        (load, bends): (Option<StepLoad>, &Bends<N>),
        is_damped: bool,
    ) -> RowMotion<N> {
        let bends = bends.map(|of_rows| of_rows.map(|number| simd.splat_f64s(number)));
        let mut sums = [[simd.splat_f64s(0.0); N]; 3];
        for ((state, shares), shape) in self.states.iter_mut().zip(&step.blocks).zip(&self.shapes) {
            for r in 0..LANES / S::F64_LANES {
                let of = |lanes: &Lanes| register::<S>(lanes, r);
                let from =
                    [&state.displacement, &state.velocity, &state.force, &state.force_rate].map(of);
                let mut free = [0, 1].map(|k| {
                    let [first, others @ ..] = &shares.free[k];
                    let moved = simd.mul_f64s(of(first), from[0]);
                    add_products(simd, moved, others.iter().map(of).zip(from[1..].iter().copied()))
                });
                if let Some(load) = load {
                    let numbers = load.coefficients.map(|number| simd.splat_f64s(number));
                    for (free, shares) in free.iter_mut().zip(&shares.load) {
                        *free = add_products(simd, *free, shares.iter().map(of).zip(numbers));
                    }
                }
                add_bends(simd, &mut free, (shares, shape, r), bends);
                for i in 0..N {
                    let closure = of(&shape.closure[i]);
                    for (sum, free) in sums.iter_mut().zip(free) {
                        sum[i] = simd.mul_add_e_f64s(closure, free, sum[i]);
                    }
                }
                if is_damped {
                    let load = load.map(|load| (of(&shape.load), load.end));
                    let moved = acceleration(simd, shares, r, (free, None), load);
                    for i in 0..N {
                        sums[2][i] = simd.mul_add_e_f64s(of(&shape.closure[i]), moved, sums[2][i]);
                    }
                }
                for (lanes, free) in state.free.iter_mut().zip(free) {
                    S::as_mut_simd_f64s(lanes).0[r] = free;
                }
            }
        }
        // Not by `map`, which would not become part of this function.
        let mut motion = [[0.0; N]; 3];
        for (motion, sums) in motion.iter_mut().zip(&sums) {
            for i in 0..N {
                motion[i] = simd.reduce_sum_f64s(sums[i]);
            }
        }
        motion
    }

    /// Completes the step that was [moved freely](Self::move_freely) by the tractions and their rates at its end, and
    /// changes of their bends.
    #[inline(always)]
    pub(super) fn complete<S: Simd>(
        &mut self,
        simd: S,
        step: &StepCoefficients,
        load: Option<StepLoad>,
        (tractions, bends): ([&[f64; N]; 2], &Bends<N>),
    ) -> Completed {
        let bends = bends.map(|of_rows| of_rows.map(|number| simd.splat_f64s(number)));
        let tractions = tractions.map(|of_rows| of_rows.map(|number| simd.splat_f64s(number)));
        let [half, sixth] = [0.5, step.step / 6.0].map(|number| simd.splat_f64s(number));
        let mut loss = simd.splat_f64s(0.0);
        let mut load_port = [simd.splat_f64s(0.0); 2];
        for ((state, shares), shape) in self.states.iter_mut().zip(&step.blocks).zip(&self.shapes) {
            for r in 0..LANES / S::F64_LANES {
                let of = |lanes: &Lanes| register::<S>(lanes, r);
                let forces = tractions.map(|of_rows| {
                    let pairs = shape.force.iter().map(of).zip(of_rows);
                    simd.neg_f64s(add_products(simd, simd.splat_f64s(0.0), pairs))
                });
                let mut moved = state.free.each_ref().map(of);
                for (moved, shares) in moved.iter_mut().zip(&shares.end) {
                    *moved = add_products(simd, *moved, shares.iter().map(of).zip(forces));
                }
                add_bends(simd, &mut moved, (shares, shape, r), bends);
                let participation = of(&shape.load);
                for (port, moved) in load_port.iter_mut().zip(moved) {
                    *port = simd.mul_add_e_f64s(participation, moved, *port);
                }
                let load = load.map(|load| (participation, load.end));
                let accelerated = acceleration(simd, shares, r, (moved, Some(forces)), load);
                let [a, b] = [of(&state.velocity), moved[1]];
                let squares = simd.mul_add_e_f64s(a, a, simd.mul_f64s(b, b));
                let slopes = simd.sub_f64s(
                    simd.mul_f64s(a, of(&state.acceleration)),
                    simd.mul_f64s(b, accelerated),
                );
                let mean = simd.mul_add_e_f64s(sixth, slopes, simd.mul_f64s(half, squares));
                loss = simd.mul_add_e_f64s(of(&shape.rate), mean, loss);
                let [displacement, velocity] = moved;
                let [force, force_rate] = forces;
                for (lanes, number) in [
                    (&mut state.displacement, displacement),
                    (&mut state.velocity, velocity),
                    (&mut state.acceleration, accelerated),
                    (&mut state.force, force),
                    (&mut state.force_rate, force_rate),
                ] {
                    S::as_mut_simd_f64s(lanes).0[r] = number;
                }
            }
        }
        Completed {
            loss: step.step * simd.reduce_sum_f64s(loss),
            load_port: load_port.map(|port| simd.reduce_sum_f64s(port)),
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

/// Accelerations of modes with these displacements and velocities under a contact force and its rate, and
/// the load and its rate.
#[inline(always)]
fn acceleration<S: Simd>(
    simd: S,
    shares: &ModeBlock,
    r: usize,
    (moved, force): ([S::f64s; 2], Option<[S::f64s; 2]>),
    load: Option<(S::f64s, [f64; 2])>,
) -> S::f64s {
    let [first, second, others @ ..] =
        shares.acceleration.each_ref().map(|lanes| register::<S>(lanes, r));
    let mut sum = simd.mul_add_e_f64s(first, moved[0], simd.mul_f64s(second, moved[1]));
    for (k, share) in others.into_iter().enumerate() {
        if let Some(force) = force {
            sum = simd.mul_add_e_f64s(share, force[k], sum);
        }
        if let Some((participation, load)) = load {
            let load = simd.mul_f64s(participation, simd.splat_f64s(load[k]));
            sum = simd.mul_add_e_f64s(share, load, sum);
        }
    }
    sum
}

/// Adds the displacements and velocities by bends of the tractions, in register `r`.
#[inline(always)]
fn add_bends<S: Simd, const N: usize>(
    simd: S,
    moved: &mut [S::f64s; 2],
    (shares, shape, r): (&ModeBlock, &Shape<N>, usize),
    bends: [[S::f64s; N]; 2],
) {
    let of = |lanes: &Lanes| register::<S>(lanes, r);
    let forces = bends.map(|of_rows| {
        let pairs = shape.force.iter().map(of).zip(of_rows);
        simd.neg_f64s(add_products(simd, simd.splat_f64s(0.0), pairs))
    });
    for (moved, shares) in moved.iter_mut().zip(&shares.bend) {
        *moved = add_products(simd, *moved, shares.iter().map(of).zip(forces));
    }
}

/// Some of the lanes, side by side in register `r`.
#[inline(always)]
fn register<S: Simd>(lanes: &Lanes, r: usize) -> S::f64s {
    S::as_simd_f64s(lanes).0[r]
}

#[inline(always)]
fn add_products<S: Simd>(
    simd: S,
    sum: S::f64s,
    pairs: impl Iterator<Item = (S::f64s, S::f64s)>,
) -> S::f64s {
    pairs.fold(sum, |sum, (a, b)| simd.mul_add_e_f64s(a, b, sum))
}

/// A number of each of at most [`LANES`] modes.
pub(super) fn lanes(modes: &[RowMode], of: impl Fn(&RowMode) -> f64) -> Lanes {
    array::from_fn(|lane| modes.get(lane).map_or(0.0, &of))
}

#[inline(always)]
fn sum_product(a: &Lanes, b: &Lanes) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
