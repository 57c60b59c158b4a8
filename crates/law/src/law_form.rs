//! The trait of the document forms of laws.

use std::sync::Arc;

use crate::contact_law::ContactLaw;
use crate::draw::Draw;
use crate::error::LawError;

/// The document form of one kind of law: its keys, which state their bounds in the schema.
pub trait LawForm {
    /// Faults that the bounds of single keys do not state, found by the checks of the law's constructor.
    fn faults(&self) -> Box<dyn Iterator<Item = LawFault> + '_> {
        Box::new(std::iter::empty())
    }

    /// Highest pressure \[Pa\] that a table of the law is to show; 0 for a law without a pressure of its
    /// own.
    fn highest_pressure(&self) -> f64 {
        0.0
    }

    /// Builds the law. A law that never separates counts its closure from `static_pressure` \[Pa\].
    ///
    /// # Errors
    /// [`LawError`] for values out of range, or a law that never separates without a pressure to hold
    /// it closed.
    fn build(&self, static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError>;

    /// A random law of this kind with about `stiffness` \[Pa/m\] at `pressure` \[Pa\], both positive.
    fn sample(draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> Self
    where
        Self: Sized;
}

/// A fault of the document form of a law.
#[derive(Debug, Clone, PartialEq)]
pub struct LawFault {
    /// JSON Pointer from the law to the value; empty for the law itself.
    pub pointer: String,
    /// The fault.
    pub error: LawError,
    /// Accepted values, in words.
    pub accepted: &'static str,
}

impl LawFault {
    /// The fault of a `checked` value, if it has one, at the `pointer`.
    pub(crate) fn of<T>(
        checked: Result<T, LawError>,
        pointer: impl FnOnce() -> String,
        accepted: &'static str,
    ) -> Option<Self> {
        let error = checked.err()?;
        Some(Self { pointer: pointer(), error, accepted })
    }

    /// `Err` with the first of the faults.
    pub(crate) fn first(mut faults: impl Iterator<Item = Self>) -> Result<(), LawError> {
        faults.next().map_or(Ok(()), |fault| Err(fault.error))
    }
}
