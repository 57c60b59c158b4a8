//! All numbers of a step that do not depend on the load.

use std::f64::consts::TAU;

use super::oscillator::{Dynamics, ForceInterpolation, Recurrence};
use super::row_modes::{RowFlexibility, RowMode, RowModes};

/// Share of a radian of the lowest natural frequency in a step: the quartic through five
/// pressures then changes the damping ratio by `(w h)^5 / 100`, less than one millionth.
const RADIANS: f64 = 0.095;

/// Square of the radians in a step, 1.2, up to which the quartic damps an oscillation of a mode and the
/// contact springs. Faster oscillations would grow; the mean of both ends has a larger error, of second
/// order, but keeps the energy of any linear contact exactly, at any frequency.
const DAMPED: f64 = 1.44;

/// Radians in a step beyond which a mode counts as following its forces at once. A step cannot
/// show such an oscillation, and under a force that is frozen within the step it can even grow.
pub(super) const FAST: f64 = 2.0;

/// Lag of a mode without inertia behind its force, over the step, below which the lag is neglected.
pub(super) const LAG: f64 = 1e-3;

/// Choice of the interpolation of the contact force for each mode.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum InterpolationChoice {
    /// The quartic for all modes that turn slowly enough, the mean of both ends for the others.
    #[default]
    HighestOrder,
    /// The mean of both ends for all modes: no linear contact gains energy, at any stiffness.
    Average,
}

impl InterpolationChoice {
    /// The interpolation of the contact force for each mode at `step` \[s\]: none for a mode that counts
    /// as flexibility, linear for one that counts as flexibility with damping of its own. What
    /// mass-proportional damping takes from so fast a mode is negligible.
    fn of(
        self,
        modes: &[RowMode],
        areas: &[f64],
        stiffness: &[f64],
        step: f64,
    ) -> Vec<Option<ForceInterpolation>> {
        let mut interpolations = vec![ForceInterpolation::Average; modes.len()];
        if self == Self::HighestOrder {
            for k in slow_modes(modes, areas, stiffness, step, DAMPED) {
                interpolations[k] = ForceInterpolation::Quartic;
            }
        }
        let of = |(mode, interpolation): (&RowMode, ForceInterpolation)| {
            let w = mode.angular_frequency;
            if !mode.massless && w * step <= FAST {
                return Some(interpolation);
            }
            let lag = mode.damping_rate / (w * w);
            (lag > LAG * step).then_some(ForceInterpolation::Linear)
        };
        modes.iter().zip(interpolations).map(of).collect()
    }
}

/// Longest step \[s\] that is chosen for a structure of this lowest natural frequency \[Hz\].
pub(super) fn longest_step(natural_frequency: f64) -> f64 {
    RADIANS / (TAU * natural_frequency)
}

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
    /// Participations of the load port and of each sensor.
    pub(super) load: f64,
    pub(super) sensors: Vec<f64>,
}

/// A structure and its contacts for one step length.
#[derive(Debug, Clone)]
pub(super) struct StepModel {
    pub(super) step: f64,
    /// Interpolation of the contact force on every mode of the structure, linear for those without
    /// inertia; none for those left out.
    pub(super) interpolations: Vec<Option<ForceInterpolation>>,
    pub(super) modes: Vec<ModeStep>,
    /// Closure lost at once at interface i per pressure increment at j \[m/Pa\].
    pub(super) coupling: Vec<Vec<f64>>,
    /// Each sensor per pressure at each row, of the modes left out \[m/Pa\].
    pub(super) sensors_per_pressure: Vec<Vec<f64>>,
    /// Flexibility of the modes left out, those too fast for the step included.
    pub(super) residual: RowFlexibility,
}

impl StepModel {
    /// The model of `structure` with contact `areas` \[m2\] under mass-proportional damping `rate`
    /// \[1/s\] at `step` \[s\]; `stiffness` \[Pa/m\] is the highest expected at each contact.
    pub(super) fn new(
        structure: &RowModes,
        areas: &[f64],
        stiffness: &[f64],
        rate: f64,
        step: f64,
        choice: InterpolationChoice,
    ) -> Self {
        let interpolations = choice.of(&structure.modes, areas, stiffness, step);
        Self::with_interpolations(structure, areas, rate, step, interpolations)
    }

    /// The model of [`new`](Self::new) with the interpolations of another, so that results are
    /// continuous in the parameters of a scenario.
    pub(super) fn with_interpolations(
        structure: &RowModes,
        areas: &[f64],
        rate: f64,
        step: f64,
        interpolations: Vec<Option<ForceInterpolation>>,
    ) -> Self {
        let mut residual = structure.residual.clone();
        let times_areas =
            |row: &[f64]| -> Vec<f64> { row.iter().zip(areas).map(|(r, area)| r * area).collect() };
        let named = || structure.modes.iter().zip(&interpolations);
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
                massless: interpolation == ForceInterpolation::Linear,
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
                load: mode.load,
                sensors: mode.sensors.clone(),
            });
        }
        let sensors_per_pressure = residual.sensors.iter().map(|row| times_areas(row)).collect();
        Self { step, interpolations, modes, coupling, sensors_per_pressure, residual }
    }
}

/// The modes that turn by no more than the root of `squared_radians` in a step \[s\], contact springs
/// included: the slowest first, as long as all of them turn slowly enough together.
///
/// With `A_km = sum_i g_ki g_mi S_i K_i h^2` the contact springs between modes k and m, no
/// oscillation of them turns faster than the largest
/// `(w_k h)^2 + sum_m |A_km|` (Gershgorin).
pub(super) fn slow_modes(
    modes: &[RowMode],
    areas: &[f64],
    stiffness: &[f64],
    step: f64,
    squared_radians: f64,
) -> Vec<usize> {
    let spring = |a: &RowMode, b: &RowMode| -> f64 {
        let shapes = a.closure.iter().zip(&b.closure).zip(areas.iter().zip(stiffness));
        shapes.map(|((g, other), (area, k))| g * other * area * k * step * step).sum()
    };
    let squared = |mode: &RowMode| (mode.angular_frequency * step).powi(2);
    let alone = |mode: &RowMode| squared(mode) + spring(mode, mode);
    let mut order: Vec<usize> = (0..modes.len()).filter(|&k| !modes[k].massless).collect();
    order.sort_by(|&a, &b| alone(&modes[a]).total_cmp(&alone(&modes[b])));
    // Those found so far, and their sums.
    let mut slow: Vec<(usize, f64)> = Vec::new();
    for k in order {
        let springs: Vec<f64> =
            slow.iter().map(|&(m, _)| spring(&modes[k], &modes[m]).abs()).collect();
        let own = alone(&modes[k]) + springs.iter().sum::<f64>();
        let sums = slow.iter().zip(&springs).map(|((_, sum), spring)| sum + spring);
        // Written so that what is not a number is not slow.
        if sums.fold(own, f64::max) <= squared_radians && own <= squared_radians {
            for ((_, sum), spring) in slow.iter_mut().zip(&springs) {
                *sum += spring;
            }
            slow.push((k, own));
        }
    }
    slow.into_iter().map(|(k, _)| k).collect()
}
