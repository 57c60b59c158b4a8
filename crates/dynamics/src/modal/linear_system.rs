//! The small linear systems of the contacts.

/// `I + B K`, factored without pivoting: with B positive definite and K not negative it has the
/// pivots of a positive definite matrix.
#[derive(Debug, Clone)]
pub(super) struct Factors {
    size: usize,
    /// Row by row; below the diagonal the multipliers, on it the inverse pivots.
    entries: Vec<f64>,
}

impl Factors {
    pub(super) fn new(size: usize) -> Self {
        Self { size, entries: vec![0.0; size * size] }
    }

    /// Factors `I + B K` for the diagonal `tangent` K.
    pub(super) fn factor(&mut self, coupling: &[Vec<f64>], tangent: &[f64]) {
        let n = self.size;
        for (i, row) in coupling.iter().enumerate() {
            for (j, (b, k)) in row.iter().zip(tangent).enumerate() {
                let unit = if i == j { 1.0 } else { 0.0 };
                self.entries[i * n + j] = unit + b * k;
            }
        }
        for k in 0..n {
            let inverse = 1.0 / self.entries[k * n + k];
            self.entries[k * n + k] = inverse;
            for i in k + 1..n {
                let factor = self.entries[i * n + k] * inverse;
                self.entries[i * n + k] = factor;
                for j in k + 1..n {
                    self.entries[i * n + j] -= factor * self.entries[k * n + j];
                }
            }
        }
    }

    /// Solves in place.
    pub(super) fn solve(&self, right: &mut [f64]) {
        let n = self.size;
        for i in 0..n {
            for k in 0..i {
                right[i] -= self.entries[i * n + k] * right[k];
            }
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                right[i] -= self.entries[i * n + k] * right[k];
            }
            right[i] *= self.entries[i * n + i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By insertion into the equations.
    #[test]
    fn the_solution_satisfies_the_equations() {
        let coupling = vec![vec![2.0, -0.5, 0.1], vec![-0.5, 3.0, -0.7], vec![0.1, -0.7, 1.0]];
        let tangent = [0.3, 0.0, 40.0];
        let mut factors = Factors::new(3);
        factors.factor(&coupling, &tangent);
        let right = [1.0, -2.0, 0.5];
        let mut x = right;
        factors.solve(&mut x);
        for (i, expected) in right.iter().enumerate() {
            let bent: f64 = (0..3).map(|j| coupling[i][j] * tangent[j] * x[j]).sum();
            assert!((x[i] + bent - expected).abs() < 1e-14);
        }
    }
}
