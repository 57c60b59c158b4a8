//! The monodromy matrix by integration in time.

use faer::Mat;

use super::variational_equation::VariationalEquation;
use crate::balance::Balance;
use crate::fourier::Fourier;

/// Radians of the fastest mode per step. The method's own damping of that mode is below 1e-3 over
/// a period, and falls with the sixth power of the frequency.
const RADIANS_PER_STEP: f64 = 0.2;

/// Steps per period, at least and at most.
const STEPS: (usize, usize) = (512, 1 << 14);

/// Radians of the fastest mode per step at most: the method is stable up to 2.8.
const MOST_RADIANS_PER_STEP: f64 = 2.0;

/// Steps at least where contact is lost: the stiffness leaves zero with a vertical tangent there,
/// and the order falls to about 1.5.
const STEPS_WITH_LOSS: usize = 1024;

/// The classical method of fourth order, `q'' = -h q' - (W^2 + Phi^T K(t) Phi) q`, for all
/// initial states at once: rows of displacements, then of velocities over w, a column per state.
#[derive(Debug, Default)]
pub(super) struct RungeKutta {
    fourier: Option<Fourier>,
    /// `(1 + K_c R)^-1 K_c` at twice as many places as steps.
    stiffness: Vec<f64>,
    closures: Vec<f64>,
    forces: Vec<f64>,
}

/// Share of a step at which each stage is evaluated, and its half steps.
const STAGES: [(f64, usize); 4] = [(0.0, 0), (0.5, 1), (0.5, 1), (1.0, 2)];

/// Weight of each stage in sixths.
const WEIGHTS: [f64; 4] = [1.0, 2.0, 2.0, 1.0];

impl RungeKutta {
    /// The monodromy matrix; none where a mode is too fast for the most steps.
    pub(super) fn monodromy(
        &mut self,
        variation: &mut VariationalEquation,
        balance: &Balance<'_>,
        closures: &[f64],
        angular_frequency: f64,
    ) -> Option<Mat<f64>> {
        let steps = steps(variation, balance, angular_frequency)?;
        self.sample(variation, balance, closures, steps);
        let (size, square) = (2 * variation.modes.len(), variation.interfaces().pow(2));
        self.closures.resize(variation.interfaces() * size, 0.0);
        self.forces.resize(variation.interfaces() * size, 0.0);
        let step = std::f64::consts::TAU / (angular_frequency * steps as f64);
        let mut states = vec![0.0; size * size];
        for i in 0..size {
            states[i * size + i] = 1.0;
        }
        let (mut slopes, mut trial) = (vec![0.0; size * size], states.clone());
        let mut sum = states.clone();
        for number in 0..steps {
            for ((share, half_steps), weight) in STAGES.into_iter().zip(WEIGHTS) {
                if share > 0.0 {
                    for ((t, x), k) in trial.iter_mut().zip(&states).zip(&slopes) {
                        *t = x + share * step * k;
                    }
                } else {
                    trial.copy_from_slice(&states);
                }
                let place = (2 * number + half_steps) % (2 * steps);
                let k = place * square..(place + 1) * square;
                self.slopes(variation, angular_frequency, k, &trial, &mut slopes);
                for (s, k) in sum.iter_mut().zip(&slopes) {
                    *s += weight / 6.0 * step * k;
                }
            }
            states.copy_from_slice(&sum);
        }
        Some(Mat::from_fn(size, size, |row, column| states[row * size + column]))
    }

