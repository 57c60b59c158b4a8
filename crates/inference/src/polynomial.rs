//! Polynomials of several variables and their least-squares fit.

use faer::Mat;

use crate::linear_algebra::Decomposition;

/// Monomials of several variables, each an earlier one times a variable.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Monomials {
    /// Index of the earlier monomial and the variable, for all but the constant.
    products: Vec<(usize, usize)>,
}

/// Terms of degree three.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cubics {
    None,
    /// Cubes, and squares times another variable: those of curvature that changes along a direction.
    OfTwo,
    /// Products of three variables too.
    All,
}

impl Monomials {
    /// All terms of degree two, and the `cubics`.
    pub(crate) fn new(variables: usize, cubics: Cubics) -> Self {
        let mut products: Vec<(usize, usize)> =
            (0..variables).map(|variable| (0, variable)).collect();
        for first in 0..variables {
            for second in first..variables {
                products.push((first + 1, second));
            }
        }
        // A monomial is continued with its own last variable or later ones only.
        let mut term = variables;
        for first in 0..variables {
            for second in first..variables {
                term += 1;
                let thirds = match cubics {
                    Cubics::None => 0..0,
                    Cubics::OfTwo if first != second => second..second + 1,
                    Cubics::OfTwo | Cubics::All => second..variables,
                };
                products.extend(thirds.map(|third| (term, third)));
            }
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Every term once, by its exponents, with its value.
    #[test]
    fn monomials_are_all_terms_of_their_degrees() {
        for variables in 1..6 {
            let z: Vec<f64> = (0..variables).map(|i| 0.3 + 0.7 * i as f64).collect();
            let triples = variables * (variables - 1) * (variables.max(2) - 2) / 6;
            let quadratic = (variables + 1) * (variables + 2) / 2;
            let cubic = variables * (variables + 1) * (variables + 2) / 6;
            for (cubics, count) in [
                (Cubics::None, quadratic),
                (Cubics::OfTwo, quadratic + cubic - triples),
                (Cubics::All, quadratic + cubic),
            ] {
                let monomials = Monomials::new(variables, cubics);
                let mut exponents = vec![vec![0; variables]];
                for &(earlier, variable) in &monomials.products {
                    let mut of_term = exponents[earlier].clone();
                    of_term[variable] += 1;
                    exponents.push(of_term);
                }
                let mut values = Vec::new();
                monomials.values(&z, &mut values);
                for (powers, value) in exponents.iter().zip(&values) {
                    let expected: f64 = powers.iter().zip(&z).map(|(n, z)| z.powi(*n)).product();
                    assert!((value - expected).abs() < 1e-12 * expected);
                    let of_three = powers.iter().filter(|n| **n > 0).count() == 3;
                    assert!(cubics == Cubics::All || !of_three);
                }
                assert_eq!((monomials.count(), values.len()), (count, count));
                assert_eq!(exponents.into_iter().collect::<BTreeSet<_>>().len(), count);
            }
        }
    }
}
