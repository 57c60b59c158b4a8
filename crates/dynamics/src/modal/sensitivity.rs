//! Derivatives of a transient case with respect to parameters, exact through the step.
//!
//! A step of the modal integrator is
//!
//! ```text
//! y* = sum of g q* + residual load,   y + B p(y) = y*,
//! d = d* - t0 F(p),  q = q* - t0 F,    d* = e d - k q + carried forces + load,  q* = q + d*
//! ```
//!
//! Its derivative with respect to a parameter is a linear step,
//!
//! ```text
//! (I + B K) y' = y*' - B' p - B p_theta,    p' = K y' + p_theta,
//! ```
//!
//! with K the tangents and `p_theta` the derivative of the laws at fixed closure. Of contacts with
//! damping or friction, and of guides, the tractions take the place of the pressures; impulses and
//! sliders at earlier steps are carried along too. The steps of the case are repeated in scalars, with
//! the exact laws and their equations solved to rounding, so that no table and no unfinished
//! correction is differentiated.
//!
//! The derivatives of what a step is made of (coefficients, shapes, the load step by step, the
//! closures of the laws at fixed pressures) are fourth-order central differences of closed forms,
//! good to 1e-9 and better ([`difference`](crate::difference)); those of laws are tabulated over the pressures of the case
//! to 1e-10 of the largest, which is far cheaper than the laws at four places in each step. The step, the
//! number of steps, and the modes kept with their force interpolations do not vary.
//!
//! At loss of contact, and at a jump in the stiffness of a law, the map from one step to the next is
//! smooth only piece by piece: the derivative belongs to the piece that the case is on, without
//! the share of steps that would change sides. So an average of the stiffness of a law with a
//! stiffness at zero pressure lacks the change of the time open. Between stick and slip the motion is
//! continuous, and nothing is lacking.

mod contact_equations;
mod derivative_table;
mod extreme;
mod friction_element;
mod law_derivative;
mod motion;
mod step_inputs;

use std::sync::atomic::AtomicBool;

use super::assembly::MOST_INTERFACES;
use super::batch::Batch;
use super::load_steps::LoadSteps;
use super::prepared_case::PreparedCase;
use super::step_model::StepModel;
use super::transient_case::TransientCase;
use crate::DynamicsError;
use asperity_structure::PreloadedContact;
use contact_equations::{Contacts, RateHistory};
use extreme::Extreme;
use friction_element::FrictionDerivative;
use law_derivative::{LawDerivative, LawDerivatives};
use motion::Motion;
use step_inputs::Inputs;

/// A case with one parameter varied, at the places of [`STENCIL`](crate::STENCIL).
///
/// Contacts whose law does not depend on the parameter should share the law's pointer with
/// the case that is varied: the derivative of the law is then zero, and not computed.
#[derive(Debug, Clone)]
pub struct ParameterVariation {
    /// The varied cases; their durations and steps do not count.
    pub cases: [TransientCase; 4],
    /// The step between them, in the parameter's unit.
    pub step: f64,
}

/// A response step by step, or its derivative with respect to a parameter (then every unit is
/// over the parameter's).
#[derive(Debug, Clone, PartialEq)]
pub struct StepHistory {
    /// Force at steps 0 to the last \[N\].
    pub force: Vec<f64>,
    /// Displacement of the output at steps 0 to the last \[m\].
    pub displacement: Vec<f64>,
    /// Pressure at steps 0 to the last, per interface from the top down \[Pa\].
    pub pressure: Vec<Vec<f64>>,
    /// Measures of each interface.
    pub contacts: Vec<ContactMeasures>,
}

/// Measures of one interface over all steps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactMeasures {
    /// Lowest and highest pressure, refined between steps \[Pa\]; the lowest is zero, without
    /// derivative, once contact was lost.
    pub pressure_min: f64,
    /// Highest pressure \[Pa\].
    pub pressure_max: f64,
    /// Time average of the stiffness over the steps, zero counting while open \[Pa/m\].
    pub stiffness_average: f64,
    /// Stiffness of the law at the lowest pressure \[Pa/m\].
    pub stiffness_at_pressure_min: f64,
}

