//! The contact equations of one step, solved to rounding with the exact laws.

use super::linear_system::Factors;
use crate::modal::increasing_root::increasing_root;
use asperity_structure::PreloadedContact;

/// Newton corrections before the interfaces are solved one by one.
const NEWTON: usize = 24;

/// Sweeps over the interfaces.
const SWEEPS: usize = 2000;

/// Newton correction, over the largest closure so far, after which the tangent is not evaluated
/// again: its relative error is of this size.
const LAST_CORRECTION: f64 = 1e-12;

/// Closure increments \[m\], pressure increments \[Pa\] and tangents \[Pa/m\] of a step.
#[derive(Debug, Clone)]
pub(super) struct Contacts {
    pub(super) closure: Vec<f64>,
    pub(super) pressure: Vec<f64>,
    pub(super) tangent: Vec<f64>,
    /// `I + B K` at the closures.
    pub(super) factors: Factors,
    correction: Vec<f64>,
    /// Largest closure so far \[m\].
    scale: f64,
}

impl Contacts {
    pub(super) fn at_rest(interfaces: usize) -> Self {
        let zero = || vec![0.0; interfaces];
        Self {
            closure: zero(),
            pressure: zero(),
            tangent: zero(),
            factors: Factors::new(interfaces),
            correction: zero(),
            scale: 0.0,
        }
    }

    /// Solves `y + B p(y) = y*`; `closure` holds a guess before. Whether numbers stay finite.
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
            }
            if largest <= LAST_CORRECTION * self.scale {
                converged = true;
                break;
            }
        }
        if !converged {
            self.solve_fallback(contacts, coupling, target);
        }
        self.pressure.iter().chain(&self.tangent).all(|value| value.is_finite())
    }

    /// The Newton correction at the closures; its largest part.
    fn correct(
        &mut self,
        contacts: &[PreloadedContact],
        coupling: &[Vec<f64>],
        target: &[f64],
    ) -> f64 {
        self.evaluate(contacts);
        self.factors.factor(coupling, &self.tangent);
        for (i, row) in coupling.iter().enumerate() {
            let lost: f64 = row.iter().zip(&self.pressure).map(|(b, p)| b * p).sum();
            self.correction[i] = target[i] - self.closure[i] - lost;
        }
        self.factors.solve(&mut self.correction);
        // A correction that is not a number must not count as none.
        let larger = |most: f64, c: &f64| if c.is_nan() { f64::NAN } else { most.max(c.abs()) };
        self.correction.iter().fold(0.0, larger)
    }

    fn evaluate(&mut self, contacts: &[PreloadedContact]) {
        for (i, contact) in contacts.iter().enumerate() {
            let at = contact.law().pressure_increment(contact.pressure(), self.closure[i]);
            (self.pressure[i], self.tangent[i]) = (at.value, at.tangent);
        }
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
                let lost: f64 = others.map(|j| coupling[i][j] * self.pressure[j]).sum();
                let own = coupling[i][i];
                let reached = closure(contact, own, target[i] - lost, self.scale);
                moved = moved.max((reached - self.closure[i]).abs());
                self.closure[i] = reached;
                let at = contact.law().pressure_increment(contact.pressure(), reached);
                (self.pressure[i], self.tangent[i]) = (at.value, at.tangent);
            }
            if moved <= f64::EPSILON * self.scale {
                break;
            }
        }
        self.factors.factor(coupling, &self.tangent);
    }
}

/// The closure at which `y + b p(y) = target`.
fn closure(contact: &PreloadedContact, own: f64, target: f64, scale: f64) -> f64 {
    let rest = contact.pressure();
    let excess = |y: f64| y + own * contact.law().pressure_increment(rest, y).value - target;
    increasing_root(excess, target, scale.max(f64::MIN_POSITIVE))
}
