//! Content of `decay.json`, and the backbones that it reports.

use asperity_signal::{
    AmplitudeTrend, Beating, DecayEnd, DecayOrigin, DecayPoint, DecayResonance, FoundDecay,
    FreeDecay, LinearMode, TwoModes,
};
use serde::Serialize;

use super::signals::{DecayChannel, DecaySignals, ResponseSignal};
use crate::hit_second_peak::name as name_of_origin;
use crate::report::AnalysisProvenance;

/// Identifier of the format of `decay.json`.
pub const DECAY_SCHEMA: &str = "asperity/decay/1";

/// Report of free decays.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecayReport {
    /// [`DECAY_SCHEMA`].
    pub schema: &'static str,
    /// Responses of all files.
    pub channels: Vec<DecayChannel>,
    /// Settings, given or found.
    pub settings: DecaySettings,
    /// All decays, in the order of the files.
    pub decays: Vec<MeasuredDecay>,
    /// Results over all decays, in words.
    pub conclusions: Vec<String>,
    /// Assumptions and omissions.
    pub notices: Vec<String>,
    /// Version and files.
    pub provenance: AnalysisProvenance,
}

/// Settings of the analysis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecaySettings {
    /// Bands in which a mode was searched \[Hz\].
    pub bands_hz: Vec<[f64; 2]>,
    /// True for given bands.
    pub band_given: bool,
}

/// One decay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredDecay {
    /// Number through all files, from 1.
    pub index: usize,
    /// File.
    pub file: String,
    /// Record in the file, from 1.
    pub record: usize,
    /// Time of the blow, or of the end of the excitation, on the time axis of the record \[s\].
    pub onset_s: f64,
    /// End of the samples on the same axis \[s\].
    pub end_s: f64,
    /// `blow`, `release` (a sustained excitation ended) or `record_start`.
    pub origin: &'static str,
    /// `next_decay` or `record_end`.
    pub ended_by: &'static str,
    /// Results of each band and response.
    pub responses: Vec<DecayCurveReport>,
    /// Problems of the decay, in words.
    pub warnings: Vec<String>,
}

/// Backbone of one response in one decay.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayCurve {
    /// Number through all curves, from 1.
    pub index: usize,
    /// Number of the decay, from 1.
    pub decay: usize,
    /// Number of the band, from 1.
    pub band: usize,
    /// Name of the response.
    pub response: String,
    /// Unit of the response; empty if it has none.
    pub unit: String,
    /// Metres over the unit of the response, times the square, the first or no power of the angular
    /// frequency; `None` for an unknown unit.
    pub(super) metres: Option<(f64, i32)>,
    /// Time of the first sample of the decay on the time axis of the record \[s\].
    pub start_s: f64,
    /// Points in the order of time, after `start_s`; none where the band holds several modes.
    pub points: Vec<DecayPoint>,
}

impl DecayCurve {
    /// Amplitude of a point as a displacement \[m\], by the derivatives of a harmonic motion; `None`
    /// for an unknown unit.
    pub fn amplitude_m(&self, point: &DecayPoint) -> Option<f64> {
        let (factor, derivatives) = self.metres?;
        let omega = std::f64::consts::TAU * point.point.frequency_hz;
        Some(point.point.amplitude * factor / omega.powi(derivatives))
    }
}

