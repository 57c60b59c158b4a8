//! Pressure against closure of contacts over a run, with the tractions of contact damping and friction.

use std::borrow::Cow;

use asperity_dynamics::InterfaceHistory;
use asperity_structure::PreloadedContact;

use crate::assemble::Interfaces;
use crate::run::Run;

/// Closures and tractions of a contact at the samples of a run.
#[derive(Debug, Clone)]
pub struct ContactPath<'a> {
    contact: &'a PreloadedContact,
    /// Closure \[m\], counted from the law's reference pressure.
    pub closure: &'a [f64],
    /// Traction \[Pa\]:
    ///
    /// ```text
    /// s = max(0, p + c(p) dd/dt) + f / A
    /// ```
    ///
    /// with the pressure p of the law at the closure d, the coefficient c of the contact damping (without the
    /// bound where the law carries tension), and the force f of the friction element over the area A. Without
    /// damping and friction it is the pressure.
    ///
    /// The rate of the closure is a central difference of the samples, of second order in their interval; the
    /// friction element follows the samples. Of a patch the means over its area are taken.
    pub traction: Cow<'a, [f64]>,
}

/// The paths of the contacts of a run, in the order of the interfaces.
pub fn contact_paths<S: Interfaces>(run: &Run<S>) -> Vec<ContactPath<'_>> {
    let interval = run.assembly.sampling.interval();
    let contacts = run.assembly.structure.interfaces().iter();
    let pairs = contacts.zip(&run.transient.history.interfaces);
    pairs.map(|(contact, history)| ContactPath::new(contact, history, interval)).collect()
}

impl<'a> ContactPath<'a> {
    fn new(contact: &'a PreloadedContact, history: &'a InterfaceHistory, interval: f64) -> Self {
        let traction = if contact.damping().is_some() || contact.friction().is_some() {
            traction(contact, history, interval).into()
        } else {
            (&history.pressure).into()
        };
        Self { contact, closure: &history.closure, traction }
    }

    /// Name of the interface.
    pub fn name(&self) -> &'a str {
        self.contact.name()
    }

    /// Closure \[m\] and pressure \[Pa\] at rest.
    pub fn at_rest(&self) -> (f64, f64) {
        (self.contact.closure(), self.contact.pressure())
    }

    /// Pressure \[Pa\] of the law at a closure \[m\].
    pub fn law(&self, closure: f64) -> f64 {
        self.contact.law().pressure(closure).value
    }

    /// True if the traction has more than the pressure of the law.
    pub fn is_dissipative(&self) -> bool {
        matches!(self.traction, Cow::Owned(_))
    }
}

fn traction(contact: &PreloadedContact, history: &InterfaceHistory, interval: f64) -> Vec<f64> {
    let InterfaceHistory { pressure, closure, stiffness } = history;
    let separates = !contact.law().domain().is_bilateral();
    let last = closure.len().saturating_sub(1);
    let rate = |n: usize| {
        let (before, after) = (n.saturating_sub(1), (n + 1).min(last));
        (closure[after] - closure[before]) / ((after - before).max(1) as f64 * interval)
    };
    let (mut before, mut held) = (contact.closure(), 0.0);
    let at = |n: usize| {
        let p = pressure[n];
        let coefficient = contact.damping().map_or(0.0, |one| one.coefficient(p, stiffness[n]));
        let normal = p + coefficient * rate(n);
        let normal = if separates { normal.max(0.0) } else { normal };
        if let Some(friction) = contact.friction() {
            let limit = friction.limit(normal * contact.area());
            held = friction.force(held, closure[n] - before, limit);
            before = closure[n];
        }
        normal + held / contact.area()
    };
    (0..closure.len()).map(at).collect()
}
