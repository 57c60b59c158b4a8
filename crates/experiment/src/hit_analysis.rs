//! Analysis of the hits in their order: features, averaged spectra, backbones, curves.

use asperity_signal::{
    AnalysedHit, ExponentialWindow, FrequencyResponse, FrfAverage, FrfForm, FundamentalSearch,
    HammerOptions, HarmonicOptions, HitRecord, HitWindows, Offset, QualityIssue, analyse_hit,
    dominant_frequency, quality_issues,
};
use rayon::prelude::*;

use crate::analysis::{Analysis, HitBackbone};
use crate::average::AveragedFrf;
use crate::curve::{Curves, HitCurve};
use crate::cutting::{CutHit, HitCutter};
use crate::error::AnalysisError;
use crate::options::{AnalysisOptions, FrequencyBand, TimeConstant, estimator_name};
use crate::report::{
    ANALYSIS_SCHEMA, AnalysisProvenance, AnalysisReport, AnalysisSettings, AverageFundamental,
    AverageReport, HitReport, HitStatistics,
};
use crate::stream::{SampleBlock, SampleStream, SignalParameters};
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
/// Most pending hits.
const MAX_PENDING: usize = 16;
/// Most samples in pending hits.
const MAX_PENDING_SAMPLES: usize = 1 << 20;

/// Results of the second pass.
pub(crate) struct HitAccumulator<'a> {
    options: &'a AnalysisOptions,
    signals: SignalParameters,
    hammer: HammerOptions,
    band: Option<FrequencyBand>,
    /// Average without a hit, with which each hit begins.
    empty: FrfAverage,
    average: FrfAverage,
    cutter: HitCutter,
    /// Hits to be analysed in parallel, with their files.
    pending: Vec<(String, CutHit)>,
    pub(crate) hits: Vec<HitReport>,
    backbones: Vec<HitBackbone>,
    curves: Curves,
}

