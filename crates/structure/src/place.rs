//! Places of a stack as documents give them.

use asperity_mesh::{Body, Port};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::StructureError;

/// Place on a body: one of its ends, or a distance from its upper end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "PlaceKeys", into = "PlaceKeys")]
pub struct PlaceSpec {
    /// Name of the body.
    pub body: String,
    /// Place along it.
    pub along: Along,
}

/// Place along a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along {
    /// Its upper or lower end.
    End(End),
    /// Distance from its upper end \[m\].
    PositionM(f64),
    /// A node of a body of finite elements, in a direction.
    Node {
        /// Number of the node.
        node: i64,
        /// Direction along the axes; its length does not count.
        direction: [f64; 3],
    },
    /// A response of a reduced model: a row of its `R`, from 0.
    Response(usize),
}

/// End of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// Upper end.
    Upper,
    /// Lower end, next to the interface below the body.
    Lower,
}

/// Place on a body: of a bar with exactly one of `position_m` and `end`, of a body of matrices with `node` and
/// `direction`, of a reduced model with `response`.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "PlaceSpec",
    extend("oneOf" = [
        {"required": ["position_m"]},
        {"required": ["end"]},
        {"required": ["node", "direction"]},
        {"required": ["response"]}
    ])
)]
struct PlaceKeys {
    /// Name of the body.
    #[schemars(length(min = 1))]
    body: String,
    /// Distance from the upper end of the body in m, at most its length; give this or `end`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    position_m: Option<f64>,
    /// End of the body; give this or `position_m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    end: Option<End>,
    /// Node of a body of matrices, with `direction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    node: Option<i64>,
    /// Direction of the force or the reading at `node`, along x, y and z; its length does not count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    direction: Option<[f64; 3]>,
    /// Response of a reduced model: a row of its array R, from 0. A force there acts by the same row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    response: Option<usize>,
}

impl TryFrom<PlaceKeys> for PlaceSpec {
    type Error = &'static str;

    fn try_from(keys: PlaceKeys) -> Result<Self, Self::Error> {
        let PlaceKeys { position_m, end, node, direction, response, .. } = keys;
        let along = match (position_m, end, node, direction, response) {
            (Some(position), None, None, None, None) => Along::PositionM(position),
            (None, Some(end), None, None, None) => Along::End(end),
            (None, None, Some(node), Some(direction), None) => Along::Node { node, direction },
            (None, None, None, None, Some(response)) => Along::Response(response),
            _ => {
                return Err(
                    "a place needs exactly one of position_m, end, node with direction, and response",
                );
            }
        };
        Ok(Self { body: keys.body, along })
    }
}

impl From<PlaceSpec> for PlaceKeys {
    fn from(place: PlaceSpec) -> Self {
        let keys = Self {
            body: place.body,
            position_m: None,
            end: None,
            node: None,
            direction: None,
            response: None,
        };
        match place.along {
            Along::PositionM(position) => Self { position_m: Some(position), ..keys },
            Along::End(end) => Self { end: Some(end), ..keys },
            Along::Node { node, direction } => {
                Self { node: Some(node), direction: Some(direction), ..keys }
            }
            Along::Response(response) => Self { response: Some(response), ..keys },
        }
    }
}

impl PlaceSpec {
    /// The port of this place on a stack of `bodies`.
    ///
    /// # Errors
    /// [`StructureError::UnknownBody`] for a name that no body has; [`StructureError::Setting`] for a
    /// position that is not on the body.
    pub fn port(&self, bodies: &[Body]) -> Result<Port, StructureError> {
        let found = bodies.iter().enumerate().find(|(_, body)| body.name() == self.body);
        let Some((body, own)) = found else {
            let known: Vec<&str> = bodies.iter().map(Body::name).collect();
            let (body, known) = (self.body.clone(), known.join(", "));
            return Err(StructureError::UnknownBody { body, known });
        };
        let position = match self.along {
            Along::End(End::Upper) => 0.0,
            Along::End(End::Lower) => own.length(),
            Along::PositionM(value) if (0.0..=own.length()).contains(&value) => value,
            Along::Node { node, .. } => {
                let (quantity, value) = ("node of a bar", node as f64);
                let accepted = "position_m or end; bodies of matrices have nodes";
                return Err(StructureError::Setting { quantity, value, accepted });
            }
            Along::Response(value) => {
                let (quantity, value) = ("response of a bar", value as f64);
                let accepted = "position_m or end; reduced models have responses";
                return Err(StructureError::Setting { quantity, value, accepted });
            }
            Along::PositionM(value) => {
                let (quantity, accepted) = ("position [m]", "0 to the length of the body");
                return Err(StructureError::Setting { quantity, value, accepted });
            }
        };
        Ok(Port::Point { body, position })
    }
}

/// Sensor: a place and what is read there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorSpec {
    /// Name of the sensor, used in the headers of the results.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Place of the sensor; the top of the stack when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<PlaceSpec>,
    /// Quantity that it reads.
    pub kind: SensorKind,
}

/// Quantity that a sensor reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SensorKind {
    /// Displacement in m.
    Displacement,
    /// Velocity in m/s.
    Velocity,
    /// Acceleration in m/s².
    Acceleration,
}

impl SensorKind {
    /// Name of the quantity with its unit, as headers have it.
    pub fn column(self) -> &'static str {
        match self {
            Self::Displacement => "displacement_m",
            Self::Velocity => "velocity_m_per_s",
            Self::Acceleration => "acceleration_m_per_s2",
        }
    }
}
