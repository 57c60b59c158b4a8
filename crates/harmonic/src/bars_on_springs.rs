//! Receptances of a stack of bars whose contacts are springs.

use asperity_mesh::{Body, Stack, Support};
use num_complex::Complex64;

use crate::complex_elimination::eliminate;
use crate::{Compliance, Receptance};

/// Writes the receptances of `stack` at the angular frequency `w` \[rad/s\], its bodies under the
/// damping rate `rate` \[1/s\] less the `anti_damping`, with `springs` \[N/m\] at its contacts.
///
/// The coordinates of a bar are the mean y and half the difference z of its end displacements. In
/// them its dynamic stiffness is diagonal,
///
/// ```text
/// -2 E A kappa tan(th / 2) for y,    2 E A kappa cot(th / 2) for z,
/// ```
///
/// with `kappa = sqrt(w^2 - i w h) / c` and `th = kappa L`, E and c being complex with internal damping,
/// so that neither the inertia of a light
/// or stiff bar nor its flexibility is a small difference of large numbers. With the closures
/// `E^T u` the springs add `E K_0 E^T`; the sum S is solved for unit forces at the contacts and the
/// driving point. Derivatives follow from `(S^-1)' = -S^-1 S' S^-1`, S' being diagonal.
///
/// A force F in a guide, spread over the bar by its mass, would move the free bar by `-F / (m s)`. On
/// its ends it acts on y by `t F`, `t = tan(th / 2) / (th / 2)`, and the mean displacement of the bar
/// is `t y + (t - 1) F / (m s)`.
pub(crate) fn write(
    stack: &Stack,
    (w, rate, anti_damping): (f64, f64, f64),
    springs: &[Complex64],
    into: &mut Compliance,
) {
    let bodies = stack.bodies();
    let n = bodies.len();
    let mut diagonal = Vec::with_capacity(2 * n + 1);
    for body in bodies {
        diagonal.extend(bar(body, w, rate - anti_damping));
    }
    if let Support::SpringMass { stiffness, mass, .. } = *stack.support() {
        let viscous = stack.support().damping() - anti_damping * mass;
        diagonal.push(Diagonal {
            value: Complex64::new(stiffness - w * w * mass, w * viscous),
            d_frequency: Complex64::new(-2.0 * w * mass, viscous),
            d_anti_damping: Complex64::new(0.0, -w * mass),
        });
    }
    let size = diagonal.len();
    let zero = Complex64::ZERO;
    let guides: Vec<GuidedBar> = (0..n)
        .filter(|&i| bodies[i].friction().is_some())
        .map(|i| GuidedBar::new(&bodies[i], i, w, rate - anti_damping))
        .collect();
    // Rows of S, then a unit force at each contact, in each guide, and one at the top.
    let top = n + guides.len();
    let width = size + top + 1;
    let mut rows = vec![zero; size * width];
    for (row, entry) in diagonal.iter().enumerate() {
        rows[row * width + row] = entry.value;
    }
    for (i, spring) in springs[..n].iter().enumerate() {
        // Lower end y - z of a bar less upper end y + z of the next, or the support.
        let all = [(2 * i, 1.0), (2 * i + 1, -1.0), (2 * i + 2, -1.0), (2 * i + 3, -1.0)];
        let shape = &all[..(size - 2 * i).min(4)];
        for (row, a) in shape {
            for (column, b) in shape {
                rows[row * width + column] += spring * (a * b);
            }
            rows[row * width + size + i] = (*a).into();
        }
    }
    for (column, guide) in (n..).zip(&guides) {
        rows[guide.coordinate * width + size + column] = guide.share.value;
    }
    for row in 0..2 {
        rows[row * width + size + top] = Complex64::ONE;
    }
    // Coordinates scaled to diagonal entries of about one: pivots do not depend on a stiff support.
    let mut scale = Vec::with_capacity(size);
    for (row, entry) in diagonal.iter().enumerate() {
        let of = |i: usize| springs[..n].get(i).map_or(0.0, Complex64::l1_norm);
        let contacts = of(row / 2) + (row / 2).checked_sub(1).map_or(0.0, of);
        scale.push((entry.value.l1_norm() + contacts).sqrt().recip());
    }
    for (row, factor) in rows.chunks_exact_mut(width).zip(&scale) {
        for (x, other) in row.iter_mut().zip(&scale) {
            *x *= factor * other;
        }
        for x in &mut row[size..] {
            *x *= factor;
        }
    }
    eliminate(&mut rows, size, width);
    let solution = |row: usize, column: usize| rows[row * width + size + column] * scale[row];
    let receptance = |a: usize, b: usize| {
        let mut found = Receptance::default();
        for (row, entry) in diagonal.iter().enumerate() {
            let product = solution(row, a) * solution(row, b);
            found.d_frequency -= product * entry.d_frequency;
            found.d_anti_damping -= product * entry.d_anti_damping;
        }
        for (guide, other) in [(a, b), (b, a)] {
            let Some(guide) = guide.checked_sub(n).and_then(|guide| guides.get(guide)) else {
                continue;
            };
            let at = solution(guide.coordinate, other);
            found.d_frequency += guide.share.d_frequency * at;
            found.d_anti_damping += guide.share.d_anti_damping * at;
        }
        let at = |i: usize| solution(i, b);
        found.value = if a == top {
            at(0) + at(1)
        } else if a >= n {
            let guide = &guides[a - n];
            if a == b {
                found.add(&guide.own, 1.0);
            }
            found.value + guide.share.value * at(guide.coordinate)
        } else {
            let below = if 2 * a + 2 < size { at(2 * a + 2) } else { zero };
            let below = if 2 * a + 3 < size { below + at(2 * a + 3) } else { below };
            at(2 * a) - at(2 * a + 1) - below
        };
        found
    };
    for i in 0..top {
        for j in 0..=i {
            // Reciprocal.
            let found = receptance(i, j);
            *into.contact_mut(i, j) = found;
            *into.contact_mut(j, i) = found;
        }
        *into.drive_mut(i) = receptance(i, top);
    }
    into.direct = receptance(top, top);
}

