//! The equations of harmonic balance and their derivatives.

mod damped_forces;
mod dense_receptances;
mod friction_loop;
mod modal_receptances;
mod opening;
mod port_motion;
#[cfg(test)]
mod tests;

use asperity_structure::PreloadedContact;
use num_complex::Complex64;

use crate::ContactSystem;
use crate::dual::Part;
use crate::factorization::dot;
use crate::fourier::Fourier;
use damped_forces::DampedForces;
use dense_receptances::DenseReceptances;
use friction_loop::{ContactForce, FEWEST_SAMPLES, FrictionLoop};
use modal_receptances::ModalReceptances;
use opening::Opening;

/// Frequency, anti-damping and force of a periodic motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Conditions {
    /// Angular frequency of the fundamental [rad/s].
    pub(crate) angular_frequency: f64,
    /// Anti-damping rate [1/s].
    pub(crate) anti_damping: f64,
    /// Amplitude F of the load `F cos(w t)`, of a force [N].
    pub(crate) force: f64,
}

/// Loss factor of the springs that stand for the contacts in the compliance.
const SPRING_LOSS: f64 = 0.5;

/// An interface whose law gave no finite force at a closure increment [m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Overflow {
    pub(crate) interface: usize,
    pub(crate) closure: f64,
}

/// Residual of harmonic balance over the closures' series, interface after interface.
///
/// For harmonic k >= 1, with the compliance at k w of the structure on springs `K_0`,
///
/// ```text
/// R_k = X_k + G_k (P_k - K_0 X_k) - g_k F_k,    F_1 = F, other F_k = 0,
/// ```
///
/// and for the means the structure's [`MeanBalance`](crate::MeanBalance), its rows scaled to closures. P is the series
/// of the contact forces at the samples of a period (alternating frequency-time), those of damped
/// contacts from closures and their rates. The compliance of
/// the structure without springs gives the same equations, but that of a light body at high
/// frequency is many times the result: rounding would leave `eps K_0 / (m w^2)` of it. The springs
/// have the contacts' stiffness at rest and a loss factor, so that nothing resonates on them.
///
/// With [many contacts](Self::of_many) the springs are real and follow the mean tangents of the motion, and the means
/// are harmonic 0 of the same equations. The derivative of the residual is then near the unit matrix where the
/// tangents change little within the period.
#[derive(Debug)]
pub(crate) struct Balance<'a> {
    system: &'a ContactSystem,
    fourier: Fourier,
    linear: Receptances,
    at: (f64, f64),
    closure_samples: Vec<f64>,
    force_samples: Vec<f64>,
    tangent_samples: Vec<f64>,
    tangent_series: Vec<f64>,
    springs: Vec<Complex64>,
    /// `P_0`, then `P_k - K_0 X_k`, of each interface.
    forces: Vec<f64>,
    /// Derivatives of the forces with respect to the closures.
    products: Vec<f64>,
    /// Of a system with damped contacts.
    damped: Option<DampedForces>,
    /// Of each friction element.
    loops: Vec<FrictionLoop>,
    /// Of each contact.
    openings: Vec<Option<Opening>>,
}

/// The linear structure.
#[derive(Debug)]
enum Receptances {
    Dense(DenseReceptances),
    Modal(Box<ModalReceptances>),
}

impl<'a> Balance<'a> {
    /// The equations with matrices of the contacts, which [`d_residual_d_closures`](Self::d_residual_d_closures) needs.
    pub(crate) fn new(system: &'a ContactSystem, harmonics: usize, samples: usize) -> Self {
        let stiffest = system.contacts().iter().map(PreloadedContact::spring).fold(0.0, f64::max);
        let linear = DenseReceptances::new(system, harmonics, stiffest);
        let springs = springs(system, SPRING_LOSS);
        Self::with(system, (harmonics, samples), Receptances::Dense(linear), springs)
    }

