//! From what a problem calls unknown to the numbers of a scenario.

use asperity_inference::{Prior, Scale, Unknown};
use serde_json::Value;

use crate::error::ProblemError;
use crate::monotone::MonotoneLaw;
use crate::problem::{ChannelSpec, PriorSpec, ScaleSpec, UnknownSpec};
use asperity_study::parameter::{Parameter, ParameterError};

/// The unknowns of a problem, and where their values go.
#[derive(Debug, Clone)]
pub(super) struct Unknowns {
    /// In the order of the problem.
    pub(super) list: Vec<Unknown>,
    scalars: Vec<(usize, Parameter)>,
    laws: Vec<(usize, MonotoneLaw)>,
    gains: Vec<Gain>,
}

/// An unknown gain.
#[derive(Debug, Clone, PartialEq)]
struct Gain {
    unknown: usize,
    channel: ChannelSpec,
    /// Names of the data it holds for; all if none are named.
    data: Option<Vec<String>>,
}

/// Unknowns that are gains of the sensors of some data.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sensors {
    force: Vec<usize>,
    response: Vec<usize>,
}

impl Sensors {
    /// The gains at `point`.
    pub(super) fn gains(&self, point: &[f64]) -> Gains {
        let product = |unknowns: &[usize]| unknowns.iter().map(|&unknown| point[unknown]).product();
        Gains { force: product(&self.force), response: product(&self.response) }
    }
}

/// What the sensors of some data show over what there is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gains {
    pub(super) force: f64,
    pub(super) response: f64,
}

impl Unknowns {
    /// The unknowns that `specs` name in a `scenario`.
    ///
    /// # Errors
    /// [`ProblemError`] where a pointer leads to no number, a law is none of steps, or a start is
    /// not within its bounds.
    pub(super) fn new(specs: &[UnknownSpec], scenario: &Value) -> Result<Self, ProblemError> {
        let mut found =
            Self { list: Vec::new(), scalars: Vec::new(), laws: Vec::new(), gains: Vec::new() };
        for spec in specs {
            found.add(spec, scenario)?;
        }
        Ok(found)
    }

    fn add(&mut self, spec: &UnknownSpec, scenario: &Value) -> Result<(), ProblemError> {
        match spec {
            UnknownSpec::Scalar { pointer, name, bounds, start, scale, prior } => {
                let parameter = Parameter::of_scenario(scenario, pointer)?;
                let value = parameter.value;
                let scale = scale.map_or_else(|| usual_scale(*bounds), Scale::from);
                let name = name.clone().unwrap_or_else(|| pointer.clone());
                let prior = prior.map(|prior| prior_of(&name, prior, scale)).transpose()?;
                self.scalars.push((self.list.len(), parameter));
                self.list.push(Unknown::new(name, start.unwrap_or(value), *bounds, scale, prior)?);
            }
            UnknownSpec::MonotoneLaw { law: name, steps } => {
                let law = MonotoneLaw::find(scenario, name)
                    .ok_or_else(|| ProblemError::NotMonotone { law: name.clone() })?;
                let starts = law
                    .read(scenario)
                    .ok_or_else(|| ProblemError::NotMonotone { law: name.clone() })?;
                let first = self.list.len();
                for (place, start) in starts.into_iter().enumerate() {
                    let unknown = if law.has_base() && place == 0 {
                        let bounds = [start / BASE_RANGE, start * BASE_RANGE];
                        let name = format!("{name}: softest stiffness [Pa/m]");
                        Unknown::new(name, start, bounds, Scale::Logarithmic, None)
                    } else {
                        let place = place + usize::from(!law.has_base());
                        // A law that the bounds leave out is started inside them.
                        let start = start.clamp(steps[0], steps[1]);
                        let name = format!("{name}: step {place}");
                        Unknown::new(name, start, *steps, Scale::Linear, None)
                    };
                    self.list.push(unknown?);
                }
                self.laws.push((first, law));
            }
            UnknownSpec::Gain { channel, name, data, bounds, prior } => {
                let usual = match channel {
                    ChannelSpec::Force => "force gain",
                    ChannelSpec::Response => "response gain",
                };
                let name = name.clone().unwrap_or_else(|| usual.to_owned());
                let scale = Scale::Logarithmic;
                let prior = prior.map(|prior| prior_of(&name, prior, scale)).transpose()?;
                let start = prior.map_or(1.0, |prior| prior.mean.exp());
                self.gains.push(Gain {
                    unknown: self.list.len(),
                    channel: *channel,
                    data: data.clone(),
                });
                self.list.push(Unknown::new(name, start, *bounds, scale, prior)?);
            }
        }
        Ok(())
    }

