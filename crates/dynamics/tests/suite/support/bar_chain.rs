//! Receptance of the damped linear rig in closed form.

use asperity_mesh::{Stack, Support};
use faer::c64;

/// Displacement of the top per force on it [m/N] at `frequency` [Hz], contacts
/// being springs of `contact_stiffness` [Pa/m] per area and `rate` the damping h [1/s].
///
/// From `-w^2 + i w h = -(c kappa)^2`, each bar is `a cot(th)` and `-a / sin(th)`
/// with `a = E A kappa`, `th = kappa L`, complex; the stiffness that the rest
/// offers to the top of each bar is built up from the support.
pub fn receptance(stack: &Stack, contact_stiffness: &[f64], rate: f64, frequency: f64) -> c64 {
    let w = std::f64::consts::TAU * frequency;
    let squared = c64::new(w * w, -w * rate);
    let in_series = |a: c64, b: c64| a * b / (a + b);
    let support = match *stack.support() {
        Support::Rigid => None,
        Support::SpringMass { stiffness, mass, .. } => {
            Some(c64::new(stiffness - w * w * mass, w * stack.support().damping()))
        }
    };
    let mut below = support;
    for (i, body) in stack.bodies().iter().enumerate().rev() {
        let contact = c64::new(contact_stiffness[i] * stack.interfaces()[i].area(), 0.0);
        let carried = below.map_or(contact, |below| in_series(contact, below));
        let number = squared.sqrt() / body.wave_speed();
        let th = number * body.length();
        let a = number * body.axial_rigidity();
        let (direct, cross) = (a * th.cos() / th.sin(), -a / th.sin());
        below = Some(direct - cross * cross / (direct + carried));
    }
    below.map_or(c64::new(f64::NAN, 0.0), |top| top.inv())
}