/// One response in one band of a decay.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecayCurveReport {
    /// Number through all decays, bands and responses, from 1, as in `backbone.csv`.
    pub index: usize,
    /// Name of the response.
    pub response: String,
    /// Unit of the amplitudes without a unit in their name; empty if the file gives none.
    pub unit: String,
    /// Time of the first sample of the decay on the time axis of the record \[s\].
    pub start_s: f64,
    /// Time from there to the end of the backbone \[s\].
    pub length_s: f64,
    /// True where the decay then ends in noise, false where its samples end.
    pub reaches_noise: bool,
    /// Frequency of the strongest resonance in the band, of all responses \[Hz\].
    pub resonance_hz: f64,
    /// Limits of the filter \[Hz\].
    pub filter_hz: [f64; 2],
    /// Cycles of a line.
    pub cycles: f64,
    /// Number of points of the backbone.
    pub points: usize,
    /// Line through the whole decay; `None` without a backbone.
    pub mean: Option<DecayLevel>,
    /// Point of the largest amplitude.
    pub largest: Option<DecayLevel>,
    /// Point of the smallest amplitude.
    pub smallest: Option<DecayLevel>,
    /// Change of the frequency with amplitude \[Hz\]; `None` for few points.
    pub frequency_trend: Option<DecayTrend>,
    /// Change of the damping ratio with amplitude.
    pub damping_trend: Option<DecayTrend>,
    /// Two linear modes in the band and beside it, the stronger first; none where one mode explains the decay.
    pub modes: Vec<DecayMode>,
    /// Part of the decay that one mode with a frequency and damping that follow its amplitude leaves; zero where
    /// that is noise.
    pub misfit: f64,
    /// Second harmonic.
    pub second_harmonic: Option<DecayHarmonicReport>,
    /// Third harmonic.
    pub third_harmonic: Option<DecayHarmonicReport>,
    /// One-sided spectral density of the noise about the mode, in the squared unit per Hz.
    pub noise_density: f64,
    /// Smallest amplitude accepted, in the unit.
    pub floor: f64,
    /// Problems, in words.
    pub warnings: Vec<String>,
}

/// Amplitude, frequency and damping with their standard deviations due to noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DecayLevel {
    /// Amplitude, in the unit of the response.
    pub amplitude: f64,
    /// Amplitude of the displacement \[m\]; `None` for an unknown unit.
    pub amplitude_m: Option<f64>,
    /// Standard deviation of the amplitude over the amplitude.
    pub relative_amplitude_uncertainty: f64,
    /// Frequency of the damped oscillation \[Hz\].
    pub frequency_hz: f64,
    /// Its standard deviation \[Hz\].
    pub frequency_uncertainty_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Its standard deviation.
    pub damping_ratio_uncertainty: f64,
}

/// Change of a quantity with amplitude, by regression over the whole backbone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DecayTrend {
    /// Value of the curve at the smallest amplitude.
    pub at_smallest: f64,
    /// Value at the largest amplitude.
    pub at_largest: f64,
    /// Standard deviation of the difference.
    pub change_uncertainty: f64,
    /// True for a change beyond three standard deviations and 1e-4 of the value.
    pub is_significant: bool,
}

/// One of two linear modes in a band.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DecayMode {
    /// Frequency of the damped oscillation \[Hz\].
    pub frequency_hz: f64,
    /// Its standard deviation \[Hz\].
    pub frequency_uncertainty_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Its standard deviation.
    pub damping_ratio_uncertainty: f64,
    /// First amplitude over the amplitude of the stronger mode.
    pub amplitude_ratio: f64,
}

impl DecayMode {
    fn of(mode: &LinearMode) -> Self {
        let LinearMode {
            frequency_hz,
            frequency_uncertainty_hz,
            damping_ratio,
            damping_ratio_uncertainty,
            amplitude_ratio,
        } = *mode;
        Self {
            frequency_hz,
            frequency_uncertainty_hz,
            damping_ratio,
            damping_ratio_uncertainty,
            amplitude_ratio,
        }
    }
}

/// Harmonic of a response, at the largest amplitude where it is above the noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DecayHarmonicReport {
    /// Amplitude over the amplitude of the fundamental, as displacements; as measured where the
    /// quantity is unknown.
    pub ratio: f64,
    /// Standard deviation of the ratio due to noise.
    pub ratio_uncertainty: f64,
    /// Amplitude of the fundamental there, in the unit of the response.
    pub amplitude: f64,
    /// The same as a displacement \[m\].
    pub amplitude_m: Option<f64>,
    /// Drift of the phase, less twice the phase of the fundamental, over the decay \[rad\].
    pub phase_drift_rad: Option<f64>,
    /// Exponent `d ln a2 / d ln a1` along the decay.
    pub amplitude_exponent: Option<f64>,
    /// `harmonic` or `mode`, if the decay tells.
    pub origin: Option<&'static str>,
}

