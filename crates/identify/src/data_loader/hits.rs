//! Simulated hits of data, and the scenarios of their rigs.

use serde_json::Value;

use super::{Loader, check_scenario};
use crate::error::IdentificationError;
use crate::hit::{HitForce, RigScenario, SimulatedHit};
use crate::problem::{Changes, HitConditionsSpec};
use crate::records;
use asperity_scenario::set_value;

/// The source of the force of a hit.
#[derive(Clone, Copy)]
pub(super) enum ForceSource<'a> {
    Spec(&'a HitConditionsSpec),
    Record(&'a records::RecordedHit),
}

impl Loader<'_> {
    /// Index of the hit with these changes, which is added unless an equal one exists.
    pub(super) fn add_hit(
        &mut self,
        place: &str,
        data: &str,
        sets: &[&Changes],
        drive: ForceSource<'_>,
    ) -> Result<usize, IdentificationError> {
        let mut of_rig = Changes::new();
        let mut of_force = Changes::new();
        let own = match drive {
            ForceSource::Spec(spec) => Some(&spec.set),
            ForceSource::Record(_) => None,
        };
        for (pointer, value) in sets.iter().copied().chain(own).flatten() {
            self.check_known(place, pointer)?;
            let force = pointer.starts_with("/excitation/");
            let into = if force { &mut of_force } else { &mut of_rig };
            into.insert(pointer.clone(), value.clone());
        }
        let rig = self.rig(place, &of_rig, &of_force)?;
        let (drive, duration) = match drive {
            ForceSource::Spec(spec) => {
                if spec.force_peak_n.is_some() {
                    self.check_known(place, "/excitation/peak_n")?;
                    self.check_peak(place)?;
                }
                (HitForce::Scenario { set: of_force, peak_n: spec.force_peak_n }, None)
            }
            ForceSource::Record(recorded) => {
                let (time_s, force_n) = (recorded.time_s.clone(), recorded.force_n.clone());
                (HitForce::Record { time_s, force_n }, Some(recorded.duration_s))
            }
        };
        let hit = SimulatedHit {
            rig,
            sensors: self.parameters.sensors(data),
            drive,
            duration,
            frequencies: Vec::new(),
            backbone: false,
        };
        let same = |known: &SimulatedHit| {
            // Hits that differ in the requested results only are one.
            (known.rig, &known.drive, known.duration, &known.sensors)
                == (hit.rig, &hit.drive, hit.duration, &hit.sensors)
        };
        if let Some(known) = self.found.hits.iter().position(same) {
            return Ok(known);
        }
        self.found.hits.push(hit);
        Ok(self.found.hits.len() - 1)
    }

    fn rig(
        &mut self,
        place: &str,
        changes: &Changes,
        of_force: &Changes,
    ) -> Result<usize, IdentificationError> {
        let mut scenario = self.scenario.clone();
        for (pointer, value) in changes {
            set_value(&mut scenario, pointer, &value.to_string())
                .map_err(|source| IdentificationError::Set { place: place.to_owned(), source })?;
        }
        let mut whole = scenario.clone();
        for (pointer, value) in of_force {
            set_value(&mut whole, pointer, &value.to_string())
                .map_err(|source| IdentificationError::Set { place: place.to_owned(), source })?;
        }
        check_scenario(&whole, self.path)?;
        let rig = RigScenario { scenario };
        if let Some(known) = self.found.rigs.iter().position(|known| *known == rig) {
            return Ok(known);
        }
        self.found.rigs.push(rig);
        Ok(self.found.rigs.len() - 1)
    }

    /// Checks that a change does not set a parameter.
    fn check_known(&self, place: &str, pointer: &str) -> Result<(), IdentificationError> {
        let inside = |a: &str, b: &str| {
            a.strip_prefix(b).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let clash = self
            .parameters
            .pointers()
            .find(|known| inside(known, pointer) || inside(pointer, known));
        match clash {
            None => Ok(()),
            Some(known) => Err(IdentificationError::Contradiction {
                pointer: known.to_owned(),
                by: format!("{place} sets {pointer}"),
            }),
        }
    }

    fn check_peak(&self, place: &str) -> Result<(), IdentificationError> {
        let kind = self.scenario.pointer("/excitation/kind").and_then(Value::as_str);
        match kind {
            Some("gamma_pulse" | "half_sine" | "haversine" | "samples") => Ok(()),
            _ => Err(IdentificationError::NoPeak { place: place.to_owned() }),
        }
    }
}
