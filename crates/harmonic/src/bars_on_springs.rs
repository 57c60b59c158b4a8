//! Receptances of a stack of bars whose contacts are springs.

use asperity_mesh::{Port, Stack, Support};
use num_complex::Complex64;

use crate::bar::{Bar, Place};
use crate::complex_elimination::eliminate;
use crate::{Compliance, Dual, SystemPort};

/// Writes the receptances of `stack` at the angular frequency w \[rad/s\] and an anti-damping rate
/// \[1/s\] between its pairs and these `ports`, its bodies under the damping rate h \[1/s\], with
/// `springs` \[N/m\] at its contacts.
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
/// `E^T u` the springs add `E K_0 E^T`; the sum S is solved for unit forces at the contacts, guides and
/// ports. Derivatives follow from `(S^-1)' = -S^-1 S' S^-1`, S' being diagonal.
///
/// Ports and guides are [`Part`]s of the motion of bars.
pub(crate) fn write(
    (stack, rate): (&Stack, f64),
    (w, anti_damping): (f64, f64),
    ports: &[SystemPort],
    springs: &[Complex64],
    into: &mut Compliance,
) {
    let bodies = stack.bodies();
    let n = bodies.len();
    let s = Dual::oscillator((0.0, -1.0, -rate), (w, anti_damping));
    let bars: Vec<Bar<'_>> = bodies.iter().map(|body| Bar::new(body, s, w)).collect();
    let mut diagonal = Vec::with_capacity(2 * n + 1);
    for bar in &bars {
        diagonal.extend(bar.stiffness());
    }
    if let Support::SpringMass { stiffness, mass, .. } = *stack.support() {
        let damper = stack.support().damping();
        diagonal.push(Dual::oscillator((stiffness, mass, damper), (w, anti_damping)));
    }
    let size = diagonal.len();
    let zero = Complex64::ZERO;
    // The parts of guides and ports, in the order of their columns.
    let mut parts = Vec::with_capacity(ports.len());
    let mut columns = n;
    for body in (0..n).filter(|&body| bodies[body].friction().is_some()) {
        add_parts(&bars, stack, Port::Mean { body }, columns, &mut parts);
        columns += 1;
    }
    for port in ports {
        if let SystemPort::Stack(port) = *port {
            add_parts(&bars, stack, port, columns, &mut parts);
        }
        columns += 1;
    }
    let of = |column: usize| parts.iter().filter(move |part: &&Part<'_>| part.column == column);
    // Rows of S, then a unit force in each column.
    let width = size + columns;
    let mut rows = vec![zero; size * width];
    for (row, entry) in diagonal.iter().enumerate() {
        rows[row * width + row] = entry.value;
    }
    let spring = |i: usize| springs.get(i).copied().unwrap_or(zero);
    for i in 0..n {
        // Lower end y - z of a bar less upper end y + z of the next, or the support.
        let all = [(2 * i, 1.0), (2 * i + 1, -1.0), (2 * i + 2, -1.0), (2 * i + 3, -1.0)];
        let shape = &all[..(size - 2 * i).min(4)];
        for (row, a) in shape {
            for (column, b) in shape {
                rows[row * width + column] += spring(i) * (a * b);
            }
            rows[row * width + size + i] = (*a).into();
        }
    }
    for part in &parts {
        for (row, share) in (part.coordinate..size).zip(&part.shape) {
            rows[row * width + size + part.column] += share.value;
        }
    }
    let scale = scales(&diagonal, &springs[..n.min(springs.len())]);
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
        let mut found = Dual::default();
        for (row, entry) in diagonal.iter().enumerate() {
            let product = solution(row, a) * solution(row, b);
            found.d_frequency -= product * entry.d_frequency;
            found.d_anti_damping -= product * entry.d_anti_damping;
        }
        for (own, other) in [(a, b), (b, a)] {
            for part in of(own).filter(|part| part.varies()) {
                for (row, share) in (part.coordinate..size).zip(&part.shape) {
                    let at = solution(row, other);
                    found.d_frequency += share.d_frequency * at;
                    found.d_anti_damping += share.d_anti_damping * at;
                }
            }
        }
        let at = |i: usize| solution(i, b);
        if a < n {
            let below = if 2 * a + 2 < size { at(2 * a + 2) } else { zero };
            let below = if 2 * a + 3 < size { below + at(2 * a + 3) } else { below };
            found.value = at(2 * a) - at(2 * a + 1) - below;
            return found;
        }
        for part in of(a) {
            for (row, share) in (part.coordinate..size).zip(&part.shape) {
                found.value += share.value * at(row);
            }
            for other in of(b).filter(|other| other.coordinate == part.coordinate) {
                part.add_held(other, &mut found);
            }
        }
        found
    };
    for j in 0..columns {
        for i in 0..=j {
            into.set(i, j, receptance(i, j));
        }
    }
}

