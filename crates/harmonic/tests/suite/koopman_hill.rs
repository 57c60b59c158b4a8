//! Floquet multipliers by a second method, the Koopman-Hill projection of Hill's matrix.

use std::f64::consts::TAU;

use asperity_harmonic::{ContactSystem, PeriodicResponse};
use asperity_mesh::{ComponentModes, NormalMode, PortPair};
use faer::Mat;
use faer::linalg::solvers::Solve;
use num_complex::Complex64;

/// Samples of a period.
const SAMPLES: usize = 128;

/// Norm of Hill's matrix over one part of the period: the exponential's series then loses two or
/// three digits at most.
const PART_NORM: f64 = 5.0;

/// Terms of the exponential at most; 5^n / n! is below 1e-17 before.
const TERMS: usize = 48;

/// Relative size of a term at which the series ends.
const SMALL: f64 = 1e-16;

/// Harmonics of the stiffness smaller than this part of it are left out.
const NEGLIGIBLE: f64 = 1e-11;

/// The multipliers of `response` in the lowest `modes` of the structure, largest first.
pub(crate) fn multipliers(
    system: &ContactSystem,
    response: &PeriodicResponse,
    modes: usize,
) -> Vec<Complex64> {
    let monodromy = Hill::new(system, response, modes).monodromy();
    let mut multipliers = monodromy.eigenvalues().unwrap();
    multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    multipliers
}

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
/// Converges exponentially with the harmonics of a smooth stiffness.
///
/// Source: F. Bayer, R. Leine, Nonlinear Dyn. 2023, 111, 8439, doi 10.1007/s11071-023-08247-7.
struct Hill {
    modes: Vec<NormalMode>,
    contacts: Vec<PortPair>,
    mass_damping: f64,
    w: f64,
    /// Velocities are divided by this times w.
    scale: f64,
    harmonics: usize,
    /// `(1 + K_c R)^-1 K_c`: for each of its n x n places the complex harmonics 2 N down to -2 N.
    stiffness: Vec<Complex64>,
    /// Products k = 0..=N of one disturbance.
    term: Vec<Complex64>,
    next: Vec<Complex64>,
    closures: Vec<Complex64>,
}

impl Hill {
    fn new(system: &ContactSystem, response: &PeriodicResponse, count: usize) -> Self {
        let modes = system.linear().lowest_modes(count).unwrap();
        let contacts = modes.contacts();
        let n = contacts.len();
        // Twice the harmonics of the motion, as far as samples resolve, are the most.
        let most = (2 * response.harmonics()).min((SAMPLES - 1) / 4);
        let zero = Complex64::new(0.0, 0.0);
        let mut coefficients = vec![vec![zero; n * n]; 2 * most + 1];
        let mut largest = 0.0_f64;
        for s in 0..SAMPLES {
            let k = stiffness(system, response, &modes, TAU * s as f64 / SAMPLES as f64);
            largest = largest.max(k.iter().map(|k| k.abs()).sum());
            for (m, coefficient) in coefficients.iter_mut().enumerate() {
                let angle = -TAU * ((m * s) % SAMPLES) as f64 / SAMPLES as f64;
                let turn = Complex64::from_polar(1.0 / SAMPLES as f64, angle);
                for (c, k) in coefficient.iter_mut().zip(&k) {
                    *c += turn * *k;
                }
            }
        }
        let matters = |c: &Vec<Complex64>| c.iter().any(|c| c.norm() > NEGLIGIBLE * largest);
        let harmonics = coefficients.iter().rposition(matters).unwrap_or(0).clamp(1, most.max(1));
        let reach = 2 * harmonics;
        let mut stiffness = Vec::new();
        for place in 0..n * n {
            let harmonic = |m: usize| coefficients.get(m).map_or(zero, |all| all[place]);
            stiffness.extend((0..=reach).rev().map(harmonic));
            stiffness.extend((1..=reach).map(|m| harmonic(m).conj()));
        }
        let square = |mode: &NormalMode| {
            let shape: f64 = contacts.iter().map(|&pair| mode.closure(pair).powi(2)).sum();
            mode.angular_frequency.powi(2) + largest * shape
        };
        let w = response.angular_frequency;
        let size = 2 * modes.modes().len();
        Self {
            mass_damping: system.linear().mass_damping(),
            w,
            scale: modes.modes().iter().map(square).fold(0.0, f64::max).sqrt() / w,
            harmonics,
            stiffness,
            term: vec![zero; (harmonics + 1) * size],
            next: vec![zero; (harmonics + 1) * size],
            closures: vec![zero; (2 * harmonics + 1) * n],
            modes: modes.modes().to_vec(),
            contacts: contacts.to_vec(),
        }
    }

