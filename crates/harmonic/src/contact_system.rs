//! A linear structure with its contacts.

use std::sync::Arc;

use asperity_mesh::Stack;

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

    /// A stack of elastic bars with mass-proportional damping of `rate` h \[1/s\], about its rest
    /// under weight.
    ///
    /// # Errors
    /// [`HarmonicError`] for a rate out of range or a law that cannot carry its static pressure or
    /// be tabulated.
    pub fn of_stack(
        stack: &Stack,
        rate: f64,
        evaluation: Evaluation,
    ) -> Result<Self, HarmonicError> {
        let contacts = stack
            .interfaces()
            .iter()
            .zip(stack.static_pressures())
            .map(|(interface, pressure)| {
                let law = Arc::clone(interface.law());
                Contact::new(interface.name(), interface.area(), pressure, law, evaluation)
            })
            .collect::<Result<_, _>>()?;
        Self::new(Arc::new(ElasticBars::new(stack, rate)?), contacts)
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
