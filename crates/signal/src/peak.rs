//! Local maxima of a receptance, found on a grid and refined on the transform.

use crate::fit::parabola_vertex;
use crate::form::ResponseKind;
use crate::root::bracketed_root;
use crate::spectra::{BandSpectra, HitSpectra};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

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
#[derive(Default)]
pub(crate) struct PowerGrid {
    pub(crate) first: usize,
    pub(crate) step: f64,
    pub(crate) power: Vec<f64>,
    /// The same with the [vertices](sinusoid_vertex) of maxima and minima in their places.
    pub(crate) heights: Vec<f64>,
    /// Magnitude of the transform of the force.
    pub(crate) force: Vec<f64>,
    /// Magnitude of the force below which `|H|` tells nothing.
    pub(crate) force_floor: f64,
}

impl PowerGrid {
    /// `|H|^2` of a band, from one point below `low` (Hz); infinite where it is undefined, which is
    /// never below its neighbours. The force is too weak below a part `threshold` of its largest magnitude in the band.
    pub(crate) fn of(band: &BandSpectra<'_>, kind: ResponseKind, low: f64, threshold: f64) -> Self {
        let first = ((low / band.step) as usize).saturating_sub(1).max(1);
        let twice = 2 * kind.derivatives();
        let power = |(k, (x, f)): (usize, (&Complex64, &Complex64))| {
            let power = x.norm_sqr() / f.norm_sqr();
            let omega = TAU * k as f64 * band.step;
            if power.is_nan() { f64::INFINITY } else { power / omega.powi(twice) }
        };
        let pairs = band.samples.iter().zip(band.force.iter()).enumerate().skip(first);
        let power: Vec<f64> = pairs.map(power).collect();
        let mut heights = power.clone();
        let turn = TAU * band.step * band.duration;
        for (height, three) in heights.iter_mut().skip(1).zip(power.windows(3)) {
            *height = sinusoid_vertex([three[0], three[1], three[2]], turn);
        }
        let force = band.force.iter().skip(first).map(|force| force.norm()).collect();
        let strongest = band.force.iter().map(Complex64::norm_sqr).fold(0.0, f64::max).sqrt();
        let force_floor = threshold * strongest;
        Self { first, step: band.step, power, heights, force, force_floor }
    }

    pub(crate) fn frequency(&self, index: usize) -> f64 {
        (self.first + index) as f64 * self.step
    }

