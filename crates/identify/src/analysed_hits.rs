//! Hits of an `analysis.json`, with the repeatability of their features.
//!
//! The scatter of repeated hits is larger than the noise of each where the point of impact or the
//! contact changes from hit to hit. Hits of one force level are repetitions; about a common line of
//! ln(feature) over ln(force) in all levels,
//!
//! ```text
//! y_i = ln(value_i) - mean over the level,    x_i = ln(force_i) - mean over the level,
//! scatter^2 = sum_i (y_i - b x_i)^2 / (n - levels - 1),    b = sum_i x_i y_i / sum_i x_i^2,
//! ```
//!
//! which removes the change with force inside a level.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use asperity_simulation::quantity::Quantity;
use serde_json::{Map, Value};

use crate::data_files::{problem, read};
use crate::error::IdentificationError;
use crate::measured_forces::{HitSource, forces_of};
use crate::problem::{Changes, HitSpec, Measured, Uncertain, default_features};

/// Least degrees of freedom of a scatter.
const LEAST_DEGREES: usize = 3;

/// The hits of an analysis.
#[derive(Debug)]
pub(super) struct AnalysedHits {
    /// The averaged hits with their available features.
    pub(super) hits: Vec<HitSpec>,
    /// The record of each.
    pub(super) sources: Vec<Option<HitSource>>,
    /// Number of the other hits.
    pub(super) left_out: usize,
    /// Relative scatter of the features over repeated hits, where it is known.
    pub(super) scatter: BTreeMap<String, f64>,
}

/// Pointers to a feature of a hit and to its standard deviation due to noise.
fn places(feature: &str) -> Option<(&'static str, Option<&'static str>)> {
    Some(match Quantity::of_name(feature)?.0 {
        Quantity::FundamentalFrequency => {
            ("/fundamental/frequency_hz", Some("/fundamental/frequency_uncertainty_hz"))
        }
        Quantity::FundamentalReceptance => {
            ("/fundamental/magnitude", Some("/fundamental/magnitude_uncertainty"))
        }
        Quantity::DampingRatio => {
            ("/fundamental/damping_ratio", Some("/fundamental/damping_ratio_uncertainty"))
        }
        Quantity::SecondHarmonicFrequency => ("/second_harmonic/frequency_hz", None),
        Quantity::SecondHarmonicReceptance => ("/second_harmonic/magnitude", None),
        Quantity::HarmonicRatio => ("/harmonic_ratio", Some("/harmonic_ratio_uncertainty")),
        _ => return None,
    })
}

const EXPECTED: &str = "the analysis.json that asperity analyse writes";

/// The analysis at `path`.
pub(super) fn read_analysis(path: &Path) -> Result<Map<String, Value>, IdentificationError> {
    serde_json::from_str(&read(path)?)
        .map_err(|error| problem(path, format!("line {}: {error}", error.line()), EXPECTED))
}

/// The averaged hits of an analysis, and their forces.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredHits {
    /// The hits with their fundamental and harmonic ratio; standard deviations are at least the scatter of
    /// repeated hits, as an identification takes them unless told otherwise.
    pub hits: Vec<HitSpec>,
    /// Times \[s\] and measured forces \[N\] of each hit, zero outside its pulse; none where the record is not found.
    pub forces: Vec<Option<(Vec<f64>, Vec<f64>)>>,
    /// Reasons why hits have no force.
    pub reasons: Vec<String>,
}

/// The averaged hits of an `analysis.json`, with the forces in the records that it names, beside it or as named.
///
/// # Errors
/// [`IdentificationError`] for a file that is not the analysis of hits, or has no averaged hit.
pub fn measured_hits(path: &Path) -> Result<MeasuredHits, IdentificationError> {
    let analysis = read_analysis(path)?;
    let found = analysed_hits(path, &analysis, &default_features(), true)?;
    let folders: Vec<PathBuf> = path.parent().map(Path::to_owned).into_iter().collect();
    let (forces, reasons) = forces_of(&found.sources, &analysis, &folders);
    Ok(MeasuredHits { hits: found.hits, forces, reasons })
}

