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
//! | `koopman_hill` | the monodromy matrix projected from Hill's matrix |
//! | `runge_kutta` | the same by integration in time |
//! | `variational_equation` | the linear equation above |

mod koopman_hill;
mod runge_kutta;
mod variational_equation;

use faer::Mat;
use num_complex::Complex64;

use crate::balance::Balance;
use crate::{ContactSystem, HarmonicError};
use koopman_hill::KoopmanHill;
use runge_kutta::RungeKutta;
use variational_equation::VariationalEquation;

/// Method of computing the monodromy matrix.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum FloquetMethod {
    /// Hill's matrix, projected: the disturbance and its products with the harmonics of the motion
    /// obey a constant matrix; its exponential, applied to a disturbance and all its products,
    /// gives the disturbance later. Applied over parts of a period, to keep the truncation of the
    /// matrix below rounding. Converges exponentially with the harmonics of a smooth stiffness.
    ///
    /// Source: F. Bayer, R. Leine, Nonlinear Dyn. 2023, 111, 8439, doi 10.1007/s11071-023-08247-7.
    KoopmanHill,
    /// The classical Runge-Kutta method of fourth order in time. Cheaper, and the better of the
    /// two where contact is lost and the stiffness has many harmonics.
    #[default]
    RungeKutta,
}

/// Settings of the stability analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Floquet {
    /// The method.
    pub method: FloquetMethod,
    /// Modes of the structure that disturbances are resolved in; the others are flexible but have
    /// no motion of their own. A system of a few masses keeps all of its modes.
    pub modes: usize,
}

impl Default for Floquet {
    /// By integration in time, on six modes.
    fn default() -> Self {
        Self { method: FloquetMethod::RungeKutta, modes: 6 }
    }
}

impl Floquet {
    /// Most modes accepted.
    pub const MOST_MODES: usize = 200;

    pub(crate) fn check(&self) -> Result<(), HarmonicError> {
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
    method: Method,
}

#[derive(Debug)]
enum Method {
    KoopmanHill(KoopmanHill),
    RungeKutta(RungeKutta),
}

impl FloquetSolver {
    pub(crate) fn new(system: &ContactSystem, floquet: Floquet) -> Result<Self, HarmonicError> {
        let modes = system.linear().lowest_modes(floquet.modes)?;
        let variation = VariationalEquation::new(&modes, system.linear().mass_damping());
        let method = match floquet.method {
            FloquetMethod::KoopmanHill => Method::KoopmanHill(KoopmanHill::default()),
            FloquetMethod::RungeKutta => Method::RungeKutta(RungeKutta::default()),
        };
        Ok(Self { variation, method })
    }

    /// The multipliers of the motion that the balance evaluated last, largest first; NaN if they
    /// cannot be computed.
    pub(crate) fn multipliers(
        &mut self,
        balance: &Balance<'_>,
        closures: &[f64],
        angular_frequency: f64,
    ) -> Vec<Complex64> {
        let monodromy = match &mut self.method {
            Method::KoopmanHill(method) => {
                method.monodromy(&mut self.variation, balance, angular_frequency)
            }
            Method::RungeKutta(method) => {
                method.monodromy(&mut self.variation, balance, closures, angular_frequency)
            }
        };
        let mut multipliers = eigenvalues(&monodromy);
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        multipliers
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
