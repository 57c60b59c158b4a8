//! The law with its band, and where the data inform it.

use asperity_inference::{Fit, ForwardModel, Posterior, Unknown, normal_quantile};

use crate::error::ProblemError;
use crate::forward::Forward;
use crate::read::Problem;
use crate::row::Row;
use asperity_study::error::StudyError;

/// Pressures at which a law is drawn.
const PRESSURES: usize = 81;

/// Draws of what is known beforehand.
const BEFORE: usize = 400;

/// Uncertainty left, over that beforehand, below which the data inform a stiffness.
pub const INFORMED_SHARE: f64 = 1.0 / 3.0;

/// Standard deviation of ln K beforehand at and below which a stiffness is known, not asked for.
const KNOWN: f64 = 1e-9;

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
    /// Standard deviation of ln K that is left, over that beforehand.
    pub remaining: Vec<f64>,
    /// Whether the data inform the stiffness: it was reached, and at most
    /// [`INFORMED_SHARE`] of the uncertainty is left, or there never was any.
    pub informed: Vec<bool>,
    /// Lowest and highest pressure that the best fit reaches, or that stiffness was measured at \[Pa\].
    pub reached: [f64; 2],
    /// Pressure at rest at the first interface of the law \[Pa\].
    pub at_rest: f64,
    /// Stiffness there, at the best fit \[Pa/m\].
    pub stiffness_at_rest: f64,
}

impl LawBand {
    pub(super) fn new(
        problem: &Problem,
        forward: &Forward,
        name: &str,
        best: &Fit,
        posterior: &Posterior,
    ) -> Result<Self, ProblemError> {
        let (reached, at_rest) = reached(forward, name, &best.point)?;
        let range = problem.spec.pressures_pa.unwrap_or([0.0, 1.25 * reached[1]]);
        // Crowded towards low pressure, where laws differ most.
        let pressure: Vec<f64> = (0..PRESSURES)
            .map(|i| i as f64 / (PRESSURES - 1) as f64)
            .map(|part| range[0] + (range[1] - range[0]) * part * part)
            .collect();
        let curve = |point: &[f64]| {
            forward.curve(name, &pressure, point).unwrap_or_else(|_| vec![f64::NAN; PRESSURES])
        };
        let tail = 0.5 * (1.0 - problem.spec.level);
        let band = posterior.band(&curve, &[tail, 0.5, 1.0 - tail]);
        let logarithms = |points: &[Vec<f64>]| -> Vec<Vec<f64>> {
            points.iter().map(|point| curve(point).iter().map(|k| k.ln()).collect()).collect()
        };
        let after = deviations(&logarithms(&posterior.draws), &posterior.weights);
        let before = beforehand(forward.unknowns(), problem.spec.seed);
        let equal = vec![1.0 / BEFORE as f64; BEFORE];
        let before = deviations(&logarithms(&before), &equal);
        let remaining: Vec<f64> =
            after.iter().zip(&before).map(|(a, b)| if *b <= KNOWN { 0.0 } else { a / b }).collect();
        let inside = |p: &f64| (reached[0]..=reached[1]).contains(p);
        let informed = pressure
            .iter()
            .zip(remaining.iter().zip(&before))
            .map(|(p, (&left, &before))| inside(p) && (left <= INFORMED_SHARE || before <= KNOWN))
            .collect();
        let [lower, median, upper]: [Vec<f64>; 3] = band.quantiles.try_into().unwrap_or_default();
        Ok(Self {
            stiffness: forward.curve(name, &pressure, &best.point)?,
            stiffness_at_rest: forward.curve(name, &[at_rest], &best.point)?[0],
            name: name.to_owned(),
            pressure,
            median,
            lower,
            upper,
            remaining,
            informed,
            reached,
            at_rest,
        })
    }

    /// The lowest and highest pressure that the data inform \[Pa\].
    pub fn informed_range(&self) -> Option<[f64; 2]> {
        let mut known = self.pressure.iter().zip(&self.informed).filter(|(_, informed)| **informed);
        let first = *known.next()?.0;
        Some([first, known.next_back().map_or(first, |(last, _)| *last)])
    }
}

/// Refuses pressures that are no range.
pub(super) fn check_pressures(problem: &Problem) -> Result<(), ProblemError> {
    match problem.spec.pressures_pa {
        Some([low, high]) if !(low >= 0.0 && high > low && high.is_finite()) => {
            Err(ProblemError::Value {
                place: "/pressures_pa".to_owned(),
                quantity: "pressure [Pa]",
                value: if low >= 0.0 { high } else { low },
                expected: "two pressures, the lower first and not negative",
            })
        }
        _ => Ok(()),
    }
}

/// The pressures that runs reach at the interfaces of a law, widened by those at which stiffness
/// was measured, and the pressure at rest.
fn reached(forward: &Forward, law: &str, point: &[f64]) -> Result<([f64; 2], f64), StudyError> {
    let outcomes = forward.outcomes(&[point.to_vec()]).remove(0)?;
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    let mut at_rest = None;
    let rigs = forward.prepare(point)?;
    for (strike, outcome) in forward.strikes.iter().zip(&outcomes.strikes) {
        let rig = &rigs[strike.rig].case;
        for (i, interface) in rig.assembly.structure.contacts().iter().enumerate() {
            let used = forward.scenario.pointer(&format!("/interfaces/{i}/law"));
            if used.and_then(serde_json::Value::as_str) != Some(law) {
                continue;
            }
            let number = |key: &str| {
                let column =
                    forward.columns.find(&format!("interfaces.{}.{key}", interface.name()));
                column.map_or(f64::NAN, |column| outcome.columns[column])
            };
            low = low.min(number("pressure_min_pa"));
            high = high.max(number("pressure_max_pa"));
            at_rest.get_or_insert(rig.at_rest.interfaces[i].pressure_pa);
        }
    }
    for row in &forward.rows {
        if let Row::Stiffness { place } = row
            && forward.stiffness[*place].0 == law
        {
            low = low.min(forward.stiffness[*place].1);
            high = high.max(forward.stiffness[*place].1);
        }
    }
    let at_rest = at_rest.unwrap_or(0.5 * (low.min(high) + high));
    Ok(([low.min(high), high], at_rest))
}

/// Points as likely as they are known beforehand: normal where there is a prior, else even between
/// the bounds, spread by the golden-ratio sequence of each unknown.
fn beforehand(unknowns: &[Unknown], seed: u64) -> Vec<Vec<f64>> {
    // Roots of x^(d+1) = x + 1 give a sequence that fills d dimensions evenly (Roberts, 2018).
    let dimensions = unknowns.len() as f64;
    let mut root = 2.0_f64;
    for _ in 0..60 {
        root = (1.0 + root).powf(1.0 / (dimensions + 1.0));
    }
    let offset = (seed % 1024) as f64 / 1024.0;
    (0..BEFORE)
        .map(|n| {
            let mut step = 1.0;
            let value = |unknown: &Unknown| {
                step /= root;
                let part = (offset + (n + 1) as f64 * step).fract();
                let [low, high] = unknown.bounds().map(|value| unknown.to_working(value));
                let x = match unknown.prior() {
                    Some(prior) => prior.mean + prior.standard_deviation * normal_quantile(part),
                    None => low + part * (high - low),
                };
                unknown.from_working(x)
            };
            unknowns.iter().map(value).collect()
        })
        .collect()
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
