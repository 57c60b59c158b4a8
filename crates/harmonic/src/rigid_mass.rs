//! A rigid mass on one contact.

use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
use asperity_structure::StructureError;
use num_complex::Complex64;

use crate::error::{HarmonicError, not_negative, positive};
use crate::{Compliance, LinearSystem, MeanBalance, Receptance};

/// A rigid mass that a force drives against one contact, `m u'' + m h u' + P(u) = f`.
///
/// The simplest model of a rig: the guide bar is rigid, and everything below it is one contact
/// whose law holds the elastic parts in series. Closure and displacement are the same. The
/// receptance is `1 / (m (-w^2 + i w h))`.
///
/// ```
/// use asperity_harmonic::{Compliance, LinearSystem, RigidMass};
///
/// let mass = RigidMass::new(1.61, 420.0)?;
/// let mut compliance = Compliance::zero(1);
/// mass.compliance(1e4, 0.0, &mut compliance);
/// assert!((compliance.direct.value.norm() * 1.61 * 1e8 - 1.0).abs() < 1e-3);
/// # Ok::<(), asperity_harmonic::HarmonicError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMass {
    mass: f64,
    damping_rate: f64,
}

impl RigidMass {
    /// A body of `mass` m \[kg\] with the mass-proportional `damping_rate` h \[1/s\].
    ///
    /// # Errors
    /// [`HarmonicError::Setting`] unless the mass is positive and the rate not negative.
    pub fn new(mass: f64, damping_rate: f64) -> Result<Self, HarmonicError> {
        Ok(Self {
            mass: positive("mass [kg]", mass)?,
            damping_rate: not_negative("damping rate [1/s]", damping_rate)?,
        })
    }
}

impl LinearSystem for RigidMass {
    fn interfaces(&self) -> usize {
        1
    }

    fn compliance(&self, w: f64, anti_damping: f64, into: &mut Compliance) {
        let rate = self.damping_rate - anti_damping;
        let value = (self.mass * Complex64::new(-w * w, w * rate)).inv();
        let squared = value * value * self.mass;
        let receptance = Receptance {
            value,
            d_frequency: -squared * Complex64::new(-2.0 * w, rate),
            d_anti_damping: squared * Complex64::new(0.0, w),
        };
        *into.contact_mut(0, 0) = receptance;
        *into.drive_mut(0) = receptance;
        into.direct = receptance;
    }

    fn mean_balance(&self) -> MeanBalance {
        MeanBalance::determinate(1)
    }

    fn lowest_modes(&self, _count: usize) -> Result<ComponentModes, HarmonicError> {
        let mode = NormalMode::rigid(vec![1.0 / self.mass.sqrt()]);
        let (contacts, none) = (vec![PortPair::on_ground(0)], ResidualFlexibility::zero(1));
        let modes = ComponentModes::new(vec![mode], none, contacts, Vec::new());
        Ok(modes.map_err(StructureError::from)?)
    }

    fn mass_damping(&self) -> f64 {
        self.damping_rate
    }
}
