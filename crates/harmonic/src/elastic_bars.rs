//! A preloaded stack of elastic bars as a linear system, in closed form.

use asperity_mesh::{Body, ComponentModes, ModeCount, Stack, Support};
use asperity_structure::{DampedMode, Guide, PreloadedStructure, StructureError};
use num_complex::Complex64;

use crate::bars_on_springs::{self, complex_modulus};
use crate::modal_damping;
use crate::{Compliance, HarmonicError, LinearSystem, MeanBalance, Receptance};

/// Exact at every frequency; contacts are not included.
///
/// Under mass-proportional viscosity of rate h each free bar of length L, with
/// `s = w^2 - i w h`, `kappa = sqrt(s) / c` and `th = kappa L`, has the end receptances
///
/// ```text
/// direct = -cot(th) / (E A kappa),    cross = -1 / (E A kappa sin(th)),
/// ```
///
/// with `kappa = sqrt(s / m) / c` and the rigidity `E A m` under internal damping, `m = 1 + i b w` or
/// `1 + i eta`. They turn into the rigid body's `-1 / (m s)` at low frequency. Interface i lies between the
/// lower end of bar i and the upper end of bar i + 1 or the support, so the compliance is
/// tridiagonal. Friction in a guide is spread over the bar by its mass, and moves it as a whole: its
/// receptances with the mean displacement and with the ends are `-1 / (m s)`. A spring-mass support has `1 / (k - w^2 m + i w c)`, its damper being its own.
impl LinearSystem for PreloadedStructure {
    fn interfaces(&self) -> usize {
        self.contacts().len()
    }

    fn guides(&self) -> &[Guide] {
        self.guides()
    }

    fn compliance(&self, w: f64, anti_damping: f64, into: &mut Compliance) {
        if !self.damped_modes().is_empty() {
            let free = vec![Complex64::ZERO; into.interfaces()];
            return self.compliance_on_springs(w, anti_damping, &free, into);
        }
        into.clear();
        let last = self.contacts().len() - 1;
        for (i, body) in self.stack().bodies().iter().enumerate() {
            let (direct, cross) = free_bar(body, w, self.damping_rate() - anti_damping);
            into.contact_mut(i, i).add(&direct, 1.0);
            if i == 0 {
                into.direct = direct;
                *into.drive_mut(0) = cross;
            } else {
                into.contact_mut(i - 1, i - 1).add(&direct, 1.0);
                into.contact_mut(i - 1, i).add(&cross, -1.0);
                into.contact_mut(i, i - 1).add(&cross, -1.0);
            }
        }
        into.contact_mut(last, last).add(&support(self.stack().support(), w, anti_damping), 1.0);
        for (pair, i) in (last + 1..).zip(guided(self.stack())) {
            let body = &self.stack().bodies()[i];
            let whole = rigid_bar(body, w, self.damping_rate() - anti_damping);
            into.contact_mut(pair, pair).add(&whole, 1.0);
            let ends = if i == 0 { vec![(0, 1.0)] } else { vec![(i - 1, -1.0), (i, 1.0)] };
            for (end, sign) in ends {
                into.contact_mut(end, pair).add(&whole, sign);
                into.contact_mut(pair, end).add(&whole, sign);
            }
            if i == 0 {
                *into.drive_mut(pair) = whole;
            }
        }
    }

    fn compliance_on_springs(
        &self,
        w: f64,
        anti_damping: f64,
        springs: &[Complex64],
        into: &mut Compliance,
    ) {
        let at = (w, self.damping_rate(), anti_damping);
        if self.damped_modes().is_empty() {
            return bars_on_springs::write(self.stack(), at, springs, into);
        }
        modal_damping::write(self.damped_modes(), self.contacts(), at, springs, into, |k, into| {
            bars_on_springs::write(self.stack(), at, k, into);
        });
    }

