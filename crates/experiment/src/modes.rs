//! Modes of the band over all hits and responses: the modal table.

use asperity_signal::{AmplitudeTrend, BandMode, Complex64, DecayPoint, HitFeatures};
use serde::Serialize;

use crate::hit_report::HitReport;

/// Part of the averaged hits of a response in which a mode must be found.
const MAJORITY: f64 = 0.5;

/// A mode of the structure in the band.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mode {
    /// Number by frequency, from 1.
    #[serde(rename = "mode")]
    pub number: usize,
    /// Undamped natural frequency over all responses \[Hz\].
    pub natural_frequency_hz: f64,
    /// Its standard deviation \[Hz\]; `None` without noise for a single hit.
    pub natural_frequency_uncertainty_hz: Option<f64>,
    /// Damping ratio over all responses.
    pub damping_ratio: f64,
    /// Its standard deviation.
    pub damping_ratio_uncertainty: Option<f64>,
    /// Responses in which the mode was found.
    pub responses: Vec<ModeAtResponse>,
}

/// A mode at one response, by circle fits to the mobility of each hit.
///
/// ```text
/// H(w) = A / (w0^2 - w^2 + 2 i zeta w0 w) + rest
/// ```
///
/// with the modal constant `A`; the residue at the pole is `A / (2 i w0 sqrt(1 - zeta^2))`. Values are
/// means over the hits, weighted by their variances due to noise. Standard deviations are those of
/// the weighted mean, times the root of the reduced chi-square where the hits scatter more than
/// their noise, as with forces that change the mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeAtResponse {
    /// Channel.
    pub response: String,
    /// Hits in which the mode was found.
    pub hits: usize,
    /// Mean frequency of the largest receptance \[Hz\].
    pub peak_frequency_hz: f64,
    /// Undamped natural frequency \[Hz\].
    pub natural_frequency_hz: f64,
    /// Its standard deviation \[Hz\].
    pub natural_frequency_uncertainty_hz: Option<f64>,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Its standard deviation.
    pub damping_ratio_uncertainty: Option<f64>,
    /// Modal constant, real and imaginary \[1/kg\].
    pub modal_constant_per_kg: [f64; 2],
    /// Standard deviation of its magnitude \[1/kg\].
    pub modal_constant_uncertainty_per_kg: Option<f64>,
    /// Phase of the modal constant \[degree\]; 0 or 180 for a real mode.
    pub phase_deg: f64,
    /// Largest change of the frequency from the smallest to the largest amplitude within a hit \[Hz\], where it is
    /// beyond five deviations of the natural frequency: the mode is nonlinear, and its backbone describes it. Half
    /// of it is then the least deviation of the natural frequency, and the distance of the damping ratio from that of
    /// the decrement its least deviation.
    pub frequency_change_hz: Option<f64>,
}

/// Modes of one response in one hit.
#[derive(Debug, Clone, Default)]
pub(crate) struct HitModes(Vec<HitMode>);

/// A mode of one hit.
#[derive(Debug, Clone, Copy)]
struct HitMode {
    mode: BandMode,
    /// Change of the frequency within the hit, of a nonlinear mode \[Hz\].
    change_hz: Option<f64>,
}

impl HitModes {
    /// The modes in the band. A nonlinear mode sweeps a range of frequencies, in which further peaks are its own.
    pub(crate) fn of(features: Option<&HitFeatures>) -> Self {
        let Some(features) = features else { return Self::default() };
        let linear = |mode: &BandMode| HitMode { mode: *mode, change_hz: None };
        let mut modes: Vec<HitMode> = features.modes.iter().map(linear).collect();
        let peak = features.harmonics.fundamental.map_or(f64::NAN, |peak| peak.frequency_hz);
        let is_own = |one: &HitMode| (one.mode.peak.frequency_hz / peak - 1.0).abs() < SAME;
        if let (Some(trend), Some(own)) =
            (frequency_trend(features), modes.iter_mut().find(|one| is_own(one)))
        {
            let sigma = own.mode.uncertainty.natural_hz.unwrap_or(0.0);
            if trend.change().abs() > NONLINEAR * sigma {
                own.change_hz = Some(trend.change());
                let width = own.mode.features.damping.circle.unwrap_or(0.0) * peak;
                let (a, b) = (trend.at_smallest, trend.at_largest);
                let swept = a.min(b) - width..=a.max(b) + width;
                modes.retain(|one| is_own(one) || !swept.contains(&one.mode.peak.frequency_hz));
            }
        }
        Self(modes)
    }
}

