//! Elastic bodies of the stack.

use asperity_law::FrictionSpec;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Elastic body of the stack: a uniform bar moving along its axis.
///
/// In JSON the section is given by exactly one of `area_m2` and `mass_kg`.
///
/// ```
/// use asperity_scenario::{BodySpec, SectionSpec};
///
/// let bar = BodySpec {
///     name: "bar".to_owned(),
///     length_m: 0.1,
///     section: SectionSpec::AreaM2(1e-4),
///     youngs_modulus_pa: 71e9,
///     density_kg_per_m3: 2700.0,
///     friction: None,
/// };
/// assert_eq!(serde_json::to_value(&bar)?["area_m2"], 1e-4);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "BodyKeys", into = "BodyKeys")]
pub struct BodySpec {
    /// Name of the body.
    pub name: String,
    /// Length along the stack in m.
    pub length_m: f64,
    /// Cross-section.
    pub section: SectionSpec,
    /// Young's modulus in Pa.
    pub youngs_modulus_pa: f64,
    /// Density in kg/m³.
    pub density_kg_per_m3: f64,
    /// Friction between the body and a guide that does not move; none when left out.
    pub friction: Option<FrictionSpec>,
}

/// Cross-section of a body, by its area or by the mass of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SectionSpec {
    /// Area of the cross-section in m².
    AreaM2(f64),
    /// Mass of the whole body in kg; the area follows as mass / (density length).
    MassKg(f64),
}

/// Elastic body of the stack: a uniform bar moving along its axis, with exactly one of `area_m2`
/// and `mass_kg`.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "BodySpec",
    extend("oneOf" = [{"required": ["area_m2"]}, {"required": ["mass_kg"]}])
)]
struct BodyKeys {
    /// Name of the body.
    #[schemars(length(min = 1))]
    name: String,
    /// Length along the stack in m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    length_m: f64,
    /// Area of the cross-section in m²; give this or `mass_kg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    area_m2: Option<f64>,
    /// Mass of the body in kg, with the area mass / (density length); give this or `area_m2`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    mass_kg: Option<f64>,
    /// Young's modulus in Pa.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    youngs_modulus_pa: f64,
    /// Density in kg/m³.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    density_kg_per_m3: f64,
    /// Friction between the body and a guide that does not move, against the mean displacement of the
    /// body and spread evenly over its length; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    friction: Option<FrictionSpec>,
}

impl TryFrom<BodyKeys> for BodySpec {
    type Error = &'static str;

    fn try_from(keys: BodyKeys) -> Result<Self, Self::Error> {
        let section = match (keys.area_m2, keys.mass_kg) {
            (Some(area), None) => SectionSpec::AreaM2(area),
            (None, Some(mass)) => SectionSpec::MassKg(mass),
            _ => return Err("a body needs exactly one of area_m2 and mass_kg"),
        };
        Ok(Self {
            name: keys.name,
            length_m: keys.length_m,
            section,
            youngs_modulus_pa: keys.youngs_modulus_pa,
            density_kg_per_m3: keys.density_kg_per_m3,
            friction: keys.friction,
        })
    }
}

impl From<BodySpec> for BodyKeys {
    fn from(body: BodySpec) -> Self {
        let (area_m2, mass_kg) = match body.section {
            SectionSpec::AreaM2(area) => (Some(area), None),
            SectionSpec::MassKg(mass) => (None, Some(mass)),
        };
        Self {
            name: body.name,
            length_m: body.length_m,
            area_m2,
            mass_kg,
            youngs_modulus_pa: body.youngs_modulus_pa,
            density_kg_per_m3: body.density_kg_per_m3,
            friction: body.friction,
        }
    }
}
