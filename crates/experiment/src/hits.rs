//! One hit after the other: cut, judged, analysed, added to the average, forgotten.

use asperity_signal::{
    AnalysedHit, ExponentialWindow, FrequencyResponse, FrfAverage, FrfForm, FundamentalSearch,
    HammerOptions, HarmonicOptions, HitFinder, HitRecord, HitWindows, Offset, QualityIssue,
    analyse_hit, dominant_frequency, quality_issues,
};

use rayon::prelude::*;

use crate::average::AveragedFrf;
use crate::curve::{Curves, HitCurve};
use crate::error::AnalysisError;
use crate::options::{AnalysisOptions, Band, TimeConstant, estimator_name};
use crate::report::{
    ANALYSIS_SCHEMA, AnalysisProvenance, AnalysisReport, AverageReport, HitReport, Settings, Spread,
};
use crate::scan::Plan;
use crate::stream::{Block, Sampling, Stream};
use crate::{Analysis, HitBackbone};

/// Margin and taper of a force window \[s\].
const FORCE_WINDOW_S: (f64, f64) = (0.5e-3, 0.5e-3);
/// What an exponential window without a time constant falls to over the longest hit.
const FALL: f64 = 0.01;
/// The fundamental is refined this far about the largest peak of the band.
const ABOUT_PEAK: (f64, f64) = (0.97, 1.03);
/// Without a band: cycles in a hit at the lowest frequency looked at.
const FEWEST_CYCLES: f64 = 8.0;
/// Without a band: the highest frequency looked at, over the rate.
const HIGHEST: f64 = 0.4;
/// Without a band: the other hits are searched this far about the first one's resonance.
const ABOUT_FIRST: (f64, f64) = (0.85, 1.15);
/// Half widths of the filter of a decay over its middle, where a band is given.
const DECAY_PART: (f64, f64) = (0.02, 0.3);
/// Drawn receptances end here, over the fundamental.
const DRAWN: f64 = 4.0;

/// Most hits that wait to be analysed side by side, and most samples in them.
const MOST_WAITING: usize = 16;
const MOST_SAMPLES: usize = 1 << 20;

/// A hit that waits to be analysed.
struct Waiting {
    file: String,
    record: usize,
    start_s: f64,
    hit: HitRecord,
}

/// The second pass.
pub(super) struct HitByHit<'a> {
    options: &'a AnalysisOptions,
    sampling: Sampling,
    hammer: HammerOptions,
    level_n: f64,
    band: Option<Band>,
    /// An average of nothing, which each hit begins with.
    empty: FrfAverage,
    average: FrfAverage,
    finder: Option<HitFinder>,
    waiting: Vec<Waiting>,
    record: usize,
    record_start_s: f64,
    pub(super) hits: Vec<HitReport>,
    backbones: Vec<HitBackbone>,
    curves: Curves,
}

impl<'a> HitByHit<'a> {
    pub(super) fn new(
        options: &'a AnalysisOptions,
        plan: &Plan,
        sampling: Sampling,
    ) -> Result<Self, AnalysisError> {
        let rate = sampling.rate_hz;
        let cut = plan.cut(options, rate);
        let exponential = match options.window.exponential {
            None => None,
            Some(TimeConstant::Seconds(tau)) => Some(ExponentialWindow::new(tau)?),
            Some(TimeConstant::OfLength) => {
                Some(ExponentialWindow::falling_to(FALL, plan.length as f64 / rate)?)
            }
        };
        let mut hammer =
            HammerOptions::new(cut, sampling.route, FundamentalSearch::Frequency(f64::NAN));
        hammer.windows =
            HitWindows { force_s: options.window.force.then_some(FORCE_WINDOW_S), exponential };
        hammer.harmonics =
            HarmonicOptions { fundamental_window: ABOUT_PEAK, ..HarmonicOptions::default() };
        hammer.keep_all = options.keep_all;
        let empty = FrfAverage::new(plan.length, rate, sampling.route, 1)?;
        let mut found = Self {
            options,
            sampling,
            hammer,
            level_n: plan.level_n,
            band: None,
            average: empty.clone(),
            empty,
            finder: None,
            waiting: Vec::new(),
            record: 0,
            record_start_s: 0.0,
            hits: Vec::new(),
            backbones: Vec::new(),
            curves: Curves::default(),
        };
        if let Some(band) = options.band_hz {
            found.search_in(band);
        }
        Ok(found)
    }

