//! The decimation filter at work on every lane of a block, and the last outputs before it.

use pulp::Simd;

use super::block::{LanePair, LaneVector, Step, lane_of, set_lane};
use crate::modal::decimation::Decimation;

/// Numbers on lines of their own: a vector that straddles two costs twice.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Line<V>(V);

/// The outputs that are kept of one lane.
#[derive(Debug, Default)]
pub(super) struct LaneSamples {
    /// The samples of the filter.
    pub(super) filtered: Vec<f64>,
    /// The last outputs before it.
    pub(super) ending: Vec<f64>,
}

/// The filter at work on every lane of a block.
pub(super) struct Decimator<S: Simd> {
    /// Taps, oldest step first.
    taps: Vec<f64>,
    factor: usize,
    /// Steps taken in.
    taken: usize,
    /// The samples, as far as the steps taken in contribute to them.
    samples: Vec<Line<LaneVector<S>>>,
    /// Those of the last outputs that are integrated, the step of the first, and the number of all.
    ending: Vec<Line<LaneVector<S>>>,
    ending_from: usize,
    ending_length: usize,
}

impl<S: Simd> Decimator<S> {
    /// A filter of `steps` outputs, the first being that at rest, of which the first `integrated` are taken in.
    pub(super) fn new(simd: S, decimation: &Decimation, [integrated, steps]: [usize; 2]) -> Self {
        let factor = decimation.stride();
        let taps: Vec<f64> = decimation.taps.iter().rev().copied().collect();
        let count = decimation.samples(steps);
        let ending_from = decimation.ending_from(steps);
        let zeros = |count: usize| vec![Line(LanePair(simd).splat(0.0)); count];
        let (samples, ending) = (zeros(count), zeros(integrated.saturating_sub(ending_from)));
        let ending_length = steps - ending_from;
        Self { taps, factor, taken: 1, samples, ending, ending_from, ending_length }
    }

    /// Takes in the outputs of one lane at steps so far, the one at rest first; all lanes have as many.
    pub(super) fn take_before(&mut self, lane: usize, outputs: &[f64]) {
        let reach = self.taps.len();
        for (j, sample) in self.samples.iter_mut().enumerate() {
            let newest = j * self.factor;
            let oldest = (newest + 1).saturating_sub(reach);
            if oldest >= outputs.len() {
                break;
            }
            let outputs = &outputs[oldest..outputs.len().min(newest + 1)];
            let taps = &self.taps[oldest + reach - 1 - newest..];
            let sum = outputs.iter().zip(taps).map(|(output, tap)| output * tap).sum();
            set_lane::<S>(&mut sample.0, lane, sum);
        }
        self.taken = outputs.len();
        let last = outputs.get(self.ending_from..).unwrap_or_default();
        for (kept, output) in self.ending.iter_mut().zip(last) {
            set_lane::<S>(&mut kept.0, lane, *output);
        }
    }

