//! The linear structure between the contacts, as harmonic balance uses it.

use std::fmt::Debug;

use asperity_mesh::ComponentModes;
use asperity_structure::{DampedMode, Guide};
use num_complex::Complex64;

use crate::{Compliance, HarmonicError, MeanBalance, SystemPort};

/// A linear structure between its ports and contact faces.
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

    /// The port of a load and a sensor that are not given: port 0, or the top of a stack.
    fn default_port(&self) -> SystemPort {
        SystemPort::Number(0)
    }

    /// Checks that the system has a port.
    ///
    /// # Errors
    /// [`HarmonicError::Structure`] for a port beyond those of the system,
    /// [`HarmonicError::ForeignPort`] for one of another kind.
    fn check_port(&self, port: SystemPort) -> Result<(), HarmonicError>;

    /// Writes the compliance of all pairs and these `ports` at a positive angular frequency \[rad/s\] and
    /// an anti-damping rate \[1/s\], with springs of these complex stiffnesses \[N/m\] in the pairs and
    /// none in those beyond. A port that the system does not have does not move.
    fn compliance(
        &self,
        at: (f64, f64),
        ports: &[SystemPort],
        springs: &[Complex64],
        into: &mut Compliance,
    );

    /// The balance of means, with the mean displacements of these ports.
    fn mean_balance(&self, ports: &[SystemPort]) -> MeanBalance;

    /// Component modes for stability: the `count` lowest, with the static flexibility of the
    /// others.
    ///
    /// # Errors
    /// [`HarmonicError::Structure`] when they cannot be computed.
    fn lowest_modes(&self, count: usize) -> Result<ComponentModes, HarmonicError>;

    /// Mass-proportional damping h \[1/s\] of these modes.
    fn mass_damping(&self) -> f64;

    /// Component modes that have all receptances, with the residual flexibility: the equations of many contacts are
    /// then written in few modes. None by default, and where linearised modes have a damping of their own.
    fn as_component_modes(&self) -> Option<&ComponentModes> {
        None
    }

    /// Linearised modes with a damping of their own, from the lowest on; none by default.
    fn damped_modes(&self) -> &[DampedMode] {
        &[]
    }
}
