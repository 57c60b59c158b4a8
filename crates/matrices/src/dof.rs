//! A degree of freedom of a mesh: a node and a direction.

use std::fmt;

/// A degree of freedom of a mesh: the motion of a node in a direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dof {
    /// Number of the node. Finite-element programs give internal nodes numbers below 1, or numbers that
    /// the mesh does not have.
    pub node: i64,
    /// Direction: 1, 2, 3 are displacements along x, y, z; 4, 5, 6 are rotations about them.
    pub direction: u8,
}

impl Dof {
    /// The degree of freedom of `node` in `direction`, 1 to 6.
    pub fn new(node: i64, direction: u8) -> Self {
        Self { node, direction }
    }

    /// True for a rotation.
    pub fn is_rotation(self) -> bool {
        self.direction > 3
    }

    /// The degree of freedom of two whole numbers; none if the direction is not between 1 and 6. An internal
    /// node, with a number below 1, may have any direction from 1 to 255.
    pub(crate) fn of_numbers(node: i64, direction: i64) -> Option<Self> {
        let most = if node < 1 { i64::from(u8::MAX) } else { 6 };
        let direction = u8::try_from(direction).ok().filter(|_| (1..=most).contains(&direction))?;
        Some(Self { node, direction })
    }
}

impl From<(i64, u8)> for Dof {
    fn from((node, direction): (i64, u8)) -> Self {
        Self { node, direction }
    }
}

impl fmt::Display for Dof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "node {} direction {}", self.node, self.direction)
    }
}
