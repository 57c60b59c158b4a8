//! The law with its credible band, and the origin of its stiffness at each pressure.
//!
//! The stiffness at a pressure is *informed* by the data if a run reaches that pressure, the
//! posterior standard deviation of ln K is at most [`INFORMED_SHARE`] of the prior one, and, of a law
//! of free form, the averaging kernel is at most [`RESOLVED`] wide: a wider one averages, or
//! extrapolates by smoothness. It is *given* if no parameter acts on it: the band then has no width,
//! and nothing was measured. See [`StiffnessOrigin`].

use asperity_inference::{ForwardModel, Posterior, prior_draws};
use serde::Serialize;

use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::latent_sampling::FreeLawFindings;
use crate::scenario_model::ScenarioModel;
use crate::stepped_sine::SimulatedSweep;
use asperity_simulation::error::SimulationError;

/// Pressures at which a law is drawn, besides the static one.
const PRESSURES: usize = 81;

/// Draws from the prior.
const PRIOR_DRAWS: usize = 400;

/// Draws of the law that are kept for figures.
const DRAWS: usize = 12;

/// Posterior over prior standard deviation of ln K up to which the data inform a stiffness.
pub const INFORMED_SHARE: f64 = 1.0 / 3.0;

/// Width of the averaging kernel in ln p up to which the data resolve a stiffness: a decade of
/// pressure.
pub const RESOLVED: f64 = std::f64::consts::LN_10;

/// Prior standard deviation of ln K up to which a stiffness counts as given.
const GIVEN: f64 = 1e-9;

/// The origin of a stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StiffnessOrigin {
    /// The data: the pressure is reached, at most a third of the uncertainty is left, and the
    /// averaging kernel of a free law is at most a decade of pressure wide.
    Data,
    /// The data at other pressures, by the smoothness of a free law: at most a third of the
    /// uncertainty is left, but the averaging kernel is wider.
    Smoothness,
    /// The form of the law as the scenario gives it: no parameter acts on the stiffness.
    Given,
    /// The parameters, which the data leave open there: bounds, priors, and the form of the law
    /// between the pressures that the data inform.
    Open,
}

impl StiffnessOrigin {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Data => "data",
            Self::Smoothness => "smoothness",
            Self::Given => "given",
            Self::Open => "open",
        }
    }

    /// The origin at a pressure that runs reach or not, from the prior deviation of ln K and the share
    /// that remains of it; `resolution` is the width of the averaging kernel of a free law.
    fn of(is_reached: bool, before: f64, remaining: f64, resolution: Option<f64>) -> Self {
        if before <= GIVEN {
            Self::Given
        } else if !(is_reached && remaining <= INFORMED_SHARE) {
            Self::Open
        } else if resolution.is_none_or(|width| width <= RESOLVED) {
            Self::Data
        } else {
            Self::Smoothness
        }
    }
}

/// The stiffness of a law at one of the pressures that its parameters are about.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StiffnessEstimate {
    /// Name of the law.
    pub law: String,
    /// Pressure \[Pa\].
    pub pressure_pa: f64,
    /// Stiffness at the best fit \[Pa/m\].
    pub stiffness_pa_per_m: f64,
    /// Interval of the posterior, with equal tails \[Pa/m\].
    pub interval_pa_per_m: [f64; 2],
    /// Posterior over prior standard deviation of ln K.
    pub remaining: f64,
    /// The origin.
    pub origin: StiffnessOrigin,
}

/// The best fit of a compared law of fixed form, at the pressures of the [`LawBand`].
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedForm {
    /// Its name in the comparison.
    pub name: String,
    /// Stiffness \[Pa/m\]; NaN where the form has none.
    pub stiffness: Vec<f64>,
}