impl MeasuredDecay {
    pub(super) fn new(
        index: usize,
        file: &str,
        record: usize,
        signals: &DecaySignals,
        place: &FoundDecay,
    ) -> Self {
        let time = |sample: usize| signals.start_s + sample as f64 / signals.sample_rate_hz;
        Self {
            index,
            file: file.to_owned(),
            record,
            onset_s: time(place.onset),
            end_s: time(place.end),
            origin: match place.origin {
                DecayOrigin::Blow => "blow",
                DecayOrigin::Release => "release",
                _ => "record_start",
            },
            ended_by: match place.ended_by {
                DecayEnd::NextDecay => "next_decay",
                _ => "record_end",
            },
            responses: Vec::new(),
            warnings: Vec::new(),
        }
    }
}

impl DecayCurveReport {
    /// The results of a decay; without backbone and its features where the band holds several modes.
    pub(super) fn new(
        curve: &DecayCurve,
        resonance: &DecayResonance,
        found: &FreeDecay,
        signal: &ResponseSignal,
    ) -> Self {
        let points: &[DecayPoint] = if found.is_one_mode() { &found.points } else { &[] };
        let level = |one: &DecayPoint| DecayLevel::new(one, curve);
        let harmonic = |order: usize| {
            points.iter().find_map(|one| {
                let harmonic = one.harmonics[order]?;
                Some(DecayHarmonicReport {
                    ratio: harmonic.ratio,
                    ratio_uncertainty: harmonic.uncertainty,
                    amplitude: one.point.amplitude,
                    amplitude_m: curve.amplitude_m(one),
                    phase_drift_rad: None,
                    amplitude_exponent: None,
                    origin: None,
                })
            })
        };
        let trend = |value: fn(&DecayPoint) -> (f64, f64)| {
            let found = AmplitudeTrend::of(points, value)?;
            Some(DecayTrend {
                at_smallest: found.at_smallest,
                at_largest: found.at_largest,
                change_uncertainty: found.change_uncertainty,
                is_significant: found.is_significant(),
            })
        };
        let test = found.harmonic_test;
        let second_harmonic = harmonic(0).map(|of| DecayHarmonicReport {
            phase_drift_rad: test.map(|test| test.phase_drift),
            amplitude_exponent: test.map(|test| test.exponent),
            origin: test.and_then(|test| test.origin()).map(name_of_origin),
            ..of
        });
        Self {
            index: curve.index,
            response: curve.response.clone(),
            unit: curve.unit.clone(),
            start_s: curve.start_s,
            length_s: found.length_s,
            reaches_noise: found.reaches_noise,
            resonance_hz: resonance.frequency_hz,
            filter_hz: [found.band.low_hz(), found.band.high_hz()],
            cycles: found.cycles,
            points: points.len(),
            mean: found.mean.filter(|_| !points.is_empty()).map(|one| level(&one)),
            largest: points.first().map(level),
            smallest: points.last().map(level),
            frequency_trend: trend(|one| (one.point.frequency_hz, one.uncertainty.frequency_hz)),
            damping_trend: trend(|one| (one.point.damping_ratio, one.uncertainty.damping_ratio)),
            modes: found.two_modes.iter().flat_map(|two| &two.modes).map(DecayMode::of).collect(),
            misfit: found.misfit,
            second_harmonic,
            third_harmonic: harmonic(1),
            noise_density: found.noise_density,
            floor: found.floor,
            warnings: warnings(found, resonance, signal),
        }
    }
}

impl DecayLevel {
    fn new(one: &DecayPoint, curve: &DecayCurve) -> Self {
        let (point, sigma) = (one.point, one.uncertainty);
        Self {
            amplitude: point.amplitude,
            amplitude_m: curve.amplitude_m(one),
            relative_amplitude_uncertainty: sigma.relative_amplitude,
            frequency_hz: point.frequency_hz,
            frequency_uncertainty_hz: sigma.frequency_hz,
            damping_ratio: point.damping_ratio,
            damping_ratio_uncertainty: sigma.damping_ratio,
        }
    }
}

