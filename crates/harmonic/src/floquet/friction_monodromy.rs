//! The monodromy matrix of motions with friction.

use std::f64::consts::TAU;

use faer::Mat;

use super::runge_kutta::{Coefficients, RungeKutta, identity};
use super::stick_slip::{ElementPhases, Phase, StickSlip};
use super::variational_equation::{VariationalEquation, add};
use crate::ContactSystem;
use crate::factorization::Factorization;

/// Integration of disturbances through phases of sticking and slipping.
///
/// The states are displacements and velocities of the modes, and the slider z of each element that
/// slips. Stuck, an element of stiffness k is a spring, and its slider rests:
///
/// ```text
/// df = k (dx - dz),    dz' = 0.
/// ```
///
/// Slipping in the direction `sigma` it has the force `sigma R` of its limit, a share mu of the force N
/// of a contact or a number,
///
/// ```text
/// df = sigma mu dN,    dz = dx - sigma mu dN / k  where the slip ends.
/// ```
///
/// The force is continuous from phase to phase, and leaves its limit with a rate of zero, so that a
/// shift of these times changes nothing to first order. The period is divided there, and each part
/// integrated in equal steps.
#[derive(Debug, Default)]
pub(super) struct FrictionMonodromy {
    method: RungeKutta,
    phases: StickSlip,
    part: Part,
}

impl FrictionMonodromy {
    /// The matrix of the motion with these closures' series; none where a mode is too fast.
    pub(super) fn compute(
        &mut self,
        system: &ContactSystem,
        variation: &mut VariationalEquation,
        closures: &[f64],
        w: f64,
    ) -> Option<Mat<f64>> {
        let elements = self.phases.follow(system, closures, w);
        let springs = elements.iter().map(|element| element.friction.stiffness());
        let stiffest = self.phases.stiffest() + springs.fold(0.0, f64::max);
        let all = vec![stiffest; variation.interfaces()];
        let damped = variation.highest_damping(self.phases.strongest_damper(), &all);
        let coupled =
            system.is_damped() || variation.is_retarded() || !variation.dampers.is_empty();
        let fastest = variation.highest_frequency(stiffest).max(if coupled { damped } else { 0.0 });
        let steps = RungeKutta::steps(fastest, w, self.phases.contact_lost())?;
        let sliders = elements.iter().filter(|element| element.slider.is_some()).count();
        let size = 2 * variation.modes.len() + sliders;
        let mut states = identity(size);
        let mut ends: Vec<f64> = elements.iter().flat_map(ElementPhases::angles).collect();
        ends.push(TAU);
        ends.sort_by(f64::total_cmp);
        let mut start = 0.0;
        for end in ends {
            if end > start {
                let count = ((end - start) / TAU * steps as f64).ceil().max(1.0) as usize;
                self.part.sample(system, &elements, closures, (w, start, end, count));
                self.part.condense(variation, &elements, sliders, 0.5 * (start + end));
                let step = (end - start) / (w * count as f64);
                for number in 0..count {
                    let at = [0, 1, 2].map(|half| self.part.coefficients(2 * number + half));
                    self.method.advance(variation, (w, step), at, &mut states);
                }
                let middle = 0.5 * (start + end);
                start = end;
                self.part.release(variation, &elements, (middle, end), w, &mut states);
            }
        }
        Some(Mat::from_fn(size, size, |row, column| states[row * size + column]))
    }
}

/// A part of a period in which no element changes its phase, sampled at the ends and middles of
/// steps.
#[derive(Debug, Default)]
struct Part {
    places: usize,
    pairs: usize,
    closures: Vec<f64>,
    rates: Vec<f64>,
    forces: Vec<f64>,
    tangents: Vec<f64>,
    dampers: Vec<f64>,
    /// Matrices by rows, place after place, of [`Coefficients`].
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    sliders: Vec<f64>,
}

