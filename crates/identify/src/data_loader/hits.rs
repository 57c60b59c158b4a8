//! Simulated hits of data, and the scenarios of their rigs.

use serde_json::Value;

use crate::built_model::Loader;
use crate::error::IdentificationError;
use crate::hit::{HitForce, SimulatedHit, apply};
use crate::problem::Changes;
use crate::problem_parameters::is_within;
use crate::records::Force;
use crate::records::RecordedHit;

impl Loader<'_> {
    /// Index of the hit with these changes and this peak force \[N\], which is added unless an equal
    /// one exists.
    pub(super) fn add_hit(
        &mut self,
        place: &str,
        data: &str,
        sets: &[&Changes],
        peak_n: Option<f64>,
    ) -> Result<usize, IdentificationError> {
        let (rig, set) = self.rig(place, sets)?;
        if peak_n.is_some() {
            self.check_known(place, "/excitation/peak_n")?;
            self.check_peak(place)?;
        }
        Ok(self.add(rig, data, HitForce::Scenario { set, peak_n }, None))
    }

    /// Index of the hit with these changes and a measured force, which is added unless an equal one exists.
    pub(super) fn add_recorded_hit(
        &mut self,
        place: &str,
        data: &str,
        set: &Changes,
        hit: &RecordedHit,
    ) -> Result<usize, IdentificationError> {
        let force = (hit.time_s.clone(), hit.force_n.clone());
        self.add_measured_hit(place, data, set, force, Some(hit.duration_s))
    }

    /// Index of the hit with these changes, a measured force and a duration \[s\], by default the scenario's.
    pub(super) fn add_measured_hit(
        &mut self,
        place: &str,
        data: &str,
        set: &Changes,
        (time_s, force_n): Force,
        duration: Option<f64>,
    ) -> Result<usize, IdentificationError> {
        let (rig, set) = self.rig(place, &[set])?;
        Ok(self.add(rig, data, HitForce::Record { set, time_s, force_n }, duration))
    }

    fn add(&mut self, rig: usize, data: &str, force: HitForce, duration: Option<f64>) -> usize {
        let forward = &mut self.built.forward;
        let hit = SimulatedHit {
            data: data.to_owned(),
            rig,
            sensors: forward.parameters.sensors(data),
            force,
            duration,
            resolution: None,
            frequencies: Vec::new(),
            backbone: false,
            shared_errors: Vec::new(),
        };
        let same = |known: &SimulatedHit| {
            // Hits that differ in the requested results only are one.
            (known.rig, &known.force, known.duration, &known.sensors)
                == (hit.rig, &hit.force, hit.duration, &hit.sensors)
        };
        forward.hits.iter().position(same).unwrap_or_else(|| {
            forward.hits.push(hit);
            forward.hits.len() - 1
        })
    }

    /// Index of the rig of steady responses, whose force is not the scenario's but at its place, and the
    /// changes inside its excitation.
    pub(super) fn steady_rig(
        &mut self,
        place: &str,
        set: &Changes,
    ) -> Result<(usize, Changes), IdentificationError> {
        self.rig(place, &[set])
    }

    /// Index of the rig with the changes in `sets` outside the excitation, and the changes inside it.
    fn rig(
        &mut self,
        place: &str,
        sets: &[&Changes],
    ) -> Result<(usize, Changes), IdentificationError> {
        let (mut of_rig, mut of_force) = (Changes::new(), Changes::new());
        let is_structure = self.built.forward.is_structure();
        for (pointer, value) in sets.iter().copied().flatten() {
            self.check_known(place, pointer)?;
            // The place of a force is a port of a structure of matrices.
            let is_port = is_structure && is_within(pointer, "/excitation/at");
            let force = pointer.starts_with("/excitation/") && !is_port;
            let into = if force { &mut of_force } else { &mut of_rig };
            into.insert(pointer.clone(), value.clone());
        }
        let mut rig = self.built.forward.scenario.clone();
        apply(&mut rig, &of_rig, place)?;
        let mut whole = rig.clone();
        apply(&mut whole, &of_force, place)?;
        self.problem.check_scenario(&whole)?;
        let rigs = &mut self.built.forward.rigs;
        let index = rigs.iter().position(|known| *known == rig).unwrap_or_else(|| {
            rigs.push(rig);
            rigs.len() - 1
        });
        Ok((index, of_force))
    }

    /// Checks that a change does not set a parameter.
    fn check_known(&self, place: &str, pointer: &str) -> Result<(), IdentificationError> {
        let clashes = |known: &&str| is_within(known, pointer) || is_within(pointer, known);
        match self.built.forward.parameters.pointers().find(clashes) {
            None => Ok(()),
            Some(known) => Err(IdentificationError::Contradiction {
                pointer: known.to_owned(),
                by: format!("{place} sets {pointer}"),
            }),
        }
    }

    fn check_peak(&self, place: &str) -> Result<(), IdentificationError> {
        let kind = self.built.forward.scenario.pointer("/excitation/kind").and_then(Value::as_str);
        match kind {
            Some("gamma_pulse" | "half_sine" | "haversine" | "samples") => Ok(()),
            _ => Err(IdentificationError::NoPeak(place.to_owned())),
        }
    }
}
