//! The implicit contact step with viscous damping.

use std::sync::Arc;

use asperity_law::{ContactDamping, ContactLaw, InSeries};
use asperity_structure::PreloadedContact;

use super::contact_table::ContactTable;

/// Newton corrections before the law is solved in series with a layer, in a bracket.
const NEWTON: usize = 24;

/// Correction, over the closures of a step, that counts as none.
const CONVERGED: f64 = 1e-13;

/// The traction of one damped interface.
///
/// With `x` the closure that the law holds at, `d-` the previous-but-one closure and `d` the newest,
/// the traction over the static pressure is
///
/// ```text
/// t = q(x) + c(p(d)) (d+ - d-) / (2 dt),    d+ - d- = (x - d-) / w,
/// ```
///
/// w being the weight of the new closure d+ in x, and not below `-p0` where the law separates. The
/// coefficient is known before the step, so that `x + b t = y` remains one increasing equation; and
/// the work of `t - q` on the closure, `c (d+ - d-)^2 / (4 dt)` per area and step, is never negative,
/// whatever the step and the law. The difference is centred: second order.
pub(super) struct DampedContact<'a> {
    contact: &'a PreloadedContact,
    damping: ContactDamping,
    /// Closure lost per pressure, in x \[m/Pa\].
    compliance: f64,
    /// `1 / (2 w dt)` \[1/s\].
    rate: f64,
    /// Traction increment at which faces carry nothing \[Pa\]; -inf where they carry tension.
    open_below: f64,
    table: ContactTable<&'a Arc<dyn ContactLaw>>,
    /// x of the step before \[m\].
    argument: f64,
}

/// Increments of pressure and traction in a step \[Pa\].
#[derive(Debug, Clone, Copy)]
pub(super) struct DampedStep {
    pub(super) pressure: f64,
    pub(super) traction: f64,
}

impl<'a> DampedContact<'a> {
    /// The step of `contact` with `damping`: `compliance` \[m/Pa\] of the argument of the law, `rate`
    /// \[1/s\] of the closure per argument, and the `table` of the law.
    pub(super) fn new(
        contact: &'a PreloadedContact,
        damping: ContactDamping,
        table: ContactTable<&'a Arc<dyn ContactLaw>>,
        (compliance, rate): (f64, f64),
        open_below: f64,
    ) -> Self {
        Self { contact, damping, compliance, rate, open_below, table, argument: 0.0 }
    }

    /// The step whose law would hold at `unloaded` \[m\] without a change of traction, from the newest
    /// `closure` and the closure `before` it \[m\].
    pub(super) fn solve(&mut self, unloaded: f64, closure: f64, before: f64) -> DampedStep {
        let newest = self.table.get(closure);
        let pressure = self.contact.pressure() + newest.value;
        let factor = self.rate * self.damping.coefficient(pressure, newest.tangent);
        let share = 1.0 / (1.0 + self.compliance * factor);
        let target = share * (unloaded + self.compliance * factor * before);
        let x = self.root(share * self.compliance, target);
        let (mut x, mut at) = (x, self.table.get(x).value);
        let mut traction = at + factor * (x - before);
        if traction < self.open_below {
            traction = self.open_below;
            x = unloaded - self.compliance * traction;
            at = self.table.get(x).value;
        }
        self.argument = x;
        DampedStep { pressure: at, traction }
    }

    /// The closure increment x at which `x + b q(x) = target`.
    fn root(&self, b: f64, target: f64) -> f64 {
        let mut x = self.argument;
        for _ in 0..NEWTON {
            let at = self.table.get(x);
            let correction = (target - x - b * at.value) / (1.0 + b * at.tangent);
            x += correction;
            if correction.abs() <= CONVERGED * (x.abs() + target.abs()) {
                return x;
            }
        }
        let Ok(series) = InSeries::new(self.contact.law(), 1.0 / b) else { return f64::NAN };
        target - b * series.pressure_increment(self.contact.pressure(), target).value
    }
}
