//! Solutions for a few right sides from a factor in dense columns.
//!
//! A product of the factor with eight columns takes as long as the factor takes to be read from memory. General
//! products of matrices copy it first, which pays for many columns alone.
#![allow(
    clippy::inline_always,
    reason = "kernels must be compiled with their caller, for the vector instructions chosen"
)]

use std::slice;

use faer::MatRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::elimination_tree::Branch;

/// Right sides that are solved for at once.
pub(super) const SIDES: usize = 8;

/// Columns of the factor that are taken together.
const COLUMNS: usize = 4;

/// A row of all right sides.
pub(super) type Row = [f64; SIDES];

/// Columns of the factor.
type Factor<'a> = SupernodalLltRef<'a, usize, f64>;

/// Replaces `rows`, in the order of elimination, by the solution of `L L^T x = rows`. Branches of the elimination
/// tree are swept side by side; they are of the factor alone, and so is the rounding.
pub(super) fn solve(factor: Factor<'_>, tree: &Branch, rows: &mut [Row]) {
    forward_branch(factor, tree, rows, &mut []);
    backward_branch(factor, tree, rows, &mut []);
}

/// Solves for the `own` rows of a branch by its triangle, and takes their parts off the rows `behind` it.
fn forward_branch(factor: Factor<'_>, branch: &Branch, own: &mut [Row], behind: &mut [Row]) {
    let within = parts(branch, own).into_par_iter().map(|(branch, own)| {
        let mut changes = vec![[0.0; SIDES]; branch.behind.len()];
        forward_branch(factor, branch, own, &mut changes);
        changes
    });
    let within: Vec<Vec<Row>> = within.collect();
    let mut rows = Rows { branch, own, behind };
    for (part, changes) in branch.branches.iter().zip(within) {
        for (&row, change) in part.behind.iter().zip(changes) {
            for (sum, change) in rows.at(row).iter_mut().zip(change) {
                *sum += change;
            }
        }
    }
    pulp::Arch::new().dispatch(Sweep { factor, rows, is_forward: true });
}

/// Solves for the `own` rows of a branch by its transposed triangle, with known rows `behind` it.
fn backward_branch(factor: Factor<'_>, branch: &Branch, own: &mut [Row], behind: &mut [Row]) {
    let rows = Rows { branch, own: &mut *own, behind: &mut *behind };
    pulp::Arch::new().dispatch(Sweep { factor, rows, is_forward: false });
    let mut rows = Rows { branch, own: &mut *own, behind };
    let known = |part: &Branch| part.behind.iter().map(|&row| *rows.at(row)).collect();
    let known: Vec<Vec<Row>> = branch.branches.iter().map(known).collect();
    let within = parts(branch, own).into_par_iter().zip(known);
    within.for_each(|((part, own), mut known)| backward_branch(factor, part, own, &mut known));
}

/// The branches within one, with their rows of its own.
fn parts<'a>(branch: &'a Branch, mut own: &'a mut [Row]) -> Vec<(&'a Branch, &'a mut [Row])> {
    let mut from = branch.rows.start;
    let mut parts = Vec::new();
    for part in &branch.branches {
        let (_, rest) = own.split_at_mut(part.rows.start - from);
        let (rows, rest) = rest.split_at_mut(part.rows.len());
        parts.push((part, rows));
        (own, from) = (rest, part.rows.end);
    }
    parts
}

/// Rows that a branch has entries in: its own, and those behind it.
struct Rows<'a> {
    branch: &'a Branch,
    own: &'a mut [Row],
    behind: &'a mut [Row],
}

impl Rows<'_> {
    #[inline(always)]
    fn at(&mut self, row: usize) -> &mut Row {
        if row < self.branch.rows.end {
            &mut self.own[row - self.branch.rows.start]
        } else {
            &mut self.behind[self.branch.place(row)]
        }
    }
}

/// A sweep over the supernodes of a branch that are in none within it.
struct Sweep<'a> {
    factor: Factor<'a>,
    rows: Rows<'a>,
    is_forward: bool,
}

impl WithSimd for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match S::F64_LANES {
            8 => self.with_vectors::<S, 1>(simd),
            4 => self.with_vectors::<S, 2>(simd),
            2 => self.with_vectors::<S, 4>(simd),
            _ => self.with_vectors::<S, 8>(simd),
        }
    }
}

