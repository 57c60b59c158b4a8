//! Combinations of latents that the data inform, and those that they do not.

use faer::Mat;

use crate::error::InferenceError;
use crate::latent_prior::LatentPrior;
use crate::linear_algebra::{
    dot, right_singular_vectors, upper_root, upper_solve, upper_times, vectorised,
};
use crate::model::{ForwardModel, Observation, PredictionError, Predictions};
use crate::parameter::Parameter;
use crate::random::{generator, normal, uniform};

/// Precision of the data over the prior's above which a combination is sampled with the data. All
/// combinations below it are drawn from the prior; the importance weights contain their effect.
pub const ACTIVE_INFORMATION: f64 = 0.03;

/// Stream of the random numbers of the uninformed combinations.
const UNINFORMED: u64 = 0x1a7e;

/// Latents `z` in new coordinates `(a, c)`,
///
/// ```text
/// z = R V (a, c),    R R^T = S,    (J R)^T (J R) V = V diag(information),
/// ```
///
/// with the standardised Jacobian `J` and the pooled prior covariance `S`: `a` has the `active` largest
/// precisions, `c` the others.
pub(crate) struct LatentSubspace {
    pub(crate) first: usize,
    /// Precision of the data along every combination over the pooled prior's, largest first.
    pub(crate) information: Vec<f64>,
    pub(crate) active: usize,
    /// `R`, upper triangular.
    root: Vec<Vec<f64>>,
    /// Rows of `V^T`.
    rotation: Vec<Vec<f64>>,
    /// Logarithms of weight over volume of each component.
    log_weights: Vec<f64>,
    /// `W` of each component, upper triangular, with `W^T W` the inverse of the covariance of `a`: row
    /// after row, of each entry that of all components.
    whitenings: Vec<f64>,
    components: Vec<Component>,
}

/// A component of the prior in the coordinates `(a, c)`.
struct Component {
    /// The mean of `c` is this times `a`.
    regression: Vec<Vec<f64>>,
    /// Root of the covariance of `c` at a given `a`, upper triangular.
    rest: Vec<Vec<f64>>,
}

impl LatentSubspace {
    /// The combinations for standardised `rows` of the Jacobian with respect to the latents, and
    /// `weights` of the components in the pooled covariance.
    pub(crate) fn new(
        prior: &LatentPrior,
        rows: &[Vec<f64>],
        weights: &[f64],
    ) -> Result<Self, InferenceError> {
        let count = prior.count();
        let singular = || InferenceError::Singular("pooled covariance of the latents");
        let root = upper_root(&prior.pooled(weights)).ok_or_else(singular)?;
        let column = |row: &[f64], j: usize| (0..=j).map(|i| row[i] * root[i][j]).sum::<f64>();
        let scaled = Mat::from_fn(rows.len().max(count), count, |i, j| {
            rows.get(i).map_or(0.0, |row| column(row, j))
        });
        let (values, rotation) = right_singular_vectors(&scaled)
            .ok_or(InferenceError::Singular("Jacobian of the latents"))?;
        let information: Vec<f64> = values.iter().map(|value| value * value).collect();
        let active = information.iter().filter(|&&value| value > ACTIVE_INFORMATION).count();
        let components =
            prior.covariances().iter().zip(prior.weights()).map(|(own, weight)| {
                Component::new(&rotated(own, &root, &rotation), active, *weight)
            });
        let components = components.collect::<Option<Vec<_>>>().ok_or_else(singular)?;
        let log_weights = components.iter().map(|(log_weight, ..)| *log_weight).collect();
        let entries = active * (active + 1) / 2;
        let entry = |entry: usize| components.iter().map(move |(_, whitening, _)| whitening[entry]);
        let whitenings = (0..entries).flat_map(entry).collect();
        let components = components.into_iter().map(|(.., component)| component).collect();
        let first = prior.first();
        Ok(Self { first, information, active, root, rotation, log_weights, whitenings, components })
    }

    pub(crate) fn count(&self) -> usize {
        self.rotation.len()
    }

