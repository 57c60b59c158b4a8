//! The parts of a response that its quantities are read from.

use asperity_dynamics::{ContactExtremes, ContactMeasures, EnergyLedger};
use asperity_signal::{FrequencyResponse, ReceptanceFeatures, SignalError};
use asperity_structure::PreloadedContact;

use crate::static_state::StaticSummary;
use crate::warning::{MOST_RESIDUAL, Warning};

/// Force over its peak up to which the decay of a response counts as free.
const FREE: f64 = 1e-3;

/// The parts of a response that its quantities are read from.
#[derive(Debug)]
pub(crate) struct ResponseParts<'a> {
    pub(crate) at_rest: &'a StaticSummary,
    pub(crate) interfaces: &'a [PreloadedContact],
    pub(crate) peaks: PeakValues,
    pub(crate) contacts: Vec<ContactMeasures>,
    /// Time without contact at each interface \[s\]; empty where it is not counted.
    pub(crate) contact_lost: Vec<f64>,
    /// The energy balance, if there is one.
    pub(crate) energy: Option<EnergyLedger>,
    /// Integration step \[s\].
    pub(crate) step: f64,
    pub(crate) steps: usize,
}

impl<'a> ResponseParts<'a> {
    /// The parts of a response of which integrators have recorded `records` at `interfaces`.
    pub(crate) fn new(
        at_rest: &'a StaticSummary,
        interfaces: &'a [PreloadedContact],
        features: &ReceptanceFeatures,
        records: &[ContactExtremes],
        energy: EnergyLedger,
        (step, steps): (f64, usize),
    ) -> Self {
        let measures = |(interface, record): (&PreloadedContact, &ContactExtremes)| {
            let law = interface.law();
            ContactMeasures {
                pressure_min: record.pressure_min,
                pressure_max: record.pressure_max,
                stiffness_average: record.stiffness_average,
                stiffness_at_pressure_min: law.stiffness(record.pressure_min),
            }
        };
        Self {
            at_rest,
            interfaces,
            peaks: PeakValues::of(features),
            contacts: interfaces.iter().zip(records).map(measures).collect(),
            contact_lost: records.iter().map(|record| record.lost).collect(),
            energy: Some(energy),
            step,
            steps,
        }
    }

    /// Warnings about the response.
    pub(crate) fn warnings(&self) -> Vec<Warning> {
        let pairs = self.interfaces.iter().zip(&self.contacts);
        let outside = pairs.filter_map(|(interface, measures)| {
            let ContactMeasures { pressure_min, pressure_max, .. } = *measures;
            Warning::outside_measured_range(interface, pressure_min, pressure_max)
        });
        let residual = self.energy.map(|energy| energy.residual_relative());
        let suspect = residual.filter(|residual| *residual > MOST_RESIDUAL);
        let balance = suspect.map(|residual_relative| Warning::EnergyBalance { residual_relative });
        outside.chain(balance).collect()
    }
}

/// Numbers of the receptance peaks and the decay, or their derivatives with respect to a parameter;
/// none where the response has no such peak.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PeakValues {
    /// f1 \[Hz\] and A1 \[m/N\].
    pub(crate) fundamental: Option<(f64, f64)>,
    /// f2 \[Hz\] and A2 \[m/N\].
    pub(crate) second: Option<(f64, f64)>,
    /// A2/A1.
    pub(crate) ratio: Option<f64>,
    /// Half-power damping ratio of the fundamental.
    pub(crate) damping_ratio: Option<f64>,
    /// Damping ratio by the logarithmic decrement.
    pub(crate) damping_ratio_decrement: Option<f64>,
}

impl PeakValues {
    pub(crate) fn of(features: &ReceptanceFeatures) -> Self {
        let harmonics = &features.harmonics;
        Self {
            fundamental: harmonics.fundamental.map(|peak| (peak.frequency_hz, peak.magnitude)),
            second: harmonics.second.map(|peak| (peak.frequency_hz, peak.magnitude)),
            ratio: harmonics.ratio(),
            damping_ratio: features.damping_ratio(),
            damping_ratio_decrement: features.damping_ratio_decrement,
        }
    }
}

/// First sample after which no force exceeds a thousandth of `peak`.
pub fn free_from(force: &[f64], peak: f64) -> usize {
    force.iter().rposition(|force| force.abs() > FREE * peak).map_or(0, |last| last + 1)
}

/// Frequency response of samples at `rate` \[Hz\]: force \[N\] to displacement \[m\]; none without
/// a force.
pub(crate) fn frequency_response(
    force: &[f64],
    displacement: &[f64],
    rate: f64,
) -> Result<Option<FrequencyResponse>, SignalError> {
    if force.iter().all(|&force| force == 0.0) {
        return Ok(None);
    }
    FrequencyResponse::from_displacement(force, displacement, rate).map(Some)
}
