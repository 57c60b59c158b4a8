//! Friction elements at the samples of a period.

use asperity_law::Friction;

use crate::fourier::Fourier;

/// Samples of a period at least where there is friction: reversals between two samples cut the
/// loops by `(pi / samples)^2 / 2` of the amplitude at most.
pub(super) const FEWEST_SAMPLES: usize = 512;

/// The force of a friction element over a period, and its derivatives.
///
/// Over equal increments the element's force is a function of the force before, a clamp. Those of a
/// whole period, whose increments sum to zero, are together one clamp to an interval, so the second
/// period from any start is the periodic loop. It starts from the displacement without a force that
/// rest is. A motion that slips both ways has one loop; one that slips less has many, and this is that
/// reached from rest.
///
/// A slip, at sample s in direction `sigma`, fixes the force to `sigma R_s`; until the next the
/// force is `sigma R_s + k (x_n - x_s)`. The derivatives are those of these lines.
#[derive(Debug, Clone)]
pub(super) struct FrictionLoop {
    friction: Friction,
    /// Pair whose closure the element follows.
    pub(super) pair: usize,
    /// Contact whose force bounds it.
    pub(super) contact: usize,
    /// Forces at the samples \[N\].
    forces: Vec<f64>,
    /// Derivatives of the series of the force with respect to those of the pair's closure and of the
    /// contact's, and with respect to the angular frequency.
    by_pair: Vec<f64>,
    pub(super) by_contact: Vec<f64>,
    by_frequency: Vec<f64>,
    /// Stiffness at the samples, and slopes of the force with those of the contact.
    stiffness: Vec<f64>,
    slope: Vec<f64>,
    /// The forces between two slips: sum over their samples of each term of a series.
    between: Vec<f64>,
    scaled: Vec<f64>,
    series: Vec<f64>,
    product: Vec<f64>,
}

/// Force of a contact at the samples of a period.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactForce<'a> {
    /// At rest \[N\].
    pub(super) at_rest: f64,
    /// Increments from rest \[N\], and their derivatives with respect to closure \[N/m\].
    pub(super) increments: &'a [f64],
    pub(super) tangents: &'a [f64],
    /// Derivatives with respect to the rate of the closure \[N s/m\] with these rates \[m/s\], where
    /// the contact is damped.
    pub(super) damping: Option<(&'a [f64], &'a [f64])>,
}

/// A slip at a sample, in a direction of -1 or 1.
#[derive(Debug, Clone, Copy)]
struct SlipPlace {
    sample: usize,
    direction: f64,
}

impl FrictionLoop {
    pub(super) fn new(friction: Friction, pair: usize, contact: usize, fourier: &Fourier) -> Self {
        let (terms, samples) = (fourier.terms(), fourier.samples());
        Self {
            friction,
            pair,
            contact,
            forces: vec![0.0; samples],
            by_pair: vec![0.0; terms * terms],
            by_contact: vec![0.0; terms * terms],
            by_frequency: vec![0.0; terms],
            stiffness: vec![0.0; samples],
            slope: vec![0.0; samples],
            between: vec![0.0; terms],
            scaled: vec![0.0; samples],
            series: vec![0.0; 2 * terms - 1],
            product: vec![0.0; terms * terms],
        }
    }

    /// Follows the element along its pair's `closures` \[m\] over a period of angular frequency `w`
    /// \[rad/s\].
    pub(super) fn follow(
        &mut self,
        fourier: &Fourier,
        closures: &[f64],
        contact: ContactForce<'_>,
        w: f64,
    ) {
        for all in [&mut self.by_pair, &mut self.by_contact, &mut self.by_frequency] {
            all.fill(0.0);
        }
        self.between.fill(0.0);
        let (stiffness, share) = (self.friction.stiffness(), self.friction.share_of_contact());
        let (mut force, mut before, mut slip) = (0.0, 0.0, None);
        for recorded in [false, true] {
            for (n, &closure) in closures.iter().enumerate() {
                let carried = contact.at_rest + contact.increments[n];
                let limit = self.friction.limit(carried);
                let stuck = force + stiffness * (closure - before);
                force = self.friction.force(force, closure - before, limit);
                before = closure;
                let slips = stuck.abs() > limit;
                if slips {
                    if recorded {
                        self.end_of_loading(fourier, contact, slip, w);
                    }
                    slip = Some(SlipPlace { sample: n, direction: stuck.signum() });
                }
                if !recorded {
                    continue;
                }
                self.forces[n] = force;
                self.stiffness[n] = if slips { 0.0 } else { stiffness };
                let bounded = slips && carried > 0.0;
                self.slope[n] = if bounded { share * stuck.signum() } else { 0.0 };
                if !slips && slip.is_some() {
                    for (c, sum) in self.between.iter_mut().enumerate() {
                        *sum += fourier.row(c)[n];
                    }
                }
            }
        }
        self.end_of_loading(fourier, contact, slip, w);
        fourier.analyse(&self.stiffness, &mut self.series);
        fourier.product(&self.series, &mut self.product);
        add(&mut self.by_pair, &self.product);
        if share > 0.0 {
            self.differentiate_slip(fourier, contact, w);
        }
    }