    /// Puts the values of `point` into a scenario.
    ///
    /// # Errors
    /// [`ProblemError::Parameter`] where the scenario has no such number.
    pub(super) fn write(&self, scenario: &mut Value, point: &[f64]) -> Result<(), ProblemError> {
        for (unknown, Parameter { pointer, .. }) in &self.scalars {
            let place = scenario
                .pointer_mut(pointer)
                .ok_or_else(|| ParameterError::NotANumber { pointer: pointer.clone() })?;
            *place = point[*unknown].into();
        }
        for (first, law) in &self.laws {
            law.write(scenario, &point[*first..first + law.count])
                .ok_or_else(|| ProblemError::NotMonotone { law: law.name.clone() })?;
        }
        Ok(())
    }

    /// The unknown gains of the sensors that measured the data of this name.
    pub(super) fn sensors(&self, data: &str) -> Sensors {
        let of = |channel: ChannelSpec| {
            let fits = |gain: &&Gain| {
                gain.channel == channel
                    && gain.data.as_ref().is_none_or(|names| names.iter().any(|name| name == data))
            };
            self.gains.iter().filter(fits).map(|gain| gain.unknown).collect()
        };
        Sensors { force: of(ChannelSpec::Force), response: of(ChannelSpec::Response) }
    }

    /// Whether the unknown is a number of a contact law.
    pub(super) fn is_of_law(&self, unknown: usize) -> bool {
        let mut scalars = self.scalars.iter();
        scalars.any(|(place, parameter)| *place == unknown && parameter.is_of_law())
            || self.laws.iter().any(|(first, law)| (*first..first + law.count).contains(&unknown))
    }

    /// Pointers that are written.
    pub(super) fn pointers(&self) -> impl Iterator<Item = &str> {
        let scalars = self.scalars.iter().map(|(_, parameter)| parameter.pointer.as_str());
        scalars.chain(self.laws.iter().map(|(_, law)| law.pointer()))
    }
}

/// Range of the softest stiffness of a table, up and down.
const BASE_RANGE: f64 = 1e3;

fn usual_scale(bounds: [f64; 2]) -> Scale {
    if bounds[0] > 0.0 { Scale::Logarithmic } else { Scale::Linear }
}

fn prior_of(name: &str, prior: PriorSpec, scale: Scale) -> Result<Prior, ProblemError> {
    let refuse = |reason| ProblemError::Prior { unknown: name.to_owned(), reason };
    let deviation = match (prior.standard_deviation, prior.relative) {
        (Some(deviation), None) => deviation,
        (None, Some(relative)) => relative * prior.value.abs(),
        _ => return Err(refuse("exactly one of standard_deviation and relative is expected")),
    };
    if !(deviation > 0.0 && deviation.is_finite()) {
        return Err(refuse("a positive standard deviation is expected"));
    }
    match scale {
        Scale::Linear => Ok(Prior { mean: prior.value, standard_deviation: deviation }),
        Scale::Logarithmic if prior.value > 0.0 => {
            Ok(Prior { mean: prior.value.ln(), standard_deviation: deviation / prior.value })
        }
        Scale::Logarithmic => Err(refuse("a positive value is expected on a logarithmic scale")),
    }
}

impl From<ScaleSpec> for Scale {
    fn from(scale: ScaleSpec) -> Self {
        match scale {
            ScaleSpec::Linear => Self::Linear,
            ScaleSpec::Logarithmic => Self::Logarithmic,
        }
    }
}
