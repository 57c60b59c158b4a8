//! Gaussian elimination of small complex matrices.

use num_complex::Complex64;

/// Solves for the columns of `rows` beyond the square part of `size` columns, in place, by elimination
/// with exchange of rows. Each row has `width` entries. A singular matrix gives numbers that are not
/// finite.
pub(crate) fn eliminate(rows: &mut [Complex64], size: usize, width: usize) {
    for column in 0..size {
        let length = |row: &usize| rows[row * width + column].norm_sqr();
        let pivot = (column..size).max_by(|a, b| length(a).total_cmp(&length(b)));
        if let Some(pivot) = pivot.filter(|&pivot| pivot != column) {
            let (above, below) = rows.split_at_mut(pivot * width);
            above[column * width..][..width].swap_with_slice(&mut below[..width]);
        }
        let (above, below) = rows.split_at_mut((column + 1) * width);
        let top = &mut above[column * width..];
        let inverse = top[column].inv();
        for x in &mut top[column + 1..] {
            *x *= inverse;
        }
        for row in below.chunks_exact_mut(width) {
            let factor = row[column];
            if factor != Complex64::ZERO {
                for (x, t) in row[column + 1..].iter_mut().zip(&top[column + 1..]) {
                    *x -= factor * t;
                }
            }
        }
    }
    for column in (1..size).rev() {
        let (above, below) = rows.split_at_mut(column * width);
        let known = &below[size..width];
        for row in above.chunks_exact_mut(width) {
            let factor = row[column];
            for (x, t) in row[size..].iter_mut().zip(known) {
                *x -= factor * t;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix that needs exchanges, against its known solutions.
    #[test]
    fn solves_what_needs_pivots() {
        let (size, width) = (5, 7);
        let entry = |i: usize, j: usize| {
            let angle = (i * size + j) as f64;
            if i == j { Complex64::ZERO } else { Complex64::new((1.3 * angle).sin(), angle.cos()) }
        };
        let exact = |i: usize, c: usize| Complex64::new(i as f64 - 1.0, c as f64);
        let mut rows = vec![Complex64::ZERO; size * width];
        for i in 0..size {
            for j in 0..size {
                rows[i * width + j] = entry(i, j);
            }
            for c in 0..2 {
                rows[i * width + size + c] = (0..size).map(|j| entry(i, j) * exact(j, c)).sum();
            }
        }
        eliminate(&mut rows, size, width);
        for i in 0..size {
            for c in 0..2 {
                assert!((rows[i * width + size + c] - exact(i, c)).norm() < 1e-12);
            }
        }
    }
}
