//! Analysis of one response to the hits in their order: features, averaged spectra, backbones, curves.

use asperity_signal::{
    AnalysedHit, ExponentialWindow, FrequencyResponse, FrfAverage, FrfForm, FundamentalSearch,
    HammerOptions, HarmonicOptions, HitRecord, HitWindows, Offset, Pulse, QualityIssue,
    ResponseKind, analyse_hit, dominant_frequency, quality_issues,
};

use crate::analysis::{HitBackbone, HitFrf, ResponseAnalysis};
use crate::average::{AveragedFrf, corrected};
use crate::curve::{Curves, HitCurve};
use crate::cutting::CutHit;
use crate::error::AnalysisError;
use crate::force_level::{BandSums, change_with_force, force_levels};
use crate::hit_report::{HitReport, HitStatistics};
use crate::modes::HitModes;
use crate::options::{AnalysisOptions, FrequencyBand, TimeConstant, estimator_name};
use crate::plausibility::{self, is_contact_lost};
use crate::report::{
    ANALYSIS_SCHEMA, AnalysisProvenance, AnalysisReport, AnalysisSettings, AverageFundamental,
    AverageReport,
};
use crate::second_peak::SecondPeakReport;
use crate::stream::UsedChannel;
use crate::trigger::TriggerSettings;

/// Margin and taper of a force window \[s\].
const FORCE_WINDOW_S: (f64, f64) = (0.5e-3, 0.5e-3);
/// Value at the end of the longest hit of an exponential window without a time constant.
const EXPONENTIAL_END: f64 = 0.01;
/// Window about the largest peak of the band in which the fundamental is refined, over its
/// frequency.
const PEAK_WINDOW: (f64, f64) = (0.97, 1.03);
/// Lowest frequency of the search without a band, in cycles over the hit.
const MIN_CYCLES: f64 = 8.0;
/// Highest frequency of the search without a band, over the sample rate.
const MAX_FREQUENCY: f64 = 0.4;
/// Band of a search without a band, over the resonance of the first good hit.
const DEFAULT_BAND: (f64, f64) = (0.85, 1.15);
/// Limits of the half width of the filter of a decay over its centre, for a given band.
const DECAY_HALF_WIDTH: (f64, f64) = (0.02, 0.3);
/// Highest frequency of a drawn receptance, over the fundamental.
const DRAWN_RANGE: f64 = 4.0;
/// Coherence at the fundamental below which hits of different forces do not average, and the ratio
/// of forces that are different.
const LOW_COHERENCE: f64 = 0.95;
const MIXED_FORCES: f64 = 1.5;
/// Most complex values of functions of hits that are kept (1 GiB).
const MAX_KEPT_VALUES: usize = 1 << 26;

/// Results of one response in the second pass.
pub(crate) struct ResponseAccumulator<'a> {
    options: &'a AnalysisOptions,
    sample_rate_hz: f64,
    response: ResponseKind,
    hammer: HammerOptions,
    band: Option<FrequencyBand>,
    /// Average without a hit, with which each hit begins.
    empty: FrfAverage,
    average: FrfAverage,
    hits: Vec<HitReport>,
    /// Spectra of each hit about the fundamental.
    sums: Vec<BandSums>,
    backbones: Vec<HitBackbone>,
    modes: Vec<HitModes>,
    curves: Curves,
    frfs: Vec<HitFrf>,
    /// Most values in `frfs`, and their number.
    most_values: usize,
    kept_values: usize,
}

/// Results of one hit that is not yet numbered.
pub(crate) struct SingleHit {
    report: HitReport,
    curve: HitCurve,
    analysed: AnalysedHit,
    average: FrfAverage,
}

/// Parts that the reports of all responses share.
pub(crate) struct CommonReport<'a> {
    pub(crate) trigger: &'a TriggerSettings,
    /// Channels of force and response.
    pub(crate) channels: Vec<UsedChannel>,
    pub(crate) notices: Vec<String>,
    pub(crate) provenance: AnalysisProvenance,
}

