//! Polynomials of several variables and their least-squares fit.

use faer::Mat;

use crate::linear_algebra::Decomposition;

/// All monomials up to a total degree, each an earlier one times a variable.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Monomials {
    /// Index of the earlier monomial and the variable, for all but the constant.
    products: Vec<(usize, usize)>,
}

impl Monomials {
    pub(crate) fn new(variables: usize, degree: usize) -> Self {
        // A monomial is continued with its own last variable or later ones only.
        let mut products: Vec<(usize, usize)> = Vec::new();
        let mut previous = vec![(0, 0)];
        for _ in 0..degree {
            let mut next = Vec::new();
            for &(term, first) in &previous {
                for variable in first..variables {
                    products.push((term, variable));
                    next.push((products.len(), variable));
                }
            }
            previous = next;
        }
        Self { products }
    }

    pub(crate) fn count(&self) -> usize {
        self.products.len() + 1
    }

    /// Values of all monomials at `z`, into `out`.
    pub(crate) fn values(&self, z: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.push(1.0);
        for &(term, variable) in &self.products {
            let value = out[term] * z[variable];
            out.push(value);
        }
    }
}

/// Coefficients of a fit with the root mean square of its leave-one-out errors.
pub(crate) struct Fitted {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) leave_one_out_error: f64,
}

/// A design matrix with its decomposition, for many right-hand sides.
pub(crate) struct LeastSquares {
    rows: Mat<f64>,
    decomposition: Decomposition,
    leverages: Vec<f64>,
}

impl LeastSquares {
    pub(crate) fn new(rows: Mat<f64>) -> Self {
        let decomposition = Decomposition::new(&rows);
        // Of a row a of the matrix: |y|^2 with R^T y = a.
        let leverage = |i: usize| {
            let mut y: Vec<f64> = Vec::with_capacity(rows.ncols());
            for k in 0..rows.ncols() {
                let known: f64 =
                    y.iter().enumerate().map(|(j, y)| decomposition.upper(j, k) * y).sum();
                y.push((rows[(i, k)] - known) / decomposition.upper(k, k));
            }
            y.iter().map(|y| y * y).sum()
        };
        let leverages = (0..rows.nrows()).map(leverage).collect();
        Self { rows, decomposition, leverages }
    }

    /// `None` if the rows do not determine the coefficients.
    ///
    /// The leave-one-out error of a point is its residual over one minus its leverage.
    pub(crate) fn fit(&self, values: &[f64]) -> Option<Fitted> {
        let right = self.decomposition.solve(values);
        let count = self.rows.ncols();
        let coefficients: Vec<f64> = (0..count).map(|k| right[(k, 0)]).collect();
        let square = |i: usize| {
            let surface: f64 = (0..count).map(|k| self.rows[(i, k)] * coefficients[k]).sum();
            ((values[i] - surface) / (1.0 - self.leverages[i]).max(1e-6)).powi(2)
        };
        let mean = (0..values.len()).map(square).sum::<f64>() / values.len() as f64;
        let finite = mean.is_finite() && coefficients.iter().all(|c| c.is_finite());
        finite.then(|| Fitted { coefficients, leave_one_out_error: mean.sqrt() })
    }
}
