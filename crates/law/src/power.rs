//! Stiffness as a power of pressure.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::{ContactLaw, Pressure};
use crate::domain::{Domain, no_less};
use crate::draw::{Draw, rounded};
use crate::error::{LawError, LawQuantity, above, at_least, regular};
use crate::exponential::log_ratio;
use crate::law_form::{LawFault, LawForm};

/// Power law, `K = C p^m`.
///
/// With the coefficient `C` \[Pa^(1-m)/m\] and the exponent `m` \[-\]:
/// - m < 1: `p = ((1 - m) C d)^(1/(1-m))` for closures from first contact; contact is lost at a
///   finite closure. m = 0 is the unilateral linear spring.
/// - m = 1: the exponential law with u0 = 1/C; contact is never lost.
/// - m > 1: contact is never lost, and the pressure is infinite at a finite closure.
///
/// One form serves all exponents: with `e = 1 - m`, the closure increment from pressure `p0` to
/// `p0 exp(L)` is
///
/// ```text
/// p0^e (exp(e L) - 1) / (e C),
/// ```
///
/// evaluated with `exp_m1` and `ln_1p`, so that neither m near 1 nor small increments lose
/// precision. Valid in the range of pressures to which it was fitted (0.14 to 1 MPa in the source).
///
/// Source: Nouira et al., Lubricants 8, 73 (2020), Eq. (7), doi 10.3390/lubricants8070073.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power {
    coefficient: f64,
    exponent: f64,
    reference_pressure: f64,
    domain: Domain,
}

impl Power {
    /// The law of `coefficient` C > 0 \[Pa^(1-m)/m\] and `exponent` m >= 0, with closures counted
    /// from `reference_pressure` \[Pa\]: at least 0 for m < 1 (0 counts from first contact),
    /// positive for m >= 1.
    ///
    /// # Errors
    /// [`LawError`] if a parameter is outside these limits or not finite.
    pub fn new(coefficient: f64, exponent: f64, reference_pressure: f64) -> Result<Self, LawError> {
        above(LawQuantity::Coefficient, coefficient, 0.0)?;
        at_least(LawQuantity::Exponent, exponent, 0.0)?;
        if exponent < 1.0 {
            at_least(LawQuantity::ReferencePressure, reference_pressure, 0.0)?;
        } else {
            above(LawQuantity::ReferencePressure, reference_pressure, 0.0)?;
        }
        let mut law = Self {
            coefficient,
            exponent,
            reference_pressure,
            domain: Domain { pressure_min: 0.0, closure_lost: None, closure_limit: f64::INFINITY },
        };
        if exponent < 1.0 {
            law.domain.closure_lost = Some(law.closure(0.0));
        } else if exponent > 1.0 {
            law.domain.closure_limit = law.closure(f64::INFINITY);
        }
        Ok(law)
    }

    /// Coefficient C \[Pa^(1-m)/m\].
    pub fn coefficient(&self) -> f64 {
        self.coefficient
    }

    /// Exponent m \[-\].
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Closure increment from pressure `from` > 0 over the logarithmic increment `log`.
    fn closure_over(&self, from: f64, log: f64) -> f64 {
        let e = 1.0 - self.exponent;
        raised(from, e) / self.coefficient * exp_m1_over(e, log)
    }

    /// Logarithmic pressure increment from `from` > 0 over a closure increment: -inf after
    /// loss of contact, +inf from the closure limit on.
    fn log_over(&self, from: f64, closure_increment: f64) -> f64 {
        let e = 1.0 - self.exponent;
        ln_1p_over(e, self.coefficient * closure_increment / raised(from, e))
    }

    /// `value` with the tangent at `pressure`.
    fn state(&self, value: f64, pressure: f64) -> Pressure {
        Pressure { value, tangent: self.stiffness(pressure) }
    }

    /// Energy \[J/m2\] from the reference pressure (positive) to that of `closure`, for laws that
    /// separate too.
    pub(crate) fn energy_from_reference(&self, closure: f64) -> f64 {
        let p0 = self.reference_pressure;
        let e = 2.0 - self.exponent;
        let log = self.log_over(p0, closure);
        p0.powf(e) / self.coefficient * exp_m1_over(e, log)
    }
}

impl ContactLaw for Power {
    fn stiffness(&self, pressure: f64) -> f64 {
        if pressure < 0.0 { 0.0 } else { self.coefficient * raised(pressure, self.exponent) }
    }

    fn stiffness_slope(&self, pressure: f64) -> f64 {
        let m = self.exponent;
        if pressure < 0.0 || m == 0.0 { 0.0 } else { m * self.coefficient * pressure.powf(m - 1.0) }
    }

    fn domain(&self) -> Domain {
        self.domain
    }

    fn reference_pressure(&self) -> f64 {
        self.reference_pressure
    }

    fn closure(&self, pressure: f64) -> f64 {
        let p = no_less(pressure, 0.0);
        let p0 = self.reference_pressure;
        if p0 > 0.0 {
            self.closure_over(p0, log_ratio(p, p0))
        } else {
            let e = 1.0 - self.exponent;
            p.powf(e) / (e * self.coefficient)
        }
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        let change = increment / from;
        if from == 0.0 || change == f64::INFINITY {
            // From zero, or so close to it that the whole closure is the increment.
            let e = 1.0 - self.exponent;
            no_less(increment, 0.0).powf(e) / (e * self.coefficient)
        } else {
            self.closure_over(from, no_less(change, -1.0).ln_1p())
        }
    }

