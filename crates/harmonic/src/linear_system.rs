//! The linear structure between the contacts, as harmonic balance uses it.

use std::fmt::Debug;

use asperity_mesh::ComponentModes;
use asperity_structure::{DampedMode, Guide};
use num_complex::Complex64;

use crate::{Compliance, HarmonicError, MeanBalance};

/// A linear structure between a driving point and contact faces.
///
/// Implemented by a preloaded stack of elastic bars, a preloaded structure in component modes, and
/// [`RigidMass`](crate::RigidMass). The anti-damping rate `xi` \[1/s\] adds the force `+ xi M u'` to
/// all masses: it keeps a damped nonlinear mode in periodic motion (extended periodic motion
/// concept), and is zero elsewhere.
pub trait LinearSystem: Debug + Send + Sync {
    /// Number of interfaces.
    fn interfaces(&self) -> usize;

    /// The guides with friction, none by default. In compliances and balances of means they are pairs
    /// after the interfaces: the closure is the displacement in the guide, and the force holds it back.
    fn guides(&self) -> &[Guide] {
        &[]
    }

    /// Writes the compliance at a positive `angular_frequency` \[rad/s\] and an anti-damping rate
    /// \[1/s\].
    fn compliance(&self, angular_frequency: f64, anti_damping: f64, into: &mut Compliance);

    /// Writes the compliance with springs of these complex stiffnesses \[N/m\] in the pairs, none in guides,
    /// by [`Compliance::add_springs`] unless a system has a form that rounding affects less.
    fn compliance_on_springs(
        &self,
        angular_frequency: f64,
        anti_damping: f64,
        springs: &[Complex64],
        into: &mut Compliance,
    ) {
        self.compliance(angular_frequency, anti_damping, into);
        into.add_springs(springs);
    }

    /// The balance of means.
    fn mean_balance(&self) -> MeanBalance;

    /// Component modes for stability: the `count` lowest, with the static flexibility of the
    /// others.
    ///
    /// # Errors
    /// [`HarmonicError::Structure`] when they cannot be computed.
    fn lowest_modes(&self, count: usize) -> Result<ComponentModes, HarmonicError>;

    /// Mass-proportional damping h \[1/s\] of these modes.
    fn mass_damping(&self) -> f64;

    /// Linearised modes with a damping of their own, from the lowest on; none by default.
    fn damped_modes(&self) -> &[DampedMode] {
        &[]
    }

    /// Checks that a periodic motion exists; passes by default.
    ///
    /// # Errors
    /// [`HarmonicError::Floating`] for rigid motions that no contact holds.
    fn check(&self) -> Result<(), HarmonicError> {
        Ok(())
    }
}
