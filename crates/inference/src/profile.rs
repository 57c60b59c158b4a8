//! Profile likelihood of one parameter with all others fitted.

use crate::covariance::Covariance;
use crate::error::{InferenceError, check_level, check_size};
use crate::fit::Fit;
use crate::fit_options::FitOptions;
use crate::fit_problem::FitProblem;
use crate::progress::Stage;
use crate::random::normal_half_width;
use crate::search::{Known, Search, run};

/// Relative tolerance of the root of the deviance.
const ROOT_TOLERANCE: f64 = 2e-3;

/// Tolerance of the cost of a constrained minimum, over the deviance sought.
const COST_TOLERANCE: f64 = 1e-4;

/// Root of the deviance over the root sought from which a bracket is halved.
const WALL: f64 = 4.0;

/// Options of profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileOptions {
    /// Level of the intervals, for example 0.95.
    pub level: f64,
    /// Largest number of points on each side of the optimum.
    pub max_points: usize,
}

impl Default for ProfileOptions {
    fn default() -> Self {
        Self { level: 0.95, max_points: 16 }
    }
}

/// One point of a profile.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfilePoint {
    /// Value of the profiled parameter.
    pub value: f64,
    /// Twice the rise of the cost above the optimum: the deviance.
    pub deviance: f64,
    /// Values of all parameters at the constrained minimum.
    pub point: Vec<f64>,
}

/// The end of one side of a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProfileEnd {
    /// The deviance crosses the level: the interval ends inside the bounds.
    Crossed,
    /// The bound comes first: the interval is open on this side.
    Bound,
    /// The model has no predictions before the level is reached: open.
    NoPrediction,
    /// The points are used up: open.
    NotReached,
}

/// The profile of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Index of the parameter.
    pub parameter: usize,
    /// Points in increasing value, the optimum among them.
    pub points: Vec<ProfilePoint>,
    /// Ends of the interval, in values; on an open side the last value reached.
    pub interval: [f64; 2],
    /// Ends of the lower and the upper side.
    pub ends: [ProfileEnd; 2],
}

/// One side of a profile. The root of the deviance, which is linear for a linear model, is followed.
struct ProfileSide {
    parameter: usize,
    direction: f64,
    /// Distance from the optimum, root of the deviance, constrained minimum; the optimum first.
    found: Vec<(f64, f64, Known)>,
    next: f64,
    end: Option<ProfileEnd>,
    /// End of the interval, as a distance from the optimum.
    width: f64,
}

impl Fit<'_> {
    /// Profiles the parameters of these indices: each is moved away from the optimum and held while
    /// all others are fitted again, until the deviance (twice the rise of the cost) reaches the
    /// chi-square quantile of the level with one degree of freedom. All sides advance together, in
    /// common calls of the model.
    ///
    /// The observations' variances are multiplied by the square of the covariance's noise factor.
    /// Source: S. A. Murphy, A. W. van der Vaart, J. Am. Stat. Assoc. 95, 449 (2000).
    ///
    /// # Errors
    ///
    /// [`InferenceError::Option`] for a level outside (0, 1); [`InferenceError::Size`] for an index
    /// without a parameter or a covariance of another model.
    ///
    /// # Example
    ///
    /// ```
    /// # use asperity_inference::*;
    /// let model = FunctionModel {
    ///     parameters: vec![Parameter::linear("mean", 1.0, [-10.0, 10.0])?],
    ///     observations: Observation::list(&[1.9, 2.1], 0.1),
    ///     function: |x: &[f64]| vec![x[0]; 2],
    /// };
    /// let best = fit(&model, &FitOptions::default())?;
    /// let profiles = best.profile(&best.covariance()?, &[0], &ProfileOptions::default())?;
    /// let half_width = 1.96 * 0.1 / 2.0_f64.sqrt();
    /// assert!((profiles[0].interval[1] - 2.0 - half_width).abs() < 1e-3);
    /// # Ok::<(), InferenceError>(())
    /// ```
    pub fn profile(
        &self,
        covariance: &Covariance,
        parameters: &[usize],
        options: &ProfileOptions,
    ) -> Result<Vec<Profile>, InferenceError> {
        check_level(options.level)?;
        let problem = self.problem.with_noise_factor(covariance.noise_factor);
        let count = problem.parameters.len();
        check_size("parameters of the covariance", covariance.centre.len(), count)?;
        if let Some(&found) = parameters.iter().find(|&&j| j >= count) {
            let quantity = "as index of a parameter";
            return Err(InferenceError::Size { quantity, found, expected: count });
        }
        let target = normal_half_width(options.level);
        let optimum = self.optimum();
        let base = problem.cost(&self.residuals, &optimum);
        let accuracy = COST_TOLERANCE * target * target / (base + target * target);
        let fit_options =
            FitOptions { tolerance: self.options.tolerance.max(accuracy), ..self.options };
        let room = |side: &ProfileSide| bound_distance(&problem, &optimum, side);
        let mut sides: Vec<ProfileSide> = parameters
            .iter()
            .flat_map(|&parameter| [-1.0, 1.0].map(|direction| (parameter, direction)))
            .map(|(parameter, direction)| {
                let next = 0.5 * target * covariance.standard_deviations[parameter];
                let found = vec![(0.0, 0.0, self.known())];
                ProfileSide { parameter, direction, found, next, end: None, width: 0.0 }
            })
            .collect();
        for side in &mut sides {
            let limit = room(side);
            side.next = side.next.min(limit);
            if limit <= 0.0 {
                side.end = Some(ProfileEnd::Bound);
            }
        }
        for _ in 0..options.max_points.max(2) {
            let open: Vec<usize> = (0..sides.len()).filter(|&k| sides[k].end.is_none()).collect();
            if open.is_empty() {
                break;
            }
            let search = |&k: &usize| {
                let side = &sides[k];
                let mut held = vec![false; optimum.len()];
                held[side.parameter] = true;
                let (x, nearest) = side.start(&problem, &optimum);
                Search::near(x, held, nearest)
            };
            let mut searches: Vec<Search> = open.iter().map(search).collect();
            run(&problem, &mut searches, &fit_options, Stage::Profile, self.progress);
            for (&k, search) in open.iter().zip(searches) {
                let limit = room(&sides[k]);
                sides[k].take(&search, base, target, limit);
            }
        }
        let finish = |pair: &[ProfileSide]| gather(&problem, pair);
        Ok(sides.chunks(2).map(finish).collect())
    }
}