    /// The informed combinations of latents.
    pub(crate) fn informed(&self, z: &[f64]) -> Vec<f64> {
        let white = upper_solve(&self.root, z);
        self.rotation[..self.active].iter().map(|row| dot(row, &white)).collect()
    }

    /// The latents of combinations, zero for the uninformed ones that are not given.
    pub(crate) fn latents(&self, informed: &[f64], rest: &[f64]) -> Vec<f64> {
        let mut white = vec![0.0; self.count()];
        for (row, value) in self.rotation.iter().zip(informed.iter().chain(rest)) {
            white.iter_mut().zip(row).for_each(|(sum, entry)| *sum += value * entry);
        }
        upper_times(&self.root, &white)
    }

    /// A row of a Jacobian with respect to the latents, with respect to the informed combinations.
    pub(crate) fn informed_row(&self, row: &[f64]) -> Vec<f64> {
        let scaled: Vec<f64> = (0..row.len())
            .map(|j| (0..=j).map(|i| row[i] * self.root[i][j]).sum::<f64>())
            .collect();
        self.rotation[..self.active].iter().map(|direction| dot(direction, &scaled)).collect()
    }

    /// Logarithm of the mixture's density of informed combinations, over the density of standard
    /// normal ones.
    pub(crate) fn log_factor(&self, informed: &[f64]) -> f64 {
        let standard = 0.5 * dot(informed, informed);
        let logs = self.log_densities(informed);
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = logs.iter().map(|log| (log - largest).exp()).sum();
        largest + sum.ln() + standard
    }

    /// Logarithm of weight times density of `a`, up to a constant of all components, of each.
    ///
    /// All components side by side: sums of one after the other would wait for each other.
    fn log_densities(&self, informed: &[f64]) -> Vec<f64> {
        let count = self.components.len();
        let mut sums = vec![0.0; count];
        let mut values = vec![0.0; count];
        let mut entries = self.whitenings.chunks_exact(count.max(1));
        vectorised(|| {
            for i in 0..informed.len() {
                values.fill(0.0);
                for (coordinate, row) in informed[i..].iter().zip(&mut entries) {
                    for (value, entry) in values.iter_mut().zip(row) {
                        *value += entry * coordinate;
                    }
                }
                for (sum, value) in sums.iter_mut().zip(&values) {
                    *sum += value * value;
                }
            }
        });
        for (sum, log_weight) in sums.iter_mut().zip(&self.log_weights) {
            *sum = log_weight - 0.5 * *sum;
        }
        sums
    }

    /// The component of draw number `index`, and its latents: both depend on the seed, the index and
    /// the informed combinations alone.
    pub(crate) fn complete(&self, informed: &[f64], seed: u64, index: usize) -> (usize, Vec<f64>) {
        let mut numbers = generator(seed ^ UNINFORMED, index as u64);
        let logs = self.log_densities(informed);
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shares: Vec<f64> = logs.iter().map(|log| (log - largest).exp()).collect();
        let chosen = LatentPrior::component_at(uniform(&mut numbers), &shares);
        let Component { regression, rest, .. } = &self.components[chosen];
        let white: Vec<f64> = rest.iter().map(|_| normal(&mut numbers)).collect();
        let spread = upper_times(rest, &white);
        let rest: Vec<f64> =
            regression.iter().zip(spread).map(|(row, step)| dot(row, informed) + step).collect();
        (chosen, self.latents(informed, &rest))
    }
}

