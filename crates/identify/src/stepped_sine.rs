//! Steady responses to a shaker at stepped frequencies, by harmonic balance.

use asperity_dynamics::{STENCIL, central_difference};
use asperity_harmonic::{
    ContactSystem, Drive, LawEvaluation, SineResponse, SineVariation, SteppedSineSolver, SystemPort,
};
use asperity_signal::Complex64;
use rayon::prelude::*;

use crate::data_files::TableSource;
use crate::error::IdentificationError;
use crate::hit::PreparedRig;
use crate::problem::Changes;
use crate::problem_parameters::{Gains, Sensors};
use asperity_simulation::error::SimulationError;
use asperity_simulation::patches::{Patch, PatchStructure, PatchSystem};

/// Least relative change of the force at which a new level begins, in a table without levels.
const NEW_LEVEL: f64 = 0.1;

/// The error of a sensor at another place than the force.
const ONE_PLACE: &str = "stepped_sine data are the response at the place of the force: excitation.at and the first of the sensors must be one place";

/// A measured response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SteppedRow {
    /// Number of its level, from 0.
    pub(super) level: usize,
    pub(super) frequency_hz: f64,
    /// Force amplitude \[N\].
    pub(super) force_n: f64,
    /// Amplitude of the displacement \[m\].
    pub(super) amplitude_m: f64,
    /// Phase of the displacement to the force \[rad\].
    pub(super) phase_rad: Option<f64>,
}

/// The rows of a table, in its order.
pub(super) fn read_table(source: &TableSource<'_>) -> Result<Vec<SteppedRow>, IdentificationError> {
    const EXPECTED: &str = "the columns frequency_hz, force_n, amplitude_m or amplitude_m_per_s2, \
                            and optionally phase_rad or phase_deg, and level";
    let table = |names: &[&[&str]; 3]| source.columns(names, EXPECTED);
    let common = [&["frequency_hz"][..], &["force_n"]];
    let with = |last: &'static [&'static str]| table(&[common[0], common[1], last]);
    let (rows, is_acceleration) = match with(&["amplitude_m"]) {
        Ok(rows) => (rows, false),
        Err(error) => match with(&["amplitude_m_per_s2"]) {
            Ok(rows) => (rows, true),
            Err(_) => return Err(error),
        },
    };
    let third = |name: &'static [&'static str]| with(name).ok();
    let phases = match (third(&["phase_rad"]), third(&["phase_deg"])) {
        (Some(rows), _) => Some((rows, 1.0)),
        (None, Some(rows)) => Some((rows, 1.0_f64.to_radians())),
        (None, None) => None,
    };
    let levels = third(&["level"]);
    let mut found: Vec<SteppedRow> = Vec::with_capacity(rows.len());
    let mut level_force = f64::NAN;
    for (i, &[frequency_hz, force_n, amplitude]) in rows.iter().enumerate() {
        let valid = [frequency_hz, force_n, amplitude].iter().all(|x| *x > 0.0 && x.is_finite());
        if !valid {
            let text = format!(
                "row {}: frequency {frequency_hz}, force {force_n}, amplitude {amplitude}",
                i + 1
            );
            return Err(source.problem(text, "positive numbers"));
        }
        let w = std::f64::consts::TAU * frequency_hz;
        let phase = phases.as_ref().map(|(rows, unit)| rows[i][2] * unit);
        let same = match (&levels, i) {
            (_, 0) => false,
            (Some(levels), _) => levels[i][2] == levels[i - 1][2],
            (None, _) => (force_n / level_force - 1.0).abs() <= NEW_LEVEL,
        };
        if !same {
            level_force = force_n;
        }
        let before = found.last().map(|row| row.level);
        found.push(SteppedRow {
            level: before.map_or(0, |level| level + usize::from(!same)),
            frequency_hz,
            force_n,
            amplitude_m: if is_acceleration { amplitude / (w * w) } else { amplitude },
            phase_rad: phase.filter(|phase| phase.is_finite()).map(|phase| {
                // Acceleration is opposite to displacement.
                if is_acceleration { phase - std::f64::consts::PI } else { phase }
            }),
        });
    }
    if found.is_empty() {
        return Err(source.problem("the table has no row".to_owned(), EXPECTED));
    }
    Ok(found)
}

/// A sweep of steady responses on one rig, to be simulated.
#[derive(Debug, Clone)]
pub(super) struct SimulatedSweep {
    /// Index of its rig.
    pub(super) rig: usize,
    /// Changes inside /excitation, whose place is that of the shaker.
    pub(super) set: Changes,
    pub(super) sensors: Sensors,
    /// Frequencies and measured force amplitudes, in their order.
    pub(super) drives: Vec<Drive>,
    pub(super) harmonics: usize,
}

impl SimulatedSweep {
    /// The structure, loaded where the shaker is.
    fn system(
        &self,
        rig: &PreparedRig,
        laws: LawEvaluation,
    ) -> Result<ContactSystem, SimulationError> {
        if let Ok(system) = rig.structure() {
            return Self::of_patches(system, laws);
        }
        let assembly = &rig.bars()?.assembly;
        let (load, sensors) = (rig.load_port(&self.set)?, assembly.sensor_ports());
        if sensors.first() != Some(&load) {
            return Err(SimulationError::Scenario(ONE_PLACE.to_owned()));
        }
        let system = ContactSystem::of_structure(&assembly.structure, laws)?;
        Ok(system.with_ports(load, &[load])?)
    }