/// A case and its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Step \[s\].
    pub step: f64,
    /// The response.
    pub values: StepHistory,
    /// Its derivative with respect to each parameter.
    pub derivatives: Vec<StepHistory>,
}

impl Batch {
    /// The response to `case`, its laws solved to rounding, and its derivative with respect to the
    /// parameter of every one of `variations`.
    ///
    /// Memory is `8 (1 + interfaces) (1 + variations)` bytes a step.
    ///
    /// ```
    /// use asperity_dynamics::{Batch, ModalModel, ParameterVariation, STENCIL, TransientCase};
    /// use asperity_mesh::Port;
    /// use asperity_structure::{LoadCase, TimeFunction};
    /// # use std::sync::Arc;
    /// # use asperity_law::Constant;
    /// # use asperity_mesh::{Body, Interface, ModeCount, Stack, Support};
    /// # use asperity_structure::{Damping, PreloadedStructure};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
    /// # let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(4.25e11)?))?;
    /// # let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
    /// # let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035))?;
    /// let model = Arc::new(ModalModel::of_stack(&structure, &[3], Port::TOP, &[Port::TOP])?);
    /// let case = |peak: f64| TransientCase {
    ///     model: Arc::clone(&model),
    ///     load: LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, peak),
    ///     sensor: 0,
    ///     duration: 5e-3,
    ///     step: None,
    ///     tolerance: None,
    /// };
    /// let step = 0.02;
    /// let peaks = STENCIL.map(|place| case(20.0 + place * step));
    /// let found = Batch::default().sensitivity(&case(20.0), &[ParameterVariation { cases: peaks, step }])?;
    /// // The contact is linear, so the response is its derivative times the peak force.
    /// let (u, slope) = (found.values.displacement[200], found.derivatives[0].displacement[200]);
    /// assert!((slope - u / 20.0).abs() < 1e-8 * u.abs());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// A case at [steps of its own](Self#steps-of-their-own) is differentiated at equal steps, a sixteenth of
    /// its longest.
    ///
    /// # Errors
    /// As [`Modal::integrate`](super::Modal::integrate) for the case itself;
    /// [`DynamicsError::Variation`] when a varied case has not as many modes and interfaces, when
    /// its step is not positive and finite, or when the static pressure varies at an interface
    /// without stiffness at rest.
    pub fn sensitivity(
        &self,
        case: &TransientCase,
        variations: &[ParameterVariation],
    ) -> Result<Sensitivity, DynamicsError> {
        let case = &case.at_equal_steps()?;
        let (prepared, outcome) = self.whole(case, &AtomicBool::new(false))?;
        let parameters = variations
            .iter()
            .enumerate()
            .map(|(number, variation)| ParameterDerivative::new(number, &prepared, variation))
            .collect::<Result<Vec<_>, _>>()?;
        march(
            &prepared,
            &inputs_of(&prepared.tabulated.step_model, case, prepared.steps),
            &outcome.closure,
            parameters,
        )
    }
}

/// The inputs of `case` as stepped by `model`.
fn inputs_of(model: &StepModel, case: &TransientCase, steps: usize) -> Inputs {
    let pressure = case.model.contacts().iter().map(PreloadedContact::pressure);
    let amplitude = case.load.amplitude();
    let mut history = LoadSteps::new(&case.load, model.step, steps);
    history.scale(amplitude);
    Inputs::new((model, case.sensor), pressure.collect(), case.load.value(0.0), history)
}

/// The inputs' derivatives with respect to a parameter, and the state of the derivative.
#[derive(Debug)]
struct ParameterDerivative {
    derivatives: Inputs,
    laws: Vec<LawDerivative>,
    motion: Motion,
    closure: Vec<f64>,
    pressure: Vec<f64>,
    traction: Vec<f64>,
    /// Of the viscous impulses at earlier steps.
    past: Vec<RateHistory>,
    /// Of the friction elements.
    friction: Vec<Option<FrictionDerivative>>,
    /// Of the stiffness at the newest step.
    stiffness: Vec<f64>,
    history: StepHistory,
}

