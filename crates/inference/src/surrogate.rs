//! A response surface: polynomials that replace the model near the optimum.

use std::time::{Duration, Instant};

use faer::Mat;

use crate::covariance::Covariance;
use crate::error::{InferenceError, check_range};
use crate::fit_problem::FitProblem;
use crate::linear_algebra::{dot, upper_solve, upper_times, vectorised};
use crate::model::Predictions;
use crate::polynomial::{Cubics, LeastSquares, Monomials};
use crate::profile::Profile;
use crate::progress::{ProgressCallback, Stage, report};
use crate::random::{generator, latin_hypercube, normal, normal_quantile};

/// Largest number of parameters with all cubic terms, and with those of two parameters.
const MAX_CUBIC: usize = 10;
const MAX_CUBIC_OF_TWO: usize = 20;
/// Standard deviation of the training points in whitened coordinates.
const SPREAD: f64 = 1.3;
/// Farthest training point in each whitened coordinate.
const TRAINING_RANGE: f64 = 4.0;
/// Largest whitened coordinate of the surface, extrapolated beyond the training points: wrong draws
/// there lose weight, and draws outside the range do not exist.
pub(crate) const RANGE: f64 = 6.0;
/// Largest share of training points at which a prediction may be missing.
const MAX_MISSING: f64 = 0.5;

/// Whitened coordinates `z` with unit covariance: `x = centre + root z`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Whitening {
    pub(crate) centre: Vec<f64>,
    /// Upper triangular.
    pub(crate) root: Vec<Vec<f64>>,
}

impl Whitening {
    /// The whitening of a covariance.
    pub(crate) fn of(covariance: &Covariance) -> Self {
        Self { centre: covariance.centre.clone(), root: covariance.root.clone() }
    }

    pub(crate) fn to_working(&self, z: &[f64]) -> Vec<f64> {
        let step = upper_times(&self.root, z);
        self.centre.iter().zip(step).map(|(centre, step)| centre + step).collect()
    }

    /// Half as wide.
    pub(crate) fn halved(&self) -> Self {
        let root = self.root.iter().map(|row| row.iter().map(|entry| 0.5 * entry).collect());
        Self { centre: self.centre.clone(), root: root.collect() }
    }

    /// Regression of all coordinates on number `j`: `C[i][j] / C[j][j]`.
    fn spread_with(&self, j: usize) -> Vec<f64> {
        let product = |i: usize| dot(&self.root[i], &self.root[j]);
        (0..self.root.len()).map(|i| product(i) / product(j)).collect()
    }

    pub(crate) fn to_white(&self, x: &[f64]) -> Vec<f64> {
        let step: Vec<f64> = x.iter().zip(&self.centre).map(|(x, centre)| x - centre).collect();
        upper_solve(&self.root, &step)
    }
}

/// Points (working coordinates) with the model's predictions.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Training {
    pub(crate) points: Vec<Vec<f64>>,
    pub(crate) predictions: Vec<Predictions>,
}

impl Training {
    /// Adds the points that have predictions.
    pub(crate) fn extend<'a>(
        &mut self,
        points: &[Vec<f64>],
        answers: impl Iterator<Item = &'a Result<Predictions, String>>,
    ) {
        for (x, answer) in points.iter().zip(answers) {
            if let Ok(predictions) = answer {
                self.points.push(x.clone());
                self.predictions.push(predictions.clone());
            }
        }
    }
}

/// Polynomials of degree three (without products of three parameters above ten of them, and of degree two above
/// twenty) in whitened coordinates `z`, with
/// `x = optimum + L z` and `L L^T` the covariance, one for every observation's standardised
/// residual.
///
/// They are trained on a Latin hypercube of normal points with standard deviation 1.3, clipped
/// to `|z| <= 4` and moved inside the bounds. Training points without predictions are left out. An
/// observation without a prediction at some points is fitted to the others; more than half is an
/// error.
pub(crate) struct Surrogate {
    /// Root mean square error at left-out points for every observation, in units of its
    /// standard deviation.
    pub(crate) leave_one_out_errors: Vec<f64>,
    pub(crate) whitening: Whitening,
    monomials: Monomials,
    /// For every monomial a coefficient per observation.
    coefficients: Vec<f64>,
}

