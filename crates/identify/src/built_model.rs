//! Forward models with their observations, to which data are added one by one.

use asperity_inference::Observation;
use asperity_scenario::four_digits;

use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::observed_quantity::ObservedQuantity;
use crate::scenario_model::ScenarioModel;

/// Largest distance of two values of one feature of one hit, in standard deviations.
const MAX_APART: f64 = 10.0;

/// A forward model with the labels of its observations.
#[derive(Debug)]
pub(super) struct BuiltModel {
    pub(super) forward: ScenarioModel,
    pub(super) about: Vec<ObservationLabel>,
    /// Notices on omitted data.
    pub(super) notices: Vec<String>,
}

/// Data, feature and abscissa of an observation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ObservationLabel {
    /// Name of the data.
    pub(super) data: String,
    /// The feature.
    pub(super) feature: String,
    /// Peak force as measured \[N\], frequency \[Hz\], amplitude \[m\] or pressure \[Pa\].
    pub(super) at: Option<f64>,
}

impl ObservationLabel {
    pub(super) fn new(data: &str, feature: impl Into<String>, at: Option<f64>) -> Self {
        Self { data: data.to_owned(), feature: feature.into(), at }
    }
}

/// Adds data to a model.
pub(super) struct Loader<'a> {
    pub(super) problem: &'a IdentificationProblem,
    pub(super) built: BuiltModel,
    /// Number of blocks for cross-validation, one per hit.
    pub(super) blocks: usize,
}

impl Loader<'_> {
    pub(super) fn next_block(&mut self) -> usize {
        self.blocks += 1;
        self.blocks - 1
    }

    pub(super) fn push(
        &mut self,
        place: &str,
        block: usize,
        quantity: ObservedQuantity,
        about: ObservationLabel,
        (value, deviation): (f64, f64),
    ) -> Result<(), IdentificationError> {
        let forward = &mut self.built.forward;
        for (known, earlier) in forward.quantities.iter().zip(&forward.observations) {
            let apart = (earlier.value - value).abs() / earlier.standard_deviation.hypot(deviation);
            if *known == quantity && apart > MAX_APART {
                return Err(IdentificationError::Contradictory {
                    place: place.to_owned(),
                    feature: about.feature,
                    first: earlier.value,
                    second: value,
                    apart,
                });
            }
        }
        let at = about.at.map_or_else(String::new, |at| format!(" at {}", four_digits(at)));
        forward.quantities.push(quantity);
        forward.observations.push(Observation {
            label: format!("{}: {}{at}", about.data, about.feature),
            block,
            value,
            standard_deviation: deviation,
        });
        self.built.about.push(about);
        Ok(())
    }
}
