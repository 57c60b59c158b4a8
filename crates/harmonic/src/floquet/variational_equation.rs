//! The linear equation of small disturbances.

use asperity_mesh::{ComponentModes, NormalMode, ResidualFlexibility};

/// Modes with contact tangents that vary over the period.
///
/// The state is `(q, q' / s)` with a rate s of the order of the highest frequency, so that both
/// halves are of one size.
#[derive(Debug, Clone)]
pub(super) struct VariationalEquation {
    /// The modes, each with its total damping rate.
    pub(super) modes: Vec<NormalMode>,
    residual: ResidualFlexibility,
    matrix: Vec<f64>,
}

impl VariationalEquation {
    /// The equation of `modes` under the mass-proportional damping `rate` \[1/s\].
    pub(super) fn new(modes: &ComponentModes, rate: f64) -> Self {
        let (n, residual) = (modes.interfaces(), modes.residual().clone());
        let mut modes = modes.modes().to_vec();
        for mode in &mut modes {
            mode.damping_rate = mode.total_damping(rate);
            mode.mass_damped = false;
        }
        Self { modes, residual, matrix: vec![0.0; 2 * n * n] }
    }

    pub(super) fn interfaces(&self) -> usize {
        self.residual.closure.len()
    }

    /// An upper estimate of the highest frequency [rad/s] with contact stiffnesses up to
    /// `stiffness` [N/m].
    pub(super) fn highest_frequency(&self, stiffness: f64) -> f64 {
        let square = |mode: &NormalMode| {
            let shape: f64 = mode.closure.iter().map(|phi| phi * phi).sum();
            mode.angular_frequency.powi(2) + stiffness * shape
        };
        self.modes.iter().map(square).fold(0.0, f64::max).sqrt()
    }

    /// Writes `(1 + K_c R)^-1 K_c` for the tangents `K_c` \[N/m\] of the contacts, by rows.
    ///
    /// The residual flexibility is positive, so that elimination needs no exchanges: in the order
    /// of the rows, `1 + K_c R` keeps positive pivots.
    pub(super) fn stiffness(&mut self, tangents: impl Fn(usize) -> f64, out: &mut [f64]) {
        let n = self.interfaces();
        if n == 1 {
            let k = tangents(0);
            out[0] = k / (1.0 + k * self.residual.closure[0][0]);
            return;
        }
        let width = 2 * n;
        self.matrix.fill(0.0);
        for i in 0..n {
            let k = tangents(i);
            for j in 0..n {
                self.matrix[i * width + j] = k * self.residual.closure[i][j];
            }
            self.matrix[i * width + i] += 1.0;
            self.matrix[i * width + n + i] = k;
        }
        for column in 0..n {
            let pivot = self.matrix[column * width + column];
            for j in column..width {
                self.matrix[column * width + j] /= pivot;
            }
            for row in (0..n).filter(|&row| row != column) {
                let factor = self.matrix[row * width + column];
                for j in column..width {
                    self.matrix[row * width + j] -= factor * self.matrix[column * width + j];
                }
            }
        }
        for i in 0..n {
            out[i * n..(i + 1) * n].copy_from_slice(&self.matrix[i * width + n..(i + 1) * width]);
        }
    }
}
