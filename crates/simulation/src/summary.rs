//! `summary.json`: the observables of one run, under the names of the contract.

use asperity_structure::SensorKind;
use serde::Serialize;

use crate::accuracy::AccuracySummary;
use crate::assemble::{Assembly, Sensor};
use crate::observables::Observables;
use crate::provenance::Provenance;
use crate::quantity::Quantity;
use crate::static_state::{StaticInterface, StaticSummary};
use crate::warning::Warning;

/// Identifier of the summary's format.
pub const SUMMARY_SCHEMA: &str = "asperity/summary/1";

/// The summary of one transient run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// [`SUMMARY_SCHEMA`].
    pub schema: &'static str,
    /// Title of the scenario.
    pub title: Option<String>,
    /// State at rest.
    #[serde(rename = "static")]
    pub at_rest: StaticSummary,
    /// Fundamental of the receptance; none without a peak.
    pub fundamental: Option<Fundamental>,
    /// Second harmonic of the receptance; none without a peak.
    pub second_harmonic: Option<SecondHarmonic>,
    /// Second-harmonic over fundamental receptance, A2/A1.
    pub harmonic_ratio: Option<f64>,
    /// Frequencies of maxima of the receptance in the windows of the fundamental and the second harmonic that are
    /// no peaks since the force is too weak there \[Hz\].
    pub masked_hz: Vec<f64>,
    /// Features at each named sensor; those at the first are also the features above.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<SensorSummary>,
    /// Extremes and averages at each interface, from the top down.
    pub interfaces: Vec<InterfaceSummary>,
    /// Energy balance.
    pub energy: EnergySummary,
    /// Estimated errors.
    pub accuracy: Option<AccuracySummary>,
    /// True if the response depends on rounding.
    pub sensitive: bool,
    /// Time from which on it does: where it and a response to a force larger by 1e-12 diverge.
    pub sensitive_from_s: Option<f64>,
    /// Warnings about the response.
    pub warnings: Vec<Warning>,
    /// Method, step and time of the computation.
    pub numerics: Numerics,
    /// Origin of the numbers.
    pub provenance: Provenance,
}

/// The fundamental.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fundamental {
    /// Frequency f1 \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude A1.
    #[serde(flatten)]
    pub amplitude: Amplitude,
    /// Half-power damping ratio; none where the peak does not fall to half power.
    pub damping_ratio: Option<f64>,
    /// Damping ratio by the logarithmic decrement of the ring-down, if it has enough cycles.
    pub damping_ratio_decrement: Option<f64>,
}

/// The second harmonic.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SecondHarmonic {
    /// Frequency f2 \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude A2.
    #[serde(flatten)]
    pub amplitude: Amplitude,
}

/// Amplitude of a frequency response.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Amplitude {
    /// Displacement per force.
    PerForce {
        /// Receptance \[m/N\].
        receptance_m_per_n: f64,
    },
    /// Displacement relative to the base per acceleration of the base.
    PerBase {
        /// Receptance \[s2\].
        receptance_s2: f64,
    },
}

impl Amplitude {
    fn new(value: f64, base: bool) -> Self {
        if base {
            Self::PerBase { receptance_s2: value }
        } else {
            Self::PerForce { receptance_m_per_n: value }
        }
    }

    /// The number \[m/N or s2\].
    pub fn value(self) -> f64 {
        match self {
            Self::PerForce { receptance_m_per_n: value }
            | Self::PerBase { receptance_s2: value } => value,
        }
    }
}

/// The features of the response at one sensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorSummary {
    /// Name of the sensor.
    pub name: String,
    /// Quantity that it reads.
    pub kind: SensorKind,
    /// Fundamental of its receptance; none without a peak.
    pub fundamental: Option<Fundamental>,
    /// Second harmonic of its receptance; none without a peak.
    pub second_harmonic: Option<SecondHarmonic>,
    /// Second-harmonic over fundamental receptance, A2/A1.
    pub harmonic_ratio: Option<f64>,
}

/// One contact during the run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterfaceSummary {
    /// Name of the interface.
    pub name: String,
    /// Lowest pressure over all steps \[Pa\].
    pub pressure_min_pa: f64,
    /// Highest pressure over all steps \[Pa\].
    pub pressure_max_pa: f64,
    /// `K_avr` of Eq. (8) over the integration steps \[Pa/m\].
    pub stiffness_average_pa_per_m: f64,
    /// Stiffness of the law at the lowest pressure \[Pa/m\].
    pub stiffness_at_pressure_min_pa_per_m: f64,
    /// Time without contact \[s\].
    pub contact_lost_s: f64,
}

