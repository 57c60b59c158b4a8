//! Constant stiffness: the linear spring.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::{ContactLaw, Pressure};
use crate::domain::Domain;
use crate::draw::{Draw, rounded};
use crate::error::{LawError, LawQuantity, above};
use crate::law_form::LawForm;

/// Constant stiffness, `K = K0`, so `p = K0 d`.
///
/// `K0` \[Pa/m\] is the stiffness; closures count from zero pressure. The law is bilateral
/// ([`new`](Self::new): it carries tension) or unilateral ([`unilateral`](Self::unilateral):
/// contact is lost at zero closure). It is the limit of every law for small motions about a state,
/// and valid for these only.
///
/// Source: the comparison case of Nouira et al., Lubricants 8, 73 (2020),
/// doi 10.3390/lubricants8070073.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    stiffness: f64,
    unilateral: bool,
}

impl Constant {
    /// A linear spring that carries tension, of `stiffness` K0 > 0 \[Pa/m\].
    ///
    /// # Errors
    /// [`LawError`] if the stiffness is not positive and finite.
    pub fn new(stiffness: f64) -> Result<Self, LawError> {
        Ok(Self { stiffness: above(LawQuantity::Stiffness, stiffness, 0.0)?, unilateral: false })
    }

    /// A linear spring of `stiffness` K0 > 0 \[Pa/m\] that separates at zero closure.
    ///
    /// # Errors
    /// [`LawError`] if the stiffness is not positive and finite.
    pub fn unilateral(stiffness: f64) -> Result<Self, LawError> {
        Ok(Self { unilateral: true, ..Self::new(stiffness)? })
    }

    /// True if contact is lost at zero closure.
    pub fn is_unilateral(&self) -> bool {
        self.unilateral
    }

    /// `pressure`, not below zero for a unilateral law.
    fn admitted(&self, pressure: f64) -> f64 {
        if self.unilateral && pressure < 0.0 { 0.0 } else { pressure }
    }
}

impl ContactLaw for Constant {
    fn stiffness(&self, pressure: f64) -> f64 {
        if self.unilateral && pressure < 0.0 { 0.0 } else { self.stiffness }
    }

    fn stiffness_slope(&self, _pressure: f64) -> f64 {
        0.0
    }

    fn domain(&self) -> Domain {
        if self.unilateral {
            Domain { pressure_min: 0.0, closure_lost: Some(0.0), closure_limit: f64::INFINITY }
        } else {
            Domain::BILATERAL
        }
    }

    fn reference_pressure(&self) -> f64 {
        0.0
    }

    fn closure(&self, pressure: f64) -> f64 {
        self.admitted(pressure) / self.stiffness
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        if self.unilateral && from + increment < 0.0 {
            -from / self.stiffness
        } else {
            increment / self.stiffness
        }
    }

    fn pressure(&self, closure: f64) -> Pressure {
        if self.unilateral && closure < 0.0 {
            return Pressure::OPEN;
        }
        Pressure { value: self.stiffness * closure, tangent: self.stiffness }
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        let increment = self.stiffness * closure_increment;
        if self.unilateral && from + increment < 0.0 {
            return Pressure::lost_from(from);
        }
        Pressure { value: increment, tangent: self.stiffness }
    }

    fn energy(&self, closure: f64) -> f64 {
        0.5 * self.pressure(closure).value * closure
    }
}

/// Linear spring, K(p) = K0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstantSpec {
    /// Stiffness K0 in Pa/m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stiffness_pa_per_m: f64,
    /// Contact opens at zero pressure instead of carrying tension.
    #[serde(default)]
    pub unilateral: bool,
}

impl LawForm for ConstantSpec {
    fn build(&self, _static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError> {
        let build = if self.unilateral { Constant::unilateral } else { Constant::new };
        Ok(Arc::new(build(self.stiffness_pa_per_m)?))
    }

    fn sample(draw: &mut dyn Draw, _pressure: f64, stiffness: f64) -> Self {
        Self { stiffness_pa_per_m: rounded(stiffness), unilateral: draw.chance(0.5) }
    }
}
