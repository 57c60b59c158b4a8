//! Linearised modes of any structure in component modes, with their participations at ports.

use std::f64::consts::TAU;

use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, Side};

use crate::contact::check_springs;
use crate::{PreloadedContact, PreloadedStructure, StructureError};

/// One undamped mode about static equilibrium, of a structure in component modes.
#[derive(Debug, Clone, PartialEq)]
pub struct PortMode {
    /// Natural frequency \[Hz\]; zero for a motion that no stiffness holds.
    pub frequency_hz: f64,
    /// Damping ratio, `phi^T C phi / (2 w)` with the mass-normalised shape; of first order in the damping,
    /// and zero without a frequency.
    pub damping_ratio: f64,
    /// Mass-normalised participation of each port \[kg^-1/2\].
    pub ports: Vec<f64>,
    /// Coordinates along the modes with inertia of the structure.
    pub coordinates: Vec<f64>,
}

/// Share of the largest of the squared frequencies below which one is rounding.
const RIGID: f64 = 1e-13;

/// The equations of a linearised structure in the coordinates of its modes with inertia.
struct Linearised<'a> {
    inert: Vec<&'a NormalMode>,
    massless: Vec<&'a NormalMode>,
    /// Flexibility of all modes without inertia, and of those left out.
    residual: ResidualFlexibility,
    /// Numbers, pairs and springs \[N/m\] of the closed contacts.
    closed: Vec<usize>,
    pairs: Vec<PortPair>,
    springs: Vec<f64>,
    /// Force of each closed contact per coordinate.
    forces: Mat<f64>,
    stiffness: Mat<f64>,
}

impl<'a> Linearised<'a> {
    fn new(modes: &'a ComponentModes, contacts: &[PreloadedContact]) -> Self {
        let (massless, inert): (Vec<_>, Vec<_>) =
            modes.modes().iter().partition(|mode| mode.massless);
        let mut residual = modes.residual().clone();
        for mode in &massless {
            residual.add(mode);
        }
        let closed: Vec<usize> =
            (0..contacts.len()).filter(|&i| contacts[i].spring() > 0.0).collect();
        let pairs: Vec<PortPair> = closed.iter().map(|&i| modes.contacts()[i]).collect();
        let springs: Vec<f64> = closed.iter().map(|&i| contacts[i].spring()).collect();
        let n = closed.len();
        let flexibility = Mat::from_fn(n, n, |i, j| {
            residual.closure(pairs[i], pairs[j]) + if i == j { 1.0 / springs[i] } else { 0.0 }
        });
        let closures = Mat::from_fn(n, inert.len(), |i, m| inert[m].closure(pairs[i]));
        let forces = flexibility.partial_piv_lu().solve(&closures);
        let coupled = closures.transpose() * &forces;
        let stiffness = Mat::from_fn(inert.len(), inert.len(), |a, b| {
            let own = if a == b { inert[a].angular_frequency.powi(2) } else { 0.0 };
            own + 0.5 * (coupled[(a, b)] + coupled[(b, a)])
        });
        Self { inert, massless, residual, closed, pairs, springs, forces, stiffness }
    }

    fn failed(&self) -> StructureError {
        StructureError::Eigenvalues { size: self.inert.len() }
    }
}

/// Eigenvalues of a positive semidefinite matrix, lowest first, and their vectors by columns: by the inverse of the
/// shifted matrix, whose largest eigenvalues the algorithm finds to rounding, which it does not for the
/// lowest ones of a large matrix.
fn lowest_first(matrix: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let size = matrix.nrows();
    let diagonal = (0..size).map(|k| matrix[(k, k)]).filter(|value| *value > 0.0);
    let shift = diagonal.fold(f64::INFINITY, f64::min);
    if !shift.is_finite() {
        return Some((vec![0.0; size], Mat::identity(size, size)));
    }
    let shifted =
        Mat::from_fn(size, size, |i, j| matrix[(i, j)] / shift + if i == j { 1.0 } else { 0.0 });
    let inverse = shifted.llt(Side::Lower).ok()?.inverse();
    let found = inverse.self_adjoint_eigen(Side::Lower).ok()?;
    let values = found.S().column_vector();
    let squares = (0..size).rev().map(|k| shift * (1.0 / values[k] - 1.0)).collect();
    Some((squares, Mat::from_fn(size, size, |i, k| found.U()[(i, size - 1 - k)])))
}

