//! Proposed hits.

use asperity_figure::{Axis, Color, Figure, Legend, Marker, Panel, Series};
use asperity_identify::problem::Changes;
use asperity_identify::{CandidateHit, DesignRanking};

use super::fitted;
use super::observations::groups;

/// Most changes of the rig that are drawn.
const MOST_CHANGES: usize = 7;

/// The uncertainty of the law left, and the information about all parameters, over force.
pub(super) fn design(design: &DesignRanking) -> Figure {
    let force = || Axis::linear("Peak force", "N");
    let label = "Uncertainty of ln K left";
    let left = Axis::linear(label, "").range(0.0, 1.05);
    let mut left = Panel::new(force(), left).legend(Legend::Above);
    let mut gained =
        Panel::new(force(), Axis::linear("Information", "nat").low(0.0)).legend(Legend::None);
    let rigs = groups(&design.candidates, |hit| &hit.set).into_iter().take(MOST_CHANGES);
    for (index, (set, mut hits)) in rigs.enumerate() {
        hits.sort_by(|a, b| a.force_peak_n.total_cmp(&b.force_peak_n));
        let x: Vec<f64> = hits.iter().map(|hit| hit.force_peak_n).collect();
        let line = |name: String, value: fn(&CandidateHit) -> f64| {
            let y: Vec<f64> = hits.iter().map(|hit| value(hit)).collect();
            y.iter().any(|y| y.is_finite()).then(|| {
                let series = Series::line_points(name, &x, y).color(Color::category(index));
                series.marker(Marker::Circle)
            })
        };
        left = left.all_series(line(fitted(&changes(set), 44), |hit| hit.remaining));
        gained = gained.all_series(line(String::new(), |hit| hit.information));
    }
    if let Some(first) = design.sequence.first() {
        left = left.note(first.force_peak_n, first.remaining, "first");
    }
    Figure::new("Hits to come").panel(left).panel(gained).columns(2).width_mm(170.0)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_named_by_their_last_keys() {
        let set = |text: &str| serde_json::from_str::<Changes>(text).unwrap_or_default();
        assert_eq!(changes(&set("{}")), "as it is");
        assert_eq!(changes(&set(r#"{"/bodies/0/mass_kg": 3.2}"#)), "bodies/0/mass_kg = 3.2");
        assert_eq!(changes(&set(r#"{"/duration_s": 1}"#)), "duration_s = 1");
    }

    #[test]
    fn hits_of_one_rig_stay_together() {
        let hit = |force_peak_n: f64, text: &str| CandidateHit {
            force_peak_n,
            set: serde_json::from_str(text).unwrap_or_default(),
            remaining: 0.5,
            information: 1.0,
        };
        let hits = [hit(1.0, "{}"), hit(1.0, r#"{"/a": 1}"#), hit(2.0, "{}")];
        let groups = groups(&hits, |hit| &hit.set);
        assert_eq!(groups.iter().map(|group| group.1.len()).collect::<Vec<_>>(), [2, 1]);
    }
}
