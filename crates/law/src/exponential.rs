//! Stiffness proportional to pressure.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::{ContactLaw, Pressure};
use crate::domain::{Domain, no_less};
use crate::draw::{Draw, rounded};
use crate::error::{LawError, LawQuantity, above};
use crate::law_form::LawForm;

/// Exponential law, `K = p / u0`, so `p = p_ref exp(d / u0)`.
///
/// `u0` \[m\] is a length of the order of the root mean square roughness; closures count from the
/// reference pressure `p_ref`, and contact is never lost. It is the power law with m = 1 and
/// C = 1/u0.
///
/// Valid for elastic contact of randomly rough, self-affine faces at squeezing pressures where the
/// real contact area is still a small part of the nominal one.
///
/// Source: Persson, Phys. Rev. Lett. 99, 125502 (2007), doi 10.1103/PhysRevLett.99.125502.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponential {
    length: f64,
    reference_pressure: f64,
}

impl Exponential {
    /// The law of `length` u0 > 0 \[m\], with closures counted from
    /// `reference_pressure` > 0 \[Pa\].
    ///
    /// # Errors
    /// [`LawError`] if either is not positive and finite.
    pub fn new(length: f64, reference_pressure: f64) -> Result<Self, LawError> {
        Ok(Self {
            length: above(LawQuantity::Length, length, 0.0)?,
            reference_pressure: above(LawQuantity::ReferencePressure, reference_pressure, 0.0)?,
        })
    }

    /// Length u0 \[m\] over which the pressure grows by a factor e.
    pub fn length(&self) -> f64 {
        self.length
    }
}

impl ContactLaw for Exponential {
    fn stiffness(&self, pressure: f64) -> f64 {
        if pressure < 0.0 { 0.0 } else { pressure / self.length }
    }

    fn stiffness_slope(&self, pressure: f64) -> f64 {
        if pressure < 0.0 { 0.0 } else { 1.0 / self.length }
    }

    fn domain(&self) -> Domain {
        Domain { pressure_min: 0.0, closure_lost: None, closure_limit: f64::INFINITY }
    }

    fn reference_pressure(&self) -> f64 {
        self.reference_pressure
    }

    fn closure(&self, pressure: f64) -> f64 {
        self.length * log_ratio(no_less(pressure, 0.0), self.reference_pressure)
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        self.length * no_less(increment / from, -1.0).ln_1p()
    }

    fn pressure(&self, closure: f64) -> Pressure {
        let p = self.reference_pressure * (closure / self.length).exp();
        Pressure { value: p, tangent: p / self.length }
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        let z = closure_increment / self.length;
        Pressure { value: from * z.exp_m1(), tangent: from * z.exp() / self.length }
    }

    fn energy(&self, closure: f64) -> f64 {
        // p - p_ref is exact in exp_m1, and dd = u0 dp / p.
        self.length * self.reference_pressure * (closure / self.length).exp_m1()
    }
}

/// `ln(p / r)` for p >= 0 and r > 0, with full relative precision next to p = r.
pub(crate) fn log_ratio(p: f64, r: f64) -> f64 {
    let change = (p - r) / r; // p - r is exact within a factor of two
    if change.abs() < 0.5 { change.ln_1p() } else { (p / r).ln() }
}

/// Exponential law K(p) = p / u0, which never separates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExponentialSpec {
    /// Length u0 in m over which the pressure grows by a factor e.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_m: f64,
}

impl LawForm for ExponentialSpec {
    fn build(&self, static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError> {
        Ok(Arc::new(Exponential::new(self.length_m, static_pressure)?))
    }

    fn sample(_draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> Self {
        Self { length_m: rounded(pressure / stiffness) }
    }
}
