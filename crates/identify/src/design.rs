//! Ranking of further measurements by the information expected from them.

use std::collections::BTreeMap;

use asperity_inference::{
    Covariance, DesignCandidate, ExpectedInformation, ForwardModel, design_sequence,
    expected_information,
};

use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::law_band::{LawBand, check_pressures};
use crate::observed_quantity::ObservedQuantity;
use crate::problem::{Changes, DataSpec, DesignSpec, HitSpec, Measured, Uncertain};
use crate::scenario_model::ScenarioModel;

/// Number of pressures at which the uncertainty of the law is evaluated.
const TARGETS: usize = 9;

/// Measurements of the proposed sequence.
const SEQUENCE: usize = 3;

/// A possible measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateMeasurement {
    /// Its kind.
    pub kind: MeasurementKind,
    /// Mean standard deviation of ln K over the pressures of the design after the measurement, over
    /// the mean before it.
    pub remaining: f64,
    /// Information about all parameters, in nats.
    pub information: f64,
}

/// The kind of a possible measurement.
#[derive(Debug, Clone, PartialEq)]
pub enum MeasurementKind {
    /// Hits.
    Hits {
        /// Peak force \[N\].
        force_peak_n: f64,
        /// Changes of the rig.
        set: Changes,
    },
    /// A quasi-static stiffness of the law.
    Stiffness {
        /// Pressure \[Pa\].
        pressure_pa: f64,
    },
}

/// Possible measurements with the information expected from them, and a sequence of the best.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRanking {
    /// Number of hits of each kind.
    pub hits: usize,
    /// Lowest and highest pressure \[Pa\] between which ln K is to be narrowed.
    pub pressures_pa: [f64; 2],
    /// Every kind, measured alone.
    pub candidates: Vec<CandidateMeasurement>,
    /// The kinds of a greedy sequence: each is the best after those before it.
    pub sequence: Vec<CandidateMeasurement>,
}

/// The forward model of possible hits, and possible stiffnesses.
#[derive(Debug)]
pub(super) struct DesignModel {
    forward: ScenarioModel,
    kinds: Vec<MeasurementKind>,
    /// Relative standard deviation of every feature, in the order of the observations of a hit.
    relative: Vec<f64>,
    /// Relative standard deviation of a quasi-static stiffness.
    of_stiffness: f64,
    hits: usize,
    /// Pressures between which ln K is to be narrowed, if not those that are reached.
    pressures: Option<[f64; 2]>,
}

impl DesignModel {
    /// The model of the measurements of the problem's design, if it has one.
    pub(super) fn asked(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
    ) -> Result<Option<Self>, IdentificationError> {
        let asked = problem.spec.design.as_ref();
        asked.map(|asked| Self::new(problem, forward, asked)).transpose()
    }

    fn new(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        asked: &DesignSpec,
    ) -> Result<Self, IdentificationError> {
        check(asked)?;
        check_pressures("/design/pressures_pa", asked.pressures_pa)?;
        let features = match &asked.features {
            none if none.is_empty() => measured_features(forward, problem)?,
            given => given.clone(),
        };
        let none = vec![Changes::new()];
        let sets = if asked.set.is_empty() { &none } else { &asked.set };
        let mut kinds = Vec::new();
        let mut data = Vec::new();
        for set in sets {
            for &force_peak_n in &asked.force_peak_n {
                let one = Measured::Uncertain(Uncertain { value: 1.0, standard_deviation: 1.0 });
                let hit = HitSpec {
                    force_peak_n: Some(force_peak_n),
                    set: Changes::new(),
                    features: features.keys().map(|feature| (feature.clone(), one)).collect(),
                };
                data.push(DataSpec::Hits {
                    name: None,
                    set: set.clone(),
                    floor: BTreeMap::new(),
                    hits: vec![hit],
                });
                kinds.push(MeasurementKind::Hits { force_peak_n, set: set.clone() });
            }
        }
        let stiffness = asked.stiffness.as_ref();
        let pressures = stiffness.map_or(&[][..], |stiffness| &stiffness.pressures_pa);
        kinds.extend(
            pressures.iter().map(|&pressure_pa| MeasurementKind::Stiffness { pressure_pa }),
        );
        Ok(Self {
            forward: problem.planned(&data)?,
            kinds,
            relative: features.into_values().collect(),
            of_stiffness: stiffness.map_or(f64::NAN, |stiffness| stiffness.relative),
            hits: asked.hits,
            pressures: asked.pressures_pa,
        })
    }

