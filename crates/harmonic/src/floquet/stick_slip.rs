//! Phases of friction elements over a period: where they stick and where they slip.

use std::f64::consts::TAU;

use asperity_law::Friction;

use crate::ContactSystem;
use crate::fourier::{Fourier, rate_of};

/// Samples of a period that slip is looked for at; its beginnings and ends are interpolated.
const SAMPLES: usize = 4096;

/// State of a friction element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Phase {
    /// The slider rests: the element is a spring.
    Stuck,
    /// The slider moves in this direction, -1 or 1: the force is that share of the limit.
    Slips(f64),
}

/// A friction element over a period.
#[derive(Debug, Clone)]
pub(super) struct ElementPhases {
    pub(super) friction: Friction,
    /// Pair whose closure the element follows, and contact whose force bounds it.
    pub(super) pair: usize,
    pub(super) contact: usize,
    /// Number of the slider's state in the monodromy matrix. The slider of an element that sticks
    /// throughout the period has no state: any position of this slider is one of rest.
    pub(super) slider: Option<usize>,
    /// Phase at the angle zero. Each change is an angle \[rad\] and the phase from there on.
    start: Phase,
    changes: Vec<(f64, Phase)>,
}

impl ElementPhases {
    /// The phase at an angle \[rad\] between two changes.
    pub(super) fn at(&self, angle: f64) -> Phase {
        let before = self.changes.iter().rev().find(|(at, _)| *at < angle);
        before.map_or(self.start, |(_, phase)| *phase)
    }

    /// The angles at which the phase changes \[rad\].
    pub(super) fn angles(&self) -> impl Iterator<Item = f64> {
        self.changes.iter().map(|(angle, _)| *angle)
    }

    /// True if a change at this angle \[rad\] begins a phase of sticking.
    pub(super) fn sticks_from(&self, angle: f64) -> bool {
        let here = self.changes.iter().rev().find(|(at, _)| *at <= angle);
        here.is_some_and(|(at, phase)| *at == angle && *phase == Phase::Stuck)
    }

    /// Follows an element through two periods and records the second. The first begins at the
    /// displacement without a force, as in the harmonic balance.
    fn new(
        (friction, pair, contact): (Friction, usize, usize),
        closures: &[f64],
        limits: &[f64],
    ) -> Self {
        let count = closures.len();
        let (mut force, mut before, mut phase) = (0.0, 0.0, Phase::Stuck);
        let (mut start, mut changes) = (Phase::Stuck, Vec::new());
        let spacing = TAU / count as f64;
        for recorded in [false, true] {
            if recorded {
                start = phase;
            }
            for n in 0..count {
                let last = (n + count - 1) % count;
                let stuck = force + friction.stiffness() * (closures[n] - before);
                let next = if stuck.abs() > limits[n] {
                    Phase::Slips(stuck.signum())
                } else {
                    Phase::Stuck
                };
                if recorded && next != phase {
                    if let Phase::Slips(_) = phase {
                        let end = end_of_slip(&friction, closures, limits, (n, phase));
                        changes.push((spacing * (n as f64 - 1.0 + end), Phase::Stuck));
                    }
                    if let Phase::Slips(direction) = next {
                        // The force reaches its limit between the samples.
                        let left = limits[last] - direction * force;
                        let share = left / (left + stuck.abs() - limits[n]);
                        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
                        changes.push((spacing * (n as f64 - 1.0 + share), next));
                    }
                }
                force = friction.force(force, closures[n] - before, limits[n]);
                (before, phase) = (closures[n], next);
            }
        }
        // Interpolation may place a change before the start of the period, or before the last one.
        let mut latest = 0.0_f64;
        for (angle, _) in &mut changes {
            latest = angle.clamp(latest, TAU);
            *angle = latest;
        }
        let slider = None;
        Self { friction, pair, contact, slider, start, changes }
    }

    fn slips(&self) -> bool {
        self.start != Phase::Stuck || !self.changes.is_empty()
    }
}

/// Place of the end of a slip before sample `n`, in samples from the one before: where the stuck
/// force turns from its limit, on a parabola.
fn end_of_slip(
    friction: &Friction,
    closures: &[f64],
    limits: &[f64],
    (n, phase): (usize, Phase),
) -> f64 {
    let Phase::Slips(direction) = phase else { return 0.0 };
    let count = closures.len();
    let excess = |place: usize| {
        let at = place % count;
        direction * friction.stiffness() * closures[at] - limits[at]
    };
    let [a, b, c] = [excess(n + count - 2), excess(n + count - 1), excess(n)];
    let top = 0.5 * (a - c) / (a - 2.0 * b + c);
    if top.is_finite() { top.clamp(-1.0, 1.0) } else { 0.0 }
}

