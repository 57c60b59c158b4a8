//! Laws compared.

use asperity_figure::{Anchor, Axis, Color, Figure, Legend, Marker, Panel, Series};
use asperity_inference::{ComparedModel, ModelAssessment, ModelComparison};

use crate::fitted;

/// Scores of left-out hits and information criteria, each less that of the best.
pub(super) fn comparison(choice: &ModelComparison) -> Figure {
    let count = choice.candidates.len();
    let best = choice.candidates.get(choice.best);
    let place = |index: usize| (count - index) as f64;
    let names = |shown: bool| {
        let name = move |(index, candidate): (usize, &ComparedModel)| {
            (place(index), if shown { fitted(&candidate.name, 34) } else { String::new() })
        };
        let ticks: Vec<(f64, String)> = choice.candidates.iter().enumerate().map(name).collect();
        Axis::linear("", "").range(0.4, count as f64 + 0.6).ticks(ticks)
    };
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let score = |candidate: &ComparedModel| candidate.score_difference.and_then(finite);
    let aicc = |candidate: &ComparedModel| finite(candidate.aicc - best?.aicc);
    let scores =
        panel("Score minus the best score (nat)", names(true), choice, &place, &score, true);
    let criteria = panel("AICc minus the lowest AICc", names(false), choice, &place, &aicc, false);
    let height = 26.0 + 9.0 * count as f64;
    let figure = Figure::new("Laws compared").panel(scores).panel(criteria).columns(2);
    figure.width_mm(175.0).row_height_mm(height.clamp(40.0, 200.0))
}

fn panel(
    label: &str,
    names: Axis,
    choice: &ModelComparison,
    place: &dyn Fn(usize) -> f64,
    value: &dyn Fn(&ComparedModel) -> Option<f64>,
    errors: bool,
) -> Panel {
    let error = |candidate: &ComparedModel| {
        candidate.difference_error.filter(|error| errors && error.is_finite())
    };
    let reach = |candidate: &ComparedModel| {
        let (x, error) = (value(candidate)?, error(candidate).unwrap_or(0.0));
        Some([x - error, x + error])
    };
    let ends = || choice.candidates.iter().filter_map(reach).flatten();
    let (low, high) = (ends().fold(0.0, f64::min), ends().fold(0.0, f64::max));
    let room = 0.1 * (high - low).max(1.0);
    let across = Axis::linear(label, "").range(low - room, high + room);
    let mut panel = Panel::new(across, names).vertical(0.0, "");
    for (index, candidate) in choice.candidates.iter().enumerate() {
        let Some(x) = value(candidate) else { continue };
        let (color, marker) = match candidate.assessment {
            ModelAssessment::Best => (Color::GREEN, Marker::Circle),
            ModelAssessment::Undecided => (Color::ORANGE, Marker::Diamond),
            ModelAssessment::Rejected { .. } | ModelAssessment::Misfit { .. } => {
                (Color::RED, Marker::Cross)
            }
        };
        let series = Series::points("", [x], [place(index)]).color(color).filled(true);
        let mut series = series.marker(marker).marker_size(5.0);
        if let Some(error) = error(candidate) {
            series = series.horizontal_errors([error]);
        }
        panel = panel.series(series);
        // The best is at zero, where the vertical is.
        if x != 0.0 {
            let text = format!("{x:.*}", usize::from(x.abs() < 10.0)).replace('-', "−");
            panel = panel.note_at(x, place(index), text, Anchor::Above, color);
        }
    }
    panel.legend(Legend::None)
}
