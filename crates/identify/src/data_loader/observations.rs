//! Observations of data: features of hits, receptances, stiffnesses.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::built_model::{Loader, ObservationLabel};
use crate::data_files::{BackboneRow, ReceptanceLine};
use crate::error::IdentificationError;
use crate::hit::SharedErrors;
use crate::observed_quantity::{ComplexPart, ObservedQuantity};
use crate::problem::{Changes, HitSpec, SpreadSpec};
use crate::records::Force;
use crate::records::RecordedHit;
use crate::scenario_laws::no_law;
use crate::stepped_sine::{SimulatedSweep, SteppedRow};
use asperity_harmonic::Drive;
use asperity_scenario::four_digits;
use asperity_simulation::quantity::Quantity;

impl Loader<'_> {
    pub(super) fn stiffness(
        &mut self,
        place: &str,
        data: &str,
        law: &str,
        points: &[[f64; 2]],
        spread: SpreadSpec,
    ) -> Result<(), IdentificationError> {
        if self.built.forward.scenario.pointer("/laws").and_then(|laws| laws.get(law)).is_none() {
            return Err(no_law(&self.built.forward.scenario, law));
        }
        for &[pressure, stiffness] in points {
            for (quantity, value) in [("pressure [Pa]", pressure), ("stiffness [Pa/m]", stiffness)]
            {
                if !(value.is_finite() && value >= 0.0) {
                    let (place, expected) = (place.to_owned(), "a finite number, not negative");
                    return Err(IdentificationError::Value { place, quantity, value, expected });
                }
            }
            let quantity =
                ObservedQuantity::Stiffness { place: self.built.forward.stiffness.len() };
            self.built.forward.stiffness.push((law.to_owned(), pressure));
            let block = self.next_block();
            let feature = format!("stiffness of {law}");
            let about = ObservationLabel::new(data, feature, Some(pressure));
            self.push(place, block, quantity, about, (stiffness, spread.of(stiffness)))?;
        }
        Ok(())
    }

    pub(super) fn hit_features(
        &mut self,
        place: &str,
        data: &str,
        set: &Changes,
        floor: &BTreeMap<String, SpreadSpec>,
        hit: &HitSpec,
    ) -> Result<(), IdentificationError> {
        self.analysed_features(place, data, set, floor, (hit, None))
    }

    /// Adds the features of a hit with its measured force, or the scenario's.
    pub(super) fn analysed_features(
        &mut self,
        place: &str,
        data: &str,
        set: &Changes,
        floor: &BTreeMap<String, SpreadSpec>,
        (hit, force): (&HitSpec, Option<Force>),
    ) -> Result<(), IdentificationError> {
        let simulated = match force {
            Some(force) => self.add_measured_hit(place, data, set, force, None)?,
            None => self.add_hit(place, data, &[set, &hit.set], hit.force_peak_n)?,
        };
        let block = self.next_block();
        for (feature, measured) in &hit.features {
            let column = self.column(place, feature)?;
            let (value, own) = measured.parts();
            let least = floor.get(feature).map_or(0.0, |floor| floor.of(value));
            let deviation = own.unwrap_or(0.0).hypot(least);
            if deviation == 0.0 {
                let (place, feature) = (place.to_owned(), feature.clone());
                return Err(IdentificationError::NoDeviation { place, feature });
            }
            let about = ObservationLabel::new(data, feature, hit.force_peak_n);
            let quantity = ObservedQuantity::Feature { hit: simulated, column };
            self.push(place, block, quantity, about, (value, deviation))?;
        }
        Ok(())
    }

    /// Adds frequency and, with its spread, damping at the points of a backbone.
    pub(super) fn backbone(
        &mut self,
        place: &str,
        data: &str,
        hit: usize,
        points: &[BackboneRow],
        (spread, damping_spread): (SpreadSpec, Option<SpreadSpec>),
    ) -> Result<(), IdentificationError> {
        self.built.forward.hits[hit].backbone = true;
        let block = self.next_block();
        for point in points {
            let amplitude = point.amplitude;
            let quantity = ObservedQuantity::Backbone { hit, amplitude, is_damping: false };
            let about = ObservationLabel::new(data, "backbone.frequency_hz", Some(amplitude));
            let value = point.frequency_hz;
            let deviation = spread.of(value).hypot(point.frequency_deviation_hz);
            self.push(place, block, quantity, about, (value, deviation))?;
            if let Some(spread) = damping_spread {
                let quantity = ObservedQuantity::Backbone { hit, amplitude, is_damping: true };
                let about = ObservationLabel::new(data, "backbone.damping_ratio", Some(amplitude));
                let value = point.damping_ratio;
                let deviation = spread.of(value).hypot(point.ratio_deviation);
                self.push(place, block, quantity, about, (value, deviation))?;
            }
        }
        Ok(())
    }

    /// Adds the receptance of a recorded hit, whose lines share the noise of the force.
    pub(super) fn recorded_receptance(
        &mut self,
        place: &str,
        data: &str,
        set: &Changes,
        spread: SpreadSpec,
        hit: &RecordedHit,
    ) -> Result<(), IdentificationError> {
        let simulated = self.add_recorded_hit(place, data, set, hit)?;
        let lines: Vec<ReceptanceLine> = hit.lines.iter().map(|(line, _)| *line).collect();
        let own = deviations(&lines, |noise| SpreadSpec {
            absolute: spread.absolute.hypot(noise),
            ..spread
        });
        let Some(errors) = hit.noise.errors(&hit.lines, &own)? else {
            return self.receptance(place, data, simulated, &lines, &own);
        };
        let first = self.built.forward.hits[simulated].frequencies.len();
        self.receptance(place, data, simulated, &lines, errors.standard_deviations())?;
        let shared = SharedErrors { lines: first..first + lines.len(), errors: Arc::new(errors) };
        self.built.forward.hits[simulated].shared_errors.push(shared);
        Ok(())
    }

    /// Adds the receptance at some lines, with the standard deviations of real and imaginary parts \[m/N\].
    pub(super) fn receptance(
        &mut self,
        place: &str,
        data: &str,
        simulated: usize,
        lines: &[ReceptanceLine],
        deviations: &[f64],
    ) -> Result<(), IdentificationError> {
        let block = self.next_block();
        for (line, own) in lines.iter().zip(deviations.chunks_exact(2)) {
            let frequencies = &mut self.built.forward.hits[simulated].frequencies;
            let at = frequencies.len();
            frequencies.push(line.frequency_hz);
            let parts = [(ComplexPart::Real, "real"), (ComplexPart::Imaginary, "imaginary")];
            for ((part, word), &deviation) in parts.into_iter().zip(own) {
                let quantity = ObservedQuantity::Receptance { hit: simulated, place: at, part };
                let feature = format!("receptance, {word} part");
                let about = ObservationLabel::new(data, feature, Some(line.frequency_hz));
                self.push(place, block, quantity, about, (part.of(line.value), deviation))?;
            }
        }
        Ok(())
    }

    /// Adds amplitudes and phases of steady responses; each level is a block.
    pub(super) fn stepped_sine(
        &mut self,
        place: &str,
        data: &str,
        set: &Changes,
        rows: &[SteppedRow],
        (spread, phase_spread): (SpreadSpec, Option<f64>),
        harmonics: usize,
    ) -> Result<(), IdentificationError> {
        let (rig, set) = self.steady_rig(place, set)?;
        let sensors = self.built.forward.parameters.sensors(data);
        let mut first = self.built.forward.sweeps.iter().map(|sweep| sweep.drives.len()).sum();
        for level in rows.chunk_by(|a, b| a.level == b.level) {
            let block = self.next_block();
            let drive =
                |row: &SteppedRow| Drive { frequency_hz: row.frequency_hz, force: row.force_n };
            self.built.forward.sweeps.push(SimulatedSweep {
                rig,
                set: set.clone(),
                sensors: sensors.clone(),
                drives: level.iter().map(drive).collect(),
                harmonics,
            });
            let of_force = format!("{} N", four_digits(level[0].force_n));
            for row in level {
                let response = first;
                first += 1;
                let quantity = ObservedQuantity::SteadyAmplitude { response };
                let feature = format!("steady amplitude_m at {of_force}");
                let about = ObservationLabel::new(data, feature, Some(row.frequency_hz));
                let deviation = spread.of(row.amplitude_m);
                self.push(place, block, quantity, about, (row.amplitude_m, deviation))?;
                if let (Some(deviation), Some(near)) = (phase_spread, row.phase_rad) {
                    let quantity = ObservedQuantity::SteadyPhase { response, near };
                    let feature = format!("steady phase_rad at {of_force}");
                    let about = ObservationLabel::new(data, feature, Some(row.frequency_hz));
                    self.push(place, block, quantity, about, (near, deviation))?;
                }
            }
        }
        Ok(())
    }

    pub(super) fn column(&self, place: &str, feature: &str) -> Result<usize, IdentificationError> {
        // Data of bars need exact derivatives.
        let is_structure = self.built.forward.is_structure();
        let is_known = |one: Quantity| one.has_derivative() || is_structure && one.is_feature();
        let known = Quantity::of_name(feature).is_some_and(|(quantity, _)| is_known(quantity));
        self.built.forward.columns.find(feature).filter(|_| known).ok_or_else(|| {
            let all = Quantity::ALL.iter().copied().filter(|quantity| is_known(*quantity));
            IdentificationError::Feature {
                place: place.to_owned(),
                feature: feature.to_owned(),
                known: all.map(Quantity::key).collect::<Vec<_>>().join(", "),
            }
        })
    }

    pub(super) fn check_floor(
        &self,
        place: &str,
        floor: &BTreeMap<String, SpreadSpec>,
    ) -> Result<(), IdentificationError> {
        floor
            .keys()
            .try_for_each(|feature| self.column(&format!("{place}/floor"), feature).map(|_| ()))
    }
}

/// Standard deviations of the real and the imaginary part of some lines \[m/N\], those of `spread` at the largest.
pub(super) fn deviations(lines: &[ReceptanceLine], spread: impl Fn(f64) -> SpreadSpec) -> Vec<f64> {
    let largest = lines.iter().map(|line| line.value.norm()).fold(0.0, f64::max);
    lines.iter().flat_map(|line| [spread(line.deviation).of(largest); 2]).collect()
}
