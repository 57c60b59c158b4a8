//! Small systems of complex linear equations.

use num_complex::Complex64;

/// The solution of n equations, given by rows of n coefficients and the right side, which are overwritten;
/// `None` if it is not finite.
pub(crate) fn solve(rows: &mut [Complex64]) -> Option<Vec<Complex64>> {
    let count = (1..=rows.len()).find(|n| n * (n + 1) >= rows.len())?;
    let width = count + 1;
    for k in 0..count {
        let pivot = (k..count).max_by(|&a, &b| {
            rows[a * width + k].norm_sqr().total_cmp(&rows[b * width + k].norm_sqr())
        })?;
        for column in 0..width {
            rows.swap(k * width + column, pivot * width + column);
        }
        for row in 0..count {
            if row == k {
                continue;
            }
            let factor = rows[row * width + k] / rows[k * width + k];
            for column in k..width {
                let change = factor * rows[k * width + column];
                rows[row * width + column] -= change;
            }
        }
    }
    let found: Vec<Complex64> =
        (0..count).map(|k| rows[k * width + count] / rows[k * width + k]).collect();
    found.iter().all(|value| value.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_is_solved_with_pivoting() {
        let c = Complex64::new;
        // 2 i y = 2, x + y = 3.
        let mut rows =
            [c(0.0, 0.0), c(0.0, 2.0), c(2.0, 0.0), c(1.0, 0.0), c(1.0, 0.0), c(3.0, 0.0)];
        let found = solve(&mut rows).unwrap();
        assert!(
            (found[0] - c(3.0, 1.0)).norm() < 1e-14 && (found[1] - c(0.0, -1.0)).norm() < 1e-14
        );
        assert_eq!(solve(&mut [Complex64::ZERO; 6]), None);
    }
}
