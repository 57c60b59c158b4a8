//! One transient run: equilibrium, integration, observables.

use std::time::Instant;

use asperity_dynamics::Transient;
use asperity_signal::{
    FrequencyResponse, Frf, HarmonicOptions, find_harmonics, half_power, logarithmic_decrement,
};

use crate::assemble::Assembly;
use crate::error::StudyError;
use crate::summary::{
    EnergySummary, Fundamental, InterfaceSummary, Numerics, Provenance, SUMMARY_SCHEMA,
    SecondHarmonic, StaticInterface, StaticSummary, Summary,
};
use asperity_scenario::{Document, Scenario};

/// Zero padding of the FRF that is written and drawn.
const FRF_PADDING: usize = 4;

/// Highest frequency of the FRF that is written, over the static frequency.
const FRF_RANGE: f64 = 6.0;

/// Residual of the energy balance above which a run is not to be trusted.
const SUSPECT_RESIDUAL: f64 = 1e-2;

/// A finished run.
#[derive(Debug)]
pub struct Run {
    /// What was run.
    pub assembly: Assembly,
    /// The response.
    pub transient: Transient,
    /// The answers.
    pub summary: Summary,
}

/// Carries out the run that `document` describes. `progress` hears the fraction done.
///
/// # Errors
/// [`StudyError`] when the parts cannot be built or the run fails.
pub fn simulate(
    document: &Document,
    scenario: &Scenario,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Run, StudyError> {
    let started = Instant::now();
    let assembly = Assembly::new(scenario, document.folder())?;
    let transient = integrate(&assembly, progress)?;
    let mut summary = summarise(scenario, &assembly, &transient, document.sha256())?;
    summary.numerics.wall_s = started.elapsed().as_secs_f64();
    Ok(Run { assembly, transient, summary })
}

/// Integrates an assembled scenario.
///
/// # Errors
/// [`StudyError::Dynamics`] when the integration fails.
pub fn integrate(
    assembly: &Assembly,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Transient, StudyError> {
    let Assembly { structure, excitation, sampling, method } = assembly;
    Ok(method.integrate_with_progress(structure, excitation, sampling, progress)?)
}

/// The answers of a run.
///
/// # Errors
/// [`StudyError::Signal`] when the response cannot be analysed.
pub fn summarise(
    scenario: &Scenario,
    assembly: &Assembly,
    transient: &Transient,
    scenario_sha256: String,
) -> Result<Summary, StudyError> {
    let at_rest = rest_state(assembly);
    let rate = assembly.sampling.rate();
    let mut fundamental = None;
    let mut second_harmonic = None;
    let mut harmonic_ratio = None;
    if let Some(natural) = at_rest.natural_frequency_hz
        && let Some(response) = displacement_response(transient, rate)?
    {
        let found = find_harmonics(&response, natural, &HarmonicOptions::default());
        harmonic_ratio = found.ratio();
        fundamental = found.fundamental.map(|peak| Fundamental {
            frequency_hz: peak.frequency_hz,
            receptance_m_per_n: peak.magnitude,
            damping_ratio: half_power(&response, &peak),
            damping_ratio_decrement: ring_down(assembly, transient, peak.frequency_hz),
        });
        second_harmonic = found.second.map(|peak| SecondHarmonic {
            frequency_hz: peak.frequency_hz,
            receptance_m_per_n: peak.magnitude,
        });
    }
    let energy = &transient.energy;
    let residual_relative = energy.residual_relative();
    if residual_relative > SUSPECT_RESIDUAL {
        tracing::warn!(
            residual_relative,
            "the energy balance does not close: use a smaller step or cell, or a law without a jump"
        );
    }
    Ok(Summary {
        schema: SUMMARY_SCHEMA,
        title: scenario.title.clone(),
        at_rest,
        fundamental,
        second_harmonic,
        harmonic_ratio,
        interfaces: contacts(assembly, transient),
        energy: EnergySummary {
            input_j: energy.input,
            dissipated_j: energy.dissipated,
            stored_j: energy.stored(),
            numerical_loss_j: energy.numerical_loss,
            residual_relative,
        },
        numerics: Numerics {
            method: assembly.method.name(),
            step_s: transient.step,
            steps: transient.steps,
            instructions: format!("{:?}", assembly.method.instructions()).to_lowercase(),
            wall_s: 0.0,
        },
        provenance: Provenance::new(scenario_sha256),
    })
}

/// Static pressures, stiffnesses and closures, and the natural frequency at rest.
pub fn rest_state(assembly: &Assembly) -> StaticSummary {
    let contacts = assembly.structure.contacts().iter();
    StaticSummary {
        // A rig without stiffness at rest has no natural frequency; the run goes on without it.
        natural_frequency_hz: assembly.structure.natural_frequency(),
        interfaces: contacts
            .map(|contact| StaticInterface {
                name: contact.name().to_owned(),
                pressure_pa: contact.pressure(),
                stiffness_pa_per_m: contact.stiffness(),
                closure_m: contact.closure(),
            })
            .collect(),
    }
}

/// The receptance from the top displacement, up to six times the static
/// frequency (or the whole band without one); none for a run without force.
///
/// # Errors
/// [`StudyError::Signal`] when the response cannot be analysed.
pub fn receptance(run: &Run) -> Result<Option<Frf>, StudyError> {
    let rate = run.assembly.sampling.rate();
    let Some(response) = displacement_response(&run.transient, rate)? else {
        return Ok(None);
    };
    let mut frf = response.receptance(FRF_PADDING);
    if let Some(natural) = run.summary.at_rest.natural_frequency_hz {
        let kept = frf.frequency_hz.partition_point(|&f| f <= FRF_RANGE * natural);
        frf.frequency_hz.truncate(kept);
        frf.values.truncate(kept);
    }
    Ok(Some(frf))
}

fn displacement_response(
    transient: &Transient,
    rate: f64,
) -> Result<Option<FrequencyResponse>, StudyError> {
    let history = &transient.history;
    if history.force.iter().all(|&force| force == 0.0) {
        return Ok(None);
    }
    Ok(Some(FrequencyResponse::from_displacement(&history.force, &history.displacement, rate)?))
}

/// Damping ratio of the displacement once the force has died down to a
/// thousandth, by the logarithmic decrement.
fn ring_down(assembly: &Assembly, transient: &Transient, frequency_hz: f64) -> Option<f64> {
    let history = &transient.history;
    let floor = 1e-3 * assembly.excitation.peak();
    let free = history.force.iter().rposition(|force| force.abs() > floor)? + 1;
    let decay = history.displacement.get(free..)?;
    let decrement = logarithmic_decrement(decay, assembly.sampling.rate(), frequency_hz)?;
    Some(decrement.ratio)
}

fn contacts(assembly: &Assembly, transient: &Transient) -> Vec<InterfaceSummary> {
    let interfaces = assembly.structure.contacts();
    interfaces
        .iter()
        .zip(&transient.contacts)
        .map(|(interface, record)| {
            let law = interface.law();
            if let Some((low, high)) = law.measured_range()
                && (record.pressure_min < low || record.pressure_max > high)
            {
                tracing::warn!(
                    interface = interface.name(),
                    reached_pa = ?(record.pressure_min, record.pressure_max),
                    measured_pa = ?(low, high),
                    "the run leaves the pressures at which the law was measured; the stiffness is held there"
                );
            }
            InterfaceSummary {
                name: interface.name().to_owned(),
                pressure_min_pa: record.pressure_min,
                pressure_max_pa: record.pressure_max,
                stiffness_average_pa_per_m: record.stiffness_average,
                stiffness_at_pressure_min_pa_per_m: law.stiffness(record.pressure_min),
                contact_lost_s: record.lost,
            }
        })
        .collect()
}
