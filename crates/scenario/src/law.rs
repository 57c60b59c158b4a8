//! Contact laws in a scenario.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::de::{Deserializer, Error};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Contact law: stiffness per area K as a function of the contact pressure p.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum LawSpec {
    /// Linear spring, K(p) = K0.
    Constant {
        /// Stiffness K0 in Pa/m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        stiffness_pa_per_m: f64,
        /// Contact opens at zero pressure instead of carrying tension.
        #[serde(default)]
        unilateral: bool,
    },
    /// Power law K(p) = C p^m (Eq. 7 of the paper).
    Power {
        /// Coefficient C in Pa^(1-m)/m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        coefficient: f64,
        /// Exponent m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        exponent: f64,
    },
    /// Power law C p^m above the transition pressure, a smooth monotone curve through the knots
    /// below it.
    ModifiedPower {
        /// Coefficient C in Pa^(1-m)/m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        coefficient: f64,
        /// Exponent m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        exponent: f64,
        /// Transition pressure in Pa, above which the power law holds.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        transition_pa: f64,
        /// Pairs [pressure in Pa, stiffness in Pa/m] below the transition, the first at zero
        /// pressure, pressures and stiffnesses increasing.
        #[schemars(length(min = 1))]
        knots: Vec<[f64; 2]>,
    },
    /// Exponential law K(p) = p / u0, which never separates (Persson).
    Exponential {
        /// Length u0 in m over which the pressure grows by a factor e.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        length_m: f64,
    },
    /// Hyperbolic law K(p) = K0 (1 + p / (K0 dm))^2 (Bandis and Barton).
    Hyperbolic {
        /// Stiffness K0 in Pa/m at zero pressure.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        stiffness_pa_per_m: f64,
        /// Largest closure dm in m, approached at infinite pressure.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        closure_limit_m: f64,
    },
    /// Hertzian contact of spherical summits whose heights are normally distributed (Greenwood and
    /// Williamson), which never separates.
    GreenwoodWilliamson {
        /// Number of summits per area in 1/m2.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        summit_density_per_m2: f64,
        /// Radius of the summits in m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        summit_radius_m: f64,
        /// Standard deviation of the heights of the summits in m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        summit_height_rms_m: f64,
        /// Contact modulus E* in Pa, `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        contact_modulus_pa: f64,
    },
    /// Elastic contact of a self-affine surface (Persson), K(p) = p / u0 at low pressures, which never
    /// separates.
    Persson {
        /// Root mean square height in m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        height_rms_m: f64,
        /// Hurst exponent, above 0 and at most 1.
        #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
        hurst_exponent: f64,
        /// Smallest wavevector of the roughness in rad/m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        roll_off_per_m: f64,
        /// Largest wavevector of the roughness in rad/m, above the smallest.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        cut_off_per_m: f64,
        /// Contact modulus E* in Pa, `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        contact_modulus_pa: f64,
    },
    /// Smooth monotone curve through measured points, constant outside them.
    Table {
        /// Pairs [pressure in Pa, stiffness in Pa/m], pressures increasing.
        #[schemars(length(min = 2))]
        points: Vec<[f64; 2]>,
    },
    /// Laws in series, with an elastic layer if one is given: `1/K = sum 1/K_law + 1/K_layer`; exactly
    /// one of law and laws.
    #[schemars(extend("oneOf" = [{"required": ["law"]}, {"required": ["laws"]}]))]
    InSeries {
        /// The one law in series with a layer: a name from "laws", or a law written in place; give
        /// this or laws.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "LawRef")]
        law: Option<LawRef>,
        /// Two or more laws, of contacts that carry the same pressure; give this or law.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[schemars(length(min = 2))]
        laws: Vec<LawRef>,
        /// Stiffness `K_layer` of the elastic layer in Pa/m; without it the laws alone are in series.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        stiffness_pa_per_m: Option<f64>,
    },
}

impl LawSpec {
    /// `law` in series with an elastic layer of this stiffness \[Pa/m\].
    pub fn with_layer(law: LawRef, stiffness_pa_per_m: f64) -> Self {
        Self::InSeries {
            law: Some(law),
            laws: Vec::new(),
            stiffness_pa_per_m: Some(stiffness_pa_per_m),
        }
    }

    /// The laws that this one has in series; none for a law of its own.
    pub fn inner_laws(&self) -> impl Iterator<Item = &LawRef> {
        let (law, laws) = match self {
            Self::InSeries { law, laws, .. } => (law.as_ref(), &laws[..]),
            _ => (None, &[][..]),
        };
        law.into_iter().chain(laws)
    }
}

/// Contact law, by its name in "laws" or written in place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum LawRef {
    /// Name of a law in "laws".
    Named(String),
    /// Law written in place.
    InPlace(Box<LawSpec>),
}

/// Contact laws by name, in the order of the scenario.
#[derive(Debug, Clone, PartialEq, Default, JsonSchema)]
#[schemars(transparent, description = "Contact laws by name.")]
pub struct Laws {
    #[schemars(with = "BTreeMap<String, LawSpec>")]
    entries: Vec<(String, LawSpec)>,
}

impl Laws {
    /// True without any law.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Number of laws.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Law of that name.
    pub fn get(&self, name: &str) -> Option<&LawSpec> {
        let entry = self.entries.iter().find(|(known, _)| known == name);
        entry.map(|(_, law)| law)
    }

    /// Names and laws, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &LawSpec)> {
        self.entries.iter().map(|(name, law)| (name.as_str(), law))
    }

    /// Names, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|(name, _)| name.as_str())
    }

    /// Adds a law, or replaces the law of that name and returns it.
    pub fn insert(&mut self, name: impl Into<String>, law: LawSpec) -> Option<LawSpec> {
        let name = name.into();
        if let Some((_, old)) = self.entries.iter_mut().find(|(known, _)| *known == name) {
            Some(std::mem::replace(old, law))
        } else {
            self.entries.push((name, law));
            None
        }
    }

    /// Law that a reference stands for; `None` for a name that is not among these.
    ///
    /// The inner references of laws in series are resolved in the same way.
    pub fn resolve<'a>(&'a self, reference: &'a LawRef) -> Option<&'a LawSpec> {
        match reference {
            LawRef::Named(name) => self.get(name),
            LawRef::InPlace(law) => Some(law),
        }
    }
}

impl FromIterator<(String, LawSpec)> for Laws {
    fn from_iter<I: IntoIterator<Item = (String, LawSpec)>>(pairs: I) -> Self {
        let mut laws = Self::default();
        for (name, law) in pairs {
            laws.insert(name, law);
        }
        laws
    }
}

impl Serialize for Laws {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de> Deserialize<'de> for Laws {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let laws = Map::<String, Value>::deserialize(deserializer)?.into_iter();
        laws.map(|(name, law)| Ok((name, serde_json::from_value(law).map_err(Error::custom)?)))
            .collect()
    }
}