    /// The equations of many contacts, whose derivatives are products alone; none for a structure that is not given by
    /// component modes or has friction. The springs are the contacts' mean tangents times a factor, one but for free
    /// motions: on the mean tangents themselves the structure is at resonance there.
    pub(crate) fn of_many(
        system: &'a ContactSystem,
        (harmonics, samples): (usize, usize),
        factor: f64,
    ) -> Option<Self> {
        if !system.is_modal() {
            return None;
        }
        let at_rest: Vec<f64> =
            system.contacts().iter().map(|contact| factor * contact.spring()).collect();
        let linear = ModalReceptances::new(system, harmonics, (&at_rest, factor))?;
        let springs = at_rest.into_iter().map(Complex64::from).collect();
        let linear = Receptances::Modal(Box::new(linear));
        Some(Self::with(system, (harmonics, samples), linear, springs))
    }

    fn with(
        system: &'a ContactSystem,
        (harmonics, samples): (usize, usize),
        linear: Receptances,
        springs: Vec<Complex64>,
    ) -> Self {
        let n = system.pairs();
        let least = if system.friction().is_some() { FEWEST_SAMPLES } else { 0 };
        let samples = samples.max(least);
        let fourier = Fourier::new(harmonics, samples);
        let terms = fourier.terms();
        Self {
            system,
            linear,
            at: (f64::NAN, f64::NAN),
            closure_samples: vec![0.0; samples * n],
            force_samples: vec![0.0; samples * n],
            tangent_samples: vec![0.0; samples * n],
            tangent_series: vec![0.0; 2 * terms - 1],
            springs,
            forces: vec![0.0; terms * n],
            products: vec![0.0; terms * terms * n],
            damped: system.is_damped().then(|| DampedForces::new(&fourier, n)),
            loops: system
                .friction_elements()
                .map(|(friction, pair, contact)| {
                    FrictionLoop::new(friction, pair, contact, &fourier)
                })
                .collect(),
            openings: system.contacts().iter().map(|one| Opening::of(one, &fourier)).collect(),
            fourier,
        }
    }

    /// True for equations of many contacts.
    pub(crate) fn is_of_many(&self) -> bool {
        matches!(self.linear, Receptances::Modal(_))
    }

