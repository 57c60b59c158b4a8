//! Contacts that open: their force integrated over the pieces of the period in which they are closed.

use std::f64::consts::{PI, TAU};

use asperity_structure::PreloadedContact;

use crate::ContactSystem;
use crate::fourier::{Fourier, value_at};

/// Nodes of a piece, beside those in proportion to its length.
const FEWEST_NODES: usize = 64;

/// Distance from the real angles, in samples, within which the force of a contact that hardly holds counts as
/// singular: equal samples are wrong by `exp(-2 pi 5)`, 2e-14, of the force there.
const NEAR: f64 = 5.0;

/// Iterations at most for a crossing, and for an extremum.
const ITERATIONS: usize = 60;
const NEWTON: usize = 4;

/// The force of a contact that opens within the period.
///
/// The force of a law that separates has a kink where the closure passes the closure of zero pressure, or a tangent
/// that is vertical there. Its sum over equal samples has a slope that changes quickly with every sample that
/// passes, and Newton's method stalls. The integral over a closed piece, from a crossing at the angle a to
/// the next at a + L, changes smoothly: with
///
/// ```text
/// th = a + L (t - sin(2 pi t) / (2 pi)),   0 < t < 1,
/// ```
///
/// the sum over equal t converges fast, because the integrand vanishes at both ends with the weight
/// `L (1 - cos(2 pi t))`. A contact that hardly holds, with the closure `v + b th^2 / 2` beyond the closure of zero
/// pressure at its minimum, has a force singular at `th = i sqrt(2 v / b)`: where that is near, a piece ends
/// at the minimum, so that the sums change smoothly as the contact begins to open. The force there has a
/// small relative error: the tangent of other tables is least exact next to the opening. Source: A. Sidi, "A new variable transformation for numerical integration",
/// Numerical Integration IV (1993) 359-373.
#[derive(Debug, Clone)]
pub(super) struct Opening {
    /// Closure increment from rest without pressure \[m\].
    closure: f64,
    /// Force at rest \[N\].
    at_rest: f64,
    /// Angles of the crossings, and of minima that hardly hold, and whether the contact is closed after them.
    crossings: Vec<(f64, bool)>,
    angles: Vec<f64>,
    weights: Vec<f64>,
    fourier: Fourier,
    closures: Vec<f64>,
    forces: Vec<f64>,
    tangents: Vec<f64>,
}

impl Opening {
    /// `None` for a contact that never opens, or is damped.
    pub(super) fn of(contact: &PreloadedContact, fourier: &Fourier) -> Option<Self> {
        let law = contact.law();
        let closure = law.closure(0.0) - contact.closure();
        let opens = law.domain().separates() && closure.is_finite() && contact.damping().is_none();
        opens.then(|| Self {
            closure,
            at_rest: contact.area() * contact.pressure(),
            crossings: Vec::new(),
            angles: Vec::new(),
            weights: Vec::new(),
            fourier: Fourier::at_angles(fourier.harmonics(), &[]),
            closures: Vec::new(),
            forces: Vec::new(),
            tangents: Vec::new(),
        })
    }

    /// Finds the crossings of a closure, and the minima that hardly hold, from its series and its samples; false
    /// without any.
    pub(super) fn find(&mut self, series: &[f64], samples: &[f64]) -> bool {
        self.crossings.clear();
        let count = samples.len();
        let spacing = TAU / count as f64;
        let beyond = |th: f64| value_at(series, th)[0] - self.closure;
        for (n, &sample) in samples.iter().enumerate() {
            let at = |m: usize| samples[m % count] - self.closure;
            let (before, here, after) = (at(n + count - 1), sample - self.closure, at(n + 1));
            let th = spacing * n as f64;
            if is_closed(here) != is_closed(after) {
                let ends = [(th, here), (th + spacing, after)];
                self.crossings.push((crossing(beyond, ends), is_closed(after)));
            }
            // An extremum beside the sample nearest to the opening may lie on the other side, or close to it.
            let (rise, fall) = ((before - here).abs(), (after - here).abs());
            let sign = here.signum();
            let is_nearest = sign * before > sign * here && sign * after >= sign * here;
            if !is_nearest || here.abs() > 2.0 * NEAR * NEAR * rise.max(fall) {
                continue;
            }
            let (mut top, mut curvature) = (th, f64::NAN);
            for _ in 0..NEWTON {
                let [_, slope, bend] = value_at(series, top);
                top = (top - slope / bend).clamp(th - spacing, th + spacing);
                curvature = bend.abs();
            }
            let extreme = (top, beyond(top));
            if is_closed(extreme.1) != is_closed(here) {
                let [left, right] = [(th - spacing, before), (th + spacing, after)];
                let first = (crossing(beyond, [left, extreme]), is_closed(extreme.1));
                let second = (crossing(beyond, [extreme, right]), is_closed(after));
                self.crossings.extend([first, second]);
            } else if sign > 0.0 && 2.0 * extreme.1 < curvature * (NEAR * spacing).powi(2) {
                self.crossings.push((top, true));
            }
        }
        self.crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        !self.crossings.is_empty()
    }

