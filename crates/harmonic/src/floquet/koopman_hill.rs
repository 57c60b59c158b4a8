//! The monodromy matrix projected from Hill's matrix.

use std::f64::consts::TAU;

use faer::Mat;
use num_complex::Complex64;

use super::variational_equation::VariationalEquation;
use crate::balance::Balance;

/// Norm of Hill's matrix over one part of the period: the exponential's series then loses two or
/// three digits at most.
const PART_NORM: f64 = 5.0;

/// Parts of the period at most: a fastest mode of ten thousand times the drive's frequency.
const MOST_PARTS: f64 = 1e4;

/// Terms of the exponential at most; 5^n / n! is below 1e-17 before.
const TERMS: usize = 48;

/// Relative size of a term at which the series ends.
const SMALL: f64 = 1e-16;

/// Harmonics of the stiffness smaller than this part of it are left out.
const NEGLIGIBLE: f64 = 1e-11;

/// Hill's matrix by its action.
///
/// With `th = w t`, the disturbance z and its products `y_k = exp(-i k th) z`, |k| <= N, obey
///
/// ```text
/// dy_k/dth = (A_0 - i k) y_k + sum_l A_(k-l) y_l,
/// ```
///
/// a constant matrix H but for the products beyond N. So z a part of a period later is the middle
/// block of `exp(H dth)` on all products of z now. Real z make `y_-k` the conjugate of `y_k`.
#[derive(Debug, Default)]
pub(super) struct KoopmanHill {
    harmonics: usize,
    /// `(1 + K_c R)^-1 K_c`: for each of its n x n places the complex harmonics 2 N down to -2 N.
    stiffness: Vec<Complex64>,
    /// Products k = 0..=N of one disturbance.
    term: Vec<Complex64>,
    next: Vec<Complex64>,
    closures: Vec<Complex64>,
}

impl KoopmanHill {
    pub(super) fn monodromy(
        &mut self,
        variation: &mut VariationalEquation,
        balance: &Balance<'_>,
        angular_frequency: f64,
    ) -> Mat<f64> {
        let w = angular_frequency;
        let largest = self.expand(variation, balance);
        let size = 2 * variation.modes();
        let rate = variation.highest_frequency(largest) / w;
        let norm = self.harmonics as f64 + rate;
        let parts = (TAU * norm / PART_NORM).ceil().clamp(1.0, MOST_PARTS);
        let part = TAU / parts;
        let zero = Complex64::new(0.0, 0.0);
        self.term.resize((self.harmonics + 1) * size, zero);
        self.next.resize((self.harmonics + 1) * size, zero);
        self.closures.resize((2 * self.harmonics + 1) * variation.interfaces(), zero);
        let mut monodromy = Mat::zeros(size, size);
        let mut state = vec![0.0; size];
        for column in 0..size {
            state.fill(0.0);
            state[column] = 1.0;
            for number in 0..parts as usize {
                self.advance(variation, w, rate, part * number as f64, part, &mut state);
            }
            for (row, x) in state.iter().enumerate() {
                monodromy[(row, column)] = *x;
            }
        }
        monodromy
    }