impl<'a> HitAccumulator<'a> {
    pub(crate) fn new(
        options: &'a AnalysisOptions,
        trigger: &TriggerSettings,
        signals: SignalParameters,
    ) -> Result<Self, AnalysisError> {
        let rate = signals.sample_rate_hz;
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
            signals.response,
            FundamentalSearch::Frequency(f64::NAN),
        );
        hammer.windows =
            HitWindows { force_s: options.windows.force.then_some(FORCE_WINDOW_S), exponential };
        hammer.harmonics =
            HarmonicOptions { fundamental_window: PEAK_WINDOW, ..HarmonicOptions::default() };
        hammer.keep_all = options.keep_all;
        let empty = FrfAverage::new(trigger.hit_samples, rate, signals.response, 1)?;
        let mut accumulator = Self {
            options,
            signals,
            hammer,
            band: None,
            average: empty.clone(),
            empty,
            cutter: HitCutter::new(trigger, options, rate),
            pending: Vec::new(),
            hits: Vec::new(),
            backbones: Vec::new(),
            curves: Curves::default(),
        };
        if let Some(band) = options.band_hz {
            accumulator.search_in(band);
        }
        Ok(accumulator)
    }

    /// Takes the next block of a file.
    pub(crate) fn push(&mut self, file: &str, block: &SampleBlock) -> Result<(), AnalysisError> {
        let hits = self.cutter.push(block)?;
        hits.into_iter().try_for_each(|hit| self.enqueue(file, hit))
    }

    /// Ends a file.
    pub(crate) fn end_file(&mut self, file: &str) -> Result<(), AnalysisError> {
        let last = self.cutter.end_file();
        last.map_or(Ok(()), |hit| self.enqueue(file, hit))
    }

    /// Adds a hit to the pending ones, and analyses them when there are enough for all cores.
    fn enqueue(&mut self, file: &str, hit: CutHit) -> Result<(), AnalysisError> {
        self.pending.push((file.to_owned(), hit));
        let samples: usize = self.pending.iter().map(|(_, hit)| hit.samples.force.len()).sum();
        if self.pending.len() >= MAX_PENDING || samples >= MAX_PENDING_SAMPLES {
            self.analyse_pending()?;
        }
        Ok(())
    }

    /// Analyses the pending hits in parallel, and adds the results in the order of the hits.
    pub(crate) fn analyse_pending(&mut self) -> Result<(), AnalysisError> {
        let pending = std::mem::take(&mut self.pending);
        if self.band.is_none()
            && let Some(band) = pending.iter().find_map(|(_, hit)| self.default_band(&hit.samples))
        {
            self.search_in(band);
        }
        let analyse = |(file, hit): (String, CutHit)| {
            let mut own = self.empty.clone();
            let curve = HitCurve::of_signals(&hit.samples);
            let analysed = analyse_hit(hit.samples, &self.hammer, &mut own);
            let rate = self.signals.sample_rate_hz;
            let report = HitReport::new(file, hit.record, hit.record_start_s, rate, &analysed);
            (report, curve, analysed, own)
        };
        let results: Vec<_> = pending.into_par_iter().map(analyse).collect();
        for (report, curve, analysed, own) in results {
            self.average.merge(&own)?;
            self.add(report, curve, analysed);
        }
        Ok(())
    }

    fn add(&mut self, mut report: HitReport, mut curve: HitCurve, hit: AnalysedHit) {
        report.index = self.hits.len() + 1;
        let force_peak_n = report.force_peak_n.unwrap_or(f64::NAN);
        if let Some(frf) = &hit.frf
            && self.curves.keeps_next()
        {
            let top = report.fundamental.map(|first| DRAWN_RANGE * first.frequency_hz);
            (curve.index, curve.force_peak_n) = (report.index, force_peak_n);
            curve.set_receptance(frf, top.unwrap_or(0.5 * self.signals.sample_rate_hz));
            self.curves.kept.push(curve);
        }
        let backbone = hit.features.and_then(|features| features.backbone);
        if let Some(mut backbone) = backbone.filter(|backbone| !backbone.points.is_empty()) {
            for point in &mut backbone.points {
                let omega = std::f64::consts::TAU * point.frequency_hz;
                point.amplitude /= omega.powi(self.signals.response.derivatives());
            }
            let points = backbone.points;
            self.backbones.push(HitBackbone { index: report.index, force_peak_n, points });
        }
        self.hits.push(report);
    }

    /// Band about the resonance of a good hit: the largest peak of the mobility, in which modes of
    /// equal decay rate and mass are equally high.
    fn default_band(&self, hit: &HitRecord) -> Option<FrequencyBand> {
        let issues = quality_issues(hit, &self.hammer.quality);
        if !self.options.keep_all && issues.iter().any(QualityIssue::is_disqualifying) {
            return None;
        }
        let mut hit = hit.clone();
        if let Some(offset) = Offset::at_rest(&hit.force) {
            offset.remove(&mut hit.force);
        }
        let response: FrequencyResponse = hit.response(0, self.signals.response).ok()?;
        let rate = self.signals.sample_rate_hz;
        let low = MIN_CYCLES * rate / hit.force.len() as f64;
        let threshold = self.hammer.harmonics.force_threshold;
        let range = (low, MAX_FREQUENCY * rate);
        let peak = dominant_frequency(&response, range, FrfForm::Mobility, threshold)?;
        Some(FrequencyBand { low_hz: DEFAULT_BAND.0 * peak, high_hz: DEFAULT_BAND.1 * peak })
    }

    fn search_in(&mut self, band: FrequencyBand) {
        let limits = (band.low_hz, band.high_hz);
        self.hammer.fundamental = FundamentalSearch::Band(limits, FrfForm::Receptance);
        let half_width = (limits.1 - limits.0) / (limits.1 + limits.0);
        if self.options.band_hz.is_some() {
            self.hammer.band_part = half_width.clamp(DECAY_HALF_WIDTH.0, DECAY_HALF_WIDTH.1);
        }
        self.band = Some(band);
    }

    /// Returns the result of all hits.
    pub(crate) fn finish(
        self,
        trigger: &TriggerSettings,
        mut stream: SampleStream<'_>,
        provenance: AnalysisProvenance,
    ) -> Result<Analysis, AnalysisError> {
        let averaged = self.average.averages();
        if averaged == 0 {
            let reason = match self.hits.first() {
                Some(hit) if hit.issues.is_empty() => {
                    "its response is not finite or has no force".to_owned()
                }
                Some(hit) => hit.issues.join("; "),
                None => {
                    let (largest_n, noise_n) = (trigger.largest_n, trigger.noise_n);
                    return Err(AnalysisError::NoHit { largest_n, noise_n });
                }
            };
            return Err(AnalysisError::NoGoodHit { hits: self.hits.len(), reason });
        }
        if let (Some(band), None) = (self.band, self.options.band_hz) {
            stream.notices.insert(format!(
                "no band given: the fundamental is the strongest resonance of the first good hit, \
                 searched in {:.1} to {:.1} Hz; `band_hz` sets another band",
                band.low_hz, band.high_hz
            ));
        }
        let exponential = self.hammer.windows.exponential;
        let response = self.signals.response;
        let average = AveragedFrf::of(&self.average, response, self.options, exponential)?;
        let limits = self.band.map(|band| (band.low_hz, band.high_hz));
        let estimator = self.options.estimator;
        let fundamental = limits
            .and_then(|limits| average.fundamental(&self.average, estimator, limits, &self.hammer));
        stream.notices.extend(mixed_levels(&self.hits, fundamental.as_ref()));
        let firsts = || self.hits.iter().filter_map(|hit| hit.fundamental);
        let rate = self.signals.sample_rate_hz;
        let report = AnalysisReport {
            schema: ANALYSIS_SCHEMA,
            sample_rate_hz: rate,
            channels: stream.channels,
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
                exponential_window_s: exponential.map(|window| window.tau_s()),
                band_hz: limits.map(|(low, high)| [low, high]),
                band_given: self.options.band_hz.is_some(),
                keep_all: self.options.keep_all,
            },
            average: AverageReport {
                hits: averaged,
                excluded: self.hits.iter().filter(|hit| !hit.averaged).map(|h| h.index).collect(),
                fundamental,
                first_masked_hz: average.first_masked_hz,
                frequency_hz: HitStatistics::of(firsts().map(|first| first.frequency_hz)),
                magnitude: HitStatistics::of(firsts().map(|first| first.magnitude)),
                harmonic_ratio: HitStatistics::of(
                    self.hits.iter().filter_map(|hit| hit.harmonic_ratio),
                ),
            },
            hits: self.hits,
            notices: stream.notices.into_iter().collect(),
            provenance,
        };
        let curves = self.curves.kept;
        Ok(Analysis { report, average, backbones: self.backbones, curves, response })
    }
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
