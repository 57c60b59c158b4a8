//! Free decays: signals, backbones and harmonics.

mod report;

use asperity_experiment::{DecayAnalysis, DecayCurve, DecayOutline};
use asperity_figure::{Axis, Color, Figure, Legend, Panel, Series};
use asperity_signal::DecayPoint;

pub use report::decay_report;

use super::figure;

/// Most bands with panels of their own, and most curves of a panel.
const MOST_BANDS: usize = 6;
const MOST_CURVES: usize = 48;
/// Standard deviation of a damping ratio over the ratio from which on a point is noise.
const MOST_NOISE: f64 = 0.05;
/// Points of which more than half are noise where a backbone ends.
const END: usize = 16;

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

/// Number of the first points of a backbone that are drawn, of `count` in the order of time: until most of
/// the following ones are noise. A beat does not end it.
///
/// - `noise`: standard deviation of the damping ratio of a point over the ratio.
pub(super) fn clear(count: usize, noise: impl Fn(usize) -> f64) -> usize {
    let is_noise = |at: usize| noise(at) >= MOST_NOISE || noise(at).is_nan();
    let ends = |from: usize| {
        let next = from..(from + END).min(count);
        let noisy = next.clone().filter(|&at| is_noise(at)).count();
        is_noise(from) && 2 * noisy > next.len()
    };
    (0..count).find(|&from| ends(from)).unwrap_or(count)
}

/// Curves of a band, each with its place among the responses and, where it is the first of its response,
/// its name.
fn named(analysis: &DecayAnalysis, band: usize) -> Vec<(&DecayCurve, usize, &str)> {
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
            (curve, place, name)
        })
        .collect()
}

/// Frequency and damping over amplitude, with two standard deviations due to noise as an area, until they
/// are noise.
fn backbones(analysis: &DecayAnalysis) -> Option<Figure> {
    let amplitude = AmplitudeAxis::of(&analysis.curves);
    let bands = analysis.report.settings.bands_hz.len().min(MOST_BANDS);
    let panels = (1..=bands).flat_map(|band| {
        let mut frequency = Panel::new(amplitude.axis(), Axis::linear("Frequency", "Hz"));
        let up = Axis::linear("Damping ratio", "%").scale(100.0);
        let mut damping = Panel::new(amplitude.axis(), up).legend(Legend::None);
        for (curve, place, name) in named(analysis, band) {
            // The noise of the smallest amplitudes would set the scale.
            let noise = |at: usize| {
                let one = &curve.points[at];
                one.uncertainty.damping_ratio / one.point.damping_ratio.abs()
            };
            let points = &curve.points[..clear(curve.points.len(), noise)];
            let column = |value: &dyn Fn(&DecayPoint) -> f64| -> Vec<f64> {
                points.iter().map(value).collect()
            };
            let x = column(&|one| amplitude.value(curve, one));
            let with_area = |panel: Panel, name: &str, y: Vec<f64>, sigma: Vec<f64>| {
                let low: Vec<f64> = y.iter().zip(&sigma).map(|(y, s)| y - 2.0 * s).collect();
                let high: Vec<f64> = y.iter().zip(&sigma).map(|(y, s)| y + 2.0 * s).collect();
                panel
                    .series_if_visible(Series::band("", &x, low, high).category(place))
                    .series_if_visible(Series::line(name, &x, y).category(place).width(0.8))
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
            for (curve, place, name) in named(analysis, band) {
                let found = curve
                    .points
                    .iter()
                    .filter_map(|one| Some((amplitude.value(curve, one), one.harmonics[order]?)));
                let (x, of): (Vec<f64>, Vec<_>) = found.unzip();
                let y: Vec<f64> = of.iter().map(|harmonic| harmonic.ratio).collect();
                let line = Series::line(name, x, y).category(place).width(0.8);
                panel = panel.series_if_visible(line);
            }
            panel
        })
    });
    figure("Harmonics along the decays", 2, 170.0, panels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_backbone_ends_where_noise_begins_and_not_at_a_beat() {
        let noise = |at: usize| match at {
            30..34 => 0.5,
            80.. if !at.is_multiple_of(4) => 0.3,
            _ => 0.01,
        };
        assert!((78..=81).contains(&clear(200, noise)), "{}", clear(200, noise));
        assert_eq!(clear(60, noise), 60);
        assert_eq!(clear(0, noise), 0);
        assert_eq!(clear(5, |_| f64::NAN), 0);
    }
}