impl Surrogate {
    pub(crate) fn from_training(
        problem: &FitProblem<'_>,
        whitening: Whitening,
        training: &Training,
    ) -> Result<Self, InferenceError> {
        let monomials = monomials(problem.parameters.len());
        let (points, terms) = (training.points.len(), monomials.count());
        if points <= terms {
            return Err(InferenceError::TooFewTraining { answered: points, needed: terms + 1 });
        }
        let mut values = Vec::with_capacity(terms);
        let rows: Vec<Vec<f64>> = training
            .points
            .iter()
            .map(|x| {
                monomials.values(&whitening.to_white(x), &mut values);
                values.clone()
            })
            .collect();
        let design = |which: &[usize]| {
            LeastSquares::new(Mat::from_fn(which.len(), terms, |i, k| rows[which[i]][k]))
        };
        let all: Vec<usize> = (0..points).collect();
        let common = design(&all);
        let mut coefficients: Vec<Vec<f64>> = Vec::new();
        let mut leave_one_out_errors = Vec::new();
        for (i, observation) in problem.observations.iter().enumerate() {
            let target = |&point: &usize| {
                let prediction = training.predictions[point][i]?;
                Some((prediction - observation.value) / observation.standard_deviation)
            };
            let answered: Vec<usize> =
                all.iter().copied().filter(|k| target(k).is_some()).collect();
            let missing = points - answered.len();
            if missing as f64 > MAX_MISSING * points as f64 {
                let label = observation.label.clone();
                return Err(InferenceError::MissingPredictions { label, missing, points });
            }
            if answered.len() <= terms {
                let answered = answered.len();
                return Err(InferenceError::TooFewTraining { answered, needed: terms + 1 });
            }
            let targets: Vec<f64> = answered.iter().filter_map(target).collect();
            let own = (missing > 0).then(|| design(&answered));
            let fitted = own.as_ref().unwrap_or(&common).fit(&targets);
            let fitted = fitted.ok_or(InferenceError::Singular("training matrix"))?;
            coefficients.push(fitted.coefficients);
            leave_one_out_errors.push(fitted.leave_one_out_error);
        }
        let coefficients =
            (0..terms).flat_map(|k| coefficients.iter().map(move |row| row[k])).collect();
        Ok(Self { leave_one_out_errors, whitening, monomials, coefficients })
    }

    /// Standardised residuals at whitened coordinates; `scratch` holds the monomials.
    pub(crate) fn residuals(&self, z: &[f64], scratch: &mut Vec<f64>, out: &mut Vec<f64>) {
        out.clear();
        out.resize(self.leave_one_out_errors.len(), 0.0);
        polynomials((&self.monomials, &self.coefficients), z, scratch, out);
    }
}

/// Polynomials of `z` with rows of `coefficients`, one row for each of the `monomials`, into `out`.
fn polynomials(
    (monomials, coefficients): (&Monomials, &[f64]),
    z: &[f64],
    scratch: &mut Vec<f64>,
    out: &mut [f64],
) {
    monomials.values(z, scratch);
    // Term by term: neighbouring observations fill the vector registers.
    vectorised(|| {
        for (row, value) in coefficients.chunks_exact(out.len()).zip(&*scratch) {
            for (sum, coefficient) in out.iter_mut().zip(row) {
                *sum += coefficient * value;
            }
        }
    });
}

/// Seconds of an evaluation of a response surface of so many parameters and observations, as this machine takes them.
pub(crate) fn evaluation_seconds(parameters: usize, observations: usize) -> f64 {
    let monomials = monomials(parameters);
    let coefficients = vec![0.0; monomials.count() * observations.max(1)];
    let (z, mut scratch) = (vec![0.5; parameters], Vec::new());
    let mut out = vec![0.0; observations.max(1)];
    let begun = Instant::now();
    let mut evaluations = 0_u32;
    while evaluations < 3 || begun.elapsed() < MEASURED {
        polynomials((&monomials, &coefficients), &z, &mut scratch, &mut out);
        std::hint::black_box(&out);
        evaluations += 1;
    }
    begun.elapsed().as_secs_f64() / f64::from(evaluations)
}

