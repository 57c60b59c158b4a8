//! All numbers of a step of one length that depend on neither the state nor the load.
//!
//! Within a step the traction of each row is the cubic through its values and rates at both ends
//! (Hermite) with a bend, for a mode that turns slowly enough, and their mean for a faster one. Without a bend a
//! rigid motion on a spring, r radians a step, keeps its energy up to r = 3, and turns too slowly by the
//! share `r^4 / 1440`. A mode too fast even for the mean follows its forces at once.

use std::array;

use super::oscillator::{Dynamics, Propagator};
use super::row_modes::{RowMode, RowModes};
use super::step_model::{FAST, LAG, slow_modes};

/// Square of the radians in a step, 2, up to which a mode and the contact springs take the cubic.
const SLOW: f64 = 4.0;

/// Pairs of the shares in the displacement and the velocity of a mode at the end of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ModeStep {
    /// Of displacement and velocity at its beginning.
    pub(super) displacement: [f64; 2],
    pub(super) velocity: [f64; 2],
    /// Of the modal contact force and its rate at the beginning, and at the end.
    pub(super) force: [[f64; 2]; 4],
    /// Of the bends of the modal contact force, `s^2 (1 - s)^2` and s times as much.
    pub(super) bend: [[f64; 2]; 2],
    /// Of the coefficients of the load, a polynomial of the part of the step.
    pub(super) load: [[f64; 2]; 3],
    /// Of displacement, velocity, modal force and its rate in the acceleration at the end.
    pub(super) acceleration: [f64; 4],
}

/// Modes side by side.
pub(super) const LANES: usize = 8;

/// A number of each of some modes side by side.
pub(super) type Lanes = [f64; LANES];

/// The steps of some modes side by side.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ModeBlock {
    /// Shares of displacement, velocity, contact force and its rate at the beginning, in displacement and
    /// velocity at the end.
    pub(super) free: [[Lanes; 4]; 2],
    /// Shares of the contact force and its rate at the end.
    pub(super) end: [[Lanes; 2]; 2],
    /// Shares of the bends of the contact force.
    pub(super) bend: [[Lanes; 2]; 2],
    /// Shares of the coefficients of the load.
    pub(super) load: [[Lanes; 3]; 2],
    /// Shares of displacement, velocity, contact force and its rate in the acceleration.
    pub(super) acceleration: [Lanes; 4],
}

/// A square matrix of rows of contacts, row by row.
pub(super) type RowMatrix = Vec<Vec<f64>>;

/// The coefficients of a step.
#[derive(Debug)]
pub(super) struct StepCoefficients {
    /// Step \[s\].
    pub(super) step: f64,
    pub(super) modes: Vec<ModeStep>,
    pub(super) blocks: Vec<ModeBlock>,
    /// Loss of the closure of row i per traction, and per rate of the traction, at row j.
    pub(super) closure: [RowMatrix; 2],
    /// Loss of its rate, and of the acceleration.
    pub(super) rate: [RowMatrix; 2],
    pub(super) acceleration: [RowMatrix; 2],
    /// Loss of the closure per traction by the modes that follow their forces at once.
    pub(super) follows: RowMatrix,
}

impl StepCoefficients {
    /// The coefficients of `structure` with contact `areas` \[m2\], of highest `stiffness` \[Pa/m\],
    /// under the mass-proportional damping `damping_rate` \[1/s\], for steps of `step` \[s\].
    pub(super) fn new(
        structure: &RowModes,
        areas: &[f64],
        stiffness: &[f64],
        damping_rate: f64,
        step: f64,
    ) -> Self {
        let mut slow = vec![false; structure.modes.len()];
        for k in slow_modes(&structure.modes, areas, stiffness, step, SLOW) {
            slow[k] = true;
        }
        let pairs = structure.modes.iter().zip(&slow);
        let modes: Vec<ModeStep> = pairs
            .map(|(mode, &is_slow)| {
                let rate = mode.total_damping(damping_rate);
                ModeStep::new(mode, rate, step, is_slow)
            })
            .collect();
        let rows = areas.len();
        let zero = || vec![vec![0.0; rows]; rows];
        let [closure, rate, acceleration] = array::from_fn(|_| [zero(), zero()]);
        let blocks = blocks(&structure.modes, &modes);
        let mut coefficients =
            Self { step, modes, blocks, closure, rate, acceleration, follows: zero() };
        coefficients.couple(structure, areas);
        coefficients
    }

