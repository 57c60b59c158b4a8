//! Change of a quantity of a decay with its amplitude.

use super::one_mode::DecayPoint;
use crate::fit::orthogonal;

/// Points a quarter of a line apart share noise: four count as one.
const SHARED: f64 = 4.0;
/// Least curvature over amplitude, in standard deviations.
const CURVED: f64 = 3.0;

/// Change of a frequency or a damping ratio with amplitude along a decay.
///
/// ```text
/// y = b_0 + b_1 A + b_2 A^2
/// ```
///
/// by least squares over all points, weighted by their noise; `b_2` only where it is significant. The deviation
/// is due to the noise, or to the scatter about the curve where that is larger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplitudeTrend {
    /// Value of the curve at the smallest amplitude.
    pub at_smallest: f64,
    /// Value of the curve at the largest amplitude.
    pub at_largest: f64,
    /// Standard deviation of the difference of both.
    pub change_uncertainty: f64,
}

impl AmplitudeTrend {
    /// The trend of `value`, which gives a quantity of a point and its standard deviation; `None` for fewer than
    /// eight points.
    ///
    /// ```
    /// use asperity_signal::{AmplitudeTrend, FreeDecay, FreeDecayOptions};
    ///
    /// // The frequency falls by 1 % of 200 Hz at the largest amplitude.
    /// let (rate, fall) = (1e4, std::f64::consts::TAU * 200.0 * 0.005);
    /// let phase = |t: f64| 1256.6 * t - 12.566 * (1.0 - (-fall * t).exp()) / fall;
    /// let decay: Vec<f64> = (0..20_000)
    ///     .map(|n| f64::from(n) / rate)
    ///     .map(|t| (-fall * t).exp() * phase(t).cos())
    ///     .collect();
    /// let options = FreeDecayOptions {
    ///     resonance_hz: 200.0,
    ///     half_width_hz: f64::INFINITY,
    ///     search_half_width_hz: f64::INFINITY,
    ///     derivatives: 0,
    ///     noise_density: None,
    /// };
    /// let found = FreeDecay::of(&decay, rate, &options)?;
    /// let frequency = |one: &asperity_signal::DecayPoint| {
    ///     (one.point.frequency_hz, one.uncertainty.frequency_hz)
    /// };
    /// let trend = AmplitudeTrend::of(&found.points, frequency).ok_or("a decay has points")?;
    /// let amplitude = found.points[0].point.amplitude;
    /// assert!((trend.change() + 2.0 * amplitude).abs() < 1e-3 && trend.is_significant());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(points: &[DecayPoint], value: impl Fn(&DecayPoint) -> (f64, f64)) -> Option<Self> {
        let count = points.len();
        if (count as f64) < 2.0 * SHARED {
            return None;
        }
        let amplitude = |one: &DecayPoint| one.point.amplitude;
        let order =
            |a: &usize, b: &usize| amplitude(&points[*a]).total_cmp(&amplitude(&points[*b]));
        let (smallest, largest) = ((0..count).min_by(order)?, (0..count).max_by(order)?);
        let values: Vec<(f64, f64)> = points.iter().map(value).collect();
        let is_noisy = values.iter().all(|(_, sigma)| *sigma > 0.0);
        let weight = |(_, sigma): &(f64, f64)| if is_noisy { sigma.powi(-2) } else { 1.0 };
        let weights: Vec<f64> = values.iter().map(weight).collect();
        let scale = amplitude(&points[largest]);
        let column =
            |degree| points.iter().map(|one| (amplitude(one) / scale).powi(degree)).collect();
        let basis = orthogonal((0..=2).map(column), &weights);
        let mut rest: Vec<f64> = values.iter().map(|(y, _)| *y).collect();
        let mut terms = Vec::new();
        for (own, square) in &basis {
            let products = rest.iter().zip(own).zip(&weights).map(|((y, x), w)| y * x * w);
            let share = products.sum::<f64>() / square;
            rest.iter_mut().zip(own).for_each(|(y, x)| *y -= share * x);
            terms.push((share, own, *square));
        }
        let squares = rest.iter().zip(&weights).map(|(y, w)| y * y * w).sum::<f64>();
        let scatter = squares / (count as f64 - terms.len() as f64);
        let variance = SHARED * if is_noisy { scatter.max(1.0) } else { scatter };
        if terms.len() == 3 && terms[2].0.abs() < CURVED * (variance / terms[2].2).sqrt() {
            terms.pop();
        }
        let at = |place: usize| terms.iter().map(|(share, own, _)| share * own[place]).sum::<f64>();
        let change = |own: &[f64]| own[largest] - own[smallest];
        let spread = terms.iter().map(|(_, own, square)| change(own).powi(2) / square).sum::<f64>();
        let found = Self {
            at_smallest: at(smallest),
            at_largest: at(largest),
            change_uncertainty: (variance * spread).sqrt(),
        };
        (found.change() + found.change_uncertainty).is_finite().then_some(found)
    }

    /// Value at the largest less the value at the smallest amplitude.
    pub fn change(&self) -> f64 {
        self.at_largest - self.at_smallest
    }

    /// True for a change beyond three standard deviations and 1e-4 of the value.
    pub fn is_significant(&self) -> bool {
        let change = self.change().abs();
        change > 3.0 * self.change_uncertainty && change > 1e-4 * self.at_smallest.abs()
    }
}
