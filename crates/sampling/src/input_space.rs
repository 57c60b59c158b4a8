//! From a row of the unit cube to the inputs of a model.

use crate::correlation::Correlation;
use crate::distribution::Distribution;
use crate::draws::WeightedDraws;
use crate::error::DesignError;

/// The joint distribution of the inputs of a model.
///
/// The first coordinates of the unit cube belong to inputs with a distribution of their own; one
/// more selects a draw of the inputs that are drawn together.
///
/// ```
/// use asperity_sampling::{Distribution, InputSpace, WeightedDraws};
///
/// let ratio = Distribution::uniform(0.0, 0.02)?;
/// let laws = WeightedDraws::new(&[vec![1.2, 0.4], vec![1.3, 0.3]], &[3.0, 1.0])?;
/// let inputs = InputSpace::new(vec![ratio], None, Some(laws))?;
/// assert_eq!(inputs.dimensions(), 2);
/// assert_eq!(inputs.values(&[0.5, 0.8]), [0.01, 1.3, 0.3]);
/// # Ok::<(), asperity_sampling::DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct InputSpace {
    distributions: Vec<Distribution>,
    correlation: Option<Correlation>,
    draws: Option<WeightedDraws>,
}

impl InputSpace {
    /// Inputs that do not depend on each other.
    ///
    /// # Errors
    /// [`DesignError::Count`] without inputs.
    pub fn independent(distributions: Vec<Distribution>) -> Result<Self, DesignError> {
        Self::new(distributions, None, None)
    }

    /// Inputs with distributions, which may be correlated, and inputs that are drawn together, which
    /// do not depend on the others.
    ///
    /// # Errors
    /// [`DesignError::Count`] without inputs, [`DesignError::Correlation`] for a matrix of another
    /// size than the number of distributions.
    pub fn new(
        distributions: Vec<Distribution>,
        correlation: Option<Correlation>,
        draws: Option<WeightedDraws>,
    ) -> Result<Self, DesignError> {
        if distributions.is_empty() && draws.is_none() {
            let most = crate::MOST_DIMENSIONS as u64;
            let quantity = "the number of inputs";
            return Err(DesignError::Count { quantity, value: 0, least: 1, most });
        }
        if let Some(found) = correlation.as_ref().map(Correlation::inputs)
            && found != distributions.len()
        {
            let expected = distributions.len();
            let text = format!("has {found} rows; expected {expected}, one for each distribution");
            return Err(DesignError::Correlation(text));
        }
        Ok(Self { distributions, correlation, draws })
    }

    /// Number of coordinates of the unit cube.
    pub fn dimensions(&self) -> usize {
        self.distributions.len() + usize::from(self.draws.is_some())
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.distributions.len() + self.draws.as_ref().map_or(0, WeightedDraws::columns)
    }

    /// True if distributions are correlated.
    pub fn is_correlated(&self) -> bool {
        self.correlation.is_some()
    }

    /// The inputs at a point of the unit cube: those with distributions, then those of the draw.
    ///
    /// # Panics
    /// If the point has fewer coordinates than [`dimensions`](Self::dimensions).
    pub fn values(&self, point: &[f64]) -> Vec<f64> {
        let (own, rest) = point.split_at(self.distributions.len());
        let mut values = own.to_vec();
        if let Some(correlation) = &self.correlation {
            correlation.apply(&mut values);
        }
        for (value, distribution) in values.iter_mut().zip(&self.distributions) {
            *value = distribution.quantile(*value);
        }
        if let Some(draws) = &self.draws {
            values.extend_from_slice(draws.select(rest[0]));
        }
        values
    }
}