impl<'a> ResponseAccumulator<'a> {
    /// - `responses`: number of responses, which share the memory of kept functions.
    pub(crate) fn new(
        options: &'a AnalysisOptions,
        trigger: &TriggerSettings,
        rate: f64,
        response: ResponseKind,
        responses: usize,
    ) -> Result<Self, AnalysisError> {
        let exponential = match options.windows.exponential {
            None => None,
            Some(TimeConstant::Seconds(tau)) => Some(ExponentialWindow::new(tau)?),
            Some(TimeConstant::OfLength) => {
                let length_s = trigger.hit_samples as f64 / rate;
                Some(ExponentialWindow::falling_to(EXPONENTIAL_END, length_s)?)
            }
        };
        let mut hammer = HammerOptions::new(
            trigger.hit_options(options, rate),
            response,
            FundamentalSearch::Frequency(f64::NAN),
        );
        hammer.windows = HitWindows {
            force_s: options.windows.force.then_some(FORCE_WINDOW_S),
            exponential,
            until_noise: options.windows.until_noise,
        };
        hammer.harmonics =
            HarmonicOptions { fundamental_window: PEAK_WINDOW, ..HarmonicOptions::default() };
        hammer.keep_all = options.keep_all;
        let empty = FrfAverage::new(trigger.hit_samples, rate, response, 1)?;
        Ok(Self {
            options,
            sample_rate_hz: rate,
            response,
            hammer,
            band: None,
            average: empty.clone(),
            empty,
            hits: Vec::new(),
            sums: Vec::new(),
            backbones: Vec::new(),
            modes: Vec::new(),
            curves: Curves::default(),
            frfs: Vec::new(),
            most_values: MAX_KEPT_VALUES / responses,
            kept_values: 0,
        })
    }

    /// Number of the hits.
    pub(crate) fn hits(&self) -> usize {
        self.hits.len()
    }

    /// Analyses a hit.
    pub(crate) fn analyse(&self, file: String, hit: CutHit) -> SingleHit {
        let mut average = self.empty.clone();
        let curve = HitCurve::of_signals(&hit.samples);
        let pulse = Pulse::of(&hit.samples.force, self.sample_rate_hz);
        let contact_lost = is_contact_lost(&hit.samples, pulse.as_ref(), self.response);
        let analysed = analyse_hit(hit.samples, &self.hammer, &mut average);
        let rate = self.sample_rate_hz;
        let report = HitReport::new(file, hit.record, hit.record_start_s, rate, &analysed);
        let report = HitReport { contact_lost, ..report };
        SingleHit { report, curve, analysed, average }
    }

    /// Adds the next hit.
    pub(crate) fn add(&mut self, hit: SingleHit) -> Result<(), AnalysisError> {
        let SingleHit { mut report, mut curve, analysed: hit, average } = hit;
        let limits = self.band.map_or((0.0, 0.0), |band| (band.low_hz, band.high_hz));
        report.index = self.hits.len() + 1;
        if self.options.rejects(report.index, &report.file, report.time_s) {
            report.reject();
            self.sums.push(BandSums::of(self.empty.sums_within(limits)));
            self.modes.push(HitModes::of(None));
            self.hits.push(report);
            return Ok(());
        }
        self.average.merge(&average)?;
        self.sums.push(BandSums::of(average.sums_within(limits)));
        let force_peak_n = report.force_peak_n.unwrap_or(f64::NAN);
        if let (Some(frf), true) = (&hit.frf, self.options.keep_frfs) {
            let exponential = self.hammer.windows.exponential;
            let frf = corrected(frf, self.response, self.options, exponential);
            self.kept_values += frf.len();
            if self.kept_values > self.most_values {
                return Err(AnalysisError::TooManyFunctions {
                    hits: self.frfs.len() + 1,
                    lines: frf.len(),
                    limit: self.most_values,
                });
            }
            self.frfs.push(HitFrf { index: report.index, force_peak_n, frf });
        }
        if let Some(frf) = &hit.frf
            && self.curves.keeps_next()
        {
            let top = report.fundamental.map(|first| DRAWN_RANGE * first.frequency_hz);
            (curve.index, curve.force_peak_n) = (report.index, force_peak_n);
            curve.set_receptance(frf, top.unwrap_or(0.5 * self.sample_rate_hz));
            self.curves.kept.push(curve);
        }
        self.modes.push(HitModes::of(hit.features.as_ref()));
        let decay =
            hit.features.and_then(|of| Some((of.backbone?.points, of.backbone_uncertainty)));
        if let Some((mut points, uncertainties)) = decay.filter(|(points, _)| !points.is_empty()) {
            for point in &mut points {
                let omega = std::f64::consts::TAU * point.frequency_hz;
                point.amplitude /= omega.powi(self.response.derivatives());
            }
            let index = report.index;
            self.backbones.push(HitBackbone { index, force_peak_n, points, uncertainties });
        }
        self.hits.push(report);
        Ok(())
    }

