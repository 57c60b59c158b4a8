//! The linear equation of small disturbances.

use asperity_mesh::ComponentModes;
use asperity_structure::DampedMode;
use faer::{Mat, Side};

/// Frequency of an elastic mode, over the fastest motion on the contacts, beyond which it is static.
const STATIC: f64 = 1e3;

/// Modes with contact tangents that vary over the period. Displacements in guides with friction are
/// closures after those of the contacts.
#[derive(Debug, Clone)]
pub(super) struct VariationalEquation {
    pub(super) modes: Vec<PairMode>,
    /// Closure of pair i per force at pair j, row i, of the modes left out \[m/N\].
    flexibility: Vec<Vec<f64>>,
    /// Closures per rate of the contact forces, `sum c g g^T / w^4` of the damped modes that are static
    /// \[m s/N\], by rows; empty without them.
    retardation: Vec<f64>,
    /// Linearised modes with a damping of their own, from the lowest on.
    pub(super) dampers: Vec<ModeDamper>,
    matrix: Vec<f64>,
}

/// A mode as the pairs see it.
#[derive(Debug, Clone)]
pub(super) struct PairMode {
    /// Angular frequency \[rad/s\].
    pub(super) angular_frequency: f64,
    /// Total damping rate \[1/s\].
    pub(super) damping_rate: f64,
    /// Participation of the closure of each pair \[kg^-1/2\].
    pub(super) closure: Vec<f64>,
}

/// Damping of a linearised mode.
#[derive(Debug, Clone)]
pub(super) struct ModeDamper {
    /// Damping rate beyond that of the others \[1/s\].
    pub(super) excess: f64,
    /// Coordinates of the mode in the component modes.
    pub(super) shape: Vec<f64>,
}

/// Modes of the structure on springs in its contacts, from the lowest on.
#[derive(Debug, Clone)]
pub(super) struct LinearisedModes {
    /// Squares of the frequencies \[rad^2/s^2\].
    pub(super) squares: Vec<f64>,
    /// Coordinates in the component modes, a row each.
    pub(super) shapes: Vec<Vec<f64>>,
}

impl VariationalEquation {
    /// The equation of `modes` under the mass-proportional damping `rate` \[1/s\], for contacts whose
    /// stiffness is of the order of `springs` \[N/m\]. Elastic modes far above all others are static, and
    /// so are overdamped ones above all motions on the contacts; their damping remains.
    pub(super) fn new(modes: &ComponentModes, rate: f64, springs: &[f64]) -> Self {
        let pairs = modes.pairs();
        let n = pairs.len();
        let row = |&a| pairs.iter().map(|&b| modes.residual().closure(a, b)).collect();
        let flexibility = pairs.iter().map(row).collect();
        let (retardation, matrix) = (Vec::new(), vec![0.0; 2 * n * n]);
        let (modes_kept, dampers) = (Vec::new(), Vec::new());
        let mut found = Self { modes: modes_kept, flexibility, retardation, dampers, matrix };
        let stiffest = springs.iter().copied().fold(0.0, f64::max);
        let contacts = modes.contacts().len();
        let all: Vec<PairMode> = modes
            .modes()
            .iter()
            .map(|mode| PairMode {
                angular_frequency: mode.angular_frequency,
                damping_rate: mode.total_damping(rate),
                closure: pairs.iter().map(|&pair| mode.closure(pair)).collect(),
            })
            .collect();
        let on_contacts = |mode: &PairMode| stiffest * square_of(&mode.closure[..contacts]);
        let fastest = all.iter().map(on_contacts).fold(0.0, f64::max).sqrt();
        for (own, mode) in modes.modes().iter().zip(all) {
            let w = mode.angular_frequency;
            let overdamped = w > fastest && own.damping_rate > 2.0 * w;
            if own.massless || overdamped || w > STATIC * fastest {
                found.leave_out(PairMode { damping_rate: own.damping_rate, ..mode });
            } else {
                found.modes.push(mode);
            }
        }
        found
    }

    /// Adds the damping of linearised modes, under contacts of the stiffness `springs` \[N/m\]; those
    /// beyond the modes of the equation have none.
    pub(super) fn add_dampers(&mut self, damped: &[DampedMode], rate: f64, springs: &[f64]) {
        if damped.is_empty() {
            return;
        }
        let Some(modes) = self.linearised(springs) else { return };
        let damper = |(mode, shape): (&DampedMode, Vec<f64>)| ModeDamper {
            excess: mode.damping_rate - rate,
            shape,
        };
        self.dampers = damped.iter().zip(modes.shapes).map(damper).collect();
    }

