//! What an analysis is told, and the texts that tell it.

use std::str::FromStr;

use asperity_measure::{ReadOptions, SensorSensitivity};
use asperity_signal::{FrfEstimator, FrfForm, HvScaling};

use crate::error::AnalysisError;
use crate::select::Selector;

/// How files of measured hits are analysed.
#[derive(Debug, Clone)]
pub struct AnalysisOptions {
    /// What the files do not say: rate, names, units.
    pub reading: ReadOptions,
    /// Sensors of channels that hold volts.
    pub sensitivities: Vec<SensorOf>,
    /// The force; the only channel of a force, if not given.
    pub force: Option<Selector>,
    /// The response; the only acceleration, velocity or displacement, if not given.
    pub response: Option<Selector>,
    /// Whether a negative force pushes.
    pub flip_force: bool,
    /// How many hits there are.
    pub hits: HitCount,
    /// Trigger level \[N\]; found from the force if not given.
    pub level_n: Option<f64>,
    /// Longest hit \[s\]; the median distance of the hits if not given.
    pub length_s: Option<f64>,
    /// Time kept before the trigger \[s\].
    pub pre_trigger_s: f64,
    /// Time after a trigger in which a further blow is a double hit and no hit of its own \[s\].
    pub hold_off_s: f64,
    /// How the average is divided.
    pub estimator: FrfEstimator,
    /// What the written frequency response function is.
    pub form: FrfForm,
    /// Windows before the transform.
    pub window: WindowChoice,
    /// Where the fundamental is looked for \[Hz\].
    pub band_hz: Option<Band>,
    /// Whether bad hits are averaged too.
    pub keep_all: bool,
}

impl Default for AnalysisOptions {
    fn default() -> Self {
        Self {
            reading: ReadOptions { block: 1 << 16, ..ReadOptions::default() },
            sensitivities: Vec::new(),
            force: None,
            response: None,
            flip_force: false,
            hits: HitCount::Auto,
            level_n: None,
            length_s: None,
            pre_trigger_s: 5e-3,
            hold_off_s: 0.2,
            estimator: FrfEstimator::H1,
            form: FrfForm::Receptance,
            window: WindowChoice::default(),
            band_hz: None,
            keep_all: false,
        }
    }
}

impl AnalysisOptions {
    /// Refuses times that are not positive, and a band that is none.
    pub(super) fn check(&self) -> Result<(), AnalysisError> {
        let times = [
            ("--level", self.level_n),
            ("--length", self.length_s),
            ("--pre-trigger", Some(self.pre_trigger_s)),
            ("--hold-off", Some(self.hold_off_s)),
        ];
        for (option, value) in times {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return Err(wrong(option, &value.to_string(), "a positive number"));
            }
        }
        if self.hold_off_s <= self.pre_trigger_s {
            let found = self.hold_off_s.to_string();
            return Err(wrong("--hold-off", &found, "a time longer than --pre-trigger"));
        }
        Ok(())
    }
}

/// How many hits the files hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HitCount {
    /// As many as stand out.
    Auto,
    /// The strongest ones, this many.
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
        number.ok_or_else(|| wrong("--hits", text, "auto, or a number from 1"))
    }
}

/// The sensor of a channel: `CHANNEL=100mV/g`.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorOf {
    /// Which channel.
    pub channel: Selector,
    /// What it gives for what it measures.
    pub sensitivity: SensorSensitivity,
}

impl FromStr for SensorOf {
    type Err = AnalysisError;

    /// Reads `CHANNEL=100mV/g`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = "CHANNEL=SENSITIVITY, such as hammer=2.25mV/N";
        let parts = text.rsplit_once('=').filter(|(channel, _)| !channel.is_empty());
        let (channel, sensitivity) = parts.ok_or_else(|| wrong("--sensitivity", text, expected))?;
        Ok(Self { channel: Selector::of_text(channel), sensitivity: sensitivity.parse()? })
    }
}

/// A band of frequencies: `LO:HI`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower limit \[Hz\].
    pub low_hz: f64,
    /// Upper limit \[Hz\].
    pub high_hz: f64,
}

impl FromStr for Band {
    type Err = AnalysisError;

    /// Reads `LO:HI` in hertz, `0 <= LO < HI`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let limits = text.split_once(':').and_then(|(low, high)| {
            Some(Self { low_hz: low.trim().parse().ok()?, high_hz: high.trim().parse().ok()? })
        });
        let ordered = |band: &Self| {
            band.low_hz >= 0.0 && band.high_hz > band.low_hz && band.high_hz.is_finite()
        };
        limits.filter(ordered).ok_or_else(|| wrong("--band", text, "LO:HI in hertz, LO below HI"))
    }
}

