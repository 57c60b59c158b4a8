//! Damping ratios of linearised modes in receptances.

use asperity_structure::{DampedMode, PreloadedContact};
use num_complex::Complex64;

use crate::{Compliance, Dual};

/// Adds the dampers of modes to a compliance at the angular frequency w \[rad/s\] and an anti-damping
/// rate \[1/s\]: it is written by `on_springs` with the springs that the modes are linearised on, and left
/// with `springs` in their place.
///
/// On these springs the structure under mass-proportional damping h, `rate` \[1/s\], has the receptances
///
/// ```text
/// G = sum_r phi_r phi_r^T / (w_r^2 - w^2 + i w h),
/// ```
///
/// in which a mode with the damping rate `c_r` of its own has `c_r` in place of h. The anti-damping
/// rate is taken from both. Participations `phi_r` of ports are given by `of_port`.
pub(crate) fn write(
    (modes, contacts, rate): (&[DampedMode], &[PreloadedContact], f64),
    at: (f64, f64),
    springs: &[Complex64],
    into: &mut Compliance,
    of_port: impl Fn(&DampedMode, usize) -> f64,
    on_springs: impl FnOnce(&[Complex64], &mut Compliance),
) {
    let at_rest: Vec<Complex64> = contacts.iter().map(|contact| contact.spring().into()).collect();
    on_springs(&at_rest, into);
    for mode in modes {
        let receptance =
            |rate: f64| Dual::oscillator((mode.angular_frequency.powi(2), 1.0, rate), at).inverse();
        let ports = (0..into.size() - into.pairs()).map(|port| of_port(mode, port));
        let participations: Vec<f64> = mode.closure.iter().copied().chain(ports).collect();
        into.add(&participations, &(receptance(mode.damping_rate) - receptance(rate)));
    }
    let given = |i: usize| springs.get(i).copied().unwrap_or(Complex64::ZERO);
    let left: Vec<Complex64> =
        at_rest.iter().enumerate().map(|(i, rest)| given(i) - rest).collect();
    into.add_springs(&left);
}