    pub(crate) fn system(&self) -> &'a ContactSystem {
        self.system
    }

    pub(crate) fn fourier(&self) -> &Fourier {
        &self.fourier
    }

    /// Number of unknowns, `interfaces (2 H + 1)`.
    pub(crate) fn unknowns(&self) -> usize {
        self.forces.len()
    }

    /// Evaluates compliances, contact forces, and their derivatives with respect to the closures.
    pub(crate) fn evaluate(&mut self, x: &[f64], at: &Conditions) -> Result<(), Overflow> {
        let found = (at.angular_frequency, at.anti_damping);
        if let Receptances::Dense(linear) = &mut self.linear
            && self.at != found
        {
            linear.update(self.system, found, &self.springs);
        }
        self.at = found;
        let (terms, samples) = (self.fourier.terms(), self.fourier.samples());
        for i in 0..self.system.contacts().len() {
            let series = &x[i * terms..(i + 1) * terms];
            let range = i * samples..(i + 1) * samples;
            let closures = &mut self.closure_samples[range.clone()];
            let force_samples = &mut self.force_samples[range.clone()];
            let tangents = &mut self.tangent_samples[range];
            self.fourier.synthesise(series, closures);
            if let Some(damped) = &mut self.damped {
                damped.sample_rates(&self.fourier, series, found.0);
                let DampedForces { rates, dampers, .. } = damped;
                let found = (&mut *force_samples, &mut *tangents, &mut dampers[..]);
                self.system.damped_forces(i, (closures, rates), found);
            } else {
                self.system.forces(i, closures, force_samples, tangents);
            }
            let force = &mut self.forces[i * terms..(i + 1) * terms];
            if let Some(opening) = &mut self.openings[i]
                && opening.find(series, closures)
            {
                let found = (&mut *force, &mut self.tangent_series[..]);
                opening.integrate((self.system, i), series, samples, found);
            } else {
                self.fourier.analyse(force_samples, force);
                self.fourier.analyse(tangents, &mut self.tangent_series);
            }
            let finite = |series: &[f64]| series.iter().all(|value| value.is_finite());
            if !(finite(force) && finite(&self.tangent_series)) {
                let worst = |&(_, f): &(&f64, &f64)| !f.is_finite();
                let found = closures.iter().zip(&*force_samples).find(worst);
                let closure = found.map_or(f64::NAN, |(x, _)| *x);
                return Err(Overflow { interface: i, closure });
            }
            let square = terms * terms;
            let product = &mut self.products[i * square..(i + 1) * square];
            self.fourier.product(&self.tangent_series, product);
            if let Some(damped) = &mut self.damped
                && !damped.differentiate(&self.fourier, i, found.0, product)
            {
                return Err(Overflow { interface: i, closure: f64::NAN });
            }
            self.evaluate_friction(x, i, found.0);
        }
        if let Receptances::Modal(linear) = &mut self.linear {
            let tangents = self.products.iter().step_by(terms * terms);
            linear.follow(tangents.copied());
            linear.update(found);
            for (spring, k) in self.springs.iter_mut().zip(linear.springs()) {
                *spring = Complex64::from(*k);
            }
        }
        self.subtract_springs(x);
        Ok(())
    }

    /// Takes the springs, which are part of the structure, from the forces.
    fn subtract_springs(&mut self, x: &[f64]) {
        let terms = self.fourier.terms();
        let has_means = self.is_of_many();
        let contacts =
            self.springs.iter().take(self.system.contacts().len()).zip(x.chunks_exact(terms));
        let forces = self.forces.chunks_exact_mut(terms);
        let products = self.products.chunks_exact_mut(terms * terms);
        for (((spring, series), force), product) in contacts.zip(forces).zip(products) {
            let Complex64 { re: elastic, im: loss } = *spring;
            if has_means {
                force[0] -= elastic * series[0];
                product[0] -= elastic;
            }
            for k in 1..=self.fourier.harmonics() {
                let (cos, sin) = (2 * k - 1, 2 * k);
                force[cos] -= elastic * series[cos] + loss * series[sin];
                force[sin] -= elastic * series[sin] - loss * series[cos];
                product[cos * terms + cos] -= elastic;
                product[cos * terms + sin] -= loss;
                product[sin * terms + cos] += loss;
                product[sin * terms + sin] -= elastic;
            }
        }
    }

    /// Adds the friction that contact `i` bounds.
    fn evaluate_friction(&mut self, x: &[f64], i: usize, w: f64) {
        let (terms, samples) = (self.fourier.terms(), self.fourier.samples());
        let of = |pair: usize, length: usize| pair * length..(pair + 1) * length;
        let contact = &self.system.contacts()[i];
        let damped = self.damped.as_ref();
        for friction in self.loops.iter_mut().filter(|friction| friction.contact == i) {
            let pair = friction.pair;
            let closures = &mut self.closure_samples[of(pair, samples)];
            if pair != i {
                self.fourier.synthesise(&x[of(pair, terms)], closures);
            }
            let force = ContactForce {
                at_rest: contact.area() * contact.pressure(),
                increments: &self.force_samples[of(i, samples)],
                tangents: &self.tangent_samples[of(i, samples)],
                damping: damped.map(|damped| (&damped.dampers[..], &damped.rates[..])),
            };
            friction.follow(&self.fourier, closures, force, w);
        }
        // Only then: a limit is one of the contact's force alone.
        for friction in self.loops.iter_mut().filter(|friction| friction.contact == i) {
            let pair = friction.pair;
            let series = &mut self.forces[of(pair, terms)];
            let product = &mut self.products[of(pair, terms * terms)];
            let force_samples = &mut self.force_samples[of(pair, samples)];
            let mut by_frequency =
                self.damped.as_mut().map(|damped| &mut damped.d_frequency[of(pair, terms)]);
            if pair != i {
                // A guide has no other force.
                series.fill(0.0);
                product.fill(0.0);
                force_samples.fill(0.0);
                if let Some(slopes) = &mut by_frequency {
                    slopes.fill(0.0);
                }
            }
            friction.add_to(&self.fourier, (series, force_samples), product, by_frequency);
        }
    }

    /// The residual of the motion last evaluated.
    pub(crate) fn residual(&self, x: &[f64], at: &Conditions, out: &mut [f64]) {
        self.linear_residual(x, (&self.forces, at.force), out);
    }

    /// The residual under other forces of the contacts, and a load.
    fn linear_residual(&self, x: &[f64], forces: (&[f64], f64), out: &mut [f64]) {
        match &self.linear {
            Receptances::Dense(linear) => linear.residual(x, forces, out),
            Receptances::Modal(linear) => linear.residual(x, forces, out),
        }
    }

    /// The derivative of the residual along a change `y` of the closures.
    pub(crate) fn d_residual_along(&self, y: &[f64], out: &mut [f64]) {
        let terms = self.fourier.terms();
        let mut forces = vec![0.0; y.len()];
        let products = self.products.chunks_exact(terms * terms);
        for ((force, product), y) in
            forces.chunks_exact_mut(terms).zip(products).zip(y.chunks_exact(terms))
        {
            for (f, row) in force.iter_mut().zip(product.chunks_exact(terms)) {
                *f = dot(row, y);
            }
        }
        for friction in self.loops.iter().filter(|friction| friction.pair != friction.contact) {
            let y = &y[friction.contact * terms..][..terms];
            let force = &mut forces[friction.pair * terms..][..terms];
            for (f, row) in force.iter_mut().zip(friction.by_contact.chunks_exact(terms)) {
                *f += dot(row, y);
            }
        }
        self.linear_residual(y, (&forces, 0.0), out);
    }

    /// Writes the derivative of the residual with respect to the closures into the upper left of a
    /// matrix whose rows are `stride` long. Equations of many contacts have no such matrix: nothing is written.
    pub(crate) fn d_residual_d_closures(&self, stride: usize, out: &mut [f64]) {
        let Receptances::Dense(linear) = &self.linear else { return };
        let (n, terms) = (self.system.pairs(), self.fourier.terms());
        let square = terms * terms;
        for i in 0..n {
            for j in 0..n {
                let product = &self.products[j * square..(j + 1) * square];
                let start = i * terms * stride + j * terms;
                linear.write_block((i, j), product, &mut out[start..], stride, |to, value| {
                    *to = value;
                });
                out[start] += linear.mean_closure(i, j);
                if i == j {
                    (1..terms).for_each(|term| out[start + term * (stride + 1)] += 1.0);
                }
            }
        }
        // Friction in a guide, bounded by the force of a contact.
        for friction in self.loops.iter().filter(|friction| friction.pair != friction.contact) {
            for i in 0..n {
                let block = &mut out[i * terms * stride + friction.contact * terms..];
                let by_contact = &friction.by_contact;
                linear.write_block((i, friction.pair), by_contact, block, stride, |to, value| {
                    *to += value;
                });
            }
        }
    }

    /// Derivative of the residual with respect to the angular frequency of the fundamental.
    pub(crate) fn d_residual_d_frequency(&self, at: &Conditions, out: &mut [f64]) {
        self.d_residual_d_condition(at, Part::Frequency, out);
        let terms = self.fourier.terms();
        for series in out.chunks_exact_mut(terms) {
            for (k, pair) in (1..).map(f64::from).zip(series[1..].chunks_exact_mut(2)) {
                for slope in pair {
                    *slope *= k;
                }
            }
        }
        let Some(damped) = &self.damped else { return };
        let (nothing, mut more) = (vec![0.0; out.len()], vec![0.0; out.len()]);
        self.linear_residual(&nothing, (&damped.d_frequency, 0.0), &mut more);
        out.iter_mut().zip(more).for_each(|(slope, more)| *slope += more);
    }

    /// Derivative of the residual with respect to the anti-damping rate.
    pub(crate) fn d_residual_d_anti_damping(&self, at: &Conditions, out: &mut [f64]) {
        self.d_residual_d_condition(at, Part::AntiDamping, out);
    }

    fn d_residual_d_condition(&self, at: &Conditions, part: Part, out: &mut [f64]) {
        let forces = (&self.forces[..], at.force);
        match &self.linear {
            Receptances::Dense(linear) => linear.slope(part, forces, out),
            Receptances::Modal(linear) => {
                linear.respond(0..self.system.pairs(), part, forces, out);
            }
        }
    }

    /// Derivative of the residual with respect to the force amplitude.
    pub(crate) fn d_residual_d_force(&self, out: &mut [f64]) {
        out.fill(0.0);
        let row = self.load_row();
        for (series, g) in out.chunks_exact_mut(self.fourier.terms()).zip(row) {
            (series[1], series[2]) = (-g.re, g.im);
        }
    }

    /// Receptances between the load and each pair at the fundamental.
    fn load_row(&self) -> Vec<Complex64> {
        let load = self.system.pairs();
        match &self.linear {
            Receptances::Dense(linear) => {
                (0..=load).map(|j| linear.get(1, load, j).value).collect()
            }
            Receptances::Modal(linear) => linear.load_row(),
        }
    }

    /// `|u^T M u| / |U_1|^2` of the fundamental motion [kg]. The derivative of a receptance with
    /// respect to the anti-damping rate is `i w` times that product of the fields of its two forces.
    pub(crate) fn modal_mass(&self, at: &Conditions, amplitude: f64) -> f64 {
        // The load acts against contact forces.
        let forces = (&self.forces[..], at.force);
        let sum = match &self.linear {
            Receptances::Dense(linear) => linear.inertia(forces),
            Receptances::Modal(linear) => linear.inertia(forces),
        };
        sum.norm() / (at.angular_frequency * amplitude * amplitude)
    }

    /// Closure increments [m] of one interface at the samples.
    pub(crate) fn closures(&self, interface: usize) -> &[f64] {
        self.samples_of(&self.closure_samples, interface)
    }

    fn samples_of<'s>(&self, all: &'s [f64], interface: usize) -> &'s [f64] {
        let samples = self.fourier.samples();
        &all[interface * samples..(interface + 1) * samples]
    }

    /// Largest harmonic of the closures that was left out, H < k <= 2 H, over the largest kept:
    /// `G_k P_k` with the forces of the motion last evaluated, on springs without loss.
    pub(crate) fn truncation(&self, x: &[f64]) -> f64 {
        let (n, terms) = (self.system.pairs(), self.fourier.terms());
        let largest = x.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let mut series = vec![0.0; n * (2 * terms - 1)];
        for (i, series) in series.chunks_exact_mut(2 * terms - 1).enumerate() {
            self.fourier.analyse(self.samples_of(&self.force_samples, i), series);
        }
        let omitted = match &self.linear {
            Receptances::Dense(linear) => {
                linear.omitted(self.system, self.at, &springs(self.system, 0.0), &series)
            }
            Receptances::Modal(linear) => linear.omitted(&series),
        };
        if largest > 0.0 { omitted.sqrt() / largest } else { 0.0 }
    }
}

/// The contacts' stiffnesses at rest \[N/m\], with a loss factor; guides have none.
fn springs(system: &ContactSystem, loss: f64) -> Vec<Complex64> {
    let spring = |contact: &PreloadedContact| contact.spring() * Complex64::new(1.0, loss);
    let mut all: Vec<Complex64> = system.contacts().iter().map(spring).collect();
    all.resize(system.pairs(), Complex64::ZERO);
    all
}