    fn monodromy(&mut self) -> Mat<f64> {
        let size = 2 * self.modes.len();
        let parts = (TAU * (self.harmonics as f64 + self.scale) / PART_NORM).ceil().max(1.0);
        let mut monodromy = Mat::zeros(size, size);
        for column in 0..size {
            let mut state = vec![0.0; size];
            state[column] = 1.0;
            for number in 0..parts as usize {
                self.advance(TAU * number as f64 / parts, TAU / parts, &mut state);
            }
            for (row, x) in state.iter().enumerate() {
                monodromy[(row, column)] = *x;
            }
        }
        monodromy
    }

    /// Takes a disturbance from `th` over a `part` of the period.
    fn advance(&mut self, th: f64, part: f64, state: &mut [f64]) {
        for (k, block) in self.term.chunks_exact_mut(state.len()).enumerate() {
            let turn = Complex64::from_polar(1.0, -(k as f64) * th);
            for (y, z) in block.iter_mut().zip(&*state) {
                *y = turn * *z;
            }
        }
        let all = |term: &[Complex64]| term.iter().map(Complex64::norm_sqr).sum::<f64>();
        let start = all(&self.term);
        for count in 1..=TERMS {
            self.apply(part / count as f64);
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
    fn apply(&mut self, factor: f64) {
        let (modes, last) = (self.modes.len(), self.harmonics);
        let (size, w, scale) = (2 * modes, self.w, self.scale * self.w);
        let n = self.closures.len() / (2 * last + 1);
        for (k, block) in self.term.chunks_exact(size).enumerate() {
            for i in 0..n {
                let sum: Complex64 = self
                    .modes
                    .iter()
                    .zip(block)
                    .map(|(mode, y)| y * mode.closure(self.contacts[i]))
                    .sum();
                self.closures[i * (2 * last + 1) + last - k] = sum.conj();
                self.closures[i * (2 * last + 1) + last + k] = sum;
            }
        }
        let blocks = self.term.chunks_exact(size).zip(self.next.chunks_exact_mut(size));
        for (k, (block, next)) in blocks.enumerate() {
            let shift = Complex64::new(0.0, -(k as f64));
            for (j, mode) in self.modes.iter().enumerate() {
                let (q, v) = (block[j], block[modes + j]);
                let rate = mode.total_damping(self.mass_damping);
                let stiffness = mode.angular_frequency.powi(2) / (w * scale);
                next[j] = factor * (v * self.scale + shift * q);
                next[modes + j] = factor * (shift * v - v * (rate / w) - q * stiffness);
            }
            for i in 0..n {
                let mut force = Complex64::new(0.0, 0.0);
                for j in 0..n {
                    // The product of harmonics k - l and l, l = -N..=N.
                    let row = &self.stiffness[(i * n + j) * (4 * last + 1)..][last - k..];
                    let closures = &self.closures[j * (2 * last + 1)..][..=2 * last];
                    force += row.iter().zip(closures).map(|(k, d)| k * d).sum::<Complex64>();
                }
                for (j, mode) in self.modes.iter().enumerate() {
                    next[modes + j] -=
                        force * (factor / (w * scale) * mode.closure(self.contacts[i]));
                }
            }
        }
    }
}

/// `(1 + K_c R)^-1 K_c` \[N/m\] by rows at a phase of the motion, with the contact tangents `K_c` and
/// the residual flexibility R.
fn stiffness(
    system: &ContactSystem,
    response: &PeriodicResponse,
    modes: &ComponentModes,
    phase: f64,
) -> Vec<f64> {
    let contacts = system.contacts().iter().enumerate();
    let tangents: Vec<f64> = contacts
        .map(|(i, contact)| {
            let [closure, ..] = response.closure_at(i, phase);
            let found = contact.law().pressure_increment(contact.pressure(), closure);
            contact.area() * found.tangent
        })
        .collect();
    let n = tangents.len();
    let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let flexibility =
        |i: usize, j: usize| modes.residual().closure(modes.contacts()[i], modes.contacts()[j]);
    let matrix = Mat::from_fn(n, n, |i, j| unit(i, j) + tangents[i] * flexibility(i, j));
    let right = Mat::from_fn(n, n, |i, j| unit(i, j) * tangents[i]);
    let found = matrix.partial_piv_lu().solve(&right);
    (0..n * n).map(|place| found[(place / n, place % n)]).collect()
}