impl Sweep<'_> {
    /// Sweeps with rows of `N` vectors.
    #[inline(always)]
    fn with_vectors<S: Simd, const N: usize>(self, simd: S) {
        let Self { factor, mut rows, is_forward } = self;
        let branch = rows.branch;
        let mut part: Vec<S::f64s> = Vec::new();
        if is_forward {
            for &number in &branch.own {
                let supernode = factor.supernode(number);
                let own = supernode.val().ncols();
                let first = supernode.start() - branch.rows.start;
                part.clear();
                part.extend_from_slice(vectors::<S>(&mut rows.own[first..first + own]));
                part.resize(N * supernode.val().nrows(), simd.splat_f64s(0.0));
                forward::<S, N>(simd, supernode.val(), &mut part);
                let (solved, changes) = part.split_at(N * own);
                vectors::<S>(&mut rows.own[first..first + own]).copy_from_slice(solved);
                for (&row, change) in supernode.pattern().iter().zip(changes.chunks_exact(N)) {
                    let sum = vectors::<S>(slice::from_mut(rows.at(row)));
                    for (x, change) in sum.iter_mut().zip(change) {
                        *x = simd.add_f64s(*x, *change);
                    }
                }
            }
        } else {
            for &number in branch.own.iter().rev() {
                let supernode = factor.supernode(number);
                let own = supernode.val().ncols();
                let first = supernode.start() - branch.rows.start;
                part.clear();
                part.extend_from_slice(vectors::<S>(&mut rows.own[first..first + own]));
                for &row in supernode.pattern() {
                    part.extend_from_slice(vectors::<S>(slice::from_mut(rows.at(row))));
                }
                backward::<S, N>(simd, supernode.val(), &mut part);
                vectors::<S>(&mut rows.own[first..first + own]).copy_from_slice(&part[..N * own]);
            }
        }
    }
}

/// Rows as vectors.
#[inline(always)]
fn vectors<S: Simd>(rows: &mut [Row]) -> &mut [S::f64s] {
    pulp::bytemuck::cast_slice_mut(rows)
}

/// Solves for the rows of the triangle on top of the columns `lower`, and takes their parts off the rows below.
#[inline(always)]
fn forward<S: Simd, const N: usize>(simd: S, lower: MatRef<'_, f64>, rows: &mut [S::f64s]) {
    for first in (0..lower.ncols()).step_by(COLUMNS) {
        let count = COLUMNS.min(lower.ncols() - first);
        let columns = columns(lower, first, count);
        let (top, below) = rows[N * first..].split_at_mut(N * count);
        let mut solved = [[simd.splat_f64s(0.0); N]; COLUMNS];
        for k in 0..count {
            solved[k].copy_from_slice(&top[N * k..N * (k + 1)]);
            for j in 0..k {
                let known = solved[j];
                add::<S, N>(simd, &mut solved[k], -columns[j][k], &known);
            }
            divide::<S, N>(simd, &mut solved[k], columns[k][k]);
            top[N * k..N * (k + 1)].copy_from_slice(&solved[k]);
        }
        let [a, b, c, d] = &solved;
        let [p, q, r, s] = columns.map(|column| column.get(count..).unwrap_or_default());
        if count == COLUMNS {
            let factors = p.iter().zip(q).zip(r).zip(s);
            for (row, (((p, q), r), s)) in below.chunks_exact_mut(N).zip(factors) {
                for (x, factor) in [(a, p), (b, q), (c, r), (d, s)] {
                    add::<S, N>(simd, row, -factor, x);
                }
            }
        } else {
            for (x, tail) in solved.iter().zip([p, q, r, s]) {
                for (row, factor) in below.chunks_exact_mut(N).zip(tail) {
                    add::<S, N>(simd, row, -factor, x);
                }
            }
        }
    }
}

/// Solves for the rows of the triangle on top of the columns `lower`, transposed, with known rows below.
#[inline(always)]
fn backward<S: Simd, const N: usize>(simd: S, lower: MatRef<'_, f64>, rows: &mut [S::f64s]) {
    for first in (0..lower.ncols()).step_by(COLUMNS).rev() {
        let count = COLUMNS.min(lower.ncols() - first);
        let columns = columns(lower, first, count);
        let (top, below) = rows[N * first..].split_at_mut(N * count);
        let [p, q, r, s] = columns.map(|column| column.get(count..).unwrap_or_default());
        let mut sums = [[simd.splat_f64s(0.0); N]; COLUMNS];
        if count == COLUMNS {
            let [a, b, c, d] = &mut sums;
            let factors = p.iter().zip(q).zip(r).zip(s);
            for (row, (((p, q), r), s)) in below.chunks_exact(N).zip(factors) {
                add::<S, N>(simd, a, -p, row);
                add::<S, N>(simd, b, -q, row);
                add::<S, N>(simd, c, -r, row);
                add::<S, N>(simd, d, -s, row);
            }
        } else {
            for (sum, tail) in sums.iter_mut().zip([p, q, r, s]) {
                for (row, factor) in below.chunks_exact(N).zip(tail) {
                    add::<S, N>(simd, sum, -factor, row);
                }
            }
        }
        for k in (0..count).rev() {
            let mut sum = sums[k];
            add::<S, N>(simd, &mut sum, 1.0, &top[N * k..N * (k + 1)]);
            for j in k + 1..count {
                add::<S, N>(simd, &mut sum, -columns[k][j], &top[N * j..N * (j + 1)]);
            }
            divide::<S, N>(simd, &mut sum, columns[k][k]);
            top[N * k..N * (k + 1)].copy_from_slice(&sum);
        }
    }
}

