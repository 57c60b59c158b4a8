//! Free decays: signals, backbones and harmonics.

mod report;

use asperity_experiment::{DecayAnalysis, DecayCurve, DecayOutline};
use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_signal::DecayPoint;

pub use report::decay_report;

use super::figure;

/// Most bands with panels of their own, and most curves of a panel.
const MOST_BANDS: usize = 6;
const MOST_CURVES: usize = 48;
/// Largest standard deviation of the damping ratio of a point that is drawn, over the ratio.
const MOST_NOISE: f64 = 0.2;

/// The figures of free decays with their names; those without anything to draw are left out.
pub fn decay_figures(analysis: &DecayAnalysis) -> Vec<(&'static str, Figure)> {
    let all = [
        ("decays", signals(&analysis.outlines)),
        ("backbone", backbones(analysis)),
        ("harmonics", harmonics(analysis)),
    ];
    all.into_iter().filter_map(|(name, figure)| Some((name, figure?))).collect()
}

/// The signals over time; the decays are shaded from their beginning to the end of the backbone.
fn signals(outlines: &[DecayOutline]) -> Option<Figure> {
    let panels = outlines.iter().map(|outline| {
        let label = format!("`{}`", outline.response).replace('`', "");
        let up = Axis::linear(label, outline.unit.replace("^2", "²"));
        let panel = Panel::new(Axis::linear("Time", "s"), up)
            .title(&outline.title)
            .legend(Legend::None)
            .series_if_visible(
                Series::line("", &outline.time_s, &outline.values).color(Color::BLUE).width(0.4),
            );
        outline.decays.iter().fold(panel, |panel, [from, to]| panel.shade(*from, *to))
    });
    Some(figure("Decays over time", 1, 170.0, panels)?.row_height_mm(42.0))
}

/// The unit of the amplitudes that all curves share, and their values: metres where they are known.
struct AmplitudeAxis {
    unit: String,
    metres: bool,
}

impl AmplitudeAxis {
    fn of(curves: &[DecayCurve]) -> Self {
        let drawn = || curves.iter().filter(|curve| !curve.points.is_empty());
        let metres =
            drawn().all(|curve| curve.points.iter().all(|one| curve.amplitude_m(one).is_some()));
        let first = drawn().next().map_or("", |curve| curve.unit.as_str());
        let same = drawn().all(|curve| curve.unit == first);
        let unit = if metres {
            "m"
        } else if same {
            first
        } else {
            "unit of the channel"
        };
        Self { unit: unit.replace("^2", "²"), metres }
    }

    fn axis(&self) -> Axis {
        Axis::log("Amplitude", &self.unit)
    }

    fn value(&self, curve: &DecayCurve, one: &DecayPoint) -> f64 {
        let metres = self.metres.then(|| curve.amplitude_m(one)).flatten();
        metres.unwrap_or(one.point.amplitude)
    }
}

/// Curves of a band, each with its colour by response and, where it is the first of that, its name.
fn named(analysis: &DecayAnalysis, band: usize) -> Vec<(&DecayCurve, Color, &str)> {
    let mut responses: Vec<&str> = Vec::new();
    let drawn: Vec<&DecayCurve> = analysis
        .curves
        .iter()
        .filter(|curve| curve.band == band && !curve.points.is_empty())
        .collect();
    let every = drawn.len().div_ceil(MOST_CURVES).max(1);
    drawn
        .into_iter()
        .step_by(every)
        .map(|curve| {
            let known = responses.iter().position(|name| *name == curve.response);
            let place = known.unwrap_or(responses.len());
            if known.is_none() {
                responses.push(&curve.response);
            }
            let name = if known.is_none() { curve.response.as_str() } else { "" };
            (curve, Color::category(place), name)
        })
        .collect()
}

/// Frequency and damping over amplitude, with two standard deviations due to noise as an area; without
/// the points whose damping is noise.
fn backbones(analysis: &DecayAnalysis) -> Option<Figure> {
    let amplitude = AmplitudeAxis::of(&analysis.curves);
    let bands = analysis.report.settings.bands_hz.len().min(MOST_BANDS);
    let panels = (1..=bands).flat_map(|band| {
        let mut frequency = Panel::new(amplitude.axis(), Axis::linear("Frequency", "Hz"));
        let up = Axis::linear("Damping ratio", "%").scale(100.0);
        let mut damping = Panel::new(amplitude.axis(), up).legend(Legend::None);
        for (curve, color, name) in named(analysis, band) {
            // The noise of the smallest amplitudes would set the scale.
            let is_clear = |one: &&DecayPoint| {
                one.uncertainty.damping_ratio < MOST_NOISE * one.point.damping_ratio.abs()
            };
            let column = |value: &dyn Fn(&DecayPoint) -> f64| -> Vec<f64> {
                curve.points.iter().filter(is_clear).map(value).collect()
            };
            let x = column(&|one| amplitude.value(curve, one));
            let with_area = |panel: Panel, name: &str, y: Vec<f64>, sigma: Vec<f64>| {
                let low: Vec<f64> = y.iter().zip(&sigma).map(|(y, s)| y - 2.0 * s).collect();
                let high: Vec<f64> = y.iter().zip(&sigma).map(|(y, s)| y + 2.0 * s).collect();
                panel
                    .series_if_visible(Series::band("", &x, low, high).color(color))
                    .series_if_visible(Series::line(name, &x, y).color(color).width(0.8))
            };
            frequency = with_area(
                frequency,
                name,
                column(&|one| one.point.frequency_hz),
                column(&|one| one.uncertainty.frequency_hz),
            );
            damping = with_area(
                damping,
                "",
                column(&|one| one.point.damping_ratio),
                column(&|one| one.uncertainty.damping_ratio),
            );
        }
        [frequency, damping]
    });
    figure("Backbones", 2, 170.0, panels)
}

/// Amplitudes of the second and the third harmonic over that of the fundamental.
fn harmonics(analysis: &DecayAnalysis) -> Option<Figure> {
    let amplitude = AmplitudeAxis::of(&analysis.curves);
    let bands = analysis.report.settings.bands_hz.len().min(MOST_BANDS);
    let panels = (1..=bands).flat_map(|band| {
        [("Ratio A_{2}/A_{1}", 0), ("Ratio A_{3}/A_{1}", 1)].map(|(label, order)| {
            let mut panel = Panel::new(amplitude.axis(), Axis::log(label, ""));
            for (curve, color, name) in named(analysis, band) {
                let found = curve
                    .points
                    .iter()
                    .filter_map(|one| Some((amplitude.value(curve, one), one.harmonics[order]?)));
                let (x, of): (Vec<f64>, Vec<_>) = found.unzip();
                let y: Vec<f64> = of.iter().map(|harmonic| harmonic.ratio).collect();
                let line = Series::line(name, x, y).color(color).dash(Dash::Solid).width(0.8);
                panel = panel.series_if_visible(line);
            }
            panel
        })
    });
    figure("Harmonics along the decays", 2, 170.0, panels)
}
