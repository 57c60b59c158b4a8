//! The implicit contact step (Eq. 5).

use std::sync::Arc;

use asperity_law::{ContactLaw, CubicCell, InSeries};
use asperity_structure::PreloadedContact;

use super::contact_table::ContactTable;
use super::damped_contact::DampedContact;
use super::stiffness_sum::StiffnessSum;
use crate::contact_energy::excess;
use crate::friction_force::FrictionForce;
use crate::{ContactExtremes, DynamicsError};

/// Closure at which the implicit contact pressure is taken (Eq. 5).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ContactForm {
    /// The mean of the new and the previous-but-one closure: no first-order
    /// numerical loss, and none at all for a linear law.
    #[default]
    Centred,
    /// The new closure, the plain reading of the paper; it damps the
    /// fundamental by about `w0^2 dt`.
    NewLevel,
}

/// One interface during a run: its law, its closures, and its extremes.
///
/// The face nodes are linear in the contact force, so with `d*` the closure
/// that a step would reach without a change of pressure, the closure reached is
///
/// ```text
/// d = d* - b q,   b = S (compliance of the face above + of the face below)
/// ```
///
/// for a pressure `p0 + q`. The law must hold at `x`, the new closure or
/// (centred) its mean with the previous-but-one: `x + b' q(x) = c` with `c`
/// known. That is the pressure of the law in series with an elastic layer of
/// stiffness `1 / b'` at the total closure `c`: a function of one number, which
/// is tabulated once, with an error estimate, instead of iterated every step.
/// Beyond the table, and to build it, the exact law is solved by safeguarded Newton. A damped
/// contact has a traction beyond the pressure, and an equation of its own ([`DampedContact`]).
pub(super) struct ContactStep<'a> {
    contact: &'a PreloadedContact,
    area: f64,
    centred: bool,
    /// Weights of the new and the previous-but-one closure in the argument of the law.
    weight_new: f64,
    weight_old: f64,
    /// Decrease of that argument per traction \[m/Pa\].
    argument_compliance: f64,
    /// Pressure increment at which contact is lost \[Pa\]; -inf for a law that never separates.
    open_below: f64,
    series: ContactTable<InSeries<Arc<dyn ContactLaw>>>,
    /// The cell of the table in use: closures stay in one for many steps.
    cell: CubicCell,
    /// Closure increment since rest, at the newest state and one step before \[m\].
    closure: f64,
    closure_before: f64,
    /// Pressure increment since rest in the latest two solves \[Pa\].
    increment: f64,
    increment_before: f64,
    lowest: f64,
    highest: f64,
    open_steps: usize,
    stiffness: StiffnessSum,
    /// `sum q (d+ - d-) / 2`, the work done on the contact per area \[J/m2\], viscous loss apart.
    work: f64,
    damped: Option<DampedContact<'a>>,
    /// Traction increment beyond the pressure increment in the latest solve \[Pa\].
    viscous: f64,
    /// Viscous loss per area \[J/m2\].
    loss: f64,
    friction: Option<FrictionForce>,
}

impl<'a> ContactStep<'a> {
    /// `compliance` \[m/N\] is the sum of both faces' displacement per force and
    /// `step` \[s\]; `scale` \[Pa\] the pressure change to expect.
    pub(super) fn new(
        contact: &'a PreloadedContact,
        form: ContactForm,
        compliance: f64,
        step: f64,
        scale: f64,
    ) -> Result<Self, DynamicsError> {
        let centred = form == ContactForm::Centred;
        let (weight_new, weight_old) = if centred { (0.5, 0.5) } else { (1.0, 0.0) };
        let separates = contact.law().domain().separates();
        let open_below = if separates { -contact.pressure() } else { f64::NEG_INFINITY };
        let b = contact.area() * compliance * weight_new;
        let named = |source| DynamicsError::Law { interface: contact.name().to_owned(), source };
        let series = InSeries::new(Arc::clone(contact.law()), 1.0 / b).map_err(named)?;
        // The last resort is for an unloaded contact that nothing is expected to press.
        let expected = scale.max(0.01 * contact.pressure());
        let expected = if expected > 0.0 { expected } else { 1.0 };
        let table_top = contact.pressure() + 3.0 * expected;
        let series = ContactTable::new(series, contact.pressure(), table_top).map_err(named)?;
        let damped = match contact.damping() {
            Some(damping) => {
                let table = ContactTable::new(contact.law(), contact.pressure(), table_top);
                let (table, rate) = (table.map_err(named)?, 0.5 / (weight_new * step));
                Some(DampedContact::new(contact, damping, table, (b, rate), open_below))
            }
            None => None,
        };
        Ok(Self {
            damped,
            viscous: 0.0,
            loss: 0.0,
            friction: contact.friction().map(FrictionForce::new),
            contact,
            area: contact.area(),
            centred,
            weight_new,
            weight_old,
            argument_compliance: b,
            open_below,
            series,
            cell: CubicCell::EMPTY,
            closure: 0.0,
            closure_before: 0.0,
            increment: 0.0,
            increment_before: 0.0,
            lowest: 0.0,
            highest: 0.0,
            open_steps: 0,
            stiffness: StiffnessSum::new(contact.law().kinks()),
            work: 0.0,
        })
    }