    /// Band about the resonance of a good hit: the largest peak of the mobility, in which modes of
    /// equal decay rate and mass are equally high.
    pub(crate) fn default_band(&self, hit: &HitRecord) -> Option<FrequencyBand> {
        let issues = quality_issues(hit, &self.hammer.quality);
        if !self.options.keep_all && issues.iter().any(QualityIssue::is_disqualifying) {
            return None;
        }
        let mut hit = hit.clone();
        if let Some(offset) = Offset::at_rest(&hit.force) {
            offset.remove(&mut hit.force);
        }
        let measured = hit.responses.first_mut()?;
        if let Some(offset) = Offset::of_response(measured, hit.trigger) {
            offset.remove(measured);
        }
        let response: FrequencyResponse = hit.response(0, self.response).ok()?;
        let rate = self.sample_rate_hz;
        let resolved = MIN_CYCLES * rate / hit.force.len() as f64;
        let low = resolved.max(self.options.high_pass_hz.unwrap_or(0.0));
        let threshold = self.hammer.harmonics.force_threshold;
        let range = (low, MAX_FREQUENCY * rate);
        let peak = dominant_frequency(&response, range, FrfForm::Mobility, threshold)?;
        let low_hz = (DEFAULT_BAND.0 * peak).max(low);
        Some(FrequencyBand { low_hz, high_hz: DEFAULT_BAND.1 * peak })
    }

    /// Searches the fundamental in a band.
    pub(crate) fn search_in(&mut self, band: FrequencyBand) {
        let limits = (band.low_hz, band.high_hz);
        self.hammer.fundamental = FundamentalSearch::Band(limits, FrfForm::Receptance);
        let half_width = (limits.1 - limits.0) / (limits.1 + limits.0);
        if self.options.band_hz.is_some() {
            self.hammer.band_part = half_width.clamp(DECAY_HALF_WIDTH.0, DECAY_HALF_WIDTH.1);
        }
        self.band = Some(band);
    }

    /// Reason for which no hit was averaged; `None` with an average.
    pub(crate) fn failure(
        &self,
        trigger: &TriggerSettings,
        force: &UsedChannel,
    ) -> Option<AnalysisError> {
        if self.average.averages() > 0 {
            return None;
        }
        let reason = match self.hits.first() {
            Some(HitReport { ring_s: Some(ring), .. }) => {
                format!("`{}` rings for {ring:.3} s after the blow: is it a force?", force.name)
            }
            Some(hit) if hit.issues.is_empty() => {
                "its response is not finite or has no force".to_owned()
            }
            Some(hit) => hit.issues.join("; "),
            None => {
                let (largest_n, noise_n) = (trigger.largest_n, trigger.noise_n);
                return Some(AnalysisError::NoHit { largest_n, noise_n, remarks: Vec::new() });
            }
        };
        Some(AnalysisError::NoGoodHit { hits: self.hits.len(), reason })
    }