impl Part {
    /// Samples the contacts from angle to angle \[rad\] in `count` steps.
    fn sample(
        &mut self,
        system: &ContactSystem,
        elements: &[ElementPhases],
        closures: &[f64],
        (w, start, end, count): (f64, f64, f64, usize),
    ) {
        debug_assert!(!elements.is_empty());
        let contacts = system.contacts().len();
        self.pairs = system.pairs();
        self.places = 2 * count + 1;
        let terms = closures.len() / self.pairs;
        for all in [
            &mut self.closures,
            &mut self.rates,
            &mut self.forces,
            &mut self.tangents,
            &mut self.dampers,
        ] {
            all.clear();
            all.resize(contacts * self.places, 0.0);
        }
        for place in 0..self.places {
            let angle = start + (end - start) * place as f64 / (2 * count) as f64;
            let (sin, cos) = angle.sin_cos();
            let (mut c, mut s) = (1.0, 0.0);
            for (i, series) in closures.chunks_exact(terms).take(contacts).enumerate() {
                self.closures[i * self.places + place] = series[0];
            }
            for k in 1..=(terms - 1) / 2 {
                (c, s) = (c * cos - s * sin, s * cos + c * sin);
                let turning = k as f64 * w;
                for (i, series) in closures.chunks_exact(terms).take(contacts).enumerate() {
                    let (a, b) = (series[2 * k - 1], series[2 * k]);
                    self.closures[i * self.places + place] += a * c + b * s;
                    self.rates[i * self.places + place] += turning * (b * c - a * s);
                }
            }
        }
        for i in 0..contacts {
            let range = i * self.places..(i + 1) * self.places;
            let along = (&self.closures[range.clone()], &self.rates[range.clone()]);
            let found = (
                &mut self.forces[range.clone()],
                &mut self.tangents[range.clone()],
                &mut self.dampers[range],
            );
            system.damped_forces(i, along, found);
        }
    }

    /// Derivatives \[N/m\] and \[N s/m\] of the force of contact i at a place.
    fn contact(&self, i: usize, place: usize) -> (f64, f64) {
        (self.tangents[i * self.places + place], self.dampers[i * self.places + place])
    }

    /// Coefficients of the pairs' forces, residual flexibility in series: with the forces
    /// `f = T x + C x' - k z` of contacts and elements, and `x = Phi q - R f + D f'`,
    ///
    /// ```text
    /// f = L T Phi q + (L C (1 - R L T) + (L T) D (L T)) Phi q' - L k z,    L = (1 + T R)^-1,
    /// ```
    ///
    /// of first order in the damping of what is left out.
    fn condense(
        &mut self,
        variation: &VariationalEquation,
        elements: &[ElementPhases],
        sliders: usize,
        middle: f64,
    ) {
        let (n, contacts) = (self.pairs, self.tangents.len() / self.places);
        let square = n * n;
        let flexibility = variation.flexibility();
        let damped = self.dampers.iter().any(|damper| *damper != 0.0) || variation.is_retarded();
        for all in [&mut self.stiffness, &mut self.damping, &mut self.sliders] {
            all.clear();
        }
        let mut factors = Factorization::new(n);
        let mut column = vec![0.0; n];
        let (mut tangent, mut damper) = (vec![0.0; square], vec![0.0; square]);
        let mut held = vec![0.0; n * sliders];
        let [mut condensed, mut of_rates] = [vec![0.0; square], vec![0.0; square]];
        for place in 0..self.places {
            tangent.fill(0.0);
            damper.fill(0.0);
            held.fill(0.0);
            for i in 0..contacts {
                (tangent[i * n + i], damper[i * n + i]) = self.contact(i, place);
            }
            for element in elements {
                let (pair, contact) = (element.pair, element.contact);
                match element.at(middle) {
                    Phase::Stuck => {
                        tangent[pair * n + pair] += element.friction.stiffness();
                        if let Some(slider) = element.slider {
                            held[pair * sliders + slider] = element.friction.stiffness();
                        }
                    }
                    Phase::Slips(direction) => {
                        let share = direction * element.friction.share_of_contact();
                        let (k, c) = self.contact(contact, place);
                        tangent[pair * n + contact] += share * k;
                        damper[pair * n + contact] += share * c;
                    }
                }
            }
            for place in 0..square {
                let (i, j) = (place / n, place % n);
                let row = tangent[i * n..(i + 1) * n].iter().zip(flexibility);
                let product: f64 = row.map(|(k, r)| k * r[j]).sum();
                factors.matrix()[place] = product + f64::from(u8::from(i == j));
            }
            // A singular matrix leaves numbers that are not finite: multipliers that are unknown.
            factors.factorize();
            let mut solve = |from: &[f64], width: usize, to: &mut [f64]| {
                for j in 0..width {
                    (0..n).for_each(|i| column[i] = from[i * width + j]);
                    factors.solve(&mut column);
                    (0..n).for_each(|i| to[i * width + j] = column[i]);
                }
            };
            solve(&tangent, n, &mut condensed);
            self.stiffness.extend(&condensed);
            if sliders > 0 {
                let start = self.sliders.len();
                self.sliders.resize(start + n * sliders, 0.0);
                solve(&held, sliders, &mut self.sliders[start..]);
            }
            if damped {
                solve(&damper, n, &mut of_rates);
                for i in 0..n {
                    for j in 0..n {
                        let share = |l: usize| {
                            let lost: f64 =
                                (0..n).map(|m| flexibility[l][m] * condensed[m * n + j]).sum();
                            f64::from(u8::from(l == j)) - lost
                        };
                        let own: f64 = (0..n).map(|l| of_rates[i * n + l] * share(l)).sum();
                        let lag = |(at, d): (usize, &f64)| {
                            condensed[i * n + at / n] * d * condensed[at % n * n + j]
                        };
                        let lag: f64 = variation.retardation().iter().enumerate().map(lag).sum();
                        self.damping.push(own + lag);
                    }
                }
            }
        }
    }