/// Training points of a surface of so many parameters.
pub(crate) fn training_points(parameters: usize, oversampling: f64) -> usize {
    (oversampling * monomials(parameters).count() as f64).ceil() as usize
}

/// Time for which a response surface is evaluated, to learn what an evaluation takes.
const MEASURED: Duration = Duration::from_millis(1);

fn monomials(parameters: usize) -> Monomials {
    let cubics = if parameters <= MAX_CUBIC {
        Cubics::All
    } else if parameters <= MAX_CUBIC_OF_TWO {
        Cubics::OfTwo
    } else {
        Cubics::None
    };
    Monomials::new(parameters, cubics)
}

/// The working coordinates at `z` or `-z`, moved towards the centre until they are inside the bounds,
/// which keeps the shape of a long, thin distribution. Where the centre is in a corner and neither
/// leads inside, each coordinate is clipped on its own.
fn inside(problem: &FitProblem<'_>, whitening: &Whitening, z: &[f64]) -> Vec<f64> {
    let centre = &whitening.centre;
    let ends = [1.0, -1.0].map(|sign| {
        let z: Vec<f64> = z.iter().map(|z| sign * z).collect();
        let end = whitening.to_working(&z);
        let share = end.iter().enumerate().map(|(j, &end)| {
            let bound = end.clamp(problem.lower[j], problem.upper[j]);
            if bound == end { 1.0 } else { (bound - centre[j]) / (end - centre[j]) }
        });
        (share.fold(1.0_f64, f64::min).max(0.0), end)
    });
    let (share, end) = if ends[0].0 >= ends[1].0 { &ends[0] } else { &ends[1] };
    let share = if *share < 0.3 { 1.0 } else { *share };
    let mut x: Vec<f64> = centre.iter().zip(end).map(|(c, end)| c + share * (end - c)).collect();
    problem.clamp(&mut x);
    x
}

/// Space-filling points about the centre, with the model's predictions.
pub(crate) fn sample(
    problem: &FitProblem<'_>,
    whitening: &Whitening,
    profiles: &[Profile],
    oversampling: f64,
    seed: u64,
    progress: &ProgressCallback<'_>,
) -> Result<Training, InferenceError> {
    let dimensions = problem.parameters.len();
    let quantity = "the number of training points per coefficient";
    check_range(quantity, oversampling, 1.2..=100.0, "1.2 to 100")?;
    let count = training_points(dimensions, oversampling);
    let place = |unit: &Vec<f64>| {
        let z: Vec<f64> = unit
            .iter()
            .map(|&u| (SPREAD * normal_quantile(u)).clamp(-TRAINING_RANGE, TRAINING_RANGE))
            .collect();
        inside(problem, whitening, &z)
    };
    let mut points: Vec<Vec<f64>> =
        latin_hypercube(count, dimensions, seed).iter().map(place).collect();
    points.extend(along(problem, whitening, profiles, count, seed));
    let count = points.len();
    let answers = problem.predict(&points);
    report(progress, Stage::Surrogate, count, count);
    let mut training = Training::default();
    training.extend(&points, answers.iter());
    Ok(training)
}

/// Points along profiles, for a long, curved distribution: `count` over all of them, each displaced
/// from its profile as the other parameters scatter at a fixed value of the profiled one.
fn along(
    problem: &FitProblem<'_>,
    whitening: &Whitening,
    profiles: &[Profile],
    count: usize,
    seed: u64,
) -> Vec<Vec<f64>> {
    let mut numbers = generator(seed, ALONG);
    let each = count.div_ceil(profiles.len().max(1));
    let mut points = Vec::with_capacity(each * profiles.len());
    for profile in profiles {
        let j = profile.parameter;
        let path: Vec<Vec<f64>> =
            profile.points.iter().map(|point| problem.to_working(&point.point)).collect();
        let [Some(first), Some(last)] = [path.first(), path.last()] else { continue };
        let (start, length) = (first[j], last[j] - first[j]);
        let spread = whitening.spread_with(j);
        for n in 0..each {
            let at = start + length * (n as f64 + 0.5) / each as f64;
            let Some(pair) = path.windows(2).find(|pair| at <= pair[1][j]) else { continue };
            let share = ((at - pair[0][j]) / (pair[1][j] - pair[0][j])).clamp(0.0, 1.0);
            let z: Vec<f64> = (0..path[0].len()).map(|_| normal(&mut numbers)).collect();
            let step = upper_times(&whitening.root, &z);
            let mut x: Vec<f64> = (0..step.len())
                .map(|i| {
                    let middle = pair[0][i] + share * (pair[1][i] - pair[0][i]);
                    middle + step[i] - spread[i] * step[j]
                })
                .collect();
            problem.clamp(&mut x);
            points.push(x);
        }
    }
    points
}

