//! A transient case and its response.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_law::CompiledLaw;

use super::assembly::{ModalModel, table_error};
use super::decimation::Decimation;
use crate::{ContactExtremes, DynamicsError, EnergyLedger};
use asperity_structure::{LoadCase, PreloadedContact};

/// A load on a structure, from rest, over a duration.
#[derive(Debug, Clone)]
pub struct TransientCase {
    /// Structure in modes, shared by cases.
    pub model: Arc<ModalModel>,
    /// Load, at the port that the model is loaded at.
    pub load: LoadCase,
    /// Sensor of the model that is read.
    pub sensor: usize,
    /// Simulated time \[s\].
    pub duration: f64,
    /// Step \[s\]; none for an automatic choice.
    pub step: Option<f64>,
    /// Error of a traction within a step, over the largest so far, of a case at
    /// [steps of its own](crate::Batch#steps-of-their-own); none for equal steps.
    pub tolerance: Option<f64>,
}

/// Exponents of two of the first top pressures \[Pa\] of tables above rest: three times the peak
/// over the area, times the amplification of a lasting force at resonance, or a quarter of the
/// weight, whichever is more.
pub(super) fn first_table_exponents(case: &TransientCase) -> Vec<i32> {
    let structure = case.model.preloaded();
    let radians = TAU * structure.natural_frequency().unwrap_or(0.0);
    let amplification = if case.load.ends_at() == f64::INFINITY {
        (radians / structure.damping_rate()).min(0.5 * radians * case.duration).max(1.0)
    } else {
        1.0
    };
    let force = 3.0 * case.load.peak() * amplification;
    let first = |contact: &PreloadedContact| {
        let scale = (force / contact.area()).max(0.25 * contact.pressure());
        if scale > 0.0 { scale.log2().ceil().clamp(-30.0, 60.0) as i32 } else { 0 }
    };
    case.model.contacts().iter().map(first).collect()
}

/// Pressure \[Pa\] and stiffness \[Pa/m\] at a closure increment \[m\] from rest, zero at and below
/// `open_below` \[m\].
pub(super) fn pressure_at(contact: &PreloadedContact, open_below: f64, increment: f64) -> [f64; 2] {
    if increment <= open_below {
        return [0.0; 2];
    }
    let (law, state) = (contact.law(), contact.pressure());
    let found = law.pressure_increment(state, increment);
    // Of a pressure near zero the difference would leave round-off.
    if found.value > -0.5 * state {
        [state + found.value, found.tangent]
    } else {
        let left = law.pressure(contact.closure() + increment);
        [left.value, left.tangent]
    }
}

/// The response to a transient case.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseResponse {
    /// Step \[s\] and number of steps.
    pub step: f64,
    /// Number of steps.
    pub steps: usize,
    /// Number of steps that were integrated: the laws bend so little in the motion after them that
    /// the rest is in closed form, within 1e-6 of the largest displacement.
    pub integrated_steps: usize,
    /// Number of modes that were integrated; the others count as flexibility.
    pub modes: usize,
    /// Displacement at the sensor \[m\], through the filter of `decimation`: sample j is the
    /// filter's output at step `j factor`, until the filter has run out.
    pub displacement: Vec<f64>,
    /// The last outputs before the filter \[m\], as many as the filter asks for or all, up to the last step but one.
    pub ending: Vec<f64>,
    /// The filter.
    pub decimation: Arc<Decimation>,
    /// Extremes and averages at each contact, from the top down.
    pub contacts: Vec<ContactExtremes>,
    /// The energy balance.
    pub energy: EnergyLedger,
    /// True if all modes took the mean of the contact forces at both ends of a step, since the
    /// motion under an interpolation of higher order did not stay bounded.
    pub is_of_second_order: bool,
    pub(super) table_exponents: Vec<i32>,
    pub(super) table_tolerance: f64,
}

impl CaseResponse {
    /// Largest difference \[Pa\] between the table of each contact and its law, over the pressures of
    /// the response, from samples; `model` is the model of the case.
    ///
    /// # Errors
    /// [`DynamicsError::Law`] when a law cannot be tabulated any more.
    pub fn table_errors(&self, model: &ModalModel) -> Result<Vec<f64>, DynamicsError> {
        let tables = model.tables(&self.table_exponents, self.table_tolerance)?;
        let contacts = model.contacts().iter().zip(&tables).zip(&self.contacts);
        let error = |((contact, table), seen): ((_, &Arc<CompiledLaw>), &ContactExtremes)| {
            table_error(contact, table, [seen.pressure_min, seen.pressure_max])
        };
        Ok(contacts.map(error).collect())
    }
}