    /// Without guides the contacts carry the mean forces of rest, and so does the support. The mean
    /// force in a guide takes from the contacts below; the mean displacement of its bar is that of the
    /// closures below, and of the bars and the support under their mean forces.
    fn mean_balance(&self) -> MeanBalance {
        let (contacts, bodies) = (self.contacts().len(), self.stack().bodies());
        let guided: Vec<usize> = guided(self.stack()).collect();
        let n = contacts + guided.len();
        let mut balance = MeanBalance::determinate(n);
        balance.output_closure[contacts..].fill(0.0);
        let guide_of =
            |body: usize| guided.iter().position(|&own| own == body).map(|guide| contacts + guide);
        // Shortening of a bar per force, by pair: half of it about the middle of its length.
        let shortening = |body: usize| {
            let flexibility = bodies[body].length() / bodies[body].axial_rigidity();
            let above = body.checked_sub(1).map(|above| (above, flexibility));
            above.into_iter().chain(guide_of(body).map(|guide| (guide, -0.5 * flexibility)))
        };
        let support = match *self.stack().support() {
            Support::Rigid => 0.0,
            Support::SpringMass { stiffness, .. } => stiffness.recip(),
        };
        for (pair, &body) in (contacts..).zip(&guided) {
            let row = pair * n;
            for below in body..contacts {
                balance.force[below * n + pair] = 1.0;
                balance.closure[row + below] = -1.0;
            }
            balance.closure[row + pair] = 1.0;
            let flexibility = bodies[body].length() / bodies[body].axial_rigidity();
            balance.force[row + pair] = flexibility / 3.0;
            if let Some(above) = body.checked_sub(1) {
                balance.force[row + above] -= 0.5 * flexibility;
            }
            for (force, shortened) in (body + 1..contacts).flat_map(shortening) {
                balance.force[row + force] -= shortened;
            }
            balance.force[row + contacts - 1] -= support;
        }
        if !guided.is_empty() {
            for (force, shortened) in (0..contacts).flat_map(shortening) {
                balance.output_force[force] += shortened;
            }
            balance.output_force[contacts - 1] += support;
        }
        balance
    }

    fn lowest_modes(&self, count: usize) -> Result<ComponentModes, HarmonicError> {
        let modes = ComponentModes::of_stack(self.stack(), ModeCount::Lowest(count), &[]);
        Ok(modes.map_err(StructureError::from)?)
    }

    fn mass_damping(&self) -> f64 {
        self.damping_rate()
    }

    fn damped_modes(&self) -> &[DampedMode] {
        self.damped_modes()
    }
}

/// The bodies in guides with friction, by their places.
fn guided(stack: &Stack) -> impl Iterator<Item = usize> {
    let bodies = stack.bodies().iter().enumerate();
    bodies.filter(|(_, body)| body.friction().is_some()).map(|(i, _)| i)
}

/// Displacement of a bar as a whole per force, `-1 / (m s)`, under the damping rate h.
fn rigid_bar(body: &Body, w: f64, rate: f64) -> Receptance {
    let value = (-body.mass() * Complex64::new(w * w, -w * rate)).inv();
    let by_square = value * value * body.mass();
    Receptance {
        value,
        d_frequency: by_square * Complex64::new(2.0 * w, -rate),
        d_anti_damping: by_square * Complex64::new(0.0, w),
    }
}

/// Receptance of the support's face.
fn support(support: &Support, w: f64, anti_damping: f64) -> Receptance {
    match *support {
        Support::Rigid => Receptance::default(),
        Support::SpringMass { stiffness, mass, .. } => {
            let viscous = support.damping() - anti_damping * mass;
            let value = Complex64::new(stiffness - w * w * mass, w * viscous).inv();
            Receptance {
                value,
                d_frequency: -value * value * Complex64::new(-2.0 * w * mass, viscous),
                d_anti_damping: value * value * Complex64::new(0.0, w * mass),
            }
        }
    }
}

