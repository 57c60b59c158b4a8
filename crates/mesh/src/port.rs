//! Ports: where loads act, contacts join and sensors read.

use crate::{MeshError, Stack};

/// A unit load pattern of a [`Stack`] and, by reciprocity, the displacement average that it works on.
///
/// A force `F` at a port acts on mode n with `phi_n F`, and the displacement of the port is
/// `sum_n phi_n q_n`, with one participation `phi_n` for both. Displacements point down.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Port {
    /// A point of a bar.
    Point {
        /// Body, counted from the top.
        body: usize,
        /// Distance from its upper end \[m\], at most its length.
        position: f64,
    },
    /// A whole bar: a force spread over it by its mass, and its mean displacement.
    Mean {
        /// Body, counted from the top.
        body: usize,
    },
    /// The support; it does not move where it is rigid.
    Support,
    /// A port of component modes, by its number.
    Number(usize),
    /// The base below the support: a unit load is the inertial force `-m` of every mass under a
    /// base acceleration of 1 m/s2, so that displacements are relative to the base.
    Base,
}

impl Port {
    /// The upper end of the first body.
    pub const TOP: Self = Self::Point { body: 0, position: 0.0 };

    /// The port, if it exists on `stack`.
    ///
    /// # Errors
    /// [`MeshError::Port`] for a body that `stack` does not have, or a position that is not on it.
    pub fn check(self, stack: &Stack) -> Result<Self, MeshError> {
        if let Self::Number(number) = self {
            // A stack has places instead.
            return Err(MeshError::NoPort { port: number, ports: 0 });
        }
        let (Self::Point { body, .. } | Self::Mean { body }) = self else { return Ok(self) };
        let Some(own) = stack.bodies().get(body) else {
            return Err(MeshError::Port {
                quantity: "number of the body, from 0",
                value: body as f64,
                most: stack.bodies().len() as f64 - 1.0,
            });
        };
        match self {
            Self::Point { position, .. } if !(0.0..=own.length()).contains(&position) => {
                let (quantity, most) = ("position [m]", own.length());
                Err(MeshError::Port { quantity, value: position, most })
            }
            _ => Ok(self),
        }
    }
}

/// Two ports whose approach is a closure: of a contact, or with one port alone the displacement in a
/// contact with the ground or in a guide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PortPair {
    /// The port above, whose displacement closes the pair.
    pub upper: usize,
    /// The port below; none for the ground.
    pub lower: Option<usize>,
}

impl PortPair {
    /// The closure between two ports.
    pub fn between(upper: usize, lower: usize) -> Self {
        Self { upper, lower: Some(lower) }
    }

    /// The closure between a port and the ground: the displacement of the port.
    pub fn on_ground(port: usize) -> Self {
        Self { upper: port, lower: None }
    }

    /// The closure of displacements or participations at all ports.
    pub fn closure(self, ports: &[f64]) -> f64 {
        ports[self.upper] - self.lower.map_or(0.0, |lower| ports[lower])
    }
}
