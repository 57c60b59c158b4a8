//! A contact at rest.

use std::sync::Arc;

use asperity_law::{ContactDamping, ContactLaw, Friction, Pressure};

use crate::StructureError;

/// A contact in static equilibrium: area, law, damping, friction, static pressure, and what the law
/// gives there.
///
/// At the static pressure `p0` the stiffness per area is `K(p0)` (Eq. 6) and the closure
/// `d0 = d(p0)`, counted from the law's reference pressure.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_law::Constant;
/// use asperity_structure::{PreloadedContact, StructureError};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let law = Arc::new(Constant::new(8.5e11)?);
/// let contact = PreloadedContact::new("guide-sample", 1.15e-4, law, 1.4e5)?;
/// assert_eq!(contact.spring(), 1.15e-4 * 8.5e11);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct PreloadedContact {
    name: String,
    area: f64,
    law: Arc<dyn ContactLaw>,
    pressure: f64,
    stiffness: f64,
    closure: f64,
    gap: f64,
    damping: Option<ContactDamping>,
    friction: Option<Friction>,
}

impl PreloadedContact {
    /// Pressure over that at rest up to which a contact without tension is near opening.
    pub const NEAR_OPENING: f64 = 0.1;

    /// A contact of nominal `area` \[m2\] that follows `law` about the static `pressure` \[Pa\].
    ///
    /// # Errors
    /// [`StructureError::Setting`] for an area that is not positive, or a pressure that is negative
    /// or not finite; [`StructureError::NoEquilibrium`] when the law cannot carry the pressure: its
    /// closure or stiffness there is not finite, or it has no stiffness under load.
    pub fn new(
        name: &str,
        area: f64,
        law: Arc<dyn ContactLaw>,
        pressure: f64,
    ) -> Result<Self, StructureError> {
        if !(area.is_finite() && area > 0.0) {
            let (quantity, accepted) = ("contact area [m2]", "positive and finite");
            return Err(StructureError::Setting { quantity, value: area, accepted });
        }
        if !(pressure.is_finite() && (pressure >= 0.0 || law.domain().is_bilateral())) {
            let (quantity, accepted) =
                ("static pressure [Pa]", "finite, and not negative unless the law carries tension");
            return Err(StructureError::Setting { quantity, value: pressure, accepted });
        }
        let (stiffness, closure) = (law.stiffness(pressure), law.closure(pressure));
        let carried = stiffness.is_finite() && closure.is_finite();
        if !carried || (pressure > 0.0 && stiffness <= 0.0) {
            let interface = name.to_owned();
            return Err(StructureError::NoEquilibrium { interface, pressure_pa: pressure });
        }
        let name = name.to_owned();
        let (damping, friction) = (None, None);
        let gap = 0.0;
        Ok(Self { name, area, law, pressure, stiffness, closure, gap, damping, friction })
    }

    /// A contact that is open at rest: its faces are `gap` \[m\] from first contact. Pressure and stiffness
    /// are zero.
    ///
    /// # Errors
    /// [`StructureError::Setting`] for an area or a gap that is not positive;
    /// [`StructureError::NoEquilibrium`] for a law that never separates.
    pub fn open(
        name: &str,
        area: f64,
        law: Arc<dyn ContactLaw>,
        gap: f64,
    ) -> Result<Self, StructureError> {
        if !(gap.is_finite() && gap > 0.0) {
            let (quantity, accepted) = ("gap at rest [m]", "positive and finite");
            return Err(StructureError::Setting { quantity, value: gap, accepted });
        }
        let Some(lost) = law.domain().closure_lost else {
            return Err(StructureError::NoEquilibrium {
                interface: name.to_owned(),
                pressure_pa: 0.0,
            });
        };
        let touching = Self::new(name, area, law, 0.0)?;
        Ok(Self { stiffness: 0.0, closure: lost - gap, gap, ..touching })
    }

    /// True where `lowest` \[Pa\] is near opening: up to [`NEAR_OPENING`](Self::NEAR_OPENING) times the static
    /// pressure. A contact whose law never separates may be, one that carries tension never is.
    pub fn is_near_opening(&self, lowest: f64) -> bool {
        !self.law.domain().is_bilateral() && lowest <= Self::NEAR_OPENING * self.pressure
    }

    /// The contact with viscous `damping`, or with none.
    #[must_use]
    pub fn with_damping(self, damping: Option<ContactDamping>) -> Self {
        Self { damping, ..self }
    }

    /// The contact with a `friction` element across its closure, or with none.
    #[must_use]
    pub fn with_friction(self, friction: Option<Friction>) -> Self {
        Self { friction, ..self }
    }

    /// Name, for messages and outputs.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Nominal contact area S \[m2\].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The contact law.
    pub fn law(&self) -> &Arc<dyn ContactLaw> {
        &self.law
    }

    /// Static pressure p0 \[Pa\].
    pub fn pressure(&self) -> f64 {
        self.pressure
    }

    /// Contact stiffness per area at rest, K(p0) \[Pa/m\].
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Closure at rest, d(p0) \[m\], counted from the law's reference pressure.
    pub fn closure(&self) -> f64 {
        self.closure
    }

    /// Distance of the faces from first contact at rest \[m\]; zero for a closed contact.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// Pressure \[Pa\] at a closure increment from rest \[m\].
    pub fn pressure_at(&self, closure: f64) -> f64 {
        self.pressure + self.pressure_increment(closure).value
    }

    /// Pressure increment \[Pa\], and tangent \[Pa/m\], at a closure increment from rest \[m\].
    pub fn pressure_increment(&self, closure: f64) -> Pressure {
        let from_contact = closure - self.gap;
        if self.gap > 0.0 && from_contact <= 0.0 {
            return Pressure { value: 0.0, tangent: 0.0 };
        }
        self.law.pressure_increment(self.pressure, from_contact)
    }

    /// Stiffness of the contact as a linear spring, `K(p0) S` \[N/m\].
    pub fn spring(&self) -> f64 {
        self.stiffness * self.area
    }

    /// The viscous damping, if there is any.
    pub fn damping(&self) -> Option<ContactDamping> {
        self.damping
    }

    /// The friction element across the closure, if there is any. At rest it carries nothing.
    pub fn friction(&self) -> Option<Friction> {
        self.friction
    }

    /// Coefficient of the contact as a linear damper at rest, `c(p0) S` \[N s/m\].
    pub fn damper(&self) -> f64 {
        let coefficient =
            |damping: ContactDamping| damping.coefficient(self.pressure, self.stiffness);
        self.area * self.damping.map_or(0.0, coefficient)
    }
}

/// Error of the first contact that touches without stiffness at rest, if there is one.
pub(crate) fn check_springs(contacts: &[PreloadedContact]) -> Result<(), StructureError> {
    match contacts.iter().find(|contact| contact.gap() == 0.0 && contact.spring() <= 0.0) {
        None => Ok(()),
        Some(contact) => Err(StructureError::NoFrequency {
            interface: contact.name().to_owned(),
            pressure_pa: contact.pressure(),
        }),
    }
}
