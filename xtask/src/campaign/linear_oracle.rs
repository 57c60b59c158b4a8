//! Exact linear response of a stack at rest, by the dynamic stiffness seen from its top.
//!
//! From the support upwards, with contacts as springs of their stiffness at rest:
//!
//! ```text
//! D = k - m w^2 + i w c                               support; infinite if rigid
//! 1/D <- 1/D + 1/(K(p0) S)                            contact
//! D <- Q (D cos(q L) - Q sin(q L)) / (Q cos(q L) + D sin(q L))   bar
//! q^2 = (w^2 - i w h) rho / E,  Q = E A q
//! ```

use asperity_mesh::Support;
use asperity_structure::PreloadedStructure;
use num_complex::Complex64;

/// Receptance of the top at an angular frequency \[rad/s\], in m/N.
pub(super) fn receptance(structure: &PreloadedStructure, angular_frequency: f64) -> Complex64 {
    1.0 / dynamic_stiffness(structure, angular_frequency, structure.damping_rate(), true)
}

/// True if the undamped structure has its lowest natural frequency at `frequency_hz`: the stiffness
/// seen from the top falls through zero there, and nowhere below.
pub(super) fn is_lowest_frequency(structure: &PreloadedStructure, frequency_hz: f64) -> bool {
    const SAMPLES: usize = 400;
    let w = std::f64::consts::TAU * frequency_hz;
    let stiffness = |w: f64| dynamic_stiffness(structure, w, 0.0, false).re;
    let below = (1..SAMPLES).map(|at| w * at as f64 / SAMPLES as f64);
    below.chain([w * (1.0 - 1e-6)]).all(|w| stiffness(w) > 0.0) && stiffness(w * (1.0 + 1e-6)) < 0.0
}

/// Dynamic stiffness seen from the top \[N/m\].
fn dynamic_stiffness(
    structure: &PreloadedStructure,
    w: f64,
    damping_rate: f64,
    support_damped: bool,
) -> Complex64 {
    let stack = structure.stack();
    // The compliance stays finite on a rigid support.
    let mut compliance = match *stack.support() {
        Support::SpringMass { stiffness, mass, .. } => {
            let damping = if support_damped { w * stack.support().damping() } else { 0.0 };
            1.0 / Complex64::new(stiffness - mass * w * w, damping)
        }
        Support::Rigid => Complex64::ZERO,
    };
    for (body, contact) in stack.bodies().iter().zip(structure.contacts()).rev() {
        compliance += 1.0 / (contact.stiffness() * contact.area());
        let speed = (body.youngs_modulus() / body.density()).sqrt();
        let wavenumber = Complex64::new(w * w, -w * damping_rate).sqrt() / speed;
        let q = wavenumber * (body.youngs_modulus() * body.section());
        let (sin, cos) = ((wavenumber * body.length()).sin(), (wavenumber * body.length()).cos());
        compliance = (q * cos * compliance + sin) / (q * (cos - q * sin * compliance));
    }
    1.0 / compliance
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use asperity_law::Constant;
    use asperity_mesh::{Body, Interface, Stack};
    use asperity_structure::Damping;

    /// A short stiff block on a soft contact is a mass on a spring.
    #[test]
    fn a_rigid_block_responds_as_one_mass() {
        let block = Body::new("block", 1e-3, 1e-3, 1e13, 8000.0).unwrap();
        let contact = Interface::new("foot", 1e-3, Arc::new(Constant::new(1e8).unwrap())).unwrap();
        let stack = Stack::new(vec![block], vec![contact], Support::Rigid, 9.81).unwrap();
        let structure = PreloadedStructure::new(stack, Damping::Ratio(0.05)).unwrap();
        let (mass, spring) = (8e-3_f64, 1e5_f64);
        let natural = (spring / mass).sqrt();
        for ratio in [0.3, 0.99, 1.0, 1.7] {
            let w = ratio * natural;
            let exact =
                1.0 / Complex64::new(spring - mass * w * w, 2.0 * 0.05 * natural * mass * w);
            let error = (receptance(&structure, w) - exact).norm() / exact.norm();
            assert!(error < 1e-6, "{ratio}: {error}");
        }
        let frequency = structure.natural_frequency().unwrap();
        assert!(is_lowest_frequency(&structure, frequency));
        assert!(!is_lowest_frequency(&structure, 1.001 * frequency));
    }
}
