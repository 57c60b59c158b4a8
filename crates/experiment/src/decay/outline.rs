//! Signals of records to draw, with their decays.

use std::path::Path;

use super::report::MeasuredDecay;
use super::signals::DecaySignals;

/// Most signals.
const MOST: usize = 6;
/// Intervals of a signal.
const INTERVALS: usize = 1200;

/// Extremes of a response over a record, and the times of its decays.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayOutline {
    /// Name of the file, without folder, and record.
    pub title: String,
    /// Name of the response.
    pub response: String,
    /// Unit of the response; empty without one.
    pub unit: String,
    /// Times on the axis of the record \[s\]: two for each interval.
    pub time_s: Vec<f64>,
    /// Smallest and largest sample of each interval, about the median, in the unit.
    pub values: Vec<f64>,
    /// First and last time of each backbone of this response \[s\]; of the whole decay where there is
    /// none.
    pub decays: Vec<[f64; 2]>,
}

impl DecayOutline {
    /// The responses of a record, as long as there are fewer than six with those `before`.
    pub(super) fn of(
        signals: &DecaySignals,
        decays: &[MeasuredDecay],
        before: &[Self],
    ) -> Vec<Self> {
        let Some(first) = decays.first() else { return Vec::new() };
        let path = Path::new(&first.file);
        let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let rate = signals.sample_rate_hz;
        let left = MOST.saturating_sub(before.len());
        signals
            .responses
            .iter()
            .take(left)
            .map(|signal| {
                let part = signal.samples.len().div_ceil(INTERVALS).max(1);
                let (mut time_s, mut values) = (Vec::new(), Vec::new());
                for (number, samples) in signal.samples.chunks(part).enumerate() {
                    let begin = signals.start_s + (number * part) as f64 / rate;
                    time_s.extend([begin, begin + 0.5 * samples.len() as f64 / rate]);
                    values.push(samples.iter().copied().fold(f64::INFINITY, f64::min));
                    values.push(samples.iter().copied().fold(f64::NEG_INFINITY, f64::max));
                }
                let span = |decay: &MeasuredDecay| {
                    let own = decay.responses.iter().filter(|of| of.response == signal.name);
                    let end = own.map(|of| of.start_s + of.length_s).fold(0.0, f64::max);
                    [decay.onset_s, if end > decay.onset_s { end } else { decay.end_s }]
                };
                Self {
                    title: format!("{file}, record {}", first.record),
                    response: signal.name.clone(),
                    unit: signal.unit.clone(),
                    time_s,
                    values,
                    decays: decays.iter().map(span).collect(),
                }
            })
            .collect()
    }
}
