//! Exact derivatives of the predictions.
//!
//! Each strike is differentiated through every step of the integrator
//! ([`Batch::sensitivity`](asperity_dynamics::Batch::sensitivity)); what rigs, laws and forces are
//! made of, and the gains of the sensors, are differenced in closed form. A backbone is
//! differenced along the exact derivative of the decay that it is found from.

use std::sync::Arc;

use asperity_dynamics::{
    Course, Hit, RELATIVE_STEP, STENCIL, Sensitivity, Variation, central_difference,
};
use asperity_inference::Derivatives;
use asperity_signal::{BackbonePoint, Complex64, transform_at};
use rayon::prelude::*;

use crate::forward::Forward;
use crate::row::{Outcome, Outcomes, Row, backbone_of};
use crate::strike::{Prepared, Strike};
use asperity_study::error::StudyError;
use asperity_study::observables::free_from;
use asperity_study::quantity::Observable;
use asperity_study::sensitivity::{DerivativeTable, StaticStencil, with_laws_of};

/// Step along the derivative of a decay, over that of the unknown's stencil.
const ALONG: f64 = 1e-2;

/// The rigs at the places of the stencil of one unknown.
struct Neighbours {
    step: f64,
    points: [Vec<f64>; 4],
    rigs: [Vec<Prepared>; 4],
    of_law: bool,
}

/// A strike's outcome, its derivatives, and its backbones beyond and before.
struct Differentiated {
    outcome: Outcome,
    rates: Vec<Outcome>,
    backbones: Vec<[Vec<BackbonePoint>; 2]>,
}

impl Forward {
    /// Predictions and their derivatives with respect to the unknowns at `point`.
    pub(super) fn derivatives(&self, point: &[f64]) -> Result<Derivatives, StudyError> {
        let base = self.prepare(point)?;
        let neighbours = (0..point.len())
            .into_par_iter()
            .map(|unknown| self.neighbours(unknown, point))
            .collect::<Result<Vec<_>, StudyError>>()?;
        let strikes = self
            .strikes
            .par_iter()
            .map(|strike| self.differentiated(strike, point, &base, &neighbours))
            .collect::<Result<Vec<_>, _>>()?;
        let outcomes = Outcomes {
            strikes: strikes.iter().map(|strike| strike.outcome.clone()).collect(),
            stiffness: self.stiffnesses(point)?,
        };
        let gains = self.gains(point);
        let value = |row: &Row| row.value(&outcomes, &gains, &self.columns);
        let values: Vec<Option<f64>> = self.rows.iter().map(value).collect();
        let mut columns = Vec::with_capacity(point.len());
        for (unknown, around) in neighbours.iter().enumerate() {
            let rates = self.rates(unknown, around, &strikes)?;
            let backbones: Vec<_> =
                strikes.iter().map(|strike| strike.backbones[unknown].clone()).collect();
            let sensors = around.points.each_ref().map(|point| self.gains(point));
            let column = self.rows.iter().map(|row| {
                let step = ALONG * around.step;
                let moved =
                    row.rate(&outcomes, &rates, (step, &backbones), &gains, &self.columns)?;
                let shown = sensors
                    .each_ref()
                    .map(|gains| row.value(&outcomes, gains, &self.columns).unwrap_or(f64::NAN));
                let rate = moved + central_difference(shown, around.step);
                (!rate.is_nan()).then_some(rate)
            });
            columns.push(column.collect::<Vec<_>>());
        }
        let jacobian = (0..self.rows.len())
            .map(|row| columns.iter().map(|column: &Vec<_>| column[row]).collect());
        Ok(Derivatives { values, jacobian: jacobian.collect() })
    }

    fn neighbours(&self, unknown: usize, point: &[f64]) -> Result<Neighbours, StudyError> {
        let [lower, upper] = self.unknowns.list[unknown].bounds();
        let value = point[unknown];
        let scale = if value == 0.0 { upper - lower } else { value.abs() };
        let step = RELATIVE_STEP * scale;
        let points = STENCIL.map(|place| {
            let mut varied = point.to_vec();
            varied[unknown] += place * step;
            varied
        });
        let [a, b, c, d] = points.each_ref().map(|point| self.prepare(point));
        let of_law = self.unknowns.is_of_law(unknown);
        Ok(Neighbours { step, points, rigs: [a?, b?, c?, d?], of_law })
    }

