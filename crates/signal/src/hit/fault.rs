//! Samples that a sensor or a converter made up.

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
        let equal = samples[first + 1..].iter().take_while(|x| **x == value).count();
        let run = Run { first, samples: 1 + equal, value };
        first += run.samples;
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
    let finite = || samples.iter().copied().filter(|x| x.is_finite());
    let most = finite().fold(f64::NEG_INFINITY, f64::max);
    let least = finite().fold(f64::INFINITY, f64::min);
    if most <= least {
        return Vec::new();
    }
    let step = converter_step(samples);
    let abrupt = |run: &Run| {
        let neighbours = [run.first.checked_sub(1), Some(run.first + run.samples)];
        let mut neighbours = neighbours.into_iter().flatten().filter_map(|n| samples.get(n));
        neighbours.any(|x| (x - run.value).abs() > 2.0 * step)
    };
    let flat = |run: &Run| {
        let far = run.value.abs() >= 0.5 * most.max(-least);
        let extreme = far && (run.value == most || run.value == least);
        extreme && run.samples >= fewest.max(2) && abrupt(run)
    };
    let beyond = |run: &Run| full_scale.is_some_and(|limit| run.value.abs() >= limit);
    runs(samples).filter(|run| flat(run) || beyond(run)).collect()
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
    let largest = samples.iter().filter(|x| x.is_finite()).fold(0.0, |m: f64, x| m.max(x.abs()));
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
    let largest = force.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
    let high = |index: Option<usize>| {
        index.and_then(|n| force.get(n)).is_some_and(|x| *x > STRUCK * largest)
    };
    let inside = |run: &Run| {
        high(run.first.checked_sub(1)) && high(Some(run.first + run.samples)) && run.value < largest
    };
    runs(force).filter(|run| run.samples >= FORCE_RUN).filter(inside).collect()
}
