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
//! within the unit circle.
//!
//! | module | holds |
//! |---|---|
//! | `runge_kutta` | the monodromy matrix by integration in time |
//! | `variational_equation` | the linear equation above |

mod runge_kutta;
mod variational_equation;

use faer::Mat;
use num_complex::Complex64;

use crate::balance::Balance;
use crate::{ContactSystem, HarmonicError};
use runge_kutta::RungeKutta;
use variational_equation::VariationalEquation;

/// Settings of the stability analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Floquet {
    /// Modes of the structure that disturbances are resolved in; the others are flexible but have
    /// no motion of their own. A system of a few masses keeps all of its modes.
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
pub(crate) struct FloquetSolver {
    variation: VariationalEquation,
    integration: RungeKutta,
}

impl FloquetSolver {
    pub(crate) fn new(system: &ContactSystem, floquet: Floquet) -> Result<Self, HarmonicError> {
        let modes = system.linear().lowest_modes(floquet.modes)?;
        let variation = VariationalEquation::new(&modes, system.linear().mass_damping());
        Ok(Self { variation, integration: RungeKutta::default() })
    }

    /// The multipliers of the motion that the balance evaluated last, largest first; NaN if they
    /// cannot be computed, and none where a mode is too fast to be integrated over a period.
    pub(crate) fn multipliers(
        &mut self,
        balance: &Balance<'_>,
        closures: &[f64],
        angular_frequency: f64,
    ) -> Option<Vec<Complex64>> {
        let variation = &mut self.variation;
        let monodromy =
            self.integration.monodromy(variation, balance, closures, angular_frequency)?;
        let mut multipliers = eigenvalues(&monodromy);
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Some(multipliers)
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
