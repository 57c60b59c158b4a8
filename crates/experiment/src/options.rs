//! Options of an analysis, and their text forms.

use std::str::FromStr;

use asperity_measure::{ReadOptions, SensorSensitivity};
use asperity_signal::{FrfEstimator, FrfForm, HvScaling};
use serde::Serialize;

use crate::channel::{ChannelSelector, ResponseChoice};
use crate::error::AnalysisError;

/// Options of an analysis of measured hits.
#[derive(Debug, Clone)]
pub struct AnalysisOptions {
    /// File of the rig's settings that these options come from, for the provenance.
    pub rig: Option<RigFile>,
    /// Properties that the files do not give: sample rate, names, units.
    pub reading: ReadOptions,
    /// Sensors of channels that are in volts; of several for a channel the first counts.
    pub sensitivities: Vec<ChannelSensor>,
    /// Channel of the force; `None` for the only one.
    pub force: Option<ChannelSelector>,
    /// Channels of the responses.
    pub responses: ResponseChoice,
    /// True where the force is negative while the hammer pushes.
    pub flip_force: bool,
    /// Number of hits.
    pub hits: HitCount,
    /// Trigger level \[N\]; `None` for the widest gap between noise and hits.
    pub trigger_level_n: Option<f64>,
    /// Longest hit \[s\]; `None` for the median time between hits.
    pub hit_length_s: Option<f64>,
    /// Time kept before the trigger \[s\].
    pub pre_trigger_s: f64,
    /// Time after a trigger in which a further impact makes a double hit \[s\].
    pub hold_off_s: f64,
    /// Estimator of the averaged function.
    pub estimator: FrfEstimator,
    /// Form of the averaged function.
    pub form: FrfForm,
    /// Windows before the transform.
    pub windows: WindowOptions,
    /// Corner `f_c` \[Hz\] of a high-pass of second order for the responses, which takes out drifts; `None`
    /// for none. At a frequency `f` it changes the magnitude by `(f_c/f)^4 / 2` of itself, and the phase
    /// by `sqrt(2) f_c/f` rad.
    pub high_pass_hz: Option<f64>,
    /// Hits to be left out of averages and statistics.
    pub rejected: Vec<RejectedHit>,
    /// Band of the fundamental \[Hz\]; `None` for a band about the strongest resonance of the first
    /// good hit.
    pub band_hz: Option<FrequencyBand>,
    /// True where double hits, overloads and dropouts are averaged too.
    pub keep_all: bool,
    /// True where the function of each hit is kept for [`Analysis::frf_record`](crate::Analysis).
    pub keep_frfs: bool,
}

impl Default for AnalysisOptions {
    fn default() -> Self {
        Self {
            rig: None,
            reading: ReadOptions { block: 1 << 16, ..ReadOptions::default() },
            sensitivities: Vec::new(),
            force: None,
            responses: ResponseChoice::Only,
            flip_force: false,
            hits: HitCount::Auto,
            trigger_level_n: None,
            hit_length_s: None,
            pre_trigger_s: 5e-3,
            hold_off_s: 0.2,
            estimator: FrfEstimator::H1,
            form: FrfForm::Receptance,
            windows: WindowOptions::automatic(),
            high_pass_hz: None,
            rejected: Vec::new(),
            band_hz: None,
            keep_all: false,
            keep_frfs: false,
        }
    }
}

impl AnalysisOptions {
    /// True for a hit that is rejected by its number, or by its file and its time to within the
    /// pre-trigger.
    pub(crate) fn rejects(&self, number: usize, file: &str, time_s: f64) -> bool {
        self.rejected.iter().any(|rejected| match rejected {
            RejectedHit::Number(own) => *own == number,
            RejectedHit::At { file: own, time_s: at } => {
                own == file && (at - time_s).abs() < self.pre_trigger_s
            }
        })
    }