impl Component {
    /// The component of this covariance of `(a, c)`, after the logarithm of its weight over its volume and
    /// its whitening.
    fn new(covariance: &[Vec<f64>], active: usize, weight: f64) -> Option<(f64, Vec<f64>, Self)> {
        let count = covariance.len();
        let block =
            |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| -> Vec<Vec<f64>> {
                rows.map(|i| covariance[i][columns.clone()].to_vec()).collect()
            };
        let root = upper_root(&block(0..active, 0..active))?;
        let unit = |j: usize| -> Vec<f64> {
            (0..active).map(|i| if i == j { 1.0 } else { 0.0 }).collect()
        };
        let columns: Vec<Vec<f64>> = (0..active).map(|j| upper_solve(&root, &unit(j))).collect();
        let whitening =
            (0..active).flat_map(|i| columns[i..].iter().map(move |column| column[i])).collect();
        // Rows of C_ca W^T: those of the regression times the root.
        let cross = block(active..count, 0..active);
        let scaled: Vec<Vec<f64>> = cross.iter().map(|row| upper_solve(&root, row)).collect();
        let regression =
            scaled.iter().map(|row| columns.iter().map(|column| dot(column, row)).collect());
        let mut rest = block(active..count, active..count);
        for (i, row) in rest.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry -= dot(&scaled[i], &scaled[j]);
                // Rounding of what is determined exactly.
                *entry += if i == j { JITTER * covariance[active + i][active + i] } else { 0.0 };
            }
        }
        let volume: f64 = (0..active).map(|i| root[i][i].ln()).sum();
        let own = Self { regression: regression.collect(), rest: upper_root(&rest)? };
        Some((weight.ln() - volume, whitening, own))
    }
}

/// Relative variance that keeps roots of rounded covariances real.
const JITTER: f64 = 1e-9;

/// `V^T R^-1 S R^-T V`.
fn rotated(covariance: &[Vec<f64>], root: &[Vec<f64>], rotation: &[Vec<f64>]) -> Vec<Vec<f64>> {
    // Rows of S R^-T, then columns of R^-1 S R^-T.
    let half: Vec<Vec<f64>> = covariance.iter().map(|row| upper_solve(root, row)).collect();
    let count = half.len();
    let column = |j: usize| -> Vec<f64> { half.iter().map(|row| row[j]).collect() };
    let white: Vec<Vec<f64>> = (0..count).map(|j| upper_solve(root, &column(j))).collect();
    let turned: Vec<Vec<f64>> =
        white.iter().map(|row| rotation.iter().map(|v| dot(v, row)).collect()).collect();
    let entry = |i: usize, j: usize| (0..count).map(|k| rotation[i][k] * turned[k][j]).sum::<f64>();
    (0..count).map(|i| (0..count).map(|j| 0.5 * (entry(i, j) + entry(j, i))).collect()).collect()
}

/// A model in its other parameters and the informed combinations of its latents; the uninformed ones
/// are zero.
pub(crate) struct SubspaceModel<'a> {
    pub(crate) model: &'a dyn ForwardModel,
    pub(crate) subspace: &'a LatentSubspace,
    parameters: Vec<Parameter>,
}

impl<'a> SubspaceModel<'a> {
    pub(crate) fn new(model: &'a dyn ForwardModel, subspace: &'a LatentSubspace) -> Self {
        let others = model.parameters().iter().enumerate();
        let latents = subspace.first..subspace.first + subspace.count();
        let others = others.filter(|(j, _)| !latents.contains(j)).map(|(_, own)| own.clone());
        let informed = (0..subspace.active)
            .map(|k| Parameter::latent(format!("informed combination {} of latents", k + 1)));
        Self { model, subspace, parameters: others.chain(informed).collect() }
    }

    /// Number of parameters that are not combinations of latents.
    pub(crate) fn others(&self) -> usize {
        self.parameters.len() - self.subspace.active
    }

    /// The values of all parameters of the model, from the other parameters and the latents.
    pub(crate) fn point(&self, others: &[f64], latents: &[f64]) -> Vec<f64> {
        let (before, after) = others.split_at(self.subspace.first);
        [before, latents, after].concat()
    }

    /// The entries of a point or row of the model that belong to no latent, and the entries of
    /// latents.
    pub(crate) fn split(&self, all: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (first, end) = (self.subspace.first, self.subspace.first + self.subspace.count());
        ([&all[..first], &all[end..]].concat(), all[first..end].to_vec())
    }
}

impl ForwardModel for SubspaceModel<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn observations(&self) -> &[Observation] {
        self.model.observations()
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        let whole = |point: &Vec<f64>| {
            let (others, informed) = point.split_at(self.others());
            self.point(others, &self.subspace.latents(informed, &[]))
        };
        self.model.predict(&points.iter().map(whole).collect::<Vec<_>>())
    }
}
