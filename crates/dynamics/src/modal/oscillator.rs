//! The exact step of one oscillator under a polynomial force.
//!
//! The response of `q'' + c q' + w^2 q = F(t)` to a unit impulse is
//!
//! ```text
//! G(t) = exp(-c t / 2) t S(z),   z = (w^2 - c^2 / 4) t^2,   S(z) = sin(sqrt z) / sqrt z
//! ```
//!
//! (`sinh` for negative z), and over a step `h` with `F = sum_k F_k s^k`, `s = t / h`,
//! nothing is approximated but F. Eliminating the velocity between two steps leaves, with
//! the step's increment `d = q - q_before`,
//!
//! ```text
//! d+ = e d - k q + sum_k (Q_k F_k + R_k F_k_before),   e = exp(-c h),
//! Q_k = h integral of G(h (1 - s)) s^k ds,   R_k = h integral of e^(-c h (1 - s)) G(h s) s^k ds
//! ```
//!
//! two states and no loss of digits for rigid motions, whose `k` is exactly zero.
//!
//! The damped flexibility of modes left out has no inertia, `c q' + w^2 q = F(t)`. Its response to a
//! unit impulse is `G(t) = exp(-w^2 t / c) / c`, and the recurrence has `e = R_k = 0`.

use std::sync::LazyLock;

/// Forces at the ends of steps that an interpolation may use.
pub(super) const NODES: usize = 5;

/// Coefficients of the polynomials that a force may be within a step: a quintic's.
pub(super) const MOMENTS: usize = 6;

/// Interpolation of a contact force within a step from its values at the ends of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ForceInterpolation {
    /// The mean of both ends: second order, and stable however stiff the contact is against the
    /// oscillator's inertia, because a rigid motion is then stepped by the trapezoidal rule.
    Average,
    /// The quartic through both ends and the three ends before: fifth order. An oscillation of up
    /// to one radian a step, its contact stiffness included, is damped by it, not excited.
    Quartic,
    /// The line through both ends, for motions without inertia: second order, and stable for any
    /// contact stiffness, because a new force moves them in its own direction only.
    Linear,
}

impl ForceInterpolation {
    /// All interpolations, each at the place of its number.
    pub(super) const ALL: [Self; 3] = [Self::Average, Self::Quartic, Self::Linear];

    /// Coefficient of `s^k` (row) per force at the new end, the old end, and the ends before
    /// (column): Lagrange's polynomials of the nodes 1, 0, -1, -2, -3.
    pub(super) fn weights(self) -> [[f64; NODES]; NODES] {
        const NONE: [f64; NODES] = [0.0; NODES];
        let [old, rise] = [[0.0, 24.0, 0.0, 0.0, 0.0], [24.0, -24.0, 0.0, 0.0, 0.0]];
        let weights = match self {
            Self::Average => [[12.0, 12.0, 0.0, 0.0, 0.0], NONE, NONE, NONE, NONE],
            Self::Linear => [old, rise, NONE, NONE, NONE],
            Self::Quartic => [
                old,
                [6.0, 20.0, -36.0, 12.0, -2.0],
                [11.0, -20.0, 6.0, 4.0, -1.0],
                [6.0, -20.0, 24.0, -12.0, 2.0],
                [1.0, -4.0, 6.0, -4.0, 1.0],
            ],
        };
        weights.map(|row| row.map(|weight| weight / 24.0))
    }
}

/// An oscillator by its two numbers, with or without its mass of one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dynamics {
    /// Angular frequency w \[rad/s\].
    pub(super) angular_frequency: f64,
    /// Damping rate c \[1/s\].
    pub(super) rate: f64,
    /// True for `c q' + w^2 q = F`.
    pub(super) massless: bool,
}

/// The two-state recurrence of one oscillator for one step length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Recurrence {
    /// `e`, of the last increment.
    pub(super) decay: f64,
    /// `k`, of the displacement.
    pub(super) spring: f64,
    /// Of the contact force at the new end, the old end, and those before.
    pub(super) contact: [f64; NODES + 1],
    /// Of the load's mean and rise in this step, and in the step before.
    pub(super) load: [f64; 4],
}

/// Displacement and velocity after part of a step: `z+ = A z + sum_k B_k F_k`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Propagator {
    /// Of displacement and velocity, in the new displacement.
    pub(super) displacement: [f64; 2],
    /// Of displacement and velocity, in the new velocity.
    pub(super) velocity: [f64; 2],
    /// Of `F_k`, in the new displacement and velocity.
    pub(super) moments: [[f64; 2]; MOMENTS],
}

impl Dynamics {
    fn impulse(self, t: f64) -> f64 {
        if self.massless {
            return (-self.relaxation() * t).exp() / self.rate;
        }
        (-0.5 * self.rate * t).exp() * t * sine_ratio(self.z(t))
    }

    /// Rate `w^2 / c` \[1/s\] at which a massless motion decays.
    fn relaxation(self) -> f64 {
        self.angular_frequency * (self.angular_frequency / self.rate)
    }

