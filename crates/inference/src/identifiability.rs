//! Combinations of the parameters that the data determine.

use faer::Mat;

use crate::error::InferenceError;
use crate::linear_algebra::right_singular_vectors;
use crate::linearisation::Linearisation;
use crate::parameter::Parameter;

/// A combination is undetermined if its standard deviation after the measurement is at least this
/// part of that before.
pub const UNDETERMINED_SHARE: f64 = 1.0 / 3.0;

/// A combination of parameters that the data do not determine.
#[derive(Debug, Clone, PartialEq)]
pub struct Undetermined {
    /// Name and weight of every parameter, largest first. Weights are per standard
    /// deviation before the measurement and have unit length.
    pub weights: Vec<(String, f64)>,
    /// Its standard deviation after the measurement over the standard deviation before, up to 1.
    pub remaining: f64,
}

/// The combinations that the data determine near the optimum.
#[derive(Debug, Clone, PartialEq)]
pub struct Identifiability {
    /// Singular values of the scaled Jacobian, largest first, one per parameter: the precision of
    /// the data over that before the measurement, along each combination.
    pub singular_values: Vec<f64>,
    /// Largest over smallest singular value; infinite if the smallest is zero.
    pub condition: f64,
    /// Combinations that the data leave undetermined, the least determined first.
    pub undetermined: Vec<Undetermined>,
}

impl Linearisation {
    /// Singular values of the Jacobian with each column times the standard deviation of the
    /// parameter before the measurement: that of the prior, or `range / sqrt(12)` of the bounds, in
    /// working coordinates. Rows have the robust weights.
    ///
    /// Along a right singular vector with value `s` the standard deviation shrinks from 1 to
    /// `1 / sqrt(1 + s^2)`; the combination is undetermined if that is at least
    /// [`UNDETERMINED_SHARE`].
    ///
    /// # Errors
    ///
    /// [`InferenceError::Singular`] if the decomposition fails.
    pub fn identifiability(&self) -> Result<Identifiability, InferenceError> {
        let parameters = &self.parameters;
        let rows = self.weighted_rows();
        let before: Vec<f64> = parameters.iter().map(Parameter::initial_deviation).collect();
        // Zero rows make the matrix at least square, so that every combination appears.
        let scaled = Mat::from_fn(rows.len().max(parameters.len()), parameters.len(), |i, j| {
            rows.get(i).map_or(0.0, |row| row[j] * before[j])
        });
        let (singular_values, vectors) =
            right_singular_vectors(&scaled).ok_or(InferenceError::Singular("Jacobian"))?;
        let count = parameters.len();
        let direction = |k: usize| -> Vec<f64> {
            let largest = vectors[k].iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
            let sign = largest.map_or(1.0, |entry| entry.signum());
            vectors[k].iter().map(|entry| sign * entry).collect()
        };
        let undetermined = (0..count).rev().filter_map(|k| {
            let remaining = 1.0 / singular_values[k].hypot(1.0);
            let names = parameters.iter().map(|parameter| parameter.name().to_owned());
            let mut weights: Vec<(String, f64)> = names.zip(direction(k)).collect();
            weights.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
            (remaining >= UNDETERMINED_SHARE).then_some(Undetermined { weights, remaining })
        });
        Ok(Identifiability {
            condition: singular_values[0] / singular_values[count - 1],
            undetermined: undetermined.collect(),
            singular_values,
        })
    }
}
