//! The contact equations of one step, solved to rounding with the exact laws.
//!
//! The traction of a damped contact at the end of a step of length h is a function of the closure,
//!
//! ```text
//! t = q(x) + a_0 R(x) / h + sum of a_k R_before_k / h,    R = integral of c dx from rest,
//! ```
//!
//! not below `-p0` where the law separates. The traction of an undamped contact is the pressure q.
//! Friction adds the traction of its element; a guide has no other traction.

use super::friction_element::FrictionElement;
use crate::modal::assembly::ModalModel;
use crate::modal::damped_table::{PAST, RATE};
use crate::modal::increasing_root::increasing_root;
use crate::modal::linear_system::Factors;
use asperity_law::Pressure;
use asperity_structure::PreloadedContact;

/// Newton corrections before the interfaces are solved one by one.
const NEWTON: usize = 24;

/// Sweeps over the interfaces.
const SWEEPS: usize = 2000;

/// Newton correction, over the largest closure so far, after which the tangent is not evaluated
/// again: its relative error is of this size.
const LAST_CORRECTION: f64 = 1e-12;

/// Closure increments \[m\], pressure and traction increments \[Pa\] and tangents \[Pa/m\] of a step, of the
/// contacts and behind them of guides.
#[derive(Debug, Clone)]
pub(super) struct Contacts {
    pub(super) closure: Vec<f64>,
    pub(super) pressure: Vec<f64>,
    pub(super) tangent: Vec<f64>,
    /// Normal tractions and their tangents: without damping, pressures and tangents of the law; zero
    /// tangents where faces carry nothing.
    pub(super) normal: Vec<f64>,
    pub(super) normal_tangent: Vec<f64>,
    /// Tractions and their tangents, with friction.
    pub(super) traction: Vec<f64>,
    pub(super) traction_tangent: Vec<f64>,
    /// Friction elements of the rows that have one.
    pub(super) friction: Vec<Option<FrictionElement>>,
    /// Viscous impulses since rest \[Pa s\] and the coefficients c, their tangents \[Pa s/m\].
    impulse: Vec<f64>,
    pub(super) coefficient: Vec<f64>,
    past: Vec<RateHistory>,
    /// Length of a step \[s\].
    pub(super) step: f64,
    /// `I + B T` at the closures, T the tangents of the tractions.
    pub(super) factors: Factors,
    correction: Vec<f64>,
    /// Largest closure so far \[m\].
    scale: f64,
}

impl Contacts {
    /// The rows of a model at rest before steps of `step` \[s\].
    pub(super) fn at_rest(model: &ModalModel, step: f64) -> Self {
        let rows = model.rows();
        let zero = || vec![0.0; rows];
        Self {
            closure: zero(),
            pressure: zero(),
            tangent: zero(),
            normal: zero(),
            normal_tangent: zero(),
            traction: zero(),
            traction_tangent: zero(),
            friction: (0..rows).map(|row| FrictionElement::of_row(model, row)).collect(),
            impulse: zero(),
            coefficient: zero(),
            past: vec![RateHistory::default(); rows],
            step,
            factors: Factors::new(rows),
            correction: zero(),
            scale: 0.0,
        }
    }

    /// Solves `y + B t(y) = y*`; `closure` holds a guess before. Whether numbers stay finite.
    pub(super) fn solve(
        &mut self,
        contacts: &[PreloadedContact],
        coupling: &[Vec<f64>],
        target: &[f64],
    ) -> bool {
        let size = target.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        if !size.is_finite() {
            return false;
        }
        self.scale = self.scale.max(size);
        self.predict_limits(contacts);
        let mut converged = false;
        for _ in 0..NEWTON {
            let largest = self.correct(contacts, coupling, target);
            for (i, correction) in self.correction.iter().enumerate() {
                self.closure[i] += correction;
                self.pressure[i] += self.tangent[i] * correction;
                self.normal[i] += self.normal_tangent[i] * correction;
                self.traction[i] += self.traction_tangent[i] * correction;
                self.impulse[i] += self.coefficient[i] * correction;
            }
            if largest <= LAST_CORRECTION * self.scale {
                converged = true;
                break;
            }
        }
        if !converged {
            self.solve_fallback(contacts, coupling, target);
        }
        let all = [&self.pressure, &self.tangent, &self.traction, &self.traction_tangent];
        all.into_iter().flatten().all(|value| value.is_finite())
    }

    /// Weight of an impulse in the rate at the end of its step \[1/s\].
    pub(super) fn rate(&self) -> f64 {
        RATE[0] / self.step
    }

    /// Keeps impulses and friction of a step that is solved for the steps to come.
    pub(super) fn advance(&mut self) {
        for (past, impulse) in self.past.iter_mut().zip(&self.impulse) {
            past.push(*impulse);
        }
        for (i, element) in self.friction.iter_mut().enumerate() {
            let Some(element) = element else { continue };
            element.advance(self.closure[i], self.normal[element.contact]);
        }
    }

    /// The slip limits of the next step, from the normal tractions of the steps before.
    fn predict_limits(&mut self, contacts: &[PreloadedContact]) {
        for element in self.friction.iter_mut().flatten() {
            element.predict_limit(contacts[element.contact].pressure());
        }
    }