    /// Checks that levels and times are positive.
    pub(crate) fn check(&self) -> Result<(), AnalysisError> {
        let times = [
            ("trigger_level_n", self.trigger_level_n),
            ("hit_length_s", self.hit_length_s),
            ("pre_trigger_s", Some(self.pre_trigger_s)),
            ("hold_off_s", Some(self.hold_off_s)),
            ("high_pass_hz", self.high_pass_hz),
        ];
        for (name, value) in times {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return Err(invalid(name, &value.to_string(), "a positive number"));
            }
        }
        if self.hold_off_s <= self.pre_trigger_s {
            let found = self.hold_off_s.to_string();
            return Err(invalid("hold_off_s", &found, "a time longer than pre_trigger_s"));
        }
        Ok(())
    }
}

/// A hit that someone has rejected.
#[derive(Debug, Clone, PartialEq)]
pub enum RejectedHit {
    /// Its number in the analysis, from 1.
    Number(usize),
    /// Its file and time \[s\] of the trigger, for an analysis of other files too.
    At {
        /// Name of the file, as given.
        file: String,
        /// Time in its record \[s\].
        time_s: f64,
    },
}

/// File of a rig's settings.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RigFile {
    /// Name, as given.
    pub file: String,
    /// SHA-256 of the file.
    pub sha256: String,
}

/// Number of hits in the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HitCount {
    /// All peaks above the widest gap.
    Auto,
    /// This number of the strongest hits.
    Strongest(usize),
}

impl FromStr for HitCount {
    type Err = AnalysisError;

    /// Reads `auto` or a number from 1.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let number = text.parse().ok().filter(|number| *number > 0).map(Self::Strongest);
        number.ok_or_else(|| invalid("the number of hits", text, "auto, or a number from 1"))
    }
}

/// Sensor of a channel, such as `hammer=2.25mV/N`.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSensor {
    /// Channel.
    pub channel: ChannelSelector,
    /// Sensitivity of the sensor.
    pub sensitivity: SensorSensitivity,
}

impl FromStr for ChannelSensor {
    type Err = AnalysisError;

    /// Reads `CHANNEL=100mV/g`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = "CHANNEL=SENSITIVITY, such as hammer=2.25mV/N";
        let parts = text.rsplit_once('=').filter(|(channel, _)| !channel.is_empty());
        let (channel, sensitivity) = parts.ok_or_else(|| invalid("the sensor", text, expected))?;
        Ok(Self { channel: channel.into(), sensitivity: sensitivity.parse()? })
    }
}

/// Band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyBand {
    /// Lower limit \[Hz\].
    pub low_hz: f64,
    /// Upper limit \[Hz\].
    pub high_hz: f64,
}

impl FromStr for FrequencyBand {
    type Err = AnalysisError;

    /// Reads `LO:HI` in hertz, `0 <= LO < HI`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let limits = text.split_once(':').and_then(|(low, high)| {
            Some(Self { low_hz: low.trim().parse().ok()?, high_hz: high.trim().parse().ok()? })
        });
        let ordered = |band: &Self| {
            band.low_hz >= 0.0 && band.high_hz > band.low_hz && band.high_hz.is_finite()
        };
        limits.filter(ordered).ok_or_else(|| {
            invalid("the band", text, "LO:HI in Hz with 0 <= LO < HI, such as 600:1000")
        })
    }
}

/// Windows before the transform.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WindowOptions {
    /// True for a force window: the force is set to zero outside the pulse.
    pub force: bool,
    /// Exponential window on both signals.
    pub exponential: Option<TimeConstant>,
    /// True where both signals are set to zero where they are noise: the force outside the samples
    /// above its noise, the response after its decay.
    pub until_noise: bool,
}

impl WindowOptions {
    /// Signals that end in noise, and no other window.
    pub fn automatic() -> Self {
        Self { until_noise: true, ..Self::default() }
    }
}

/// Time constant of an exponential window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeConstant {
    /// Decay to 1 % over the longest hit.
    OfLength,
    /// Time constant \[s\].
    Seconds(f64),
}

impl FromStr for WindowOptions {
    type Err = AnalysisError;

