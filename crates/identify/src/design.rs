//! What to measure next.

use std::collections::BTreeMap;

use asperity_inference::{
    Covariance, DesignCandidate, Fit, ForwardModel, Scale, design_sequence, expected_information,
};

use crate::band::LawBand;
use crate::error::ProblemError;
use crate::forward::Forward;
use crate::problem::{Changes, DataSpec, DesignSpec, HitSpec, Measured, Uncertain};
use crate::read::Problem;
use crate::row::Row;

/// Pressures at which the law is to be known better.
const TARGETS: usize = 9;

/// Measurements of the proposed sequence.
const SEQUENCE: usize = 3;

/// Step of the law's derivatives in the unknowns' working coordinates.
const STEP: f64 = 1e-4;

/// A hit that could be made.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignedHit {
    /// Peak force \[N\].
    pub force_peak_n: f64,
    /// Changes of the rig.
    pub set: Changes,
    /// Mean standard deviation of ln K over the reached pressures after it, over that before.
    pub remaining: f64,
    /// Information gained about all unknowns, in nats.
    pub information: f64,
}

/// The hits, and the best sequence of some of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Designed {
    /// Hits of each kind that were counted.
    pub hits: usize,
    /// Every kind, measured alone.
    pub candidates: Vec<DesignedHit>,
    /// Kinds in the order in which they had best be measured, each after those before.
    pub sequence: Vec<DesignedHit>,
}

/// The hits of a design as a forward model, which is made before any work is.
#[derive(Debug)]
pub(super) struct Plan {
    forward: Forward,
    /// Force and changes of the rig of every hit.
    kinds: Vec<(f64, Changes)>,
    /// Median relative standard deviation of every feature of the hits that were made, in the order of
    /// the rows of a hit.
    relative: Vec<f64>,
    hits: usize,
}

/// Plans the hits of a design, with the features of those that were made.
pub(super) fn plan(
    problem: &Problem,
    forward: &Forward,
    asked: &DesignSpec,
) -> Result<Plan, ProblemError> {
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
    Ok(Plan {
        forward: problem.planned(&data)?,
        kinds,
        relative: features.into_values().collect(),
        hits: asked.hits,
    })
}

/// Ranks planned hits by what they would tell about the law.
pub(super) fn rank(
    plan: &Plan,
    law: &LawBand,
    best: &Fit,
    (covariance, noise_factor): (&Covariance, f64),
) -> Result<Designed, ProblemError> {
    let Plan { forward, kinds, relative, hits } = plan;
    let derivatives = forward.derivatives(&best.point)?;
    let pairs = forward.unknowns().iter().zip(&best.point);
    let slopes: Vec<f64> = pairs.map(|(unknown, &value)| unknown.value_slope(value)).collect();
    let shrink = (*hits as f64).sqrt() / noise_factor;
    // The rows of each kind follow one another, a feature each.
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
                // A peak that is not there tells nothing.
                if let (Some(value), Some(entries)) = (value, entries) {
                    let working = entries.iter().zip(&slopes).map(|(entry, slope)| entry * slope);
                    candidate.jacobian.push(working.collect());
                    candidate.standard_deviations.push(relative * value.abs() / shrink);
                }
            }
            candidate
        })
        .collect();
    let targets = targets(forward, law, best)?;
    let named = |gain: &asperity_inference::DesignGain| {
        let (force_peak_n, set) = kinds[gain.candidate].clone();
        let (remaining, information) = (gain.target_ratio, gain.information);
        DesignedHit { force_peak_n, set, remaining, information }
    };
    let alone = expected_information(&covariance.matrix, &candidates, &targets)?;
    let sequence = design_sequence(&covariance.matrix, &candidates, &targets, SEQUENCE)?;
    Ok(Designed {
        hits: *hits,
        candidates: alone.iter().map(named).collect(),
        sequence: sequence.iter().map(named).collect(),
    })
}

/// Features of the hits that were made, and their median relative standard deviation.
fn features(forward: &Forward, problem: &Problem) -> Result<BTreeMap<String, f64>, ProblemError> {
    let mut all: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (row, observation) in forward.rows.iter().zip(&forward.observations) {
        if let Row::Feature { column, .. } = row
            && observation.value != 0.0
        {
            let relative = observation.standard_deviation / observation.value.abs();
            all.entry(forward.columns.names[*column].clone()).or_default().push(relative);
        }
    }
    if all.is_empty() {
        return Err(ProblemError::Design { path: problem.document.path().to_owned() });
    }
    let median = |mut list: Vec<f64>| {
        list.sort_by(f64::total_cmp);
        list[list.len() / 2]
    };
    Ok(all.into_iter().map(|(feature, list)| (feature, median(list))).collect())
}

/// Gradients of ln K at pressures that were reached, in working coordinates.
fn targets(forward: &Forward, law: &LawBand, best: &Fit) -> Result<Vec<Vec<f64>>, ProblemError> {
    let [low, high] = law.reached;
    let pressures: Vec<f64> = (0..TARGETS)
        .map(|i| low + (high - low) * (i as f64 / (TARGETS - 1) as f64).powi(2))
        .collect();
    let mut gradients = vec![Vec::new(); TARGETS];
    for (j, unknown) in forward.unknowns().iter().enumerate() {
        let at = |place: f64| {
            let mut point = best.point.clone();
            let x = unknown.to_working(point[j]);
            point[j] = match unknown.scale() {
                Scale::Linear => x + place,
                Scale::Logarithmic => (x + place).exp(),
            };
            forward.curve(&law.name, &pressures, &point)
        };
        let (above, below) = (at(STEP)?, at(-STEP)?);
        for ((gradient, above), below) in gradients.iter_mut().zip(above).zip(below) {
            gradient.push((above / below).ln() / (2.0 * STEP));
        }
    }
    // A law without stiffness at zero pressure has no logarithm of it.
    gradients.retain(|gradient| gradient.iter().all(|entry| entry.is_finite()));
    Ok(gradients)
}
