//! Derivatives of a hit with respect to what it depends on, exact through the step.
//!
//! A step of the modal integrator is
//!
//! ```text
//! y* = sum of g q* + residual drive,   y + B p(y) = y*,
//! d = d* - t0 F(p),  q = q* - t0 F,    d* = e d - k q + carried forces + drive,  q* = q + d*
//! ```
//!
//! Differentiated with respect to a parameter, it is linear in what it carries along,
//!
//! ```text
//! (I + B K) y' = y*' - B' p - B p_theta,    p' = K y' + p_theta,
//! ```
//!
//! with K the tangents and `p_theta` the derivative of the laws at fixed closure. The steps are
//! marched once more for it, one hit and in scalars, with the exact laws and their equations
//! solved to rounding, so that no table and no unfinished correction is differentiated.
//!
//! The derivatives of what a step is made of (coefficients, shapes, the course of the drive, the
//! closures of the laws at fixed pressures) are fourth-order central differences of closed forms,
//! good to 1e-9 and better ([`difference`](crate::difference)). The step and its number, and
//! which modes are kept in which course, are those of the hit throughout.
//!
//! Where contact is lost, or a law has a jump in stiffness, the map from one step to the next is
//! smooth only piece by piece: the derivative is that of the piece that the hit is on, without
//! the share of steps that would change sides. So an average of the stiffness of a law with a
//! stiffness at zero pressure lacks the change of the time open.

mod contact;
mod elimination;
mod extreme;
mod inputs;
mod law_rate;
mod motion;

use super::drive::DriveCourse;
use super::lane::Lane;
use super::model::StepModel;
use super::{Batch, Hit};
use crate::DynamicsError;
use asperity_structure::PreloadedContact;
use contact::Contacts;
use extreme::Extreme;
use inputs::Inputs;
use law_rate::LawRate;
use motion::Motion;

/// A hit with one parameter varied, at the places of [`STENCIL`](crate::STENCIL).
///
/// Contacts whose law does not depend on the parameter had better share the law's pointer with
/// the hit that is varied: its derivative is known then, and not computed.
#[derive(Debug, Clone)]
pub struct Variation {
    /// The varied hits; their durations and steps do not count.
    pub hits: [Hit; 4],
    /// The step between them, in the parameter's unit.
    pub step: f64,
}

/// A response step by step, or its derivative with respect to a parameter (then every unit is
/// over the parameter's).
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Force at steps 0 to the last \[N\].
    pub force: Vec<f64>,
    /// Displacement of the output at steps 0 to the last \[m\].
    pub displacement: Vec<f64>,
    /// Pressure at steps 0 to the last, per interface from the top down \[Pa\].
    pub pressure: Vec<Vec<f64>>,
    /// What the summary of each interface says.
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

/// A hit and its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Step \[s\].
    pub step: f64,
    /// The response.
    pub values: Course,
    /// Its derivative with respect to each parameter.
    pub rates: Vec<Course>,
}

impl Batch {
    /// The response to `hit`, its laws solved to rounding, and its derivative with respect to the
    /// parameter of every one of `variations`.
    ///
    /// Memory is `8 (1 + interfaces) (1 + variations)` bytes a step.
    ///
    /// # Errors
    /// As [`Modal::integrate`](super::Modal::integrate) for the hit itself;
    /// [`DynamicsError::Variation`] when a varied hit has not as many modes and interfaces, when
    /// its step is not positive and finite, or when the static pressure varies at an interface
    /// without stiffness at rest.
    pub fn sensitivity(
        &self,
        hit: &Hit,
        variations: &[Variation],
    ) -> Result<Sensitivity, DynamicsError> {
        let (lane, outcome) = self.whole(hit)?;
        let tangents = variations
            .iter()
            .enumerate()
            .map(|(number, variation)| Tangent::new(number, &lane, variation))
            .collect::<Result<Vec<_>, _>>()?;
        march(&lane, &inputs_of(&lane.prepared.model, hit, lane.steps), &outcome.closure, tangents)
    }
}

/// The inputs of `hit` as stepped by `model`.
fn inputs_of(model: &StepModel, hit: &Hit, steps: usize) -> Inputs {
    let pressure = hit.rig.contacts().iter().map(PreloadedContact::pressure);
    let course = DriveCourse::new(&hit.excitation, model.step, steps);
    Inputs::new(model, pressure.collect(), hit.excitation.force(0.0), course)
}

