//! Results of decays in words.

use asperity_signal::{DecayPoint, PeakOrigin};

use super::report::{DecayCurve, DecayLevel, MeasuredDecay};
use crate::second_peak::name as name_of_origin;

/// Part of the points at each end of a backbone whose mean is compared.
const END: usize = 6;
/// Least change in standard deviations, and over the value.
const SIGNIFICANT: f64 = 3.0;
const LEAST_CHANGE: f64 = 1e-4;
/// Least relative difference of the frequencies of two responses, and in standard deviations.
const APART: (f64, f64) = (1e-3, 5.0);
/// Least ratio of the amplitudes of a backbone over which a change is told.
const RANGE: f64 = 1.5;

/// A sentence where responses of one decay and band have different frequencies at the same times,
/// as responses of one mode cannot.
pub(super) fn disagreement(curves: &[DecayCurve]) -> Option<String> {
    let longest = curves.iter().max_by_key(|curve| curve.points.len())?;
    for other in curves.iter().filter(|other| other.index != longest.index) {
        let mut apart: Vec<(f64, f64)> = Vec::new();
        for one in &other.points {
            let time = one.point.time_s;
            let pair = longest
                .points
                .windows(2)
                .find(|pair| (pair[0].point.time_s..=pair[1].point.time_s).contains(&time));
            let Some([a, b]) = pair else { continue };
            let share = (time - a.point.time_s) / (b.point.time_s - a.point.time_s);
            let frequency =
                a.point.frequency_hz + share * (b.point.frequency_hz - a.point.frequency_hz);
            let sigma = one.uncertainty.frequency_hz.hypot(a.uncertainty.frequency_hz);
            apart.push(((one.point.frequency_hz - frequency).abs() / frequency, sigma / frequency));
        }
        let median = |of: fn(&(f64, f64)) -> f64| {
            let mut values: Vec<f64> = apart.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied()
        };
        let (Some(difference), Some(sigma)) = (median(|pair| pair.0), median(|pair| pair.1)) else {
            continue;
        };
        if difference > APART.0 && difference > APART.1 * sigma {
            return Some(format!(
                "`{}` and `{}` have frequencies {:.2} % apart at the same times: the band holds more \
                 than one mode, and neither backbone is that of one",
                longest.response,
                other.response,
                100.0 * difference
            ));
        }
    }
    None
}

/// The change of frequency and damping with amplitude, and the origin of the second harmonic, of
/// each response and band: from the backbone with the largest amplitude.
pub(super) fn conclusions(decays: &[MeasuredDecay], curves: &[DecayCurve]) -> Vec<String> {
    let mut kinds: Vec<(usize, &str)> = Vec::new();
    for curve in curves {
        if !kinds.contains(&(curve.band, &curve.response)) {
            kinds.push((curve.band, &curve.response));
        }
    }
    kinds.sort_by_key(|kind| kind.0);
    let mut sentences = Vec::new();
    for (band, response) in kinds {
        let own = curves.iter().filter(|of| of.band == band && of.response == response);
        let largest = own
            .filter_map(|curve| {
                let (first, last) = (curve.points.first()?, curve.points.last()?);
                let range = first.point.amplitude / last.point.amplitude;
                (range > RANGE).then_some((first.point.amplitude, curve))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, curve)) = largest else { continue };
        let report =
            decays.iter().flat_map(|decay| &decay.responses).find(|of| of.index == curve.index);
        let Some(report) = report else { continue };
        sentences.extend(change(curve, report.mean.as_ref()));
        let harmonic = name_of_origin(PeakOrigin::Harmonic);
        let second = report.second_harmonic.filter(|second| second.origin == Some(harmonic));
        if let Some(second) = second {
            sentences.push(format!(
                "`{response}`: the second harmonic is {:.2} % of the fundamental at {}",
                100.0 * second.ratio,
                amplitude(second.amplitude, second.amplitude_m, &curve.unit)
            ));
        }
    }
    sentences
}

