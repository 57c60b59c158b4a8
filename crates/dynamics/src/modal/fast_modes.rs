//! The error by modes that a step cannot show, and that count as flexibility.
//!
//! Left out of the equation of mode n, `q'' + w^2 q = f`, is the motion `q - f / w^2`. It is at rest
//! before the force begins, and follows `-f'' / w^2`. With forces `f_k` at times `1 / w` apart it is
//! bounded, up to factors near one, by
//!
//! ```text
//! |q - f / w^2| <= (1 / w^2) min(sum |second differences of f_k|, sum |third differences of f_k|),
//! ```
//!
//! the first sum for a force whose slope jumps, the second for a smooth one. A contact force moves
//! with the natural frequency `w_1` of the structure: of it `(w_1 / w)^2` is left out.

use std::f64::consts::TAU;

use super::row_modes::RowMode;
use super::step_model::FAST;
use super::transient_case::{CaseResponse, TransientCase};
use crate::ContactExtremes;
use asperity_structure::LoadCase;

/// Samples of a force at most.
const MOST_SAMPLES: f64 = 1e6;

impl TransientCase {
    /// Estimated error of the pressures by the modes that a step \[s\] does not show, over the range
    /// of the pressures at the contact with the largest error; `response` gives these ranges.
    ///
    /// The estimate is one from above: it adds up modes and forces whatever their signs.
    pub fn error_of_fast_modes(&self, step: f64, response: &CaseResponse) -> f64 {
        let modes = &self.model.row_modes().modes;
        let shown = |mode: &&RowMode| mode.massless || mode.angular_frequency * step <= FAST;
        let fast = || modes.iter().filter(|mode| !shown(mode));
        let Some(slowest) = fast().map(|mode| mode.angular_frequency).reduce(f64::min) else {
            return 0.0;
        };
        let changes = changes(&self.load, self.duration, slowest);
        let natural = TAU * self.model.preloaded().natural_frequency().unwrap_or(0.0);
        let range = |seen: &ContactExtremes| seen.pressure_max - seen.pressure_min;
        let contacts = || self.model.contacts().iter().zip(&response.contacts).enumerate();
        let mut errors = vec![0.0; self.model.contacts().len()];
        for mode in fast() {
            let w = mode.angular_frequency;
            let by_contacts: f64 = contacts()
                .map(|(i, (contact, seen))| mode.closure[i].abs() * contact.area() * range(seen))
                .sum();
            let by_load = mode.load.abs() * changes * slowest / w;
            let motion = (by_load + by_contacts * (natural / w).powi(2)) / (w * w);
            for (i, (contact, seen)) in contacts() {
                let stiffness = contact.law().stiffness(seen.pressure_max).max(contact.stiffness());
                errors[i] += stiffness * mode.closure[i].abs() * motion;
            }
        }
        let share = |(i, (_, seen)): (usize, (_, &ContactExtremes))| {
            if errors[i] == 0.0 { 0.0 } else { errors[i] / range(seen) }
        };
        contacts().map(share).fold(0.0, f64::max)
    }
}

/// Sum of the magnitudes of second or third differences, whichever is less, of a load at
/// times `1 / frequency` apart.
fn changes(load: &LoadCase, duration: f64, frequency: f64) -> f64 {
    let count = (load.ends_at().min(duration) * frequency).min(MOST_SAMPLES) as usize + 3;
    let (mut second_sum, mut third_sum) = (0.0, 0.0);
    let (mut force, mut slope, mut curvature) = (0.0, 0.0, 0.0);
    for k in 0..=count {
        let next = load.value(k as f64 / frequency);
        let next_slope = next - force;
        let next_curvature = next_slope - slope;
        second_sum += f64::abs(next_curvature);
        third_sum += f64::abs(next_curvature - curvature);
        (force, slope, curvature) = (next, next_slope, next_curvature);
    }
    f64::min(second_sum, third_sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_structure::TimeFunction;

    /// An oscillator, solved exactly for a force that is linear within short steps: what it does
    /// beyond its flexibility is within the bound, and not a hundredth of it.
    #[test]
    fn motion_beyond_the_flexibility_is_within_its_bound() {
        let (peak, duration) = (3.0, 0.4e-3);
        for function in [
            TimeFunction::HalfSine { duration },
            TimeFunction::Haversine { duration },
            TimeFunction::GammaPulse { rise: 0.2e-3 },
        ] {
            let load = LoadCase::force(function, peak);
            for w in [1e5, 3e5, 1e6_f64] {
                let step = 0.02 / w;
                let (sine, cosine) = 0.02_f64.sin_cos();
                let (mut beyond, mut rate, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
                let mut slope = 0.0;
                for k in 0..(1.2 * duration / step) as usize {
                    // In units of f / w^2, with time in radians; the flexibility takes up a slope.
                    let from = load.value(k as f64 * step);
                    let to = load.value((k + 1) as f64 * step);
                    let next = (to - from) / 0.02;
                    rate -= next - slope;
                    slope = next;
                    (beyond, rate) = (cosine * beyond + sine * rate, cosine * rate - sine * beyond);
                    most = most.max(beyond.abs());
                }
                let bound = changes(&load, duration * 100.0, w);
                assert!(most <= 1.1 * bound, "{load:?} {w:e}: {most:e} {bound:e}");
                assert!(most >= 0.01 * bound, "{load:?} {w:e}: {most:e} {bound:e}");
            }
        }
    }
}
