//! Ranking of further hits by the information expected from them.

use std::collections::BTreeMap;

use asperity_inference::{
    Covariance, DesignCandidate, ExpectedInformation, ForwardModel, ParameterScale,
    design_sequence, expected_information,
};

use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::law_band::LawBand;
use crate::observed_quantity::ObservedQuantity;
use crate::problem::{Changes, DataSpec, DesignSpec, HitSpec, Measured, Uncertain};
use crate::scenario_model::ScenarioModel;

/// Number of pressures at which the uncertainty of the law is evaluated.
const TARGETS: usize = 9;

/// Measurements of the proposed sequence.
const SEQUENCE: usize = 3;

/// Step of the law's derivatives in the parameters' working coordinates.
const STEP: f64 = 1e-4;

/// A possible hit.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateHit {
    /// Peak force \[N\].
    pub force_peak_n: f64,
    /// Changes of the rig.
    pub set: Changes,
    /// Mean standard deviation of ln K over the reached pressures after the hit, over that before.
    pub remaining: f64,
    /// Information about all parameters, in nats.
    pub information: f64,
}

/// Possible hits with the information expected from them, and a sequence of the best.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRanking {
    /// Number of hits of each kind.
    pub hits: usize,
    /// Every kind, measured alone.
    pub candidates: Vec<CandidateHit>,
    /// The kinds of a greedy sequence: each is the best after those before it.
    pub sequence: Vec<CandidateHit>,
}

/// The forward model of possible hits.
#[derive(Debug)]
pub(super) struct DesignModel {
    forward: ScenarioModel,
    /// Force and changes of the rig of every hit.
    kinds: Vec<(f64, Changes)>,
    /// Median relative standard deviation of every feature of the measured hits, in the order of the
    /// observations of a hit.
    relative: Vec<f64>,
    hits: usize,
}

impl DesignModel {
    /// The model of the hits of the problem's design, if it has one.
    pub(super) fn asked(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
    ) -> Result<Option<Self>, IdentificationError> {
        let asked = problem.spec.design.as_ref();
        asked.map(|asked| Self::new(problem, forward, asked)).transpose()
    }

    /// The model of the hits of a design, with the features of the measured hits.
    fn new(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        asked: &DesignSpec,
    ) -> Result<Self, IdentificationError> {
        let features = features(forward, problem)?;
        let none = vec![Changes::new()];
        let sets = if asked.set.is_empty() { &none } else { &asked.set };
        let mut kinds = Vec::new();
        let mut data = Vec::new();
        for set in sets {
            for &force in &asked.force_peak_n {
                let one = Measured::Uncertain(Uncertain { value: 1.0, standard_deviation: 1.0 });
                let hit = HitSpec {
                    force_peak_n: Some(force),
                    set: Changes::new(),
                    features: features.keys().map(|feature| (feature.clone(), one)).collect(),
                };
                data.push(DataSpec::Hits {
                    name: None,
                    set: set.clone(),
                    floor: BTreeMap::new(),
                    hits: vec![hit],
                });
                kinds.push((force, set.clone()));
            }
        }
        Ok(Self {
            forward: problem.planned(&data)?,
            kinds,
            relative: features.into_values().collect(),
            hits: asked.hits,
        })
    }