/// A contact law as identified.
#[derive(Debug, Clone, PartialEq)]
pub struct LawBand {
    /// Its name.
    pub name: String,
    /// Pressures \[Pa\].
    pub pressure: Vec<f64>,
    /// Stiffness at the best fit \[Pa/m\].
    pub stiffness: Vec<f64>,
    /// Median of the posterior \[Pa/m\].
    pub median: Vec<f64>,
    /// Lower end of the interval \[Pa/m\].
    pub lower: Vec<f64>,
    /// Upper end of the interval \[Pa/m\].
    pub upper: Vec<f64>,
    /// Lower and upper quartile of the posterior: the band of 50 % \[Pa/m\].
    pub quartiles: [Vec<f64>; 2],
    /// Some draws from the posterior, by their weights \[Pa/m\].
    pub draws: Vec<Vec<f64>>,
    /// Posterior over prior standard deviation of ln K.
    pub remaining: Vec<f64>,
    /// The origin of the stiffness.
    pub origin: Vec<StiffnessOrigin>,
    /// True where the origin is the data.
    pub informed: Vec<bool>,
    /// Lowest and highest pressure \[Pa\] of the runs at the best fit and of measured stiffnesses.
    pub reached: [f64; 2],
    /// Static pressure at the first interface of the law \[Pa\].
    pub at_rest: f64,
    /// Stiffness there, at the best fit \[Pa/m\].
    pub stiffness_at_rest: f64,
}

impl LawBand {
    pub(super) fn new(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        name: &str,
        best: &[f64],
        (posterior, free): (&Posterior, Option<&FreeLawFindings>),
    ) -> Result<Self, IdentificationError> {
        let Reached { range: reached, at_rest } = Reached::of(forward, name, best)?;
        let range = problem.spec.pressures_pa.unwrap_or([0.0, 1.25 * reached[1]]);
        // Denser at low pressure, where laws differ most.
        let mut pressure: Vec<f64> = (0..PRESSURES)
            .map(|i| i as f64 / (PRESSURES - 1) as f64)
            .map(|part| range[0] + (range[1] - range[0]) * part * part)
            .collect();
        // Small hits inform the stiffness at rest alone.
        if (range[0]..=range[1]).contains(&at_rest) {
            let place = pressure.partition_point(|p| *p < at_rest);
            pressure.insert(place, at_rest);
            pressure.dedup();
        }
        let found = Evaluated::new(problem, forward, name, &pressure, posterior);
        let origin = found.origins(&pressure, reached, free.filter(|free| free.law == name));
        let Evaluated { quantiles: [lower, first, median, third, upper], remaining, .. } = found;
        let draws = equal_draws(posterior, DRAWS)
            .into_iter()
            .map(|draw| forward.curve(name, &pressure, &posterior.draws[draw]))
            .collect::<Result<_, _>>()?;
        let informed = origin.iter().map(|&origin| origin == StiffnessOrigin::Data).collect();
        Ok(Self {
            stiffness: forward.curve(name, &pressure, best)?,
            stiffness_at_rest: forward.curve(name, &[at_rest], best)?[0],
            name: name.to_owned(),
            pressure,
            median,
            lower,
            upper,
            quartiles: [first, third],
            draws,
            remaining,
            origin,
            informed,
            reached,
            at_rest,
        })
    }

    /// Takes the band away: without draws nothing is known of it.
    pub(super) fn leave_open(&mut self) {
        for ends in [&mut self.lower, &mut self.upper].into_iter().chain(&mut self.quartiles) {
            ends.fill(f64::NAN);
        }
        for origin in self.origin.iter_mut().filter(|origin| **origin != StiffnessOrigin::Given) {
            *origin = StiffnessOrigin::Open;
        }
        self.informed.fill(false);
        self.remaining.fill(f64::NAN);
    }

    /// The lowest and highest pressure that the data inform \[Pa\].
    pub fn informed_range(&self) -> Option<[f64; 2]> {
        let ranges = self.ranges(StiffnessOrigin::Data);
        Some([ranges.first()?[0], ranges.last()?[1]])
    }

