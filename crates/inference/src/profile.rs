//! Profile likelihood: how far one unknown can go if all others follow.

use crate::covariance::Covariance;
use crate::distribution::normal_half_width;
use crate::error::{IdentifyError, check_level, check_size};
use crate::fit::{Descent, Fit, Progress, Stage, advance};
use crate::model::ForwardModel;
use crate::problem::Problem;

/// How far from the wanted root of the deviance a search may end.
const ROOT_TOLERANCE: f64 = 2e-3;

/// Options of profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileOptions {
    /// Level of the intervals, for example 0.95.
    pub level: f64,
    /// Most points on each side of the optimum.
    pub most_points: usize,
}

impl Default for ProfileOptions {
    fn default() -> Self {
        Self { level: 0.95, most_points: 16 }
    }
}

/// One point of a profile.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfilePoint {
    /// Value of the profiled unknown.
    pub value: f64,
    /// Twice the rise of the cost above the optimum: the deviance.
    pub deviance: f64,
    /// Values of all unknowns at the constrained minimum.
    pub point: Vec<f64>,
}

/// How a side of a profile ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProfileEnd {
    /// The deviance crosses the level: the interval ends inside the bounds.
    Crossed,
    /// The bound comes first: the interval is open on this side.
    Bound,
    /// The model refuses points before the level is reached: open.
    Refused,
    /// The allowed points were used up: open.
    NotReached,
}

/// The profile of one unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Index of the unknown.
    pub unknown: usize,
    /// Points in increasing value, the optimum among them.
    pub points: Vec<ProfilePoint>,
    /// Ends of the interval, in values; on an open side the last value reached.
    pub interval: [f64; 2],
    /// How the lower and the upper side ended.
    pub ends: [ProfileEnd; 2],
}

/// One side of one profile under way. The deviance is followed by its root, which is linear for
/// a linear model.
struct Side {
    unknown: usize,
    direction: f64,
    /// Distance from the optimum, root of the deviance, working coordinates; the optimum first.
    found: Vec<(f64, f64, Vec<f64>)>,
    next: f64,
    end: Option<ProfileEnd>,
    /// The interval's end as a distance.
    reach: f64,
}

