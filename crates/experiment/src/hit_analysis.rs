//! Hits of the second pass, cut, and analysed for every response.

use rayon::prelude::*;

use crate::analysis::Analysis;
use crate::cutting::{CutHit, HitCutter};
use crate::error::AnalysisError;
use crate::modes::{Mode, ResponseModes};
use crate::options::{AnalysisOptions, FrequencyBand, RejectedHit};
use crate::report::AnalysisProvenance;
use crate::response_analysis::{CommonReport, ResponseAccumulator};
use crate::stream::{SampleBlock, SampleStream, SignalParameters};
use crate::trigger::TriggerSettings;

/// Most pending hits.
const MAX_PENDING: usize = 16;
/// Most samples in pending hits.
const MAX_PENDING_SAMPLES: usize = 1 << 20;

/// Results of the second pass.
pub(crate) struct HitAccumulator<'a> {
    options: &'a AnalysisOptions,
    cutter: HitCutter,
    /// Hits to be analysed in parallel, with their files.
    pending: Vec<(String, CutHit)>,
    band: Option<FrequencyBand>,
    responses: Vec<ResponseAccumulator<'a>>,
}

impl<'a> HitAccumulator<'a> {
    pub(crate) fn new(
        options: &'a AnalysisOptions,
        trigger: &TriggerSettings,
        signals: &SignalParameters,
    ) -> Result<Self, AnalysisError> {
        let (rate, count) = (signals.sample_rate_hz, signals.responses.len());
        let response = |kind| ResponseAccumulator::new(options, trigger, rate, kind, count);
        let mut accumulator = Self {
            options,
            cutter: HitCutter::new(trigger, options, rate),
            pending: Vec::new(),
            band: None,
            responses: signals
                .responses
                .iter()
                .map(|kind| response(*kind))
                .collect::<Result<_, _>>()?,
        };
        if let Some(band) = options.band_hz {
            accumulator.search_in(band);
        }
        Ok(accumulator)
    }

    /// Number of the hits that are analysed.
    pub(crate) fn hits(&self) -> usize {
        self.responses.first().map_or(0, ResponseAccumulator::hits)
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
            && let Some(first) = self.responses.first()
            && let Some(band) = pending.iter().enumerate().find_map(|(place, (file, hit))| {
                let number = first.hits() + place + 1;
                let rate = hit.samples.sample_rate_hz;
                let trigger = hit.samples.start + hit.samples.trigger as u64;
                let time_s = hit.record_start_s + trigger as f64 / rate;
                let rejected = self.options.rejects(number, file, time_s);
                if rejected { None } else { first.default_band(&hit.samples) }
            })
        {
            self.search_in(band);
        }
        let responses = &self.responses;
        let single = |(file, hit): (String, CutHit)| {
            hit.of_each_response()
                .into_iter()
                .enumerate()
                .map(move |(r, hit)| (r, file.clone(), hit))
        };
        let tasks: Vec<(usize, String, CutHit)> = pending.into_iter().flat_map(single).collect();
        let results: Vec<_> = tasks
            .into_par_iter()
            .map(|(response, file, hit)| (response, responses[response].analyse(file, hit)))
            .collect();
        results.into_iter().try_for_each(|(response, hit)| self.responses[response].add(hit))
    }

    fn search_in(&mut self, band: FrequencyBand) {
        self.responses.iter_mut().for_each(|response| response.search_in(band));
        self.band = Some(band);
    }

    /// Returns the result of all hits. Responses without a good hit are left out, unless there is
    /// no other.
    pub(crate) fn finish(
        self,
        trigger: &TriggerSettings,
        mut stream: SampleStream<'_>,
        provenance: &AnalysisProvenance,
    ) -> Result<Analysis, AnalysisError> {
        if let (Some(band), None) = (self.band, self.options.band_hz) {
            stream.notices.insert(format!(
                "no band given: the fundamental is the strongest resonance of the first good hit, \
                 searched in {:.1} to {:.1} Hz; `band_hz` sets another band",
                band.low_hz, band.high_hz
            ));
        }
        let hits = self.hits();
        for rejected in &self.options.rejected {
            if let RejectedHit::Number(number) = *rejected
                && !(1..=hits).contains(&number)
            {
                return Err(AnalysisError::NoSuchHit { number, hits });
            }
        }
        let (force, channels) = stream.channels.split_first().ok_or(AnalysisError::NoFile)?;
        let mut failure = None;
        let mut good = Vec::new();
        for (response, channel) in self.responses.into_iter().zip(channels) {
            if let Some(error) = response.failure(trigger, force) {
                let name = &channel.name;
                stream.notices.insert(format!("the response {name} is left out: {error}"));
                failure = failure.or(Some(error));
            } else {
                good.push((response, channel.clone()));
            }
        }
        if let (true, Some(error)) = (good.is_empty(), failure) {
            return Err(error);
        }
        let (mut responses, mut modes) = (Vec::new(), Vec::new());
        for (response, channel) in good {
            let name = channel.name.clone();
            let (found, hits) = response.finish(CommonReport {
                trigger,
                channels: vec![force.clone(), channel],
                notices: stream.all_notices(),
                provenance: provenance.clone(),
            })?;
            modes.push(ResponseModes::new(
                name,
                found.report.average.hits,
                hits,
                &found.report.hits,
            ));
            responses.push(found);
        }
        let modes = Mode::of(&modes);
        Ok(Analysis::new(responses, modes))
    }
}