    fn couple(&mut self, structure: &RowModes, areas: &[f64]) {
        for (i, flexibility) in structure.residual.closure.iter().enumerate() {
            for (j, area) in areas.iter().enumerate() {
                self.closure[0][i][j] += flexibility[j] * area;
                self.rate[1][i][j] += flexibility[j] * area;
                self.follows[i][j] += flexibility[j] * area;
            }
        }
        for (mode, shares) in structure.modes.iter().zip(&self.modes) {
            for (i, own) in mode.closure.iter().enumerate() {
                for (j, area) in areas.iter().enumerate() {
                    let both = own * mode.closure[j] * area;
                    if shares.follows() {
                        self.follows[i][j] += both * shares.force[2][0];
                    }
                    for order in 0..2 {
                        let [displacement, velocity] = shares.force[2 + order];
                        self.closure[order][i][j] += both * displacement;
                        self.rate[order][i][j] += both * velocity;
                        let [of_displacement, of_velocity, ..] = shares.acceleration;
                        self.acceleration[order][i][j] += both
                            * (of_displacement * displacement
                                + of_velocity * velocity
                                + shares.acceleration[2 + order]);
                    }
                }
            }
        }
    }
}

/// The steps of `modes` in blocks; the lanes behind the last mode stay at rest.
fn blocks(modes: &[RowMode], steps: &[ModeStep]) -> Vec<ModeBlock> {
    let block = |(modes, steps): (&[RowMode], &[ModeStep])| {
        let mut block = ModeBlock::default();
        for (lane, (mode, step)) in modes.iter().zip(steps).enumerate() {
            for k in 0..2 {
                let free = [step.displacement, step.velocity][k]
                    .into_iter()
                    .chain([0, 1].map(|j| step.force[j][k]));
                for (lanes, share) in block.free[k].iter_mut().zip(free) {
                    lanes[lane] = share;
                }
                for j in 0..2 {
                    block.end[k][j][lane] = step.force[2 + j][k];
                    block.bend[k][j][lane] = step.bend[j][k];
                }
                for j in 0..3 {
                    block.load[k][j][lane] = mode.load * step.load[j][k];
                }
            }
            for (lanes, share) in block.acceleration.iter_mut().zip(step.acceleration) {
                lanes[lane] = share;
            }
        }
        block
    };
    modes.chunks(LANES).zip(steps.chunks(LANES)).map(block).collect()
}

impl ModeStep {
    fn new(mode: &RowMode, rate: f64, step: f64, is_slow: bool) -> Self {
        let w = mode.angular_frequency;
        let (zero, at_once) = ([0.0; 2], 1.0 / (w * w));
        let is_fast = if mode.massless { rate <= LAG * step * w * w } else { w * step > FAST };
        if is_fast && !is_slow {
            return Self {
                force: [zero, zero, [at_once, 0.0], [0.0, at_once]],
                load: [[at_once, 0.0], [at_once, at_once / step], [at_once, 2.0 * at_once / step]],
                ..Self::default()
            };
        }
        let dynamics = Dynamics { angular_frequency: w, rate, massless: mode.massless };
        let propagator = dynamics.propagator(step);
        let [m0, m1, m2, m3, m4, m5] = propagator.moments;
        let sum = |shares: [f64; 4]| -> [f64; 2] {
            let [a, b, c, d] = shares;
            array::from_fn(|k| a * m0[k] + b * m1[k] + c * m2[k] + d * m3[k])
        };
        if mode.massless {
            return Self::massless(propagator, w * w / rate, rate);
        }
        let (force, bend) = if is_slow {
            let cubic = [
                sum([1.0, 0.0, -3.0, 2.0]),
                sum([0.0, step, -2.0 * step, step]),
                sum([0.0, 0.0, 3.0, -2.0]),
                sum([0.0, 0.0, -step, step]),
            ];
            let bent = |[a, b, c]: [[f64; 2]; 3]| array::from_fn(|k| a[k] - 2.0 * b[k] + c[k]);
            (cubic, [bent([m2, m3, m4]), bent([m3, m4, m5])])
        } else {
            let half = sum([0.5, 0.0, 0.0, 0.0]);
            ([half, zero, half, zero], [zero; 2])
        };
        Self {
            displacement: propagator.displacement,
            velocity: propagator.velocity,
            force,
            bend,
            load: [m0, m1, m2],
            acceleration: [-w * w, -rate, 1.0, 0.0],
        }
    }
    /// True for a mode that follows its forces at once.
    pub(super) fn follows(&self) -> bool {
        self.displacement == [0.0; 2]
    }

    /// A motion without inertia, `c q' = F - w^2 q`, under forces that are linear in the step.
    fn massless(propagator: Propagator, relaxation: f64, rate: f64) -> Self {
        let [m0, m1, m2, ..] = propagator.moments.map(|moment| moment[0]);
        let with_velocity = |displacement: f64, at_end: f64| {
            [displacement, at_end / rate - relaxation * displacement]
        };
        let [kept, _] = propagator.displacement;
        Self {
            displacement: [kept, 0.0],
            velocity: [-relaxation * kept, 0.0],
            force: [with_velocity(m0 - m1, 0.0), [0.0; 2], with_velocity(m1, 1.0), [0.0; 2]],
            load: [with_velocity(m0, 1.0), with_velocity(m1, 1.0), with_velocity(m2, 1.0)],
            acceleration: [0.0, -relaxation, 0.0, 1.0 / rate],
            ..Self::default()
        }
    }
}
