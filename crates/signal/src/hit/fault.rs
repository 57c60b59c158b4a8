//! Samples that a sensor or a converter made up.

use std::cell::LazyCell;

/// A run of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) samples: usize,
    pub(super) value: f64,
}

/// Runs of exactly equal samples; those that are not finite equal nothing.
fn runs(samples: &[f64]) -> impl Iterator<Item = Run> + '_ {
    let mut first = 0;
    std::iter::from_fn(move || {
        let value = *samples.get(first)?;
        let mut end = first + 1;
        while samples.get(end) == Some(&value) {
            end += 1;
        }
        let run = Run { first, samples: end - first, value };
        first = end;
        Some(run)
    })
}

/// Flat tops: runs of at least `fewest` samples equal to the largest or the
/// smallest, or beyond `full_scale`.
///
/// Without a full scale a flat top must be at least half of the largest
/// magnitude, so that a force at rest is none, and end in a step of more than
/// two converter steps on one side, so that the top of a slow, coarsely
/// digitised oscillation is none. The converter step is the smallest change in the record.
pub(super) fn overloads(samples: &[f64], fewest: usize, full_scale: Option<f64>) -> Vec<Run> {
    let (least, most) = extremes(samples);
    if most <= least {
        return Vec::new();
    }
    // Few records have a flat top, and only those need the step.
    let step = LazyCell::new(|| converter_step(samples));
    let abrupt = |run: &Run| {
        let neighbours = [run.first.checked_sub(1), Some(run.first + run.samples)];
        let mut neighbours = neighbours.into_iter().flatten().filter_map(|n| samples.get(n));
        neighbours.any(|x| (x - run.value).abs() > 2.0 * *step)
    };
    let flat = |run: &Run| {
        let far = run.value.abs() >= 0.5 * most.max(-least);
        let extreme = run.value == most || run.value == least;
        run.samples >= fewest.max(2) && extreme && far && abrupt(run)
    };
    let beyond = |run: &Run| full_scale.is_some_and(|limit| run.value.abs() >= limit);
    runs(samples).filter(|run| flat(run) || beyond(run)).collect()
}

/// Smallest and largest finite sample; infinite and the wrong way round if there is none.
fn extremes(samples: &[f64]) -> (f64, f64) {
    // Several at a time: each depends on the one before it otherwise.
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

/// Smallest change between neighbours; zero if none changes.
fn converter_step(samples: &[f64]) -> f64 {
    let changes = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let least = changes.filter(|change| *change > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Runs of samples that are not finite.
pub(super) fn not_finite(samples: &[f64]) -> Vec<Run> {
    let mut found: Vec<Run> = Vec::new();
    for (index, &value) in samples.iter().enumerate().filter(|(_, x)| !x.is_finite()) {
        match found.last_mut() {
            Some(run) if run.first + run.samples == index => run.samples += 1,
            _ => found.push(Run { first: index, samples: 1, value }),
        }
    }
    found
}

/// A response is active while it is above this fraction of its largest value.
const ACTIVE: f64 = 0.02;

/// Runs of at least `fewest` equal samples while a response is active.
///
/// Runs at the largest and smallest value are overloads, not dropouts.
pub(super) fn response_dropouts(samples: &[f64], fewest: usize) -> Vec<Run> {
    let (least, most) = extremes(samples);
    let largest = most.max(-least).max(0.0);
    let active = |x: &f64| x.abs() > ACTIVE * largest;
    let Some((begin, end)) = samples.iter().position(active).zip(samples.iter().rposition(active))
    else {
        return Vec::new();
    };
    let inside = |run: &Run| {
        run.first > begin && run.first + run.samples <= end && run.value.abs() < largest
    };
    runs(samples).filter(|run| run.samples >= fewest.max(2)).filter(inside).collect()
}

/// A blow does not stand still in mid-air: the samples beside a force dropout
/// are above this fraction of the largest.
const STRUCK: f64 = 0.25;
/// Fewest equal samples in a force that are a dropout.
const FORCE_RUN: usize = 3;

/// Runs of at least three equal samples inside a force pulse.
pub(super) fn force_dropouts(force: &[f64]) -> Vec<Run> {
    let largest = extremes(force).1.max(0.0);
    let high = |index: Option<usize>| {
        index.and_then(|n| force.get(n)).is_some_and(|x| *x > STRUCK * largest)
    };
    let inside = |run: &Run| {
        high(run.first.checked_sub(1)) && high(Some(run.first + run.samples)) && run.value < largest
    };
    runs(force).filter(|run| run.samples >= FORCE_RUN).filter(inside).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verified by hand, with what is not finite in chunks and in the rest.
    #[test]
    fn extremes_are_finite() {
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
