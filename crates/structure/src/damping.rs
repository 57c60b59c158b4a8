//! Damping of the bodies.

use std::f64::consts::TAU;

use asperity_mesh::BodyDamping;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::StructureError;

/// The viscosity `h` of Eq. (1), given directly or by the ratio it has at the lowest mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// Damping ratio xi of the lowest mode linearised at static equilibrium: `h = 2 xi w0`. The
    /// paper writes `xi = h / (2 m w0)`, whose dimension does not fit Eq. (1).
    Ratio(f64),
    /// The rate h itself \[1/s\].
    Rate(f64),
}

impl Damping {
    /// The rate h \[1/s\] where the lowest natural frequency is `natural` \[Hz\].
    pub(crate) fn rate(self, natural: Result<f64, StructureError>) -> Result<f64, StructureError> {
        let (quantity, value) = match self {
            Self::Ratio(ratio) => ("damping ratio", ratio),
            Self::Rate(rate) => ("damping rate [1/s]", rate),
        };
        if !(value.is_finite() && value >= 0.0) {
            let accepted = "finite and not negative";
            return Err(StructureError::Setting { quantity, value, accepted });
        }
        let rate = match self {
            Self::Ratio(ratio) if ratio > 0.0 => 2.0 * ratio * TAU * natural?,
            Self::Ratio(_) | Self::Rate(_) => value,
        };
        if rate.is_finite() {
            Ok(rate)
        } else {
            let quantity = "damping rate [1/s]";
            Err(StructureError::Setting { quantity, value: rate, accepted: "finite" })
        }
    }
}

/// Damping of the bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "DampingKeys", into = "DampingKeys")]
pub enum DampingSpec {
    /// Force `h rho A u'` per length on every body: h times its momentum per length.
    MassProportional(Damping),
    /// Rayleigh damping, `C = a M + b K` of every body.
    Rayleigh(RayleighSpec),
    /// Modulus `E (1 + i eta)` of every body in harmonic vibration, with the loss factor eta; steady
    /// responses and linearised modes only.
    LossFactor(f64),
    /// Damping ratios of the linearised modes; steady responses and linearised modes only.
    Modal(ModalDampingSpec),
}

impl DampingSpec {
    /// The mass-proportional and the internal damping of the bodies. Ratios of modes are none of them:
    /// they are those of the structure at rest,
    /// [`with_modal_damping`](crate::PreloadedStructure::with_modal_damping).
    ///
    /// # Errors
    /// [`StructureError::Mesh`] for an internal damping that is negative or not finite.
    pub fn of_bodies(&self) -> Result<(Damping, BodyDamping), StructureError> {
        Ok(match self {
            Self::MassProportional(damping) => (*damping, BodyDamping::NONE),
            Self::Rayleigh(rayleigh) => {
                let (rate, time) = rayleigh.coefficients();
                (Damping::Rate(rate), BodyDamping::kelvin_voigt(time)?)
            }
            Self::LossFactor(factor) => (Damping::Rate(0.0), BodyDamping::loss_factor(*factor)?),
            Self::Modal(_) => (Damping::Rate(0.0), BodyDamping::NONE),
        })
    }
}

/// Damping ratios of the modes linearised about static equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalDampingSpec {
    /// Ratio of each mode, from the lowest on.
    pub ratios: Vec<f64>,
    /// Ratio of the first mode after these; the last of them if none is given. Modes above have its
    /// damping rate.
    pub other_ratio: Option<f64>,
}

impl ModalDampingSpec {
    /// Ratio of the first mode after the given ones.
    pub fn other(&self) -> f64 {
        self.other_ratio.or_else(|| self.ratios.last().copied()).unwrap_or_default()
    }
}

/// Coefficients of Rayleigh damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RayleighSpec {
    /// The coefficients themselves.
    Coefficients {
        /// Mass-proportional damping rate a in 1/s.
        rate_per_s: f64,
        /// Stiffness-proportional retardation time b in s.
        time_s: f64,
    },
    /// The damping ratios of free modes of the bodies at two frequencies.
    Ratios([RatioAtFrequency; 2]),
}

/// A damping ratio at a frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RatioAtFrequency {
    /// Frequency in Hz.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub frequency_hz: f64,
    /// Damping ratio there.
    #[schemars(range(min = 0.0))]
    pub ratio: f64,
}

impl RayleighSpec {
    /// The coefficients a \[1/s\] and b \[s\] of `zeta = a / (2 w) + b w / 2`: with the ratios given,
    ///
    /// ```text
    /// b = 2 (zeta2 w2 - zeta1 w1) / (w2^2 - w1^2),    a = 2 w1 w2 (zeta1 w2 - zeta2 w1) / (w2^2 - w1^2).
    /// ```
    ///
    /// Not finite for two equal frequencies.
    pub fn coefficients(&self) -> (f64, f64) {
        match *self {
            Self::Coefficients { rate_per_s, time_s } => (rate_per_s, time_s),
            Self::Ratios([first, second]) => {
                let [w1, w2] = [first, second].map(|at| TAU * at.frequency_hz);
                let scale = 2.0 / ((w2 - w1) * (w2 + w1));
                // Ratios of purely mass- or stiffness-proportional damping have an exact zero.
                let difference = |a: f64, b: f64| {
                    if (a - b).abs() <= 1e-12 * (a + b) { 0.0 } else { a - b }
                };
                let mass = difference(first.ratio * w2, second.ratio * w1) * w1 * w2;
                let stiffness = difference(second.ratio * w2, first.ratio * w1);
                (scale * mass, scale * stiffness)
            }
        }
    }

