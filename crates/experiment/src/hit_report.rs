//! Results of one hit, and their statistics over hits.

use asperity_signal::{AnalysedHit, HitFeatures, QualityIssue};
use serde::Serialize;

use crate::hit_second_peak::HitSecondPeak;

/// Results of one hit.
#[allow(clippy::struct_excessive_bools, reason = "each is a key of the file format")]
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct HitReport {
    /// File.
    pub file: String,
    /// Number through all files, from 1.
    pub index: usize,
    /// Record in the file, from 1.
    pub record: usize,
    /// Time of the trigger on the time axis of the record \[s\].
    pub time_s: f64,
    /// Number of samples.
    pub samples: usize,
    /// Largest force, interpolated between the samples \[N\]; `None` without a pulse.
    pub force_peak_n: Option<f64>,
    /// Impulse of the force pulse \[N s\].
    pub impulse_ns: Option<f64>,
    /// Full width of the force pulse at half its height \[s\].
    pub pulse_width_s: Option<f64>,
    /// True for a second impact of the hammer.
    pub double_hit: bool,
    /// True for a saturated signal.
    pub overload: bool,
    /// True for a constant or lost signal.
    pub dropout: bool,
    /// True for a hit in the average.
    pub averaged: bool,
    /// True where troughs of the acceleration are flat at gravity, as while a contact is open.
    pub contact_lost: bool,
    /// Quality issues, in words.
    #[serde(rename = "verdicts")]
    pub issues: Vec<String>,
    /// Fundamental; `None` without a peak, or for an excluded hit.
    pub fundamental: Option<HitFundamental>,
    /// Time after the trigger at which the response is noise and the features end \[s\]; `None`
    /// where they are of the whole hit.
    pub response_end_s: Option<f64>,
    /// Peak in 1.7 to 2.3 of f1 that is well above the noise.
    pub second_peak: Option<HitSecondPeak>,
    /// Second harmonic: the second peak, where the test decided that it is the harmonic.
    pub second_harmonic: Option<HitSecondHarmonic>,
    /// Harmonic ratio A2/A1, a ratio of receptances.
    pub harmonic_ratio: Option<f64>,
    /// Standard deviation of the ratio due to noise.
    pub harmonic_ratio_uncertainty: Option<f64>,
    /// Time from the first impact to the last of a force that rings \[s\].
    #[serde(skip)]
    pub(crate) ring_s: Option<f64>,
}

/// Most further impacts of a hammer that bounces; more are ringing.
const MOST_BOUNCES: usize = 3;

/// Fundamental of a hit, corrected for an exponential window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HitFundamental {
    /// Frequency f1 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A1 \[m/N\].
    pub magnitude: f64,
    /// Half-power damping ratio; `None` for a peak that does not fall to half power.
    pub damping_ratio: Option<f64>,
    /// Damping ratio of the circle fit to the mobility.
    pub damping_ratio_circle: Option<f64>,
    /// Damping ratio of the logarithmic decrement of the filtered decay.
    pub damping_ratio_decrement: Option<f64>,
    /// Standard deviation of the frequency due to noise \[Hz\].
    pub frequency_uncertainty_hz: Option<f64>,
    /// Standard deviation of the receptance due to noise \[m/N\].
    pub magnitude_uncertainty: Option<f64>,
    /// Standard deviation of the half-power damping ratio due to noise.
    pub damping_ratio_uncertainty: Option<f64>,
    /// Standard deviation of the damping ratio of the circle fit due to noise.
    pub damping_ratio_circle_uncertainty: Option<f64>,
    /// Standard deviation of the damping ratio of the decrement due to noise.
    pub damping_ratio_decrement_uncertainty: Option<f64>,
    /// Undamped natural frequency of the circle fit \[Hz\].
    pub natural_frequency_hz: Option<f64>,
    /// Standard deviation of the natural frequency due to noise \[Hz\].
    pub natural_frequency_uncertainty_hz: Option<f64>,
    /// Modal constant of the circle fit, real and imaginary \[1/kg\]; for a real mode its reciprocal
    /// is the modal mass.
    pub modal_constant_per_kg: Option<[f64; 2]>,
    /// Standard deviation of its magnitude due to noise \[1/kg\].
    pub modal_constant_uncertainty_per_kg: Option<f64>,
}

/// Second harmonic of a hit, not corrected for an exponential window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HitSecondHarmonic {
    /// Frequency f2 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A2 \[m/N\].
    pub magnitude: f64,
}

/// Statistics of a quantity over the hits.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct HitStatistics {
    /// Number of hits with the quantity.
    pub hits: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation, with `n - 1`; `None` for one hit.
    pub standard_deviation: Option<f64>,
    /// Smallest.
    pub smallest: f64,
    /// Largest.
    pub largest: f64,
}

