//! Compliance of a linear structure at its contact faces and its driving point.

use num_complex::Complex64;

use crate::complex_elimination::eliminate;

/// A receptance \[m/N\] and its derivatives.
///
/// Time goes as `exp(i w t)`, so that a damped structure lags: imaginary parts of direct
/// receptances are negative.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Receptance {
    /// Complex displacement per complex force \[m/N\].
    pub value: Complex64,
    /// Derivative with respect to the angular frequency \[m s/(N rad)\].
    pub d_frequency: Complex64,
    /// Derivative with respect to the anti-damping rate \[m s/N\].
    pub d_anti_damping: Complex64,
}

impl Receptance {
    /// Adds `factor` times `other`, derivatives included.
    pub(crate) fn add(&mut self, other: &Self, factor: f64) {
        self.value += other.value * factor;
        self.d_frequency += other.d_frequency * factor;
        self.d_anti_damping += other.d_anti_damping * factor;
    }
}

/// Receptances at all contact faces and the driving point of a structure, at one frequency.
///
/// Guides with friction count as interfaces here, after those of the structure. With contact forces P
/// (pressing, one per interface), the drive F and the closures x,
///
/// ```text
/// x = drive F - contact P,    u = direct F - drive^T P,
/// ```
///
/// u being the displacement of the driving point; the second line holds by reciprocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliance {
    interfaces: usize,
    contact: Vec<Receptance>,
    drive: Vec<Receptance>,
    /// Displacement of the driving point per drive force \[m/N\].
    pub direct: Receptance,
}

impl Compliance {
    /// A compliance of zero, for a structure with `interfaces` interfaces.
    pub fn zero(interfaces: usize) -> Self {
        Self {
            interfaces,
            contact: vec![Receptance::default(); interfaces * interfaces],
            drive: vec![Receptance::default(); interfaces],
            direct: Receptance::default(),
        }
    }

    /// Number of interfaces.
    pub fn interfaces(&self) -> usize {
        self.interfaces
    }

    /// Loss of closure at interface `row` per contact force at interface `column` \[m/N\].
    pub fn contact(&self, row: usize, column: usize) -> &Receptance {
        &self.contact[row * self.interfaces + column]
    }

    /// Mutable access to [`contact`](Self::contact).
    pub fn contact_mut(&mut self, row: usize, column: usize) -> &mut Receptance {
        &mut self.contact[row * self.interfaces + column]
    }

    /// Closure at `interface` per drive force \[m/N\].
    pub fn drive(&self, interface: usize) -> &Receptance {
        &self.drive[interface]
    }

    /// Mutable access to [`drive`](Self::drive).
    pub fn drive_mut(&mut self, interface: usize) -> &mut Receptance {
        &mut self.drive[interface]
    }