/// What a parameter changes, and the state of the derivative with respect to it.
#[derive(Debug)]
struct Tangent {
    rates: Inputs,
    laws: Vec<LawRate>,
    motion: Motion,
    closure: Vec<f64>,
    pressure: Vec<f64>,
    /// Of the stiffness at the newest step.
    stiffness: Vec<f64>,
    course: Course,
}

impl Tangent {
    fn new(number: usize, lane: &Lane, variation: &Variation) -> Result<Self, DynamicsError> {
        let refuse = |quantity, value, accepted| {
            Err(DynamicsError::Variation { parameter: number, quantity, value, accepted })
        };
        let step = variation.step;
        if !(step.is_finite() && step > 0.0) {
            return refuse("step of the variation", step, "positive and finite");
        }
        let base = lane.rig.contacts();
        let modes = lane.rig.structure().modes().len();
        for hit in &variation.hits {
            let (found, interfaces) = (hit.rig.structure().modes().len(), hit.rig.contacts().len());
            if found != modes {
                return refuse("number of modes", found as f64, "that of the hit that is varied");
            }
            if interfaces != base.len() {
                let accepted = "that of the hit that is varied";
                return refuse("number of interfaces", interfaces as f64, accepted);
            }
            hit.excitation.check()?;
        }
        let model = &lane.prepared.model;
        let inputs = variation.hits.each_ref().map(|hit| {
            let areas: Vec<f64> = hit.rig.contacts().iter().map(PreloadedContact::area).collect();
            let (structure, courses) = (hit.rig.structure(), model.courses.clone());
            let varied =
                StepModel::with_courses(structure, &areas, hit.rig.rate(), model.step, courses);
            inputs_of(&varied, hit, lane.steps)
        });
        let rates = Inputs::difference(&inputs, step);
        let mut laws = Vec::with_capacity(base.len());
        for (i, contact) in base.iter().enumerate() {
            let places = variation.hits.each_ref().map(|hit| &hit.rig.contacts()[i]);
            let Some(law) = LawRate::new(contact, places, step, rates.pressure[i]) else {
                let stiffness = contact.law().stiffness(contact.pressure());
                return refuse("stiffness at rest [Pa/m]", stiffness, "positive and finite");
            };
            laws.push(law);
        }
        let course = Course::new(rates.force(lane.steps), &rates.pressure);
        let zero = || vec![0.0; base.len()];
        let at_rest = base.iter().zip(&laws).map(|(contact, law)| {
            let pressure = contact.pressure();
            let slope = law.slope(pressure, law.pressure_rate);
            if open_at(contact, 0.0) { 0.0 } else { slope + law.stiffness(pressure) }
        });
        Ok(Self {
            motion: Motion::at_rest(rates.modes.len()),
            closure: zero(),
            pressure: zero(),
            stiffness: at_rest.collect(),
            rates,
            laws,
            course,
        })
    }
}