impl HitReport {
    /// Report of a hit, without its number.
    pub(crate) fn new(
        file: String,
        record: usize,
        start_s: f64,
        rate: f64,
        hit: &AnalysedHit,
    ) -> Self {
        let any = |fits: fn(&QualityIssue) -> bool| hit.issues.iter().any(fits);
        let features = hit.features.as_ref();
        let is_noise = features.is_some_and(|found| {
            found.mode.frequency_hz.is_some() && found.fundamental_uncertainty.is_none()
        });
        let doubtful = is_noise.then(|| "the peak at f1 may be noise".to_owned());
        let impacts = || {
            hit.issues.iter().filter_map(|issue| match issue {
                QualityIssue::DoubleHit(double) => Some(double),
                _ => None,
            })
        };
        let last = impacts().map(|double| double.second_s - double.first_s).reduce(f64::max);
        let ring_s = last.filter(|_| impacts().count() > MOST_BOUNCES);
        let rings = ring_s.map(|ring| {
            let further = impacts().count();
            format!("the force rings for {ring:.3} s after the first impact ({further} peaks)")
        });
        let is_told =
            |issue: &&QualityIssue| rings.is_none() || !matches!(issue, QualityIssue::DoubleHit(_));
        Self {
            file,
            index: 0,
            record,
            time_s: start_s + (hit.start + hit.trigger as u64) as f64 / rate,
            samples: hit.samples,
            force_peak_n: hit.pulse.map(|pulse| pulse.refined_peak_n),
            impulse_ns: hit.pulse.map(|pulse| pulse.impulse_n_s),
            pulse_width_s: hit.pulse.map(|pulse| pulse.width_s),
            double_hit: any(|issue| matches!(issue, QualityIssue::DoubleHit(_))),
            overload: any(|issue| {
                matches!(
                    issue,
                    QualityIssue::Overload { .. }
                        | QualityIssue::Clipped { .. }
                        | QualityIssue::NotFinite { infinite: true, .. }
                )
            }),
            dropout: any(|issue| {
                matches!(
                    issue,
                    QualityIssue::Dropout { .. } | QualityIssue::NotFinite { infinite: false, .. }
                )
            }),
            averaged: hit.is_averaged(),
            contact_lost: false,
            issues: rings
                .iter()
                .cloned()
                .chain(hit.issues.iter().filter(is_told).map(ToString::to_string))
                .chain(doubtful)
                .collect(),
            ring_s,
            fundamental: features.and_then(HitFundamental::of),
            response_end_s: hit
                .response_window
                .map(|window| window.end_s + window.taper_s - hit.trigger as f64 / rate),
            second_peak: features.and_then(HitSecondPeak::of),
            second_harmonic: None,
            harmonic_ratio: None,
            harmonic_ratio_uncertainty: None,
        }
    }

    /// Leaves a hit out of averages and statistics that someone has rejected.
    pub(crate) fn reject(&mut self) {
        self.averaged = false;
        self.issues.insert(0, "rejected".to_owned());
        (self.fundamental, self.second_peak, self.second_harmonic) = (None, None, None);
    }

    /// Takes the second peak as the second harmonic.
    pub(crate) fn accept_harmonic(&mut self) {
        if let Some(peak) = &self.second_peak {
            self.second_harmonic = Some(HitSecondHarmonic {
                frequency_hz: peak.frequency_hz,
                magnitude: peak.magnitude,
            });
            self.harmonic_ratio = Some(peak.ratio);
            self.harmonic_ratio_uncertainty = peak.ratio_uncertainty;
        }
    }
}

impl HitFundamental {
    fn of(found: &HitFeatures) -> Option<Self> {
        let sigma = found.fundamental_uncertainty;
        // A peak that may be noise has no standard deviations.
        let mode = sigma.map(|_| found.mode_uncertainty).unwrap_or_default();
        Some(Self {
            frequency_hz: found.mode.frequency_hz?,
            magnitude: found.mode.magnitude?,
            damping_ratio: found.mode.damping.half_power,
            damping_ratio_circle: found.mode.damping.circle,
            damping_ratio_decrement: found.mode.damping.decrement,
            frequency_uncertainty_hz: sigma.map(|sigma| sigma.frequency_hz),
            magnitude_uncertainty: mode.magnitude,
            damping_ratio_uncertainty: mode.half_power,
            damping_ratio_circle_uncertainty: mode.circle,
            damping_ratio_decrement_uncertainty: mode.decrement,
            natural_frequency_hz: found.mode.natural_hz,
            natural_frequency_uncertainty_hz: mode.natural_hz,
            modal_constant_per_kg: found.mode.modal_constant.map(|value| [value.re, value.im]),
            modal_constant_uncertainty_per_kg: mode.modal_constant,
        })
    }
}

impl HitStatistics {
    /// Statistics of some values; `None` without any.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.collect();
        let hits = values.len();
        let mean = values.iter().sum::<f64>() / hits as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (hits > 0).then(|| Self {
            hits,
            mean,
            standard_deviation: (hits > 1).then(|| (squares / (hits as f64 - 1.0)).sqrt()),
            smallest: values.iter().copied().fold(f64::INFINITY, f64::min),
            largest: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
    }
}