fn bound_distance(problem: &FitProblem<'_>, optimum: &[f64], side: &ProfileSide) -> f64 {
    let j = side.parameter;
    let bound = if side.direction > 0.0 { problem.upper[j] } else { problem.lower[j] };
    (bound - optimum[j]).abs()
}

impl ProfileSide {
    /// Start of the others, on the line through the nearest two points, and the nearest point.
    fn start(&self, problem: &FitProblem<'_>, optimum: &[f64]) -> (Vec<f64>, Known) {
        let mut near: Vec<&(f64, f64, Known)> = self.found.iter().collect();
        near.sort_by(|a, b| (a.0 - self.next).abs().total_cmp(&(b.0 - self.next).abs()));
        let nearest = &near[0].2;
        let mut x = nearest.x.clone();
        if let Some(other) = near.get(1) {
            let along = (self.next - near[0].0) / (other.0 - near[0].0);
            x.iter_mut().zip(&other.2.x).for_each(|(x, other)| *x += along * (other - *x));
        }
        x[self.parameter] = optimum[self.parameter] + self.direction * self.next;
        problem.clamp(&mut x);
        (x, nearest.clone())
    }

    /// Adds a constrained minimum and sets the next distance.
    fn take(&mut self, search: &Search, base: f64, target: f64, limit: f64) {
        let distance = self.next;
        if !search.cost.is_finite() {
            self.end = Some(ProfileEnd::NoPrediction);
            return;
        }
        let root = (2.0 * (search.cost - base)).max(0.0).sqrt();
        self.found.push((distance, root, search.known()));
        self.found.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.width = self.width.max(distance);
        if (root - target).abs() <= ROOT_TOLERANCE * target {
            (self.width, self.end) = (distance, Some(ProfileEnd::Crossed));
            return;
        }
        let above = self.found.iter().position(|found| found.1 >= target);
        let Some(above) = above else {
            if distance >= limit {
                (self.width, self.end) = (limit, Some(ProfileEnd::Bound));
                return;
            }
            // Along the secant, at most twice as far.
            let ahead = match self.found.as_slice() {
                [.., a, b] if b.1 > a.1 => b.0 + (target - b.1) * (b.0 - a.0) / (b.1 - a.1),
                _ => f64::INFINITY,
            };
            self.next = (1.02 * ahead).min(2.0 * distance).min(limit);
            return;
        };
        let (a, b) = (&self.found[above - 1], &self.found[above]);
        self.width = a.0 + (target - a.1) * (b.0 - a.0) / (b.1 - a.1);
        // Away from the ends, so that the bracket shrinks for any shape; halved in front of a wall, as of
        // a direction that the data leave open up to the bound of another parameter.
        let share = if b.1 > WALL * target { 0.5 } else { 0.02 };
        let margin = share * (b.0 - a.0);
        self.next = self.width.clamp(a.0 + margin, b.0 - margin);
        if b.0 - a.0 <= 1e-9 * b.0 {
            self.end = Some(ProfileEnd::Crossed);
        }
    }
}

fn gather(problem: &FitProblem<'_>, pair: &[ProfileSide]) -> Profile {
    let (parameter, optimum) = (pair[0].parameter, &pair[0].found[0].2.x);
    let point = |(_, root, end): &(f64, f64, Known)| {
        let point = problem.values_at(&end.x);
        ProfilePoint { value: point[parameter], deviance: root * root, point }
    };
    let mut points: Vec<ProfilePoint> = pair[0].found.iter().rev().map(point).collect();
    points.extend(pair[1].found.iter().skip(1).map(point));
    let end = |side: &ProfileSide| {
        let x = optimum[parameter] + side.direction * side.width;
        let crossed = side.found.iter().any(|f| f.1 > f64::MIN_POSITIVE && f.0 > side.width);
        let otherwise = if crossed { ProfileEnd::Crossed } else { ProfileEnd::NotReached };
        (problem.parameters[parameter].from_working(x), side.end.unwrap_or(otherwise))
    };
    let ends = [end(&pair[0]), end(&pair[1])];
    Profile { parameter, points, interval: ends.map(|end| end.0), ends: ends.map(|end| end.1) }
}
