//! The closed-form dynamic stiffness of a bar.

use std::f64::consts::PI;

use crate::Body;

/// End forces per end displacement of an undamped bar vibrating at angular
/// frequency `w`, from the solution of Eq. (1) without damping and gravity:
///
/// ```text
/// direct = a cot(th),  cross = -a / sin(th),  a = E A w / c,  th = w L / c
/// ```
///
/// As `w` tends to zero both tend to the static `E A / L`, with opposite signs.
/// At the frequencies of the bar clamped at both ends the entries are infinite;
/// [`clamped_modes_below`](BarStiffness::clamped_modes_below) counts those for
/// the Wittrick-Williams algorithm (J. Sound Vib. 1971, 16, 419).
///
/// ```
/// use asperity_mesh::{BarStiffness, Body};
///
/// let bar = Body::new("bar", 0.2, 1e-3, 71e9, 2710.0)?;
/// let stiffness = BarStiffness::at(&bar, 1.0);
/// assert!((stiffness.direct * 0.2 / (71e9 * 1e-3) - 1.0).abs() < 1e-8);
/// # Ok::<(), asperity_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BarStiffness {
    /// Force at an end per displacement of the same end \[N/m\].
    pub direct: f64,
    /// Force at an end per displacement of the other end \[N/m\].
    pub cross: f64,
    /// Number of natural frequencies of the bar clamped at both ends below `w`.
    pub clamped_modes_below: usize,
}

impl BarStiffness {
    /// The dynamic stiffness of `body` at `angular_frequency` \[rad/s\], which must be positive.
    pub fn at(body: &Body, angular_frequency: f64) -> Self {
        let th = angular_frequency * body.length() / body.wave_speed();
        let a = body.axial_rigidity() * angular_frequency / body.wave_speed();
        let (sin, cos) = th.sin_cos();
        Self {
            direct: a * cos / sin,
            cross: -a / sin,
            // th = n pi are the clamped modes; those strictly below th.
            clamped_modes_below: ((th / PI).ceil() - 1.0).max(0.0) as usize,
        }
    }

    /// Displacement at `fraction` of the length from the top, for end
    /// displacements `top` and `bottom`, at `angular_frequency` [rad/s]:
    /// `(top sin(th (1 - s)) + bottom sin(th s)) / sin(th)`.
    pub fn displacement(
        body: &Body,
        angular_frequency: f64,
        (top, bottom): (f64, f64),
        fraction: f64,
    ) -> f64 {
        let th = angular_frequency * body.length() / body.wave_speed();
        (top * (th * (1.0 - fraction)).sin() + bottom * (th * fraction).sin()) / th.sin()
    }

    /// Mean displacement over the length, for end displacements `top` and `bottom`, at
    /// `angular_frequency` \[rad/s\]: half their sum times `tan(th / 2) / (th / 2)`.
    pub fn mean_displacement(
        body: &Body,
        angular_frequency: f64,
        (top, bottom): (f64, f64),
    ) -> f64 {
        let half = 0.5 * angular_frequency * body.length() / body.wave_speed();
        let share = if half < 1e-4 { 1.0 + half * half / 3.0 } else { half.tan() / half };
        0.5 * (top + bottom) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> Body {
        Body::new("bar", 0.2, 1e-3, 71e9, 2710.0).unwrap()
    }

    #[test]
    fn slow_motion_meets_the_static_stiffness() {
        let stiffness = BarStiffness::at(&body(), 1.0);
        let k = 71e9 * 1e-3 / 0.2;
        assert!((stiffness.direct / k - 1.0).abs() < 1e-8);
        assert!((stiffness.cross / k + 1.0).abs() < 1e-8);
        assert_eq!(stiffness.clamped_modes_below, 0);
    }

    /// Clamped-clamped modes are n c / (2 L).
    #[test]
    fn clamped_modes_are_counted() {
        let body = body();
        let first = PI * body.wave_speed() / body.length();
        for (factor, count) in [(0.5, 0), (1.001, 1), (1.999, 1), (2.001, 2), (7.5, 7)] {
            assert_eq!(BarStiffness::at(&body, factor * first).clamped_modes_below, count);
        }
    }

    /// The shape solves the wave equation: u'' = -(w/c)^2 u, checked by differences.
    #[test]
    fn the_shape_solves_the_wave_equation() {
        let body = body();
        let w = 0.7 * PI * body.wave_speed() / body.length();
        let at = |s| BarStiffness::displacement(&body, w, (1.0, -0.3), s);
        assert!((at(0.0) - 1.0).abs() < 1e-14 && (at(1.0) + 0.3).abs() < 1e-14);
        let h = 1e-3;
        let curvature = (at(0.4 + h) - 2.0 * at(0.4) + at(0.4 - h)) / (h * body.length()).powi(2);
        let expected = -(w / body.wave_speed()).powi(2) * at(0.4);
        assert!((curvature / expected - 1.0).abs() < 1e-6);
    }
}