    /// The response to a unit impulse, and its rate.
    fn impulse_and_rate(self, t: f64) -> [f64; 2] {
        let (z, decay) = (self.z(t), (-0.5 * self.rate * t).exp());
        let [ratio, cosine] = sine_ratio_and_cosine(z);
        [decay * t * ratio, decay * (cosine - 0.5 * self.rate * t * ratio)]
    }

    fn z(self, t: f64) -> f64 {
        let w = self.angular_frequency;
        (w * w - 0.25 * self.rate * self.rate) * t * t
    }

    /// `h integral of kernel(s) s^k ds` over the step of each of some kernels, k from 0.
    fn moments<const N: usize>(
        self,
        h: f64,
        kernels: impl Fn(f64) -> [f64; N],
    ) -> [[f64; N]; MOMENTS] {
        // Sixteen points integrate to round-off over an argument of six and more.
        let extent =
            if self.massless { self.relaxation() } else { self.angular_frequency + self.rate } * h;
        let panels = (extent / 6.0).ceil().clamp(1.0, 1e4) as usize;
        let width = 1.0 / panels as f64;
        let mut sums = [[0.0; N]; MOMENTS];
        for panel in 0..panels {
            for &(node, weight) in GAUSS.iter() {
                let s = (panel as f64 + node) * width;
                let mut values = kernels(s).map(|value| h * width * weight * value);
                for sums in &mut sums {
                    for (sum, value) in sums.iter_mut().zip(&mut values) {
                        *sum += *value;
                        *value *= s;
                    }
                }
            }
        }
        sums
    }

    pub(super) fn recurrence(self, h: f64, interpolation: ForceInterpolation) -> Recurrence {
        let Self { angular_frequency: w, rate: c, massless } = self;
        let now = self.moments(h, |s| [self.impulse(h * (1.0 - s))]).map(|[now]| now);
        let before = if massless {
            [0.0; MOMENTS]
        } else {
            let kernel = |s: f64| [(-c * h * (1.0 - s)).exp() * self.impulse(h * s)];
            self.moments(h, kernel).map(|[before]| before)
        };
        let weights = interpolation.weights();
        let mut contact = [0.0; NODES + 1];
        for (k, row) in weights.iter().enumerate() {
            for (end, weight) in row.iter().enumerate() {
                contact[end] += now[k] * weight;
                contact[end + 1] += before[k] * weight;
            }
        }
        // The load is its mean plus its rise times (s - 1/2).
        let load = [now[0], now[1] - 0.5 * now[0], before[0], before[1] - 0.5 * before[0]];
        if massless {
            return Recurrence {
                decay: 0.0,
                spring: -(-self.relaxation() * h).exp_m1(),
                contact,
                load,
            };
        }
        // 1 + e - trace(A), written so that a rigid motion has exactly zero.
        let (z, y) = (self.z(h), 0.25 * (c * h).powi(2));
        let (half, rigid) = (sine_ratio(0.25 * z).powi(2), sine_ratio(-0.25 * y).powi(2));
        let root = (-0.5 * c * h).exp();
        Recurrence {
            decay: (-c * h).exp(),
            spring: root * ((w * h).powi(2) * half + y * (rigid - half)),
            contact,
            load,
        }
    }

    /// Displacement and velocity after the time `t`; of a massless motion the velocity stays zero.
    pub(super) fn propagator(self, t: f64) -> Propagator {
        let w = self.angular_frequency;
        if self.massless {
            return Propagator {
                displacement: [(-self.relaxation() * t).exp(), 0.0],
                velocity: [0.0; 2],
                moments: self.moments(t, |s| [self.impulse(t * (1.0 - s)), 0.0]),
            };
        }
        let [g, g_rate] = self.impulse_and_rate(t);
        Propagator {
            displacement: [g_rate + self.rate * g, g],
            velocity: [-w * w * g, g_rate],
            moments: self.moments(t, |s| self.impulse_and_rate(t * (1.0 - s))),
        }
    }
}

/// `sin(sqrt z) / sqrt z`, for negative z `sinh(sqrt -z) / sqrt -z`.
fn sine_ratio(z: f64) -> f64 {
    if z.abs() < 1e-3 {
        1.0 - z / 6.0 * (1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0)))
    } else if z > 0.0 {
        z.sqrt().sin() / z.sqrt()
    } else {
        (-z).sqrt().sinh() / (-z).sqrt()
    }
}

/// The same, and `cos(sqrt z)`, for negative z `cosh(sqrt -z)`.
fn sine_ratio_and_cosine(z: f64) -> [f64; 2] {
    let root = z.abs().sqrt();
    let [sine, cosine] = if z >= 0.0 { root.sin_cos().into() } else { [root.sinh(), root.cosh()] };
    [if root < 0.03 { sine_ratio(z) } else { sine / root }, cosine]
}

/// Nodes and weights of the sixteen-point Gauss rule on 0 to 1.
static GAUSS: LazyLock<[(f64, f64); 16]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let n = 16.0;
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut last, mut value) = (1.0, x);
            for k in 2..=16 {
                let k = f64::from(k);
                (last, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * last) / k);
            }
            slope = n * (x * value - last) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
});

#[cfg(test)]
mod tests {
    use super::*;