/// A bar in a guide with friction.
struct GuidedBar {
    /// Coordinate y of the bar.
    coordinate: usize,
    /// `tan(th / 2) / (th / 2)`.
    share: Receptance,
    /// Mean displacement per force in the guide while y is held, `(t - 1) / (m s)`.
    own: Receptance,
}

impl GuidedBar {
    fn new(body: &Body, place: usize, w: f64, h: f64) -> Self {
        let s = Complex64::new(w * w, -w * h);
        let (m, m_slope) = complex_modulus(body, w);
        let x = root(s / m) / body.wave_speed() * (0.5 * body.length());
        let square = x * x;
        let excess = if x.norm_sqr() < 0.01 {
            // Of tan(x) / x - 1.
            const SERIES: [f64; 5] =
                [1.0 / 3.0, 2.0 / 15.0, 17.0 / 315.0, 62.0 / 2835.0, 1382.0 / 155_925.0];
            square * SERIES.iter().rev().fold(Complex64::ZERO, |sum, factor| sum * square + factor)
        } else {
            tangent(x) / x - Complex64::ONE
        };
        let share = excess + Complex64::ONE;
        // x dt/dx = 1 + tan^2 - t, and x^2 is proportional to s / m.
        let slope = 0.5 * (square * share * share - excess);
        let (by_square, by_modulus) = (slope / s, -slope * m_slope / m);
        let own = excess / (body.mass() * s);
        let own_slope = (slope - excess) / (body.mass() * s * s);
        let (d_frequency, d_anti_damping) = (Complex64::new(2.0 * w, -h), Complex64::new(0.0, w));
        let share = Receptance {
            value: share,
            d_frequency: by_square * d_frequency + by_modulus,
            d_anti_damping: by_square * d_anti_damping,
        };
        let own = Receptance {
            value: own,
            d_frequency: own_slope * d_frequency + by_modulus / (body.mass() * s),
            d_anti_damping: own_slope * d_anti_damping,
        };
        Self { coordinate: 2 * place, share, own }
    }
}

/// An entry of the dynamic stiffness with its derivatives.
#[derive(Debug, Clone, Copy)]
struct Diagonal {
    value: Complex64,
    d_frequency: Complex64,
    d_anti_damping: Complex64,
}