    fn coefficients(&self, place: usize) -> Coefficients<'_> {
        let square = self.pairs * self.pairs;
        let sliders = self.sliders.len() / self.places;
        let damping = self.damping.get(place * square..(place + 1) * square);
        Coefficients {
            stiffness: &self.stiffness[place * square..(place + 1) * square],
            damping: damping.unwrap_or(&[]),
            sliders: &self.sliders[place * sliders..(place + 1) * sliders],
        }
    }

    /// Sets the sliders of the elements whose slip ends at the end of the part.
    fn release(
        &self,
        variation: &VariationalEquation,
        elements: &[ElementPhases],
        (middle, end): (f64, f64),
        scale: f64,
        states: &mut [f64],
    ) {
        let (modes, n) = (variation.modes.len(), self.pairs);
        let place = self.places - 1;
        let at = self.coefficients(place);
        let sliders = at.sliders.len() / n;
        let size = 2 * modes + sliders;
        for element in elements {
            let (Phase::Slips(direction), Some(slider)) = (element.at(middle), element.slider)
            else {
                continue;
            };
            if !element.sticks_from(end) {
                continue;
            }
            // Rows of the closures of the modes kept, their rates, and the forces.
            let sum = |rows: &dyn Fn(usize) -> (usize, f64), count: usize, states: &[f64]| {
                let mut total = vec![0.0; size];
                for term in 0..count {
                    let (row, factor) = rows(term);
                    add(&mut total, factor, &states[row * size..(row + 1) * size]);
                }
                total
            };
            let closure = |i: usize, states: &[f64]| {
                sum(&|m| (m, variation.modes[m].closure[i]), modes, states)
            };
            let rate = |i: usize, states: &[f64]| {
                sum(&|m| (modes + m, scale * variation.modes[m].closure[i]), modes, states)
            };
            let closures: Vec<_> = (0..n).map(|i| closure(i, states)).collect();
            let rates: Vec<_> = (0..n).map(|i| rate(i, states)).collect();
            let product = |matrix: &[f64], i: usize, of: &[Vec<f64>], to: &mut [f64]| {
                for (factor, row) in matrix[i * n..(i + 1) * n].iter().zip(of) {
                    add(to, *factor, row);
                }
            };
            let (mut forces, mut force_rates) = (Vec::new(), Vec::new());
            for i in 0..n {
                let (mut force, mut force_rate) = (vec![0.0; size], vec![0.0; size]);
                product(at.stiffness, i, &closures, &mut force);
                product(at.stiffness, i, &rates, &mut force_rate);
                if !at.damping.is_empty() {
                    product(at.damping, i, &rates, &mut force);
                }
                for (j, b) in at.sliders[i * sliders..(i + 1) * sliders].iter().enumerate() {
                    let row = (2 * modes + j) * size;
                    add(&mut force, -b, &states[row..row + size]);
                }
                forces.push(force);
                force_rates.push(force_rate);
            }
            // Closures and rates with the flexibility of the modes left out.
            let whole = |i: usize| {
                let (mut x, mut v) = (closures[i].clone(), rates[i].clone());
                for j in 0..n {
                    add(&mut x, -variation.flexibility()[i][j], &forces[j]);
                    add(&mut v, -variation.flexibility()[i][j], &force_rates[j]);
                    if let Some(lag) = variation.retardation().get(i * n + j) {
                        add(&mut x, *lag, &force_rates[j]);
                    }
                }
                (x, v)
            };
            let (mut row, _) = whole(element.pair);
            let share = direction * element.friction.share_of_contact();
            if share != 0.0 {
                let (x, v) = whole(element.contact);
                let (k, c) = self.contact(element.contact, place);
                let factor = -share / element.friction.stiffness();
                add(&mut row, factor * k, &x);
                add(&mut row, factor * c, &v);
            }
            let to = (2 * modes + slider) * size;
            states[to..to + size].copy_from_slice(&row);
        }
    }
}
