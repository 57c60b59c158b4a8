//! The stiffness of the contacts over a period of a motion.

use super::modal_contacts::ModalContacts;
use super::variational_equation::VariationalEquation;
use crate::ContactSystem;
use crate::fourier::{Fourier, rate_of};
use crate::vector_instructions::vectorised;

/// Stiffness of the contacts, residual flexibility in series, at places of a period: so many in
/// each of its equal steps, the same ones in every step.
#[derive(Debug, Clone, Default)]
pub(super) struct Period {
    fourier: Option<Fourier>,
    places: Vec<f64>,
    steps: usize,
    interfaces: usize,
    closures: Vec<f64>,
    tangents: Vec<f64>,
    /// Forces, closures' rates and the dampers of a system with damped contacts.
    forces: Vec<f64>,
    rates: Vec<f64>,
    dampers: Vec<f64>,
    /// `A^T C_c A + K D K` with `A = (1 + R K_c)^-1` by rows, place after place; empty without damped
    /// contacts and damped static modes.
    damping: Vec<f64>,
    /// `(1 + K_c R)^-1 K_c` by rows, place after place.
    stiffness: Vec<f64>,
    /// Present with many contacts: stiffness and damping are matrices of the modes then, `Phi^T .. Phi`.
    modal: Option<ModalContacts>,
}

impl Period {
    /// A period to be sampled at these shares of each step.
    pub(super) fn new(places: &[f64]) -> Self {
        Self { places: places.to_vec(), ..Self::default() }
    }

    /// As [`new`](Self::new), with the stiffness in the coordinates of the modes.
    pub(super) fn modal(places: &[f64]) -> Self {
        Self { modal: Some(ModalContacts::default()), ..Self::new(places) }
    }

    /// True if stiffness and damping are matrices of the modes.
    pub(super) fn is_modal(&self) -> bool {
        self.modal.is_some()
    }

    pub(super) fn steps(&self) -> usize {
        self.steps
    }

    pub(super) fn interfaces(&self) -> usize {
        self.interfaces
    }

    /// The stiffness sampled last, a square matrix for each place.
    pub(super) fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    /// The damping sampled last, a square matrix for each place; none without damped contacts.
    pub(super) fn damping(&self) -> &[f64] {
        &self.damping
    }

    /// Samples the contacts along the closures' series at the angular frequency w \[rad/s\] in as many
    /// steps as `steps` gives for the fastest rate \[rad/s\], w, and loss of contact, and puts the
    /// residual flexibility in series; none where it gives none.
    pub(super) fn resolve(
        &mut self,
        system: &ContactSystem,
        variation: &mut VariationalEquation,
        (closures, w): (&[f64], f64),
        steps: impl Fn(f64, f64, bool) -> Option<usize>,
    ) -> Option<()> {
        // The steps of the motion before resolve most motions; they are counted again for this one.
        self.sample(system, closures, w, self.steps.max(1));
        let stiffest = self.stiffest();
        let frequency = variation.highest_frequency(stiffest);
        let damped = variation.highest_damping(self.strongest_damper(), stiffest);
        let coupled =
            system.is_damped() || variation.is_retarded() || !variation.dampers.is_empty();
        let fastest = if coupled { frequency.max(damped) } else { frequency };
        let steps = steps(fastest, w, self.contact_lost())?;
        if steps != self.steps {
            self.sample(system, closures, w, steps);
        }
        self.condense(variation);
        Some(())
    }