    /// Fault of the ratios, if two are given that no coefficients of zero or more have.
    pub fn fault(&self) -> Option<RayleighFault> {
        if let Self::Ratios([first, second]) = self
            && first.frequency_hz == second.frequency_hz
        {
            return Some(RayleighFault::EqualFrequencies(first.frequency_hz));
        }
        let (rate, time) = self.coefficients();
        let is_fault = |value: f64| !(value.is_finite() && value >= 0.0);
        let coefficients = [("rate_per_s", rate), ("time_s", time)].into_iter();
        let mut faults = coefficients.filter(|(_, value)| is_fault(*value));
        faults.next().map(|(quantity, value)| RayleighFault::Negative { quantity, value })
    }
}

/// Fault of two damping ratios that are not those of Rayleigh damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RayleighFault {
    /// Both ratios are given at one frequency \[Hz\].
    EqualFrequencies(f64),
    /// A coefficient would be negative or not finite.
    Negative {
        /// Its key.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
}

impl RayleighFault {
    /// Ratios that are those of Rayleigh damping, in words.
    pub const ACCEPTED: &str = "two different frequencies, the ratio at the higher over that at the lower between the quotient of the lower and the higher frequency and its inverse";
}

/// Damping of the bodies.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "DampingSpec")]
enum DampingKeys {
    /// Force on every body proportional to its momentum, with exactly one of ratio and
    /// `rate_per_s`.
    #[schemars(extend("oneOf" = [{"required": ["ratio"]}, {"required": ["rate_per_s"]}]))]
    MassProportional {
        /// Damping ratio of the lowest mode linearised about static equilibrium; give this or
        /// `rate_per_s`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        ratio: Option<f64>,
        /// Damping rate h of the equation of motion in 1/s; give this or ratio.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        rate_per_s: Option<f64>,
    },
    /// Rayleigh damping of every body, C = a M + b K, with exactly one of `time_s` and ratios: a free
    /// mode has the damping ratio a / (2 w) + b w / 2. Contacts have their own damping.
    #[schemars(extend("oneOf" = [{"required": ["time_s"]}, {"required": ["ratios"]}]))]
    Rayleigh {
        /// Mass-proportional damping rate a in 1/s, beside `time_s`; 0 when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        rate_per_s: Option<f64>,
        /// Stiffness-proportional retardation time b in s; give this or ratios.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        time_s: Option<f64>,
        /// Damping ratios at two frequencies; give this or `time_s`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        ratios: Option<[RatioAtFrequency; 2]>,
    },
    /// Hysteretic damping of every body, of steady responses and linearised modes only.
    LossFactor {
        /// Loss factor eta: a free mode has the damping ratio eta / 2.
        #[schemars(range(min = 0.0))]
        loss_factor: f64,
    },
    /// Damping ratio of each linearised mode, of steady responses and linearised modes only.
    Modal {
        /// Damping ratios of the lowest modes linearised about static equilibrium, from the lowest on.
        #[schemars(length(min = 1, max = 50), inner(range(min = 0.0)))]
        ratios: Vec<f64>,
        /// Damping ratio of the first mode after these, the last of the ratios when left out; modes
        /// above have its damping rate.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        other_ratio: Option<f64>,
    },
}

impl TryFrom<DampingKeys> for DampingSpec {
    type Error = &'static str;

    fn try_from(keys: DampingKeys) -> Result<Self, Self::Error> {
        match keys {
            DampingKeys::MassProportional { ratio, rate_per_s } => match (ratio, rate_per_s) {
                (Some(xi), None) => Ok(Self::MassProportional(Damping::Ratio(xi))),
                (None, Some(h)) => Ok(Self::MassProportional(Damping::Rate(h))),
                _ => Err("mass_proportional damping needs exactly one of ratio and rate_per_s"),
            },
            DampingKeys::Rayleigh { rate_per_s, time_s, ratios } => {
                match (rate_per_s, time_s, ratios) {
                    (rate, Some(time_s), None) => Ok(Self::Rayleigh(RayleighSpec::Coefficients {
                        rate_per_s: rate.unwrap_or(0.0),
                        time_s,
                    })),
                    (None, None, Some(ratios)) => Ok(Self::Rayleigh(RayleighSpec::Ratios(ratios))),
                    _ => {
                        Err("rayleigh damping needs time_s, with or without rate_per_s, or ratios")
                    }
                }
            }
            DampingKeys::LossFactor { loss_factor } => Ok(Self::LossFactor(loss_factor)),
            DampingKeys::Modal { ratios, other_ratio } => {
                Ok(Self::Modal(ModalDampingSpec { ratios, other_ratio }))
            }
        }
    }
}

impl From<DampingSpec> for DampingKeys {
    fn from(damping: DampingSpec) -> Self {
        match damping {
            DampingSpec::MassProportional(Damping::Ratio(xi)) => {
                Self::MassProportional { ratio: Some(xi), rate_per_s: None }
            }
            DampingSpec::MassProportional(Damping::Rate(h)) => {
                Self::MassProportional { ratio: None, rate_per_s: Some(h) }
            }
            DampingSpec::Rayleigh(RayleighSpec::Coefficients { rate_per_s, time_s }) => {
                Self::Rayleigh { rate_per_s: Some(rate_per_s), time_s: Some(time_s), ratios: None }
            }
            DampingSpec::Rayleigh(RayleighSpec::Ratios(ratios)) => {
                Self::Rayleigh { rate_per_s: None, time_s: None, ratios: Some(ratios) }
            }
            DampingSpec::LossFactor(loss_factor) => Self::LossFactor { loss_factor },
            DampingSpec::Modal(ModalDampingSpec { ratios, other_ratio }) => {
                Self::Modal { ratios, other_ratio }
            }
        }
    }
}