    /// Takes in the outputs of `chunk`.
    ///
    /// Each sample that they contribute to is loaded and stored once a chunk, and no window of
    /// past outputs has to be kept.
    #[inline(always)]
    pub(super) fn take<const N: usize>(&mut self, simd: S, chunk: &[Step<LaneVector<S>, N>]) {
        let pair = LanePair(simd);
        let reach = self.taps.len();
        let mut j = self.taken.div_ceil(self.factor);
        while j < self.samples.len() {
            // Place in the chunk of the sample's newest step, which may be beyond it, and of
            // its oldest.
            let newest = j * self.factor - self.taken;
            let oldest = (newest + 1).saturating_sub(reach);
            if oldest >= chunk.len() {
                break;
            }
            let steps = &chunk[oldest..chunk.len().min(newest + 1)];
            let taps = &self.taps[oldest + reach - 1 - newest..][..steps.len()];
            let zero = pair.splat(0.0);
            // Four sums by name: an array of them would be kept in memory.
            let (mut a, mut b, mut c, mut d) = (self.samples[j].0, zero, zero, zero);
            let (quads, tap_quads) = (steps.chunks_exact(4), taps.chunks_exact(4));
            for (step, tap) in quads.remainder().iter().zip(tap_quads.remainder()) {
                a = pair.mul_add(pair.splat(*tap), step.reading, a);
            }
            for (steps, taps) in quads.zip(tap_quads) {
                let (&[t0, t1, t2, t3], [u0, u1, u2, u3]) = (taps, steps) else { continue };
                a = pair.mul_add(pair.splat(t0), u0.reading, a);
                b = pair.mul_add(pair.splat(t1), u1.reading, b);
                c = pair.mul_add(pair.splat(t2), u2.reading, c);
                d = pair.mul_add(pair.splat(t3), u3.reading, d);
            }
            self.samples[j].0 = pair.add(pair.add(a, b), pair.add(c, d));
            j += 1;
        }
        // Of the chunk, and of the ending: where each begins in the other.
        let (before, after) = (
            self.ending_from.saturating_sub(self.taken),
            self.taken.saturating_sub(self.ending_from),
        );
        let last = chunk.get(before..).unwrap_or_default();
        for (kept, step) in self.ending.iter_mut().skip(after).zip(last) {
            kept.0 = step.reading;
        }
        self.taken += chunk.len();
    }

    /// The samples and the last outputs of each lane; zeros for what was not taken in.
    pub(super) fn finish(self) -> Vec<LaneSamples> {
        let column = |lines: &[Line<LaneVector<S>>], lane: usize, length: usize| {
            let mut column = Vec::with_capacity(length);
            column.extend(lines.iter().map(|line| lane_of::<S>(&line.0, lane)));
            column.resize(length, 0.0);
            column
        };
        let of = |lane| LaneSamples {
            filtered: column(&self.samples, lane, self.samples.len()),
            ending: column(&self.ending, lane, self.ending_length),
        };
        (0..2 * S::F64_LANES).map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// Against the sum that defines the filter, for taps within a chunk, across chunks, and
    /// across all of them; the second lane has twice the output.
    #[test]
    fn samples_are_the_sums_of_the_definition() {
        let simd = pulp::Scalar::new();
        let output: Vec<f64> = (0..203).map(|n| (0.37 * f64::from(n)).sin()).collect();
        for (factor, length) in [(1, 1), (8, 64), (3, 5), (7, 2), (5, 300)] {
            let taps: Arc<[f64]> = (0..length).map(|l| 1.0 / (1.0 + l as f64)).collect();
            let ending = length + 20;
            let decimation = Decimation { factor, taps: Arc::clone(&taps), ending };
            let mut decimator = Decimator::new(simd, &decimation, [output.len(); 2]);
            for chunk in output[1..].chunks(32) {
                let step = |&u: &f64| Step {
                    pressure: [[0.0; 2]],
                    closure: [[0.0; 2]],
                    reading: [u, 2.0 * u],
                };
                let steps: Vec<Step<[f64; 2], 1>> = chunk.iter().map(step).collect();
                decimator.take(simd, &steps);
            }
            let found = decimator.finish();
            let last = &output[output.len().saturating_sub(ending)..];
            assert_eq!(found[0].ending, last, "{factor} {length}");
            assert!(found[1].ending.iter().zip(last).all(|(twice, once)| *twice == 2.0 * once));
            let [once, twice] = [&found[0].filtered, &found[1].filtered];
            assert_eq!(once.len(), (output.len() + taps.len() - 1).div_ceil(factor));
            for (j, sample) in once.iter().enumerate() {
                let past = |l: usize| (j * factor).checked_sub(l).and_then(|n| output.get(n));
                let sum: f64 =
                    taps.iter().enumerate().filter_map(|(l, tap)| Some(tap * past(l)?)).sum();
                // Roundings of three hundred terms of at most one.
                assert!((sample - sum).abs() < 1e-13, "{factor} {length} {j}: {sample} {sum}");
                assert_eq!(twice[j], 2.0 * sample);
            }
        }
    }
}
