//! Guides with friction.

use asperity_law::Friction;

/// A guide that does not move, with friction against a displacement of the structure.
///
/// ```
/// use asperity_law::Friction;
/// use asperity_structure::Guide;
///
/// let guide = Guide::new("guide bar", Friction::coefficient(1e7, 0.02)?, 0);
/// assert_eq!(guide.contact(), 0);
/// # Ok::<(), asperity_law::LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    name: String,
    friction: Friction,
    contact: usize,
}

impl Guide {
    /// A guide; a coefficient of friction is one of the force of `contact`, counted from zero.
    pub fn new(name: &str, friction: Friction, contact: usize) -> Self {
        Self { name: name.to_owned(), friction, contact }
    }

    /// Name, for messages: that of the guided body.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The friction element.
    pub fn friction(&self) -> Friction {
        self.friction
    }

    /// The contact whose force a coefficient is of.
    pub fn contact(&self) -> usize {
        self.contact
    }
}
