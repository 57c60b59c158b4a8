//! A linear structure in its modes.

use faer::c64;
use faer::prelude::Solve;
use faer::{Mat, linalg::solvers::Svd};

use crate::error::{HarmonicError, not_negative};
use crate::{Compliance, LinearSystem, MeanBalance, Receptance};

/// A structure without its contacts, in mass-normalised modes and a residual flexibility.
///
/// Mode j has the angular frequency `w_j` (zero for a rigid motion), the damping rate `h_j`, the
/// closure `phi_j` it makes at each interface and its displacement `psi_j` at the driving point:
///
/// ```text
/// q_j'' + h_j q_j' + w_j^2 q_j = psi_j f - phi_j . P,
/// x = sum_j phi_j q_j - R P + r f,    u = sum_j psi_j q_j - r . P + r0 f,
/// ```
///
/// R, r and r0 being the static flexibility of modes left out.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalSystem {
    interfaces: usize,
    frequency: Vec<f64>,
    rate: Vec<f64>,
    /// By modes, `interfaces` values each.
    closure: Vec<f64>,
    drive: Vec<f64>,
    residual: Vec<f64>,
    residual_drive: Vec<f64>,
    residual_direct: f64,
}

/// Part of the largest singular value below which a rigid motion is not held by contacts.
const HELD: f64 = 1e-9;

impl ModalSystem {
    /// A structure with `interfaces` interfaces, as yet without modes.
    pub fn empty(interfaces: usize) -> Self {
        Self {
            interfaces,
            frequency: Vec::new(),
            rate: Vec::new(),
            closure: Vec::new(),
            drive: Vec::new(),
            residual: vec![0.0; interfaces * interfaces],
            residual_drive: vec![0.0; interfaces],
            residual_direct: 0.0,
        }
    }

    /// Adds a mode of angular frequency \[rad/s\], zero if rigid, damping rate h \[1/s\],
    /// mass-normalised closures at the interfaces \[kg^-1/2\] (as many as there are interfaces) and
    /// displacement at the driving point \[kg^-1/2\].
    pub fn push(&mut self, angular_frequency: f64, rate: f64, closure: &[f64], drive: f64) {
        self.frequency.push(angular_frequency);
        self.rate.push(rate);
        self.closure.extend((0..self.interfaces).map(|i| closure.get(i).copied().unwrap_or(0.0)));
        self.drive.push(drive);
    }

    /// Adds to the residual flexibility \[m/N\] between two interfaces.
    pub fn add_residual(&mut self, row: usize, column: usize, flexibility: f64) {
        self.residual[row * self.interfaces + column] += flexibility;
    }

    /// Adds to the residual flexibility \[m/N\] between the driving point and an interface.
    pub fn add_residual_drive(&mut self, interface: usize, flexibility: f64) {
        self.residual_drive[interface] += flexibility;
    }

    /// Adds to the residual flexibility \[m/N\] at the driving point.
    pub fn add_residual_direct(&mut self, flexibility: f64) {
        self.residual_direct += flexibility;
    }

    /// Number of modes.
    pub fn modes(&self) -> usize {
        self.frequency.len()
    }

    /// Angular frequency of each mode \[rad/s\].
    pub fn frequency(&self) -> &[f64] {
        &self.frequency
    }

    /// Damping rate of each mode \[1/s\].
    pub fn rate(&self) -> &[f64] {
        &self.rate
    }

    /// Closures of mode `mode` at the interfaces \[kg^-1/2\].
    pub fn closure(&self, mode: usize) -> &[f64] {
        &self.closure[mode * self.interfaces..(mode + 1) * self.interfaces]
    }

    /// Displacement of each mode at the driving point \[kg^-1/2\].
    pub fn drive(&self) -> &[f64] {
        &self.drive
    }

    /// Residual flexibility between two interfaces \[m/N\].
    pub fn residual(&self, row: usize, column: usize) -> f64 {
        self.residual[row * self.interfaces + column]
    }

    /// Residual flexibility between the driving point and each interface \[m/N\].
    pub fn residual_drive(&self) -> &[f64] {
        &self.residual_drive
    }

    fn rigid(&self) -> Vec<usize> {
        (0..self.modes()).filter(|&j| self.frequency[j] == 0.0).collect()
    }

    fn rigid_closures(&self, rigid: &[usize]) -> Mat<f64> {
        Mat::from_fn(self.interfaces, rigid.len(), |i, r| self.closure(rigid[r])[i])
    }