    /// The Newton correction at the closures; its largest part.
    fn correct(
        &mut self,
        contacts: &[PreloadedContact],
        coupling: &[Vec<f64>],
        target: &[f64],
    ) -> f64 {
        self.evaluate(contacts);
        self.factors.factor(coupling, &self.traction_tangent);
        for (i, row) in coupling.iter().enumerate() {
            let lost: f64 = row.iter().zip(&self.traction).map(|(b, p)| b * p).sum();
            self.correction[i] = target[i] - self.closure[i] - lost;
        }
        self.factors.solve(&mut self.correction);
        // A correction that is not a number must not count as none.
        let larger = |most: f64, c: &f64| if c.is_nan() { f64::NAN } else { most.max(c.abs()) };
        self.correction.iter().fold(0.0, larger)
    }

    fn evaluate(&mut self, contacts: &[PreloadedContact]) {
        for i in 0..self.closure.len() {
            self.evaluate_one(i, contacts);
        }
    }

    /// Row `i` at a closure \[m\].
    fn at(&self, i: usize, contacts: &[PreloadedContact], closure: f64) -> Evaluation {
        let normal = match contacts.get(i) {
            Some(contact) => Evaluation::new(contact, closure, &self.past[i], self.step),
            None => Evaluation::of_guide(),
        };
        normal.with_friction(self.friction[i].as_ref(), closure)
    }

    fn evaluate_one(&mut self, i: usize, contacts: &[PreloadedContact]) {
        let found = self.at(i, contacts, self.closure[i]);
        (self.pressure[i], self.tangent[i]) = (found.law.value, found.law.tangent);
        (self.normal[i], self.normal_tangent[i]) = (found.normal.value, found.normal.tangent);
        (self.traction[i], self.traction_tangent[i]) =
            (found.traction.value, found.traction.tangent);
        (self.impulse[i], self.coefficient[i]) = (found.impulse.value, found.impulse.tangent);
    }

    /// Interface by interface, each by halving a bracket: slowly down the convex energy whose
    /// minimum the equations state.
    #[cold]
    fn solve_fallback(
        &mut self,
        contacts: &[PreloadedContact],
        coupling: &[Vec<f64>],
        target: &[f64],
    ) {
        self.closure.copy_from_slice(target);
        self.evaluate(contacts);
        for _ in 0..SWEEPS {
            let mut moved = 0.0_f64;
            for i in 0..target.len() {
                let others = (0..target.len()).filter(|&j| j != i);
                let lost: f64 = others.map(|j| coupling[i][j] * self.traction[j]).sum();
                let own = coupling[i][i];
                let traction = |y: f64| self.at(i, contacts, y).traction.value;
                let lost = |y: f64| y + own * traction(y) - target[i] + lost;
                let scale = self.scale.max(f64::MIN_POSITIVE);
                let reached = increasing_root(lost, target[i], scale);
                moved = moved.max((reached - self.closure[i]).abs());
                self.closure[i] = reached;
                self.evaluate_one(i, contacts);
            }
            if moved <= f64::EPSILON * self.scale {
                break;
            }
        }
        self.factors.factor(coupling, &self.traction_tangent);
    }
}

/// Values at earlier steps, newest first.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct RateHistory([f64; PAST]);

impl RateHistory {
    /// Share of the earlier values in the rate at the end of the next step of `step` \[s\].
    pub(super) fn share(&self, step: f64) -> f64 {
        RATE[1..].iter().zip(&self.0).map(|(weight, value)| weight / step * value).sum()
    }

    pub(super) fn push(&mut self, value: f64) {
        self.0.copy_within(..PAST - 1, 1);
        self.0[0] = value;
    }
}

/// One row at a closure: law, viscous impulse, normal traction and traction, with their tangents.
struct Evaluation {
    law: Pressure,
    impulse: Pressure,
    normal: Pressure,
    traction: Pressure,
}

const NOTHING: Pressure = Pressure { value: 0.0, tangent: 0.0 };

impl Evaluation {
    fn new(contact: &PreloadedContact, closure: f64, past: &RateHistory, step: f64) -> Self {
        let (rest, law) = (contact.pressure(), contact.law());
        let at = law.pressure_increment(rest, closure);
        let Some(damping) = contact.damping() else {
            return Self { law: at, impulse: NOTHING, normal: at, traction: at };
        };
        let pressure = rest + at.value;
        let impulse = Pressure {
            value: damping.impulse(&**law, rest, pressure),
            tangent: damping.coefficient(pressure, at.tangent),
        };
        let rate = RATE[0] / step;
        let value = at.value + rate * impulse.value + past.share(step);
        let normal = if law.domain().separates() && value <= -rest {
            Pressure { value: -rest, tangent: 0.0 }
        } else {
            Pressure { value, tangent: at.tangent + rate * impulse.tangent }
        };
        Self { law: at, impulse, normal, traction: normal }
    }

    /// A guide without its friction.
    fn of_guide() -> Self {
        Self { law: NOTHING, impulse: NOTHING, normal: NOTHING, traction: NOTHING }
    }

    /// The row with its friction element.
    fn with_friction(mut self, element: Option<&FrictionElement>, closure: f64) -> Self {
        if let Some(element) = element {
            let friction = element.traction(closure);
            self.traction.value += friction.value;
            self.traction.tangent += friction.tangent;
        }
        self
    }
}
