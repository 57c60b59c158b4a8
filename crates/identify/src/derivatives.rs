//! Exact derivatives of the predictions.
//!
//! Each hit is differentiated through every step of the integrator
//! ([`Batch::sensitivity`](asperity_dynamics::Batch::sensitivity)). The inputs of the integrator
//! (rigs, laws, forces) and the gains of the sensors are differentiated by fourth-order central
//! differences, a backbone by differences along the exact derivative of the decay.

use std::sync::Arc;

use asperity_dynamics::{
    ParameterVariation, RELATIVE_STEP, STENCIL, Sensitivity, StepHistory, TransientCase,
    central_difference,
};
use asperity_inference::Derivatives;
use asperity_signal::{BackbonePoint, Complex64, transform_at};
use rayon::prelude::*;

use crate::hit::{PreparedRig, SimulatedHit};
use crate::observed_quantity::{HitOutcome, ObservedQuantity, PointOutcomes, backbone_of};
use crate::scenario_model::ScenarioModel;
use crate::shared_errors::Of;
use crate::stepped_sine::SweepStencil;
use asperity_simulation::assemble::Interfaces as _;
use asperity_simulation::error::SimulationError;
use asperity_simulation::observables::{displacement_to_rest, free_from};
use asperity_simulation::quantity::{Observable, Quantity};
use asperity_simulation::sensitivity::{DerivativeTable, StaticStencil, with_laws_of};

/// Step along the derivative of a decay over the step of the parameter's stencil.
const ALONG: f64 = 1e-2;

/// The rigs at the points of the stencil of one parameter.
struct StencilRigs {
    step: f64,
    points: [Vec<f64>; 4],
    rigs: [Vec<PreparedRig>; 4],
    of_law: bool,
}

/// Results of a hit, their derivatives, and its backbones above and below.
struct HitDerivatives {
    outcome: HitOutcome,
    derivatives: Vec<HitOutcome>,
    backbones: Vec<[Vec<BackbonePoint>; 2]>,
}

impl ScenarioModel {
    /// Predictions and their derivatives with respect to the parameters at `point`.
    pub(crate) fn derivatives(&self, point: &[f64]) -> Result<Derivatives, SimulationError> {
        let base = self.prepare(point)?;
        let neighbours = (0..point.len())
            .into_par_iter()
            .map(|parameter| self.neighbours(parameter, point))
            .collect::<Result<Vec<_>, SimulationError>>()?;
        let hit_derivatives = self
            .hits
            .par_iter()
            .map(|hit| self.differentiated(hit, point, &base, &neighbours))
            .collect::<Result<Vec<_>, _>>()?;
        let (steady, steady_derivatives) = self.steady_derivatives(point, &base, &neighbours)?;
        let outcomes = PointOutcomes {
            hits: hit_derivatives.iter().map(|hit| hit.outcome.clone()).collect(),
            stiffness: self.stiffnesses(point)?,
            steady,
        };
        let gains = self.gains(point);
        let value = |quantity: &ObservedQuantity| quantity.value(&outcomes, &gains, &self.columns);
        let mut values: Vec<Option<f64>> = self.quantities.iter().map(value).collect();
        self.make_errors_independent(&mut values, Of::Values);
        let mut columns = Vec::with_capacity(point.len());
        for (parameter, around) in neighbours.iter().enumerate() {
            let derivatives = PointOutcomes {
                steady: steady_derivatives[parameter].clone(),
                ..self.parameter_derivatives(parameter, around, &hit_derivatives)?
            };
            let backbones: Vec<_> =
                hit_derivatives.iter().map(|hit| hit.backbones[parameter].clone()).collect();
            let sensors = around.points.each_ref().map(|point| self.gains(point));
            let column = self.quantities.iter().map(|quantity| {
                let step = ALONG * around.step;
                let moved = quantity.derivative(
                    &outcomes,
                    &derivatives,
                    (step, &backbones),
                    &gains,
                    &self.columns,
                )?;
                let shown = sensors.each_ref().map(|gains| {
                    quantity.value(&outcomes, gains, &self.columns).unwrap_or(f64::NAN)
                });
                let rate = moved + central_difference(shown, around.step);
                (!rate.is_nan()).then_some(rate)
            });
            let mut column = column.collect::<Vec<_>>();
            self.make_errors_independent(&mut column, Of::Rates);
            columns.push(column);
        }
        let jacobian = (0..self.quantities.len())
            .map(|quantity| columns.iter().map(|column: &Vec<_>| column[quantity]).collect());
        Ok(Derivatives { values, jacobian: jacobian.collect() })
    }

