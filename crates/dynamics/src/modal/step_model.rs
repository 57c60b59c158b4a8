//! All numbers of a step that do not depend on the drive force.

use asperity_mesh::{ComponentModes, NormalMode, ResidualFlexibility};

use super::oscillator::{Dynamics, ForceInterpolation, Recurrence};

/// Square of the radians in a step up to which the quartic damps an oscillation on its contacts.
const DAMPED: f64 = 1.44;

/// Largest growth of an oscillator of more radians by the quartic, as a share of its own decay.
///
/// The quartic turns a contact spring `k` (over the oscillator's inertia) of an oscillator of
/// `r^2 = (w^2 + k) h^2` into a growth of at most `k h^2 (r^2 - 1.44^2 / r^2) / 48` a step. The mean of
/// both ends has a larger error, of second order, but keeps the energy of any linear contact
/// exactly, at any frequency; so it replaces the quartic where that would excite an oscillation.
const GROWTH_SHARE: f64 = 0.5;

/// Contact stiffness over a mode's own up to which it hardly moves the mode.
const WEAK: f64 = 0.1;

/// Radians in a step from which on a mode counts as following its forces at once. A step cannot
/// show such an oscillation, and under a force that is frozen within the step it can even grow.
const FAST: f64 = 2.0;

/// One mode and its share in forces and closures.
#[derive(Debug, Clone)]
pub(super) struct ModeStep {
    pub(super) dynamics: Dynamics,
    pub(super) interpolation: ForceInterpolation,
    pub(super) recurrence: Recurrence,
    /// Shape of each closure.
    pub(super) closure: Vec<f64>,
    /// Modal force per pressure at each interface, `g S`.
    pub(super) force: Vec<f64>,
    pub(super) drive: f64,
    pub(super) output: f64,
}

/// A structure and its contacts for one step length.
#[derive(Debug, Clone)]
pub(super) struct StepModel {
    pub(super) step: f64,
    /// Interpolation of the contact force on every mode of the structure; none for those left out.
    pub(super) interpolations: Vec<Option<ForceInterpolation>>,
    pub(super) modes: Vec<ModeStep>,
    /// Closure lost at once at interface i per pressure increment at j \[m/Pa\].
    pub(super) coupling: Vec<Vec<f64>>,
    /// Output per pressure at each interface, of the modes left out \[m/Pa\].
    pub(super) output_pressure: Vec<f64>,
    /// Flexibility of the modes left out, those too fast for the step included.
    pub(super) residual: ResidualFlexibility,
}

impl StepModel {
    /// The model of `structure` with contact `areas` \[m2\] under mass-proportional damping `rate`
    /// \[1/s\] at `step` \[s\]; `stiffness` \[Pa/m\] is that of each contact at rest, and the highest
    /// expected.
    pub(super) fn new(
        structure: &ComponentModes,
        areas: &[f64],
        stiffness: &[[f64; 2]],
        rate: f64,
        step: f64,
    ) -> Self {
        let of = |mode: &NormalMode| {
            let stiff = [0, 1].map(|which| -> f64 {
                let pairs = mode.closure.iter().zip(areas).zip(stiffness);
                pairs.map(|((g, area), k)| g * (g * area) * k[which] * step * step).sum()
            });
            let turn = mode.angular_frequency * step;
            (turn <= FAST).then(|| interpolation(turn, stiff, mode.total_damping(rate) * step))
        };
        let interpolations = structure.modes().iter().map(of).collect();
        Self::with_interpolations(structure, areas, rate, step, interpolations)
    }

    /// The model of [`new`](Self::new) with the interpolations of another, so that results are
    /// continuous in the parameters of a scenario.
    pub(super) fn with_interpolations(
        structure: &ComponentModes,
        areas: &[f64],
        rate: f64,
        step: f64,
        interpolations: Vec<Option<ForceInterpolation>>,
    ) -> Self {
        let mut residual = structure.residual().clone();
        let times_areas =
            |row: &[f64]| -> Vec<f64> { row.iter().zip(areas).map(|(r, area)| r * area).collect() };
        let named = || structure.modes().iter().zip(&interpolations);
        for (mode, _) in named().filter(|(_, interpolation)| interpolation.is_none()) {
            residual.add(mode);
        }
        let mut coupling: Vec<Vec<f64>> =
            residual.closure.iter().map(|row| times_areas(row)).collect();
        let mut modes = Vec::with_capacity(interpolations.len());
        for (mode, &interpolation) in named() {
            let Some(interpolation) = interpolation else { continue };
            let dynamics = Dynamics {
                angular_frequency: mode.angular_frequency,
                rate: mode.total_damping(rate),
            };
            let force = times_areas(&mode.closure);
            let recurrence = dynamics.recurrence(step, interpolation);
            for (row, g) in coupling.iter_mut().zip(&mode.closure) {
                for (entry, gs) in row.iter_mut().zip(&force) {
                    *entry += g * gs * recurrence.contact[0];
                }
            }
            modes.push(ModeStep {
                dynamics,
                interpolation,
                recurrence,
                closure: mode.closure.clone(),
                force,
                drive: mode.drive,
                output: mode.output,
            });
        }
        let output_pressure = times_areas(&residual.output);
        Self { step, interpolations, modes, coupling, output_pressure, residual }
    }
}

/// The interpolation of force for an oscillator of `turn` radians in a step, under contact
/// stiffnesses at rest and at most over its inertia, and a damping rate `damping`, times the step
/// squared and once.
fn interpolation(turn: f64, [rest, most]: [f64; 2], damping: f64) -> ForceInterpolation {
    // Two equal bodies in contact have twice the stiffness of each of them.
    let coupled = turn * turn + 2.0 * most;
    // The stiffness that a mode of its own frequency sees on average is about that at rest.
    let stiff = if most < WEAK * turn * turn { rest } else { most };
    let squared = turn * turn + stiff;
    let growth = stiff * (squared - DAMPED * DAMPED / squared) / 48.0;
    let harmless = coupled <= DAMPED || growth <= GROWTH_SHARE * 0.5 * damping;
    if harmless { ForceInterpolation::Quartic } else { ForceInterpolation::Average }
}