impl ParameterDerivative {
    fn new(
        number: usize,
        prepared: &PreparedCase,
        variation: &ParameterVariation,
    ) -> Result<Self, DynamicsError> {
        let refuse = |quantity, value, accepted| {
            Err(DynamicsError::Variation { parameter: number, quantity, value, accepted })
        };
        let step = variation.step;
        if !(step.is_finite() && step > 0.0) {
            return refuse("step of the variation", step, "positive and finite");
        }
        let base = prepared.model.contacts();
        let modes = prepared.model.structure().modes().len();
        for case in &variation.cases {
            for (quantity, found, expected) in [
                ("number of modes", case.model.structure().modes().len(), modes),
                ("number of interfaces", case.model.contacts().len(), base.len()),
                ("number of guides with friction", case.model.rows(), prepared.model.rows()),
            ] {
                if found != expected {
                    return refuse(quantity, found as f64, "as in the case that is varied");
                }
            }
            case.load.check()?;
        }
        let model = &prepared.tabulated.step_model;
        let inputs = variation.cases.each_ref().map(|case| {
            let rows = case.model.row_modes();
            let areas: Vec<f64> = (0..case.model.rows()).map(|i| case.model.area(i)).collect();
            let rate = case.model.preloaded().damping_rate();
            let kept = model.interpolations.clone();
            let varied = StepModel::with_interpolations(rows, &areas, rate, model.step, kept);
            inputs_of(&varied, case, prepared.steps)
        });
        let derivatives = Inputs::difference(&inputs, step);
        let mut laws = Vec::with_capacity(base.len());
        for (i, contact) in base.iter().enumerate() {
            let places = variation.cases.each_ref().map(|case| &case.model.contacts()[i]);
            let Some(law) = LawDerivative::new(contact, places, step, derivatives.pressure[i])
            else {
                let stiffness = contact.law().stiffness(contact.pressure());
                return refuse("stiffness at rest [Pa/m]", stiffness, "positive and finite");
            };
            laws.push(law);
        }
        let history = StepHistory::new(derivatives.loads(prepared.steps), &derivatives.pressure);
        let zero = || vec![0.0; prepared.model.rows()];
        let models = variation.cases.each_ref().map(|case| &*case.model);
        let friction = (0..prepared.model.rows())
            .map(|i| FrictionDerivative::of_row(models, i, step))
            .collect();
        let at_rest = base.iter().zip(&laws).map(|(contact, law)| {
            let pressure = contact.pressure();
            let slope = law.slope(pressure, law.pressure_derivative);
            if open_at(contact, 0.0) { 0.0 } else { slope + law.stiffness(pressure) }
        });
        Ok(Self {
            motion: Motion::at_rest(derivatives.modes.len()),
            closure: zero(),
            pressure: zero(),
            traction: zero(),
            past: vec![RateHistory::default(); base.len()],
            friction,
            stiffness: at_rest.collect(),
            derivatives,
            laws,
            history,
        })
    }
}

impl StepHistory {
    /// A history that starts at `pressure`, as long as `force`.
    fn new(force: Vec<f64>, pressure: &[f64]) -> Self {
        let column = |start: f64| {
            let mut column = Vec::with_capacity(force.len());
            column.push(start);
            column
        };
        Self {
            displacement: column(0.0),
            pressure: pressure.iter().map(|&start| column(start)).collect(),
            contacts: vec![ContactMeasures::default(); pressure.len()],
            force,
        }
    }
}

