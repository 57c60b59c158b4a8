//! Overloads, dropouts and invalid samples of a signal.

use crate::noise::converter_step;
use std::cell::LazyCell;

/// A run of equal samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SampleRun {
    pub(super) first: usize,
    pub(super) samples: usize,
    pub(super) value: f64,
}

/// The steps in which runs of a signal begin and end.
struct Edges<'a, F> {
    samples: &'a [f64],
    /// Needed for records with long runs only.
    converter_step: LazyCell<f64, F>,
}

impl<'a> Edges<'a, ()> {
    fn of(samples: &'a [f64]) -> Edges<'a, impl FnOnce() -> f64 + 'a> {
        Edges { samples, converter_step: LazyCell::new(|| converter_step(samples)) }
    }
}

impl<F: FnOnce() -> f64> Edges<'_, F> {
    /// True if a run begins or ends in a step of more than two converter steps, unlike the maxima of a
    /// coarsely digitised oscillation.
    fn are_abrupt(&self, run: &SampleRun) -> bool {
        let neighbours = [run.first.checked_sub(1), Some(run.first + run.samples)];
        let mut neighbours = neighbours.into_iter().flatten().filter_map(|n| self.samples.get(n));
        neighbours.any(|x| (x - run.value).abs() > 2.0 * *self.converter_step)
    }
}

/// Runs of exactly equal samples.
fn runs(samples: &[f64]) -> impl Iterator<Item = SampleRun> + '_ {
    let mut first = 0;
    std::iter::from_fn(move || {
        let value = *samples.get(first)?;
        let mut end = first + 1;
        while samples.get(end) == Some(&value) {
            end += 1;
        }
        let run = SampleRun { first, samples: end - first, value };
        first = end;
        Some(run)
    })
}

/// Flat tops: runs of at least `fewest` samples equal to the largest or the
/// smallest, or beyond `full_scale`.
///
/// Without a full scale a flat top must be at least half of the largest
/// magnitude, which excludes a force at rest, and end in a step of more than
/// two converter steps on one side, which excludes the maxima of a coarsely
/// digitised oscillation. The converter step is the smallest change in the record.
pub(super) fn overloads(samples: &[f64], fewest: usize, full_scale: Option<f64>) -> Vec<SampleRun> {
    let (least, most) = extremes(samples);
    if most <= least {
        return Vec::new();
    }
    let edges = Edges::of(samples);
    let flat = |run: &SampleRun| {
        let far = run.value.abs() >= 0.5 * most.max(-least);
        let extreme = run.value == most || run.value == least;
        run.samples >= fewest.max(2) && extreme && far && edges.are_abrupt(run)
    };
    let beyond = |run: &SampleRun| full_scale.is_some_and(|limit| run.value.abs() >= limit);
    runs(samples).filter(|run| flat(run) || beyond(run)).collect()
}

/// Fewest separate times at one limit of a clipped oscillation.
const TOUCHES: usize = 5;
/// Fewest converter steps from the smallest to the largest sample for that: of few steps, equal
/// maxima are chance.
const STEPS_OF_RANGE: f64 = 256.0;

/// Separate times at which an oscillation is at exactly its largest or smallest sample, if there are
/// so many that it is clipped: the maxima of one that decays differ. The first sample, the times
/// and the value of the limit that is met more often.
pub(super) fn clipped(samples: &[f64]) -> Option<SampleRun> {
    let (least, most) = extremes(samples);
    if most <= least {
        return None;
    }
    let met = |limit: f64| {
        let mut times = runs(samples).filter(|run| run.value == limit);
        let first = times.next()?.first;
        Some(SampleRun { first, samples: 1 + times.count(), value: limit })
    };
    let found = [most, least].into_iter().filter_map(met).max_by_key(|found| found.samples)?;
    let far = found.value.abs() >= 0.5 * most.max(-least);
    let is_fine = || most - least >= STEPS_OF_RANGE * converter_step(samples);
    (found.samples >= TOUCHES && far && is_fine()).then_some(found)
}

