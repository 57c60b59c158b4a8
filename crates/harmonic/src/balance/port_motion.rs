//! Displacements of the load's port and of sensors.

use num_complex::Complex64;

use super::{Balance, Conditions, Receptances};
use crate::PortMotion;
use crate::dual::Part;
use crate::fourier::amplitude_of;

impl Balance<'_> {
    /// Complex amplitude of harmonic k >= 1 of the displacement of the load's port [m].
    pub(crate) fn load_displacement(&self, k: usize, at: &Conditions) -> Complex64 {
        match &self.linear {
            Receptances::Dense(linear) => {
                let place = (self.system.pairs(), k);
                -linear.at_place(place, Part::Value, (&self.forces, at.force))
            }
            Receptances::Modal(_) => {
                amplitude_of(&self.port_series(0..1, Part::Value, (&self.forces, at.force)), k)
            }
        }
    }

    /// Series of the displacements of ports under forces of the contacts and a load, in modes; of no other form.
    fn port_series(
        &self,
        ports: std::ops::Range<usize>,
        part: Part,
        forces: (&[f64], f64),
    ) -> Vec<f64> {
        let (pairs, terms) = (self.system.pairs(), self.fourier.terms());
        let mut series = vec![0.0; ports.len() * terms];
        if let Receptances::Modal(linear) = &self.linear {
            let places = pairs + ports.start..pairs + ports.end;
            linear.respond(places, part, forces, &mut series);
        }
        for u in &mut series {
            *u = -*u;
        }
        series
    }

    /// Motions of the load's port and of the sensors, linear in the closures and forces of the motion last
    /// evaluated.
    pub(crate) fn motions(&self, x: &[f64], at: &Conditions) -> Vec<PortMotion> {
        let ports = self.system.ports();
        let motion = |mean: f64, harmonics: Vec<Complex64>| PortMotion {
            angular_frequency: at.angular_frequency,
            mean,
            harmonics,
        };
        let forces = (&self.forces[..], at.force);
        let harmonics = 1..=self.fourier.harmonics();
        let linear = match &self.linear {
            Receptances::Dense(linear) => linear,
            Receptances::Modal(_) => {
                let series = self.port_series(0..ports.len(), Part::Value, forces);
                let of = |series: &[f64]| {
                    motion(series[0], harmonics.clone().map(|k| amplitude_of(series, k)).collect())
                };
                return series.chunks_exact(self.fourier.terms()).map(of).collect();
            }
        };
        let mean = |port: usize| linear.mean_displacement(x, &self.forces, port);
        let load = motion(mean(0), harmonics.map(|k| self.load_displacement(k, at)).collect());
        if ports.iter().all(|port| *port == ports[0]) {
            return vec![load; ports.len()];
        }
        let conditions = (at.angular_frequency, at.anti_damping);
        let sensors = linear.sensors(self.system, (conditions, &self.springs), forces);
        let sensors = (1..).zip(sensors).map(|(port, harmonics)| motion(mean(port), harmonics));
        std::iter::once(load).chain(sensors).collect()
    }

    /// Derivatives of the fundamental displacement of the load's port with respect to the closures: real
    /// and imaginary parts.
    pub(crate) fn d_displacement_d_closures(&self, real: &mut [f64], imaginary: &mut [f64]) {
        let terms = self.fourier.terms();
        let square = terms * terms;
        let row = self.load_row();
        for (j, g) in row[..self.system.pairs()].iter().enumerate() {
            let (cos, sin) = self.products[j * square + terms..].split_at(terms);
            for c in 0..terms {
                real[j * terms + c] = -(g.re * cos[c] + g.im * sin[c]);
                imaginary[j * terms + c] = g.re * sin[c] - g.im * cos[c];
            }
        }
        for friction in self.loops.iter().filter(|friction| friction.pair != friction.contact) {
            let g = row[friction.pair];
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
        let part = |part: Part, forces: (&[f64], f64)| match &self.linear {
            Receptances::Dense(linear) => -linear.at_place((self.system.pairs(), 1), part, forces),
            Receptances::Modal(_) => amplitude_of(&self.port_series(0..1, part, forces), 1),
        };
        let forces = (&self.forces[..], at.force);
        let damped = self
            .damped
            .as_ref()
            .map_or(Complex64::ZERO, |damped| part(Part::Value, (&damped.d_frequency, 0.0)));
        [
            part(Part::Frequency, forces) + damped,
            part(Part::AntiDamping, forces),
            self.load_row()[self.system.pairs()],
        ]
    }
}