/// Windows before the transform: `none`, `force`, `exponential[:TAU]`, or both with a `+`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WindowChoice {
    /// Whether the force is blanked but for the blow.
    pub force: bool,
    /// Whether an exponential window is laid on both signals, and which.
    pub exponential: Option<TimeConstant>,
}

/// The time constant of an exponential window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeConstant {
    /// Down to a hundredth over the longest hit.
    OfLength,
    /// This one \[s\].
    Seconds(f64),
}

impl FromStr for WindowChoice {
    type Err = AnalysisError;

    /// Reads `none`, `force`, `exponential`, `exponential:TAU`, `force+exponential`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let accepted = "none, force, exponential[:TAU] with TAU in seconds, or force+exponential";
        let refuse = || wrong("--window", text, accepted);
        if text == "none" {
            return Ok(Self::default());
        }
        let mut choice = Self::default();
        for part in text.split('+') {
            let (name, value) = part.split_once(':').map_or((part, None), |(n, v)| (n, Some(v)));
            match (name, value) {
                ("force", None) => choice.force = true,
                ("exponential", None) => choice.exponential = Some(TimeConstant::OfLength),
                ("exponential", Some(value)) => {
                    let tau = value.parse().ok().filter(|t: &f64| *t > 0.0 && t.is_finite());
                    choice.exponential = Some(TimeConstant::Seconds(tau.ok_or_else(refuse)?));
                }
                _ => return Err(refuse()),
            }
        }
        Ok(choice)
    }
}

/// The estimator that `text` names: `h1`, `h2`, or `hv` with equal noise ratios.
///
/// # Errors
/// [`AnalysisError::Option`] for anything else.
pub fn estimator(text: &str) -> Result<FrfEstimator, AnalysisError> {
    match text {
        "h1" => Ok(FrfEstimator::H1),
        "h2" => Ok(FrfEstimator::H2),
        "hv" => Ok(FrfEstimator::Hv(HvScaling::EqualRatios)),
        _ => Err(wrong("--estimator", text, "h1, h2, hv")),
    }
}

/// Name of an estimator, as [`estimator`] reads it.
pub(super) fn estimator_name(estimator: FrfEstimator) -> &'static str {
    match estimator {
        FrfEstimator::H1 => "h1",
        FrfEstimator::H2 => "h2",
        FrfEstimator::Hv(_) => "hv",
    }
}

/// The motion over force that `text` names: `receptance`, `mobility` or `accelerance`.
///
/// # Errors
/// [`AnalysisError::Option`] for anything else.
pub fn form(text: &str) -> Result<FrfForm, AnalysisError> {
    let forms = [FrfForm::Receptance, FrfForm::Mobility, FrfForm::Accelerance];
    let found = forms.into_iter().find(|form| form.name() == text);
    found.ok_or_else(|| wrong("--form", text, "receptance, mobility, accelerance"))
}

pub(super) fn wrong(option: &'static str, found: &str, expected: &'static str) -> AnalysisError {
    AnalysisError::Option { option, found: found.to_owned(), expected }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_options_are_read() {
        assert_eq!("auto".parse::<HitCount>().unwrap(), HitCount::Auto);
        assert_eq!("12".parse::<HitCount>().unwrap(), HitCount::Strongest(12));
        let both: WindowChoice = "force+exponential:0.05".parse().unwrap();
        assert!(both.force && both.exponential == Some(TimeConstant::Seconds(0.05)));
        assert_eq!("none".parse::<WindowChoice>().unwrap(), WindowChoice::default());
        let band: Band = "500:1400".parse().unwrap();
        assert_eq!((band.low_hz, band.high_hz), (500.0, 1400.0));
        let sensor: SensorOf = "#2=100 mV/g".parse().unwrap();
        assert_eq!(sensor.channel, Selector::Number(2));
    }

    #[test]
    fn what_is_no_option_is_refused_with_what_is_accepted() {
        for text in ["0", "-1", "many"] {
            assert!(text.parse::<HitCount>().is_err(), "{text}");
        }
        for text in ["1400:500", "5", "a:b", "nan:5", "0:inf"] {
            assert!(text.parse::<Band>().is_err(), "{text}");
        }
        for text in ["hann", "exponential:0", "force+none", ""] {
            let error = text.parse::<WindowChoice>().unwrap_err();
            assert!(error.to_string().contains("exponential[:TAU]"), "{error}");
        }
        for text in ["hammer", "=1mV/N", "hammer=3"] {
            assert!(text.parse::<SensorOf>().is_err(), "{text}");
        }
        assert!(estimator("h3").is_err() && form("stiffness").is_err());
    }
}