    fn held(&self, rigid: &[usize]) -> usize {
        let values = self.rigid_closures(rigid).singular_values().unwrap_or_default();
        let largest = values.iter().copied().fold(0.0, f64::max);
        values.iter().filter(|&&value| value > HELD * largest).count()
    }

    /// Static flexibility of the elastic modes and the residual, between interfaces and, in the
    /// last row, at the driving point per contact force.
    fn elastic(&self) -> Mat<f64> {
        let n = self.interfaces;
        Mat::from_fn(n + 1, n, |row, column| {
            let shape = |j: usize| if row < n { self.closure(j)[row] } else { self.drive[j] };
            let modes: f64 = (0..self.modes())
                .filter(|&j| self.frequency[j] > 0.0)
                .map(|j| shape(j) * self.closure(j)[column] / self.frequency[j].powi(2))
                .sum();
            let residual =
                if row < n { self.residual(row, column) } else { self.residual_drive[column] };
            modes + residual
        })
    }
}

impl LinearSystem for ModalSystem {
    fn interfaces(&self) -> usize {
        self.interfaces
    }

    fn compliance(&self, w: f64, anti_damping: f64, into: &mut Compliance) {
        let n = self.interfaces;
        let constant = |value| Receptance { value: c64::new(value, 0.0), ..Receptance::default() };
        for row in 0..n {
            for column in 0..n {
                *into.contact_mut(row, column) = constant(self.residual(row, column));
            }
            *into.drive_mut(row) = constant(self.residual_drive[row]);
        }
        into.direct = constant(self.residual_direct);
        for j in 0..self.modes() {
            let rate = self.rate[j] - anti_damping;
            let value = c64::new(self.frequency[j].powi(2) - w * w, w * rate).inv();
            let by_frequency = -value * value * c64::new(-2.0 * w, rate);
            let by_rate = value * value * c64::new(0.0, w);
            let add = |to: &mut Receptance, factor: f64| {
                to.value += value * factor;
                to.by_frequency += by_frequency * factor;
                to.by_rate += by_rate * factor;
            };
            let shape = self.closure(j);
            for row in 0..n {
                for column in 0..n {
                    add(into.contact_mut(row, column), shape[row] * shape[column]);
                }
                add(into.drive_mut(row), shape[row] * self.drive[j]);
            }
            add(&mut into.direct, self.drive[j] * self.drive[j]);
        }
    }

    fn check(&self) -> Result<(), HarmonicError> {
        for (&w, &h) in self.frequency.iter().zip(&self.rate) {
            not_negative("modal angular frequency [rad/s]", w)?;
            not_negative("modal damping rate [1/s]", h)?;
        }
        let rigid = self.rigid();
        let held = self.held(&rigid);
        if held < rigid.len() {
            return Err(HarmonicError::Floating { free: rigid.len(), held });
        }
        Ok(())
    }

    /// Rigid motions carry no mean force, `phi_rigid . P0 = 0`; across them the closures are
    /// elastic, `N^T (X0 + G P0) = 0` with N orthogonal to the rigid closures.
    fn mean_balance(&self) -> MeanBalance {
        let n = self.interfaces;
        let rigid = self.rigid();
        let elastic = self.elastic();
        let mut balance = MeanBalance {
            closure: vec![0.0; n * n],
            force: vec![0.0; n * n],
            output_closure: vec![0.0; n],
            output_force: (0..n).map(|i| -elastic[(n, i)]).collect(),
        };
        let closures = self.rigid_closures(&rigid);
        let Ok(svd) = Svd::new(closures.as_ref()) else {
            return balance;
        };
        let (left, held) = (svd.U(), self.held(&rigid));
        for row in 0..n {
            for column in 0..n {
                if row < held {
                    balance.force[row * n + column] = left[(column, row)];
                } else {
                    balance.closure[row * n + column] = left[(column, row)];
                    balance.force[row * n + column] =
                        (0..n).map(|i| left[(i, row)] * elastic[(i, column)]).sum();
                }
            }
        }
        if !rigid.is_empty() && held == rigid.len() {
            // The rigid motions from the closures, Phi q = X0 + G P0, by least squares.
            let squares = closures.transpose() * &closures;
            let drive = Mat::from_fn(rigid.len(), 1, |r, _| self.drive[rigid[r]]);
            let weights = &closures * squares.partial_piv_lu().solve(&drive);
            for i in 0..n {
                balance.output_closure[i] = weights[(i, 0)];
                balance.output_force[i] +=
                    (0..n).map(|row| weights[(row, 0)] * elastic[(row, i)]).sum::<f64>();
            }
        }
        balance
    }

    fn modal(&self, _count: usize) -> Self {
        self.clone()
    }
}
