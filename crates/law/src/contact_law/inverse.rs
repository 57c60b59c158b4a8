//! Pressure of any law from its closure, by a bracketed Newton iteration.

use super::{ContactLaw, Pressure, quadrature};
use crate::domain::no_less;

/// Largest number of iterations; bisection needs about 64.
const ITERATIONS: usize = 200;

/// Relative step below which an iteration that no longer advances is limited by the rounding of
/// the quadrature.
const STALLED: f64 = 1e-13;

/// Longest step in the logarithm of pressure while the root is not yet bracketed.
const STRIDE: f64 = 40.0;

/// Relative correction of a [`step`] whose square is below rounding.
const SETTLED: f64 = 1e-7;

/// Closure \[m\] from one pressure \[Pa\] to another.
type ClosureBetween<'a> = dyn Fn(f64, f64) -> f64 + 'a;

/// Pressure \[Pa\] at `closure` \[m\]: the default of [`ContactLaw::pressure`].
pub(crate) fn pressure<L: ContactLaw + ?Sized>(law: &L, closure: f64) -> Pressure {
    pressure_by(law, closure, &|from, to| quadrature::closure_between(law, from, to))
}

/// The same for a law with its own closure `between` two pressures.
pub(crate) fn pressure_by<L: ContactLaw + ?Sized>(
    law: &L,
    closure: f64,
    between: &ClosureBetween<'_>,
) -> Pressure {
    let domain = law.domain();
    if closure.is_nan() {
        return Pressure { value: f64::NAN, tangent: f64::NAN };
    }
    if domain.is_open(closure) {
        return Pressure::OPEN;
    }
    if closure >= domain.closure_limit {
        return Pressure::RIGID;
    }
    let p = if domain.closure_lost == Some(closure) {
        0.0
    } else {
        solve(law, between, law.reference_pressure(), closure)
    };
    Pressure { value: p, tangent: law.stiffness(p) }
}

/// Pressure increment \[Pa\]: the default of [`ContactLaw::pressure_increment`].
///
/// Newton steps on the increment itself restore the relative precision that is lost in the
/// difference of two pressures.
pub(crate) fn pressure_increment<L: ContactLaw + ?Sized>(
    law: &L,
    from: f64,
    closure_increment: f64,
) -> Pressure {
    let between = |from: f64, to: f64| quadrature::closure_between(law, from, to);
    pressure_increment_by(law, from, closure_increment, &between)
}

/// The same for a law with its own closure `between` two pressures.
pub(crate) fn pressure_increment_by<L: ContactLaw + ?Sized>(
    law: &L,
    from: f64,
    closure_increment: f64,
    between: &ClosureBetween<'_>,
) -> Pressure {
    if let Some(lost) = law.domain().closure_lost {
        // The closure at loss of contact, unless the difference would cancel.
        let stated = lost - law.closure(from);
        let room =
            if stated < 1e-3 * lost { stated } else { law.closure_increment(from, 0.0 - from) };
        if closure_increment < room {
            return Pressure::lost_from(from);
        }
    }
    let reached = solve(law, between, from, closure_increment);
    if reached == f64::INFINITY {
        return Pressure::RIGID;
    }
    refine_increment(law, from, closure_increment, reached - from)
}

/// Newton step over the increment and over the pressure after which the next would be rounding: it goes with the square.
const LAST_STEP: f64 = 1e-9;

/// Newton steps on a pressure increment, from a close `guess`.
pub(crate) fn refine_increment<L: ContactLaw + ?Sized>(
    law: &L,
    from: f64,
    closure_increment: f64,
    guess: f64,
) -> Pressure {
    if closure_increment == 0.0 {
        return Pressure { value: 0.0, tangent: law.stiffness(from) };
    }
    let lowest = law.domain().pressure_min - from;
    let mut increment = guess;
    for _ in 0..4 {
        let residual = closure_increment - law.closure_increment(from, increment);
        let step = residual * law.stiffness(from + increment);
        let next = no_less(increment + step, lowest);
        if !next.is_finite() {
            break;
        }
        increment = next;
        let small = LAST_STEP * (from + increment).abs().min(increment.abs());
        if step.abs() <= small.max(2.0 * f64::EPSILON * increment.abs()) {
            break;
        }
    }
    Pressure { value: increment, tangent: law.stiffness(from + increment) }
}

/// Pressure at which the closure from pressure `origin` is `target`.
fn solve<L: ContactLaw + ?Sized>(
    law: &L,
    between: &ClosureBetween<'_>,
    origin: f64,
    target: f64,
) -> f64 {
    if law.domain().is_bilateral() {
        bilateral(law, between, origin, target)
    } else {
        unilateral(law, between, origin, target)
    }
}