    /// The modes under contacts of the stiffness `springs` \[N/m\], none in guides.
    pub(super) fn linearised(&mut self, springs: &[f64]) -> Option<LinearisedModes> {
        let (n, count) = (self.interfaces(), self.modes.len());
        let mut at_rest = vec![0.0; n * n];
        self.stiffness(|i| springs.get(i).copied().unwrap_or(0.0), &mut at_rest);
        let modes = &self.modes;
        let coupling = |a: usize, b: usize| -> f64 {
            let pair = |i: usize, j: usize| modes[a].closure[i] * modes[b].closure[j];
            (0..n * n).map(|place| at_rest[place] * pair(place / n, place % n)).sum()
        };
        let matrix = Mat::from_fn(count, count, |a, b| {
            let own = if a == b { modes[a].angular_frequency.powi(2) } else { 0.0 };
            own + 0.5 * (coupling(a, b) + coupling(b, a))
        });
        let found = matrix.self_adjoint_eigen(Side::Lower).ok()?;
        let (vectors, values) = (found.U(), found.S().column_vector());
        Some(LinearisedModes {
            squares: (0..count).map(|r| values[r].max(0.0)).collect(),
            shapes: (0..count).map(|r| (0..count).map(|j| vectors[(j, r)]).collect()).collect(),
        })
    }

    /// Adds the flexibility of a static mode and the lag of its damping.
    fn leave_out(&mut self, mode: PairMode) {
        let PairMode { angular_frequency: w, damping_rate, closure } = mode;
        let n = self.interfaces();
        if damping_rate != 0.0 {
            self.retardation.resize(n * n, 0.0);
        }
        for (i, own) in closure.iter().enumerate() {
            for (j, other) in closure.iter().enumerate() {
                self.flexibility[i][j] += own * other * w.powi(-2);
                if damping_rate != 0.0 {
                    self.retardation[i * n + j] += damping_rate * w.powi(-4) * own * other;
                }
            }
        }
    }

    /// Leaves out the last mode of a test.
    #[cfg(test)]
    pub(super) fn leave_out_last(&mut self) {
        if let Some(mode) = self.modes.pop() {
            self.leave_out(mode);
        }
    }

    /// True if static modes are damped: they add damping to all others.
    pub(super) fn is_retarded(&self) -> bool {
        !self.retardation.is_empty()
    }

    /// Number of pairs: interfaces, and after them guides with friction.
    pub(super) fn interfaces(&self) -> usize {
        self.flexibility.len()
    }

    /// Closures of pair i per force at pair j, row i, of the modes left out \[m/N\].
    pub(super) fn flexibility(&self) -> &[Vec<f64>] {
        &self.flexibility
    }

    /// Closures per rate of the forces of static modes \[m s/N\], by rows; empty without damped ones.
    pub(super) fn retardation(&self) -> &[f64] {
        &self.retardation
    }

    /// An upper estimate of the highest frequency [rad/s] with contact stiffnesses up to
    /// `stiffness` [N/m].
    pub(super) fn highest_frequency(&self, stiffness: f64) -> f64 {
        let square =
            |mode: &PairMode| mode.angular_frequency.powi(2) + stiffness * square_of(&mode.closure);
        self.modes.iter().map(square).fold(0.0, f64::max).sqrt()
    }

    /// The highest frequency \[rad/s\] with contacts of the stiffnesses `springs` \[N/m\], none in guides.
    pub(super) fn highest_frequency_on(&mut self, springs: &[f64]) -> Option<f64> {
        let are_numbers = springs.iter().all(|k| k.is_finite());
        let modes = are_numbers.then(|| self.linearised(springs)).flatten()?;
        Some(modes.squares.into_iter().fold(0.0, f64::max).sqrt())
    }

    /// The highest frequency \[rad/s\] and damping rate \[1/s\] of the modes without contacts.
    pub(super) fn highest(&self) -> (f64, f64) {
        let excess = self.dampers.iter().map(|damper| damper.excess).fold(0.0, f64::max);
        let frequency = self.modes.iter().map(|mode| mode.angular_frequency).fold(0.0, f64::max);
        let rate = self.modes.iter().map(|mode| mode.damping_rate).fold(0.0, f64::max);
        (frequency, excess + rate)
    }

    /// An upper estimate of the highest damping rate [1/s] with contact dampers up to `damper` [N s/m]
    /// and contacts of stiffnesses up to `springs` [N/m], none in guides.
    pub(super) fn highest_damping(&self, damper: f64, springs: &[f64]) -> f64 {
        let n = self.interfaces();
        let retarded = |(i, entry): (usize, &f64)| {
            let (flexibility, stiffness) = (self.flexibility[i][i], springs.get(i).unwrap_or(&0.0));
            entry * (stiffness / (1.0 + stiffness * flexibility)).powi(2)
        };
        let damper =
            damper + self.retardation.iter().step_by(n + 1).enumerate().map(retarded).sum::<f64>();
        let rate = |mode: &PairMode| mode.damping_rate + damper * square_of(&mode.closure);
        let excess = self.dampers.iter().map(|damper| damper.excess).fold(0.0, f64::max);
        excess + self.modes.iter().map(rate).fold(0.0, f64::max)
    }