/// The entries of a bar under the damping rate h, for the mean of its ends and half their difference.
///
/// Internal damping has the modulus `E m`, `m = 1 + i loss(w)`, and `kappa = sqrt(s / m) / c`.
fn bar(body: &Body, w: f64, h: f64) -> [Diagonal; 2] {
    let s = Complex64::new(w * w, -w * h);
    let (m, m_slope) = complex_modulus(body, w);
    let kappa = root(s / m) / body.wave_speed();
    let half = 0.5 * body.length();
    let tan = tangent(kappa * half);
    let rigidity = m * (2.0 * body.axial_rigidity());
    // d tan(kappa L / 2) / d kappa.
    let slope = half * (Complex64::ONE + tan * tan);
    let mean = (-rigidity * kappa * tan, -rigidity * (tan + kappa * slope));
    let difference =
        (rigidity * kappa / tan, rigidity * (Complex64::ONE - kappa * slope / tan) / tan);
    // d kappa = kappa / 2 (ds / s - dm / m); the rigidity grows by dm / m too.
    let (by_square, by_modulus) = (kappa / (2.0 * s), m_slope / m);
    [mean, difference].map(|(value, d_kappa)| Diagonal {
        value,
        d_frequency: d_kappa * by_square * Complex64::new(2.0 * w, -h)
            + by_modulus * (value - 0.5 * kappa * d_kappa),
        d_anti_damping: d_kappa * by_square * Complex64::new(0.0, w),
    })
}

/// The modulus of a bar over E at the angular frequency `w` \[rad/s\], `1 + i loss(w)`, and its
/// derivative \[s\].
pub(crate) fn complex_modulus(body: &Body, w: f64) -> (Complex64, Complex64) {
    let damping = body.damping();
    (Complex64::new(1.0, damping.loss(w)), Complex64::new(0.0, damping.loss_slope()))
}

/// The root with a positive real part, without the angles of the general function.
fn root(x: Complex64) -> Complex64 {
    let size = x.norm_sqr().sqrt();
    if x.re <= 0.0 || !size.is_normal() {
        return x.sqrt();
    }
    let re = (0.5 * (size + x.re)).sqrt();
    Complex64::new(re, 0.5 * x.im / re)
}

/// `tan(x)`, without overflow for the strongly damped, whose imaginary part is negative, and
/// without cancellation for small x.
fn tangent(x: Complex64) -> Complex64 {
    let i = Complex64::new(0.0, 1.0);
    if x.norm_sqr() < 0.25 {
        x.sin() / x.cos()
    } else {
        let turn = (-2.0 * i * x).exp();
        -i * (Complex64::ONE - turn) / (Complex64::ONE + turn)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use asperity_law::Constant;
    use asperity_mesh::Interface;

    use super::*;

    /// A support as stiff as numbers go is a rigid one.
    #[test]
    fn a_very_stiff_support_is_rigid() {
        let found = |support: Support| {
            let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0).unwrap();
            let sample = Body::new("sample", 0.015, 1.15e-4, 71e9, 2710.0).unwrap();
            let law = Arc::new(Constant::new(8.5e11).unwrap());
            let contact = |name| Interface::new(name, 1.15e-4, law.clone()).unwrap();
            let contacts = vec![contact("upper"), contact("lower")];
            let stack = Stack::new(vec![guide, sample], contacts, support, 9.81).unwrap();
            let mut compliance = Compliance::zero(2);
            write(&stack, (5e3, 400.0, 0.0), &[Complex64::new(9e7, 4e7); 2], &mut compliance);
            compliance
        };
        let rigid = found(Support::Rigid);
        for stiffness in [1e100, 1e160, 1e200, 1e300] {
            let compliant =
                found(Support::SpringMass { stiffness, mass: 2.0, damping_ratio: 0.02 });
            for (i, j) in [(0, 0), (0, 1), (1, 1)] {
                let (a, b) = (compliant.contact(i, j), rigid.contact(i, j));
                assert!((a.value / b.value - 1.0).norm() < 1e-13, "{stiffness}: {a:?} {b:?}");
                assert!((a.d_frequency / b.d_frequency - 1.0).norm() < 1e-12, "{stiffness}");
            }
            assert!((compliant.direct.value / rigid.direct.value - 1.0).norm() < 1e-13);
        }
    }
}
