//! One hit and its response.

use std::sync::Arc;

use super::assembly::ModalModel;
use super::simd::decimation::Decimation;
use crate::{ContactExtremes, EnergyLedger, Excitation};

/// One hit on a structure, to be simulated.
#[derive(Debug, Clone)]
pub struct HitSimulation {
    /// Structure in modes, shared by hits.
    pub model: Arc<ModalModel>,
    /// Force.
    pub excitation: Excitation,
    /// Simulated time \[s\].
    pub duration: f64,
    /// Step \[s\]; none for an automatic choice.
    pub step: Option<f64>,
}

/// The response to a hit.
#[derive(Debug, Clone, PartialEq)]
pub struct HitResponse {
    /// Step \[s\] and number of steps.
    pub step: f64,
    /// Number of steps.
    pub steps: usize,
    /// Number of modes that were integrated; the others count as flexibility.
    pub modes: usize,
    /// Displacement of the output \[m\], through the filter of `decimation`: sample j is the
    /// filter's output at step `j factor`, until the filter has run out.
    pub displacement: Vec<f64>,
    /// The filter.
    pub decimation: Arc<Decimation>,
    /// Extremes and averages at each contact, from the top down.
    pub contacts: Vec<ContactExtremes>,
    /// The energy balance.
    pub energy: EnergyLedger,
}