    /// Takes the next block of a file.
    pub(super) fn push(&mut self, file: &str, block: &Block) -> Result<(), AnalysisError> {
        if block.begins {
            if let Some(finder) = self.finder.take() {
                self.close(file, finder)?;
            }
            self.record += 1;
            self.record_start_s = block.start_s;
        }
        if self.finder.is_none() {
            let rate = self.sampling.rate_hz;
            self.finder = Some(HitFinder::new(1, rate, self.level_n, &self.hammer.hits)?);
        }
        let Some(finder) = &mut self.finder else { return Ok(()) };
        for hit in finder.push(&block.force, &[&block.response])? {
            self.wait(file, hit)?;
        }
        Ok(())
    }

    /// Ends the last record of a file.
    pub(super) fn end_record(&mut self, file: &str) -> Result<(), AnalysisError> {
        if let Some(finder) = self.finder.take() {
            self.close(file, finder)?;
        }
        self.record = 0;
        Ok(())
    }

    fn close(&mut self, file: &str, finder: HitFinder) -> Result<(), AnalysisError> {
        finder.finish().map_or(Ok(()), |hit| self.wait(file, hit))
    }

    /// Keeps a hit until there are enough for all cores.
    fn wait(&mut self, file: &str, hit: HitRecord) -> Result<(), AnalysisError> {
        let (record, start_s) = (self.record, self.record_start_s);
        self.waiting.push(Waiting { file: file.to_owned(), record, start_s, hit });
        let samples: usize = self.waiting.iter().map(|waiting| waiting.hit.force.len()).sum();
        if self.waiting.len() >= MOST_WAITING || samples >= MOST_SAMPLES {
            self.analyse_waiting()?;
        }
        Ok(())
    }

    /// Analyses what waits, side by side, and adds it up in its order.
    pub(super) fn analyse_waiting(&mut self) -> Result<(), AnalysisError> {
        let waiting = std::mem::take(&mut self.waiting);
        if self.band.is_none()
            && let Some(band) = waiting.iter().find_map(|waiting| self.band_of_first(&waiting.hit))
        {
            self.search_in(band);
        }
        let analyse = |waiting: Waiting| {
            let mut own = self.empty.clone();
            let curve = HitCurve::of_signals(&waiting.hit);
            let found = analyse_hit(waiting.hit, &self.hammer, &mut own);
            let rate = self.sampling.rate_hz;
            let report =
                HitReport::new(waiting.file, waiting.record, waiting.start_s, rate, &found);
            (report, curve, found, own)
        };
        let analysed: Vec<_> = waiting.into_par_iter().map(analyse).collect();
        for (report, curve, found, own) in analysed {
            self.average.merge(&own)?;
            self.add(report, curve, found);
        }
        Ok(())
    }

    fn add(&mut self, mut report: HitReport, mut curve: HitCurve, found: AnalysedHit) {
        report.index = self.hits.len() + 1;
        let force_peak_n = report.force_peak_n.unwrap_or(f64::NAN);
        if let Some(frf) = &found.frf
            && self.curves.wants_next()
        {
            let top = report.fundamental.map(|first| DRAWN * first.frequency_hz);
            (curve.index, curve.force_peak_n) = (report.index, force_peak_n);
            curve.set_receptance(frf, top.unwrap_or(0.5 * self.sampling.rate_hz));
            self.curves.kept.push(curve);
        }
        let backbone = found.features.and_then(|features| features.backbone);
        if let Some(mut backbone) = backbone.filter(|backbone| !backbone.points.is_empty()) {
            for point in &mut backbone.points {
                let omega = std::f64::consts::TAU * point.frequency_hz;
                point.amplitude /= omega.powi(self.sampling.route.derivatives());
            }
            let points = backbone.points;
            self.backbones.push(HitBackbone { index: report.index, force_peak_n, points });
        }
        self.hits.push(report);
    }

