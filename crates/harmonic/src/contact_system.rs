//! A linear structure with its contacts.

use std::sync::Arc;

use asperity_structure::PreloadedStructure;

use crate::{Contact, ElasticBars, Evaluation, HarmonicError, LinearSystem};

/// A linear structure and the contacts between its faces: what steady responses are those of.
#[derive(Debug, Clone)]
pub struct ContactSystem {
    linear: Arc<dyn LinearSystem>,
    contacts: Vec<Contact>,
}

impl ContactSystem {
    /// A structure with a contact at each of its interfaces.
    ///
    /// # Errors
    /// [`HarmonicError::ContactCount`] unless there is one contact per interface, and at least one;
    /// what [`LinearSystem::check`] finds.
    pub fn new(
        linear: Arc<dyn LinearSystem>,
        contacts: Vec<Contact>,
    ) -> Result<Self, HarmonicError> {
        if contacts.len() != linear.interfaces() || contacts.is_empty() {
            return Err(HarmonicError::ContactCount {
                interfaces: linear.interfaces(),
                contacts: contacts.len(),
            });
        }
        linear.check()?;
        Ok(Self { linear, contacts })
    }

    /// A preloaded stack of elastic bars.
    ///
    /// # Errors
    /// [`HarmonicError`] for a law that has no stiffness at its static pressure or cannot be
    /// tabulated.
    pub fn of_stack(
        structure: &PreloadedStructure,
        evaluation: Evaluation,
    ) -> Result<Self, HarmonicError> {
        let contacts = structure
            .contacts()
            .iter()
            .map(|contact| {
                let law = Arc::clone(contact.law());
                Contact::new(contact.name(), contact.area(), contact.pressure(), law, evaluation)
            })
            .collect::<Result<_, _>>()?;
        Self::new(
            Arc::new(ElasticBars::new(structure.stack(), structure.damping_rate())?),
            contacts,
        )
    }

    /// The linear structure.
    pub fn linear(&self) -> &dyn LinearSystem {
        &*self.linear
    }

    /// The contacts.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }
}