    /// Numbers of samples at which the element slips, and is stuck.
    #[cfg(test)]
    pub(super) fn stages(&self) -> (usize, usize) {
        let stuck = self.stiffness.iter().filter(|stiffness| **stiffness > 0.0).count();
        (self.stiffness.len() - stuck, stuck)
    }

    /// Adds the loop to the series and the samples of its pair's force, to the derivative with the
    /// pair's closure, and to that with the frequency.
    pub(super) fn add_to(
        &mut self,
        fourier: &Fourier,
        (series, samples): (&mut [f64], &mut [f64]),
        product: &mut [f64],
        by_frequency: Option<&mut [f64]>,
    ) {
        let terms = fourier.terms();
        fourier.analyse(&self.forces, &mut self.series[..terms]);
        add(series, &self.series[..terms]);
        add(samples, &self.forces);
        add(product, &self.by_pair);
        if self.pair == self.contact {
            add(product, &self.by_contact);
        }
        if let Some(slopes) = by_frequency {
            add(slopes, &self.by_frequency);
        }
    }

    /// The part of the derivatives with the last `slip` in the forces since.
    fn end_of_loading(
        &mut self,
        fourier: &Fourier,
        contact: ContactForce<'_>,
        slip: Option<SlipPlace>,
        w: f64,
    ) {
        let Some(SlipPlace { sample, direction }) = slip else { return };
        let terms = fourier.terms();
        let carries = contact.at_rest + contact.increments[sample] > 0.0;
        let share = if carries { direction * self.friction.share_of_contact() } else { 0.0 };
        let tangent = share * contact.tangents[sample];
        let (damper, rate) =
            contact.damping.map_or((0.0, 0.0), |(dampers, rates)| (dampers[sample], rates[sample]));
        let damper = share * damper;
        for (row, sum) in self.between.iter_mut().enumerate() {
            let scale = if row == 0 { 1.0 } else { 2.0 } / fourier.samples() as f64;
            let sum = scale * std::mem::take(sum);
            if sum == 0.0 {
                continue;
            }
            let own = &mut self.by_pair[row * terms..(row + 1) * terms];
            let bound = &mut self.by_contact[row * terms..(row + 1) * terms];
            for (column, (own, bound)) in own.iter_mut().zip(bound).enumerate() {
                let shape = fourier.row(column)[sample];
                *own -= sum * self.friction.stiffness() * shape;
                *bound += sum * (tangent * shape + damper * fourier.rate(column, sample, w));
            }
            self.by_frequency[row] += sum * damper * rate / w;
        }
    }

    /// The derivatives of the forces while the element slips at a share of the contact's force.
    fn differentiate_slip(&mut self, fourier: &Fourier, contact: ContactForce<'_>, w: f64) {
        let terms = fourier.terms();
        let sampled = |scaled: &mut [f64], slope: &[f64], by: &[f64]| {
            for ((to, slope), by) in scaled.iter_mut().zip(slope).zip(by) {
                *to = slope * by;
            }
        };
        sampled(&mut self.scaled, &self.slope, contact.tangents);
        fourier.analyse(&self.scaled, &mut self.series);
        fourier.product(&self.series, &mut self.product);
        add(&mut self.by_contact, &self.product);
        let Some((dampers, rates)) = contact.damping else { return };
        sampled(&mut self.scaled, &self.slope, dampers);
        fourier.analyse(&self.scaled, &mut self.series);
        fourier.product(&self.series, &mut self.product);
        fourier.add_rates(&self.product, w, &mut self.by_contact);
        for (scaled, rate) in self.scaled.iter_mut().zip(rates) {
            *scaled *= rate / w;
        }
        fourier.analyse(&self.scaled, &mut self.series[..terms]);
        add(&mut self.by_frequency, &self.series[..terms]);
    }
}

fn add(to: &mut [f64], values: &[f64]) {
    for (to, value) in to.iter_mut().zip(values) {
        *to += value;
    }
}
