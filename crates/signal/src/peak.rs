//! Local maxima of a receptance, found on a grid and refined on the transform.

use crate::form::ResponseKind;
use crate::root::bracketed_root;
use crate::spectra::{BandSpectra, HitSpectra};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Relative width to which a maximum is refined.
const TOLERANCE: f64 = 1e-12;

/// A local maximum of `|H|`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Frequency of the maximum, in hertz.
    pub frequency_hz: f64,
    /// Magnitude of the receptance there, in m/N.
    pub magnitude: f64,
    /// The receptance there, in m/N.
    pub value: Complex64,
    /// Height above the higher of the two minima beside it, over `magnitude`: 0 to 1.
    pub prominence: f64,
}

/// `|H|^2` on equally spaced frequencies `(first + k) step`.
pub(crate) struct PowerGrid {
    pub(crate) first: usize,
    pub(crate) step: f64,
    pub(crate) power: Vec<f64>,
}

impl PowerGrid {
    /// `|H|^2` of a band, from one point below `low` (Hz); infinite where it is undefined, which is
    /// never below its neighbours.
    pub(crate) fn of(band: &BandSpectra<'_>, kind: ResponseKind, low: f64) -> Self {
        let first = ((low / band.step) as usize).saturating_sub(1).max(1);
        let twice = 2 * kind.derivatives();
        let power = |(k, (x, f)): (usize, (&Complex64, &Complex64))| {
            let power = x.norm_sqr() / f.norm_sqr();
            let omega = TAU * k as f64 * band.step;
            if power.is_nan() { f64::INFINITY } else { power / omega.powi(twice) }
        };
        let pairs = band.samples.iter().zip(band.force.iter()).enumerate().skip(first);
        Self { first, step: band.step, power: pairs.map(power).collect() }
    }

    pub(crate) fn frequency(&self, index: usize) -> f64 {
        (self.first + index) as f64 * self.step
    }

    /// Local maxima of the grid inside the window, one step wider.
    pub(crate) fn maxima(&self, (low, high): (f64, f64)) -> Vec<usize> {
        let inside = |k: &usize| {
            let frequency = self.frequency(*k);
            frequency > low - self.step && frequency < high + self.step
        };
        (1..self.power.len().saturating_sub(1))
            .filter(inside)
            .filter(|&k| {
                let [left, here, right] = [self.power[k - 1], self.power[k], self.power[k + 1]];
                here > left && here >= right
            })
            .collect()
    }

    /// `|H|` at the higher of the minima on either side of a grid maximum.
    ///
    /// Each is the lowest point before `|H|` exceeds the maximum again or the grid ends.
    pub(crate) fn saddle(&self, index: usize) -> f64 {
        let top = self.power[index];
        let minimum = |sequence: &mut dyn Iterator<Item = &f64>| {
            sequence
                .take_while(|power| **power <= top)
                .fold(top, |lowest, power| lowest.min(*power))
        };
        let left = minimum(&mut self.power[..index].iter().rev());
        let right = minimum(&mut self.power[index + 1..].iter());
        left.max(right).sqrt()
    }
}

/// Frequency of the maximum of `|H|` near a grid maximum: the root of the derivative of `ln |H|^2`
/// between the neighbouring grid points; `None` if there is no maximum between them.
pub(crate) fn refine(response: &impl HitSpectra, grid: &PowerGrid, index: usize) -> Option<f64> {
    let here = grid.frequency(index);
    let (power, slope) = response.power_and_slope(here);
    if slope == 0.0 {
        return Some(here);
    }
    let neighbour = if slope > 0.0 { index + 1 } else { index - 1 };
    // A maximum lies between a point that rises towards a lower one and that one: bisect until
    // the far end falls, which brackets the root.
    let (mut near, mut near_power, mut near_slope) = (here, power, slope);
    let mut far = grid.frequency(neighbour);
    let (mut far_power, mut far_slope) = response.power_and_slope(far);
    for _ in 0..60 {
        if (far_slope > 0.0) != (near_slope > 0.0) {
            let root = bracketed_root(
                |frequency| response.power_and_slope(frequency).1,
                (near, near_slope),
                (far, far_slope),
                TOLERANCE,
            );
            return root.is_finite().then_some(root);
        }
        if far_power > near_power || !far_slope.is_finite() {
            return None;
        }
        let middle = 0.5 * (near + far);
        let (middle_power, middle_slope) = response.power_and_slope(middle);
        let same = (middle_slope > 0.0) == (near_slope > 0.0);
        if same && middle_power > near_power {
            (near, near_power, near_slope) = (middle, middle_power, middle_slope);
        } else {
            (far, far_power, far_slope) = (middle, middle_power, middle_slope);
        }
    }
    None
}
