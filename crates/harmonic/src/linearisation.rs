//! The linearised equations of a point of a branch, and their solution.

use crate::balance::Balance;
use crate::factorization::{Factorization, dot};
use crate::gmres;

/// Rows and columns beside the derivative of the residual of harmonic balance with respect to the closures: of
/// further unknowns and their equations, and of the parameter.
#[derive(Debug, Clone, Default)]
pub(crate) struct Border {
    /// A column for each further unknown and the parameter: its entries in the equations of the closures, then in the
    /// further equations.
    pub(crate) columns: Vec<Vec<f64>>,
    /// A row for each further equation: its derivatives with respect to the closures.
    pub(crate) rows: Vec<Vec<f64>>,
}

/// Linearised equations, completed by a row to square ones.
#[derive(Debug)]
pub(crate) enum Linearisation {
    Direct(Factorization),
    Iterative(Iterative),
}

impl Linearisation {
    /// For the equations of `balance` in so many unknowns, further ones and the parameter included.
    pub(crate) fn new(balance: &Balance<'_>, size: usize) -> Self {
        if balance.is_of_many() {
            Self::Iterative(Iterative::default())
        } else {
            Self::Direct(Factorization::new(size))
        }
    }

    /// Takes the derivatives at the motion that `balance` evaluated last, with `last` as the last row, or without a
    /// border; false if they are singular.
    pub(crate) fn take(&mut self, balance: &Balance<'_>, border: Border, last: &[f64]) -> bool {
        match self {
            Self::Direct(factors) => {
                let (n, width) = (balance.unknowns(), border.columns.len());
                let stride = n + width;
                balance.d_residual_d_closures(stride, factors.matrix());
                let rows = factors.matrix();
                for (out, row) in rows[n * stride..].chunks_exact_mut(stride).zip(&border.rows) {
                    out[..n].copy_from_slice(row);
                }
                for (c, column) in border.columns.iter().enumerate() {
                    for (out, value) in rows.chunks_exact_mut(stride).zip(column) {
                        out[n + c] = *value;
                    }
                }
                rows[stride * stride - last.len()..].copy_from_slice(last);
                factors.factorize()
            }
            Self::Iterative(iterative) => iterative.take(border, last),
        }
    }

    /// Solves for one right-hand side, in place, to a relative accuracy; false if it is not found.
    pub(crate) fn solve(&self, balance: &Balance<'_>, x: &mut [f64], accuracy: f64) -> bool {
        match self {
            Self::Direct(factors) => {
                factors.solve(x);
                true
            }
            Self::Iterative(iterative) => iterative.solve(balance, x, accuracy),
        }
    }

    /// Sign of the determinant; one where equations are solved by iteration, which gives none.
    pub(crate) fn orientation(&self) -> f64 {
        match self {
            Self::Direct(factors) => factors.determinant_sign(),
            Self::Iterative(_) => 1.0,
        }
    }
}

/// The solution by GMRES.
///
/// The derivative of the residual by the closures is near the unit matrix, so that the elimination of the closures with
/// the unit matrix in its place prepares the system: with the columns C, the rows A and the corner D of the border,
///
/// ```text
/// [1 C; A D]^-1 [u; v] = [u - C z; z],    z = (D - A C)^-1 (v - A u).
/// ```
#[derive(Debug, Default)]
pub(crate) struct Iterative {
    border: Border,
    last: Vec<f64>,
    /// `D - A C`.
    corner: Option<Factorization>,
}

impl Iterative {
    fn take(&mut self, border: Border, last: &[f64]) -> bool {
        (self.border, self.last) = (border, last.to_vec());
        let width = self.border.columns.len();
        if width == 0 {
            return true;
        }
        let n = self.last.len() - width;
        let mut corner = Factorization::new(width);
        for (i, out) in corner.matrix().chunks_exact_mut(width).enumerate() {
            let row = self.row(i, n);
            for ((c, column), out) in self.border.columns.iter().enumerate().zip(out) {
                let own = if i + 1 < width { column[n + i] } else { self.last[n + c] };
                *out = own - dot(row, &column[..n]);
            }
        }
        self.corner = corner.factorize().then_some(corner);
        self.border.columns.iter().flatten().all(|value| value.is_finite())
    }

    /// Row `i` of the border, with respect to the closures.
    fn row(&self, i: usize, n: usize) -> &[f64] {
        self.border.rows.get(i).map_or(&self.last[..n], |row| row)
    }

    fn solve(&self, balance: &Balance<'_>, x: &mut [f64], accuracy: f64) -> bool {
        let n = balance.unknowns();
        let apply = |v: &[f64], out: &mut [f64]| {
            let (closures, rest) = v.split_at(n);
            balance.d_residual_along(closures, &mut out[..n]);
            let size = rest.len();
            for i in 0..size {
                out[n + i] = dot(self.row(i, n), closures);
            }
            for (column, z) in self.border.columns.iter().zip(rest) {
                out.iter_mut().zip(column).for_each(|(to, c)| *to += z * c);
            }
            if let Some(to) = out.last_mut().filter(|_| size > 0) {
                *to += dot(&self.last[n..], rest);
            }
            self.prepare(out, n);
        };
        self.prepare(x, n);
        gmres::solve(apply, x, accuracy)
    }

    /// Multiplies by the inverse of the system with the unit matrix for the closures, where it has one.
    fn prepare(&self, x: &mut [f64], n: usize) {
        let Some(corner) = &self.corner else { return };
        let (closures, rest) = x.split_at_mut(n);
        for (i, v) in rest.iter_mut().enumerate() {
            *v -= dot(self.row(i, n), closures);
        }
        corner.solve(rest);
        for (column, z) in self.border.columns.iter().zip(rest) {
            closures.iter_mut().zip(column).for_each(|(u, c)| *u -= *z * c);
        }
    }
}
