//! Results of decays in words.

use asperity_signal::PeakOrigin;

use super::report::{DecayCurve, DecayCurveReport, DecayLevel, DecayTrend, MeasuredDecay};
use crate::hit_second_peak::name as name_of_origin;

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
        sentences.extend(change(curve, report));
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

/// The change of frequency and damping with amplitude along a backbone.
fn change(curve: &DecayCurve, report: &DecayCurveReport) -> Option<String> {
    let (mean, trends) = (report.mean?, (report.frequency_trend?, report.damping_trend?));
    let frequency = if trends.0.is_significant {
        let DecayTrend { at_smallest: low, at_largest: high, change_uncertainty, .. } = trends.0;
        let (change, sigma) = (100.0 * (high / low - 1.0).abs(), 100.0 * change_uncertainty / low);
        let verb = verb(low, high);
        format!(
            "the frequency {verb} by {change:.2} % (± {sigma:.2} %), from {low:.3} to {high:.3} Hz"
        )
    } else {
        format!("the frequency is {:.3} Hz within its scatter", mean.frequency_hz)
    };
    let damping = if trends.1.is_significant {
        let (low, high) = (100.0 * trends.1.at_smallest, 100.0 * trends.1.at_largest);
        let (sigma, verb) = (100.0 * trends.1.change_uncertainty, verb(low, high));
        format!("the damping ratio {verb} from {low:.3} to {high:.3} % (± {sigma:.3} %)")
    } else {
        format!("the damping ratio is {:.3} % within its scatter", 100.0 * mean.damping_ratio)
    };
    let show = |end: &DecayLevel| amplitude(end.amplitude, end.amplitude_m, &curve.unit);
    let name = &curve.response;
    let (from, to) = (show(report.smallest.as_ref()?), show(report.largest.as_ref()?));
    Some(format!("`{name}`: from {from} to {to} {frequency}, and {damping}"))
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
