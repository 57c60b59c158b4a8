//! Receptances between few contacts, as matrices.

use num_complex::Complex64;

use crate::dual::Part;
use crate::fourier::amplitude_of;
use crate::{Compliance, ContactSystem, Dual, MeanBalance};

/// The compliance of the pairs and the load at each harmonic, and the balance of means: the linear structure of
/// systems with few contacts.
#[derive(Debug)]
pub(super) struct DenseReceptances {
    pairs: usize,
    terms: usize,
    mean: MeanBalance,
    compliances: Vec<Compliance>,
}

impl DenseReceptances {
    /// Receptances at so many harmonics; rows of the means without closures are divided by the stiffness
    /// `stiffest` \[N/m\], which makes them closures.
    pub(super) fn new(system: &ContactSystem, harmonics: usize, stiffest: f64) -> Self {
        let n = system.pairs();
        let mut mean = system.linear().mean_balance(system.ports());
        for row in 0..n {
            let range = row * n..(row + 1) * n;
            if mean.closure[range.clone()].iter().all(|&a| a == 0.0) {
                mean.force[range].iter_mut().for_each(|b| *b /= stiffest);
            }
        }
        let compliances = vec![Compliance::zero(n, 1); harmonics];
        Self { pairs: n, terms: 2 * harmonics + 1, mean, compliances }
    }

    /// Moves to a frequency and an anti-damping rate.
    pub(super) fn update(&mut self, system: &ContactSystem, at: (f64, f64), springs: &[Complex64]) {
        for (k, compliance) in (1..).map(f64::from).zip(&mut self.compliances) {
            system.linear().compliance((k * at.0, at.1), system.load(), springs, compliance);
        }
    }

    /// The receptance of two places at harmonic k.
    pub(super) fn get(&self, k: usize, a: usize, b: usize) -> &Dual {
        self.compliances[k - 1].get(a, b)
    }

    /// Writes `X_k + G_k f_k - g_k F_k` of all pairs, and of the means their balance.
    pub(super) fn residual(&self, x: &[f64], (forces, load): (&[f64], f64), out: &mut [f64]) {
        let (n, terms) = (self.pairs, self.terms);
        for i in 0..n {
            out[i * terms] = (0..n)
                .map(|j| {
                    self.mean.closure[i * n + j] * x[j * terms]
                        + self.mean.force[i * n + j] * forces[j * terms]
                })
                .sum();
            for k in 1..=self.compliances.len() {
                let r = self.at_place((i, k), Part::Value, (forces, load));
                out[i * terms + 2 * k - 1] = x[i * terms + 2 * k - 1] + r.re;
                out[i * terms + 2 * k] = x[i * terms + 2 * k] - r.im;
            }
        }
    }

    /// Writes `G'_k f_k - g'_k F_k` with derivatives of the receptances at harmonic k by frequency or rate.
    pub(super) fn slope(&self, part: Part, forces: (&[f64], f64), out: &mut [f64]) {
        for (i, out) in out.chunks_exact_mut(self.terms).enumerate() {
            out[0] = 0.0;
            for k in 1..=self.compliances.len() {
                let r = self.at_place((i, k), part, forces);
                (out[2 * k - 1], out[2 * k]) = (r.re, -r.im);
            }
        }
    }

    /// Factor of the mean closure of pair j in row i of the balance of means.
    pub(super) fn mean_closure(&self, i: usize, j: usize) -> f64 {
        self.mean.closure[i * self.pairs + j]
    }

    /// Puts the rows of pair `i` under the derivatives `product` of the force of pair `j` into the
    /// leading columns of `out`.
    #[inline]
    pub(super) fn write_block(
        &self,
        (i, j): (usize, usize),
        product: &[f64],
        out: &mut [f64],
        stride: usize,
        put: impl Fn(&mut f64, f64),
    ) {
        let terms = self.terms;
        let factor = self.mean.force[i * self.pairs + j];
        for (to, p) in out[..terms].iter_mut().zip(product) {
            put(to, factor * p);
        }
        for k in 1..=self.compliances.len() {
            let g = self.get(k, i, j).value;
            let (cos, sin) = product[(2 * k - 1) * terms..].split_at(terms);
            let (first, second) = out[(2 * k - 1) * stride..].split_at_mut(stride);
            let targets = first[..terms].iter_mut().zip(&mut second[..terms]);
            for ((a, b), (c, s)) in targets.zip(cos.iter().zip(sin)) {
                put(a, g.re * c + g.im * s);
                put(b, g.re * s - g.im * c);
            }
        }
    }

