//! Damping ratios of linearised modes in receptances.

use asperity_structure::{DampedMode, PreloadedContact};
use num_complex::Complex64;

use crate::{Compliance, Receptance};

/// Adds the dampers of modes to a compliance at the angular frequency `w` \[rad/s\]: it is written by
/// `on_springs` with the springs that the modes are linearised on, and left with `springs` in their
/// place.
///
/// On these springs the structure under mass-proportional damping h has the receptances
///
/// ```text
/// G = sum_r phi_r phi_r^T / (w_r^2 - w^2 + i w h),
/// ```
///
/// in which a mode with the damping rate `c_r` of its own has `c_r` in place of h. The anti-damping
/// rate is taken from both.
pub(crate) fn write(
    modes: &[DampedMode],
    contacts: &[PreloadedContact],
    (w, rate, anti_damping): (f64, f64, f64),
    springs: &[Complex64],
    into: &mut Compliance,
    on_springs: impl FnOnce(&[Complex64], &mut Compliance),
) {
    let at_rest: Vec<Complex64> = (0..springs.len())
        .map(|i| contacts.get(i).map_or(Complex64::ZERO, |contact| contact.spring().into()))
        .collect();
    on_springs(&at_rest, into);
    for mode in modes {
        let square = mode.angular_frequency.powi(2) - w * w;
        let receptance = |rate: f64| {
            let value = Complex64::new(square, w * rate).inv();
            Receptance {
                value,
                d_frequency: -value * value * Complex64::new(-2.0 * w, rate),
                d_anti_damping: value * value * Complex64::new(0.0, w),
            }
        };
        let mut change = receptance(mode.damping_rate - anti_damping);
        change.add(&receptance(rate - anti_damping), -1.0);
        for (i, own) in mode.closure.iter().enumerate() {
            for (j, other) in mode.closure.iter().enumerate() {
                into.contact_mut(i, j).add(&change, own * other);
            }
            into.drive_mut(i).add(&change, own * mode.drive);
        }
        into.direct.add(&change, mode.drive * mode.drive);
    }
    let left: Vec<Complex64> = springs.iter().zip(&at_rest).map(|(k, rest)| k - rest).collect();
    into.add_springs(&left);
}