    /// Samples the tangents of the contacts along the closures' series at the angular frequency `w`
    /// \[rad/s\], and their dampers.
    pub(super) fn sample(
        &mut self,
        system: &ContactSystem,
        closures: &[f64],
        w: f64,
        steps: usize,
    ) {
        let n = system.contacts().len();
        let harmonics = (closures.len() / n - 1) / 2;
        let count = steps * self.places.len();
        let kept = self.fourier.take();
        let kept = kept.filter(|kept| kept.harmonics() == harmonics && kept.samples() == count);
        let fourier = kept.unwrap_or_else(|| Fourier::at_places(harmonics, steps, &self.places));
        (self.steps, self.interfaces) = (steps, n);
        for samples in [&mut self.closures, &mut self.tangents] {
            samples.resize(count * n, 0.0);
        }
        if system.is_damped() {
            self.forces.resize(count * n, 0.0);
            self.rates.resize(count, 0.0);
            self.dampers.resize(count * n, 0.0);
        }
        let mut rate_series = vec![0.0; fourier.terms()];
        for (i, series) in closures.chunks_exact(fourier.terms()).enumerate() {
            let range = i * count..(i + 1) * count;
            let samples = &mut self.closures[range.clone()];
            fourier.synthesise(series, samples);
            let tangents = &mut self.tangents[range.clone()];
            if self.dampers.is_empty() {
                system.tangents(i, samples, tangents);
            } else {
                let forces = &mut self.forces[range.clone()];
                rate_of(series, w, &mut rate_series);
                fourier.synthesise(&rate_series, &mut self.rates);
                let found = (forces, tangents, &mut self.dampers[range]);
                system.damped_forces(i, (samples, &self.rates), found);
            }
        }
        self.fourier = Some(fourier);
    }

    /// The largest tangent sampled \[N/m\]; NaN if one is not a number.
    pub(super) fn stiffest(&self) -> f64 {
        self.tangents
            .iter()
            .fold(0.0, |largest, &k| if k > largest || k.is_nan() { k } else { largest })
    }

    /// The largest damper sampled \[N s/m\]; zero without damped contacts.
    pub(super) fn strongest_damper(&self) -> f64 {
        self.dampers.iter().copied().fold(0.0, f64::max)
    }

    /// True if a contact is open at a place.
    pub(super) fn contact_lost(&self) -> bool {
        self.tangents.contains(&0.0)
    }

    /// Puts the residual flexibility in series with the tangents sampled.
    pub(super) fn condense(&mut self, variation: &mut VariationalEquation) {
        let count = self.steps * self.places.len();
        let n = if self.is_modal() { variation.modes.len() } else { self.interfaces };
        self.stiffness.resize(count * n * n, 0.0);
        let dissipates = !self.dampers.is_empty() || variation.is_retarded();
        self.damping.resize(if dissipates { count * n * n } else { 0 }, 0.0);
        let Self { tangents, dampers, stiffness, damping, modal, .. } = self;
        if let Some(modal) = modal {
            modal.take(variation);
            vectorised(
                #[inline(always)]
                || {
                    for (place, out) in stiffness.chunks_exact_mut(n * n).enumerate() {
                        modal.stiffness(variation, |i| tangents[i * count + place], out);
                        if dissipates {
                            let damper =
                                |i: usize| dampers.get(i * count + place).copied().unwrap_or(0.0);
                            modal.damping(
                                variation,
                                damper,
                                &mut damping[place * n * n..][..n * n],
                            );
                        }
                    }
                },
            );
            return;
        }
        vectorised(
            #[inline(always)]
            || {
                for (place, out) in stiffness.chunks_exact_mut(n * n).enumerate() {
                    variation.stiffness(|i| tangents[i * count + place], out);
                }
                let places = stiffness.chunks_exact(n * n).zip(damping.chunks_exact_mut(n * n));
                for (place, (stiffness, out)) in places.enumerate() {
                    let damper = |i: usize| dampers.get(i * count + place).copied().unwrap_or(0.0);
                    variation.damping(damper, stiffness, out);
                }
            },
        );
    }
}

/// A number of steps rounded up to eighths of a power of two, so that tables serve many points of a
/// branch.
pub(super) fn rounded(wanted: f64) -> usize {
    let grain = ((wanted / 8.0) as usize).next_power_of_two().max(1);
    (wanted.ceil() as usize).next_multiple_of(grain).max(1)
}