    fn pressure(&self, closure: f64) -> Pressure {
        if self.domain.is_open(closure) {
            return Pressure::OPEN;
        }
        if closure >= self.domain.closure_limit {
            return Pressure::RIGID;
        }
        let p0 = self.reference_pressure;
        let p = if self.domain.closure_lost == Some(closure) {
            0.0
        } else if p0 > 0.0 {
            p0 * self.log_over(p0, closure).exp()
        } else {
            let e = 1.0 - self.exponent;
            (e * self.coefficient * closure).powf(1.0 / e)
        };
        self.state(p, p)
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        if from > 0.0 {
            let log = self.log_over(from, closure_increment);
            if log == f64::NEG_INFINITY {
                return Pressure::lost_from(from);
            }
            return self.state(from * log.exp_m1(), from * log.exp());
        }
        if closure_increment < 0.0 {
            return Pressure::OPEN;
        }
        let e = 1.0 - self.exponent;
        let p = (e * self.coefficient * closure_increment).powf(1.0 / e);
        self.state(p, p)
    }

    /// In closed form, with one power: `p0^m = p0 / p0^(1-m)`.
    fn pressure_step(&self, from: f64, closure_increment: f64) -> Option<Pressure> {
        let (m, e) = (self.exponent, 1.0 - self.exponent);
        let power = raised(from, e);
        let log = ln_1p_over(e, self.coefficient * closure_increment / power);
        let value = from * log.exp_m1();
        let tangent = self.coefficient * (from / power) * (m * log).exp();
        (from > 0.0 && value.is_finite() && value > -from).then_some(Pressure { value, tangent })
    }

    /// In closed form; from first contact with one power each.
    fn interpolate(&self, closures: &[f64], found: &mut Vec<Pressure>) -> bool {
        let (p0, e) = (self.reference_pressure, 1.0 - self.exponent);
        let rate = self.coefficient / raised(p0, e);
        let inverse = e.recip();
        let at = |&closure: &f64| {
            if self.domain.is_open(closure) || self.domain.closure_lost == Some(closure) {
                return Pressure { value: 0.0, ..self.pressure(closure) };
            }
            if closure >= self.domain.closure_limit {
                return Pressure::RIGID;
            }
            if p0 > 0.0 {
                let p = p0 * ln_1p_over(e, rate * closure).exp();
                return self.state(p, p);
            }
            // `dp/dd = p / ((1 - m) d)`.
            let scaled = e * closure;
            let p = (self.coefficient * scaled).powf(inverse);
            Pressure { value: p, tangent: p / scaled }
        };
        found.extend(closures.iter().map(at));
        true
    }

    fn energy(&self, closure: f64) -> f64 {
        let m = self.exponent;
        if m < 1.0 {
            // From first contact: integral of p^(1-m) / C.
            let p = self.pressure(closure).value;
            p.powf(2.0 - m) / ((2.0 - m) * self.coefficient)
        } else {
            self.energy_from_reference(closure)
        }
    }
}

/// `x^a`, without a power for the exponents of a constant stiffness.
fn raised(x: f64, a: f64) -> f64 {
    if a == 0.0 {
        1.0
    } else if a == 1.0 {
        x
    } else {
        x.powf(a)
    }
}

/// `(exp(e l) - 1) / e`, and its limit `l` at e = 0.
fn exp_m1_over(e: f64, l: f64) -> f64 {
    if e == 0.0 || (e * l).abs() < 1e-17 { l } else { (e * l).exp_m1() / e }
}

/// `ln(1 + e y) / e`, and its limit `y` at e = 0: the inverse of [`exp_m1_over`].
///
/// For a non-positive argument of the logarithm: -inf for e > 0, +inf for e < 0.
fn ln_1p_over(e: f64, y: f64) -> f64 {
    if e == 0.0 || (e * y).abs() < 1e-17 { y } else { no_less(e * y, -1.0).ln_1p() / e }
}

/// Power law K(p) = C p^m (Eq. 7 of the paper).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PowerSpec {
    /// Coefficient C in Pa^(1-m)/m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub coefficient: f64,
    /// Exponent m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub exponent: f64,
}

impl LawForm for PowerSpec {
    /// The stiffness neither overflows nor vanishes at a typical pressure.
    fn faults(&self) -> Box<dyn Iterator<Item = LawFault> + '_> {
        let stiffness = self.coefficient * 1e6_f64.powf(self.exponent);
        let stiffness = regular("the stiffness C p^m at 1e6 Pa", stiffness);
        Box::new(LawFault::of(stiffness, String::new, REGULAR).into_iter())
    }

    fn build(&self, static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError> {
        let reference_pressure = if self.exponent < 1.0 { 0.0 } else { static_pressure };
        Ok(Arc::new(Power::new(self.coefficient, self.exponent, reference_pressure)?))
    }

    fn sample(draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> Self {
        let exponent =
            if draw.chance(0.1) { draw.uniform(1.0, 1.2) } else { draw.uniform(0.2, 0.9) };
        Self { coefficient: rounded(stiffness / pressure.powf(exponent)), exponent }
    }
}

/// Values accepted for a stiffness `C p^m` that is to be [`regular`].
pub(crate) const REGULAR: &str =
    "a coefficient and an exponent that give a finite stiffness above zero";