    /// Writes the series of the force increment \[N\], and of the tangent \[N/m\] to twice as many harmonics,
    /// for the crossings found.
    pub(super) fn integrate(
        &mut self,
        (system, interface): (&ContactSystem, usize),
        closure_series: &[f64],
        nodes: usize,
        (force, tangent): (&mut [f64], &mut [f64]),
    ) {
        self.place(nodes);
        let count = self.angles.len();
        self.fourier.move_to(&self.angles);
        for values in [&mut self.closures, &mut self.forces, &mut self.tangents] {
            values.resize(count, 0.0);
        }
        self.fourier.synthesise(closure_series, &mut self.closures);
        system.forces(interface, &self.closures, &mut self.forces, &mut self.tangents);
        let places = self.forces.iter_mut().zip(&mut self.tangents).zip(&self.weights);
        for ((force, tangent), weight) in places {
            *force = weight * (*force + self.at_rest);
            *tangent *= weight;
        }
        self.fourier.analyse(&self.forces, force);
        self.fourier.analyse(&self.tangents, tangent);
        force[0] -= self.at_rest;
    }

    /// Places nodes in the closed pieces, with weights for which their mean is the mean over the period.
    fn place(&mut self, nodes: usize) {
        self.angles.clear();
        self.weights.clear();
        let count = self.crossings.len();
        for (n, &(start, closes)) in self.crossings.iter().enumerate() {
            if !closes {
                continue;
            }
            let next = self.crossings[(n + 1) % count].0;
            let length = if n + 1 < count { next - start } else { next + TAU - start };
            let steps = FEWEST_NODES + (nodes as f64 * length / TAU).ceil() as usize;
            for t in (1..steps).map(|j| j as f64 / steps as f64) {
                let (sin, cos) = (TAU * t).sin_cos();
                self.angles.push(start + length * (t - sin / TAU));
                self.weights.push(length / TAU * (1.0 - cos) / steps as f64);
            }
        }
        let all = self.angles.len() as f64;
        self.weights.iter_mut().for_each(|weight| *weight *= all);
    }
}

fn is_closed(beyond: f64) -> bool {
    beyond >= 0.0
}

/// The zero of a function between two places with its values of different signs: Illinois rule.
fn crossing(value: impl Fn(f64) -> f64, [mut a, mut b]: [(f64, f64); 2]) -> f64 {
    let smallest = 1e-14 * PI;
    let scale = a.1.abs().max(b.1.abs());
    let mut kept = 0;
    for _ in 0..ITERATIONS {
        let at = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        let at = if at > a.0 && at < b.0 { at } else { 0.5 * (a.0 + b.0) };
        let found = value(at);
        if found.abs() <= 1e-15 * scale || b.0 - a.0 <= smallest {
            return at;
        }
        if is_closed(found) == is_closed(a.1) {
            a = (at, found);
            b.1 *= if kept == 1 { 0.5 } else { 1.0 };
            kept = 1;
        } else {
            b = (at, found);
            a.1 *= if kept == -1 { 0.5 } else { 1.0 };
            kept = -1;
        }
    }
    0.5 * (a.0 + b.0)
}
