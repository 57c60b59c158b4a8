//! Elastic bars.

use asperity_law::Friction;

use crate::BodyDamping;
use crate::error::{MeshError, positive};

/// An elastic bar in longitudinal motion: length, section, modulus, density, internal damping.
///
/// The paper's Table 2 gives a mass that differs from density times section times length (see the
/// decision record on the equivalent model): a bar built [`with_mass`](Body::with_mass) has the
/// section `A = m / (rho L)`, which keeps wave speed, mass and static pressure.
///
/// ```
/// use asperity_mesh::Body;
///
/// let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
/// assert!((guide.section() - 2.594e-3).abs() < 1e-6);
/// assert!((guide.wave_speed() - 5118.5).abs() < 0.1);
/// # Ok::<(), asperity_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    name: String,
    length: f64,
    section: f64,
    youngs_modulus: f64,
    density: f64,
    friction: Option<Friction>,
    damping: BodyDamping,
}

impl Body {
    /// A bar of `length` \[m\], `section` \[m2\], `youngs_modulus` \[Pa\] and `density` \[kg/m3\].
    ///
    /// # Errors
    /// [`MeshError::NotPositive`] for any value that is not positive and finite, or values whose mass,
    /// wave speed or stiffness is not.
    pub fn new(
        name: &str,
        length: f64,
        section: f64,
        youngs_modulus: f64,
        density: f64,
    ) -> Result<Self, MeshError> {
        let body = Self {
            name: name.to_owned(),
            length: positive(name, "length [m]", length)?,
            section: positive(name, "section [m2]", section)?,
            youngs_modulus: positive(name, "Young's modulus [Pa]", youngs_modulus)?,
            density: positive(name, "density [kg/m3]", density)?,
            friction: None,
            damping: BodyDamping::NONE,
        };
        positive(name, "mass [kg]", body.mass())?;
        positive(name, "wave speed over length [1/s]", body.wave_speed() / length)?;
        positive(name, "stiffness E A / L [N/m]", body.axial_rigidity() / length)?;
        Ok(body)
    }

    /// A bar of known `mass` \[kg\]; its section is `mass / (density length)`.
    ///
    /// # Errors
    /// [`MeshError::NotPositive`] for any value that is not positive and finite.
    pub fn with_mass(
        name: &str,
        length: f64,
        mass: f64,
        youngs_modulus: f64,
        density: f64,
    ) -> Result<Self, MeshError> {
        positive(name, "length [m]", length)?;
        positive(name, "mass [kg]", mass)?;
        positive(name, "density [kg/m3]", density)?;
        Self::new(name, length, mass / (density * length), youngs_modulus, density)
    }

    /// The bar with friction in a guide that does not move.
    ///
    /// The element lies across the mean displacement of the bar, and its force is spread evenly over
    /// the length. A coefficient is one of the force of the contact below the bar.
    #[must_use]
    pub fn with_friction(self, friction: Friction) -> Self {
        Self { friction: Some(friction), ..self }
    }

    /// The friction element between the bar and its guide, if there is any.
    pub fn friction(&self) -> Option<Friction> {
        self.friction
    }

    /// The same bar with this internal damping.
    #[must_use]
    pub fn with_damping(self, damping: BodyDamping) -> Self {
        Self { damping, ..self }
    }

    /// Internal damping.
    pub fn damping(&self) -> BodyDamping {
        self.damping
    }

    /// Name, for messages and outputs.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Length L \[m\].
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Cross-section A \[m2\].
    pub fn section(&self) -> f64 {
        self.section
    }

    /// Young's modulus E \[Pa\].
    pub fn youngs_modulus(&self) -> f64 {
        self.youngs_modulus
    }

    /// Density rho \[kg/m3\].
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Mass rho A L \[kg\].
    pub fn mass(&self) -> f64 {
        self.density * self.section * self.length
    }

    /// Longitudinal wave speed c = sqrt(E / rho) \[m/s\].
    pub fn wave_speed(&self) -> f64 {
        (self.youngs_modulus / self.density).sqrt()
    }

    /// Mechanical impedance rho c A \[N s/m\].
    pub fn impedance(&self) -> f64 {
        self.density * self.wave_speed() * self.section
    }

    /// Axial rigidity E A \[N\].
    pub fn axial_rigidity(&self) -> f64 {
        self.youngs_modulus * self.section
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 2: the guide bar's mass fixes a section of 2.594e-3 m2.
    #[test]
    fn a_given_mass_fixes_the_section() {
        let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0).unwrap();
        assert!((guide.section() - 2.594e-3).abs() < 1e-6);
        assert!((guide.mass() - 1.61).abs() < 1e-14);
        assert!((guide.wave_speed() - 5118.5).abs() < 0.1);
    }

    #[test]
    fn values_that_are_not_positive_are_errors() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Body::new("b", bad, 1.0, 1.0, 1.0).is_err());
            assert!(Body::new("b", 1.0, bad, 1.0, 1.0).is_err());
            assert!(Body::new("b", 1.0, 1.0, bad, 1.0).is_err());
            assert!(Body::new("b", 1.0, 1.0, 1.0, bad).is_err());
            assert!(Body::with_mass("b", 1.0, bad, 1.0, 1.0).is_err());
        }
    }

    /// Numbers that are positive and finite, whose products and quotients are not.
    #[test]
    fn sizes_beyond_the_range_of_numbers_are_errors() {
        let (tiny, huge) = (f64::from_bits(1), 1e300);
        for (length, section, modulus, density) in [
            (1.0, 1.0, tiny, 1e3),
            (1.0, 1.0, huge, tiny),
            (1.0, tiny, 0.1, 1.0),
            (huge, huge, 1.0, 1.0),
            (huge, 1.0, 1e-100, 1e200),
        ] {
            assert!(Body::new("b", length, section, modulus, density).is_err());
        }
        assert!(Body::with_mass("b", tiny, 1.0, 1.0, 1.0).is_err());
    }
}