    /// Where the resonance of the first good hit lies: the largest peak of the
    /// mobility, in which modes of one decay rate and mass are equally high.
    fn band_of_first(&self, hit: &HitRecord) -> Option<Band> {
        let issues = quality_issues(hit, &self.hammer.quality);
        if !self.options.keep_all && issues.iter().any(QualityIssue::is_disqualifying) {
            return None;
        }
        let mut hit = hit.clone();
        if let Some(offset) = Offset::at_rest(&hit.force) {
            offset.remove(&mut hit.force);
        }
        let response: FrequencyResponse = hit.response(0, self.sampling.route).ok()?;
        let rate = self.sampling.rate_hz;
        let low = FEWEST_CYCLES * rate / hit.force.len() as f64;
        let threshold = self.hammer.harmonics.force_threshold;
        let range = (low, HIGHEST * rate);
        let first = dominant_frequency(&response, range, FrfForm::Mobility, threshold)?;
        Some(Band { low_hz: ABOUT_FIRST.0 * first, high_hz: ABOUT_FIRST.1 * first })
    }

    fn search_in(&mut self, band: Band) {
        let limits = (band.low_hz, band.high_hz);
        self.hammer.fundamental = FundamentalSearch::Band(limits, FrfForm::Receptance);
        let part = (limits.1 - limits.0) / (limits.1 + limits.0);
        if self.options.band_hz.is_some() {
            self.hammer.band_part = part.clamp(DECAY_PART.0, DECAY_PART.1);
        }
        self.band = Some(band);
    }

    /// The answers.
    pub(super) fn finish(
        self,
        plan: &Plan,
        mut stream: Stream<'_>,
        provenance: AnalysisProvenance,
    ) -> Result<Analysis, AnalysisError> {
        let averaged = self.average.averages();
        if averaged == 0 {
            let reason = match self.hits.first() {
                Some(hit) if hit.verdicts.is_empty() => "it cannot be transformed".to_owned(),
                Some(hit) => hit.verdicts.join("; "),
                None => {
                    let (largest_n, noise_n) = (plan.largest_n, plan.noise_n);
                    return Err(AnalysisError::NoHit { largest_n, noise_n });
                }
            };
            return Err(AnalysisError::NoGoodHit { hits: self.hits.len(), reason });
        }
        if let (Some(band), None) = (self.band, self.options.band_hz) {
            stream.notices.insert(format!(
                "no band given: the fundamental is taken as the strongest resonance of the first \
                 good hit, within {:.1} to {:.1} Hz; --band LO:HI looks elsewhere",
                band.low_hz, band.high_hz
            ));
        }
        let exponential = self.hammer.windows.exponential;
        let route = self.sampling.route;
        let (average, receptance) =
            AveragedFrf::of(&self.average, route, self.options, exponential)?;
        let limits = self.band.map(|band| (band.low_hz, band.high_hz));
        let fundamental = limits.and_then(|limits| average.fundamental(&receptance, limits));
        let firsts = || self.hits.iter().filter_map(|hit| hit.fundamental);
        let rate = self.sampling.rate_hz;
        let report = AnalysisReport {
            schema: ANALYSIS_SCHEMA,
            sample_rate_hz: rate,
            channels: stream.channels,
            settings: Settings {
                level_n: plan.level_n,
                noise_n: plan.noise_n,
                length_s: plan.length as f64 / rate,
                pre_trigger_s: self.options.pre_trigger_s,
                hold_off_s: self.options.hold_off_s,
                estimator: estimator_name(self.options.estimator),
                measured_form: route.form().name(),
                feature_form: FrfForm::Receptance.name(),
                frf_form: self.options.form.name(),
                force_window: self.options.window.force,
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
                frequency_hz: Spread::of(firsts().map(|first| first.frequency_hz)),
                magnitude: Spread::of(firsts().map(|first| first.magnitude)),
                harmonic_ratio: Spread::of(self.hits.iter().filter_map(|hit| hit.harmonic_ratio)),
            },
            hits: self.hits,
            notices: stream.notices.into_iter().collect(),
            provenance,
        };
        let curves = self.curves.kept;
        Ok(Analysis { report, average, backbones: self.backbones, curves, route })
    }
}
