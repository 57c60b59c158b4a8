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
    open: Vec<usize>,
    stiffness: Vec<f64>,
    /// Of few contacts: the lower triangle by columns, the inverse on its diagonal.
    few: Vec<f64>,
    /// Of many.
    many: Option<Llt<f64>>,
    /// Memory of forces.
    forces: Vec<f64>,
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
        self.open.clear();
        self.open.extend((0..stiffness.len()).filter(|&i| stiffness[i] <= 0.0));
        let closed = &self.closed;
        let size = closed.len();
        let entry = |a: usize, b: usize| {
            let (i, j) = (closed[a], closed[b]);
            flexibility[(i, j)] + if i == j { 1.0 / stiffness[i] } else { 0.0 }
        };
        self.stiffness.clear();
        self.stiffness.extend(closed.iter().map(|&i| stiffness[i]));
        if size >= WORTH_KEEPING {
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

    /// Changes of all closures \[m\] that residuals `rest` \[m\] of the closures ask for: with the forces `f` of closed contacts,
    /// `(1 / k + G) f = rest`, the changes are `rest - G f`, which is `f / k` for closed ones.
    pub(super) fn solve(&mut self, flexibility: &Mat<f64>, rest: &[f64], changes: &mut [f64]) {
        let forces = &mut self.forces;
        forces.clear();
        forces.extend(self.closed.iter().map(|&i| rest[i]));
        let size = forces.len();
        match &self.many {
            Some(factor) => {
                factor.solve_in_place(faer::MatMut::from_column_major_slice_mut(forces, size, 1));
            }
            None => solve_few(&self.few, forces),
        }
        for &i in &self.open {
            let column = flexibility.col_as_slice(i);
            let carried = self.closed.iter().zip(&*forces).map(|(&j, force)| column[j] * force);
            changes[i] = rest[i] - carried.sum::<f64>();
        }
        for ((&i, force), stiffness) in self.closed.iter().zip(&*forces).zip(&self.stiffness) {
            changes[i] = force / stiffness;
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
        right[k] = (right[k] - dot(&column[k + 1..], &right[k + 1..])) * column[k];
    }
}

/// Numbers side by side in sums.
const LANES: usize = 8;

/// The sum of products of two vectors of one length.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a, a_end) = a.as_chunks::<LANES>();
    let (b, b_end) = b.as_chunks::<LANES>();
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + a_end.iter().zip(b_end).map(|(a, b)| a * b).sum::<f64>()
}

/// The symmetric `matrix` times a vector, from its lower triangle.
pub(super) fn times(matrix: &Mat<f64>, vector: &[f64], product: &mut [f64]) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || times_within(matrix, vector, product),
    );
}

#[inline(always)]
fn times_within(matrix: &Mat<f64>, vector: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    for column in 0..vector.len() {
        let entries = &matrix.col_as_slice(column)[column..];
        let factor = vector[column];
        product[column] += entries[0] * factor;
        let mut sums = [0.0; LANES];
        let (entries, end) = entries[1..].as_chunks::<LANES>();
        let (below, below_end) = product[column + 1..].as_chunks_mut::<LANES>();
        let (others, others_end) = vector[column + 1..].as_chunks::<LANES>();
        for ((entries, product), others) in entries.iter().zip(below).zip(others) {
            for lane in 0..LANES {
                product[lane] += entries[lane] * factor;
                sums[lane] += entries[lane] * others[lane];
            }
        }
        let mut sum = sums.iter().sum::<f64>();
        for ((entry, product), other) in end.iter().zip(below_end).zip(others_end) {
            *product += entry * factor;
            sum += entry * other;
        }
        product[column] += sum;
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
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Few contacts and many, by insertion: open contacts carry nothing, and follow the others.
    #[test]
    fn changes_satisfy_the_equations_of_all_contacts() {
        for count in [1, 2, 7, WORTH_KEEPING + 20] {
            let flexibility = Mat::from_fn(count, count, |i, j| {
                1e-9 * (-(i.abs_diff(j) as f64)).exp() * if i == j { 1.1 } else { 1.0 }
            });
            let stiffness = |i: usize| if i % 5 == 3 { 0.0 } else { 1e8 * (1 + i % 3) as f64 };
            let stiffness: Vec<f64> = (0..count).map(stiffness).collect();
            let rest: Vec<f64> = (0..count).map(|i| 1e-6 * (i as f64).sin() + 1e-7).collect();
            let mut factor = ContactFactor::default();
            assert!(factor.update(&stiffness, &flexibility));
            let (mut changes, mut product) = (vec![f64::NAN; count], vec![1.0; count]);
            factor.solve(&flexibility, &rest, &mut changes);
            let forces: Vec<f64> = changes.iter().zip(&stiffness).map(|(x, k)| x * k).collect();
            times(&flexibility, &forces, &mut product);
            for i in 0..count {
                let expected: f64 = (0..count).map(|j| flexibility[(i, j)] * forces[j]).sum();
                assert!((product[i] - expected).abs() < 1e-18, "{count} {i}");
                assert!((product[i] + changes[i] - rest[i]).abs() < 1e-18, "{count} {i}");
            }
            assert!(
                !ContactFactor::default()
                    .update(&vec![1e8; count], &(-&flexibility * faer::Scale(100.0)))
            );
        }
    }
}
