//! The monodromy matrix by integration in time.

use faer::Mat;

use super::period::{Period, rounded};
use super::variational_equation::{VariationalEquation, add};
use crate::vector_instructions::vectorised;

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

/// The classical method of fourth order,
///
/// ```text
/// q'' = -(h + Phi^T C(t) Phi) q' - (W^2 + Phi^T K(t) Phi) q + Phi^T B(t) z,
/// ```
///
/// for all initial states at once: rows of displacements, then of velocities over w, then of sliders z,
/// which are constant in a step; a column per state.
#[derive(Debug, Clone, Default)]
pub(super) struct RungeKutta {
    closures: Vec<f64>,
    rates: Vec<f64>,
    forces: Vec<f64>,
    slopes: Vec<f64>,
    trial: Vec<f64>,
    sum: Vec<f64>,
}

/// The forces of the pairs at a time: per closure K, per rate C, and per slider B, matrices by rows. C
/// and B are empty where there are none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coefficients<'a> {
    pub(super) stiffness: &'a [f64],
    pub(super) damping: &'a [f64],
    pub(super) sliders: &'a [f64],
}

/// Share of a step at which each stage is evaluated, and its half steps.
const STAGES: [(f64, usize); 4] = [(0.0, 0), (0.5, 1), (0.5, 1), (1.0, 2)];

/// Share of a step at which the stiffness is sampled.
pub(super) const PLACES: [f64; 2] = [0.0, 0.5];

/// Weight of each stage in sixths.
const WEIGHTS: [f64; 4] = [1.0, 2.0, 2.0, 1.0];

impl RungeKutta {
    /// Steps of a period with the angular frequency `w` whose stiffest contacts bring the fastest mode
    /// to `fastest` \[rad/s\]; none where it is too fast for the most steps.
    pub(super) fn steps(fastest: f64, w: f64, lost: bool) -> Option<usize> {
        let wanted = std::f64::consts::TAU * fastest / (w * RADIANS_PER_STEP);
        let most = MOST_RADIANS_PER_STEP * STEPS.1 as f64;
        if wanted.is_nan() || wanted * RADIANS_PER_STEP > most {
            return None;
        }
        let fewest = if lost { STEPS_WITH_LOSS } else { STEPS.0 };
        Some(rounded(wanted).clamp(fewest, STEPS.1))
    }

    /// The monodromy matrix over a period sampled at [`PLACES`].
    pub(super) fn monodromy(
        &mut self,
        variation: &VariationalEquation,
        period: &Period,
        angular_frequency: f64,
    ) -> Mat<f64> {
        let steps = period.steps();
        let modes = variation.modes.len();
        let rows = if period.is_modal() { modes } else { variation.interfaces() };
        let (size, square) = (2 * modes, rows * rows);
        let step = std::f64::consts::TAU / (angular_frequency * steps as f64);
        let mut states = identity(size);
        for number in 0..steps {
            let at = [0, 1, 2].map(|half_steps| {
                let place = (2 * number + half_steps) % (2 * steps);
                let range = place * square..(place + 1) * square;
                Coefficients {
                    stiffness: &period.stiffness()[range.clone()],
                    damping: period.damping().get(range).unwrap_or(&[]),
                    sliders: &[],
                }
            });
            if period.is_modal() {
                self.step(step, &mut states, |_, half_steps, states, slopes| {
                    modal_slopes(variation, angular_frequency, at[half_steps], states, slopes);
                });
            } else {
                self.advance(variation, (angular_frequency, step), at, &mut states);
            }
        }
        Mat::from_fn(size, size, |row, column| states[row * size + column])
    }

