//! Free decay of the linear rig against the damping ratio of its lowest mode.

use std::f64::consts::TAU;

use crate::support::{DISC, constant, rig, rig_on, run_at, slope};
use asperity_dynamics::{ContactForm, FiniteDifference, Integrator, Modal};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

/// Damping ratio from the logarithms of successive maxima after `from` [s], each
/// refined by a parabola through three samples; and the number of maxima used.
pub(crate) fn ratio_of_decay(displacement: &[f64], interval: f64, from: f64) -> (f64, usize) {
    let start = (from / interval) as usize;
    let mut number = Vec::new();
    let mut height = Vec::new();
    for i in start + 1..displacement.len() - 1 {
        let [a, b, c] = [displacement[i - 1], displacement[i], displacement[i + 1]];
        if b > a && b >= c && b > 0.0 {
            number.push((number.len() as f64).exp());
            height.push(b + (a - c) * (a - c) / (8.0 * (2.0 * b - a - c)));
        }
    }
    let decrement = -slope(&number, &height);
    (decrement / decrement.hypot(TAU), height.len())
}

/// The decrement of the free decay is that of mode 1: exact for the linear rig.
#[test]
fn free_decay_of_the_linear_rig_has_the_damping_ratio_of_its_first_mode() {
    // A long smooth pulse leaves the higher modes, which decay no faster, alone.
    let pulse = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, 9.0);
    for (name, stack) in [("rigid", rig(&constant())), ("disc", rig_on(&constant(), DISC))] {
        let structure = PreloadedStructure::new(stack.clone(), Damping::Ratio(0.035)).unwrap();
        let rate = structure.damping_rate();
        let expected = structure.modes(1).unwrap().swap_remove(0);
        let decay = |method: Integrator| {
            let run = run_at(&stack, &method, rate, &pulse, (0.03, 1e6));
            ratio_of_decay(&run.history.sensors[0].displacement, run.history.time[1], 2e-3)
        };
        let grid = |contact| FiniteDifference { contact, ..FiniteDifference::default() }.into();
        let (ratio, maxima) = decay(Modal::default().into());
        let off = ratio / expected.damping_ratio - 1.0;
        assert!(maxima > 15 && off.abs() < 1e-3, "{name}, modal: off by {off}");
        let (ratio, maxima) = decay(grid(ContactForm::Centred));
        let off = ratio / expected.damping_ratio - 1.0;
        // The one-sided damping difference, h dt / 2 = 3e-5; on the disc also
        // the second mode, and zeta^2 of a damping that is not proportional.
        assert!(maxima > 15 && off.abs() < 1e-3, "{name}: off by {off}");
        // The test can see w0^2 dt, the numerical damping of the new-level form:
        // 1 % of the damping at 1 mm.
        let excess = decay(grid(ContactForm::NewLevel)).0 / ratio - 1.0;
        assert!((4e-3..2e-2).contains(&excess), "{name}: {excess}");
    }
}
