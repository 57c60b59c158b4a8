//! Local maxima of a receptance, found on a grid and refined on the transform.

use crate::response::Spectra;
use crate::root::bracketed_root;
use realfft::num_complex::Complex64;

/// Relative width to which a maximum is refined.
const TOLERANCE: f64 = 1e-12;

/// A local maximum of `|H|`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Frequency of the maximum, in hertz.
    pub frequency_hz: f64,
    /// Magnitude of the receptance there, in m/N.
    pub magnitude: f64,
    /// The receptance itself there, in m/N.
    pub value: Complex64,
    /// Height over the higher of the two valleys beside it, over `magnitude`: 0 to 1.
    pub prominence: f64,
}

/// `|H|^2` on equally spaced frequencies `(first + k) step`.
pub(crate) struct PowerGrid {
    pub(crate) first: usize,
    pub(crate) step: f64,
    pub(crate) power: Vec<f64>,
}

impl PowerGrid {
    pub(crate) fn frequency(&self, index: usize) -> f64 {
        (self.first + index) as f64 * self.step
    }

    /// Interior grid points no lower than their neighbours, inside a window one step wider.
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

    /// `|H|` at the higher of the valleys beside a grid maximum.
    ///
    /// Each valley is the lowest point before `|H|` is higher than the maximum
    /// again, or before the grid ends.
    pub(crate) fn saddle(&self, index: usize) -> f64 {
        let top = self.power[index];
        let valley = |sequence: &mut dyn Iterator<Item = &f64>| {
            sequence
                .take_while(|power| **power <= top)
                .fold(top, |lowest, power| lowest.min(*power))
        };
        let left = valley(&mut self.power[..index].iter().rev());
        let right = valley(&mut self.power[index + 1..].iter());
        left.max(right).sqrt()
    }
}

/// Frequency of the maximum of `|H|` near a grid maximum, from the exact transform.
///
/// The derivative of `ln |H|^2` is bracketed by the grid points beside the
/// maximum and its root is found; `None` if the bracket holds no maximum.
pub(crate) fn refine(response: &impl Spectra, grid: &PowerGrid, index: usize) -> Option<f64> {
    let here = grid.frequency(index);
    let (power, slope) = response.power_and_slope(here);
    if slope == 0.0 {
        return Some(here);
    }
    let neighbour = if slope > 0.0 { index + 1 } else { index - 1 };
    // Between a point that rises towards a lower one and that one lies a
    // maximum: halve until the far end falls, and the root is bracketed.
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
