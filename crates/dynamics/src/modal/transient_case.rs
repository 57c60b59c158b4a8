//! A transient case and its response.

use std::sync::Arc;

use asperity_law::CompiledLaw;

use super::assembly::{ModalModel, table_error};
use super::decimation::Decimation;
use super::step_model::InterpolationChoice;
use crate::{ContactExtremes, DynamicsError, EnergyLedger};
use asperity_structure::LoadCase;

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
}

impl CaseResponse {
    /// Largest difference \[Pa\] between the table of each contact and its law, over the pressures of
    /// the response, from samples; `model` is the model of the case.
    ///
    /// # Errors
    /// [`DynamicsError::Law`] when a law cannot be tabulated any more.
    pub fn table_errors(&self, model: &ModalModel) -> Result<Vec<f64>, DynamicsError> {
        let tabulated =
            model.prepare(self.step, &self.table_exponents, InterpolationChoice::default())?;
        let contacts = model.contacts().iter().zip(&tabulated.tables).zip(&self.contacts);
        let error = |((contact, table), seen): ((_, &Arc<CompiledLaw>), &ContactExtremes)| {
            table_error(contact, table, [seen.pressure_min, seen.pressure_max])
        };
        Ok(contacts.map(error).collect())
    }
}
