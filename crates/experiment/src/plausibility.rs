//! Hits that are possible and unusual: forces, sample rates, signs, and contacts that open.

use asperity_signal::{HitRecord, Pulse, ResponseKind};

use crate::hit_report::HitReport;
use crate::options::FrequencyBand;

/// Largest usual force of a hand hammer \[N\], and least sample rate over the upper limit of the band.
const HAND_HAMMER: f64 = 5e3;
const SAMPLES: f64 = 10.0;
/// Gravity \[m/s2\], and the limits of a trough at it.
const GRAVITY: f64 = 9.81;
const AT_GRAVITY: (f64, f64) = (0.85, 1.25);
/// Least height of the other side over the trough, and least width of the trough at [`DEPTH`] of its depth over
/// the width of the peak at the same part of its height.
const HIGHER: f64 = 1.25;
const WIDER: f64 = 1.3;
const DEPTH: f64 = 0.8;
/// Samples of a trough at least.
const FEWEST: usize = 4;

/// Notices about the hits of a response.
pub(crate) fn notices(
    hits: &[HitReport],
    sample_rate_hz: f64,
    band: Option<FrequencyBand>,
) -> Vec<String> {
    let mut found = Vec::new();
    let largest = hits.iter().filter_map(|hit| hit.force_peak_n).fold(0.0, f64::max);
    if largest > HAND_HAMMER {
        found.push(format!(
            "the largest force is {largest:.4e} N; usual for a hand hammer: at most {HAND_HAMMER} N; \
             unit and sensitivity of the force?"
        ));
    }
    if let Some(band) = band.filter(|band| sample_rate_hz < SAMPLES * band.high_hz) {
        found.push(format!(
            "the sample rate is {sample_rate_hz} Hz; usual: at least {:.0} Hz, ten times the upper limit \
             of the band",
            SAMPLES * band.high_hz
        ));
    }
    let constants = || {
        let firsts = hits.iter().filter(|hit| hit.averaged).filter_map(|hit| hit.fundamental);
        firsts.filter_map(|first| first.modal_constant_per_kg)
    };
    let opposite = constants().filter(|[real, _]| *real < 0.0).count();
    if opposite > 0 && 2 * opposite > constants().count() {
        let mean = constants().map(|[real, _]| real).sum::<f64>() / constants().count() as f64;
        found.push(format!(
            "response and force have opposite signs at the fundamental (modal constant {mean:.3e} 1/kg; \
             usual where both are at one point: positive): a sensor that is turned round, or a response at \
             another point"
        ));
    }
    let open: Vec<String> =
        hits.iter().filter(|hit| hit.contact_lost).map(|hit| hit.index.to_string()).collect();
    if !open.is_empty() {
        found.push(format!(
            "contact is probably lost in hits {}: troughs of the acceleration are flat at gravity, where no \
             contact force acts; frequency, damping and harmonic ratio are those of an opening contact",
            open.join(", ")
        ));
    }
    found
}

/// True for an acceleration \[m/s2\] after the pulse whose extremes on one side stay flat at gravity, while the
/// others are higher: a body that a contact only pushes is in free fall while the contact is open.
pub(crate) fn is_contact_lost(hit: &HitRecord, pulse: Option<&Pulse>, kind: ResponseKind) -> bool {
    let (Some(pulse), ResponseKind::Acceleration) = (pulse, kind) else { return false };
    let begin = (pulse.base_s.1 * hit.sample_rate_hz).ceil() as usize;
    let Some(free) = hit.responses.first().and_then(|samples| samples.get(begin..)) else {
        return false;
    };
    [1.0, -1.0].into_iter().any(|sign| {
        let depth = free.iter().fold(0.0, |most: f64, x| most.max(-sign * x));
        let height = free.iter().fold(0.0, |most: f64, x| most.max(sign * x));
        let is_at_gravity = (AT_GRAVITY.0 * GRAVITY..AT_GRAVITY.1 * GRAVITY).contains(&depth);
        if !is_at_gravity || height < HIGHER * depth {
            return false;
        }
        let trough = longest(free.iter().map(|x| -sign * x > DEPTH * depth));
        let peak = longest(free.iter().map(|x| sign * x > DEPTH * height));
        trough >= FEWEST && trough as f64 > WIDER * peak as f64
    })
}

/// Length of the longest run of true values.
fn longest(values: impl Iterator<Item = bool>) -> usize {
    let mut run = 0;
    values.fold(0, |most, value| {
        run = if value { run + 1 } else { 0 };
        most.max(run)
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

    use super::*;

    /// The acceleration of a mass of 1 kg on a spring with 100 N/kg of damping that only pushes, after a pulse
    /// that gives it a speed, and the same with a spring that also pulls.
    fn bouncing(speed: f64, is_unilateral: bool) -> HitRecord {
        let (rate, stiffness) = (51_200.0, (std::f64::consts::TAU * 800.0).powi(2));
        let (mut u, mut v) = (0.0, 0.0);
        let mut force = vec![0.0; 4000];
        let mut response = vec![0.0; 4000];
        for n in 0..4000 {
            force[n] = if (100..120).contains(&n) { speed * rate / 20.0 } else { 0.0 };
            // Ten steps a sample, positive down, about static equilibrium.
            for _ in 0..10 {
                let spring = -stiffness * u - 300.0 * v;
                let spring = if is_unilateral { spring.min(9.81) } else { spring };
                response[n] = spring + force[n];
                v += response[n] / (10.0 * rate);
                u += v / (10.0 * rate);
            }
        }
        HitRecord {
            start: 0,
            trigger: 100,
            force,
            responses: vec![response],
            sample_rate_hz: rate,
            missing: 0,
        }
    }

    #[test]
    fn flat_troughs_at_gravity_are_a_contact_that_opens() {
        for (speed, is_unilateral, expected) in [
            (0.008, true, true),
            (0.005, true, true),
            (0.001, true, false),
            (0.008, false, false),
            (0.0025, false, false),
        ] {
            let hit = bouncing(speed, is_unilateral);
            let pulse = Pulse::of(&hit.force, hit.sample_rate_hz).unwrap();
            let found = is_contact_lost(&hit, Some(&pulse), ResponseKind::Acceleration);
            assert_eq!(found, expected, "{speed} {is_unilateral}");
        }
    }
}