/// The root in the pressure itself.
fn bilateral<L: ContactLaw + ?Sized>(
    law: &L,
    between: &ClosureBetween<'_>,
    origin: f64,
    target: f64,
) -> f64 {
    let mut bracket = Bracket::OPEN;
    let mut p = origin;
    for _ in 0..ITERATIONS {
        let residual = target - between(origin, p);
        let newton = residual * law.stiffness(p);
        if newton.is_nan() {
            return f64::NAN;
        }
        let advances = bracket.narrow(p, residual);
        if converged(newton, p.abs(), advances) {
            return p + newton;
        }
        p = bracket.inside(p + newton, advances);
    }
    p
}

/// The root in the logarithm of the pressure; for closures from first contact in that of the
/// closure too, which makes a power law's equation linear. Zero or +inf where no pressure reaches
/// the target.
fn unilateral<L: ContactLaw + ?Sized>(
    law: &L,
    between: &ClosureBetween<'_>,
    origin: f64,
    target: f64,
) -> f64 {
    let from_contact = origin == 0.0;
    let mut bracket = Bracket::OPEN;
    let mut t = if from_contact { 0.0 } else { origin.ln() };
    for _ in 0..ITERATIONS {
        let p = t.exp();
        if p == 0.0 || p == f64::INFINITY {
            return p;
        }
        let found = between(origin, p);
        if found == target {
            return p;
        }
        // d(ln p)/dd
        let slope = law.stiffness(p) / p;
        let newton = if from_contact {
            (target / found).ln() * found * slope
        } else {
            (target - found) * slope
        };
        if newton.is_nan() {
            return f64::NAN;
        }
        let advances = bracket.narrow(t, target - found);
        if converged(newton, 1.0 + t.abs(), advances) {
            // The last correction, applied to the pressure without the rounding of its logarithm.
            return p * (1.0 + newton);
        }
        t = bracket.inside(t + newton.clamp(-STRIDE, STRIDE), advances);
    }
    t.exp()
}

/// True if a Newton step is rounding: small, or as small as quadrature allows and not shrinking.
fn converged(newton: f64, scale: f64, advances: bool) -> bool {
    let size = newton.abs() / scale;
    size <= 4.0 * f64::EPSILON || (!advances && size <= STALLED)
}

/// The interval that holds the root of an increasing function.
struct Bracket {
    low: f64,
    high: f64,
    residual: f64,
}

impl Bracket {
    const OPEN: Self =
        Self { low: f64::NEG_INFINITY, high: f64::INFINITY, residual: f64::INFINITY };

    /// Updates the interval with the residual at a point; true if it is at most half the last one.
    fn narrow(&mut self, at: f64, residual: f64) -> bool {
        if residual > 0.0 {
            self.low = at;
        } else {
            self.high = at;
        }
        let halved = residual.abs() <= 0.5 * self.residual;
        self.residual = residual.abs();
        halved
    }

    /// `next` if the iteration advances and `next` lies inside, else the midpoint; `next` in any
    /// case while one side is open.
    fn inside(&self, next: f64, advances: bool) -> f64 {
        let middle = 0.5 * (self.low + self.high);
        if !middle.is_finite() || (advances && self.low < next && next < self.high) {
            next
        } else {
            middle
        }
    }
}

/// [`ContactLaw::pressure_step`] from a pressure \[Pa\] over a closure increment \[m\], with the stiffness at a
/// pressure and the closure increment over a pressure increment.
pub(crate) fn step(
    (from, over): (f64, f64),
    stiffness: impl Fn(f64) -> f64,
    closure: impl Fn(f64) -> f64,
) -> Option<Pressure> {
    let k1 = stiffness(from);
    let k2 = stiffness(from + 0.5 * over * k1);
    let k3 = stiffness(from + 0.5 * over * k2);
    let k4 = stiffness(from + over * k3);
    let mut increment = over * (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
    for _ in 0..2 {
        let reached = from + increment;
        // A step down by more than half of the pressure is too coarse next to zero.
        if !(from > 0.0 && k1 > 0.0 && increment.is_finite() && reached > 0.5 * from) {
            return None;
        }
        let off = stiffness(reached) * (over - closure(increment));
        increment += off;
        // The remaining error is of the order of the square, times the curvature of the law.
        if off.abs() <= SETTLED * increment.abs() {
            return Some(Pressure { value: increment, tangent: stiffness(from + increment) });
        }
    }
    None
}