/// `sum += factor row`.
#[inline(always)]
fn add<S: Simd, const N: usize>(simd: S, sum: &mut [S::f64s], factor: f64, row: &[S::f64s]) {
    let factor = simd.splat_f64s(factor);
    for n in 0..N {
        sum[n] = simd.mul_add_e_f64s(factor, row[n], sum[n]);
    }
}

#[inline(always)]
fn divide<S: Simd, const N: usize>(simd: S, row: &mut [S::f64s; N], by: f64) {
    let by = simd.splat_f64s(by);
    for x in row {
        *x = simd.div_f64s(*x, by);
    }
}

/// Columns of the factor from the row of the first on; empty beyond the `count`th.
#[inline(always)]
fn columns(lower: MatRef<'_, f64>, first: usize, count: usize) -> [&[f64]; COLUMNS] {
    std::array::from_fn(|k| {
        let column = (k < count).then(|| lower.col(first + k).try_as_col_major());
        column.flatten().map_or(&[][..], |column| &column.as_slice()[first..])
    })
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    /// Both sweeps on all instruction sets against products with the triangle, for every remainder of columns.
    #[test]
    fn triangles_are_solved_on_all_instruction_sets() {
        for (own, below) in [(1, 0), (2, 3), (3, 9), (4, 1), (5, 0), (7, 2), (12, 20), (17, 6)] {
            let mixed = |n: usize| ((n * 7919 + 13) % 101) as f64 / 101.0 - 0.5;
            let lower = Mat::from_fn(own + below, own, |i, j| match i {
                i if i < j => f64::NAN,
                i if i == j => 2.0 + mixed(i),
                _ => mixed(i * own + j),
            });
            let rows: Vec<Row> =
                (0..own + below).map(|i| std::array::from_fn(|k| mixed(11 * i + k))).collect();
            check::<8>(pulp::Scalar::new(), lower.as_ref(), &rows);
            #[cfg(target_arch = "x86_64")]
            {
                if let Some(simd) = pulp::x86::V3::try_new() {
                    check::<2>(simd, lower.as_ref(), &rows);
                }
                if let Some(simd) = pulp::x86::V4::try_new() {
                    check::<1>(simd, lower.as_ref(), &rows);
                }
            }
        }
    }

    fn check<const N: usize>(simd: impl Simd, lower: MatRef<'_, f64>, rows: &[Row]) {
        fn sweep<S: Simd, const N: usize>(
            simd: S,
            lower: MatRef<'_, f64>,
            rows: &mut [Row],
            is_forward: bool,
        ) {
            let rows: &mut [S::f64s] = pulp::bytemuck::cast_slice_mut(rows);
            if is_forward {
                forward::<S, N>(simd, lower, rows);
            } else {
                backward::<S, N>(simd, lower, rows);
            }
        }
        let own = lower.ncols();
        let entry = |i: usize, j: usize| if j <= i { lower[(i, j)] } else { 0.0 };
        let mut found = rows.to_vec();
        sweep::<_, N>(simd, lower, &mut found, true);
        for side in 0..SIDES {
            for i in 0..rows.len() {
                let part: f64 = (0..own).map(|j| entry(i, j) * found[j][side]).sum();
                let sum = if i < own { part } else { part + found[i][side] };
                assert!((sum - rows[i][side]).abs() < 1e-13, "forward {own} {i} {side}");
            }
        }
        let mut found = rows.to_vec();
        sweep::<_, N>(simd, lower, &mut found, false);
        for side in 0..SIDES {
            for j in 0..own {
                let sum: f64 = (0..rows.len()).map(|i| entry(i, j) * found[i][side]).sum();
                assert!((sum - rows[j][side]).abs() < 1e-13, "backward {own} {j} {side}");
            }
        }
    }
}