/// Significant change of the frequency with amplitude along the backbone of a hit.
fn frequency_trend(features: &HitFeatures) -> Option<AmplitudeTrend> {
    let points = &features.backbone.as_ref()?.points;
    let both = points.iter().zip(&features.backbone_uncertainty);
    let points: Vec<DecayPoint> = both
        .map(|(&point, &uncertainty)| DecayPoint { point, uncertainty, harmonics: [None; 2] })
        .collect();
    let value = |one: &DecayPoint| (one.point.frequency_hz, one.uncertainty.frequency_hz);
    AmplitudeTrend::of(&points, value).filter(AmplitudeTrend::is_significant)
}

/// Modes of one response in all hits.
pub(crate) struct ResponseModes {
    name: String,
    /// Averaged hits.
    averaged: usize,
    hits: Vec<HitModes>,
}

impl ResponseModes {
    /// The modes of a response, without the peaks that are second harmonics.
    pub(crate) fn new(
        name: String,
        averaged: usize,
        mut hits: Vec<HitModes>,
        reports: &[HitReport],
    ) -> Self {
        for (modes, hit) in hits.iter_mut().zip(reports) {
            if let Some(harmonic) = &hit.second_harmonic {
                let is_harmonic = |mode: &BandMode| {
                    (mode.peak.frequency_hz / harmonic.frequency_hz - 1.0).abs() < SAME
                };
                modes.0.retain(|one| !is_harmonic(&one.mode));
            }
        }
        Self { name, averaged, hits }
    }
}

/// Relative difference of the frequencies of one peak under two windows.
const SAME: f64 = 5e-3;
/// Least change of the frequency of a nonlinear mode within a hit, in standard deviations.
const NONLINEAR: f64 = 5.0;

/// A mode of one hit at one response, with the number of both.
struct Found<'a> {
    response: usize,
    hit: usize,
    mode: &'a BandMode,
    change_hz: Option<f64>,
}

impl Found<'_> {
    fn natural_hz(&self) -> f64 {
        self.mode.features.natural_hz.unwrap_or(self.mode.peak.frequency_hz)
    }

    /// Half of the half-power width \[Hz\].
    fn half_width(&self) -> f64 {
        self.mode.features.damping.circle.unwrap_or(0.0) * self.natural_hz()
    }
}

impl Mode {
    /// Groups the modes of all hits and responses by frequency.
    ///
    /// Sorted by frequency, two neighbours belong to one mode if they are closer than half of the
    /// wider of their half-power widths. A mode must be in half of the hits of a response.
    pub(crate) fn of(responses: &[ResponseModes]) -> Vec<Self> {
        let mut all: Vec<Found<'_>> = Vec::new();
        for (response, modes) in responses.iter().enumerate() {
            for (hit, modes) in modes.hits.iter().enumerate() {
                all.extend(modes.0.iter().map(|HitMode { mode, change_hz }| Found {
                    response,
                    hit,
                    mode,
                    change_hz: *change_hz,
                }));
            }
        }
        all.sort_by(|a, b| a.natural_hz().total_cmp(&b.natural_hz()));
        let same = |a: &Found<'_>, b: &Found<'_>| {
            let is_one_hit = (a.response, a.hit) == (b.response, b.hit);
            !is_one_hit && b.natural_hz() - a.natural_hz() <= a.half_width().max(b.half_width())
        };
        let groups = all.chunk_by(same);
        let mut modes: Vec<Self> =
            groups.filter_map(|group| Self::of_group(group, responses)).collect();
        for (number, mode) in modes.iter_mut().enumerate() {
            mode.number = number + 1;
        }
        modes
    }

