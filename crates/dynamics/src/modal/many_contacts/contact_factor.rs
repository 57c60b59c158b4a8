//! Factors of the contact equations, and the memory of their Newton steps.

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

/// Contacts from which on a library factors the equations, and a factor is kept.
const WORTH_KEEPING: usize = 48;

/// Relative change of a stiffness up to which a kept factor is used again.
const SAME: f64 = 0.2;

/// A factor of `1 / k + G` for the closed contacts, with stiffnesses `k` \[N/m\] and the flexibility `G` \[m/N\].
#[derive(Debug, Default)]
pub(super) struct ContactFactor {
    closed: Vec<usize>,
    stiffness: Vec<f64>,
    /// Of few contacts: the lower triangle by columns, the inverse on its diagonal.
    few: Vec<f64>,
    /// Of many.
    many: Option<Llt<f64>>,
}

impl ContactFactor {
    /// Factors the equations of the contacts whose `stiffness` is positive, unless the last factor is close enough. False where they
    /// are not positive definite.
    pub(super) fn update(&mut self, stiffness: &[f64], flexibility: &Mat<f64>) -> bool {
        let closed = || (0..stiffness.len()).filter(|&i| stiffness[i] > 0.0);
        let same = || {
            let pairs = self.closed.iter().zip(&self.stiffness);
            closed().eq(self.closed.iter().copied())
                && pairs.into_iter().all(|(&i, old)| (stiffness[i] - old).abs() <= SAME * old)
        };
        if self.many.is_some() && same() {
            return true;
        }
        self.closed.clear();
        self.closed.extend(closed());
        let closed = &self.closed;
        let size = closed.len();
        let entry = |a: usize, b: usize| {
            let (i, j) = (closed[a], closed[b]);
            flexibility[(i, j)] + if i == j { 1.0 / stiffness[i] } else { 0.0 }
        };
        if size >= WORTH_KEEPING {
            self.stiffness.clear();
            self.stiffness.extend(closed.iter().map(|&i| stiffness[i]));
            self.many = Mat::from_fn(size, size, entry).llt(Side::Lower).ok();
            return self.many.is_some();
        }
        self.many = None;
        self.few.clear();
        self.few.extend(
            (0..size).flat_map(|b| (0..size).map(move |a| (a, b))).map(|(a, b)| entry(a, b)),
        );
        factor_few(&mut self.few, size)
    }

    /// The solution for all contacts of the equations of the closed ones with the right side `rest`, in `solution`: zero for open
    /// contacts. `room` is memory.
    pub(super) fn solve(&self, rest: &[f64], solution: &mut [f64], room: &mut Vec<f64>) {
        solution.fill(0.0);
        room.clear();
        room.extend(self.closed.iter().map(|&i| rest[i]));
        let size = room.len();
        match &self.many {
            Some(factor) => {
                factor.solve_in_place(faer::MatMut::from_column_major_slice_mut(room, size, 1));
            }
            None => solve_few(&self.few, room),
        }
        for (&i, value) in self.closed.iter().zip(&*room) {
            solution[i] = *value;
        }
    }
}

/// Cholesky factor in place of a symmetric matrix by columns; false if it is not positive definite.
fn factor_few(entries: &mut [f64], size: usize) -> bool {
    for k in 0..size {
        let (done, rest) = entries.split_at_mut((k + 1) * size);
        let column = &mut done[k * size..];
        let pivot = column[k];
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        column[k] = inverse;
        for value in &mut column[k + 1..] {
            *value *= inverse;
        }
        for j in k + 1..size {
            let target = &mut rest[(j - k - 1) * size..][..size];
            let factor = column[j];
            for (x, y) in target[j..].iter_mut().zip(&column[j..]) {
                *x -= factor * y;
            }
        }
    }
    true
}

/// Solves with a factor of [`factor_few`] in place.
fn solve_few(entries: &[f64], right: &mut [f64]) {
    let size = right.len();
    for k in 0..size {
        let column = &entries[k * size..][..size];
        let value = right[k] * column[k];
        right[k] = value;
        for (x, y) in right[k + 1..].iter_mut().zip(&column[k + 1..]) {
            *x -= value * y;
        }
    }
    for k in (0..size).rev() {
        let column = &entries[k * size..][..size];
        let sum: f64 = right[k + 1..].iter().zip(&column[k + 1..]).map(|(x, y)| x * y).sum();
        right[k] = (right[k] - sum) * column[k];
    }
}

/// The symmetric `matrix` times a vector.
pub(super) fn times(matrix: &Mat<f64>, vector: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    for (column, factor) in vector.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
        for (sum, entry) in product.iter_mut().zip(matrix.col_as_slice(column)) {
            *sum += factor * entry;
        }
    }
}

/// Memory of the Newton steps of a step of time.
#[derive(Debug, Default)]
pub(super) struct Work {
    pub(super) factor: ContactFactor,
    /// Closures, those before the last change, and the change.
    pub(super) place: Vec<f64>,
    pub(super) from: Vec<f64>,
    pub(super) change: Vec<f64>,
    /// Residuals of the closures.
    pub(super) rest: Vec<f64>,
    pub(super) carried: Vec<f64>,
    pub(super) increments: Vec<f64>,
    pub(super) room: Vec<f64>,
}

impl Work {
    pub(super) fn new(contacts: usize) -> Self {
        let zeros = || vec![0.0; contacts];
        Self {
            place: zeros(),
            from: zeros(),
            change: zeros(),
            rest: zeros(),
            carried: zeros(),
            increments: zeros(),
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Few contacts and many, by insertion; open contacts carry nothing.
    #[test]
    fn solutions_satisfy_the_equations_of_closed_contacts() {
        for count in [1, 2, 7, WORTH_KEEPING + 20] {
            let flexibility = Mat::from_fn(count, count, |i, j| {
                1e-9 * (-(i.abs_diff(j) as f64)).exp() * if i == j { 1.1 } else { 1.0 }
            });
            let stiffness = |i: usize| if i % 5 == 3 { 0.0 } else { 1e8 * (1 + i % 3) as f64 };
            let stiffness: Vec<f64> = (0..count).map(stiffness).collect();
            let rest: Vec<f64> = (0..count).map(|i| 1e-6 * (i as f64).sin() + 1e-7).collect();
            let mut factor = ContactFactor::default();
            assert!(factor.update(&stiffness, &flexibility));
            let (mut solution, mut product) = (vec![1.0; count], vec![0.0; count]);
            factor.solve(&rest, &mut solution, &mut Vec::new());
            times(&flexibility, &solution, &mut product);
            for i in 0..count {
                if stiffness[i] > 0.0 {
                    let found = product[i] + solution[i] / stiffness[i];
                    assert!((found - rest[i]).abs() < 1e-18, "{count} {i}");
                } else {
                    assert_eq!(solution[i], 0.0);
                }
            }
            assert!(
                !ContactFactor::default()
                    .update(&vec![1e8; count], &(-&flexibility * faer::Scale(100.0)))
            );
        }
    }
}
