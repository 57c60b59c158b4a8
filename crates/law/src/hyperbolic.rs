//! Stiffness that grows without bound at a finite closure.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::{ContactLaw, Pressure};
use crate::domain::{Domain, no_less};
use crate::draw::{Draw, rounded};
use crate::error::{LawError, LawQuantity, above};
use crate::law_form::LawForm;

/// Hyperbolic law, `K = K0 (1 + p / (K0 dm))^2`, so `p = K0 d / (1 - d / dm)`.
///
/// The normal closure of joints (Barton-Bandis): initial stiffness `K0` \[Pa/m\] and maximum closure
/// `dm` \[m\]. Contact is lost at zero closure; with `dm -> inf` it is the unilateral spring of
/// stiffness K0.
///
/// Fitted to unweathered and weathered rock joints under monotonic loading; hysteresis between
/// loading and unloading is not part of it.
///
/// Source: Bandis, Lumsden and Barton, Int. J. Rock Mech. Min. Sci. 20, 249 (1983),
/// doi 10.1016/0148-9062(83)90595-8.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hyperbolic {
    stiffness: f64,
    closure_limit: f64,
}

impl Hyperbolic {
    /// The law of initial `stiffness` K0 > 0 \[Pa/m\] and `closure_limit` dm > 0 \[m\].
    ///
    /// # Errors
    /// [`LawError`] if either is not positive and finite.
    pub fn new(stiffness: f64, closure_limit: f64) -> Result<Self, LawError> {
        Ok(Self {
            stiffness: above(LawQuantity::Stiffness, stiffness, 0.0)?,
            closure_limit: above(LawQuantity::ClosureLimit, closure_limit, 0.0)?,
        })
    }

    /// Stiffness K0 \[Pa/m\] at zero pressure.
    pub fn initial_stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Closure dm \[m\] at which the pressure is infinite.
    pub fn closure_limit(&self) -> f64 {
        self.closure_limit
    }

    /// `q = 1 + p / (K0 dm) = 1 / (1 - d / dm)`.
    fn stretch(&self, pressure: f64) -> f64 {
        1.0 + pressure / self.stiffness / self.closure_limit
    }
}

impl ContactLaw for Hyperbolic {
    fn stiffness(&self, pressure: f64) -> f64 {
        if pressure < 0.0 {
            return 0.0;
        }
        let q = self.stretch(pressure);
        self.stiffness * q * q
    }

    fn stiffness_slope(&self, pressure: f64) -> f64 {
        if pressure < 0.0 {
            return 0.0;
        }
        2.0 * self.stretch(pressure) / self.closure_limit
    }

    fn domain(&self) -> Domain {
        Domain { pressure_min: 0.0, closure_lost: Some(0.0), closure_limit: self.closure_limit }
    }

    fn reference_pressure(&self) -> f64 {
        0.0
    }

    fn closure(&self, pressure: f64) -> f64 {
        if pressure == f64::INFINITY {
            return self.closure_limit;
        }
        let p = no_less(pressure, 0.0);
        let d = p / (self.stiffness * self.stretch(p));
        if d > self.closure_limit {
            self.closure_limit // by rounding alone
        } else {
            d
        }
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        // d = dm (1 - 1/q), so the difference is dm (q2 - q1) / (q1 q2).
        let to = no_less(from + increment, 0.0);
        let dp = no_less(increment, -from);
        dp / (self.stiffness * self.stretch(from) * self.stretch(to))
    }

    fn pressure(&self, closure: f64) -> Pressure {
        if closure < 0.0 {
            return Pressure::OPEN;
        }
        if closure >= self.closure_limit {
            return Pressure::RIGID;
        }
        let q = self.closure_limit / (self.closure_limit - closure);
        Pressure { value: self.stiffness * closure * q, tangent: self.stiffness * q * q }
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        let q1 = self.stretch(from);
        let room = 1.0 - q1 * closure_increment / self.closure_limit;
        if room <= 0.0 {
            return Pressure::RIGID;
        }
        if closure_increment < -self.closure(from) {
            return Pressure::lost_from(from);
        }
        let q = q1 / room;
        let increment = self.stiffness * q1 * q * closure_increment;
        Pressure { value: no_less(increment, -from), tangent: self.stiffness * q * q }
    }

    fn energy(&self, closure: f64) -> f64 {
        if closure < 0.0 {
            return 0.0;
        }
        if closure >= self.closure_limit {
            return f64::INFINITY;
        }
        let dm = self.closure_limit;
        self.stiffness * dm * dm * log_remainder(closure / dm)
    }
}

/// `-ln(1 - z) - z` for 0 <= z < 1 without cancellation.
fn log_remainder(z: f64) -> f64 {
    if z > 0.125 {
        return -(-z).ln_1p() - z;
    }
    // z^2 (1/2 + z/3 + ... + z^16/18): the next term is below 1e-16 of the sum at z = 1/8.
    let series = (2..=18).rev().fold(0.0, |sum, k| sum * z + 1.0 / f64::from(k));
    z * z * series
}

/// Hyperbolic law K(p) = K0 (1 + p / (K0 dm))^2 (Bandis and Barton).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HyperbolicSpec {
    /// Stiffness K0 in Pa/m at zero pressure.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stiffness_pa_per_m: f64,
    /// Largest closure dm in m, approached at infinite pressure.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub closure_limit_m: f64,
}

impl LawForm for HyperbolicSpec {
    fn build(&self, _static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError> {
        Ok(Arc::new(Hyperbolic::new(self.stiffness_pa_per_m, self.closure_limit_m)?))
    }

    fn sample(draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> Self {
        // K0 (1 + s)^2 is the stiffness at a pressure of s K0 dm.
        let share = draw.log_uniform(0.05, 20.0);
        let stiffness_pa_per_m = rounded(stiffness / (1.0 + share).powi(2));
        let closure_limit_m = rounded(pressure / (share * stiffness_pa_per_m));
        Self { stiffness_pa_per_m, closure_limit_m }
    }
}
