//! Parameters as numbers of a scenario, steps of a law, and gains of sensors.

use asperity_inference::{FitSolution, LatentPrior, Parameter, ParameterScale, Prior};
use serde_json::Value;

use crate::error::IdentificationError;
use crate::free_law::FreeLaw;
use crate::monotone::MonotoneLaw;
use crate::problem::{ChannelSpec, ParameterSpec, PriorSpec, ScaleSpec};
use asperity_simulation::parameter::{ParameterError, ScenarioParameter};

/// The parameters of a problem and the places of their values.
#[derive(Debug, Clone)]
pub(super) struct ProblemParameters {
    /// In the order of the problem.
    pub(super) list: Vec<Parameter>,
    scalars: Vec<(usize, ScenarioParameter)>,
    laws: Vec<(usize, MonotoneLaw)>,
    /// The law without an assumed form, and the index of its first latent.
    pub(super) free: Option<(usize, FreeLaw)>,
    gains: Vec<Gain>,
}

/// A gain to identify.
#[derive(Debug, Clone, PartialEq)]
struct Gain {
    parameter: usize,
    channel: ChannelSpec,
    /// Names of the data it holds for; all if none are named.
    data: Option<Vec<String>>,
}

/// Indices of parameters that are gains of the sensors of some data.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sensors {
    force: Vec<usize>,
    response: Vec<usize>,
}

impl Sensors {
    /// The gains at `point`.
    pub(super) fn gains(&self, point: &[f64]) -> Gains {
        let product =
            |parameters: &[usize]| parameters.iter().map(|&parameter| point[parameter]).product();
        Gains { force: product(&self.force), response: product(&self.response) }
    }
}

/// Gains of the sensors of some data: measured over true value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gains {
    pub(super) force: f64,
    pub(super) response: f64,
}

impl ProblemParameters {
    /// The parameters that `specs` name in a `scenario`.
    ///
    /// # Errors
    /// [`IdentificationError`] for a pointer without a number, a law without points, or a start
    /// outside its bounds.
    pub(super) fn new(
        specs: &[ParameterSpec],
        scenario: &Value,
    ) -> Result<Self, IdentificationError> {
        let mut found = Self {
            list: Vec::new(),
            scalars: Vec::new(),
            laws: Vec::new(),
            free: None,
            gains: Vec::new(),
        };
        for spec in specs {
            found.add(spec, scenario)?;
        }
        let form_is_unknown = !found.of_form().is_empty();
        if let Some((_, free)) = &mut found.free
            && form_is_unknown
        {
            free.with_unknown_form();
            found.check_form(scenario)?;
        }
        Ok(found)
    }