    fn neighbours(&self, parameter: usize, point: &[f64]) -> Result<StencilRigs, SimulationError> {
        let [lower, upper] = self.parameters.list[parameter].bounds();
        let value = point[parameter];
        let scale = match value {
            _ if self.parameters.list[parameter].is_latent() => 1.0,
            0.0 => upper - lower,
            _ => value.abs(),
        };
        let step = RELATIVE_STEP * scale;
        let points = STENCIL.map(|place| {
            let mut varied = point.to_vec();
            varied[parameter] += place * step;
            varied
        });
        let [a, b, c, d] = points.each_ref().map(|point| self.prepare(point));
        let of_law = self.parameters.is_of_law(parameter);
        Ok(StencilRigs { step, points, rigs: [a?, b?, c?, d?], of_law })
    }

    fn differentiated(
        &self,
        hit: &SimulatedHit,
        point: &[f64],
        base: &[PreparedRig],
        neighbours: &[StencilRigs],
    ) -> Result<HitDerivatives, SimulationError> {
        let rig = &base[hit.rig];
        let bars = rig.bars()?;
        let gains = |point: &[f64]| hit.sensors.gains(point);
        let simulation = hit.simulation(rig, gains(point), &self.folder)?;
        let counts = hit.mode_counts(rig, &simulation.load)?;
        let mut variations = Vec::with_capacity(neighbours.len());
        for around in neighbours {
            let at = |place: usize| -> Result<TransientCase, SimulationError> {
                let varied = &around.rigs[place][hit.rig];
                let sensors = gains(&around.points[place]);
                let load = hit.load(varied, sensors, &self.folder)?;
                let mut moved = varied.bars()?.modal_model(&counts, load.port())?;
                if !around.of_law {
                    moved = Arc::new(with_laws_of(&simulation.model, &moved)?);
                }
                Ok(TransientCase { model: moved, load, ..simulation.clone() })
            };
            let cases = [at(0)?, at(1)?, at(2)?, at(3)?];
            variations.push(ParameterVariation { cases, step: around.step });
        }
        let found = self.batch.sensitivity(&simulation, &variations)?;
        let stencils: Vec<StaticStencil<'_>> = neighbours
            .iter()
            .map(|around| {
                let at_rest = around.rigs.each_ref().map(|rigs| rigs[hit.rig].at_rest());
                (at_rest, around.step)
            })
            .collect();
        let steps: Vec<f64> = neighbours.iter().map(|around| around.step).collect();
        let table = DerivativeTable::new(bars, &found, &stencils)?;
        let has_friction = bars.assembly.structure.has_friction();
        let mut found = self.collected(hit, &table, (&found, has_friction), &steps);
        if simulation.tolerance.is_some() {
            // The derivatives are of equal steps; the values are to be the search's own.
            let backbone = std::mem::take(&mut found.outcome.backbone);
            found.outcome = HitOutcome { backbone, ..self.outcome_alone(rig, hit, &simulation)? };
        }
        Ok(found)
    }