    /// The traction increment \[Pa\] of a step that would bring the closure increment to
    /// `unloaded` \[m\] without it: the pressure increment `q`, but for damping and friction.
    #[inline(always)]
    pub(super) fn solve(&mut self, unloaded: f64) -> f64 {
        let argument = self.weight_new * unloaded + self.weight_old * self.closure_before;
        let before = self.increment;
        let traction = match self.friction {
            None => self.normal_traction(argument),
            Some(friction) => self.solve_with_friction(friction, argument),
        };
        self.increment_before = before;
        traction
    }

    /// The traction increment \[Pa\] without friction, where the law would hold at `argument` \[m\]
    /// without it.
    #[inline(always)]
    fn normal_traction(&mut self, argument: f64) -> f64 {
        if self.damped.is_some() {
            return self.solve_damped(argument);
        }
        let outside = if self.cell.contains(argument) { None } else { self.change_cell(argument) };
        let increment = outside.unwrap_or_else(|| self.cell.get(argument, |a, b, c| a * b + c));
        self.increment = increment;
        increment
    }

    /// The traction increment \[Pa\] with friction across the closure x that the law holds at.
    ///
    /// With `t(y)` the traction of the contact alone, `y` being the closure without it, and the force f
    /// of the element, `x = y - b t(y)` with `y = c - b f / S`: x falls with f, so that the element
    /// slips forwards if it would at its slip force, backwards likewise, and is stuck else, at the one
    /// force between.
    #[inline(never)]
    fn solve_with_friction(&mut self, friction: FrictionForce, argument: f64) -> f64 {
        let limit = friction.limit(self.area * self.normal());
        let b = self.argument_compliance;
        let mut at = |force: f64| {
            let unloaded = argument - b * force / self.area;
            let traction = self.normal_traction(unloaded);
            let closure = unloaded - b * traction;
            (closure, traction, friction.at(closure, limit) - force)
        };
        let mut force = limit;
        let (mut closure, mut traction, excess) = at(force);
        if excess < 0.0 {
            force = -limit;
            let backwards = at(force);
            (closure, traction, _) = backwards;
            if backwards.2 > 0.0 {
                force =
                    decreasing_root(|force| at(force).2, [(-limit, backwards.2), (limit, excess)]);
                (closure, traction, _) = at(force);
            }
        }
        if let Some(friction) = &mut self.friction {
            friction.advance(closure, force);
        }
        traction + force / self.area
    }

    #[inline(never)]
    fn solve_damped(&mut self, argument: f64) -> f64 {
        let Some(damped) = &mut self.damped else { return f64::NAN };
        let found = damped.solve(argument, self.closure, self.closure_before);
        self.increment = found.pressure;
        self.viscous = found.traction - found.pressure;
        found.traction
    }

    /// Records the closure increment \[m\] that the step ends with.
    #[inline(always)]
    pub(super) fn advance(&mut self, reached: f64) {
        self.work += 0.5 * self.increment * (reached - self.closure_before);
        self.loss += 0.5 * self.viscous * (reached - self.closure_before);
        if let Some(friction) = &mut self.friction {
            friction.count(0.5 * (reached - self.closure_before));
        }
        self.closure_before = self.closure;
        self.closure = reached;
        if self.increment < self.lowest {
            self.lowest = self.increment;
        }
        if self.increment > self.highest {
            self.highest = self.increment;
        }
        if self.increment <= self.open_below {
            self.open_steps += 1;
        } else {
            let pressure = self.contact.pressure() + self.increment;
            self.stiffness.count(pressure, |pressure| self.contact.law().stiffness(pressure));
        }
    }

