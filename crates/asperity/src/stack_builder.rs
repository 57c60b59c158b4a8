//! A stack of bodies, built from the top down.

use std::sync::Arc;

use asperity_law::ContactLaw;
use asperity_mesh::{Body, Interface, MeshError, Stack, Support};
use asperity_structure::{Damping, PreloadedStructure, StructureError};

/// Standard gravity, rounded as the paper does \[m/s2\].
const GRAVITY: f64 = 9.81;

/// Builder of a [`Stack`]: bodies and the interfaces below them, from the top down.
///
/// The support is rigid and gravity 9.81 m/s² unless given.
///
/// ```
/// use asperity::prelude::*;
///
/// let structure = StackBuilder::new()
///     .body(Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0)?)
///     .interface("guide-disc", 1.15e-4, Constant::new(8.5e11)?)
///     .preloaded(Damping::Ratio(0.035))?;
/// let pressure = structure.contacts()[0].pressure();
/// assert!((pressure - 1.61 * 9.81 / 1.15e-4).abs() < 1e-6 * pressure);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct StackBuilder {
    bodies: Vec<Body>,
    interfaces: Vec<Result<Interface, MeshError>>,
    support: Support,
    gravity: f64,
}

impl Default for StackBuilder {
    fn default() -> Self {
        Self {
            bodies: Vec::new(),
            interfaces: Vec::new(),
            support: Support::Rigid,
            gravity: GRAVITY,
        }
    }
}

impl StackBuilder {
    /// A stack without bodies.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a body below the last interface.
    #[must_use]
    pub fn body(mut self, body: Body) -> Self {
        self.bodies.push(body);
        self
    }

    /// Adds an interface of `area` \[m2\] with `law` below the last body.
    #[must_use]
    pub fn interface(mut self, name: &str, area: f64, law: impl ContactLaw + 'static) -> Self {
        self.interfaces.push(Interface::new(name, area, Arc::new(law)));
        self
    }

    /// Sets the support under the last interface.
    #[must_use]
    pub fn support(mut self, support: Support) -> Self {
        self.support = support;
        self
    }

    /// Sets the acceleration of gravity \[m/s2\].
    #[must_use]
    pub fn gravity(mut self, gravity: f64) -> Self {
        self.gravity = gravity;
        self
    }

    /// The stack.
    ///
    /// # Errors
    /// [`MeshError`] for an area or gravity out of range, or unless there is one interface below
    /// each body.
    pub fn build(self) -> Result<Stack, MeshError> {
        let interfaces = self.interfaces.into_iter().collect::<Result<_, _>>()?;
        Stack::new(self.bodies, interfaces, self.support, self.gravity)
    }

    /// The stack at static equilibrium under its weight, with its damping.
    ///
    /// # Errors
    /// As [`build`](Self::build) and [`PreloadedStructure::new`].
    pub fn preloaded(self, damping: Damping) -> Result<PreloadedStructure, StructureError> {
        PreloadedStructure::new(self.build()?, damping)
    }
}