    fn add(&mut self, spec: &ParameterSpec, scenario: &Value) -> Result<(), IdentificationError> {
        match spec {
            ParameterSpec::Scalar { pointer, also, name, bounds, start, scale, prior } => {
                let number = ScenarioParameter::of_scenario(scenario, pointer)?;
                let value = number.value;
                for other in also {
                    let number = ScenarioParameter::of_scenario(scenario, other)?;
                    self.scalars.push((self.list.len(), number));
                }
                let scale =
                    scale.map_or_else(|| usual_scale(pointer, *bounds), ParameterScale::from);
                let name = name.clone().unwrap_or_else(|| pointer.clone());
                let prior = prior.map(|prior| prior_of(&name, prior, scale)).transpose()?;
                self.scalars.push((self.list.len(), number));
                let start = start.unwrap_or(value);
                self.list.push(Parameter::new(name, start, *bounds, scale, prior)?);
            }
            ParameterSpec::MonotoneLaw { law: name, steps } => {
                let found = MonotoneLaw::find(scenario, name)
                    .and_then(|law| Some((law.read(scenario)?, law)));
                let (starts, law) =
                    found.ok_or_else(|| IdentificationError::NotMonotone(name.clone()))?;
                let first = self.list.len();
                for (place, start) in starts.into_iter().enumerate() {
                    let parameter = if law.has_base() && place == 0 {
                        let bounds = [start / BASE_RANGE, start * BASE_RANGE];
                        let name = format!("{name}: softest stiffness [Pa/m]");
                        Parameter::new(name, start, bounds, ParameterScale::Logarithmic, None)
                    } else {
                        let place = place + usize::from(!law.has_base());
                        // A start outside the bounds is moved inside.
                        let start = start.clamp(steps[0], steps[1]);
                        let name = format!("{name}: step {place}");
                        Parameter::new(name, start, *steps, ParameterScale::Linear, None)
                            .map(|parameter| parameter.with_length(STEP_LENGTH))
                    };
                    self.list.push(parameter?);
                }
                self.laws.push((first, law));
            }
            ParameterSpec::FreeLaw { law, .. } => {
                if self.free.is_some() {
                    let reason = "it is the second one; expected at most one free law".to_owned();
                    return Err(IdentificationError::FreeLaw { law: law.clone(), reason });
                }
                if let Some(free) = FreeLaw::new(spec, scenario)? {
                    let first = self.list.len();
                    self.list.extend(free.parameters());
                    self.free = Some((first, free));
                }
            }
            ParameterSpec::Gain { channel, name, data, bounds, prior } => {
                let usual = match channel {
                    ChannelSpec::Force => "force gain",
                    ChannelSpec::Response => "response gain",
                };
                let name = name.clone().unwrap_or_else(|| usual.to_owned());
                let scale = ParameterScale::Logarithmic;
                let prior = prior.map(|prior| prior_of(&name, prior, scale)).transpose()?;
                let start = prior.map_or(1.0, |prior| prior.mean.exp());
                let (parameter, data) = (self.list.len(), data.clone());
                self.gains.push(Gain { parameter, channel: *channel, data });
                self.list.push(Parameter::new(name, start, *bounds, scale, prior)?);
            }
        }
        Ok(())
    }

    /// Checks that every number of the form of the free law changes its slopes. Knots may be outside its
    /// pressures.
    fn check_form(&self, scenario: &Value) -> Result<(), IdentificationError> {
        let start: Vec<f64> = self.list.iter().map(Parameter::start).collect();
        let Some(free) = self.free_law_at(scenario, &start)? else { return Ok(()) };
        for j in self.of_form().into_iter().filter(|&j| !self.is_of_monotone_law(j)) {
            let parameter = &self.list[j];
            let [low, high] = parameter.bounds().map(|bound| parameter.to_working(bound));
            let at = parameter.to_working(start[j]);
            let step = FORM_STEP * (high - low);
            let mut moved = start.clone();
            moved[j] = parameter.from_working(if at + step > high { at - step } else { at + step });
            let other = self.free_law_at(scenario, &moved)?;
            if other.is_some_and(|other| other.has_slopes_of(&free)) {
                let reason = format!(
                    "its unknown \"{}\" changes no slope, and a free law has a level of its own; expected numbers that change the slope",
                    parameter.name()
                );
                return Err(IdentificationError::FreeLaw { law: free.name, reason });
            }
        }
        Ok(())
    }

    /// Puts the values of `point` into a scenario.
    ///
    /// # Errors
    /// [`IdentificationError::Parameter`] for a missing number.
    pub(super) fn write(
        &self,
        scenario: &mut Value,
        point: &[f64],
    ) -> Result<(), IdentificationError> {
        self.write_numbers(scenario, point)?;
        if let Some((first, law)) = &self.free {
            // The table comes last: it replaces the form that the other parameters have written.
            law.write(scenario, &point[*first..first + law.count()])?;
        }
        Ok(())
    }

    /// Puts the values of all parameters except the latents of the free law into a scenario.
    fn write_numbers(
        &self,
        scenario: &mut Value,
        point: &[f64],
    ) -> Result<(), IdentificationError> {
        for (parameter, ScenarioParameter { pointer, .. }) in &self.scalars {
            let place = scenario
                .pointer_mut(pointer)
                .ok_or_else(|| ParameterError::NotANumber(pointer.clone()))?;
            *place = point[*parameter].into();
        }
        for (first, law) in &self.laws {
            law.write(scenario, &point[*first..first + law.count])
                .ok_or_else(|| IdentificationError::NotMonotone(law.name.clone()))?;
        }
        Ok(())
    }