/// Smallest and largest finite sample; `(inf, -inf)` without one.
fn extremes(samples: &[f64]) -> (f64, f64) {
    // Independent lanes, which the compiler can put into vector registers.
    const LANES: usize = 8;
    let (mut least, mut most) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    let (chunks, rest) = samples.as_chunks::<LANES>();
    for chunk in chunks {
        for lane in 0..LANES {
            let x = chunk[lane];
            least[lane] = if x < least[lane] && x >= f64::MIN { x } else { least[lane] };
            most[lane] = if x > most[lane] && x <= f64::MAX { x } else { most[lane] };
        }
    }
    let finite = rest.iter().copied().filter(|x| x.is_finite());
    let (low, high) = (least.into_iter().chain(finite.clone()), most.into_iter().chain(finite));
    (low.fold(f64::INFINITY, f64::min), high.fold(f64::NEG_INFINITY, f64::max))
}

/// Runs of samples that are not finite.
pub(super) fn not_finite(samples: &[f64]) -> Vec<SampleRun> {
    let mut found: Vec<SampleRun> = Vec::new();
    for (index, &value) in samples.iter().enumerate().filter(|(_, x)| !x.is_finite()) {
        match found.last_mut() {
            Some(run) if run.first + run.samples == index => run.samples += 1,
            _ => found.push(SampleRun { first: index, samples: 1, value }),
        }
    }
    found
}

/// Smallest magnitude of an active response over its largest value.
const ACTIVE: f64 = 0.02;

/// Runs of at least `fewest` equal samples while a response is active that begin or end abruptly, or a
/// response that is constant throughout.
///
/// Other runs at the largest and smallest value are overloads, not dropouts.
pub(super) fn response_dropouts(samples: &[f64], fewest: usize) -> Vec<SampleRun> {
    let (least, most) = extremes(samples);
    if least == most && samples.len() >= fewest.max(2) {
        return vec![SampleRun { first: 0, samples: samples.len(), value: most }];
    }
    let largest = most.max(-least).max(0.0);
    let active = |x: &f64| x.abs() > ACTIVE * largest;
    let Some((begin, end)) = samples.iter().position(active).zip(samples.iter().rposition(active))
    else {
        return Vec::new();
    };
    let edges = Edges::of(samples);
    let inside = |run: &SampleRun| {
        let is_active = run.first > begin && run.first + run.samples <= end;
        is_active && run.value.abs() < largest && edges.are_abrupt(run)
    };
    runs(samples).filter(|run| run.samples >= fewest.max(2)).filter(inside).collect()
}

/// Smallest force beside a dropout over the largest force.
const IN_PULSE: f64 = 0.25;
/// Fewest equal samples of a force dropout.
const FORCE_RUN: usize = 3;

/// Runs of at least three equal samples inside a force pulse that begin or end abruptly.
pub(super) fn force_dropouts(force: &[f64]) -> Vec<SampleRun> {
    let largest = extremes(force).1.max(0.0);
    let high = |index: Option<usize>| {
        index.and_then(|n| force.get(n)).is_some_and(|x| *x > IN_PULSE * largest)
    };
    let edges = Edges::of(force);
    let inside = |run: &SampleRun| {
        let is_high = high(run.first.checked_sub(1)) && high(Some(run.first + run.samples));
        is_high && run.value < largest && edges.are_abrupt(run)
    };
    runs(force).filter(|run| run.samples >= FORCE_RUN).filter(inside).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verified by hand, with samples that are not finite in chunks and in the rest.
    #[test]
    fn extremes_are_those_of_the_finite_samples() {
        let mut samples: Vec<f64> = (0..19).map(|n| f64::from((n * 7) % 19) - 9.0).collect();
        assert_eq!(extremes(&samples), (-9.0, 9.0));
        let lowest = samples.iter().position(|x| *x == -9.0).unwrap();
        (samples[lowest], samples[18], samples[3]) = (f64::NEG_INFINITY, f64::INFINITY, f64::NAN);
        let finite = || samples.iter().copied().filter(|x| x.is_finite());
        let expected = (finite().fold(9.0, f64::min), finite().fold(-9.0, f64::max));
        assert_eq!(extremes(&samples), expected);
        assert_eq!(extremes(&[f64::NAN]), (f64::INFINITY, f64::NEG_INFINITY));
    }
}