    /// The ranges of pressure \[Pa\] with stiffnesses of an origin.
    pub fn ranges(&self, origin: StiffnessOrigin) -> Vec<[f64; 2]> {
        let pairs: Vec<(f64, StiffnessOrigin)> =
            self.pressure.iter().copied().zip(self.origin.iter().copied()).collect();
        let runs = pairs.chunk_by(|a, b| a.1 == b.1).filter(|run| run[0].1 == origin);
        runs.map(|run| [run[0].0, run[run.len() - 1].0]).collect()
    }
}

impl StiffnessEstimate {
    /// The stiffnesses at the pressures of every monotone law among the parameters.
    pub(super) fn all(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        best: &[f64],
        posterior: &Posterior,
    ) -> Result<Vec<Self>, IdentificationError> {
        let mut all = Vec::new();
        for (law, mut pressures) in forward.parameters.monotone_pressures(&forward.scenario) {
            if let Some((_, free)) =
                forward.parameters.free.as_ref().filter(|free| free.1.name == law)
            {
                // Outside its table a free law does not have these stiffnesses.
                let range = free.pressures[0]..=free.pressures[free.count() - 1];
                pressures.retain(|pressure| range.contains(pressure));
            }
            let reached = Reached::of(forward, &law, best)?.range;
            let stiffness = forward.curve(&law, &pressures, best)?;
            let found = Evaluated::new(problem, forward, &law, &pressures, posterior);
            let origin = found.origins(&pressures, reached, None);
            let [lower, _, _, _, upper] = &found.quantiles;
            all.extend((0..pressures.len()).map(|i| Self {
                law: law.clone(),
                pressure_pa: pressures[i],
                stiffness_pa_per_m: stiffness[i],
                interval_pa_per_m: [lower[i], upper[i]],
                remaining: found.remaining[i],
                origin: origin[i],
            }));
        }
        Ok(all)
    }
}

/// Quantiles of the stiffness of a law at some pressures, and its uncertainty.
struct Evaluated {
    /// Lower end of the interval, first quartile, median, third quartile, upper end.
    quantiles: [Vec<f64>; 5],
    /// Standard deviation of ln K before the measurement.
    before: Vec<f64>,
    /// Posterior over prior standard deviation of ln K.
    remaining: Vec<f64>,
}

impl Evaluated {
    fn new(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        law: &str,
        pressures: &[f64],
        posterior: &Posterior,
    ) -> Self {
        let count = pressures.len();
        let curve = |point: &[f64]| {
            forward.curve(law, pressures, point).unwrap_or_else(|_| vec![f64::NAN; count])
        };
        let tail = 0.5 * (1.0 - problem.spec.level);
        let band = posterior.band(&curve, &[tail, 0.25, 0.5, 0.75, 1.0 - tail]);
        let logarithms = |points: &[Vec<f64>]| -> Vec<Vec<f64>> {
            points.iter().map(|point| curve(point).iter().map(|k| k.ln()).collect()).collect()
        };
        let after = deviations(&logarithms(&posterior.draws), &posterior.weights);
        let mixture = forward.parameters.latent_prior().ok().flatten();
        let before =
            prior_draws(forward.parameters(), mixture.as_slice(), PRIOR_DRAWS, problem.spec.seed);
        let equal = vec![1.0 / PRIOR_DRAWS as f64; PRIOR_DRAWS];
        let before = deviations(&logarithms(&before), &equal);
        let remaining: Vec<f64> =
            after.iter().zip(&before).map(|(a, b)| if *b <= GIVEN { 0.0 } else { a / b }).collect();
        Self { quantiles: band.quantiles.try_into().unwrap_or_default(), before, remaining }
    }

    /// The origin of the stiffness at the pressures, of which runs reach a range.
    fn origins(
        &self,
        pressures: &[f64],
        reached: [f64; 2],
        free: Option<&FreeLawFindings>,
    ) -> Vec<StiffnessOrigin> {
        let origin = |(i, pressure): (usize, &f64)| {
            let is_reached = (reached[0]..=reached[1]).contains(pressure);
            // Outside the table of a free law nothing is resolved.
            let width = free.map(|free| free.resolution(*pressure).unwrap_or(f64::INFINITY));
            StiffnessOrigin::of(is_reached, self.before[i], self.remaining[i], width)
        };
        pressures.iter().enumerate().map(origin).collect()
    }
}