    /// The values that [`write`](Self::write) puts into this scenario, in the order of
    /// [`pointers`](Self::pointers).
    ///
    /// # Errors
    /// Those of [`write`](Self::write).
    pub(super) fn written(
        &self,
        scenario: &Value,
        point: &[f64],
    ) -> Result<Vec<Value>, IdentificationError> {
        let mut scenario = scenario.clone();
        self.write(&mut scenario, point)?;
        Ok(self.pointers().filter_map(|pointer| scenario.pointer(pointer).cloned()).collect())
    }

    /// The free law about the form that the other parameters at `point` give it.
    ///
    /// # Errors
    /// Those of [`write`](Self::write).
    pub(super) fn free_law_at(
        &self,
        scenario: &Value,
        point: &[f64],
    ) -> Result<Option<FreeLaw>, IdentificationError> {
        let Some((_, law)) = &self.free else { return Ok(None) };
        let mut scenario = scenario.clone();
        self.write_numbers(&mut scenario, point)?;
        law.about(&scenario).map(Some)
    }

    /// Indices of the parameters that are numbers of the form of the free law.
    pub(super) fn of_form(&self) -> Vec<usize> {
        let Some((_, free)) = &self.free else { return Vec::new() };
        let inside = |pointer: &str| is_within(pointer, &free.pointer);
        let scalars = self.scalars.iter().filter(|(_, number)| inside(&number.pointer));
        let laws = self.laws.iter().filter(|(_, law)| inside(&law.pairs));
        let mut found: Vec<usize> = scalars.map(|(parameter, _)| *parameter).collect();
        found.extend(laws.flat_map(|(first, law)| *first..first + law.count));
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The prior of the latents of the free law.
    pub(super) fn latent_prior(&self) -> Result<Option<LatentPrior>, IdentificationError> {
        self.free.as_ref().map(|(first, law)| law.prior(*first)).transpose()
    }

    /// Changes the latents of the free law to those that are standard normal under the mean covariance of its prior's
    /// components with these weights, and those of a fit with them.
    pub(super) fn weigh(
        &mut self,
        weights: &[f64],
        fit: FitSolution,
    ) -> Result<FitSolution, IdentificationError> {
        let Some((first, law)) = &mut self.free else { return Ok(fit) };
        let before = law.clone();
        *law = before.with_weights(weights)?;
        let changed = |latents: &[f64]| law.latents_of(&before, latents);
        let back = |latents: &[f64]| before.latents_of(law, latents);
        Ok(fit.with_latents(*first..*first + before.count(), &changed, &back))
    }

    /// The gains of the sensors of the data of this name.
    pub(super) fn sensors(&self, data: &str) -> Sensors {
        let of = |channel: ChannelSpec| {
            let fits = |gain: &&Gain| {
                gain.channel == channel
                    && gain.data.as_ref().is_none_or(|names| names.iter().any(|name| name == data))
            };
            self.gains.iter().filter(fits).map(|gain| gain.parameter).collect()
        };
        Sensors { force: of(ChannelSpec::Force), response: of(ChannelSpec::Response) }
    }

    /// The names of the parameters in words: a step of a monotone law by the stiffnesses that it
    /// relates, all others by their names.
    pub(super) fn labels(&self, scenario: &Value) -> Vec<String> {
        let mut labels: Vec<String> =
            self.list.iter().map(|parameter| parameter.name().to_owned()).collect();
        for (first, law) in &self.laws {
            let pressures = law.pressures(scenario);
            for (label, words) in labels[*first..].iter_mut().zip(law.step_labels(&pressures)) {
                *label = words;
            }
        }
        if let Some((first, law)) = &self.free {
            for (label, words) in labels[*first..].iter_mut().zip(law.labels()) {
                *label = words;
            }
        }
        labels
    }

    /// Names of the monotone laws among the parameters, with the pressures of their stiffnesses \[Pa\].
    pub(super) fn monotone_pressures(&self, scenario: &Value) -> Vec<(String, Vec<f64>)> {
        let of = |(_, law): &(usize, MonotoneLaw)| (law.name.clone(), law.pressures(scenario));
        self.laws.iter().map(of).collect()
    }

    /// True if the parameter is a step or a stiffness of a monotone law.
    pub(super) fn is_of_monotone_law(&self, parameter: usize) -> bool {
        let mut laws = self.laws.iter();
        laws.any(|(first, law)| (*first..first + law.count).contains(&parameter))
    }

    /// True if the parameter is a number of a contact law.
    pub(super) fn is_of_law(&self, parameter: usize) -> bool {
        let mut scalars = self.scalars.iter();
        scalars.any(|(place, number)| *place == parameter && number.is_of_law())
            || self.is_of_monotone_law(parameter)
            || self.list[parameter].is_latent()
    }

    /// The parameter that is the damping of the bodies.
    pub(super) fn body_damping(&self) -> Option<usize> {
        let is_body = |number: &ScenarioParameter| number.pointer.starts_with("/damping/");
        self.scalars.iter().find(|(_, number)| is_body(number)).map(|(place, _)| *place)
    }

    /// Pointers to the written numbers, without the numbers of the form that the free law replaces.
    pub(super) fn pointers(&self) -> impl Iterator<Item = &str> {
        let free = self.free.as_ref().map(|(_, law)| law.pointer.as_str());
        let stays = move |pointer: &&str| free.is_none_or(|free| !is_within(pointer, free));
        self.pointers_of_numbers().filter(stays).chain(free)
    }

    /// Pointers to the numbers of all parameters except the latents of the free law.
    pub(super) fn pointers_of_numbers(&self) -> impl Iterator<Item = &str> {
        let scalars = self.scalars.iter().map(|(_, parameter)| parameter.pointer.as_str());
        scalars.chain(self.laws.iter().map(|(_, law)| law.pairs.as_str()))
    }
}

/// Change of a number of the form of a free law, over its range, that has to change its slopes.
const FORM_STEP: f64 = 0.01;

/// Change of a step of a monotone law over which predictions change.
const STEP_LENGTH: f64 = 0.25;

/// Ratio of the bounds of the softest stiffness of a table to its start.
const BASE_RANGE: f64 = 1e3;

/// True if a JSON Pointer leads to the place of another, or inside it.
pub(super) fn is_within(pointer: &str, container: &str) -> bool {
    let rest = pointer.strip_prefix(container);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// The scale of a number: an exponent `m` is linear, since `ln K = ln C + m ln p` is, in which data at one
/// pressure determine a straight combination of `ln C` and `m`.
fn usual_scale(pointer: &str, bounds: [f64; 2]) -> ParameterScale {
    if bounds[0] > 0.0 && !pointer.ends_with("/exponent") {
        ParameterScale::Logarithmic
    } else {
        ParameterScale::Linear
    }
}

fn prior_of(
    name: &str,
    prior: PriorSpec,
    scale: ParameterScale,
) -> Result<Prior, IdentificationError> {
    let refuse = |reason| IdentificationError::Prior { parameter: name.to_owned(), reason };
    let deviation = match (prior.standard_deviation, prior.relative) {
        (Some(deviation), None) => deviation,
        (None, Some(relative)) => relative * prior.value.abs(),
        _ => return Err(refuse("exactly one of standard_deviation and relative is expected")),
    };
    if !(deviation > 0.0 && deviation.is_finite()) {
        return Err(refuse("a positive standard deviation is expected"));
    }
    match scale {
        ParameterScale::Linear => Ok(Prior { mean: prior.value, standard_deviation: deviation }),
        ParameterScale::Logarithmic if prior.value > 0.0 => {
            Ok(Prior { mean: prior.value.ln(), standard_deviation: deviation / prior.value })
        }
        ParameterScale::Logarithmic => {
            Err(refuse("a positive value is expected on a logarithmic scale"))
        }
    }
}

impl From<ScaleSpec> for ParameterScale {
    fn from(scale: ScaleSpec) -> Self {
        match scale {
            ScaleSpec::Linear => Self::Linear,
            ScaleSpec::Logarithmic => Self::Logarithmic,
        }
    }
}
