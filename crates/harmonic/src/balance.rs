//! The equations of harmonic balance and their derivatives.

mod damped_forces;
mod friction_loop;
mod opening;
mod port_motion;
#[cfg(test)]
mod tests;

use asperity_structure::PreloadedContact;
use num_complex::Complex64;

use crate::fourier::{Fourier, amplitude_of};
use crate::{Compliance, ContactSystem, Dual, MeanBalance};
use damped_forces::DampedForces;
use friction_loop::{ContactForce, FEWEST_SAMPLES, FrictionLoop};
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
/// and for the means the structure's [`MeanBalance`], its rows scaled to closures. P is the series
/// of the contact forces at the samples of a period (alternating frequency-time), those of damped
/// contacts from closures and their rates. The compliance of
/// the structure without springs gives the same equations, but that of a light body at high
/// frequency is many times the result: rounding would leave `eps K_0 / (m w^2)` of it. The springs
/// have the contacts' stiffness at rest and a loss factor, so that nothing resonates on them.
#[derive(Debug, Clone)]
pub(crate) struct Balance<'a> {
    system: &'a ContactSystem,
    fourier: Fourier,
    mean: MeanBalance,
    compliances: Vec<Compliance>,
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

impl<'a> Balance<'a> {
    pub(crate) fn new(system: &'a ContactSystem, harmonics: usize, samples: usize) -> Self {
        let n = system.pairs();
        let least = if system.friction().is_some() { FEWEST_SAMPLES } else { 0 };
        let samples = samples.max(least);
        let fourier = Fourier::new(harmonics, samples);
        let terms = fourier.terms();
        let mut mean = system.linear().mean_balance(system.ports());
        // A row without closures balances forces: over the contacts' stiffness it is a closure.
        let stiffest = system.contacts().iter().map(PreloadedContact::spring).fold(0.0, f64::max);
        for row in 0..n {
            let range = row * n..(row + 1) * n;
            if mean.closure[range.clone()].iter().all(|&a| a == 0.0) {
                mean.force[range].iter_mut().for_each(|b| *b /= stiffest);
            }
        }
        Self {
            system,
            mean,
            compliances: vec![Compliance::zero(n, 1); harmonics],
            at: (f64::NAN, f64::NAN),
            closure_samples: vec![0.0; samples * n],
            force_samples: vec![0.0; samples * n],
            tangent_samples: vec![0.0; samples * n],
            tangent_series: vec![0.0; 2 * terms - 1],
            springs: springs(system, SPRING_LOSS),
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
        if self.at != found {
            for (k, compliance) in (1..).map(f64::from).zip(&mut self.compliances) {
                let (linear, load) = (self.system.linear(), self.system.load());
                linear.compliance((k * found.0, found.1), load, &self.springs, compliance);
            }
            self.at = found;
        }
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
            let force = &mut self.forces[i * terms..(i + 1) * terms];
            let product = &mut self.products[i * square..(i + 1) * square];
            // The springs are part of the structure.
            let Complex64 { re: elastic, im: loss } = self.springs[i];
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
        Ok(())
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
        let (n, terms) = (self.system.pairs(), self.fourier.terms());
        for i in 0..n {
            out[i * terms] = (0..n)
                .map(|j| {
                    self.mean.closure[i * n + j] * x[j * terms]
                        + self.mean.force[i * n + j] * self.forces[j * terms]
                })
                .sum();
            for k in 1..=self.fourier.harmonics() {
                let place = (&self.compliances[k - 1], i, k);
                let r = self.linear_part(place, at.force, |receptance| receptance.value);
                out[i * terms + 2 * k - 1] = x[i * terms + 2 * k - 1] + r.re;
                out[i * terms + 2 * k] = x[i * terms + 2 * k] - r.im;
            }
        }
    }

    /// `G_k P_k - g_k F_k` of one pair, or of a port after the pairs, or the same of a derivative of G and
    /// g, with `F_1 = force`.
    fn linear_part(
        &self,
        (compliance, row, k): (&Compliance, usize, usize),
        force: f64,
        of: impl Fn(&Dual) -> Complex64,
    ) -> Complex64 {
        let forces = (&self.forces[..], self.fourier.terms());
        let load = if k == 1 { force } else { 0.0 };
        under_forces((compliance, row, k), forces, &of)
            - of(compliance.get(row, compliance.pairs())) * load
    }

    /// Writes the derivative of the residual with respect to the closures into the upper left of a
    /// matrix whose rows are `stride` long.
    pub(crate) fn d_residual_d_closures(&self, stride: usize, out: &mut [f64]) {
        let (n, terms) = (self.system.pairs(), self.fourier.terms());
        let square = terms * terms;
        for i in 0..n {
            for j in 0..n {
                let product = &self.products[j * square..(j + 1) * square];
                let start = i * terms * stride + j * terms;
                self.write_block((i, j), product, &mut out[start..], stride, |to, value| {
                    *to = value;
                });
                out[start] += self.mean.closure[i * n + j];
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
                self.write_block((i, friction.pair), by_contact, block, stride, |to, value| {
                    *to += value;
                });
            }
        }
    }

    /// Puts the rows of pair `i` under the derivatives `product` of the force of pair `j` into the
    /// leading columns of `out`.
    #[inline]
    fn write_block(
        &self,
        (i, j): (usize, usize),
        product: &[f64],
        out: &mut [f64],
        stride: usize,
        put: impl Fn(&mut f64, f64),
    ) {
        let terms = self.fourier.terms();
        let factor = self.mean.force[i * self.system.pairs() + j];
        for (to, p) in out[..terms].iter_mut().zip(product) {
            put(to, factor * p);
        }
        for k in 1..=self.fourier.harmonics() {
            let g = self.compliances[k - 1].get(i, j).value;
            let (cos, sin) = product[(2 * k - 1) * terms..].split_at(terms);
            let (first, second) = out[(2 * k - 1) * stride..].split_at_mut(stride);
            let targets = first[..terms].iter_mut().zip(&mut second[..terms]);
            for ((a, b), (c, s)) in targets.zip(cos.iter().zip(sin)) {
                put(a, g.re * c + g.im * s);
                put(b, g.re * s - g.im * c);
            }
        }
    }

    /// Derivative of the residual with respect to the angular frequency of the fundamental.
    pub(crate) fn d_residual_d_frequency(&self, at: &Conditions, out: &mut [f64]) {
        self.d_residual_d_condition(at, out, |k| k as f64, |receptance| receptance.d_frequency);
        let Some(damped) = &self.damped else { return };
        let (n, terms) = (self.system.pairs(), self.fourier.terms());
        for (i, out) in out.chunks_exact_mut(terms).enumerate() {
            let means = damped.d_frequency.iter().step_by(terms);
            out[0] +=
                self.mean.force[i * n..][..n].iter().zip(means).map(|(b, p)| b * p).sum::<f64>();
            for k in 1..=self.fourier.harmonics() {
                let (place, slopes) = ((&self.compliances[k - 1], i, k), &damped.d_frequency);
                let r = under_forces(place, (slopes, terms), |receptance| receptance.value);
                out[2 * k - 1] += r.re;
                out[2 * k] -= r.im;
            }
        }
    }

    /// Derivative of the residual with respect to the anti-damping rate.
    pub(crate) fn d_residual_d_anti_damping(&self, at: &Conditions, out: &mut [f64]) {
        self.d_residual_d_condition(at, out, |_| 1.0, |receptance| receptance.d_anti_damping);
    }

    fn d_residual_d_condition(
        &self,
        at: &Conditions,
        out: &mut [f64],
        factor: impl Fn(usize) -> f64,
        of: impl Fn(&Dual) -> Complex64,
    ) {
        let terms = self.fourier.terms();
        for i in 0..self.system.pairs() {
            out[i * terms] = 0.0;
            for k in 1..=self.fourier.harmonics() {
                let place = (&self.compliances[k - 1], i, k);
                let r = self.linear_part(place, at.force, &of) * factor(k);
                out[i * terms + 2 * k - 1] = r.re;
                out[i * terms + 2 * k] = -r.im;
            }
        }
    }

    /// Derivative of the residual with respect to the force amplitude.
    pub(crate) fn d_residual_d_force(&self, out: &mut [f64]) {
        out.fill(0.0);
        let terms = self.fourier.terms();
        if let Some(compliance) = self.compliances.first() {
            for i in 0..self.system.pairs() {
                let g = compliance.get(i, compliance.pairs()).value;
                out[i * terms + 1] = -g.re;
                out[i * terms + 2] = g.im;
            }
        }
    }

    /// `|u^T M u| / |U_1|^2` of the fundamental motion [kg]. The derivative of a receptance with
    /// respect to the anti-damping rate is `i w` times that product of the fields of its two forces.
    pub(crate) fn modal_mass(&self, at: &Conditions, amplitude: f64) -> f64 {
        let (n, terms) = (self.system.pairs(), self.fourier.terms());
        let compliance = &self.compliances[0];
        // The load acts against contact forces.
        let force = |j: usize| {
            if j < n { amplitude_of(&self.forces[j * terms..], 1) } else { (-at.force).into() }
        };
        let mut sum = Complex64::ZERO;
        for i in 0..=n {
            for j in 0..=n {
                sum += compliance.get(i, j).d_anti_damping * force(i) * force(j);
            }
        }
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
        let mut compliance = Compliance::zero(n, 0);
        let springs = springs(self.system, 0.0);
        let mut series = vec![0.0; n * (2 * terms - 1)];
        for (i, series) in series.chunks_exact_mut(2 * terms - 1).enumerate() {
            self.fourier.analyse(self.samples_of(&self.force_samples, i), series);
        }
        let mut omitted = 0.0_f64;
        for k in self.fourier.harmonics() + 1..=2 * self.fourier.harmonics() {
            let w = k as f64 * self.at.0;
            let linear = self.system.linear();
            linear.compliance((w, self.at.1), &[], &springs, &mut compliance);
            for i in 0..n {
                let forces = (&series[..], 2 * terms - 1);
                let closure = under_forces((&compliance, i, k), forces, |found| found.value);
                omitted = omitted.max(closure.norm_sqr());
            }
        }
        if largest > 0.0 { omitted.sqrt() / largest } else { 0.0 }
    }
}

/// `sum_j G_aj P_j` of one pair or port a at harmonic k, P being series of so many terms.
fn under_forces(
    (compliance, row, k): (&Compliance, usize, usize),
    (forces, terms): (&[f64], usize),
    of: impl Fn(&Dual) -> Complex64,
) -> Complex64 {
    let own = |(j, series)| of(compliance.get(row, j)) * amplitude_of(series, k);
    forces.chunks_exact(terms).enumerate().map(own).sum()
}

/// The contacts' stiffnesses at rest \[N/m\], with a loss factor; guides have none.
fn springs(system: &ContactSystem, loss: f64) -> Vec<Complex64> {
    let spring = |contact: &PreloadedContact| contact.spring() * Complex64::new(1.0, loss);
    let mut all: Vec<Complex64> = system.contacts().iter().map(spring).collect();
    all.resize(system.pairs(), Complex64::ZERO);
    all
}