/// Scales of the coordinates that bring the diagonal entries to about one: pivots do not depend on a
/// stiff support.
fn scales(diagonal: &[Dual], springs: &[Complex64]) -> Vec<f64> {
    let of = |i: usize| springs.get(i).map_or(0.0, Complex64::l1_norm);
    let scale = |(row, entry): (usize, &Dual)| {
        let contacts = of(row / 2) + (row / 2).checked_sub(1).map_or(0.0, of);
        (entry.value.l1_norm() + contacts).sqrt().recip()
    };
    diagonal.iter().enumerate().map(scale).collect()
}

/// Adds the parts of a port in a column.
fn add_parts<'a>(
    bars: &'a [Bar<'a>],
    stack: &Stack,
    port: Port,
    column: usize,
    parts: &mut Vec<Part<'a>>,
) {
    let mut add = |body: usize, place: Place, factor: f64| {
        let (coordinate, bar) = (2 * body, bars.get(body));
        let shape = bar.map_or([Dual::ONE, Dual::default()], |bar| bar.shape(place));
        let shape = shape.map(|share| if factor == 1.0 { share } else { share * factor });
        parts.push(Part { column, coordinate, bar, place, factor, shape });
    };
    let carried = match *stack.support() {
        Support::SpringMass { mass, .. } => Some(mass),
        Support::Rigid => None,
    };
    match port {
        Port::Point { body, position } => add(body, Place::Point(position), 1.0),
        Port::Mean { body } => add(body, Place::Mean, 1.0),
        Port::Base => {
            for (body, bar) in bars.iter().enumerate() {
                add(body, Place::Mean, -bar.body.mass());
            }
            if let Some(mass) = carried {
                add(bars.len(), Place::Whole, -mass);
            }
        }
        Port::Support if carried.is_some() => add(bars.len(), Place::Whole, 1.0),
        _ => {}
    }
}

/// The share of a port in the motion of a bar or the support.
///
/// A bar whose ends move by y and z moves at x by
///
/// ```text
/// y cos(kappa d) / cos(th / 2) + z sin(kappa d) / sin(th / 2),    d = L / 2 - x,
/// ```
///
/// and on average by `t y`, `t = tan(th / 2) / (th / 2)`. Forces act on y and z with these shares. Beside
/// that they move a bar whose ends are held: a force at x the place x' by
/// `sin(kappa x<) sin(kappa (L - x>)) / (E A kappa sin(th))`, x< being the lesser and x> the greater of
/// both; a force spread over the bar by its mass moves x by `(cos(kappa d) / cos(th / 2) - 1) / (m s)` and
/// the bar on average by `(t - 1) / (m s)`, with `s = w^2 - i w h`.
struct Part<'a> {
    column: usize,
    /// First of its two coordinates; the support has one.
    coordinate: usize,
    /// None for the support.
    bar: Option<&'a Bar<'a>>,
    place: Place,
    factor: f64,
    /// Shares of the coordinates, times the factor.
    shape: [Dual; 2],
}

impl Part<'_> {
    /// True if the shares depend on the frequency: all but those of ends and the support.
    fn varies(&self) -> bool {
        match (self.place, self.bar) {
            (Place::Point(x), Some(bar)) => x > 0.0 && x < bar.body.length(),
            (Place::Mean, _) => true,
            _ => false,
        }
    }

    /// Adds the receptance between two parts of a bar whose ends are held.
    fn add_held(&self, other: &Self, found: &mut Dual) {
        let (Some(bar), true, true) = (self.bar, self.varies(), other.varies()) else { return };
        let held = match (self.place, other.place) {
            (Place::Point(x), Place::Point(y)) => bar.held(x.min(y), bar.body.length() - x.max(y)),
            (Place::Point(x), _) | (_, Place::Point(x)) => bar.point_excess(x) * bar.per_inertia(),
            _ => bar.mean_excess() * bar.per_inertia(),
        };
        found.add(&held, self.factor * other.factor);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use asperity_law::Constant;
    use asperity_mesh::{Body, Interface};

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
            let mut compliance = Compliance::zero(2, 1);
            let springs = [Complex64::new(9e7, 4e7); 2];
            write((&stack, 400.0), (5e3, 0.0), &[Port::TOP.into()], &springs, &mut compliance);
            compliance
        };
        let rigid = found(Support::Rigid);
        for stiffness in [1e100, 1e160, 1e200, 1e300] {
            let compliant =
                found(Support::SpringMass { stiffness, mass: 2.0, damping_ratio: 0.02 });
            for (i, j) in [(0, 0), (0, 1), (1, 1), (2, 2)] {
                let (a, b) = (compliant.get(i, j), rigid.get(i, j));
                assert!((a.value / b.value - 1.0).norm() < 1e-13, "{stiffness}: {a:?} {b:?}");
                assert!((a.d_frequency / b.d_frequency - 1.0).norm() < 1e-12, "{stiffness}");
            }
        }
    }
}
