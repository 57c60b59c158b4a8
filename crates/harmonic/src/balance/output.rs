//! The displacement of the driving point.

use num_complex::Complex64;

use super::{Balance, Conditions};
use crate::Receptance;
use crate::fourier::amplitude_of;

impl Balance<'_> {
    /// Complex amplitude of harmonic k >= 1 of the driving point's displacement [m].
    pub(crate) fn output(&self, k: usize, at: &Conditions) -> Complex64 {
        self.output_of(k, at.force, |receptance| receptance.value)
    }

    fn output_of(&self, k: usize, force: f64, of: impl Fn(&Receptance) -> Complex64) -> Complex64 {
        let terms = self.fourier.terms();
        let compliance = &self.compliances[k - 1];
        let contact: Complex64 = (0..self.system.pairs())
            .map(|j| of(compliance.drive(j)) * amplitude_of(&self.forces[j * terms..][..terms], k))
            .sum();
        let drive = if k == 1 { force } else { 0.0 };
        of(&compliance.direct) * drive - contact
    }

    /// Mean displacement of the driving point from rest [m].
    pub(crate) fn mean_output(&self, x: &[f64]) -> f64 {
        let terms = self.fourier.terms();
        (0..self.system.pairs())
            .map(|j| {
                self.mean.output_closure[j] * x[j * terms]
                    + self.mean.output_force[j] * self.forces[j * terms]
            })
            .sum()
    }

    /// Derivatives of the fundamental output with respect to the closures: real and imaginary parts.
    pub(crate) fn d_output_d_closures(&self, real: &mut [f64], imaginary: &mut [f64]) {
        let terms = self.fourier.terms();
        let square = terms * terms;
        for j in 0..self.system.pairs() {
            let g = self.compliances[0].drive(j).value;
            let (cos, sin) = self.products[j * square + terms..].split_at(terms);
            for c in 0..terms {
                real[j * terms + c] = -(g.re * cos[c] + g.im * sin[c]);
                imaginary[j * terms + c] = g.re * sin[c] - g.im * cos[c];
            }
        }
        for friction in self.loops.iter().filter(|friction| friction.pair != friction.contact) {
            let g = self.compliances[0].drive(friction.pair).value;
            let (cos, sin) = friction.by_contact[terms..].split_at(terms);
            for (c, column) in (friction.contact * terms..).take(terms).enumerate() {
                real[column] -= g.re * cos[c] + g.im * sin[c];
                imaginary[column] += g.re * sin[c] - g.im * cos[c];
            }
        }
    }

    /// Derivatives of the fundamental output with respect to angular frequency, anti-damping rate and
    /// force.
    pub(crate) fn d_output_d_conditions(&self, at: &Conditions) -> [Complex64; 3] {
        let terms = self.fourier.terms();
        let damped = self.damped.as_ref().map_or(Complex64::ZERO, |damped| {
            let of = |(j, series): (usize, &[f64])| {
                self.compliances[0].drive(j).value * amplitude_of(series, 1)
            };
            damped.d_frequency.chunks_exact(terms).enumerate().map(of).sum()
        });
        [
            self.output_of(1, at.force, |receptance| receptance.d_frequency) - damped,
            self.output_of(1, at.force, |receptance| receptance.d_anti_damping),
            self.compliances[0].direct.value,
        ]
    }
}