    /// Reads `auto`, `none`, `force`, `exponential`, `exponential:TAU`, `force+exponential`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let accepted =
            "auto, none, force, exponential[:TAU] with TAU in seconds, or force+exponential";
        let error = || invalid("the window", text, accepted);
        match text {
            "auto" => return Ok(Self::automatic()),
            "none" => return Ok(Self::default()),
            _ => {}
        }
        let mut choice = Self::default();
        for part in text.split('+') {
            let (name, value) = part.split_once(':').map_or((part, None), |(n, v)| (n, Some(v)));
            match (name, value) {
                ("force", None) => choice.force = true,
                ("exponential", None) => choice.exponential = Some(TimeConstant::OfLength),
                ("exponential", Some(value)) => {
                    let tau = value.parse().ok().filter(|t: &f64| *t > 0.0 && t.is_finite());
                    choice.exponential = Some(TimeConstant::Seconds(tau.ok_or_else(error)?));
                }
                _ => return Err(error()),
            }
        }
        Ok(choice)
    }
}

/// Parses the name of an estimator: `h1`, `h2`, or `hv` with equal noise ratios.
///
/// # Errors
/// [`AnalysisError::Setting`] for any other text.
pub fn parse_estimator(text: &str) -> Result<FrfEstimator, AnalysisError> {
    match text {
        "h1" => Ok(FrfEstimator::H1),
        "h2" => Ok(FrfEstimator::H2),
        "hv" => Ok(FrfEstimator::Hv(HvScaling::EqualRatios)),
        _ => Err(invalid("the estimator", text, "h1, h2, hv")),
    }
}

/// Name of an estimator, as [`parse_estimator`] reads it.
pub(crate) fn estimator_name(estimator: FrfEstimator) -> &'static str {
    match estimator {
        FrfEstimator::H1 => "h1",
        FrfEstimator::H2 => "h2",
        FrfEstimator::Hv(_) => "hv",
    }
}

/// Parses the name of a form of the frequency response function: `receptance`, `mobility` or
/// `accelerance`.
///
/// # Errors
/// [`AnalysisError::Setting`] for any other text.
pub fn parse_frf_form(text: &str) -> Result<FrfForm, AnalysisError> {
    let forms = [FrfForm::Receptance, FrfForm::Mobility, FrfForm::Accelerance];
    let found = forms.into_iter().find(|form| form.name() == text);
    found.ok_or_else(|| invalid("the form", text, "receptance, mobility, accelerance"))
}

/// Error of a setting that is not valid.
fn invalid(name: &'static str, found: &str, expected: &'static str) -> AnalysisError {
    AnalysisError::Setting { name, found: found.to_owned(), expected }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_options_are_parsed() {
        assert_eq!("auto".parse::<HitCount>().unwrap(), HitCount::Auto);
        assert_eq!("12".parse::<HitCount>().unwrap(), HitCount::Strongest(12));
        let both: WindowOptions = "force+exponential:0.05".parse().unwrap();
        assert!(both.force && both.exponential == Some(TimeConstant::Seconds(0.05)));
        assert_eq!("none".parse::<WindowOptions>().unwrap(), WindowOptions::default());
        let band: FrequencyBand = "500:1400".parse().unwrap();
        assert_eq!((band.low_hz, band.high_hz), (500.0, 1400.0));
        let sensor: ChannelSensor = "#2=100 mV/g".parse().unwrap();
        assert_eq!(sensor.channel, ChannelSelector::Number(2));
    }

    #[test]
    fn errors_name_the_accepted_texts() {
        for text in ["0", "-1", "many"] {
            assert!(text.parse::<HitCount>().is_err(), "{text}");
        }
        for text in ["1400:500", "5", "a:b", "nan:5", "0:inf"] {
            assert!(text.parse::<FrequencyBand>().is_err(), "{text}");
        }
        for text in ["hann", "exponential:0", "force+none", ""] {
            let error = text.parse::<WindowOptions>().unwrap_err();
            assert!(error.to_string().contains("exponential[:TAU]"), "{error}");
        }
        for text in ["hammer", "=1mV/N", "hammer=3"] {
            assert!(text.parse::<ChannelSensor>().is_err(), "{text}");
        }
        assert!(parse_estimator("h3").is_err() && parse_frf_form("stiffness").is_err());
    }
}