    fn collected(
        &self,
        hit: &SimulatedHit,
        table: &DerivativeTable,
        (found, has_friction): (&Sensitivity, bool),
        steps: &[f64],
    ) -> HitDerivatives {
        let interfaces = found.values.contacts.len();
        let place = |wanted: &Observable| table.observables.iter().position(|one| one == wanted);
        let places: Vec<Option<usize>> = Observable::all(interfaces).iter().map(place).collect();
        let gather = |of: &dyn Fn(usize) -> Option<f64>| -> Vec<f64> {
            places.iter().map(|place| place.and_then(of).unwrap_or(f64::NAN)).collect()
        };
        let rate = 1.0 / found.step;
        let count = found.values.displacement.len() - 1;
        let transforms = |history: &StepHistory| -> Vec<[Complex64; 2]> {
            let displacement = displacement_to_rest(&history.displacement[..count], has_friction);
            let signals = [&displacement[..], &history.force[..count]];
            let at = |&f: &f64| signals.map(|samples| transform_at(samples, rate, f));
            hit.frequencies.iter().map(at).collect()
        };
        let at_frequencies = transforms(&found.values);
        let outcome = HitOutcome {
            columns: gather(&|place| table.values[place]),
            receptance: at_frequencies.iter().map(|&[u, f]| u / f).collect(),
            ..HitOutcome::default()
        };
        let derivatives = found.derivatives.iter().enumerate().map(|(parameter, history)| {
            let pairs = transforms(history).into_iter().zip(&at_frequencies);
            let receptance = pairs.map(|([d_response, d_force], &[response, force])| {
                (d_response - response / force * d_force) / force
            });
            HitOutcome {
                columns: gather(&|place| table.jacobian[place][parameter]),
                receptance: receptance.collect(),
                ..HitOutcome::default()
            }
        });
        let derivatives = derivatives.collect();
        let mut all = HitDerivatives {
            outcome,
            derivatives,
            backbones: vec![Default::default(); steps.len()],
        };
        let first = self.columns.find(Quantity::FundamentalFrequency.key());
        let fundamental = first.map_or(f64::NAN, |column| all.outcome.columns[column]);
        if hit.backbone && fundamental.is_finite() {
            let force = &found.values.force[..count];
            let peak = force.iter().fold(0.0_f64, |peak, force| peak.max(force.abs()));
            let free = free_from(force, peak);
            let decay = &found.values.displacement[free..count];
            all.outcome.backbone = backbone_of(decay, rate, fundamental);
            all.backbones = found
                .derivatives
                .iter()
                .zip(steps)
                .map(|(history, step)| {
                    let along = &history.displacement[free..count];
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

    /// Derivatives of all results with respect to one parameter.
    fn parameter_derivatives(
        &self,
        parameter: usize,
        around: &StencilRigs,
        hit_derivatives: &[HitDerivatives],
    ) -> Result<PointOutcomes, SimulationError> {
        let [a, b, c, d] = around.points.each_ref().map(|point| self.stiffnesses(point));
        let (a, b, c, d) = (a?, b?, c?, d?);
        let stiffness = (0..self.stiffness.len())
            .map(|place| central_difference([a[place], b[place], c[place], d[place]], around.step));
        Ok(PointOutcomes {
            hits: hit_derivatives.iter().map(|hit| hit.derivatives[parameter].clone()).collect(),
            stiffness: stiffness.collect(),
            steady: Vec::new(),
        })
    }

    /// The steady responses, and their derivatives with respect to each parameter.
    #[allow(clippy::type_complexity, reason = "responses, and a list of them for each parameter")]
    fn steady_derivatives(
        &self,
        point: &[f64],
        base: &[PreparedRig],
        neighbours: &[StencilRigs],
    ) -> Result<(Vec<Option<Complex64>>, Vec<Vec<Option<Complex64>>>), SimulationError> {
        let (mut values, mut derivatives) = (Vec::new(), vec![Vec::new(); neighbours.len()]);
        for sweep in &self.sweeps {
            let stencils: Vec<SweepStencil<'_>> = neighbours
                .iter()
                .map(|around| SweepStencil {
                    rigs: around.rigs.each_ref().map(Vec::as_slice),
                    gains: around.points.each_ref().map(|point| sweep.sensors.gains(point)),
                    step: around.step,
                })
                .collect();
            let (own, moved) = sweep.differentiated(base, sweep.sensors.gains(point), &stencils)?;
            values.extend(own);
            for (all, moved) in derivatives.iter_mut().zip(moved) {
                all.extend(moved);
            }
        }
        Ok((values, derivatives))
    }
}