/// Direct and cross end receptances of a free bar under the damping rate h.
fn free_bar(body: &Body, w: f64, rate: f64) -> (Receptance, Receptance) {
    let s = Complex64::new(w * w, -w * rate);
    let (modulus, modulus_slope) = complex_modulus(body, w);
    let kappa = (s / modulus).sqrt() / body.wave_speed();
    let th = kappa * body.length();
    // exp(-i th) shrinks where damping makes th complex, so nothing overflows. With
    // `wave = 1 - exp(-2 i th)`: cot = i (2 - wave) / wave, 1 / sin = 2 i exp(-i th) / wave.
    let turn = (th * Complex64::new(0.0, -1.0)).exp();
    let wave = one_minus_square(turn, th);
    let i = Complex64::new(0.0, 1.0);
    let cot = i * (Complex64::new(2.0, 0.0) - wave) / wave;
    let cosec = 2.0 * i * turn / wave;
    let flexibility = (kappa * modulus * body.axial_rigidity()).inv();
    let length = Complex64::new(body.length(), 0.0);
    let (direct, cross) = (-cot * flexibility, -cosec * flexibility);
    // By kappa: -(cot)' / (E A kappa) = L / sin^2, and the like; each also falls as 1 / kappa.
    let direct_slope = flexibility * length * cosec * cosec - direct / kappa;
    let cross_slope = flexibility * length * cosec * cot - cross / kappa;
    let by_square = kappa / (2.0 * s);
    let (d_frequency, d_anti_damping) = (Complex64::new(2.0 * w, -rate), Complex64::new(0.0, w));
    let by_modulus = modulus_slope / modulus;
    let receptance = |value: Complex64, slope: Complex64| Receptance {
        value,
        d_frequency: slope * by_square * d_frequency - by_modulus * (value + 0.5 * kappa * slope),
        d_anti_damping: slope * by_square * d_anti_damping,
    };
    (receptance(direct, direct_slope), receptance(cross, cross_slope))
}

/// `1 - turn^2` for `turn = exp(-i th)`, without cancellation for small th:
/// `1 - exp(-2 i th) = 2 i sin(th) exp(-i th)`.
fn one_minus_square(turn: Complex64, th: Complex64) -> Complex64 {
    if th.norm() < 0.5 {
        Complex64::new(0.0, 2.0) * th.sin() * turn
    } else {
        Complex64::new(1.0, 0.0) - turn * turn
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_mesh::BarStiffness;

    /// Without damping the receptances invert the closed-form stiffness; rounding grows with the
    /// condition of the small matrix.
    #[test]
    fn receptances_invert_the_dynamic_stiffness() {
        let body = Body::new("bar", 0.2, 1e-3, 71e9, 2710.0).unwrap();
        for w in [50.0, 5e3, 6.1e4, 2.3e5] {
            let (direct, cross) = free_bar(&body, w, 0.0);
            let k = BarStiffness::at(&body, w);
            let same = direct.value * k.direct + cross.value * k.cross;
            let other = direct.value * k.cross + cross.value * k.direct;
            // A slow bar is nearly rigid: k.direct and k.cross nearly cancel.
            let bound = 1e-14 * (k.direct * direct.value.re).abs().max(1.0);
            assert!((same - Complex64::new(1.0, 0.0)).norm() < bound, "{w}: {same}");
            assert!(other.norm() < bound, "{w}: {other}");
        }
    }

    /// Derivatives against central differences, whose own error is about 1e-9.
    #[test]
    fn derivatives_match_differences() {
        let body = Body::new("bar", 0.2, 1e-3, 71e9, 2710.0).unwrap();
        for w in [900.0, 6e3, 2.3e5] {
            let (h, dw, dh) = (350.0, 1e-5 * w, 0.1);
            let (direct, cross) = free_bar(&body, w, h);
            let (up, down) = (free_bar(&body, w + dw, h), free_bar(&body, w - dw, h));
            // Anti-damping lowers the rate.
            let (more, less) = (free_bar(&body, w, h - dh), free_bar(&body, w, h + dh));
            for (exact, up, down, more, less) in
                [(direct, up.0, down.0, more.0, less.0), (cross, up.1, down.1, more.1, less.1)]
            {
                let slope = (up.value - down.value) / (2.0 * dw);
                assert!((slope / exact.d_frequency - 1.0).norm() < 1e-6);
                let slope = (more.value - less.value) / (2.0 * dh);
                assert!((slope / exact.d_anti_damping - 1.0).norm() < 1e-6);
            }
        }
    }
}