    /// Nominal contact area \[m2\].
    pub(super) fn area(&self) -> f64 {
        self.area
    }

    /// True if every number of the latest solve is finite.
    pub(super) fn is_finite(&self) -> bool {
        self.increment.is_finite() && self.closure.is_finite()
    }

    /// Takes up the cell of the table that `argument` falls in; outside the
    /// table, returns the pressure increment of the exact law instead.
    #[cold]
    #[inline(never)]
    fn change_cell(&mut self, argument: f64) -> Option<f64> {
        let found = self.series.cell(argument);
        self.cell = found.unwrap_or(CubicCell::EMPTY);
        if found.is_some() { None } else { Some(self.series.get_beyond(argument)) }
    }

    /// Pressure \[Pa\], closure \[m\] and stiffness \[Pa/m\] one step before the newest state.
    pub(super) fn observe(&self) -> (f64, f64, f64) {
        // Centred, the latest solve spans the step before the newest; else it is the newest's.
        let increment = if self.centred { self.increment } else { self.increment_before };
        let closure = self.contact.closure() + self.closure_before;
        if increment <= self.open_below {
            return (0.0, closure, 0.0);
        }
        let pressure = self.contact.pressure() + increment;
        (pressure, closure, self.contact.law().stiffness(pressure))
    }

    pub(super) fn record(&self, step: f64, steps: usize) -> ContactExtremes {
        // Next to loss of contact the table may undershoot zero within its error bound.
        let pressure = |increment: f64| self.contact.pressure() + increment.max(self.open_below);
        ContactExtremes {
            pressure_min: pressure(self.lowest),
            pressure_max: pressure(self.highest),
            lost: self.open_steps as f64 * step,
            stiffness_average: self.stiffness.total(|p| self.contact.law().stiffness(p))
                / steps as f64,
        }
    }

    /// Energy stored beyond rest and against the static pressure, averaged over
    /// the last two states, and the work done on the contact \[J\].
    pub(super) fn energy(&self) -> (f64, f64) {
        let excess = |increment: f64| excess(self.contact, increment);
        let stored = 0.5 * (excess(self.closure) + excess(self.closure_before));
        (self.area * stored, self.area * self.work)
    }

    /// Traction without friction in the latest solve \[Pa\].
    pub(super) fn normal(&self) -> f64 {
        self.contact.pressure() + self.increment + self.viscous
    }

    /// Energy of the friction element, and its loss so far \[J\].
    pub(super) fn friction_energy(&self) -> (f64, f64) {
        self.friction.map_or((0.0, 0.0), |friction| friction.energy())
    }

    /// Viscous loss of the contact so far \[J\].
    pub(super) fn loss(&self) -> f64 {
        self.area * self.loss
    }

    pub(super) fn name(&self) -> &str {
        self.contact.name()
    }
}

/// Most steps of the search for a root, and its width over the first that ends it.
const ROOT_STEPS: usize = 100;
const ROOT_WIDTH: f64 = 1e-14;

/// The root of a decreasing function between two places with values of either sign, by false
/// position with halved weights.
fn decreasing_root(mut of: impl FnMut(f64) -> f64, ends: [(f64, f64); 2]) -> f64 {
    let [(mut low, mut above), (mut high, mut below)] = ends;
    let width = ROOT_WIDTH * (high - low);
    let mut place = low;
    // Side of the last place: the weight of an end that is kept twice is halved.
    let mut last = 0;
    for _ in 0..ROOT_STEPS {
        place = (low * below - high * above) / (below - above);
        let value = of(place);
        if value == 0.0 || high - low <= width {
            break;
        }
        if value > 0.0 {
            (low, above) = (place, value);
            if last > 0 {
                below *= 0.5;
            }
            last = 1;
        } else {
            (high, below) = (place, value);
            if last < 0 {
                above *= 0.5;
            }
            last = -1;
        }
        if value.abs() <= width {
            break;
        }
    }
    place
}