/// Stream of the random numbers along profiles.
const ALONG: u64 = 0xa109;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Fit, fit};
    use crate::fit_options::FitOptions;
    use crate::model::{ForwardModel, FunctionModel, Observation, PredictionError};
    use crate::parameter::Parameter;

    fn train(found: &Fit<'_>, oversampling: f64, seed: u64) -> Result<Surrogate, InferenceError> {
        let whitening = Whitening::of(&found.covariance().unwrap());
        let problem = &found.problem;
        let training = sample(problem, &whitening, &[], oversampling, seed, found.progress)?;
        Surrogate::from_training(problem, whitening, &training)
    }

    fn linear(name: &str, start: f64, bounds: [f64; 2]) -> Parameter {
        Parameter::linear(name, start, bounds).unwrap()
    }

    /// A cubic model is copied to rounding; of another one the leave-out error is what fresh points
    /// show, within a factor of two (a root mean square of heavy tails over 1000 points each).
    #[test]
    fn a_cubic_is_copied_and_the_error_of_others_is_known() {
        let cubic = |x: &[f64]| vec![x[0] + 0.1 * x[1].powi(3), x[0] * x[1] + x[1], x[1]];
        let model = FunctionModel {
            parameters: vec![linear("a", 0.5, [-9.0, 9.0]), linear("b", 0.5, [-9.0, 9.0])],
            observations: Observation::list(&[1.0, 0.5, 0.4], 0.3),
            function: cubic,
        };
        let found = fit(&model, &FitOptions::default()).unwrap();
        let surface = train(&found, 2.5, 1).unwrap();
        assert!(surface.leave_one_out_errors.iter().all(|&error| error < 1e-9));
        let there = [found.point[0] + 0.2, found.point[1] - 0.3];
        let expected = (cubic(&there)[0] - 1.0) / 0.3;
        let mut residuals = Vec::new();
        surface.residuals(&surface.whitening.to_white(&there), &mut Vec::new(), &mut residuals);
        assert!((residuals[0] - expected).abs() < 1e-9);

        let model = FunctionModel {
            parameters: model.parameters,
            observations: model.observations,
            function: |x: &[f64]| vec![(x[0] - x[1]).exp(), x[0], x[1]],
        };
        let found = fit(&model, &FitOptions::default()).unwrap();
        let [surface, fresh] = [3, 4].map(|seed| train(&found, 100.0, seed).unwrap());
        let error = surface.leave_one_out_errors[0];
        assert!(error > 1e-4, "{error}");
        // Another seed's training points are fresh ones for this surface.
        let ratio = fresh.leave_one_out_errors[0] / error;
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
    }

    /// A second answer that exists only for `x > 0`.
    struct Half {
        parameters: Vec<Parameter>,
        observations: Vec<Observation>,
    }

    impl ForwardModel for Half {
        fn parameters(&self) -> &[Parameter] {
            &self.parameters
        }

        fn observations(&self) -> &[Observation] {
            &self.observations
        }

        fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
            points.iter().map(|x| Ok(vec![Some(x[0]), (x[0] > 0.05).then_some(x[0])])).collect()
        }
    }

    #[test]
    fn an_observation_that_is_often_missing_is_refused_by_name() {
        let model = Half {
            parameters: vec![linear("x", 0.1, [-9.0, 0.2])],
            observations: Observation::list(&[0.1, 0.1], 1.0),
        };
        let found = fit(&model, &FitOptions::default()).unwrap();
        let error = train(&found, 2.5, 1).err();
        assert!(
            matches!(&error, Some(InferenceError::MissingPredictions { label, .. }) if label == "y1"),
            "{error:?}"
        );
    }
}
