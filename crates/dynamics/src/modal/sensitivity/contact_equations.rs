//! The contact equations of one step, solved to rounding with the exact laws.
//!
//! The traction of a damped contact at the end of a step of length h is a function of the closure,
//!
//! ```text
//! t = q(x) + a_0 R(x) / h + sum of a_k R_before_k / h,    R = integral of c dx from rest,
//! ```
//!
//! not below `-p0` where the law separates; that of another is the pressure q.

use super::linear_system::Factors;
use crate::modal::damped_table::RATE;
use crate::modal::increasing_root::increasing_root;
use crate::modal::simd::block::PAST;
use asperity_law::Pressure;
use asperity_structure::PreloadedContact;

/// Newton corrections before the interfaces are solved one by one.
const NEWTON: usize = 24;

/// Sweeps over the interfaces.
const SWEEPS: usize = 2000;

/// Newton correction, over the largest closure so far, after which the tangent is not evaluated
/// again: its relative error is of this size.
const LAST_CORRECTION: f64 = 1e-12;

/// Closure increments \[m\], pressure and traction increments \[Pa\] and tangents \[Pa/m\] of a step.
#[derive(Debug, Clone)]
pub(super) struct Contacts {
    pub(super) closure: Vec<f64>,
    pub(super) pressure: Vec<f64>,
    pub(super) tangent: Vec<f64>,
    /// Tractions and their tangents: those of the law without damping, zero tangents where faces carry
    /// nothing.
    pub(super) traction: Vec<f64>,
    pub(super) traction_tangent: Vec<f64>,
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
    /// Contacts at rest before steps of `step` \[s\].
    pub(super) fn at_rest(interfaces: usize, step: f64) -> Self {
        let zero = || vec![0.0; interfaces];
        Self {
            closure: zero(),
            pressure: zero(),
            tangent: zero(),
            traction: zero(),
            traction_tangent: zero(),
            impulse: zero(),
            coefficient: zero(),
            past: vec![RateHistory::default(); interfaces],
            step,
            factors: Factors::new(interfaces),
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
        let mut converged = false;
        for _ in 0..NEWTON {
            let largest = self.correct(contacts, coupling, target);
            for (i, correction) in self.correction.iter().enumerate() {
                self.closure[i] += correction;
                self.pressure[i] += self.tangent[i] * correction;
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

    /// Keeps the impulses of a step that is solved for the steps to come.
    pub(super) fn advance(&mut self) {
        for (past, impulse) in self.past.iter_mut().zip(&self.impulse) {
            past.push(*impulse);
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
        for (i, contact) in contacts.iter().enumerate() {
            self.evaluate_one(i, contact);
        }
    }

    fn evaluate_one(&mut self, i: usize, contact: &PreloadedContact) {
        let found = Evaluation::new(contact, self.closure[i], &self.past[i], self.step);
        (self.pressure[i], self.tangent[i]) = (found.law.value, found.law.tangent);
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
            for (i, contact) in contacts.iter().enumerate() {
                let others = (0..target.len()).filter(|&j| j != i);
                let lost: f64 = others.map(|j| coupling[i][j] * self.traction[j]).sum();
                let own = coupling[i][i];
                let traction =
                    |y: f64| Evaluation::new(contact, y, &self.past[i], self.step).traction.value;
                let lost = |y: f64| y + own * traction(y) - target[i] + lost;
                let scale = self.scale.max(f64::MIN_POSITIVE);
                let reached = increasing_root(lost, target[i], scale);
                moved = moved.max((reached - self.closure[i]).abs());
                self.closure[i] = reached;
                self.evaluate_one(i, contact);
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

/// One contact at a closure: law, viscous impulse and traction, with their tangents.
struct Evaluation {
    law: Pressure,
    impulse: Pressure,
    traction: Pressure,
}

impl Evaluation {
    fn new(contact: &PreloadedContact, closure: f64, past: &RateHistory, step: f64) -> Self {
        let (rest, law) = (contact.pressure(), contact.law());
        let at = law.pressure_increment(rest, closure);
        let Some(damping) = contact.damping() else {
            return Self { law: at, impulse: Pressure { value: 0.0, tangent: 0.0 }, traction: at };
        };
        let pressure = rest + at.value;
        let impulse = Pressure {
            value: damping.impulse(&**law, rest, pressure),
            tangent: damping.coefficient(pressure, at.tangent),
        };
        let rate = RATE[0] / step;
        let value = at.value + rate * impulse.value + past.share(step);
        let traction = if law.domain().separates() && value <= -rest {
            Pressure { value: -rest, tangent: 0.0 }
        } else {
            Pressure { value, tangent: at.tangent + rate * impulse.tangent }
        };
        Self { law: at, impulse, traction }
    }
}