/// Marches the case from its `guesses` of closures, and all derivatives with it.
fn march(
    prepared: &PreparedCase,
    inputs: &Inputs,
    guesses: &[Vec<f64>],
    mut parameters: Vec<ParameterDerivative>,
) -> Result<Sensitivity, DynamicsError> {
    let contacts = prepared.model.contacts();
    let share = 1.0 / prepared.steps as f64;
    let mut motion = Motion::at_rest(inputs.modes.len());
    let mut found = Contacts::at_rest(&prepared.model, prepared.tabulated.step_model.step);
    let mut target = vec![0.0; prepared.model.rows()];
    let mut open = vec![false; contacts.len()];
    let at_rest = contacts.iter().map(|contact| {
        let stiffness = contact.law().stiffness(contact.pressure());
        if open_at(contact, 0.0) { 0.0 } else { stiffness }
    });
    let mut stiffness: Vec<f64> = at_rest.collect();
    let mut history = StepHistory::new(inputs.loads(prepared.steps), &inputs.pressure);
    for (i, (contact, guesses)) in contacts.iter().zip(guesses).enumerate() {
        let range = pressure_range(contact, guesses);
        for parameter in &mut parameters {
            parameter.laws[i].tabulate(range);
        }
    }
    for n in 0..prepared.steps {
        let load = inputs.load(n);
        motion.predict(inputs, &load, &mut target);
        for (closure, guess) in found.closure.iter_mut().zip(guesses) {
            *closure = guess.get(n + 1).copied().unwrap_or(*closure);
        }
        if !found.solve(contacts, &inputs.coupling, &target) {
            return Err(unstable(prepared, n, &found));
        }
        for parameter in &mut parameters {
            let ParameterDerivative { derivatives, motion: moved, closure, .. } = parameter;
            let loads = (&load, &derivatives.load(n));
            moved.predict_derivative((inputs, &*derivatives), loads, &motion, closure);
        }
        let output = motion.correct(inputs, &load, &found.traction);
        history.displacement.push(output);
        for (i, contact) in contacts.iter().enumerate() {
            open[i] = open_at(contact, found.pressure[i]);
            history.pressure[i].push(contact.pressure() + found.pressure[i]);
            history.contacts[i].stiffness_average += share * stiffness[i];
            stiffness[i] = found.tangent[i];
        }
        for parameter in &mut parameters {
            parameter.step(n, (inputs, &motion), &found, &open, share);
        }
        found.advance();
    }
    let extremes = finish(&mut history, prepared);
    let finished =
        parameters.into_iter().map(|parameter| parameter.finish(&history, prepared, &extremes));
    let derivatives = finished.collect();
    Ok(Sensitivity { step: prepared.tabulated.step_model.step, values: history, derivatives })
}

/// Lowest and highest pressure \[Pa\] of a contact whose closures since rest \[m\] are given.
fn pressure_range(contact: &PreloadedContact, closures: &[f64]) -> [f64; 2] {
    let low = closures.iter().copied().fold(0.0, f64::min);
    let high = closures.iter().copied().fold(0.0, f64::max);
    let (rest, law) = (contact.pressure(), contact.law());
    [low, high].map(|closure| rest + law.pressure_increment(rest, closure).value)
}

/// True if a contact is open once its pressure has risen by `increment` \[Pa\] from rest.
fn open_at(contact: &PreloadedContact, increment: f64) -> bool {
    contact.law().domain().separates() && increment <= -contact.pressure()
}

fn unstable(prepared: &PreparedCase, n: usize, found: &Contacts) -> DynamicsError {
    let contacts = prepared.model.contacts();
    let named = contacts.iter().zip(&found.pressure);
    let lost = named.clone().find(|(_, p)| !p.is_finite()).or_else(|| named.clone().next());
    DynamicsError::Unstable {
        time_s: (n + 1) as f64 * prepared.tabulated.step_model.step,
        interface: lost.map_or_else(String::new, |(contact, _)| contact.name().to_owned()),
    }
}