/// Follows all friction elements of a system over a period; keeps its memory.
#[derive(Debug, Default)]
pub(super) struct StickSlip {
    fourier: Option<Fourier>,
    closures: Vec<f64>,
    forces: Vec<f64>,
    tangents: Vec<f64>,
    rates: Vec<f64>,
    dampers: Vec<f64>,
    rate_series: Vec<f64>,
    limits: Vec<f64>,
}

impl StickSlip {
    /// The elements along the pairs' series of closures at the angular frequency `w` \[rad/s\].
    pub(super) fn follow(
        &mut self,
        system: &ContactSystem,
        closures: &[f64],
        w: f64,
    ) -> Vec<ElementPhases> {
        let (pairs, contacts) = (system.pairs(), system.contacts().len());
        let harmonics = (closures.len() / pairs - 1) / 2;
        let kept = self.fourier.take().filter(|kept| kept.harmonics() == harmonics);
        let fourier = kept.unwrap_or_else(|| Fourier::at_places(harmonics, SAMPLES, &[0.0]));
        self.closures.resize(pairs * SAMPLES, 0.0);
        for all in [&mut self.forces, &mut self.tangents, &mut self.dampers] {
            all.resize(contacts * SAMPLES, 0.0);
        }
        self.rates.resize(SAMPLES, 0.0);
        self.rate_series.resize(fourier.terms(), 0.0);
        for (i, series) in closures.chunks_exact(fourier.terms()).enumerate() {
            let range = i * SAMPLES..(i + 1) * SAMPLES;
            let samples = &mut self.closures[range.clone()];
            fourier.synthesise(series, samples);
            if i >= contacts {
                continue;
            }
            rate_of(series, w, &mut self.rate_series);
            fourier.synthesise(&self.rate_series, &mut self.rates);
            let forces = &mut self.forces[range.clone()];
            let found = (forces, &mut self.tangents[range.clone()], &mut self.dampers[range]);
            system.damped_forces(i, (samples, &self.rates), found);
        }
        self.fourier = Some(fourier);
        let mut sliders = 0;
        let mut found = Vec::new();
        for (friction, pair, contact) in system.friction_elements() {
            let bounding = &system.contacts()[contact];
            let at_rest = bounding.area() * bounding.pressure();
            let forces = &self.forces[contact * SAMPLES..(contact + 1) * SAMPLES];
            self.limits.clear();
            self.limits.extend(forces.iter().map(|force| friction.limit(at_rest + force)));
            let closures = &self.closures[pair * SAMPLES..(pair + 1) * SAMPLES];
            let mut element = ElementPhases::new((friction, pair, contact), closures, &self.limits);
            if element.slips() {
                element.slider = Some(sliders);
                sliders += 1;
            }
            found.push(element);
        }
        found
    }

    /// The largest tangent of the contacts \[N/m\] in the period followed last; NaN if one is not a
    /// number.
    pub(super) fn stiffest(&self) -> f64 {
        let larger = |most: f64, k: &f64| if *k > most || k.is_nan() { *k } else { most };
        self.tangents.iter().fold(0.0, larger)
    }

    /// The largest damper \[N s/m\].
    pub(super) fn strongest_damper(&self) -> f64 {
        self.dampers.iter().copied().fold(0.0, f64::max)
    }

    /// True if a contact was open.
    pub(super) fn contact_lost(&self) -> bool {
        self.tangents.contains(&0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cosine of amplitude X under a constant limit R slips from where it has moved 2 R / k back
    /// from a reversal, to the reversal after.
    #[test]
    fn slip_begins_and_ends_as_in_closed_form() {
        let (stiffness, limit, amplitude) = (1e7, 0.3, 1e-7);
        let friction = Friction::slip_force(stiffness, limit).unwrap();
        let count = SAMPLES;
        let angle = |n: usize| TAU * n as f64 / count as f64 - 0.7;
        let closures: Vec<f64> = (0..count).map(|n| amplitude * angle(n).cos()).collect();
        let found = ElementPhases::new((friction, 0, 0), &closures, &vec![limit; count]);
        let begin = (1.0 - 2.0 * limit / (stiffness * amplitude)).acos();
        let expected = [
            (0.7, Phase::Stuck),
            (0.7 + begin, Phase::Slips(-1.0)),
            (0.7 + TAU / 2.0, Phase::Stuck),
            (0.7 + TAU / 2.0 + begin, Phase::Slips(1.0)),
        ];
        assert_eq!(found.changes.len(), 4);
        assert_eq!(found.start, Phase::Slips(1.0));
        for ((angle, phase), (at, is)) in found.changes.iter().zip(expected) {
            assert_eq!(*phase, is);
            assert!((angle - at).abs() < 1e-5, "{angle} {at}");
        }
        assert_eq!(found.at(0.8), Phase::Stuck);
        // A smaller motion sticks throughout.
        let small: Vec<f64> = closures.iter().map(|x| 0.2 * x).collect();
        assert!(!ElementPhases::new((friction, 0, 0), &small, &vec![limit; count]).slips());
    }
}