    /// `G_k f_k - g_k F_k` of a pair, or of the load's port after the pairs, at harmonic k; F acts at the first.
    pub(super) fn at_place(
        &self,
        (row, k): (usize, usize),
        part: Part,
        (forces, load): (&[f64], f64),
    ) -> Complex64 {
        let load = if k == 1 { load } else { 0.0 };
        let compliance = &self.compliances[k - 1];
        under_forces((compliance, row, k), (forces, self.terms), part)
            - compliance.get(row, compliance.pairs()).part(part) * load
    }

    /// Mean displacement of a port.
    pub(super) fn mean_displacement(&self, x: &[f64], forces: &[f64], port: usize) -> f64 {
        let (n, terms) = (self.pairs, self.terms);
        let row = port * n;
        (0..n)
            .map(|j| {
                self.mean.port_closure[row + j] * x[j * terms]
                    + self.mean.port_force[row + j] * forces[j * terms]
            })
            .sum()
    }

    /// `sum f f^T dG/dxi` of the fundamental over the pairs and the load.
    pub(super) fn inertia(&self, (forces, load): (&[f64], f64)) -> Complex64 {
        let n = self.pairs;
        let force = |j: usize| {
            if j < n { amplitude_of(&forces[j * self.terms..], 1) } else { (-load).into() }
        };
        let mut sum = Complex64::ZERO;
        for i in 0..=n {
            for j in 0..=n {
                sum += self.get(1, i, j).d_anti_damping * force(i) * force(j);
            }
        }
        sum
    }

    /// Largest square of a closure beyond the harmonics kept, up to twice as many, under series of forces up to
    /// there.
    pub(super) fn omitted(
        &self,
        system: &ContactSystem,
        at: (f64, f64),
        springs: &[Complex64],
        series: &[f64],
    ) -> f64 {
        let n = self.pairs;
        let mut compliance = Compliance::zero(n, 0);
        let mut omitted = 0.0_f64;
        for k in self.compliances.len() + 1..=2 * self.compliances.len() {
            let at_harmonic = (k as f64 * at.0, at.1);
            system.linear().compliance(at_harmonic, &[], springs, &mut compliance);
            for i in 0..n {
                let forces = (series, 2 * self.terms - 1);
                let closure = under_forces((&compliance, i, k), forces, Part::Value);
                omitted = omitted.max(closure.norm_sqr());
            }
        }
        omitted
    }

    /// Amplitudes of the ports after the load's, harmonic by harmonic.
    pub(super) fn sensors(
        &self,
        system: &ContactSystem,
        (at, springs): ((f64, f64), &[Complex64]),
        (forces, load): (&[f64], f64),
    ) -> Vec<Vec<Complex64>> {
        let (ports, pairs) = (system.ports(), system.pairs());
        let mut wide = Compliance::zero(pairs, ports.len());
        let mut found = vec![Vec::with_capacity(self.compliances.len()); ports.len() - 1];
        for k in 1..=self.compliances.len() {
            system.linear().compliance((k as f64 * at.0, at.1), ports, springs, &mut wide);
            let load = if k == 1 { load } else { 0.0 };
            for (port, motion) in (pairs + 1..).zip(&mut found) {
                let under = under_forces((&wide, port, k), (forces, self.terms), Part::Value);
                motion.push(wide.get(port, pairs).value * load - under);
            }
        }
        found
    }
}

/// `sum_j G_aj P_j` of one pair or port a at harmonic k, P being series of so many terms.
fn under_forces(
    (compliance, row, k): (&Compliance, usize, usize),
    (forces, terms): (&[f64], usize),
    part: Part,
) -> Complex64 {
    let own = |(j, series)| compliance.get(row, j).part(part) * amplitude_of(series, k);
    forces.chunks_exact(terms).enumerate().map(own).sum()
}