impl ParameterDerivative {
    /// Takes step `n` after the case has taken it; `closure` holds the predicted closures.
    fn step(
        &mut self,
        n: usize,
        (inputs, motion): (&Inputs, &Motion),
        found: &Contacts,
        open: &[bool],
        share: f64,
    ) {
        let (count, rows) = (self.laws.len(), self.closure.len());
        let mut answers = [LawDerivatives::default(); MOST_INTERFACES];
        for (i, (answer, law)) in answers.iter_mut().zip(&mut self.laws).enumerate() {
            *answer = law.at(found.pressure[i], found.tangent[i], open[i]);
        }
        let answers = &answers[..count];
        // Of the normal tractions and of friction, at fixed closure.
        let mut normal = [0.0; MOST_INTERFACES];
        for (i, answer) in answers.iter().enumerate() {
            normal[i] = if !self.laws[i].is_damped() {
                answer.pressure
            } else if found.normal_tangent[i] == 0.0 {
                -self.laws[i].pressure_derivative
            } else {
                answer.pressure + found.rate() * answer.impulse + self.past[i].share(found.step)
            };
        }
        let mut friction = [0.0; MOST_INTERFACES];
        for (i, (own, base)) in self.friction.iter().zip(&found.friction).enumerate() {
            if let (Some(own), Some(base)) = (own, base) {
                let rest = self.laws[base.contact].pressure_derivative;
                friction[i] = own.at_fixed_closure(base, found.closure[i], rest);
            }
        }
        for i in 0..rows {
            for (j, (normal, friction)) in normal.iter().zip(&friction).take(rows).enumerate() {
                self.closure[i] -= self.derivatives.coupling[i][j] * found.traction[j]
                    + inputs.coupling[i][j] * (normal + friction);
            }
        }
        found.factors.solve(&mut self.closure);
        for (i, answer) in answers.iter().enumerate() {
            self.pressure[i] = found.tangent[i] * self.closure[i] + answer.pressure;
            normal[i] += found.normal_tangent[i] * self.closure[i];
            self.past[i].push(found.coefficient[i] * self.closure[i] + answer.impulse);
            let derivative = self.laws[i].pressure_derivative + self.pressure[i];
            self.history.pressure[i].push(derivative);
            self.history.contacts[i].stiffness_average += share * self.stiffness[i];
            let slope = self.laws[i].slope(inputs.pressure[i] + found.pressure[i], derivative);
            self.stiffness[i] = if open[i] { 0.0 } else { slope + answer.stiffness };
        }
        for i in 0..rows {
            let tangent = found.traction_tangent[i] - found.normal_tangent[i];
            friction[i] += tangent * self.closure[i];
            self.traction[i] = normal[i] + friction[i];
            if let (Some(own), Some(base)) = (&mut self.friction[i], &found.friction[i]) {
                let moved = (self.closure[i], friction[i], normal[base.contact]);
                own.advance(base, found.closure[i], moved);
            }
        }
        let loads = (&inputs.load(n), &self.derivatives.load(n));
        let tractions = (found.traction.as_slice(), self.traction.as_slice());
        let output =
            self.motion.correct_derivative((inputs, &self.derivatives), loads, motion, tractions);
        self.history.displacement.push(output);
    }

    fn finish(
        mut self,
        base: &StepHistory,
        prepared: &PreparedCase,
        extremes: &[[Extreme; 2]],
    ) -> StepHistory {
        for (i, [lowest, highest]) in extremes.iter().enumerate() {
            let measures = &mut self.history.contacts[i];
            let column = &self.history.pressure[i];
            measures.pressure_max = highest.derivative(column);
            let separates = prepared.model.contacts()[i].law().domain().separates();
            let minimum = base.contacts[i].pressure_min;
            if !(separates && minimum <= 0.0) {
                measures.pressure_min = lowest.derivative(column);
            }
            let law = &self.laws[i];
            measures.stiffness_at_pressure_min =
                law.stiffness(minimum) + law.slope(minimum, measures.pressure_min);
        }
        self.history
    }
}

/// Fills in the extremes of a case.
fn finish(history: &mut StepHistory, prepared: &PreparedCase) -> Vec<[Extreme; 2]> {
    let mut all = Vec::with_capacity(history.pressure.len());
    for (i, contact) in prepared.model.contacts().iter().enumerate() {
        let column = &history.pressure[i];
        let (Some(lowest), Some(highest)) =
            (Extreme::lowest(column, 1.0), Extreme::lowest(column, -1.0))
        else {
            continue;
        };
        let measures = &mut history.contacts[i];
        let separates = contact.law().domain().separates();
        measures.pressure_min = if separates { lowest.value.max(0.0) } else { lowest.value };
        measures.pressure_max = highest.value;
        measures.stiffness_at_pressure_min = contact.law().stiffness(measures.pressure_min);
        all.push([lowest, highest]);
    }
    all
}
