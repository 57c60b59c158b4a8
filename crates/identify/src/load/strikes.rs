//! The strikes that data ask for, and the rigs they are on.

use serde_json::Value;

use super::{Loader, check_scenario};
use crate::error::ProblemError;
use crate::problem::{Changes, StrikeSpec};
use crate::records;
use crate::strike::{Drive, Rig, Strike};
use asperity_scenario::set_value;

/// The force of a strike as data give it.
#[derive(Clone, Copy)]
pub(super) enum StrikeDrive<'a> {
    Spec(&'a StrikeSpec),
    Record(&'a records::RecordedHit),
}

impl Loader<'_> {
    /// The strike of these changes, a new one unless there is one like it.
    pub(super) fn strike(
        &mut self,
        place: &str,
        data: &str,
        sets: &[&Changes],
        drive: StrikeDrive<'_>,
    ) -> Result<usize, ProblemError> {
        let mut of_rig = Changes::new();
        let mut of_force = Changes::new();
        let own = match drive {
            StrikeDrive::Spec(spec) => Some(&spec.set),
            StrikeDrive::Record(_) => None,
        };
        for (pointer, value) in sets.iter().copied().chain(own).flatten() {
            self.check_known(place, pointer)?;
            let force = pointer.starts_with("/excitation/");
            let into = if force { &mut of_force } else { &mut of_rig };
            into.insert(pointer.clone(), value.clone());
        }
        let rig = self.rig(place, &of_rig, &of_force)?;
        let (drive, duration) = match drive {
            StrikeDrive::Spec(spec) => {
                if spec.force_peak_n.is_some() {
                    self.check_known(place, "/excitation/peak_n")?;
                    self.check_peak(place)?;
                }
                (Drive::Scenario { set: of_force, peak_n: spec.force_peak_n }, None)
            }
            StrikeDrive::Record(hit) => {
                let (time_s, force_n) = (hit.time_s.clone(), hit.force_n.clone());
                (Drive::Record { time_s, force_n }, Some(hit.duration_s))
            }
        };
        let strike = Strike {
            rig,
            sensors: self.unknowns.sensors(data),
            drive,
            duration,
            frequencies: Vec::new(),
            backbone: false,
        };
        let same = |known: &Strike| {
            // What else is asked of a strike does not make it another.
            (known.rig, &known.drive, known.duration, &known.sensors)
                == (strike.rig, &strike.drive, strike.duration, &strike.sensors)
        };
        if let Some(known) = self.found.strikes.iter().position(same) {
            return Ok(known);
        }
        self.found.strikes.push(strike);
        Ok(self.found.strikes.len() - 1)
    }

    fn rig(
        &mut self,
        place: &str,
        changes: &Changes,
        of_force: &Changes,
    ) -> Result<usize, ProblemError> {
        let mut scenario = self.scenario.clone();
        for (pointer, value) in changes {
            set_value(&mut scenario, pointer, &value.to_string())
                .map_err(|source| ProblemError::Set { place: place.to_owned(), source })?;
        }
        let mut whole = scenario.clone();
        for (pointer, value) in of_force {
            set_value(&mut whole, pointer, &value.to_string())
                .map_err(|source| ProblemError::Set { place: place.to_owned(), source })?;
        }
        check_scenario(&whole, self.path)?;
        let rig = Rig { scenario };
        if let Some(known) = self.found.rigs.iter().position(|known| *known == rig) {
            return Ok(known);
        }
        self.found.rigs.push(rig);
        Ok(self.found.rigs.len() - 1)
    }

    /// Refuses what is unknown to be set.
    fn check_known(&self, place: &str, pointer: &str) -> Result<(), ProblemError> {
        let inside = |a: &str, b: &str| {
            a.strip_prefix(b).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let clash =
            self.unknowns.pointers().find(|known| inside(known, pointer) || inside(pointer, known));
        match clash {
            None => Ok(()),
            Some(known) => Err(ProblemError::Contradiction {
                pointer: known.to_owned(),
                by: format!("{place} sets {pointer}"),
            }),
        }
    }

    fn check_peak(&self, place: &str) -> Result<(), ProblemError> {
        let kind = self.scenario.pointer("/excitation/kind").and_then(Value::as_str);
        match kind {
            Some("gamma_pulse" | "half_sine" | "haversine" | "samples") => Ok(()),
            _ => Err(ProblemError::NoPeak { place: place.to_owned() }),
        }
    }
}