    /// Puts springs of these complex stiffnesses K \[N/m\] into the contacts: with the compliance G of the
    /// free structure, `A = (1 + G K)^-1` and `c = A g`,
    ///
    /// ```text
    /// contact: A G,    drive: c,    direct: r - g^T K c.
    /// ```
    ///
    /// Exact but for rounding, which is that of G over the result: a free body much lighter than
    /// `K / w^2` needs a closed form.
    pub fn add_springs(&mut self, springs: &[Complex64]) {
        let n = self.interfaces;
        let width = 3 * n + 1;
        // Columns: 1 + G K, then G, g and the unit matrix.
        let mut rows = vec![Complex64::ZERO; n * width];
        for i in 0..n {
            for j in 0..n {
                let g = self.contact(i, j).value;
                rows[i * width + j] = g * springs[j];
                rows[i * width + n + j] = g;
            }
            rows[i * width + i] += 1.0;
            rows[i * width + 2 * n] = self.drive(i).value;
            rows[i * width + 2 * n + 1 + i] = Complex64::ONE;
        }
        eliminate(&mut rows, n, width);
        let solved = |row: usize, column: usize| rows[row * width + column];
        // Forces of the springs per drive force, K c.
        let forces: Vec<Complex64> = (0..n).map(|i| solved(i, 2 * n) * springs[i]).collect();
        let mut found = Self::zero(n);
        let slopes: [fn(&Receptance) -> Complex64; 2] = [|r| r.d_frequency, |r| r.d_anti_damping];
        let sum = |terms: &dyn Fn(usize) -> Complex64| (0..n).map(terms).sum::<Complex64>();
        for i in 0..n {
            // (A G)' = A G' A^T and (A g)' = A (g' - G' K c).
            let derivatives = slopes.map(|of| {
                let drive =
                    |m: usize| of(self.drive(m)) - sum(&|l| of(self.contact(m, l)) * forces[l]);
                let along = |j: usize| {
                    let inner =
                        |m: usize| sum(&|l| of(self.contact(m, l)) * solved(j, 2 * n + 1 + l));
                    sum(&|m| solved(i, 2 * n + 1 + m) * inner(m))
                };
                let drive = sum(&|m| solved(i, 2 * n + 1 + m) * drive(m));
                (drive, (0..n).map(along).collect::<Vec<_>>())
            });
            let [frequency, damping] = derivatives;
            for j in 0..n {
                *found.contact_mut(i, j) = Receptance {
                    value: solved(i, n + j),
                    d_frequency: frequency.1[j],
                    d_anti_damping: damping.1[j],
                };
            }
            *found.drive_mut(i) = Receptance {
                value: solved(i, 2 * n),
                d_frequency: frequency.0,
                d_anti_damping: damping.0,
            };
        }
        let direct = |of: fn(&Receptance) -> Complex64| {
            let twice = sum(&|i| of(self.drive(i)) * forces[i]);
            let inner = |i: usize| sum(&|j| of(self.contact(i, j)) * forces[j]);
            of(&self.direct) - twice * 2.0 + sum(&|i| forces[i] * inner(i))
        };
        found.direct = Receptance {
            value: self.direct.value - sum(&|i| self.drive(i).value * forces[i]),
            d_frequency: direct(slopes[0]),
            d_anti_damping: direct(slopes[1]),
        };
        *self = found;
    }

    /// Sets every receptance to zero.
    pub fn clear(&mut self) {
        self.contact.fill(Receptance::default());
        self.drive.fill(Receptance::default());
        self.direct = Receptance::default();
    }
}

/// Balance of the mean closures X0 and mean contact force increments P0 of a periodic motion.
///
/// At zero frequency the compliance of bodies that only contacts hold is infinite, so the balance
/// is written `closure X0 + force P0 = 0`, square matrices stored by rows. For a stack, which is
/// statically determinate, it is `P0 = 0`: the mean pressures are the static ones, however far
/// the mean closures shift. The mean displacement of the driving point is
/// `output_closure . X0 + output_force . P0`.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanBalance {
    /// Factors of the mean closures \[-\], by rows.
    pub closure: Vec<f64>,
    /// Factors of the mean force increments \[m/N\], by rows, or without unit in rows that have no
    /// closure.
    pub force: Vec<f64>,
    /// Mean displacement of the driving point per mean closure \[-\].
    pub output_closure: Vec<f64>,
    /// Mean displacement of the driving point per mean force increment \[m/N\].
    pub output_force: Vec<f64>,
}

impl MeanBalance {
    /// The balance of a chain of bodies that rest one on another: `P0 = 0`, and the top moves by
    /// the sum of the closures.
    pub fn determinate(interfaces: usize) -> Self {
        let mut force = vec![0.0; interfaces * interfaces];
        for i in 0..interfaces {
            force[i * interfaces + i] = 1.0;
        }
        Self {
            closure: vec![0.0; interfaces * interfaces],
            force,
            output_closure: vec![1.0; interfaces],
            output_force: vec![0.0; interfaces],
        }
    }
}
