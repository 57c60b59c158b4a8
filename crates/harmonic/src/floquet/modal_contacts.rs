//! Stiffness and damping of many contacts in the coordinates of few modes.

use super::variational_equation::{VariationalEquation, add};

/// `Phi^T (1 + K_c R)^-1 K_c Phi` and the damping of the contacts in the same coordinates, without the matrices of the
/// pairs. With `s = K_c^1/2` and the Cholesky factor `U^T U = 1 + s R s`, which only contacts that carry enter,
///
/// ```text
/// Y = U^-T s Phi,   Phi^T K Phi = Y^T Y,   K Phi = s U^-1 Y,   A Phi = Phi - R K Phi.
/// ```
#[derive(Debug, Clone, Default)]
pub(super) struct ModalContacts {
    /// Participations, a row for each pair.
    shapes: Vec<f64>,
    /// Pairs that carry, and the roots of their tangents.
    active: Vec<usize>,
    roots: Vec<f64>,
    /// The factor by rows, each used from the diagonal on.
    factor: Vec<f64>,
    /// Y, and then K Phi of the active pairs, by rows.
    solved: Vec<f64>,
    forces: Vec<f64>,
    row: Vec<f64>,
}

impl ModalContacts {
    /// Takes the modes of an equation.
    pub(super) fn take(&mut self, variation: &VariationalEquation) {
        let modes = &variation.modes;
        let row = |i: usize| modes.iter().map(move |mode| mode.closure[i]);
        self.shapes.clear();
        self.shapes.extend((0..variation.interfaces()).flat_map(row));
    }

    /// Writes the stiffness for the tangents `K_c` \[N/m\], a row for each mode.
    #[inline]
    pub(super) fn stiffness(
        &mut self,
        variation: &VariationalEquation,
        tangents: impl Fn(usize) -> f64,
        out: &mut [f64],
    ) {
        let modes = variation.modes.len();
        self.active.clear();
        self.active.extend((0..variation.interfaces()).filter(|&i| tangents(i) != 0.0));
        self.roots.clear();
        self.roots.extend(self.active.iter().map(|&i| tangents(i).sqrt()));
        let n = self.active.len();
        out.fill(0.0);
        self.factor.resize(n * n, 0.0);
        self.solved.resize(n * modes, 0.0);
        if n == 0 {
            return;
        }
        let rows = self.factor.chunks_exact_mut(n).zip(self.solved.chunks_exact_mut(modes));
        for (k, (row, solved)) in rows.enumerate() {
            let (pair, root) = (self.active[k], self.roots[k]);
            let flexibility = &variation.flexibility()[pair];
            for ((entry, &other), other_root) in row.iter_mut().zip(&self.active).zip(&self.roots) {
                *entry = root * flexibility[other] * other_root;
            }
            row[k] += 1.0;
            let shapes = &self.shapes[pair * modes..][..modes];
            solved.iter_mut().zip(shapes).for_each(|(y, phi)| *y = root * phi);
        }
        // Positive definite with pivots of one at least: the flexibility is not negative.
        for k in 0..n {
            let (above, below) = self.factor.split_at_mut((k + 1) * n);
            let own = &mut above[k * n + k..];
            let scale = 1.0 / own[0].sqrt();
            multiply(own, scale);
            let (before, after) = self.solved.split_at_mut((k + 1) * modes);
            let y = &mut before[k * modes..];
            multiply(y, scale);
            let rows = below.chunks_exact_mut(n).zip(after.chunks_exact_mut(modes));
            for (i, (row, solved)) in rows.enumerate() {
                let share = own[i + 1];
                add(&mut row[k + 1 + i..], -share, &own[i + 1..]);
                add(solved, -share, y);
            }
        }
        for y in self.solved.chunks_exact(modes) {
            for (share, to) in y.iter().zip(out.chunks_exact_mut(modes)) {
                add(to, *share, y);
            }
        }
    }

    /// Writes the damping for the contact dampers `C_c` \[N s/m\] under the stiffness written last, a row for each
    /// mode: [`VariationalEquation::damping`] in the coordinates of the modes.
    #[inline]
    pub(super) fn damping(
        &mut self,
        variation: &VariationalEquation,
        dampers: impl Fn(usize) -> f64,
        out: &mut [f64],
    ) {
        let (modes, n) = (variation.modes.len(), self.active.len());
        for k in (0..n).rev() {
            let (before, after) = self.solved.split_at_mut((k + 1) * modes);
            let own = &mut before[k * modes..];
            let row = &self.factor[k * n + k..][..n - k];
            for (share, z) in row[1..].iter().zip(after.chunks_exact(modes)) {
                add(own, -share, z);
            }
            let scale = 1.0 / row[0];
            multiply(own, scale);
        }
        let pairs = variation.interfaces();
        self.forces.clear();
        self.forces.resize(pairs * modes, 0.0);
        for ((&pair, root), z) in
            self.active.iter().zip(&self.roots).zip(self.solved.chunks_exact(modes))
        {
            add(&mut self.forces[pair * modes..][..modes], *root, z);
        }
        out.fill(0.0);
        for (l, flexibility) in variation.flexibility().iter().enumerate() {
            let damper = dampers(l);
            if damper == 0.0 {
                continue;
            }
            self.row.clear();
            self.row.extend_from_slice(&self.shapes[l * modes..][..modes]);
            for (r, force) in flexibility.iter().zip(self.forces.chunks_exact(modes)) {
                add(&mut self.row, -r, force);
            }
            for (share, to) in self.row.iter().zip(out.chunks_exact_mut(modes)) {
                add(to, damper * share, &self.row);
            }
        }
        let retardations = variation.retardation().chunks_exact(pairs);
        for (retardation, own) in retardations.zip(self.forces.chunks_exact(modes)) {
            self.row.clear();
            self.row.resize(modes, 0.0);
            for (d, force) in retardation.iter().zip(self.forces.chunks_exact(modes)) {
                add(&mut self.row, *d, force);
            }
            for (share, to) in own.iter().zip(out.chunks_exact_mut(modes)) {
                add(to, *share, &self.row);
            }
        }
    }
}

#[inline]
fn multiply(values: &mut [f64], factor: f64) {
    for value in values {
        *value *= factor;
    }
}
