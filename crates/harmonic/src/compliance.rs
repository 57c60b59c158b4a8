//! Compliance of a linear structure at its contact faces and ports.

use num_complex::Complex64;

use crate::Dual;
use crate::complex_elimination::eliminate;

/// Receptances between all pairs of faces and some ports of a structure, at one frequency.
///
/// The pairs are the contacts and after them the guides with friction; ports follow. With contact
/// forces P (pressing, one per pair), a load F at port l, the closures x and the displacement u of port
/// p, the receptances are
///
/// ```text
/// x_i = G_il F - sum_j G_ij P_j,    u_p = G_pl F - sum_j G_pj P_j,
/// ```
///
/// a symmetric matrix by reciprocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliance {
    pairs: usize,
    size: usize,
    /// By rows.
    entries: Vec<Dual>,
}

impl Compliance {
    /// A compliance of zero, for a structure with so many pairs and ports.
    pub fn zero(pairs: usize, ports: usize) -> Self {
        let size = pairs + ports;
        Self { pairs, size, entries: vec![Dual::default(); size * size] }
    }

    /// Number of pairs.
    pub fn pairs(&self) -> usize {
        self.pairs
    }

    /// Number of pairs and ports.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Receptance between two places \[m/N\], pairs counted first, and after them ports.
    pub fn get(&self, a: usize, b: usize) -> &Dual {
        &self.entries[a * self.size + b]
    }

    /// Sets a receptance, both ways.
    pub fn set(&mut self, a: usize, b: usize, receptance: Dual) {
        self.entries[a * self.size + b] = receptance;
        self.entries[b * self.size + a] = receptance;
    }

    /// Adds a receptance times the `participations` of both places.
    pub fn add(&mut self, participations: &[f64], receptance: &Dual) {
        for (row, own) in self.entries.chunks_exact_mut(self.size.max(1)).zip(participations) {
            for (entry, other) in row.iter_mut().zip(participations) {
                entry.add(receptance, own * other);
            }
        }
    }

    /// Puts springs of these complex stiffnesses K \[N/m\] into the pairs: the compliance G of the
    /// structure without them becomes
    ///
    /// ```text
    /// T G,    T = (1 + G K)^-1,    with derivatives T G' T^T.
    /// ```
    ///
    /// Exact but for rounding, which is that of G over the result: a free body much lighter than
    /// `K / w^2` needs a closed form. Pairs beyond the springs given have none.
    pub fn add_springs(&mut self, springs: &[Complex64]) {
        if springs.iter().all(|spring| *spring == Complex64::ZERO) {
            return;
        }
        let (n, size) = (self.pairs, self.size);
        let spring = |i: usize| springs.get(i).copied().unwrap_or(Complex64::ZERO);
        let width = 2 * n + size;
        // Columns of the pairs' rows: 1 + G K, then G and the unit matrix.
        let mut rows = vec![Complex64::ZERO; n * width];
        for i in 0..n {
            for j in 0..n {
                rows[i * width + j] = self.get(i, j).value * spring(j);
            }
            for c in 0..size {
                rows[i * width + n + c] = self.get(i, c).value;
            }
            rows[i * width + i] += 1.0;
            rows[i * width + n + size + i] = Complex64::ONE;
        }
        eliminate(&mut rows, n, width);
        // A port moves by the forces of the springs, K T G.
        let force = |i: usize, c: usize| spring(i) * rows[i * width + n + c];
        let mut transfer = vec![Complex64::ZERO; size * size];
        for a in 0..size {
            for i in 0..n {
                transfer[a * size + i] =
                    if a < n { rows[a * width + n + size + i] } else { -force(i, a) };
            }
            if a >= n {
                transfer[a * size + a] = Complex64::ONE;
            }
        }
        let congruent = |of: fn(&Dual) -> Complex64| {
            let product = |place: usize| -> Complex64 {
                let (a, d) = (place / size, place % size);
                (0..size).map(|c| transfer[a * size + c] * of(self.get(c, d))).sum()
            };
            (0..size * size).map(product).collect::<Vec<_>>()
        };
        let slopes = [congruent(|g| g.d_frequency), congruent(|g| g.d_anti_damping)];
        let mut found = Self::zero(n, size - n);
        for a in 0..size {
            for b in a..size {
                let value = if a < n {
                    rows[a * width + n + b]
                } else {
                    let lost = (0..n).map(|j| self.get(a, j).value * force(j, b));
                    self.get(a, b).value - lost.sum::<Complex64>()
                };
                let along = |half: &Vec<Complex64>| -> Complex64 {
                    (0..size).map(|d| half[a * size + d] * transfer[b * size + d]).sum()
                };
                let [d_frequency, d_anti_damping] = [along(&slopes[0]), along(&slopes[1])];
                found.set(a, b, Dual { value, d_frequency, d_anti_damping });
            }
        }
        *self = found;
    }

    /// Sets every receptance to zero.
    pub fn clear(&mut self) {
        self.entries.fill(Dual::default());
    }
}

/// Balance of the mean closures X0 and mean contact force increments P0 of a periodic motion.
///
/// At zero frequency the compliance of bodies that only contacts hold is infinite, so the balance
/// is written `closure X0 + force P0 = 0`, square matrices stored by rows. For a stack, which is
/// statically determinate, it is `P0 = 0`: the mean pressures are the static ones, however far
/// the mean closures shift. The mean displacements of ports are `port_closure X0 + port_force P0`.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanBalance {
    /// Factors of the mean closures \[-\], by rows.
    pub closure: Vec<f64>,
    /// Factors of the mean force increments \[m/N\], by rows, or without unit in rows that have no
    /// closure.
    pub force: Vec<f64>,
    /// Mean displacement per mean closure \[-\], a row for each port.
    pub port_closure: Vec<f64>,
    /// Mean displacement per mean force increment \[m/N\], a row for each port.
    pub port_force: Vec<f64>,
}