    fn of_group(group: &[Found<'_>], responses: &[ResponseModes]) -> Option<Self> {
        let at = |response: usize| {
            let own = || group.iter().filter(|one| one.response == response);
            let of: Vec<&BandMode> = own().map(|one| one.mode).collect();
            let ResponseModes { name, averaged, .. } = &responses[response];
            let is_common = !of.is_empty() && of.len() as f64 >= MAJORITY * *averaged as f64;
            let changes = own().filter_map(|one| one.change_hz);
            let change_hz = changes.max_by(|a, b| a.abs().total_cmp(&b.abs()));
            is_common.then(|| ModeAtResponse::of(name, &of, change_hz)).flatten()
        };
        let responses: Vec<ModeAtResponse> = (0..responses.len()).filter_map(at).collect();
        let frequencies = responses
            .iter()
            .map(|at| (at.natural_frequency_hz, at.natural_frequency_uncertainty_hz));
        let ratios = responses.iter().map(|at| (at.damping_ratio, at.damping_ratio_uncertainty));
        let (frequency, ratio) = (WeightedMean::of(frequencies)?, WeightedMean::of(ratios)?);
        Some(Self {
            number: 0,
            natural_frequency_hz: frequency.value,
            natural_frequency_uncertainty_hz: frequency.deviation,
            damping_ratio: ratio.value,
            damping_ratio_uncertainty: ratio.deviation,
            responses,
        })
    }
}

impl ModeAtResponse {
    fn of(name: &str, hits: &[&BandMode], change_hz: Option<f64>) -> Option<Self> {
        let frequency = WeightedMean::of(
            hits.iter()
                .filter_map(|hit| Some((hit.features.natural_hz?, hit.uncertainty.natural_hz))),
        )?;
        let ratio = WeightedMean::of(
            hits.iter()
                .filter_map(|hit| Some((hit.features.damping.circle?, hit.uncertainty.circle))),
        )?;
        let constants = || {
            hits.iter().filter_map(|hit| {
                Some((hit.features.modal_constant?, hit.uncertainty.modal_constant))
            })
        };
        let part = |part: fn(Complex64) -> f64| {
            WeightedMean::of(constants().map(|(value, deviation)| (part(value), deviation)))
        };
        let constant = Complex64::new(part(|value| value.re)?.value, part(|value| value.im)?.value);
        let size = part(Complex64::norm)?;
        let peaks: f64 = hits.iter().map(|hit| hit.peak.frequency_hz).sum();
        let apart = hits.iter().filter_map(|hit| {
            let damping = hit.features.damping;
            Some((damping.circle? - damping.decrement?).abs())
        });
        Some(Self {
            response: name.to_owned(),
            hits: hits.len(),
            peak_frequency_hz: peaks / hits.len() as f64,
            natural_frequency_hz: frequency.value,
            natural_frequency_uncertainty_hz: change_hz.map_or(frequency.deviation, |change| {
                Some(frequency.deviation.unwrap_or(0.0).max(0.5 * change.abs()))
            }),
            damping_ratio: ratio.value,
            damping_ratio_uncertainty: change_hz.map_or(ratio.deviation, |_| {
                Some(apart.fold(ratio.deviation.unwrap_or(0.0), f64::max))
            }),
            modal_constant_per_kg: [constant.re, constant.im],
            modal_constant_uncertainty_per_kg: size.deviation,
            phase_deg: constant.arg().to_degrees(),
            frequency_change_hz: change_hz,
        })
    }
}

/// Mean of values with standard deviations.
struct WeightedMean {
    value: f64,
    deviation: Option<f64>,
}

impl WeightedMean {
    /// Weighted by the reciprocal variances, where all are known and positive; else the plain mean
    /// with the scatter. `None` without a value.
    fn of(values: impl Iterator<Item = (f64, Option<f64>)>) -> Option<Self> {
        let values: Vec<(f64, Option<f64>)> = values.collect();
        let weight = |(_, deviation): &(f64, Option<f64>)| {
            deviation.map(|deviation| deviation.powi(-2)).filter(|w| w.is_finite())
        };
        let known: Option<Vec<f64>> = values.iter().map(weight).collect();
        let weights = known.clone().unwrap_or_else(|| vec![1.0; values.len()]);
        let total: f64 = weights.iter().sum();
        if values.is_empty() || total <= 0.0 {
            return None;
        }
        let sum: f64 = values.iter().zip(&weights).map(|((value, _), weight)| value * weight).sum();
        let value = sum / total;
        let squares = values.iter().zip(&weights).map(|((x, _), w)| w * (x - value).powi(2));
        let spread = squares.sum::<f64>() / (values.len() as f64 - 1.0);
        let deviation = match (known.is_some(), values.len()) {
            (true, 1) => Some((1.0 / total).sqrt()),
            (true, _) => Some((spread.max(1.0) / total).sqrt()),
            (false, 1) => None,
            (false, _) => Some((spread / total).sqrt()),
        };
        Some(Self { value, deviation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against closed forms: equal weights, one deviation, scatter above the noise, and no noise.
    #[test]
    fn means_are_weighted_by_variances() {
        let mean =
            |values: &[(f64, Option<f64>)]| WeightedMean::of(values.iter().copied()).unwrap();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        let two = mean(&[(1.0, Some(0.5)), (2.0, Some(1.0))]);
        close(two.value, (1.0 / 0.25 + 2.0) / (1.0 / 0.25 + 1.0));
        close(two.deviation.unwrap(), (1.0_f64 / 5.0).sqrt());
        let scattered = mean(&[(1.0, Some(0.1)), (2.0, Some(0.1)), (3.0, Some(0.1))]);
        close(scattered.deviation.unwrap(), (1.0_f64 / 3.0).sqrt());
        let plain = mean(&[(1.0, None), (2.0, Some(0.1)), (3.0, None)]);
        close(plain.deviation.unwrap(), (1.0_f64 / 3.0).sqrt());
        assert!(mean(&[(1.0, None)]).deviation.is_none());
        assert!(mean(&[(1.0, Some(0.0))]).deviation.is_none());
        assert!(WeightedMean::of(std::iter::empty()).is_none());
    }
}
