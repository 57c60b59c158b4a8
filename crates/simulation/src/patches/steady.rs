//! Steady responses of structures with contact patches: by harmonic balance, checked by time integration.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use asperity_dynamics::{DynamicsError, ManyContacts, Sampling};
use asperity_harmonic::{
    ContactSystem, LawEvaluation, PeriodicResponse, PressureRange, SystemPort,
};
use asperity_structure::{LoadCase, PreloadedContact, SteppedSine, TimeFunction};
use asperity_table::DataTable;

use super::recording::Recording;
use super::structure::PatchStructure;
use super::system::system;
use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::steady::{
    SAMPLES, SequenceRunner, Shaken, Steady, TimeCheck, TimeSweep, TimeSweepRequest,
    periods_to_decay_at, settled_by, sweeps_by,
};

/// Steps in the period of the lowest natural frequency at least, and between samples of a check.
const STEPS_IN_PERIOD: f64 = 200.0;
const LEAST_PARTS: usize = 2;

/// The method's error falls with the square of the step.
const ORDER: i32 = 2;

/// Modes among which the one that decays most slowly is sought.
const SLOW_MODES: usize = 20;

impl Shaken for PatchStructure {
    fn contact_system(
        assembly: &Assembly<Self>,
        evaluation: LawEvaluation,
    ) -> Result<ContactSystem, SimulationError> {
        let Self { structure, load, sensors, .. } = &assembly.structure;
        let system = ContactSystem::of_structure(&**structure, evaluation)?;
        let sensors: Vec<SystemPort> = sensors.iter().copied().map(SystemPort::Number).collect();
        Ok(system.with_ports(SystemPort::Number(*load), &sensors)?)
    }

    fn cells(&self) -> Vec<Range<usize>> {
        self.patches.iter().map(|patch| patch.cells.clone()).collect()
    }

    fn natural_frequency_hz(&self) -> Option<f64> {
        self.structure.natural_frequency()
    }

    fn time_check(
        assembly: &Assembly<Self>,
        response: &PeriodicResponse,
    ) -> Result<TimeCheck, SimulationError> {
        let frequency = response.frequency_hz();
        let integration = Integration::new(assembly, frequency)?;
        let parts = integration.parts();
        let periods = periods_to_decay_at(integration.decay_rate(), frequency);
        let settled = |parts: usize| {
            let integrate = |load: &LoadCase, sampling: &Sampling| {
                integration.system.integrate(load, sampling, parts)
            };
            let shaker = (response.force, frequency);
            settled_by(integrate, assembly.load.port(), shaker, periods)
        };
        Ok(TimeCheck::between(response, [settled(parts)?, settled(2 * parts)?], ORDER))
    }

    fn time_sweeps(
        assembly: &Assembly<Self>,
        amplitudes: &[f64],
        range: (f64, f64),
        request: TimeSweepRequest,
    ) -> Result<Vec<TimeSweep>, SimulationError> {
        let integration = Integration::new(assembly, range.0.max(range.1))?;
        Ok(sweeps_by(&integration, amplitudes, range, request)?)
    }
}

/// Time integration of a shaken structure.
struct Integration<'a> {
    assembly: &'a Assembly<PatchStructure>,
    system: ManyContacts,
    /// Rate of the samples \[Hz\].
    sample_rate: f64,
}

impl<'a> Integration<'a> {
    /// The integration under forces up to the frequency `highest` \[Hz\].
    fn new(assembly: &'a Assembly<PatchStructure>, highest: f64) -> Result<Self, SimulationError> {
        let system =
            system(assembly, Arc::clone(&assembly.structure.structure), &Recording::default())?;
        Ok(Self { assembly, system, sample_rate: SAMPLES as f64 * highest })
    }

    /// Steps between samples.
    fn parts(&self) -> usize {
        let natural = self.assembly.structure.structure.natural_frequency().unwrap_or(0.0);
        ((STEPS_IN_PERIOD * natural / self.sample_rate).ceil() as usize).max(LEAST_PARTS)
    }
}

impl SequenceRunner for Integration<'_> {
    fn decay_rate(&self) -> f64 {
        let modes = self.assembly.structure.structure.port_modes(SLOW_MODES);
        let rates = modes.iter().flatten().filter(|mode| mode.frequency_hz > 0.0);
        rates.map(|mode| TAU * mode.frequency_hz * mode.damping_ratio).fold(f64::INFINITY, f64::min)
    }

    fn room(&self) -> usize {
        1
    }

    fn run(&self, sequences: &[(SteppedSine, f64)]) -> Vec<Result<(Vec<f64>, f64), DynamicsError>> {
        let run = |(sequence, force_n): &(SteppedSine, f64)| {
            let sampling = Sampling::new(sequence.end(), self.sample_rate)?;
            let load = LoadCase::force(TimeFunction::SteppedSine(sequence.clone()), *force_n);
            let mut found = self.system.integrate(&load, &sampling, self.parts())?;
            Ok((found.history.sensors.remove(0).displacement, sampling.interval()))
        };
        sequences.iter().map(run).collect()
    }
}

/// `cells.csv` of steady responses: a row for each cell at the highest response of each force amplitude.
pub fn steady_cells(structure: &PatchStructure, steady: &Steady) -> DataTable {
    let contacts = structure.structure.contacts();
    let peaks = (1..)
        .zip(steady.parts())
        .filter_map(|(branch, level)| Some((branch, level.outcome.as_ref().ok()?.highest()?)));
    let cells = peaks.flat_map(|(branch, peak)| {
        let cells = structure.patches.iter().flat_map(|patch| {
            let names = patch.cell_names.iter().zip(patch.cells.clone());
            names.map(|(name, i)| (patch.name.as_str(), name.as_str(), i))
        });
        cells.map(move |(patch, name, number)| Cell { branch, peak, patch, name, number })
    });
    let cells: Vec<Cell<'_>> = cells.collect();
    let of = |value: &dyn Fn(&PreloadedContact, &PressureRange) -> f64| -> Vec<f64> {
        let own = |cell: &Cell<'_>| value(&contacts[cell.number], cell.range());
        cells.iter().map(own).collect()
    };
    DataTable::new()
        .counts("branch", cells.iter().map(|cell| cell.branch))
        .texts("interface", cells.iter().map(|cell| cell.patch))
        .texts("cell", cells.iter().map(|cell| cell.name))
        .numbers("frequency_hz", cells.iter().map(|cell| cell.peak.frequency_hz()))
        .with("area_m2", of(&|contact, _| contact.area()))
        .with("pressure_at_rest_pa", of(&|contact, _| contact.pressure()))
        .with("gap_at_rest_m", of(&|contact, _| contact.gap()))
        .with("pressure_min_pa", of(&|_, range| range.lowest))
        .with("pressure_max_pa", of(&|_, range| range.highest))
        .flags("contact_lost", cells.iter().map(|cell| cell.range().contact_lost))
}

/// A cell in the highest response of a branch.
struct Cell<'a> {
    branch: usize,
    peak: &'a PeriodicResponse,
    patch: &'a str,
    name: &'a str,
    number: usize,
}

impl Cell<'_> {
    fn range(&self) -> &PressureRange {
        &self.peak.pressures[self.number]
    }
}