/// The hits of an analysis with these features; with `repeated`, standard deviations are at least the
/// scatter of repeated hits. `path` is its file, or its place in the problem.
pub(super) fn analysed_hits(
    path: &Path,
    analysis: &Map<String, Value>,
    features: &[String],
    repeated: bool,
) -> Result<AnalysedHits, IdentificationError> {
    if analysis.get("schema").and_then(Value::as_str) != Some("asperity/analysis/1") {
        let found = "\"schema\" is not \"asperity/analysis/1\"".to_owned();
        return Err(problem(path, found, EXPECTED));
    }
    let list = |key: &str| analysis.get(key).and_then(Value::as_array);
    let all = list("hits").map_or(&[][..], Vec::as_slice);
    let levels = list("levels").map_or(&[][..], Vec::as_slice);
    let mut scatter = BTreeMap::new();
    for feature in features {
        let Some((value, _)) = places(feature) else {
            let text = format!("an analysis has no feature {feature}");
            return Err(problem(path, text, "features of the fundamental and the harmonic"));
        };
        if let Some(found) = repeated.then(|| scatter_of(all, levels, value)).flatten() {
            scatter.insert(feature.clone(), found);
        }
    }
    let mut hits = Vec::with_capacity(all.len());
    let mut sources = Vec::with_capacity(all.len());
    let good = |hit: &&Value| hit.get("averaged").and_then(Value::as_bool) == Some(true);
    for hit in all.iter().filter(good) {
        let number = |pointer: &str| hit.pointer(pointer).and_then(Value::as_f64);
        let Some(peak) = number("/force_peak_n") else { continue };
        let mut measured = BTreeMap::new();
        for feature in features {
            let Some((value, noise)) = places(feature) else { continue };
            let Some(value) = number(value) else { continue };
            let noise = noise.and_then(number).unwrap_or(0.0);
            let relative = scatter.get(feature).copied().unwrap_or(0.0);
            let standard_deviation = noise.max(relative * value.abs());
            let known = if standard_deviation > 0.0 {
                Measured::Uncertain(Uncertain { value, standard_deviation })
            } else {
                Measured::Alone(value)
            };
            measured.insert(feature.clone(), known);
        }
        sources.push(HitSource::of(hit));
        hits.push(HitSpec { force_peak_n: Some(peak), set: Changes::new(), features: measured });
    }
    if hits.is_empty() {
        return Err(problem(path, "the file has no averaged hit".to_owned(), EXPECTED));
    }
    Ok(AnalysedHits { left_out: all.len() - hits.len(), hits, sources, scatter })
}

/// The relative scatter of the number at `pointer` over the hits of each level.
fn scatter_of(hits: &[Value], levels: &[Value], pointer: &str) -> Option<f64> {
    let (mut xx, mut xy, mut yy, mut degrees) = (0.0, 0.0, 0.0, 0);
    for level in levels {
        let members = level.get("hits").and_then(Value::as_array)?;
        let pairs: Vec<(f64, f64)> = members
            .iter()
            .filter_map(|number| {
                let is = |hit: &&Value| hit.get("index") == Some(number);
                let hit = hits.iter().find(is)?;
                let force = hit.get("force_peak_n")?.as_f64().filter(|force| *force > 0.0)?;
                let value = hit.pointer(pointer)?.as_f64().filter(|value| *value > 0.0)?;
                Some((force.ln(), value.ln()))
            })
            .collect();
        let count = pairs.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
        let (x_mean, y_mean) = (mean(|pair| pair.0), mean(|pair| pair.1));
        for (x, y) in &pairs {
            let (x, y) = (x - x_mean, y - y_mean);
            xx += x * x;
            xy += x * y;
            yy += y * y;
        }
        degrees += pairs.len().saturating_sub(1);
    }
    let (slope_degree, reduction) = if xx > 0.0 { (1, xy * xy / xx) } else { (0, 0.0) };
    let degrees = degrees.saturating_sub(slope_degree);
    let scatter = ((yy - reduction).max(0.0) / degrees.max(1) as f64).sqrt();
    (degrees >= LEAST_DEGREES && scatter > 0.0).then_some(scatter)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Values on a line over the force in each level have no scatter but what is added.
    #[test]
    fn the_change_with_force_is_no_scatter() {
        let errors = [1.0, -2.0, 1.0, -1.0, 0.0, 1.0];
        let forces = [9.0, 10.0, 11.0, 29.0, 30.0, 31.0_f64];
        let analysis = |size: f64| -> (Vec<Value>, Vec<Value>) {
            let hit = |i: usize| {
                let value = 900.0 * forces[i].powf(-0.05) * (size * errors[i]).exp();
                json!({"index": i, "force_peak_n": forces[i], "fundamental": {"frequency_hz": value}})
            };
            let levels = vec![json!({"hits": [0, 1, 2]}), json!({"hits": [3, 4, 5]})];
            ((0..6).map(hit).collect(), levels)
        };
        let (hits, levels) = analysis(0.0);
        let none = scatter_of(&hits, &levels, "/fundamental/frequency_hz");
        assert!(none.is_none_or(|scatter| scatter < 1e-9));
        // Residuals of the common line, over 6 - 2 - 1 degrees of freedom.
        let (hits, levels) = analysis(1e-3);
        let found = scatter_of(&hits, &levels, "/fundamental/frequency_hz").unwrap();
        let centred = |values: [f64; 6]| {
            let means = [0, 3].map(|first| values[first..first + 3].iter().sum::<f64>() / 3.0);
            std::array::from_fn::<f64, 6, _>(|i| values[i] - means[i / 3])
        };
        let (x, y) = (centred(forces.map(f64::ln)), centred(errors.map(|e| 1e-3 * e)));
        let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let slope = dot(&x, &y) / dot(&x, &x);
        let left = std::array::from_fn::<f64, 6, _>(|i| y[i] - slope * x[i]);
        assert!((found / (dot(&left, &left) / 3.0).sqrt() - 1.0).abs() < 1e-9, "{found}");
        // Two levels of two hits leave one degree of freedom.
        let few = vec![json!({"hits": [0, 1]}), json!({"hits": [3, 4]})];
        assert_eq!(scatter_of(&hits, &few, "/fundamental/frequency_hz"), None);
    }
}
