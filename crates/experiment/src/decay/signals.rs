//! Responses of a record, in the units of their channels.

use std::ops::Range;
use std::path::Path;

use asperity_measure::{Channel, ChannelQuantity, Record, Samples};
use asperity_signal::{DecayResonance, robust_level};
use serde::Serialize;

use crate::channel::{ChannelSelector, choose_any_responses};
use crate::error::AnalysisError;
use crate::options::ChannelSensor;
use crate::stream::{calibrate, is_in_time};

/// Lowest frequency of a mode, in cycles over the decay.
pub(super) const MIN_CYCLES: f64 = 8.0;
/// Highest frequency of a mode, over the sample rate.
pub(super) const MAX_FREQUENCY: f64 = 0.4;
/// Most samples of a record from which the length of a cycle is taken.
const MOST_FOR_CYCLE: usize = 1 << 20;

/// Channel of a response.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DecayChannel {
    /// Name.
    pub name: String,
    /// Measured quantity.
    pub quantity: String,
    /// Unit in the file, of all amplitudes without a unit in their name; empty without one.
    pub unit: String,
    /// SI unit of the quantity; `None` for a unit that is not known, or not one of motion.
    pub si_unit: Option<&'static str>,
}

/// Responses that are sampled together.
pub(super) struct DecaySignals {
    pub(super) sample_rate_hz: f64,
    /// Time of the first sample \[s\].
    pub(super) start_s: f64,
    pub(super) responses: Vec<ResponseSignal>,
    /// Channels that cannot be analysed, in words.
    pub(super) left_out: Vec<String>,
}

/// One response.
pub(super) struct ResponseSignal {
    pub(super) name: String,
    /// Unit in the file; empty without one.
    pub(super) unit: String,
    quantity: ChannelQuantity,
    /// Derivatives of the displacement, for an acceleration, a velocity or a displacement.
    pub(super) derivatives: Option<i32>,
    /// Factor to the SI unit of a known unit, and the derivatives.
    pub(super) metres: Option<(f64, i32)>,
    /// Samples about their median, in the unit of the channel.
    pub(super) samples: Vec<f64>,
}

impl DecaySignals {
    /// The chosen responses of a record; `None` for a record that is not in time.
    pub(super) fn of(
        file: &Path,
        number: usize,
        mut record: Record,
        sensors: &[ChannelSensor],
        responses: &[ChannelSelector],
    ) -> Result<Option<Self>, AnalysisError> {
        if !is_in_time(&record) {
            return Ok(None);
        }
        calibrate(sensors, file, &mut record)?;
        let places = choose_any_responses(file, &record, responses)?;
        let problem =
            |problem| Err(AnalysisError::Record { file: file.to_owned(), record: number, problem });
        let mut found = Self {
            sample_rate_hz: f64::NAN,
            start_s: 0.0,
            responses: Vec::new(),
            left_out: Vec::new(),
        };
        for place in places {
            let channel = &mut record.channels[place];
            let Some(rate) = channel.sample_rate_hz() else {
                return problem("it is not sampled evenly in time");
            };
            let start_s = channel.abscissa.at(0).unwrap_or(0.0);
            let Some(signal) = ResponseSignal::of(channel) else {
                return problem("its samples are complex");
            };
            if let Some(first) = found.responses.first() {
                let together = rate == found.sample_rate_hz
                    && (start_s - found.start_s).abs() < 0.5 / rate
                    && signal.samples.len() == first.samples.len();
                if !together {
                    return problem("its responses are not sampled together");
                }
            }
            (found.sample_rate_hz, found.start_s) = (rate, start_s);
            let bad = signal.samples.iter().filter(|x| !x.is_finite()).count();
            if bad > 0 {
                let name = &signal.name;
                let text = format!("`{name}` left out: {bad} of its samples are not finite");
                found.left_out.push(text);
            } else if signal.is_constant() {
                found.left_out.push(format!("`{}` left out: it is constant", signal.name));
            } else {
                found.responses.push(signal);
            }
        }
        Ok(Some(found))
    }

    pub(super) fn samples(&self) -> usize {
        self.responses.first().map_or(0, |signal| signal.samples.len())
    }

    pub(super) fn slices(&self) -> Vec<&[f64]> {
        self.responses.iter().map(|signal| signal.samples.as_slice()).collect()
    }

    /// A part of the responses, with their derivatives.
    pub(super) fn parts(&self, range: Range<usize>) -> Vec<(&[f64], i32)> {
        let part = |signal: &'_ ResponseSignal| signal.derivatives.unwrap_or(1);
        self.responses.iter().map(|signal| (&signal.samples[range.clone()], part(signal))).collect()
    }

    /// Frequency (Hz) of the strongest resonance of the record; `None` for a record without
    /// responses or of a few samples.
    pub(super) fn cycle_hz(&self) -> Result<Option<f64>, AnalysisError> {
        let Some(first) = self.responses.first() else { return Ok(None) };
        let all = first.samples.len();
        let rate = self.sample_rate_hz;
        let level = |sample: usize| first.samples[sample].abs();
        let largest = (0..all).max_by(|&a, &b| level(a).total_cmp(&level(b))).unwrap_or(0);
        let begin = largest.saturating_sub(MOST_FOR_CYCLE / 8).min(all.saturating_sub(1));
        let end = all.min(begin + MOST_FOR_CYCLE);
        let band = (MIN_CYCLES * rate / (end - begin) as f64, MAX_FREQUENCY * rate);
        if band.1 <= band.0 {
            return Ok(None);
        }
        let found = DecayResonance::strongest(&self.parts(begin..end), rate, band)?;
        Ok(found.map(|found| found.frequency_hz))
    }
}

impl ResponseSignal {
    /// The response of a channel; `None` for complex samples.
    fn of(channel: &mut Channel) -> Option<Self> {
        let empty = Samples::Real(Vec::new());
        let Samples::Real(mut samples) = std::mem::replace(&mut channel.samples, empty) else {
            return None;
        };
        let median = robust_level(&samples).map_or(0.0, |level| level.median);
        for x in &mut samples {
            *x -= median;
        }
        let derivatives = match channel.quantity {
            ChannelQuantity::Displacement => Some(0),
            ChannelQuantity::Velocity => Some(1),
            ChannelQuantity::Acceleration => Some(2),
            _ => None,
        };
        let factor = channel.unit.known().map(|unit| unit.factor());
        Some(Self {
            name: channel.name.clone(),
            unit: channel.unit.text().to_owned(),
            quantity: channel.quantity,
            derivatives,
            metres: factor.zip(derivatives),
            samples,
        })
    }

    fn is_constant(&self) -> bool {
        self.samples.iter().all(|x| *x == self.samples[0])
    }

    pub(super) fn channel(&self) -> DecayChannel {
        DecayChannel {
            name: self.name.clone(),
            quantity: self.quantity.to_string(),
            unit: self.unit.clone(),
            si_unit: self.metres.map(|_| self.quantity.si_symbol()),
        }
    }
}