/// Energy balance of the run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EnergySummary {
    /// Work of the force \[J\].
    pub input_j: f64,
    /// Loss \[J\].
    pub dissipated_j: f64,
    /// The viscous part of it in the contacts \[J\].
    pub contact_dissipated_j: f64,
    /// The part of it by friction \[J\].
    pub friction_dissipated_j: f64,
    /// Stored at the end, counted from rest \[J\].
    pub stored_j: f64,
    /// Loss of the contact scheme itself \[J\].
    pub numerical_loss_j: f64,
    /// Remainder of the balance over the input.
    pub residual_relative: f64,
}

/// Method, step and time of the computation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Numerics {
    /// Integrator.
    pub method: &'static str,
    /// Integration step \[s\].
    pub step_s: f64,
    /// Number of steps.
    pub steps: usize,
    /// Modes of each body, the rigid one included; none of finite differences.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes_per_body: Option<Vec<usize>>,
    /// Vector instructions used.
    pub instructions: String,
    /// Time the integration and analysis took \[s\].
    pub wall_s: f64,
}

impl Summary {
    /// The summary of a response with these observables.
    pub(crate) fn new<S>(
        title: Option<String>,
        assembly: &Assembly<S>,
        at_rest: StaticSummary,
        found: &Observables,
        numerics: Numerics,
        provenance: Provenance,
    ) -> Self {
        let whole = |quantity| found.get(quantity, None);
        let base = assembly.load.base().is_some();
        let at = |sensor: usize| {
            let value = |quantity| found.at(sensor, quantity);
            let peak = |frequency, receptance| {
                Some((value(frequency)?, Amplitude::new(value(receptance)?, base)))
            };
            let first = peak(Quantity::FundamentalFrequency, Quantity::FundamentalReceptance);
            let second =
                peak(Quantity::SecondHarmonicFrequency, Quantity::SecondHarmonicReceptance);
            let fundamental = first.map(|(frequency_hz, amplitude)| Fundamental {
                frequency_hz,
                amplitude,
                damping_ratio: value(Quantity::DampingRatio),
                damping_ratio_decrement: value(Quantity::DampingRatioDecrement),
            });
            let second_harmonic =
                second.map(|(frequency_hz, amplitude)| SecondHarmonic { frequency_hz, amplitude });
            (fundamental, second_harmonic, value(Quantity::HarmonicRatio))
        };
        let sensor = |(number, sensor): (usize, &Sensor)| {
            let (fundamental, second_harmonic, harmonic_ratio) = at(number);
            let (name, kind) = (sensor.name.clone()?, sensor.kind);
            Some(SensorSummary { name, kind, fundamental, second_harmonic, harmonic_ratio })
        };
        let (fundamental, second_harmonic, harmonic_ratio) = at(0);
        let number = |quantity, interface| found.get(quantity, interface).unwrap_or(f64::NAN);
        let interface = |(at, state): (usize, &StaticInterface)| {
            let number = |quantity| number(quantity, Some(at));
            InterfaceSummary {
                name: state.name.clone(),
                pressure_min_pa: number(Quantity::PressureMin),
                pressure_max_pa: number(Quantity::PressureMax),
                stiffness_average_pa_per_m: number(Quantity::StiffnessAverage),
                stiffness_at_pressure_min_pa_per_m: number(Quantity::StiffnessAtPressureMin),
                contact_lost_s: number(Quantity::ContactLost),
            }
        };
        let names: Vec<&str> = at_rest.interfaces.iter().map(|one| one.name.as_str()).collect();
        let accuracy = found.estimate().map(|estimate| estimate.summary(&names));
        let sensitive_from_s = whole(Quantity::SensitiveFrom);
        Self {
            schema: SUMMARY_SCHEMA,
            title,
            fundamental,
            second_harmonic,
            harmonic_ratio,
            masked_hz: found.masked_hz.to_vec(),
            sensors: assembly.sensors.iter().enumerate().filter_map(sensor).collect(),
            interfaces: at_rest.interfaces.iter().enumerate().map(interface).collect(),
            at_rest,
            energy: EnergySummary {
                input_j: number(Quantity::EnergyInput, None),
                dissipated_j: number(Quantity::EnergyDissipated, None),
                contact_dissipated_j: number(Quantity::EnergyContactDissipated, None),
                friction_dissipated_j: number(Quantity::EnergyFrictionDissipated, None),
                stored_j: number(Quantity::EnergyStored, None),
                numerical_loss_j: number(Quantity::EnergyNumericalLoss, None),
                residual_relative: number(Quantity::EnergyResidual, None),
            },
            accuracy,
            sensitive: sensitive_from_s.is_some(),
            sensitive_from_s,
            warnings: found.warnings.clone(),
            numerics,
            provenance,
        }
    }
}