    const CASES: [(f64, f64); 6] =
        [(0.0, 0.0), (0.0, 352.0), (5.5e3, 0.0), (7.0e4, 352.0), (1e3, 2e3), (10.0, 5e3)];

    #[test]
    fn each_interpolation_is_at_the_place_of_its_number() {
        for (place, interpolation) in ForceInterpolation::ALL.into_iter().enumerate() {
            assert_eq!(interpolation as usize, place);
        }
    }

    /// Against the propagator applied twice: the recurrence is the same motion without velocity.
    #[test]
    fn the_recurrence_is_the_propagator_without_velocity() {
        let h = 2e-5;
        for (angular_frequency, rate) in CASES {
            let oscillator = Dynamics { angular_frequency, rate, massless: false };
            let whole = oscillator.propagator(h);
            for interpolation in [ForceInterpolation::Average, ForceInterpolation::Quartic] {
                let recurrence = oscillator.recurrence(h, interpolation);
                // Contact forces from the oldest to the newest, from q = 0.3, v = -40.
                let forces = [0.7, -4.0, 3.0, 1.0, -2.0, 5.0];
                let step = |[q, v]: [f64; 2], newest: usize| {
                    let mut z = [
                        whole.displacement[0] * q + whole.displacement[1] * v,
                        whole.velocity[0] * q + whole.velocity[1] * v,
                    ];
                    for (k, row) in interpolation.weights().iter().enumerate() {
                        let f: f64 = (0..NODES).map(|age| row[age] * forces[newest - age]).sum();
                        z[0] += whole.moments[k][0] * f;
                        z[1] += whole.moments[k][1] * f;
                    }
                    z
                };
                let start = [0.3, -40.0];
                let middle = step(start, NODES - 1);
                let end = step(middle, NODES);
                let increment = middle[0] - start[0];
                let mut next = recurrence.decay * increment - recurrence.spring * middle[0];
                for (age, tap) in recurrence.contact.iter().enumerate() {
                    next += tap * forces[NODES - age];
                }
                let found = middle[0] + next;
                assert!(
                    (found - end[0]).abs() < 1e-15,
                    "{angular_frequency} {rate} {interpolation:?}"
                );
            }
        }
    }

    /// Against closed forms: a rigid body under a constant force, and a resonator's free decay.
    #[test]
    fn limits_have_their_closed_forms() {
        let h = 1e-5;
        let free = Dynamics { angular_frequency: 0.0, rate: 0.0, massless: false };
        let recurrence = free.recurrence(h, ForceInterpolation::Average);
        assert_eq!((recurrence.decay, recurrence.spring), (1.0, 0.0));
        assert!((recurrence.contact.iter().sum::<f64>() / (h * h) - 1.0).abs() < 1e-14);
        assert_eq!(
            Dynamics { rate: 352.0, ..free }.recurrence(h, ForceInterpolation::Quartic).spring,
            0.0
        );

        let (w, c, t) = (7e4, 352.0, 1.3e-4);
        let propagator = Dynamics { angular_frequency: w, rate: c, massless: false }.propagator(t);
        let damped = (w * w - 0.25 * c * c).sqrt();
        let decay = (-0.5 * c * t).exp();
        let expected = decay * ((damped * t).cos() + 0.5 * c / damped * (damped * t).sin());
        assert!((propagator.displacement[0] - expected).abs() < 1e-13);
        // A constant force moves it towards F / w^2.
        let still = (1.0 - expected) / (w * w);
        assert!((propagator.moments[0][0] / still - 1.0).abs() < 1e-11);
    }

    /// Without inertia: a force that grows in proportion to time is followed at the lag `c / w^2`, and
    /// a fast relaxation is the flexibility itself.
    #[test]
    fn a_massless_motion_relaxes_in_closed_form() {
        let h = 5e-6;
        for time in [1e-4, 3e-6, 1e-7, 1e-9_f64] {
            let w = 1e6_f64;
            let motion = Dynamics { angular_frequency: w, rate: time * w * w, massless: true };
            let step = motion.recurrence(h, ForceInterpolation::Linear);
            let (mut q, mut n) = (0.0, 0);
            for _ in 0..40 {
                let forces = [f64::from(n + 1) * h, f64::from(n) * h];
                q += step.contact[0] * forces[0] + step.contact[1] * forces[1] - step.spring * q;
                n += 1;
            }
            let t = f64::from(n) * h;
            let expected = (t - time * (1.0 - (-t / time).exp())) / (w * w);
            // Rounding of the place within the step, over the time of relaxation.
            let rounding = 2e-15 * (50.0 + h / time);
            assert!(
                (q * w * w / t - expected * w * w / t).abs() < rounding,
                "{time}: {q} {expected}"
            );
            assert_eq!((step.decay, step.contact[2]), (0.0, 0.0));
            // The load, a mean and a rise, is the same line.
            let loaded = step.load[0] * 0.5 * h + step.load[1] * h;
            assert!((loaded / (step.contact[0] * h) - 1.0).abs() < 1e-12);
            let whole = motion.propagator(h);
            assert!((whole.displacement[0] - (-h / time).exp()).abs() < 1e-15);
        }
    }
}