    /// Writes `A^T C_c A + K D K` for the contact dampers `C_c` \[N s/m\], by rows: A is the share of the
    /// contacts in the closures, `(1 + R K_c)^-1 = 1 - R K` with the `stiffness` K of
    /// [`stiffness`](Self::stiffness), D the retardation of the static modes. Of first order in the
    /// damping times the residual flexibility.
    #[inline]
    pub(super) fn damping(
        &self,
        dampers: impl Fn(usize) -> f64,
        stiffness: &[f64],
        out: &mut [f64],
    ) {
        let n = self.interfaces();
        out.fill(0.0);
        let mut row = vec![0.0; n];
        for (l, flexibility) in self.flexibility.iter().enumerate() {
            let damper = dampers(l);
            if damper == 0.0 {
                continue;
            }
            row.fill(0.0);
            row[l] = 1.0;
            for (r, k) in flexibility.iter().zip(stiffness.chunks_exact(n)) {
                add(&mut row, -r, k);
            }
            for (share, to) in row.iter().zip(out.chunks_exact_mut(n)) {
                add(to, damper * share, &row);
            }
        }
        for (l, retardation) in self.retardation.chunks_exact(n).enumerate() {
            row.fill(0.0);
            for (d, k) in retardation.iter().zip(stiffness.chunks_exact(n)) {
                add(&mut row, *d, k);
            }
            for (k, to) in stiffness[l * n..][..n].iter().zip(out.chunks_exact_mut(n)) {
                add(to, *k, &row);
            }
        }
    }

    /// Writes `(1 + K_c R)^-1 K_c` for the tangents `K_c` \[N/m\] of the contacts, by rows.
    ///
    /// The residual flexibility is positive, so that elimination needs no exchanges: in the order
    /// of the rows, `1 + K_c R` keeps positive pivots.
    #[inline]
    pub(super) fn stiffness(&mut self, tangents: impl Fn(usize) -> f64, out: &mut [f64]) {
        let n = self.interfaces();
        if n == 1 {
            let k = tangents(0);
            out[0] = k / (1.0 + k * self.flexibility[0][0]);
            return;
        }
        if n == 2 {
            // The inverse of a matrix of two rows, times K_c.
            let ([k0, k1], r) = ([tangents(0), tangents(1)], &self.flexibility);
            let (a, b) = (1.0 + k0 * r[0][0], k0 * r[0][1]);
            let (c, d) = (k1 * r[1][0], 1.0 + k1 * r[1][1]);
            let inverse = 1.0 / (a * d - b * c);
            let cross = -b * k1 * inverse;
            out.copy_from_slice(&[d * k0 * inverse, cross, -c * k0 * inverse, a * k1 * inverse]);
            return;
        }
        let width = 2 * n;
        self.matrix.fill(0.0);
        for i in 0..n {
            let k = tangents(i);
            for j in 0..n {
                self.matrix[i * width + j] = k * self.flexibility[i][j];
            }
            self.matrix[i * width + i] += 1.0;
            self.matrix[i * width + n + i] = k;
        }
        for column in 0..n {
            let pivot = self.matrix[column * width + column];
            let (above, rest) = self.matrix.split_at_mut(column * width);
            let (own, below) = rest.split_at_mut(width);
            // Columns beyond the unit matrix's one in this row are zero.
            let used = column..n + column + 1;
            own[used.clone()].iter_mut().for_each(|entry| *entry /= pivot);
            for row in above.chunks_exact_mut(width).chain(below.chunks_exact_mut(width)) {
                let factor = row[column];
                if factor != 0.0 {
                    add(&mut row[used.clone()], -factor, &own[used.clone()]);
                }
            }
        }
        for i in 0..n {
            out[i * n..(i + 1) * n].copy_from_slice(&self.matrix[i * width + n..(i + 1) * width]);
        }
    }
}

/// Adds a multiple of `what`.
#[inline]
pub(super) fn add(to: &mut [f64], factor: f64, what: &[f64]) {
    for (t, w) in to.iter_mut().zip(what) {
        *t += factor * w;
    }
}

fn square_of(shape: &[f64]) -> f64 {
    shape.iter().map(|phi| phi * phi).sum()
}