    /// Advances all `states` by a `step` \[s\], under the coefficients at its start, middle and end;
    /// velocities are divided by `scale` \[rad/s\].
    pub(super) fn advance(
        &mut self,
        variation: &VariationalEquation,
        (scale, step): (f64, f64),
        at: [Coefficients<'_>; 3],
        states: &mut [f64],
    ) {
        self.step(step, states, |own, half_steps, states, slopes| {
            own.slopes(variation, scale, at[half_steps], states, slopes);
        });
    }

    /// A step with time derivatives at so many half steps.
    fn step(
        &mut self,
        step: f64,
        states: &mut [f64],
        mut derivatives: impl FnMut(&mut Self, usize, &[f64], &mut [f64]),
    ) {
        for all in [&mut self.slopes, &mut self.trial, &mut self.sum] {
            all.resize(states.len(), 0.0);
        }
        let (mut slopes, mut trial) =
            (std::mem::take(&mut self.slopes), std::mem::take(&mut self.trial));
        self.sum.copy_from_slice(states);
        for ((share, half_steps), weight) in STAGES.into_iter().zip(WEIGHTS) {
            if share > 0.0 {
                for ((t, x), k) in trial.iter_mut().zip(&*states).zip(&slopes) {
                    *t = x + share * step * k;
                }
            } else {
                trial.copy_from_slice(states);
            }
            derivatives(self, half_steps, &trial, &mut slopes);
            for (s, k) in self.sum.iter_mut().zip(&slopes) {
                *s += weight / 6.0 * step * k;
            }
        }
        states.copy_from_slice(&self.sum);
        (self.slopes, self.trial) = (slopes, trial);
    }

    /// Time derivatives of all states under these coefficients.
    fn slopes(
        &mut self,
        variation: &VariationalEquation,
        scale: f64,
        at: Coefficients<'_>,
        states: &[f64],
        slopes: &mut [f64],
    ) {
        let (modes, n) = (variation.modes.len(), variation.interfaces());
        let sliders = at.sliders.len() / n;
        let size = states.len() / (2 * modes + sliders);
        for all in [&mut self.closures, &mut self.rates, &mut self.forces] {
            all.resize(n * size, 0.0);
        }
        let (q, rest) = states.split_at(modes * size);
        let (v, z) = rest.split_at(modes * size);
        slopes[2 * modes * size..].fill(0.0);
        let (q_slopes, v_slopes) = slopes[..2 * modes * size].split_at_mut(modes * size);
        self.closures.fill(0.0);
        self.forces.fill(0.0);
        for (q, mode) in q.chunks_exact(size).zip(&variation.modes) {
            for (closure, phi) in self.closures.chunks_exact_mut(size).zip(&mode.closure) {
                add(closure, *phi, q);
            }
        }
        for (force, k) in self.forces.chunks_exact_mut(size).zip(at.stiffness.chunks_exact(n)) {
            for (closure, k) in self.closures.chunks_exact(size).zip(k) {
                add(force, k / scale, closure);
            }
        }
        if !at.damping.is_empty() {
            self.rates.fill(0.0);
            for (v, mode) in v.chunks_exact(size).zip(&variation.modes) {
                for (rate, phi) in self.rates.chunks_exact_mut(size).zip(&mode.closure) {
                    add(rate, *phi, v);
                }
            }
            for (force, c) in self.forces.chunks_exact_mut(size).zip(at.damping.chunks_exact(n)) {
                for (rate, c) in self.rates.chunks_exact(size).zip(c) {
                    add(force, *c, rate);
                }
            }
        }
        if sliders > 0 {
            let rows = at.sliders.chunks_exact(sliders);
            for (force, b) in self.forces.chunks_exact_mut(size).zip(rows) {
                for (slider, b) in z.chunks_exact(size).zip(b) {
                    add(force, -b / scale, slider);
                }
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
        for damper in &variation.dampers {
            let rate = &mut self.forces[..size];
            rate.fill(0.0);
            for (v, share) in v.chunks_exact(size).zip(&damper.shape) {
                add(rate, *share, v);
            }
            for (v_slope, share) in v_slopes.chunks_exact_mut(size).zip(&damper.shape) {
                add(v_slope, -damper.excess * share, rate);
            }
        }
    }
}

/// Time derivatives of all states under coefficients in the coordinates of the modes.
fn modal_slopes(
    variation: &VariationalEquation,
    scale: f64,
    at: Coefficients<'_>,
    states: &[f64],
    slopes: &mut [f64],
) {
    let modes = variation.modes.len();
    let size = states.len() / (2 * modes);
    let (q, v) = states.split_at(modes * size);
    let (q_slopes, v_slopes) = slopes.split_at_mut(modes * size);
    vectorised(
        #[inline(always)]
        || {
            q_slopes.iter_mut().zip(v).for_each(|(dq, v)| *dq = scale * v);
            let rows = v_slopes.chunks_exact_mut(size).zip(&variation.modes).enumerate();
            for (a, (slope, mode)) in rows {
                slope.fill(0.0);
                add(slope, -mode.damping_rate, &v[a * size..][..size]);
                add(slope, -mode.angular_frequency.powi(2) / scale, &q[a * size..][..size]);
                let stiffness = &at.stiffness[a * modes..][..modes];
                for (k, q) in stiffness.iter().zip(q.chunks_exact(size)) {
                    add(slope, -k / scale, q);
                }
                if !at.damping.is_empty() {
                    let damping = &at.damping[a * modes..][..modes];
                    for (c, v) in damping.iter().zip(v.chunks_exact(size)) {
                        add(slope, -c, v);
                    }
                }
            }
            for damper in &variation.dampers {
                for (a, slope) in v_slopes.chunks_exact_mut(size).enumerate() {
                    for (share, v) in damper.shape.iter().zip(v.chunks_exact(size)) {
                        add(slope, -damper.excess * damper.shape[a] * share, v);
                    }
                }
            }
        },
    );
}

/// The states that the columns of a monodromy matrix start from, by rows.
pub(super) fn identity(size: usize) -> Vec<f64> {
    let mut states = vec![0.0; size * size];
    for i in 0..size {
        states[i * size + i] = 1.0;
    }
    states
}
