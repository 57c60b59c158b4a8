//! Stiffness and damping of many contacts in the coordinates of few modes.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Mat, Par, Side};

use super::variational_equation::VariationalEquation;

/// `Phi^T (1 + K_c R)^-1 K_c Phi` and the damping of the contacts in the same coordinates, without the matrices of the
/// pairs. With `s = K_c^1/2` and the Cholesky factor `L L^T = 1 + s R s`, which only contacts that carry enter,
///
/// ```text
/// Y = L^-1 s Phi,   Phi^T K Phi = Y^T Y,   K Phi = s L^-T Y,   A Phi = Phi - R K Phi.
/// ```
#[derive(Debug, Clone)]
pub(super) struct ModalContacts {
    /// Participations, a row for each pair.
    shapes: Mat<f64>,
    flexibility: Mat<f64>,
    /// Retardation of the static modes, if they are damped.
    retardation: Option<Mat<f64>>,
}

impl ModalContacts {
    pub(super) fn new(variation: &VariationalEquation) -> Self {
        let (n, modes) = (variation.interfaces(), &variation.modes);
        let retardation = variation.retardation();
        Self {
            shapes: Mat::from_fn(n, modes.len(), |i, r| modes[r].closure[i]),
            flexibility: Mat::from_fn(n, n, |i, j| variation.flexibility()[i][j]),
            retardation: variation
                .is_retarded()
                .then(|| Mat::from_fn(n, n, |i, j| retardation[i * n + j])),
        }
    }

    /// Writes the stiffness for the tangents `K_c` \[N/m\], a row for each mode, and, unless `damping` is empty, the
    /// damping for the contact dampers `C_c` \[N s/m\], [`VariationalEquation::damping`] in the coordinates of the modes.
    /// Tangents that are not finite give numbers that are not.
    pub(super) fn write(
        &self,
        tangents: impl Fn(usize) -> f64,
        dampers: impl Fn(usize) -> f64,
        stiffness: &mut [f64],
        damping: &mut [f64],
    ) {
        let (pairs, modes) = (self.shapes.nrows(), self.shapes.ncols());
        let active: Vec<usize> = (0..pairs).filter(|&i| tangents(i) != 0.0).collect();
        let roots: Vec<f64> = active.iter().map(|&i| tangents(i).sqrt()).collect();
        let n = active.len();
        let coupled = Mat::from_fn(n, n, |i, j| {
            let unit = f64::from(u8::from(i == j));
            unit + roots[i] * self.flexibility[(active[i], active[j])] * roots[j]
        });
        let mut y = Mat::from_fn(n, modes, |i, r| roots[i] * self.shapes[(active[i], r)]);
        // Positive definite with pivots of one at least: the flexibility is not negative.
        let Ok(factor) = coupled.llt(Side::Lower) else {
            stiffness.fill(f64::NAN);
            return damping.fill(f64::NAN);
        };
        solve_lower_triangular_in_place(factor.L(), y.as_mut(), Par::Seq);
        write_rows(&(y.transpose() * &y), stiffness);
        if damping.is_empty() {
            return;
        }
        solve_upper_triangular_in_place(factor.L().transpose(), y.as_mut(), Par::Seq);
        let mut forces = Mat::zeros(pairs, modes);
        for (i, &pair) in active.iter().enumerate() {
            (0..modes).for_each(|r| forces[(pair, r)] = roots[i] * y[(i, r)]);
        }
        let mut found = Mat::zeros(modes, modes);
        if (0..pairs).any(|i| dampers(i) != 0.0) {
            let share = &self.shapes - &self.flexibility * &forces;
            let weighted = Mat::from_fn(pairs, modes, |i, r| dampers(i) * share[(i, r)]);
            matmul(&mut found, Accum::Add, share.transpose(), &weighted, 1.0, Par::Seq);
        }
        if let Some(retardation) = &self.retardation {
            let lag = retardation * &forces;
            matmul(&mut found, Accum::Add, forces.transpose(), &lag, 1.0, Par::Seq);
        }
        write_rows(&found, damping);
    }
}

fn write_rows(matrix: &Mat<f64>, rows: &mut [f64]) {
    for (i, row) in rows.chunks_exact_mut(matrix.ncols()).enumerate() {
        row.iter_mut().enumerate().for_each(|(j, to)| *to = matrix[(i, j)]);
    }
}
