//! Displacements of the load's port and of sensors.

use num_complex::Complex64;

use super::{Balance, Conditions, under_forces};
use crate::{Compliance, PortMotion};

impl Balance<'_> {
    /// Complex amplitude of harmonic k >= 1 of the displacement of the load's port [m].
    pub(crate) fn load_displacement(&self, k: usize, at: &Conditions) -> Complex64 {
        let place = (&self.compliances[k - 1], self.system.pairs(), k);
        -self.linear_part(place, at.force, |receptance| receptance.value)
    }

    /// Mean displacement of a port from rest [m]: of the load, and after it those of the sensors.
    fn mean_displacement(&self, x: &[f64], port: usize) -> f64 {
        let (terms, pairs) = (self.fourier.terms(), self.system.pairs());
        let row = port * pairs;
        (0..pairs)
            .map(|j| {
                self.mean.port_closure[row + j] * x[j * terms]
                    + self.mean.port_force[row + j] * self.forces[j * terms]
            })
            .sum()
    }

    /// Motions of the load's port and of the sensors, linear in the closures and forces of the motion last
    /// evaluated.
    pub(crate) fn motions(&self, x: &[f64], at: &Conditions) -> Vec<PortMotion> {
        let (ports, pairs) = (self.system.ports(), self.system.pairs());
        let count = self.compliances.len();
        let mut motions = vec![PortMotion {
            angular_frequency: at.angular_frequency,
            mean: self.mean_displacement(x, 0),
            harmonics: (1..=count).map(|k| self.load_displacement(k, at)).collect(),
        }];
        if ports.iter().all(|port| *port == ports[0]) {
            return vec![motions.remove(0); ports.len()];
        }
        let mut wide = Compliance::zero(pairs, ports.len());
        motions.extend((1..ports.len()).map(|port| PortMotion {
            angular_frequency: at.angular_frequency,
            mean: self.mean_displacement(x, port),
            harmonics: Vec::with_capacity(count),
        }));
        for k in 1..=count {
            let at_harmonic = (k as f64 * at.angular_frequency, at.anti_damping);
            self.system.linear().compliance(at_harmonic, ports, &self.springs, &mut wide);
            for (port, motion) in motions.iter_mut().enumerate().skip(1) {
                let place = (&wide, pairs + port, k);
                let found = -self.linear_part(place, at.force, |receptance| receptance.value);
                motion.harmonics.push(found);
            }
        }
        motions
    }

    /// Derivatives of the fundamental displacement of the load's port with respect to the closures: real
    /// and imaginary parts.
    pub(crate) fn d_displacement_d_closures(&self, real: &mut [f64], imaginary: &mut [f64]) {
        let (terms, load) = (self.fourier.terms(), self.system.pairs());
        let square = terms * terms;
        for j in 0..self.system.pairs() {
            let g = self.compliances[0].get(load, j).value;
            let (cos, sin) = self.products[j * square + terms..].split_at(terms);
            for c in 0..terms {
                real[j * terms + c] = -(g.re * cos[c] + g.im * sin[c]);
                imaginary[j * terms + c] = g.re * sin[c] - g.im * cos[c];
            }
        }
        for friction in self.loops.iter().filter(|friction| friction.pair != friction.contact) {
            let g = self.compliances[0].get(load, friction.pair).value;
            let (cos, sin) = friction.by_contact[terms..].split_at(terms);
            for (c, column) in (friction.contact * terms..).take(terms).enumerate() {
                real[column] -= g.re * cos[c] + g.im * sin[c];
                imaginary[column] += g.re * sin[c] - g.im * cos[c];
            }
        }
    }

    /// Derivatives of the fundamental displacement of the load's port with respect to angular frequency,
    /// anti-damping rate and force.
    pub(crate) fn d_displacement_d_conditions(&self, at: &Conditions) -> [Complex64; 3] {
        let (terms, load) = (self.fourier.terms(), self.system.pairs());
        let place = (&self.compliances[0], load, 1);
        let damped = self.damped.as_ref().map_or(Complex64::ZERO, |damped| {
            under_forces(place, (&damped.d_frequency, terms), |receptance| receptance.value)
        });
        [
            -self.linear_part(place, at.force, |receptance| receptance.d_frequency) - damped,
            -self.linear_part(place, at.force, |receptance| receptance.d_anti_damping),
            self.compliances[0].get(load, load).value,
        ]
    }
}