    /// Ranks the hits by the information about the law at the best fit.
    pub(super) fn rank(
        &mut self,
        law: &LawBand,
        best: &[f64],
        covariance: &Covariance,
        noise_factor: f64,
    ) -> Result<DesignRanking, IdentificationError> {
        self.forward.hold(&self.forward.controlled(best)?);
        let Self { forward, kinds, relative, hits } = &*self;
        let derivatives = forward.derivatives(best)?;
        let pairs = forward.parameters().iter().zip(best);
        let slopes: Vec<f64> =
            pairs.map(|(parameter, &value)| parameter.d_value_d_working(value)).collect();
        let shrink = (*hits as f64).sqrt() / noise_factor;
        // The rows of each kind follow one another, one per feature.
        let rows = derivatives.jacobian.chunks(relative.len());
        let values = derivatives.values.chunks(relative.len());
        let candidates: Vec<DesignCandidate> = kinds
            .iter()
            .zip(rows.zip(values))
            .map(|((force, _), (rows, values))| {
                let mut candidate = DesignCandidate {
                    name: format!("{force} N"),
                    jacobian: Vec::new(),
                    standard_deviations: Vec::new(),
                };
                for ((row, value), relative) in rows.iter().zip(values).zip(relative) {
                    let entries: Option<Vec<f64>> = row.iter().copied().collect();
                    // A missing peak gives no information.
                    if let (Some(value), Some(entries)) = (value, entries) {
                        let working =
                            entries.iter().zip(&slopes).map(|(entry, slope)| entry * slope);
                        candidate.jacobian.push(working.collect());
                        candidate.standard_deviations.push(relative * value.abs() / shrink);
                    }
                }
                candidate
            })
            .collect();
        let targets = targets(forward, law, best)?;
        let named = |expected: &ExpectedInformation| {
            let (force_peak_n, set) = kinds[expected.candidate].clone();
            let (remaining, information) = (expected.target_ratio, expected.information);
            CandidateHit { force_peak_n, set, remaining, information }
        };
        let alone = expected_information(&covariance.matrix, &candidates, &targets)?;
        let sequence = design_sequence(&covariance.matrix, &candidates, &targets, SEQUENCE)?;
        Ok(DesignRanking {
            hits: *hits,
            candidates: alone.iter().map(named).collect(),
            sequence: sequence.iter().map(named).collect(),
        })
    }
}

/// Features of the measured hits, and their median relative standard deviation.
fn features(
    forward: &ScenarioModel,
    problem: &IdentificationProblem,
) -> Result<BTreeMap<String, f64>, IdentificationError> {
    let mut all: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (quantity, observation) in forward.quantities.iter().zip(&forward.observations) {
        if let ObservedQuantity::Feature { column, .. } = quantity
            && observation.value != 0.0
        {
            let relative = observation.standard_deviation / observation.value.abs();
            all.entry(forward.columns.names[*column].clone()).or_default().push(relative);
        }
    }
    if all.is_empty() {
        return Err(IdentificationError::Design(problem.document.path().to_owned()));
    }
    let median = |mut list: Vec<f64>| {
        list.sort_by(f64::total_cmp);
        list[list.len() / 2]
    };
    Ok(all.into_iter().map(|(feature, list)| (feature, median(list))).collect())
}

/// Gradients of ln K over the reached pressures, with respect to the working coordinates.
fn targets(
    forward: &ScenarioModel,
    law: &LawBand,
    best: &[f64],
) -> Result<Vec<Vec<f64>>, IdentificationError> {
    let [low, high] = law.reached;
    let pressures: Vec<f64> = (0..TARGETS)
        .map(|i| low + (high - low) * (i as f64 / (TARGETS - 1) as f64).powi(2))
        .collect();
    let mut gradients = vec![Vec::new(); TARGETS];
    for (j, parameter) in forward.parameters().iter().enumerate() {
        let at = |place: f64| {
            let mut point = best.to_vec();
            let x = parameter.to_working(point[j]);
            point[j] = match parameter.scale() {
                ParameterScale::Linear => x + place,
                ParameterScale::Logarithmic => (x + place).exp(),
            };
            forward.curve(&law.name, &pressures, &point)
        };
        let (above, below) = (at(STEP)?, at(-STEP)?);
        for ((gradient, above), below) in gradients.iter_mut().zip(above).zip(below) {
            gradient.push((above / below).ln() / (2.0 * STEP));
        }
    }
    // ln K is infinite where the stiffness is zero.
    gradients.retain(|gradient| gradient.iter().all(|entry| entry.is_finite()));
    Ok(gradients)
}