    /// Frequency \[Hz\] of the largest local maximum of the transform of the response, as a displacement.
    pub(crate) fn oscillation_hz(&self) -> Option<f64> {
        let motion = |k: usize| self.power[k].sqrt() * self.force[k];
        let inner = 1..self.power.len().saturating_sub(1);
        let threes = inner.map(|k| (k, [motion(k - 1), motion(k), motion(k + 1)]));
        let maxima = threes.filter(|(_, [left, here, right])| here > left && here >= right);
        let (k, three) = maxima.max_by(|(_, a), (_, b)| a[1].total_cmp(&b[1]))?;
        let (shift, _) = parabola_vertex(three)?;
        Some(self.frequency(k) + shift * self.step)
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
    /// Each is the lowest before `|H|` exceeds the maximum again, where the force is strong enough, or the grid ends: a pole
    /// beside a zero of the force may lie between two points of the grid.
    pub(crate) fn saddle(&self, index: usize) -> f64 {
        self.saddle_above(index, &|_, _| 0.0)
    }

    /// The same of `|H| + ripple`, with the ripple at a frequency \[Hz\] under a force of this spectral magnitude.
    pub(crate) fn saddle_above(&self, index: usize, ripple: &impl Fn(f64, f64) -> f64) -> f64 {
        let [left, right] = self.lowest(index, &self.heights, ripple);
        left.1.max(right.1)
    }

    /// The same where a pole ends a side at a weak force too.
    pub(crate) fn saddle_to_poles(&self, index: usize, ripple: &impl Fn(f64, f64) -> f64) -> f64 {
        let [left, right] = self.lowest_at(index, &self.heights, 0.0, ripple);
        left.1.max(right.1)
    }

    /// The same of the points alone, which is no less: of a minimum beside a pole, as where the force vanishes, a sinusoid
    /// may be far too low.
    pub(crate) fn saddle_above_points(
        &self,
        index: usize,
        ripple: &impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let [left, right] = self.lowest(index, &self.power, ripple);
        left.1.max(right.1)
    }

    /// The same with both minima of `|H|` found on the transforms, where there is one between the points beside that of
    /// the grid.
    pub(crate) fn exact_saddle_above(
        &self,
        response: &impl HitSpectra,
        index: usize,
        ripple: &impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let exact = |(k, by_sinusoid): (usize, f64)| {
            let trough = if k == index { None } else { refine_trough(response, self, k) };
            trough.map_or(by_sinusoid, |frequency| {
                let force = response.force_magnitude(frequency);
                let lowest = response.power_and_slope(frequency).0.sqrt();
                self.above(k, self.power[k], ripple).min(lowest + ripple(frequency, force))
            })
        };
        let [left, right] = self.lowest(index, &self.heights, ripple).map(exact);
        left.max(right)
    }

    /// `|H| + ripple` at a point, of a power there.
    fn above(&self, k: usize, power: f64, ripple: &impl Fn(f64, f64) -> f64) -> f64 {
        power.sqrt() + ripple(self.frequency(k), self.force[k])
    }

    /// Places on either side of a maximum where `|H| + ripple` is lowest by these powers, and its value; its own where none is
    /// lower. Points where the force is too weak, and weaker than at the maximum, tell something only on a side that has no other.
    fn lowest(
        &self,
        index: usize,
        powers: &[f64],
        ripple: &impl Fn(f64, f64) -> f64,
    ) -> [(usize, f64); 2] {
        self.lowest_at(index, powers, self.force_floor.min(self.force[index]), ripple)
    }

    /// The same of the points with a force of `floor` or more.
    fn lowest_at(
        &self,
        index: usize,
        powers: &[f64],
        floor: f64,
        ripple: &impl Fn(f64, f64) -> f64,
    ) -> [(usize, f64); 2] {
        let top = self.heights[index];
        let value = |k: usize| (k, self.above(k, powers[k], ripple));
        let lowest = |beside: &mut dyn Iterator<Item = usize>, floor: f64| {
            let strong = beside.filter(|&k| self.force[k] >= floor);
            let lower = strong.take_while(|&k| self.heights[k] <= top).map(value);
            lower.min_by(|a, b| a.1.total_cmp(&b.1))
        };
        let before = |floor| lowest(&mut (0..index).rev(), floor);
        let after = |floor| lowest(&mut (index + 1..self.heights.len()), floor);
        [before(floor).or_else(|| before(0.0)), after(floor).or_else(|| after(0.0))]
            .map(|lowest| lowest.unwrap_or_else(|| value(index)))
    }
}

/// Crest or trough of `|H|^2` about a point that is not between its neighbours; the point itself otherwise.
///
/// The end of a record adds ripples, `|a + b exp(-i w T)|^2` with a duration `T`: of three equally spaced points, `turn`
/// apart in `w T`, on a sinusoid
///
/// ```text
/// mean = (left + right - 2 here cos(turn)) / (2 - 2 cos(turn))
/// amplitude = hypot(here - mean, (right - left) / (2 sin(turn)))
/// ```
///
/// The points alone would make heights depend on where the grid lies. Of wider extrema these are vertices too.
fn sinusoid_vertex([left, here, right]: [f64; 3], turn: f64) -> f64 {
    let is_crest = here >= left && here >= right;
    let is_trough = here <= left && here <= right;
    let (sin, cos) = turn.sin_cos();
    let mean = (left + right - 2.0 * here * cos) / (2.0 - 2.0 * cos);
    let amplitude = (here - mean).hypot((right - left) / (2.0 * sin));
    // Of points almost half a turn apart, or hardly apart, the sinusoid is not well known.
    let is_known = turn > 1e-3 && turn < 0.8 * PI && amplitude.is_finite();
    match (is_crest, is_trough) {
        (true, false) if is_known => here.max(mean + amplitude),
        (false, true) if is_known => (mean - amplitude).clamp(0.0, here),
        _ => here,
    }
}

/// Frequency of the maximum of `|H|` near a grid maximum: the root of the derivative of `ln |H|^2`
/// between the neighbouring grid points; `None` if there is no maximum between them.
pub(crate) fn refine(response: &impl HitSpectra, grid: &PowerGrid, index: usize) -> Option<f64> {
    refined(|frequency| response.power_and_slope(frequency), grid, index)
}

/// The same of a minimum.
fn refine_trough(response: &impl HitSpectra, grid: &PowerGrid, index: usize) -> Option<f64> {
    let negative = |frequency| {
        let (power, slope) = response.power_and_slope(frequency);
        (-power, -slope)
    };
    refined(negative, grid, index)
}

/// The maximum near a grid point of a power whose value and logarithmic slope are given, or of its negative.
fn refined(at: impl Fn(f64) -> (f64, f64), grid: &PowerGrid, index: usize) -> Option<f64> {
    let here = grid.frequency(index);
    let (power, slope) = at(here);
    if slope == 0.0 {
        return Some(here);
    }
    let neighbour = if slope > 0.0 { index + 1 } else { index.checked_sub(1)? };
    // A maximum lies between a point that rises towards a lower one and that one: bisect until
    // the far end falls, which brackets the root.
    let (mut near, mut near_power, mut near_slope) = (here, power, slope);
    let mut far = grid.frequency(neighbour);
    let (mut far_power, mut far_slope) = at(far);
    for _ in 0..60 {
        if (far_slope > 0.0) != (near_slope > 0.0) {
            let root = bracketed_root(
                |frequency| at(frequency).1,
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
        let (middle_power, middle_slope) = at(middle);
        let same = (middle_slope > 0.0) == (near_slope > 0.0);
        if same && middle_power > near_power {
            (near, near_power, near_slope) = (middle, middle_power, middle_slope);
        } else {
            (far, far_power, far_slope) = (middle, middle_power, middle_slope);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crests_and_troughs_of_a_sinusoid_are_exact_wherever_the_points_lie() {
        for degrees in [30.0_f64, 60.0, 89.0, 119.0, 140.0] {
            let turn = degrees.to_radians();
            for offset in [-0.45, -0.2, 0.0, 0.3, 0.49] {
                let [crest, trough] = [1.0, -1.0].map(|sign| {
                    let three = [-1.0, 0.0, 1.0].map(|k| 3.0 + sign * ((k + offset) * turn).cos());
                    sinusoid_vertex(three, turn)
                });
                assert!((crest - 4.0).abs() < 1e-12, "{degrees} {offset}: {crest}");
                assert!((trough - 2.0).abs() < 1e-12, "{degrees} {offset}: {trough}");
            }
        }
        assert_eq!(sinusoid_vertex([1.0, 2.0, 3.0], 1.5), 2.0);
        assert_eq!(sinusoid_vertex([1.0, 2.0, f64::INFINITY], 1.5), 2.0);
        assert_eq!(sinusoid_vertex([2.0, 2.0, 2.0], 1.5), 2.0);
        assert!((sinusoid_vertex([1.0, 0.1, 1.0], 0.01) - 0.1).abs() < 1e-9);
        assert_eq!(sinusoid_vertex([1.0, 0.1, 1.0], 1e-9), 0.1);
    }

    /// A trough of a closed form, and none where the power falls from one neighbour to the other.
    #[test]
    fn a_trough_is_found_between_its_neighbours() {
        let grid = PowerGrid { first: 10, step: 1.0, ..PowerGrid::default() };
        let at = |trough: f64| {
            move |frequency: f64| {
                let (x, least) = (frequency - trough, 0.01);
                (-(x * x + least), -2.0 * x / (x * x + least))
            }
        };
        for trough in [12.02_f64, 12.5, 12.98, 13.0] {
            let nearest = trough.round() as usize - 10;
            let found = refined(at(trough), &grid, nearest).unwrap();
            assert!((found - trough).abs() < 1e-9, "{trough}: {found}");
        }
        assert_eq!(refined(at(9.0), &grid, 0), None);
        assert_eq!(refined(at(20.0), &grid, 3), None);
    }
}