    fn differentiated(
        &self,
        strike: &Strike,
        point: &[f64],
        base: &[Prepared],
        neighbours: &[Neighbours],
    ) -> Result<Differentiated, StudyError> {
        let rig = &base[strike.rig];
        let gains = |point: &[f64]| strike.sensors.gains(point);
        let hit = strike.hit(rig, gains(point), &self.folder)?;
        let modal = rig.case.modal().unwrap_or_default();
        let counts = rig.case.mode_counts(&modal, &hit.excitation)?;
        let mut variations = Vec::with_capacity(neighbours.len());
        for around in neighbours {
            let at = |place: usize| -> Result<Hit, StudyError> {
                let varied = &around.rigs[place][strike.rig];
                let sensors = gains(&around.points[place]);
                let excitation = strike.excitation(varied, sensors, &self.folder)?;
                let mut moved = varied.case.modal_model(&counts)?;
                if !around.of_law {
                    moved = Arc::new(with_laws_of(&hit.rig, &moved)?);
                }
                Ok(Hit { rig: moved, excitation, ..hit.clone() })
            };
            let hits = [at(0)?, at(1)?, at(2)?, at(3)?];
            variations.push(Variation { hits, step: around.step });
        }
        let found = self.batch.sensitivity(&hit, &variations)?;
        let stencils: Vec<StaticStencil<'_>> = neighbours
            .iter()
            .map(|around| {
                let at_rest = around.rigs.each_ref().map(|rigs| &rigs[strike.rig].case.at_rest);
                (at_rest, around.step)
            })
            .collect();
        let steps: Vec<f64> = neighbours.iter().map(|around| around.step).collect();
        let table = DerivativeTable::new(&rig.case, &found, &stencils)?;
        Ok(self.collected(strike, &table, &found, &steps))
    }

    fn collected(
        &self,
        strike: &Strike,
        table: &DerivativeTable,
        found: &Sensitivity,
        steps: &[f64],
    ) -> Differentiated {
        let interfaces = found.values.contacts.len();
        let place = |wanted: &Observable| table.observables.iter().position(|one| one == wanted);
        let places: Vec<Option<usize>> = Observable::all(interfaces).iter().map(place).collect();
        let gather = |of: &dyn Fn(usize) -> Option<f64>| -> Vec<f64> {
            places.iter().map(|place| place.and_then(of).unwrap_or(f64::NAN)).collect()
        };
        let rate = 1.0 / found.step;
        let count = found.values.displacement.len() - 1;
        let transforms = |course: &Course, frequency: f64| {
            [&course.displacement, &course.force]
                .map(|samples| transform_at(&samples[..count], rate, frequency))
        };
        let at_frequencies: Vec<[Complex64; 2]> =
            strike.frequencies.iter().map(|&f| transforms(&found.values, f)).collect();
        let outcome = Outcome {
            columns: gather(&|place| table.values[place]),
            receptance: at_frequencies.iter().map(|&[u, f]| u / f).collect(),
            backbone: Vec::new(),
        };
        let rates = found.rates.iter().enumerate().map(|(unknown, course)| {
            let pairs = strike.frequencies.iter().zip(&at_frequencies);
            let receptance = pairs.map(|(&f, &[response, force])| {
                let [response_rate, force_rate] = transforms(course, f);
                (response_rate - response / force * force_rate) / force
            });
            Outcome {
                columns: gather(&|place| table.jacobian[place][unknown]),
                receptance: receptance.collect(),
                backbone: Vec::new(),
            }
        });
        let rates = rates.collect();
        let mut all =
            Differentiated { outcome, rates, backbones: vec![Default::default(); steps.len()] };
        let first = self.columns.find("fundamental.frequency_hz");
        let fundamental = first.map_or(f64::NAN, |column| all.outcome.columns[column]);
        if strike.backbone && fundamental.is_finite() {
            let force = &found.values.force[..count];
            let peak = force.iter().fold(0.0_f64, |peak, force| peak.max(force.abs()));
            let free = free_from(force, peak);
            let decay = &found.values.displacement[free..count];
            all.outcome.backbone = backbone_of(decay, rate, fundamental);
            all.backbones = found
                .rates
                .iter()
                .zip(steps)
                .map(|(course, step)| {
                    let along = &course.displacement[free..count];
                    [ALONG * step, -ALONG * step].map(|step| {
                        let moved: Vec<f64> =
                            decay.iter().zip(along).map(|(u, rate)| u + step * rate).collect();
                        backbone_of(&moved, rate, fundamental)
                    })
                })
                .collect();
        }
        all
    }

    /// The rates of everything with one unknown.
    fn rates(
        &self,
        unknown: usize,
        around: &Neighbours,
        strikes: &[Differentiated],
    ) -> Result<Outcomes, StudyError> {
        let [a, b, c, d] = around.points.each_ref().map(|point| self.stiffnesses(point));
        let (a, b, c, d) = (a?, b?, c?, d?);
        let stiffness = (0..self.stiffness.len())
            .map(|place| central_difference([a[place], b[place], c[place], d[place]], around.step));
        Ok(Outcomes {
            strikes: strikes.iter().map(|strike| strike.rates[unknown].clone()).collect(),
            stiffness: stiffness.collect(),
        })
    }
}