    /// The result of all hits, of which one is averaged at least, and the modes of each.
    pub(crate) fn finish(
        self,
        common: CommonReport<'_>,
    ) -> Result<(ResponseAnalysis, Vec<HitModes>), AnalysisError> {
        let CommonReport { trigger, channels, mut notices, provenance } = common;
        let averaged = self.average.averages();
        let mut hits = self.hits;
        let exponential = self.hammer.windows.exponential;
        let response = self.response;
        let average = AveragedFrf::of(&self.average, response, self.options, exponential)?;
        let limits = self.band.map(|band| (band.low_hz, band.high_hz));
        let estimator = self.options.estimator;
        let fundamental = limits
            .and_then(|limits| average.fundamental(&self.average, estimator, limits, &self.hammer));
        let second_peak = SecondPeakReport::of(&hits);
        if second_peak.as_ref().is_some_and(SecondPeakReport::is_harmonic) {
            hits.iter_mut().for_each(HitReport::accept_harmonic);
        }
        let levels = force_levels(&hits, &self.sums);
        let mut conclusions: Vec<String> = change_with_force(&levels, &hits).into_iter().collect();
        conclusions.extend(second_peak.iter().map(|second| second.sentence.clone()));
        notices.extend(mixed_levels(&hits, fundamental.as_ref()));
        notices.extend(ringing_force(&hits, &channels));
        notices.extend(plausibility::notices(&hits, self.sample_rate_hz, self.band));
        let firsts = || hits.iter().filter_map(|hit| hit.fundamental);
        let rate = self.sample_rate_hz;
        let report = AnalysisReport {
            schema: ANALYSIS_SCHEMA,
            sample_rate_hz: rate,
            channels,
            settings: AnalysisSettings {
                trigger_level_n: trigger.level_n,
                noise_n: trigger.noise_n,
                hit_length_s: trigger.hit_samples as f64 / rate,
                pre_trigger_s: self.options.pre_trigger_s,
                hold_off_s: self.options.hold_off_s,
                estimator: estimator_name(self.options.estimator),
                measured_form: response.form().name(),
                feature_form: FrfForm::Receptance.name(),
                frf_form: self.options.form.name(),
                force_window: self.options.windows.force,
                until_noise: self.options.windows.until_noise,
                exponential_window_s: exponential.map(|window| window.tau_s()),
                band_hz: limits.map(|(low, high)| [low, high]),
                band_given: self.options.band_hz.is_some(),
                keep_all: self.options.keep_all,
            },
            average: AverageReport {
                hits: averaged,
                excluded: hits.iter().filter(|hit| !hit.averaged).map(|h| h.index).collect(),
                fundamental,
                first_masked_hz: average.first_masked_hz,
                frequency_hz: HitStatistics::of(firsts().map(|first| first.frequency_hz)),
                magnitude: HitStatistics::of(firsts().map(|first| first.magnitude)),
                harmonic_ratio: HitStatistics::of(hits.iter().filter_map(|hit| hit.harmonic_ratio)),
            },
            second_peak,
            levels,
            conclusions,
            modes: Vec::new(),
            other_responses: Vec::new(),
            hits,
            notices,
            provenance,
        };
        let curves = self.curves.kept;
        let (backbones, frfs) = (self.backbones, self.frfs);
        let analysis = ResponseAnalysis { report, average, backbones, curves, frfs, response };
        Ok((analysis, self.modes))
    }
}

/// A sentence where the force rings after most of the hits.
fn ringing_force(hits: &[HitReport], channels: &[UsedChannel]) -> Option<String> {
    let rings: Vec<f64> = hits.iter().filter_map(|hit| hit.ring_s).collect();
    let longest = rings.iter().copied().reduce(f64::max)?;
    let name = &channels.first()?.name;
    (2 * rings.len() > hits.len())
        .then(|| format!("`{name}` rings for up to {longest:.3} s after the blow: is it a force?"))
}

/// A sentence where the average mixes hits whose different forces have different functions.
fn mixed_levels(hits: &[HitReport], average: Option<&AverageFundamental>) -> Option<String> {
    let coherence = average?.coherence.filter(|coherence| *coherence < LOW_COHERENCE)?;
    let peaks = hits.iter().filter(|hit| hit.averaged).filter_map(|hit| hit.force_peak_n);
    let (low, high) = peaks.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), peak| {
        (low.min(peak), high.max(peak))
    });
    (high > MIXED_FORCES * low).then(|| {
        format!(
            "the forces of the averaged hits are from {low:.3} to {high:.3} N, and the coherence at \
             the fundamental is {coherence:.2}: where the function depends on the force, an average \
             over levels is that of none; compare hits, or average equal levels"
        )
    })
}