/// The lowest frequency \[Hz\] of a structure, rigid motions that nothing holds apart.
pub(crate) fn lowest_frequency(
    modes: &ComponentModes,
    contacts: &[PreloadedContact],
) -> Result<f64, StructureError> {
    check_springs(contacts)?;
    let equations = Linearised::new(modes, contacts);
    let squares = equations.stiffness.self_adjoint_eigenvalues(Side::Lower);
    let squares = squares.map_err(|_| equations.failed())?;
    let largest = squares.iter().copied().fold(0.0, f64::max);
    let lowest = squares.iter().copied().find(|square| *square > RIGID * largest);
    Ok(lowest.ok_or_else(|| equations.failed())?.sqrt() / TAU)
}

impl PreloadedStructure<ComponentModes> {
    /// The lowest `count` modes linearised at rest, or all that the component modes have.
    ///
    /// Closed contacts are springs of stiffness `k = K(p0) S`, open ones none. With the closures B of the
    /// modes with inertia and the flexibility R of all others
    ///
    /// ```text
    /// (w_n^2 + B^T (1/k + R)^-1 B) q = w^2 q,    u = Phi q - R (1/k + R)^-1 B q.
    /// ```
    ///
    /// # Errors
    /// [`StructureError::Eigenvalues`] if an eigenvalue computation does not converge.
    pub fn port_modes(&self, count: usize) -> Result<Vec<PortMode>, StructureError> {
        let modes = self.component_modes();
        let equations = Linearised::new(modes, self.contacts());
        let Linearised { inert, massless, residual, closed, pairs, springs, forces, stiffness } =
            &equations;
        let (squares, vectors) = lowest_first(stiffness).ok_or_else(|| equations.failed())?;
        let largest = squares.iter().copied().fold(0.0, f64::max);
        let mode = |k: usize| {
            let w = if squares[k] > RIGID * largest { squares[k].sqrt() } else { 0.0 };
            let coordinates: Vec<f64> = (0..inert.len()).map(|m| vectors[(m, k)]).collect();
            let force = |i: usize| -> f64 {
                coordinates.iter().enumerate().map(|(m, q)| forces[(i, m)] * q).sum()
            };
            let of_contacts: Vec<f64> = (0..closed.len()).map(force).collect();
            let port = |port: usize| {
                let carried: f64 =
                    coordinates.iter().zip(inert).map(|(q, mode)| q * mode.ports[port]).sum();
                let ground = PortPair::on_ground(port);
                let yielded = pairs.iter().zip(&of_contacts);
                carried - yielded.map(|(&pair, f)| residual.closure(ground, pair) * f).sum::<f64>()
            };
            let rate = self.damping_rate();
            let bodies = coordinates.iter().zip(inert);
            let bodies = bodies.map(|(q, mode)| mode.total_damping(rate) * q * q).sum::<f64>();
            let left_out = massless.iter().map(|mode| {
                let along = pairs.iter().zip(&of_contacts);
                let force: f64 = along.map(|(&pair, force)| mode.closure(pair) * force).sum();
                mode.damping_rate * (force / mode.angular_frequency.powi(2)).powi(2)
            });
            let dampers = closed
                .iter()
                .zip(springs)
                .zip(&of_contacts)
                .map(|((&i, k), force)| self.contacts()[i].damper() * (force / k).powi(2));
            let loss = bodies + left_out.sum::<f64>() + dampers.sum::<f64>();
            PortMode {
                frequency_hz: w / TAU,
                damping_ratio: if w > 0.0 { loss / (2.0 * w) } else { 0.0 },
                ports: (0..modes.ports()).map(port).collect(),
                coordinates,
            }
        };
        Ok((0..inert.len().min(count)).map(mode).collect())
    }
}
