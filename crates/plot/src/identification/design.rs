//! Proposed measurements.

use asperity_figure::{Axis, Color, Figure, Legend, Marker, Panel, Series};
use asperity_identify::problem::Changes;
use asperity_identify::{CandidateMeasurement, DesignRanking, MeasurementKind};

use asperity_scenario::four_digits;

use super::observations::groups;
use crate::axes::{pointer_value, pointer_words};
use crate::fitted;

/// Most changes of the rig that are drawn.
const MOST_CHANGES: usize = 7;

/// A kind of hits with what is expected from them.
struct ProposedHits<'a> {
    force_peak_n: f64,
    set: &'a Changes,
    expected: &'a CandidateMeasurement,
}

/// The uncertainty of the law left, and the information about all parameters: of hits over force, of
/// quasi-static stiffnesses over pressure.
pub(super) fn design(design: &DesignRanking) -> Figure {
    let hits: Vec<ProposedHits<'_>> = design.candidates.iter().filter_map(proposed_hits).collect();
    let figure = Figure::new("Measurements to come").columns(2).width_mm(170.0);
    let [mut left, mut gained] = panels("Peak force", "N", 1.0);
    let rigs = groups(&hits, |hit| hit.set).into_iter().take(MOST_CHANGES);
    for (index, (set, mut hits)) in rigs.enumerate() {
        hits.sort_by(|a, b| a.force_peak_n.total_cmp(&b.force_peak_n));
        let x: Vec<f64> = hits.iter().map(|hit| hit.force_peak_n).collect();
        let line = |name: String, value: fn(&CandidateMeasurement) -> f64| {
            let y: Vec<f64> = hits.iter().map(|hit| value(hit.expected)).collect();
            y.iter()
                .any(|y| y.is_finite())
                .then(|| Series::line_points(name, &x, y).category(index))
        };
        left = left.all_series(line(fitted(&in_words(set), 44), |one| one.remaining));
        gained = gained.all_series(line(String::new(), |one| one.information));
    }
    let first = design.sequence.first();
    if let Some(hits) = first.and_then(proposed_hits) {
        left = left.note(hits.force_peak_n, hits.expected.remaining, "first");
    }
    let figure = if hits.is_empty() { figure } else { figure.panel(left).panel(gained) };

    let points: Vec<(f64, &CandidateMeasurement)> =
        design.candidates.iter().filter_map(|one| Some((pressure(one)?, one))).collect();
    if points.is_empty() {
        return figure;
    }
    let [left, gained] = panels("Pressure of a quasi-static stiffness", "MPa", 1e-6);
    let x: Vec<f64> = points.iter().map(|point| point.0).collect();
    let points = |value: fn(&CandidateMeasurement) -> f64| {
        let y: Vec<f64> = points.iter().map(|point| value(point.1)).collect();
        Series::line_points("", &x, y).color(Color::BLUE).marker(Marker::Square)
    };
    let mut left = left.series_if_visible(points(|one| one.remaining)).legend(Legend::None);
    if let Some((pressure, one)) = first.and_then(|one| Some((pressure(one)?, one))) {
        left = left.note(pressure, one.remaining, "first");
    }
    figure.panel(left).panel(gained.series_if_visible(points(|one| one.information)))
}

/// Panels of the uncertainty left and of the information over a quantity.
fn panels(label: &str, unit: &str, scale: f64) -> [Panel; 2] {
    let over = || Axis::linear(label, unit).scale(scale);
    let left = Axis::linear("Deviation of ln K, then over now", "").range(0.0, 1.05);
    let gained = Axis::linear("Information", "nat").low(0.0);
    [
        Panel::new(over(), left).legend(Legend::Above),
        Panel::new(over(), gained).legend(Legend::None),
    ]
}

fn proposed_hits(expected: &CandidateMeasurement) -> Option<ProposedHits<'_>> {
    match &expected.kind {
        &MeasurementKind::Hits { force_peak_n, ref set } => {
            Some(ProposedHits { force_peak_n, set, expected })
        }
        MeasurementKind::Stiffness { .. } => None,
    }
}

/// Pressure of a quasi-static stiffness \[Pa\].
fn pressure(of: &CandidateMeasurement) -> Option<f64> {
    match of.kind {
        MeasurementKind::Stiffness { pressure_pa } => Some(pressure_pa),
        MeasurementKind::Hits { .. } => None,
    }
}

/// A measurement in words.
pub fn measurement(kind: &MeasurementKind) -> String {
    match kind {
        MeasurementKind::Hits { force_peak_n, set } if set.is_empty() => {
            format!("hits of {} N", four_digits(*force_peak_n))
        }
        MeasurementKind::Hits { force_peak_n, set } => {
            format!("hits of {} N with {}", four_digits(*force_peak_n), changes(set))
        }
        MeasurementKind::Stiffness { pressure_pa } => {
            format!("quasi-static stiffness at {} MPa", four_digits(1e-6 * pressure_pa))
        }
    }
}

/// Changes of a rig in words: the last three keys of each pointer and the value.
pub(super) fn changes(set: &Changes) -> String {
    if set.is_empty() {
        return "as it is".to_owned();
    }
    let one = |(pointer, value): (&String, &serde_json::Value)| {
        let keys: Vec<&str> = pointer.split('/').skip(1).collect();
        format!("{} = {value}", keys[keys.len().saturating_sub(3)..].join("/"))
    };
    set.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Changes of a rig with the words of their values, for a legend.
fn in_words(set: &Changes) -> String {
    if set.is_empty() {
        return changes(set);
    }
    let one = |(pointer, value): (&String, &serde_json::Value)| {
        let (words, value) = (pointer_words(pointer).0, pointer_value(pointer, &value.to_string()));
        if value.starts_with(&words) { value } else { format!("{words}: {value}") }
    };
    set.iter().map(one).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_named_by_their_last_keys() {
        let set = |text: &str| serde_json::from_str::<Changes>(text).unwrap_or_default();
        assert_eq!(changes(&set("{}")), "as it is");
        assert_eq!(changes(&set(r#"{"/bodies/0/mass_kg": 3.2}"#)), "bodies/0/mass_kg = 3.2");
        assert_eq!(in_words(&set(r#"{"/bodies/0/mass_kg": 3.2}"#)), "Mass of body 1: 3.2 kg");
        assert_eq!(in_words(&set(r#"{"/damping/ratio": 0.02}"#)), "Damping ratio 0.02");
        assert_eq!(changes(&set(r#"{"/duration_s": 1}"#)), "duration_s = 1");
    }

    #[test]
    fn hits_of_one_rig_stay_together() {
        let kind = |force_peak_n: f64, text: &str| MeasurementKind::Hits {
            force_peak_n,
            set: serde_json::from_str(text).unwrap_or_default(),
        };
        let one = |kind| CandidateMeasurement { kind, remaining: 0.5, information: 1.0 };
        let kinds = [kind(1.0, "{}"), kind(1.0, r#"{"/a": 1}"#), kind(2.0, "{}")];
        let all = kinds.map(one);
        let hits: Vec<ProposedHits<'_>> = all.iter().filter_map(proposed_hits).collect();
        let groups = groups(&hits, |hit| hit.set);
        assert_eq!(groups.iter().map(|group| group.1.len()).collect::<Vec<_>>(), [2, 1]);
        assert_eq!(measurement(&all[2].kind), "hits of 2 N");
        assert_eq!(measurement(&all[1].kind), "hits of 1 N with a = 1");
        let static_one = MeasurementKind::Stiffness { pressure_pa: 2e4 };
        assert_eq!(measurement(&static_one), "quasi-static stiffness at 0.02 MPa");
    }
}
