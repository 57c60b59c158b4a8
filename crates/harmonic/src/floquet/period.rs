//! The stiffness of the contacts over a period of a motion.

use super::modal_contacts::ModalContacts;
use super::variational_equation::{VariationalEquation, add};
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

/// Contacts from which on their matrices are interpolated between nodes of the period.
pub(super) const MANY: usize = 24;

/// Steps from which on the highest frequency is that of the modes on the stiffest contacts, in place of a bound without
/// matrices that takes the stiffest one for all.
const MANY_STEPS: usize = 4096;

/// Nodes at first and at most, and the largest error of cubics at the nodes between them, over the largest entry of all
/// matrices.
const FEWEST_NODES: usize = 64;
const MOST_NODES: usize = 1024;
const NODE_ERROR: f64 = 1e-3;

impl Period {
    /// A period to be sampled at these shares of each step.
    pub(super) fn new(places: &[f64]) -> Self {
        Self { places: places.to_vec(), ..Self::default() }
    }

    /// As [`new`](Self::new), with the stiffness in the coordinates of the modes.
    pub(super) fn modal(places: &[f64], variation: &VariationalEquation) -> Self {
        Self { modal: Some(ModalContacts::new(variation)), ..Self::new(places) }
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
        if self.modal.is_some() && system.contacts().len() >= MANY {
            return self.interpolate(system, variation, (closures, w), steps);
        }
        // The steps of the motion before resolve most motions; they are counted again for this one.
        self.sample(system, closures, w, self.steps.max(1));
        let stiffest = self.stiffest_of_each();
        let damped = variation.highest_damping(self.strongest_damper(), &stiffest);
        let coupled =
            system.is_damped() || variation.is_retarded() || !variation.dampers.is_empty();
        let lost = self.contact_lost();
        let steps = |frequency: f64| {
            steps(if coupled { frequency.max(damped) } else { frequency }, w, lost)
        };
        let mut wanted = steps(variation.highest_frequency(largest(&stiffest)));
        if wanted.is_none_or(|count| count > MANY_STEPS)
            && let Some(frequency) = variation.highest_frequency_on(&stiffest)
        {
            wanted = steps(frequency);
        }
        let steps = wanted?;
        if steps != self.steps {
            self.sample(system, closures, w, steps);
        }
        self.condense(variation);
        Some(())
    }

