//! Fewer samples than steps: a low-pass filter that keeps every so many outputs, and the last ones as they are.

use std::cmp::Ordering;
use std::sync::Arc;

/// A finite filter `y_j = sum of taps_l u_(j factor - l)`, u being zero before and after the run.
///
/// The taps are the caller's, who must apply the same filter to the force: ratios of spectra then
/// do not see it.
#[derive(Debug, Clone, PartialEq)]
pub struct Decimation {
    /// Steps per sample kept, at least 1.
    pub factor: usize,
    /// The filter, newest step first.
    pub taps: Arc<[f64]>,
    /// Number of the last outputs that are kept as they are too: a filter hides the end of the run.
    pub ending: usize,
}

impl Decimation {
    /// Every output as it is.
    pub fn every_step() -> Arc<Self> {
        Arc::new(Self { factor: 1, taps: Arc::new([1.0]), ending: 0 })
    }

    /// No samples.
    pub(super) fn none() -> Arc<Self> {
        Arc::new(Self { factor: 1, taps: Arc::new([]), ending: 0 })
    }

    /// Steps per sample kept; one where the factor is zero.
    pub(super) fn stride(&self) -> usize {
        self.factor.max(1)
    }

    /// Number of samples of `steps` outputs: multiples of the factor until the filter has run out.
    pub(super) fn samples(&self, steps: usize) -> usize {
        (steps + self.taps.len().saturating_sub(1)).div_ceil(self.stride())
    }

    /// The samples of outputs that are all known.
    pub(super) fn filtered(&self, outputs: &[f64]) -> Vec<f64> {
        let sample = |j: usize| {
            let newest = j * self.stride();
            let first = (newest + 1).saturating_sub(outputs.len());
            let taps = self.taps.iter().enumerate().skip(first);
            taps.map_while(|(l, tap)| Some(tap * outputs[newest.checked_sub(l)?])).sum()
        };
        (0..self.samples(outputs.len())).map(sample).collect()
    }

    /// The first of `steps` outputs that is kept as it is.
    pub(super) fn ending_from(&self, steps: usize) -> usize {
        steps.saturating_sub(self.ending)
    }

    /// An order in which filters are equal if they have equal factors and endings, and taps of equal bits.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let size = |filter: &Self| (filter.factor, filter.taps.len(), filter.ending);
        let taps = || {
            if Arc::ptr_eq(&self.taps, &other.taps) {
                return Ordering::Equal;
            }
            let mut orders = self.taps.iter().zip(&*other.taps).map(|(a, b)| a.total_cmp(b));
            orders.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
        };
        size(self).cmp(&size(other)).then_with(taps)
    }
}