/// The change of frequency and damping along a backbone, between the weighted means of both ends.
fn change(curve: &DecayCurve, mean: Option<&DecayLevel>) -> Option<String> {
    let mean = mean?;
    let count = (curve.points.len() / END).max(1);
    let large = BackboneEnd::of(curve, &curve.points[..count]);
    let small = BackboneEnd::of(curve, &curve.points[curve.points.len() - count..]);
    let (low, high) = (small.frequency_hz, large.frequency_hz);
    let frequency = if differs(low, high) {
        let (low, high, verb) = (low.0, high.0, verb(low.0, high.0));
        let change = 100.0 * (high / low - 1.0).abs();
        format!("the frequency {verb} {change:.2} %, from {low:.3} to {high:.3} Hz")
    } else {
        format!("the frequency is {:.3} Hz within its scatter", mean.frequency_hz)
    };
    let (low, high) = (small.damping_ratio, large.damping_ratio);
    let damping = if differs(low, high) {
        let (low, high, verb) = (100.0 * low.0, 100.0 * high.0, verb(low.0, high.0));
        format!("the damping ratio {verb} from {low:.3} to {high:.3} %")
    } else {
        format!("the damping ratio is {:.3} % within its scatter", 100.0 * mean.damping_ratio)
    };
    let show = |end: &BackboneEnd| amplitude(end.amplitude, end.amplitude_m, &curve.unit);
    let (name, from, to) = (&curve.response, show(&small), show(&large));
    Some(format!("`{name}`: from {from} to {to} {frequency}, and {damping}"))
}

/// Means over the points at an end of a backbone, weighted by their noise; frequency and damping with
/// the larger of the standard deviations due to noise and to scatter.
struct BackboneEnd {
    amplitude: f64,
    amplitude_m: Option<f64>,
    frequency_hz: (f64, f64),
    damping_ratio: (f64, f64),
}

impl BackboneEnd {
    fn of(curve: &DecayCurve, points: &[DecayPoint]) -> Self {
        let square = |one: &DecayPoint| one.uncertainty.frequency_hz.powi(2);
        let is_noisy = points.iter().all(|one| square(one) > 0.0);
        let weight = |one: &DecayPoint| if is_noisy { square(one).recip() } else { 1.0 };
        let sum = points.iter().map(weight).sum::<f64>();
        let squares = points.iter().map(|one| weight(one).powi(2)).sum::<f64>();
        let over = |value: &dyn Fn(&DecayPoint) -> f64| {
            points.iter().map(|one| weight(one) * value(one)).sum::<f64>() / sum
        };
        // Points a quarter of a line apart share noise: four count as one.
        let count = (0.25 * sum * sum / squares).max(1.0);
        let mean = |value: fn(&DecayPoint) -> (f64, f64)| {
            let mean = over(&|one| value(one).0);
            let noise = over(&|one| value(one).1.powi(2));
            let scatter = over(&|one| (value(one).0 - mean).powi(2));
            (mean, (noise.max(scatter) / count).sqrt())
        };
        let metres = points.iter().all(|one| curve.amplitude_m(one).is_some());
        Self {
            amplitude: over(&|one| one.point.amplitude.ln()).exp(),
            amplitude_m: metres
                .then(|| over(&|one| curve.amplitude_m(one).map_or(0.0, f64::ln)).exp()),
            frequency_hz: mean(|one| (one.point.frequency_hz, one.uncertainty.frequency_hz)),
            damping_ratio: mean(|one| (one.point.damping_ratio, one.uncertainty.damping_ratio)),
        }
    }
}

/// True for two values, with their standard deviations, whose difference is worth telling.
fn differs(low: (f64, f64), high: (f64, f64)) -> bool {
    let change = high.0 - low.0;
    change.abs() > SIGNIFICANT * low.1.hypot(high.1) && (change / low.0).abs() > LEAST_CHANGE
}

fn verb(low: f64, high: f64) -> &'static str {
    if high < low { "falls" } else { "rises" }
}

/// An amplitude in m, or else in the unit of its channel.
fn amplitude(value: f64, metres: Option<f64>, unit: &str) -> String {
    match metres {
        Some(metres) => format!("{metres:.1e} m"),
        None if unit.is_empty() => format!("{value:.1e} (no unit)"),
        None => format!("{value:.1e} {unit}"),
    }
}