    /// Fourier coefficients of the stiffness, as many as matter; returns an upper estimate of its
    /// size [N/m].
    fn expand(&mut self, variation: &mut VariationalEquation, balance: &Balance<'_>) -> f64 {
        let samples = balance.fourier().samples();
        let n = variation.interfaces();
        let square = n * n;
        // Twice the harmonics of the motion, as far as samples resolve, are the most.
        let most = (2 * balance.fourier().harmonics()).min((samples - 1) / 4);
        let zero = Complex64::new(0.0, 0.0);
        let mut coefficients = vec![zero; (2 * most + 1) * square];
        let mut k = vec![0.0; square];
        let mut largest = 0.0_f64;
        for s in 0..samples {
            variation.stiffness(|i| balance.tangents(i)[s], &mut k);
            largest = largest.max(k.iter().map(|k| k.abs()).sum());
            for (m, coefficient) in coefficients.chunks_exact_mut(square).enumerate() {
                let angle = -TAU * ((m * s) % samples) as f64 / samples as f64;
                let turn = Complex64::from_polar(1.0 / samples as f64, angle);
                for (c, k) in coefficient.iter_mut().zip(&k) {
                    *c += turn * *k;
                }
            }
        }
        let matters = |c: &[Complex64]| c.iter().any(|c| c.norm() > NEGLIGIBLE * largest);
        let last = coefficients.chunks_exact(square).rposition(matters).unwrap_or(0);
        self.harmonics = last.clamp(1, most.max(1));
        let reach = 2 * self.harmonics;
        self.stiffness.clear();
        for place in 0..square {
            let harmonic = |m: usize| coefficients.get(m * square + place).copied().unwrap_or(zero);
            self.stiffness.extend((0..=reach).rev().map(harmonic));
            self.stiffness.extend((1..=reach).map(|m| harmonic(m).conj()));
        }
        largest
    }

    /// Takes a disturbance from `th` over a `part` of the period.
    fn advance(
        &mut self,
        variation: &VariationalEquation,
        w: f64,
        rate: f64,
        th: f64,
        part: f64,
        state: &mut [f64],
    ) {
        let size = state.len();
        for (k, block) in self.term.chunks_exact_mut(size).enumerate() {
            let turn = Complex64::from_polar(1.0, -(k as f64) * th);
            for (y, z) in block.iter_mut().zip(&*state) {
                *y = turn * *z;
            }
        }
        let all = |term: &[Complex64]| term.iter().map(Complex64::norm_sqr).sum::<f64>();
        let start = all(&self.term);
        for count in 1..=TERMS {
            self.apply(variation, w, rate, part / count as f64);
            std::mem::swap(&mut self.term, &mut self.next);
            for (z, y) in state.iter_mut().zip(&self.term) {
                *z += y.re;
            }
            if all(&self.term) <= SMALL * SMALL * start {
                break;
            }
        }
    }

    /// `next = factor H term`.
    fn apply(&mut self, variation: &VariationalEquation, w: f64, rate: f64, factor: f64) {
        let (modes, n, last) = (variation.modes(), variation.interfaces(), self.harmonics);
        let size = 2 * modes;
        self.closures.fill(Complex64::new(0.0, 0.0));
        for (k, block) in self.term.chunks_exact(size).enumerate() {
            for i in 0..n {
                let sum: Complex64 = (0..modes).map(|j| block[j] * variation.closure(j)[i]).sum();
                self.closures[i * (2 * last + 1) + last - k] = sum.conj();
                self.closures[i * (2 * last + 1) + last + k] = sum;
            }
        }
        let scale = rate * w;
        for (k, (block, next)) in
            self.term.chunks_exact(size).zip(self.next.chunks_exact_mut(size)).enumerate()
        {
            let shift = Complex64::new(0.0, -(k as f64));
            for j in 0..modes {
                let (q, v) = (block[j], block[modes + j]);
                let stiffness = variation.frequency(j).powi(2) / (w * scale);
                next[j] = factor * (v * rate + shift * q);
                next[modes + j] =
                    factor * (shift * v - v * (variation.rate(j) / w) - q * stiffness);
            }
            for i in 0..n {
                let mut force = Complex64::new(0.0, 0.0);
                for j in 0..n {
                    // The product of harmonics k - l and l, l = -N..=N.
                    let row = &self.stiffness[(i * n + j) * (4 * last + 1)..][last - k..];
                    let closures = &self.closures[j * (2 * last + 1)..][..=2 * last];
                    force += row.iter().zip(closures).map(|(k, d)| k * d).sum::<Complex64>();
                }
                let force = force * (factor / (w * scale));
                for j in 0..modes {
                    next[modes + j] -= force * variation.closure(j)[i];
                }
            }
        }
    }
}
