//! Uncertainty of the features of a mode from noise.

use crate::damping::{CircleSensitivity, HalfPower, circle_fit, half_power_crossings};
use crate::decrement::decrement_of;
use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::ring_down::BackboneOptions;
use crate::uncertainty::{LogReceptanceTerms, NoiseDensity};
use crate::window::ExponentialWindow;
use num_complex::Complex64;

/// Standard deviations of [`ModeFeatures`](super::ModeFeatures) caused by noise, to first order.
///
/// Each feature is, for little noise, linear in the logarithm of the receptance at some
/// frequencies (the peak, the half-power crossings, the points of the circle) or in the extrema of
/// the filtered decay; the noise at these frequencies or times is correlated through the windows or
/// the filter. `None` where the feature itself is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ModeUncertainty {
    /// Of the receptance at the peak, with the correction for an exponential window, in m/N.
    pub magnitude: Option<f64>,
    /// Of the damping ratio from the half-power width.
    pub half_power: Option<f64>,
    /// Of the damping ratio from the circle.
    pub circle: Option<f64>,
    /// Of the damping ratio from the decrement.
    pub decrement: Option<f64>,
    /// Of the natural frequency of the circle fit, in hertz.
    pub natural_hz: Option<f64>,
    /// Of the magnitude of the modal constant of the circle fit, in 1/kg.
    pub modal_constant: Option<f64>,
}

impl ModeUncertainty {
    /// The deviations for a peak under an exponential window.
    pub(super) fn of(
        response: &FrequencyResponse,
        peak: &Peak,
        noise: &NoiseDensity,
        window: Option<ExponentialWindow>,
    ) -> Self {
        let width = half_power_crossings(response, peak);
        let circle = circle_fit(response, peak);
        let half_power_terms =
            width.and_then(|width| half_power_terms(response, peak, &width).zip(Some(width)));
        let circle_terms = width
            .zip(circle)
            .and_then(|(width, fit)| Some((CircleSensitivity::of(response, &width, &fit)?, fit)));
        let ratio = match (&circle_terms, &half_power_terms) {
            (Some((terms, fit)), _) => Some((terms.ratio.clone(), fit.ratio)),
            (None, Some((terms, width))) => {
                let ratio = width.ratio();
                Some((terms.clone().scaled(1.0 / ratio), ratio))
            }
            (None, None) => None,
        };
        let top = LogReceptanceTerms { terms: vec![(peak.frequency_hz, Complex64::ONE)] };
        let (ln_height, factor) = match (window, ratio) {
            (None, _) => (Some(top), 1.0),
            (Some(window), Some((terms, ratio))) => {
                let sigma = std::f64::consts::TAU * peak.frequency_hz * ratio;
                let without = sigma - window.rate();
                let both = top.plus(&terms.scaled(-window.rate() / without));
                (Some(both), sigma / without)
            }
            (Some(_), None) => (None, 1.0),
        };
        let deviation = |terms: &LogReceptanceTerms| terms.deviation(response, noise);
        Self {
            magnitude: ln_height
                .and_then(|terms| Some(factor.abs() * peak.magnitude * deviation(&terms)?)),
            half_power: half_power_terms.and_then(|(terms, _)| deviation(&terms)),
            circle: circle_terms
                .as_ref()
                .and_then(|(terms, fit)| Some(fit.ratio * deviation(&terms.ratio)?)),
            natural_hz: circle_terms
                .as_ref()
                .and_then(|(terms, fit)| Some(fit.natural_hz * deviation(&terms.natural)?)),
            modal_constant: circle_terms.as_ref().and_then(|(terms, fit)| {
                Some(fit.modal_constant.norm() * deviation(&terms.modal_constant)?)
            }),
            decrement: None,
        }
    }

    /// Adds the deviation of the decrement of a filtered decay.
    ///
    /// ```text
    /// var zeta = S integral G(f)^2 |sum_k a_k exp(-i 2 pi f t_k)|^2 df
    /// ```
    ///
    /// with the derivatives `a_k` with respect to the extrema at `t_k`, and the gain `G` of the
    /// filter.
    pub(super) fn with_decrement(
        mut self,
        decay: &[f64],
        sample_rate_hz: f64,
        frequency_hz: f64,
        noise_density: f64,
        settings: &BackboneOptions,
    ) -> Self {
        let (band, filter) = (&settings.band, settings.filter());
        let Some((_, extrema)) = decrement_of(decay, sample_rate_hz, frequency_hz) else {
            return self;
        };
        let span = extrema.last().map_or(0.0, |last| last.0) - extrema[0].0;
        let margin = 0.5 * band.width_hz();
        let (low, high) = ((band.low_hz() - margin).max(0.0), band.high_hz() + margin);
        let points = 64 + (8.0 * span * (high - low)) as usize;
        let step = (high - low) / points as f64;
        let power = |point: usize| {
            let frequency = low + (point as f64 + 0.5) * step;
            let omega = std::f64::consts::TAU * frequency;
            let sum: Complex64 =
                extrema.iter().map(|(time, a)| Complex64::from_polar(*a, -omega * time)).sum();
            (filter.gain(frequency) * sum.norm()).powi(2)
        };
        let variance = noise_density * step * (0..points).map(power).sum::<f64>();
        self.decrement = Some(variance.sqrt()).filter(|deviation| deviation.is_finite());
        self
    }
}

/// The change of the half-power damping ratio, as in
/// [`PeakSensitivity`](crate::PeakSensitivity): a crossing moves by the change of `ln |H|^2` at the
/// peak less that at the crossing, over the slope there.
fn half_power_terms(
    response: &FrequencyResponse,
    peak: &Peak,
    width: &HalfPower,
) -> Option<LogReceptanceTerms> {
    use crate::spectra::HitSpectra;
    let (a, b) = (width.lower_hz, width.upper_hz);
    let sum = a * a + b * b;
    let q = (b - a) * (b + a) / sum;
    let factor = 2.0 * (0.5 * (0.5 * q.atan()).cos()) / (1.0 + q * q) * 4.0 * a * b / (sum * sum);
    let slope = |frequency: f64| response.power_and_slope(frequency).1;
    let (lower, upper) = (-factor * b / slope(a), factor * a / slope(b));
    let terms = [(peak.frequency_hz, lower + upper), (a, -lower), (b, -upper)];
    let finite = terms.iter().all(|(_, c)| c.is_finite());
    finite.then(|| LogReceptanceTerms {
        terms: terms.iter().map(|(f, c)| (*f, Complex64::from(*c))).collect(),
    })
}