    /// Time derivatives of all states, with the stiffness stored at `place`.
    fn slopes(
        &mut self,
        variation: &VariationalEquation,
        scale: f64,
        place: std::ops::Range<usize>,
        states: &[f64],
        slopes: &mut [f64],
    ) {
        let (modes, size) = (variation.modes.len(), 2 * variation.modes.len());
        let k = &self.stiffness[place];
        let n = self.closures.len() / size;
        let (q, v) = states.split_at(modes * size);
        let (q_slopes, v_slopes) = slopes.split_at_mut(modes * size);
        self.closures.fill(0.0);
        self.forces.fill(0.0);
        for (q, mode) in q.chunks_exact(size).zip(&variation.modes) {
            for (closure, phi) in self.closures.chunks_exact_mut(size).zip(&mode.closure) {
                add(closure, *phi, q);
            }
        }
        for (force, k) in self.forces.chunks_exact_mut(size).zip(k.chunks_exact(n)) {
            for (closure, k) in self.closures.chunks_exact(size).zip(k) {
                add(force, k / scale, closure);
            }
        }
        let slopes = q_slopes.chunks_exact_mut(size).zip(v_slopes.chunks_exact_mut(size));
        for (j, ((q_slope, v_slope), mode)) in slopes.zip(&variation.modes).enumerate() {
            let (q, v) = (&q[j * size..][..size], &v[j * size..][..size]);
            let (rate, square) = (mode.damping_rate, mode.angular_frequency.powi(2) / scale);
            for ((dq, dv), (q, v)) in q_slope.iter_mut().zip(&mut *v_slope).zip(q.iter().zip(v)) {
                *dq = scale * v;
                *dv = -rate * v - square * q;
            }
            for (force, phi) in self.forces.chunks_exact(size).zip(&mode.closure) {
                add(v_slope, -phi, force);
            }
        }
    }

    /// The stiffness at every half step.
    fn sample(
        &mut self,
        variation: &mut VariationalEquation,
        balance: &Balance<'_>,
        closures: &[f64],
        steps: usize,
    ) {
        let (harmonics, places) = (balance.fourier().harmonics(), 2 * steps);
        let kept = self.fourier.take();
        let kept = kept.filter(|kept| kept.harmonics() == harmonics && kept.samples() == places);
        let fourier = kept.unwrap_or_else(|| Fourier::to_samples(harmonics, places));
        let n = variation.interfaces();
        let terms = fourier.terms();
        let (mut samples, mut forces) = (vec![0.0; places], vec![0.0; places]);
        let mut tangents = vec![0.0; n * places];
        for i in 0..n {
            fourier.synthesise(&closures[i * terms..(i + 1) * terms], &mut samples);
            let tangents = &mut tangents[i * places..(i + 1) * places];
            balance.system().forces(i, &samples, &mut forces, tangents);
        }
        self.stiffness.resize(n * n * places, 0.0);
        for (place, k) in self.stiffness.chunks_exact_mut(n * n).enumerate() {
            variation.stiffness(|i| tangents[i * places + place], k);
        }
        self.fourier = Some(fourier);
    }
}

fn steps(variation: &VariationalEquation, balance: &Balance<'_>, w: f64) -> Option<usize> {
    let stiffest = (0..variation.interfaces())
        .flat_map(|i| balance.tangents(i))
        .fold(0.0_f64, |largest, &k| largest.max(k));
    let lost = (0..variation.interfaces()).any(|i| balance.tangents(i).contains(&0.0));
    let fewest = if lost { STEPS_WITH_LOSS } else { STEPS.0 };
    let wanted =
        std::f64::consts::TAU * variation.highest_frequency(stiffest) / (w * RADIANS_PER_STEP);
    if wanted * RADIANS_PER_STEP > MOST_RADIANS_PER_STEP * STEPS.1 as f64 || wanted.is_nan() {
        return None;
    }
    // Steps in eighths of a power of two, so that the tables serve many points of a branch.
    let grain = ((wanted / 8.0) as usize).next_power_of_two().clamp(1, STEPS.1 / 8);
    Some((wanted as usize).next_multiple_of(grain).clamp(fewest, STEPS.1))
}

fn add(to: &mut [f64], factor: f64, what: &[f64]) {
    for (t, w) in to.iter_mut().zip(what) {
        *t += factor * w;
    }
}