/// Checks a range of pressures of the problem.
pub(super) fn check_pressures(
    place: &str,
    range: Option<[f64; 2]>,
) -> Result<(), IdentificationError> {
    match range {
        Some([low, high]) if !(low >= 0.0 && high > low && high.is_finite()) => {
            Err(IdentificationError::Value {
                place: place.to_owned(),
                quantity: "pressure [Pa]",
                value: if low >= 0.0 { high } else { low },
                expected: "two pressures, the lower first and not negative",
            })
        }
        _ => Ok(()),
    }
}

/// The range of pressures of runs at the interfaces of a law and of measured stiffnesses, and the
/// static pressure \[Pa\].
pub(super) struct Reached {
    pub(super) range: [f64; 2],
    pub(super) at_rest: f64,
}

impl Reached {
    pub(super) fn of(
        forward: &ScenarioModel,
        law: &str,
        point: &[f64],
    ) -> Result<Self, SimulationError> {
        let outcomes = forward.outcomes(&[point.to_vec()]).remove(0)?;
        let rigs = forward.prepare(point)?;
        let interfaces =
            forward.scenario["interfaces"].as_array().into_iter().flatten().enumerate();
        let own = interfaces.filter(|(_, interface)| interface["law"].as_str() == Some(law));
        let own: Vec<usize> = own.map(|(index, _)| index).collect();
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        for outcome in &outcomes.hits {
            ranges.extend(own.iter().map(|&i| outcome.pressures[i]));
        }
        for sweep in &forward.sweeps {
            let responses = sweep.responses(&rigs, sweep.sensors.gains(point))?;
            let found = SimulatedSweep::pressures(&rigs[sweep.rig], &responses)?;
            ranges.extend(own.iter().map(|&i| found[i]));
        }
        let measured = forward.stiffness.iter().filter(|(of_law, _)| of_law == law);
        ranges.extend(measured.map(|&(_, pressure)| [pressure; 2]));
        let low = ranges.iter().map(|range| range[0]).fold(f64::INFINITY, f64::min);
        let high = ranges.iter().map(|range| range[1]).fold(0.0, f64::max);
        let mut used = forward.hits.iter().map(|hit| hit.rig);
        let rig = used.next().or_else(|| forward.sweeps.first().map(|sweep| sweep.rig));
        let at_rest = rig.zip(own.first());
        let at_rest = at_rest.map(|(rig, &i)| rigs[rig].at_rest().interfaces[i].pressure_pa);
        let at_rest = at_rest.unwrap_or(0.5 * (low.min(high) + high));
        Ok(Self { range: [low.min(high), high], at_rest })
    }
}

/// Indices of `count` draws that represent the posterior with equal weights: those at evenly spaced
/// places of the cumulative weight.
fn equal_draws(posterior: &Posterior, count: usize) -> Vec<usize> {
    let mut found = Vec::with_capacity(count);
    let mut below = 0.0;
    for (draw, weight) in posterior.weights.iter().enumerate() {
        below += weight;
        while found.len() < count && below * count as f64 > found.len() as f64 + 0.5 {
            found.push(draw);
        }
    }
    found
}

/// Weighted standard deviation of every column, of the finite entries.
fn deviations(rows: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let columns = rows.first().map_or(0, Vec::len);
    (0..columns)
        .map(|column| {
            let (mut total, mut sum, mut squares) = (0.0, 0.0, 0.0);
            let centre = rows.iter().map(|row| row[column]).find(|x| x.is_finite());
            let centre = centre.unwrap_or(0.0);
            for (row, &weight) in rows.iter().zip(weights) {
                let x = row[column] - centre;
                if x.is_finite() {
                    total += weight;
                    sum += weight * x;
                    squares += weight * x * x;
                }
            }
            (squares / total - (sum / total).powi(2)).max(0.0).sqrt()
        })
        .collect()
}
