//! Stability of periodic motions by Floquet multipliers.
//!
//! A small disturbance of a periodic motion obeys, in the modes of the structure,
//!
//! ```text
//! q'' + h q' + (W^2 + Phi^T K(t) Phi) q = 0,    K(t) = (1 + K_c(t) R)^-1 K_c(t),
//! ```
//!
//! with the contact tangents `K_c = diag(S dp/dd)` along the motion and the residual flexibility R
//! in series with them. The state after one period is the monodromy matrix times the state before;
//! its eigenvalues are the multipliers, as many as there are states. The motion is stable if all lie
//! within the unit circle. Damped contacts, of traction `t(x, x')`, have the tangents `S dt/dx`, and
//! add `Phi^T C(t) Phi q'` with the dampers `C_c = diag(S dt/dx')`; both are zero where the faces
//! carry nothing. Bodies with internal damping add `K D K`, D being the retardation of the flexibility
//! R. Friction elements are springs while they stick. An element that slips in the period adds the state
//! of its slider, with a multiplier of zero; an element that never slips adds no state.
//!
//! | module | holds |
//! |---|---|
//! | `variational_equation` | the linear equation above |
//! | `period` | the contacts' tangents over a period |
//! | `modal_contacts` | many contacts in the coordinates of few modes |
//! | `stick_slip`, `friction_monodromy` | phases of friction elements; the monodromy matrix through them |
//! | `splitting` | the monodromy matrix by exact rotations and kicks, for modes of one damping rate |
//! | `runge_kutta` | the same by the classical method, for the others |

mod friction_monodromy;
mod modal_contacts;
mod period;
mod runge_kutta;
mod splitting;
mod stick_slip;
#[cfg(test)]
mod tests;
mod variational_equation;

use asperity_structure::PreloadedContact;
use faer::Mat;
use num_complex::Complex64;

use crate::{ContactSystem, HarmonicError};
use friction_monodromy::FrictionMonodromy;
use period::{MANY, Period};
use runge_kutta::RungeKutta;
use splitting::Splitting;
use variational_equation::VariationalEquation;

/// Settings of the stability analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Floquet {
    /// Modes of the structure that disturbances are resolved in, in component modes beside the rigid
    /// motions; the others are flexible but have no motion of their own.
    pub modes: usize,
}

impl Default for Floquet {
    /// Six modes.
    fn default() -> Self {
        Self { modes: 6 }
    }
}

impl Floquet {
    /// Most modes accepted.
    pub const MOST_MODES: usize = 200;

    pub(crate) fn check(self) -> Result<(), HarmonicError> {
        if (1..=Self::MOST_MODES).contains(&self.modes) {
            Ok(())
        } else {
            let quantity = "modes for stability";
            let value = self.modes as f64;
            Err(HarmonicError::Setting { quantity, value, accepted: "1 to 200" })
        }
    }
}

/// Computes multipliers; keeps its memory from point to point.
#[derive(Debug)]
pub(crate) struct FloquetSolver<'a> {
    system: &'a ContactSystem,
    variation: VariationalEquation,
    integration: Integration,
    period: Period,
}

#[derive(Debug)]
enum Integration {
    Splitting(Splitting),
    RungeKutta(RungeKutta),
    Friction(Box<FrictionMonodromy>),
}

impl<'a> FloquetSolver<'a> {
    pub(crate) fn new(system: &'a ContactSystem, floquet: Floquet) -> Result<Self, HarmonicError> {
        let springs: Vec<f64> = system.contacts().iter().map(PreloadedContact::spring).collect();
        let modes = system.linear().lowest_modes(floquet.modes)?;
        let mut variation =
            VariationalEquation::new(&modes, system.linear().mass_damping(), &springs);
        let rate = system.linear().mass_damping();
        variation.add_dampers(system.linear().damped_modes(), rate, &springs);
        // Dampers of the contacts, and of static modes, couple the rates of the others.
        let friction = system.friction().is_some();
        let plain = !friction && !system.is_damped() && !variation.is_retarded();
        let plain = plain && system.contacts().len() < MANY;
        let splitting = plain.then(|| Splitting::new(&mut variation, &springs)).flatten();
        let (integration, places) = match splitting {
            Some(splitting) => (Integration::Splitting(splitting), &splitting::PLACES[..]),
            None if friction => (Integration::Friction(Box::default()), &[][..]),
            None => (Integration::RungeKutta(RungeKutta::default()), &runge_kutta::PLACES[..]),
        };
        // Matrices of the modes need less work, unless the contacts are fewer than half as many.
        let contacts = system.contacts().len();
        let many = contacts >= MANY || 2 * contacts > variation.modes.len();
        let period = match &integration {
            Integration::RungeKutta(_) if many => Period::modal(places, &variation),
            _ => Period::new(places),
        };
        Ok(Self { system, variation, integration, period })
    }

    /// The multipliers of the motion with these closures' series, largest first; NaN if they cannot
    /// be computed, and none where a mode is too fast to be integrated over a period.
    pub(crate) fn multipliers(
        &mut self,
        closures: &[f64],
        angular_frequency: f64,
    ) -> Option<Vec<Complex64>> {
        let monodromy = self.monodromy(closures, angular_frequency)?;
        let mut multipliers = eigenvalues(&monodromy);
        multipliers.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()));
        Some(multipliers)
    }

    fn monodromy(&mut self, closures: &[f64], w: f64) -> Option<Mat<f64>> {
        let Self { system, variation, integration, period } = self;
        match integration {
            Integration::Splitting(splitting) => {
                period.resolve(system, variation, (closures, w), Splitting::steps)?;
                Some(splitting.monodromy(period, w))
            }
            Integration::RungeKutta(method) => {
                period.resolve(system, variation, (closures, w), RungeKutta::steps)?;
                Some(method.monodromy(variation, period, w))
            }
            Integration::Friction(friction) => friction.compute(system, variation, closures, w),
        }
    }
}

fn eigenvalues(matrix: &Mat<f64>) -> Vec<Complex64> {
    let size = matrix.nrows();
    if size == 2 {
        // In closed form, without a call for every point of a simple system.
        let (a, b, c, d) = (matrix[(0, 0)], matrix[(0, 1)], matrix[(1, 0)], matrix[(1, 1)]);
        let (mean, half) = (0.5 * (a + d), 0.5 * (a - d));
        let root = Complex64::new(half * half + b * c, 0.0).sqrt();
        return vec![Complex64::new(mean, 0.0) + root, Complex64::new(mean, 0.0) - root];
    }
    let finite = (0..size).all(|j| (0..size).all(|i| matrix[(i, j)].is_finite()));
    let nothing = || vec![Complex64::new(f64::NAN, f64::NAN); size];
    if finite { matrix.eigenvalues().unwrap_or_else(|_| nothing()) } else { nothing() }
}
