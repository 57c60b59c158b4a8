//! A rigid mass on one contact.

use asperity_mesh::{ComponentModes, MeshError, NormalMode, PortPair, ResidualFlexibility};
use asperity_structure::StructureError;
use num_complex::Complex64;

use crate::error::{HarmonicError, not_negative, positive};
use crate::{Compliance, Dual, LinearSystem, MeanBalance, SystemPort};

/// A rigid mass under a force and on one contact, `m u'' + m h u' + P(u) = f`.
///
/// The simplest model of a rig: the guide bar is rigid, and everything below it is one contact
/// whose law holds the elastic parts in series. Closure and displacement of its one port are the same.
/// The receptance is `1 / (m (-w^2 + i w h))`.
///
/// ```
/// use asperity_harmonic::{Compliance, LinearSystem, RigidMass};
///
/// let mass = RigidMass::new(1.61, 420.0)?;
/// let mut compliance = Compliance::zero(1, 1);
/// mass.compliance((1e4, 0.0), &[0.into()], &[], &mut compliance);
/// assert!((compliance.get(1, 1).value.norm() * 1.61 * 1e8 - 1.0).abs() < 1e-3);
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

    fn check_port(&self, port: SystemPort) -> Result<(), HarmonicError> {
        match port {
            SystemPort::Number(0) => Ok(()),
            SystemPort::Number(port) => {
                Err(StructureError::from(MeshError::NoPort { port, ports: 1 }).into())
            }
            SystemPort::Stack(_) => Err(HarmonicError::ForeignPort { port }),
        }
    }

    fn compliance(
        &self,
        at: (f64, f64),
        _ports: &[SystemPort],
        springs: &[Complex64],
        into: &mut Compliance,
    ) {
        let mut stiffness = Dual::oscillator((0.0, self.mass, self.mass * self.damping_rate), at);
        stiffness.value += springs.iter().sum::<Complex64>();
        let receptance = stiffness.inverse();
        for a in 0..into.size() {
            for b in a..into.size() {
                into.set(a, b, receptance);
            }
        }
    }

    fn mean_balance(&self, ports: &[SystemPort]) -> MeanBalance {
        let (port_closure, port_force) = (vec![1.0; ports.len()], vec![0.0; ports.len()]);
        MeanBalance { closure: vec![0.0], force: vec![1.0], port_closure, port_force }
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