    /// Ranks the measurements by the information about the law at the best fit.
    pub(super) fn rank(
        &mut self,
        law: &LawBand,
        best: &[f64],
        covariance: &Covariance,
        noise_factor: f64,
    ) -> Result<DesignRanking, IdentificationError> {
        self.forward.hold(&self.forward.converged(best)?);
        let forward = &self.forward;
        let mut candidates = self.hit_candidates(best, noise_factor)?;
        for kind in &self.kinds {
            if let MeasurementKind::Stiffness { pressure_pa } = kind {
                let gradient = forward.log_stiffness_gradients(&law.name, &[*pressure_pa], best)?;
                // At an infinite ln K a measurement has no meaning.
                let usable = gradient.iter().flatten().all(|entry| entry.is_finite());
                let rows = usize::from(usable);
                candidates.push(DesignCandidate {
                    name: format!("{pressure_pa} Pa"),
                    jacobian: gradient.into_iter().take(rows).collect(),
                    standard_deviations: vec![self.of_stiffness; rows],
                });
            }
        }
        let pressures_pa = self.pressures.unwrap_or(law.reached);
        let [low, high] = pressures_pa;
        let pressures: Vec<f64> = (0..TARGETS)
            .map(|i| low + (high - low) * (i as f64 / (TARGETS - 1) as f64).powi(2))
            .collect();
        let mut targets = forward.log_stiffness_gradients(&law.name, &pressures, best)?;
        // ln K is infinite where the stiffness is zero.
        targets.retain(|gradient| gradient.iter().all(|entry| entry.is_finite()));
        let named = |expected: &ExpectedInformation| CandidateMeasurement {
            kind: self.kinds[expected.candidate].clone(),
            remaining: expected.target_ratio,
            information: expected.information,
        };
        let alone = expected_information(&covariance.matrix, &candidates, &targets)?;
        let sequence = design_sequence(&covariance.matrix, &candidates, &targets, SEQUENCE)?;
        Ok(DesignRanking {
            hits: self.hits,
            pressures_pa,
            candidates: alone.iter().map(named).collect(),
            sequence: sequence.iter().map(named).collect(),
        })
    }

    /// The hits, by their derivatives.
    fn hit_candidates(
        &self,
        best: &[f64],
        noise_factor: f64,
    ) -> Result<Vec<DesignCandidate>, IdentificationError> {
        let derivatives = if self.forward.is_structure() {
            self.forward.differences(best)
        } else {
            self.forward.derivatives(best)?
        };
        let pairs = self.forward.parameters().iter().zip(best);
        let slopes: Vec<f64> =
            pairs.map(|(parameter, &value)| parameter.d_value_d_working(value)).collect();
        let shrink = (self.hits as f64).sqrt() / noise_factor;
        let forces = self.kinds.iter().filter_map(|kind| match kind {
            MeasurementKind::Hits { force_peak_n, .. } => Some(force_peak_n),
            MeasurementKind::Stiffness { .. } => None,
        });
        // The rows of each kind follow one another, one per feature.
        let rows = derivatives.jacobian.chunks(self.relative.len());
        let values = derivatives.values.chunks(self.relative.len());
        let mut candidates = Vec::new();
        for (force, (rows, values)) in forces.zip(rows.zip(values)) {
            let mut candidate = DesignCandidate {
                name: format!("{force} N"),
                jacobian: Vec::new(),
                standard_deviations: Vec::new(),
            };
            for ((row, value), relative) in rows.iter().zip(values).zip(&self.relative) {
                let entries: Option<Vec<f64>> = row.iter().copied().collect();
                // A missing peak gives no information.
                if let (Some(value), Some(entries)) = (value, entries) {
                    let working = entries.iter().zip(&slopes).map(|(entry, slope)| entry * slope);
                    candidate.jacobian.push(working.collect());
                    candidate.standard_deviations.push(relative * value.abs() / shrink);
                }
            }
            candidates.push(candidate);
        }
        Ok(candidates)
    }
}

/// Checks the numbers of a design.
fn check(asked: &DesignSpec) -> Result<(), IdentificationError> {
    let refuse = |place: &str, quantity, value, expected| {
        Err(IdentificationError::Value { place: place.to_owned(), quantity, value, expected })
    };
    for (feature, &value) in &asked.features {
        if !(value > 0.0 && value.is_finite()) {
            let place = format!("/design/features/{feature}");
            return refuse(&place, "relative standard deviation", value, "a positive number");
        }
    }
    if let Some(stiffness) = &asked.stiffness {
        let relative = stiffness.relative;
        if !(relative > 0.0 && relative.is_finite()) {
            let quantity = "relative standard deviation";
            return refuse("/design/stiffness/relative", quantity, relative, "a positive number");
        }
        for &pressure in &stiffness.pressures_pa {
            if !(pressure > 0.0 && pressure.is_finite()) {
                let place = "/design/stiffness/pressures_pa";
                return refuse(place, "pressure [Pa]", pressure, "a positive number");
            }
        }
    }
    Ok(())
}

/// Features of the measured hits, and their median relative standard deviation.
fn measured_features(
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