    /// A structure of matrices, read along its force.
    fn of_patches(
        system: &PatchSystem,
        laws: LawEvaluation,
    ) -> Result<ContactSystem, SimulationError> {
        let PatchStructure { structure, load, sensors, .. } = &system.assembly.structure;
        let modes = structure.component_modes().modes();
        let is_there = |sensor: &usize| {
            modes.iter().all(|mode| mode.ports[*sensor].abs() == mode.ports[*load].abs())
        };
        if !sensors.first().is_some_and(is_there) {
            return Err(SimulationError::Scenario(ONE_PLACE.to_owned()));
        }
        let port = SystemPort::Number(*load);
        Ok(ContactSystem::of_structure(&**structure, laws)?.with_ports(port, &[port])?)
    }

    fn drive(drive: Drive, gains: Gains) -> Drive {
        Drive { force: drive.force / gains.force, ..drive }
    }

    /// The responses on the prepared rigs.
    pub(super) fn responses(
        &self,
        rigs: &[PreparedRig],
        gains: Gains,
    ) -> Result<Vec<Option<SineResponse>>, SimulationError> {
        // Tables of the laws here; `differentiated` evaluates the laws themselves.
        let system = self.system(&rigs[self.rig], LawEvaluation::default())?;
        let drives: Vec<Drive> =
            self.drives.iter().map(|drive| Self::drive(*drive, gains)).collect();
        Ok(SteppedSineSolver::new(&system, self.harmonics).sweep(&drives))
    }

    /// The responses as the sensors show them, and their derivatives with respect to every parameter,
    /// from rigs and gains at the points of its stencil.
    #[allow(clippy::type_complexity, reason = "responses, and a list of them for each parameter")]
    pub(super) fn differentiated(
        &self,
        rigs: &[PreparedRig],
        gains: Gains,
        stencils: &[SweepStencil<'_>],
    ) -> Result<(Vec<Option<Complex64>>, Vec<Vec<Option<Complex64>>>), SimulationError> {
        let responses = self.responses(rigs, gains)?;
        let exact = |rigs: &[PreparedRig]| self.system(&rigs[self.rig], LawEvaluation::Exact);
        let middle = exact(rigs)?;
        let systems = stencils
            .iter()
            .map(|stencil| stencil.rigs.iter().map(|rigs| exact(rigs)).collect())
            .collect::<Result<Vec<Vec<ContactSystem>>, SimulationError>>()?;
        // The weights of the stencil, from the differences of unit values.
        let weights: [f64; 4] = std::array::from_fn(|k| {
            central_difference(std::array::from_fn(|i| f64::from(u8::from(i == k))), 1.0)
        });
        let of_row = |(drive, response): (&Drive, &Option<SineResponse>)| {
            let response = response.as_ref()?;
            let variations: Vec<SineVariation<'_>> = stencils
                .iter()
                .zip(&systems)
                .map(|(stencil, systems)| SineVariation {
                    points: systems
                        .iter()
                        .zip(stencil.gains)
                        .map(|(system, gains)| (system, Self::drive(*drive, gains)))
                        .collect(),
                    weights: &weights,
                    step: stencil.step,
                })
                .collect();
            let mut solver = SteppedSineSolver::new(&middle, self.harmonics);
            let here = Self::drive(*drive, gains);
            let found = solver.derivatives(here, response, &variations)?;
            // The product rule with the gain of the response.
            let shown = found.into_iter().zip(stencils).map(|(du, stencil)| {
                let d_gain =
                    central_difference(stencil.gains.map(|gains| gains.response), stencil.step);
                gains.response * du + d_gain * response.displacement
            });
            Some(shown.collect::<Vec<Complex64>>())
        };
        let rows: Vec<Option<Vec<Complex64>>> =
            self.drives.par_iter().zip(&responses).map(of_row).collect();
        let derivatives = (0..stencils.len())
            .map(|j| rows.iter().map(|row| row.as_ref().map(|row| row[j])).collect())
            .collect();
        let shown =
            |one: &Option<SineResponse>| one.as_ref().map(|one| gains.response * one.displacement);
        Ok((responses.iter().map(shown).collect(), derivatives))
    }

    /// Lowest and highest pressure \[Pa\] at each interface in `responses`, of a cell of a patch.
    pub(super) fn pressures(
        rig: &PreparedRig,
        responses: &[Option<SineResponse>],
    ) -> Result<Vec<[f64; 2]>, SimulationError> {
        let structure = rig.structure().ok();
        let contacts = match structure {
            Some(system) => system.assembly.structure.structure.contacts(),
            None => rig.bars()?.assembly.structure.contacts(),
        };
        let of = |(i, contact): (usize, &asperity_structure::PreloadedContact)| {
            let ranges = || responses.iter().flatten().map(move |one| one.closure_range[i]);
            let low = ranges().map(|range| range[0]).fold(f64::INFINITY, f64::min);
            let high = ranges().map(|range| range[1]).fold(f64::NEG_INFINITY, f64::max);
            [low, high].map(|closure| contact.pressure_at(closure))
        };
        let all: Vec<[f64; 2]> = contacts.iter().enumerate().map(of).collect();
        let Some(system) = structure else { return Ok(all) };
        let of_patch = |patch: &Patch| {
            let cells = all[patch.cells.clone()].iter();
            cells.fold([f64::INFINITY, 0.0], |range: [f64; 2], cell| {
                [range[0].min(cell[0]), range[1].max(cell[1])]
            })
        };
        Ok(system.assembly.structure.patches.iter().map(of_patch).collect())
    }
}

/// Rigs and gains at the four points of the stencil of one parameter.
pub(super) struct SweepStencil<'a> {
    pub(super) rigs: [&'a [PreparedRig]; STENCIL.len()],
    pub(super) gains: [Gains; STENCIL.len()],
    pub(super) step: f64,
}