impl Course {
    /// A course that starts at `pressure`, as long as `force`.
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

/// Marches the hit from its `guesses` of closures, and all derivatives with it.
fn march(
    lane: &Lane,
    inputs: &Inputs,
    guesses: &[Vec<f64>],
    mut tangents: Vec<Tangent>,
) -> Result<Sensitivity, DynamicsError> {
    let contacts = lane.rig.contacts();
    let share = 1.0 / lane.steps as f64;
    let mut motion = Motion::at_rest(inputs.modes.len());
    let mut found = Contacts::at_rest(contacts.len());
    let mut target = vec![0.0; contacts.len()];
    let mut open = vec![false; contacts.len()];
    let at_rest = contacts.iter().map(|contact| {
        let stiffness = contact.law().stiffness(contact.pressure());
        if open_at(contact, 0.0) { 0.0 } else { stiffness }
    });
    let mut stiffness: Vec<f64> = at_rest.collect();
    let mut course = Course::new(inputs.force(lane.steps), &inputs.pressure);
    for n in 0..lane.steps {
        let drive = inputs.drive(n);
        motion.reach(inputs, &drive, &mut target);
        for (closure, guess) in found.closure.iter_mut().zip(guesses) {
            *closure = guess.get(n + 1).copied().unwrap_or(*closure);
        }
        if !found.solve(contacts, &inputs.coupling, &target) {
            return Err(unstable(lane, n, &found));
        }
        for tangent in &mut tangents {
            let Tangent { rates, motion: moved, closure, .. } = tangent;
            let drives = (&drive, &rates.drive(n));
            moved.reach_tangent((inputs, &*rates), drives, &motion, closure);
        }
        let output = motion.settle(inputs, &drive, &found.pressure);
        course.displacement.push(output);
        for (i, contact) in contacts.iter().enumerate() {
            open[i] = open_at(contact, found.pressure[i]);
            course.pressure[i].push(contact.pressure() + found.pressure[i]);
            course.contacts[i].stiffness_average += share * stiffness[i];
            stiffness[i] = found.tangent[i];
        }
        for tangent in &mut tangents {
            tangent.step(n, (inputs, &motion), &found, &open, share);
        }
    }
    let extremes = finish(&mut course, lane);
    let finished = tangents.into_iter().map(|tangent| tangent.finish(&course, lane, &extremes));
    let rates = finished.collect();
    Ok(Sensitivity { step: lane.prepared.model.step, values: course, rates })
}

/// True for a contact that is open once its pressure has risen by `gained` \[Pa\] from rest.
fn open_at(contact: &PreloadedContact, gained: f64) -> bool {
    contact.law().domain().separates() && gained <= -contact.pressure()
}

fn unstable(lane: &Lane, n: usize, found: &Contacts) -> DynamicsError {
    let lost = found.pressure.iter().position(|p| !p.is_finite()).unwrap_or(0);
    DynamicsError::Unstable {
        time_s: (n + 1) as f64 * lane.prepared.model.step,
        interface: lane.rig.contacts()[lost].name().to_owned(),
    }
}

impl Tangent {
    /// Takes step `n` after the hit has taken it; `closure` holds what the step would reach.
    fn step(
        &mut self,
        n: usize,
        (inputs, motion): (&Inputs, &Motion),
        found: &Contacts,
        open: &[bool],
        share: f64,
    ) {
        let count = self.laws.len();
        let mut answers = [law_rate::Rates::default(); super::block::MOST_INTERFACES];
        for (i, (answer, law)) in answers.iter_mut().zip(&self.laws).enumerate() {
            *answer = law.at(found.pressure[i], found.tangent[i], open[i]);
        }
        let answers = &answers[..count];
        for i in 0..count {
            for (j, answer) in answers.iter().enumerate() {
                self.closure[i] -= self.rates.coupling[i][j] * found.pressure[j]
                    + inputs.coupling[i][j] * answer.pressure;
            }
        }
        found.factors.solve(&mut self.closure);
        for (i, answer) in answers.iter().enumerate() {
            self.pressure[i] = found.tangent[i] * self.closure[i] + answer.pressure;
            let rate = self.laws[i].pressure_rate + self.pressure[i];
            self.course.pressure[i].push(rate);
            self.course.contacts[i].stiffness_average += share * self.stiffness[i];
            let slope = self.laws[i].slope(inputs.pressure[i] + found.pressure[i], rate);
            self.stiffness[i] = if open[i] { 0.0 } else { slope + answer.stiffness };
        }
        let drives = (&inputs.drive(n), &self.rates.drive(n));
        let pressures = (found.pressure.as_slice(), self.pressure.as_slice());
        let output = self.motion.settle_tangent((inputs, &self.rates), drives, motion, pressures);
        self.course.displacement.push(output);
    }

    fn finish(mut self, base: &Course, lane: &Lane, extremes: &[[Extreme; 2]]) -> Course {
        for (i, [lowest, highest]) in extremes.iter().enumerate() {
            let measures = &mut self.course.contacts[i];
            let column = &self.course.pressure[i];
            measures.pressure_max = highest.rate(column);
            let separates = lane.rig.contacts()[i].law().domain().separates();
            let minimum = base.contacts[i].pressure_min;
            if !(separates && minimum <= 0.0) {
                measures.pressure_min = lowest.rate(column);
            }
            let law = &self.laws[i];
            measures.stiffness_at_pressure_min =
                law.stiffness(minimum) + law.slope(minimum, measures.pressure_min);
        }
        self.course
    }
}

/// Fills in the extremes of a hit.
fn finish(course: &mut Course, lane: &Lane) -> Vec<[Extreme; 2]> {
    let mut all = Vec::with_capacity(course.pressure.len());
    for (i, contact) in lane.rig.contacts().iter().enumerate() {
        let column = &course.pressure[i];
        let (Some(lowest), Some(highest)) =
            (Extreme::lowest(column, 1.0), Extreme::lowest(column, -1.0))
        else {
            continue;
        };
        let measures = &mut course.contacts[i];
        let separates = contact.law().domain().separates();
        measures.pressure_min = if separates { lowest.value.max(0.0) } else { lowest.value };
        measures.pressure_max = highest.value;
        measures.stiffness_at_pressure_min = contact.law().stiffness(measures.pressure_min);
        all.push([lowest, highest]);
    }
    all
}