    /// [`resolve`](Self::resolve) by matrices of the modes at equal nodes of the period, twice as many until cubics
    /// through them are exact to [`NODE_ERROR`] at the nodes between.
    ///
    /// The opening of one of many cells changes the matrices little, and each node needs a factor of the contacts:
    /// thousands of steps of the fastest mode do not.
    fn interpolate(
        &mut self,
        system: &ContactSystem,
        variation: &VariationalEquation,
        (closures, w): (&[f64], f64),
        steps: impl Fn(f64, f64, bool) -> Option<usize>,
    ) -> Option<()> {
        let places = std::mem::replace(&mut self.places, vec![0.0]);
        let square = variation.modes.len().pow(2);
        self.sample(system, closures, w, FEWEST_NODES);
        let mut nodes: Vec<Vec<f64>> =
            (0..FEWEST_NODES).map(|at| self.node(square, variation, at)).collect();
        loop {
            let count = nodes.len();
            self.sample(system, closures, w, 2 * count);
            let between: Vec<Vec<f64>> =
                (0..count).map(|at| self.node(square, variation, 2 * at + 1)).collect();
            let largest = nodes.iter().flatten().fold(0.0_f64, |most, v| most.max(v.abs()));
            let off = |(at, own): (usize, &Vec<f64>)| {
                let guess = cubic(&nodes, at as f64 + 0.5);
                guess.iter().zip(own).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            let error = between.iter().enumerate().map(off).fold(0.0, f64::max);
            nodes = nodes.into_iter().zip(between).flat_map(|(a, b)| [a, b]).collect();
            if error <= NODE_ERROR * largest || nodes.len() >= MOST_NODES {
                break;
            }
        }
        self.places = places;
        let length = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
        let largest = |part: fn(&[f64], usize) -> &[f64]| {
            nodes.iter().map(|node| length(part(node, square))).fold(0.0, f64::max)
        };
        let (frequency, rate) = variation.highest();
        let stiffness = largest(|node, square| &node[..square]);
        let damping = largest(|node, square| &node[square..]);
        let fastest = (frequency.powi(2) + stiffness).sqrt().max(rate + damping);
        let steps = steps(fastest, w, false)?;
        (self.steps, self.interfaces) = (steps, system.contacts().len());
        self.stiffness.clear();
        self.damping.clear();
        for step in 0..steps {
            for share in &self.places {
                let place = (step as f64 + share) / steps as f64 * nodes.len() as f64;
                let found = cubic(&nodes, place);
                self.stiffness.extend_from_slice(&found[..square]);
                self.damping.extend_from_slice(&found[square..]);
            }
        }
        Some(())
    }

    /// Stiffness, and damping if there is any, in the coordinates of the modes at a sample.
    fn node(&self, square: usize, variation: &VariationalEquation, at: usize) -> Vec<f64> {
        let Some(modal) = &self.modal else { return Vec::new() };
        let dissipates = !self.dampers.is_empty() || variation.is_retarded();
        let mut found = vec![0.0; if dissipates { 2 * square } else { square }];
        let (stiffness, damping) = found.split_at_mut(square);
        let damper = |i: usize| self.dampers.get(i * self.steps + at).copied().unwrap_or(0.0);
        modal.write(|i| self.tangents[i * self.steps + at], damper, stiffness, damping);
        found
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

    /// The largest tangent sampled of each contact \[N/m\]; NaN where one is not a number.
    pub(super) fn stiffest_of_each(&self) -> Vec<f64> {
        self.tangents.chunks_exact(self.steps * self.places.len()).map(largest).collect()
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
        if self.is_modal() {
            return self.condense_to_modes(variation);
        }
        let Self { tangents, dampers, stiffness, damping, .. } = self;
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

    /// [`condense`](Self::condense) in the coordinates of the modes, by way of the few matrices of the pairs.
    fn condense_to_modes(&mut self, variation: &mut VariationalEquation) {
        let Self { tangents, dampers, stiffness, damping, interfaces: n, .. } = self;
        let (n, modes) = (*n, variation.modes.len());
        let count = self.steps * self.places.len();
        let shapes: Vec<f64> = (0..n * modes)
            .map(|place| variation.modes[place % modes].closure[place / modes])
            .collect();
        let (mut pairs, mut of_pairs) = (vec![0.0; n * n], vec![0.0; n * n]);
        let mut forces = vec![0.0; n * modes];
        let square = modes * modes;
        vectorised(
            #[inline(always)]
            || {
                for place in 0..count {
                    variation.stiffness(|i| tangents[i * count + place], &mut pairs);
                    let out = &mut stiffness[place * square..][..square];
                    to_modes(&shapes, &pairs, &mut forces, out);
                    let Some(out) = damping.get_mut(place * square..(place + 1) * square) else {
                        continue;
                    };
                    let damper = |i: usize| dampers.get(i * count + place).copied().unwrap_or(0.0);
                    variation.damping(damper, &pairs, &mut of_pairs);
                    to_modes(&shapes, &of_pairs, &mut forces, out);
                }
            },
        );
    }
}

/// The largest number of at least zero; NaN if one is not a number.
pub(super) fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |most, &k| if k > most || k.is_nan() { k } else { most })
}

/// Writes `Phi^T M Phi`, all by rows: `shapes` Phi has a row for each pair, M is the matrix of the `pairs`. `forces` is memory
/// for `M Phi`.
#[inline]
fn to_modes(shapes: &[f64], pairs: &[f64], forces: &mut [f64], out: &mut [f64]) {
    let n = pairs.len().isqrt();
    let modes = shapes.len() / n;
    forces.fill(0.0);
    for (force, row) in forces.chunks_exact_mut(modes).zip(pairs.chunks_exact(n)) {
        for (entry, shape) in row.iter().zip(shapes.chunks_exact(modes)) {
            add(force, *entry, shape);
        }
    }
    out.fill(0.0);
    for (shape, force) in shapes.chunks_exact(modes).zip(forces.chunks_exact(modes)) {
        for (phi, to) in shape.iter().zip(out.chunks_exact_mut(modes)) {
            add(to, *phi, force);
        }
    }
}

/// The cubic through the four nearest of equal nodes of a period, at a place counted in nodes.
fn cubic(nodes: &[Vec<f64>], place: f64) -> Vec<f64> {
    let count = nodes.len();
    let first = place.floor();
    let u = place - first;
    let at = |offset: usize| &nodes[(first as usize + count + offset - 1) % count];
    let weights = [
        -u * (u - 1.0) * (u - 2.0) / 6.0,
        0.5 * (u + 1.0) * (u - 1.0) * (u - 2.0),
        -0.5 * (u + 1.0) * u * (u - 2.0),
        (u + 1.0) * u * (u - 1.0) / 6.0,
    ];
    let mut found = vec![0.0; nodes[0].len()];
    for (offset, weight) in weights.into_iter().enumerate() {
        add(&mut found, weight, at(offset));
    }
    found
}

/// A number of steps rounded up to eighths of a power of two, so that tables serve many points of a
/// branch.
pub(super) fn rounded(wanted: f64) -> usize {
    let grain = ((wanted / 8.0) as usize).next_power_of_two().max(1);
    (wanted.ceil() as usize).next_multiple_of(grain).max(1)
}