/// Profiles the given unknowns: each is moved away from the optimum and held while all others
/// are fitted again, until the deviance (twice the rise of the cost) reaches the chi-square
/// quantile of the level with one degree of freedom. All sides advance together, so that one
/// call to the model serves them all.
///
/// The observations' variances are multiplied by the covariance's noise factor squared.
/// Source: S. A. Murphy, A. W. van der Vaart, J. Am. Stat. Assoc. 95, 449 (2000).
///
/// # Errors
///
/// [`IdentifyError::Option`] for a level outside (0, 1); [`IdentifyError::Size`] for an index of
/// no unknown or a fit of another model.
pub fn profile(
    model: &dyn ForwardModel,
    fit: &Fit,
    covariance: &Covariance,
    unknowns: &[usize],
    options: &ProfileOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<Profile>, IdentifyError> {
    check_level(options.level)?;
    let problem = Problem::of_fit(model, fit, covariance.noise_factor.powi(2))?;
    check_size(
        "standard deviations",
        covariance.standard_deviations.len(),
        problem.unknowns.len(),
    )?;
    if let Some(&found) = unknowns.iter().find(|&&j| j >= problem.unknowns.len()) {
        let (quantity, expected) = ("as index of an unknown", problem.unknowns.len());
        return Err(IdentifyError::Size { quantity, found, expected });
    }
    let target = normal_half_width(options.level);
    let optimum = problem.to_working(&fit.point);
    let base = problem.cost(&fit.residuals, &optimum);
    let room = |side: &Side| bound_distance(&problem, &optimum, side);
    let mut sides: Vec<Side> = unknowns
        .iter()
        .flat_map(|&unknown| [-1.0, 1.0].map(|direction| (unknown, direction)))
        .map(|(unknown, direction)| {
            let next = 0.5 * target * covariance.standard_deviations[unknown];
            let found = vec![(0.0, 0.0, optimum.clone())];
            Side { unknown, direction, found, next, end: None, reach: 0.0 }
        })
        .collect();
    for side in &mut sides {
        let limit = room(side);
        side.next = side.next.min(limit);
        if limit <= 0.0 {
            side.end = Some(ProfileEnd::Bound);
        }
    }
    for _ in 0..options.most_points.max(2) {
        let open: Vec<usize> = (0..sides.len()).filter(|&k| sides[k].end.is_none()).collect();
        if open.is_empty() {
            break;
        }
        let search = |&k: &usize| {
            let side = &sides[k];
            let mut held = vec![false; optimum.len()];
            held[side.unknown] = true;
            Descent::new(side.start(&problem, &optimum), held)
        };
        let mut searches: Vec<Descent> = open.iter().map(search).collect();
        advance(&problem, &mut searches, &fit.options, Stage::Profile, progress);
        for (&k, search) in open.iter().zip(searches) {
            let limit = room(&sides[k]);
            sides[k].take(search, base, target, limit);
        }
    }
    let finish = |pair: &[Side]| gather(&problem, pair);
    Ok(sides.chunks(2).map(finish).collect())
}

fn bound_distance(problem: &Problem<'_>, optimum: &[f64], side: &Side) -> f64 {
    let j = side.unknown;
    let bound = if side.direction > 0.0 { problem.upper[j] } else { problem.lower[j] };
    (bound - optimum[j]).abs()
}

impl Side {
    /// Where the others probably are: on the line through the nearest two points found.
    fn start(&self, problem: &Problem<'_>, optimum: &[f64]) -> Vec<f64> {
        let mut near: Vec<&(f64, f64, Vec<f64>)> = self.found.iter().collect();
        near.sort_by(|a, b| (a.0 - self.next).abs().total_cmp(&(b.0 - self.next).abs()));
        let mut x = near[0].2.clone();
        if let Some(other) = near.get(1) {
            let along = (self.next - near[0].0) / (other.0 - near[0].0);
            x.iter_mut().zip(&other.2).for_each(|(x, other)| *x += along * (other - *x));
        }
        x[self.unknown] = optimum[self.unknown] + self.direction * self.next;
        problem.clamp(&mut x);
        x
    }

    /// Takes a constrained minimum and decides where to look next.
    fn take(&mut self, search: Descent, base: f64, target: f64, limit: f64) {
        let distance = self.next;
        if !search.cost.is_finite() {
            self.end = Some(ProfileEnd::Refused);
            return;
        }
        let root = (2.0 * (search.cost - base)).max(0.0).sqrt();
        self.found.push((distance, root, search.x));
        self.found.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.reach = self.reach.max(distance);
        if (root - target).abs() <= ROOT_TOLERANCE * target {
            (self.reach, self.end) = (distance, Some(ProfileEnd::Crossed));
            return;
        }
        let above = self.found.iter().position(|found| found.1 >= target);
        let Some(above) = above else {
            if distance >= limit {
                (self.reach, self.end) = (limit, Some(ProfileEnd::Bound));
                return;
            }
            // On along the secant, at most twice as far.
            let ahead = match self.found.as_slice() {
                [.., a, b] if b.1 > a.1 => b.0 + (target - b.1) * (b.0 - a.0) / (b.1 - a.1),
                _ => f64::INFINITY,
            };
            self.next = (1.02 * ahead).min(2.0 * distance).min(limit);
            return;
        };
        let (a, b) = (&self.found[above - 1], &self.found[above]);
        self.reach = a.0 + (target - a.1) * (b.0 - a.0) / (b.1 - a.1);
        // Kept off the ends, so that the bracket shrinks whatever the shape.
        let margin = 0.02 * (b.0 - a.0);
        self.next = self.reach.clamp(a.0 + margin, b.0 - margin);
        if b.0 - a.0 <= 1e-9 * b.0 {
            self.end = Some(ProfileEnd::Crossed);
        }
    }
}

fn gather(problem: &Problem<'_>, pair: &[Side]) -> Profile {
    let (unknown, optimum) = (pair[0].unknown, &pair[0].found[0].2);
    let point = |(_, root, x): &(f64, f64, Vec<f64>)| {
        let point = problem.values_at(x);
        ProfilePoint { value: point[unknown], deviance: root * root, point }
    };
    let mut points: Vec<ProfilePoint> = pair[0].found.iter().rev().map(point).collect();
    points.extend(pair[1].found.iter().skip(1).map(point));
    let end = |side: &Side| {
        let x = optimum[unknown] + side.direction * side.reach;
        let crossed = side.found.iter().any(|f| f.1 > f64::MIN_POSITIVE && f.0 > side.reach);
        let otherwise = if crossed { ProfileEnd::Crossed } else { ProfileEnd::NotReached };
        (problem.unknowns[unknown].from_working(x), side.end.unwrap_or(otherwise))
    };
    let ends = [end(&pair[0]), end(&pair[1])];
    Profile { unknown, points, interval: ends.map(|end| end.0), ends: ends.map(|end| end.1) }
}