/// Part of a decay that one mode leaves which is told.
const MISFIT: f64 = 0.03;

/// Two linear modes in words.
fn two_modes(two: &TwoModes, has_backbone: bool) -> String {
    let show = |mode: &LinearMode| {
        let sigma = 100.0 * mode.damping_ratio_uncertainty;
        let frequency =
            format!("{:.3} ± {:.1e} Hz", mode.frequency_hz, mode.frequency_uncertainty_hz);
        format!("{frequency} with {:.4} ± {sigma:.0e} % of damping", 100.0 * mode.damping_ratio)
    };
    let [first, second] = &two.modes;
    let (weaker, error) = (100.0 * second.amplitude_ratio, 100.0 * two.decay_rate_error);
    let effect = if has_backbone {
        format!("the weaker changes the local damping ratios by up to {error:.0} %")
    } else {
        "no backbone, which is that of one mode".to_owned()
    };
    format!(
        "two linear modes explain the decay: {}, and {}, with {weaker:.0} % of the amplitude; {effect}",
        show(first),
        show(second)
    )
}

/// Least change of the local damping ratios by a beat that is told.
const RIPPLE: f64 = 0.05;

/// Problems of a decay in words.
fn warnings(found: &FreeDecay, resonance: &DecayResonance, signal: &ResponseSignal) -> Vec<String> {
    let filter = format!("{:.2} to {:.2} Hz", found.band.low_hz(), found.band.high_hz());
    let mut warnings = Vec::new();
    let has_backbone = found.is_one_mode() && !found.points.is_empty();
    let told = |two: &TwoModes| !has_backbone || two.decay_rate_error > RIPPLE;
    if let Some(two) = found.two_modes.filter(told) {
        warnings.push(two_modes(&two, has_backbone));
    } else if !found.is_one_mode() {
        warnings.push(match found.beating {
            Some(Beating { ratio, offset_hz, .. }) => format!(
                "no backbone: in {filter} two modes beat, {:.2} Hz apart, the weaker with {:.0} % of \
                 the amplitude; `band_hz` with one of them alone, or a response near its node, may \
                 separate them",
                offset_hz.abs(),
                100.0 * ratio.min(1.0)
            ),
            None => format!(
                "no backbone: in {filter} the amplitude grows or hardly falls during the decay, unlike \
                 that of one mode; several modes beat, or the structure is still excited; `band_hz` \
                 may separate them"
            ),
        });
    } else if let Some(beating) = found.beating.filter(|one| one.decay_rate_error > RIPPLE) {
        warnings.push(format!(
            "a weaker mode {:.2} Hz away changes the local damping ratios by up to {:.0} %",
            beating.offset_hz.abs(),
            100.0 * beating.decay_rate_error
        ));
    }
    if found.two_modes.is_some() {
        return warnings;
    }
    if has_backbone && found.misfit > MISFIT {
        warnings.push(format!(
            "one mode leaves {:.0} % of the decay unexplained, and two linear modes too: whether the band \
             holds one mode is not told",
            100.0 * found.misfit
        ));
    }
    if found.is_one_mode() && found.mean.is_none() && found.points.is_empty() && found.reaches_noise
    {
        warnings.push(format!(
            "no backbone: the amplitude in {filter} is below {:.2e} {}, five times the noise",
            found.floor, signal.unit
        ));
    } else if found.is_one_mode() && found.mean.is_none() {
        let narrow = if resonance.half_width_hz < 0.2 * resonance.frequency_hz {
            "; the filter is narrow since another resonance is near"
        } else {
            ""
        };
        warnings.push(format!(
            "no backbone: the decay in {filter} is shorter than the settling of the filter{narrow}"
        ));
    }
    warnings
}
