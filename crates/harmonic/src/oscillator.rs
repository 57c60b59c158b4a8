//! A rigid mass on one contact.

use faer::c64;

use crate::error::{HarmonicError, not_negative, positive};
use crate::{Compliance, LinearSystem, MeanBalance, ModalSystem, Receptance};

/// A rigid mass that a force drives against one contact, `m u'' + c u' + P(u) = f`.
///
/// The simplest model of a rig: the guide bar is rigid, and everything below it is one contact
/// whose law holds the elastic parts in series. Closure and displacement are the same. The
/// receptance is `1 / (-w^2 m + i w c)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    mass: f64,
    rate: f64,
}

impl Oscillator {
    /// A body of `mass` m \[kg\] with mass-proportional damping of `rate` `h = c / m` \[1/s\].
    ///
    /// # Errors
    /// [`HarmonicError::Setting`] unless the mass is positive and the rate not negative.
    pub fn new(mass: f64, rate: f64) -> Result<Self, HarmonicError> {
        Ok(Self {
            mass: positive("mass [kg]", mass)?,
            rate: not_negative("damping rate [1/s]", rate)?,
        })
    }
}

impl LinearSystem for Oscillator {
    fn interfaces(&self) -> usize {
        1
    }

    fn compliance(&self, w: f64, anti_damping: f64, into: &mut Compliance) {
        let rate = self.rate - anti_damping;
        let value = (self.mass * c64::new(-w * w, w * rate)).inv();
        let squared = value * value * self.mass;
        let receptance = Receptance {
            value,
            by_frequency: -squared * c64::new(-2.0 * w, rate),
            by_rate: squared * c64::new(0.0, w),
        };
        *into.contact_mut(0, 0) = receptance;
        *into.drive_mut(0) = receptance;
        into.direct = receptance;
    }

    fn mean_balance(&self) -> MeanBalance {
        MeanBalance::determinate(1)
    }

    fn modal(&self, _count: usize) -> ModalSystem {
        let shape = 1.0 / self.mass.sqrt();
        let mut modal = ModalSystem::empty(1);
        modal.push(0.0, self.rate, &[shape], shape);
        modal
    }
}
