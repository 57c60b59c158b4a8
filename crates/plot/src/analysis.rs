//! Measured hits: time records, FRFs, coherence, features and backbones.

mod report;

use asperity_experiment::{
    Analysis, ForceLevel, HitCurve, HitReport, HitStatistics, ResponseAnalysis,
};
use asperity_figure::{Axis, Color, ColorBar, Dash, Figure, Legend, Marker, Panel, Series};
use asperity_scenario::four_digits;
use asperity_signal::{BackbonePoint, ResponseKind};

pub use report::analysis_report;

use super::decay::clear;
use super::figure;
use super::magnitude::{MagnitudeAxis, phase_axis, phase_line};

/// Most frequencies of the averaged FRF that are drawn: more than a screen has columns.
const MOST_LINES: usize = 6000;
/// Highest frequency of the FRFs drawn, over the fundamental.
const RANGE: f64 = 4.0;
/// Lowest frequency that the axes of magnitudes follow, over the fundamental: the division of an
/// acceleration by the square of the frequency magnifies noise below.
const LEAST: f64 = 0.15;
/// Time drawn before and after the trigger, over the width of the force pulse.
const PULSE: (f64, f64) = (1.5, 6.0);
/// Range drawn of several responses, over the limits of the band.
const OVER_BAND: f64 = 1.1;
/// Most decays that are drawn.
const MOST_DECAYS: usize = 48;
/// Most hits whose records are drawn, spread over the test.
const MOST_RECORDS: usize = 12;
/// Time drawn before the trigger over the time after it.
const TIME_BEFORE: f64 = 0.05;

/// The figures of an analysis with their names; those without anything to draw are left out.
pub fn figures(analysis: &ResponseAnalysis, axis: MagnitudeAxis) -> Vec<(&'static str, Figure)> {
    let bar = force_bar(analysis);
    let all = [
        ("records", records(analysis, &bar)),
        ("frf", functions(analysis, &bar, axis)),
        ("features", features(analysis)),
        ("backbone", backbones(analysis, &bar)),
    ];
    all.into_iter().filter_map(|(name, figure)| Some((name, figure?))).collect()
}

/// Colours by force level.
fn force_bar(analysis: &ResponseAnalysis) -> ColorBar {
    let forces = || analysis.report.hits.iter().filter_map(|hit| hit.force_peak_n);
    let low = forces().fold(f64::INFINITY, f64::min);
    let high = forces().fold(f64::NEG_INFINITY, f64::max);
    // One level still needs a bar of some length.
    let (low, high) = if high > low { (low, high) } else { (0.9 * low, 1.1 * high) };
    ColorBar::continuous("Peak force", "N", low, high)
}

fn line(x: &[f64], y: &[f64], color: Color) -> Series {
    Series::line("", x, y).color(color).width(0.6)
}

/// A panel without legend.
fn plain(x: Axis, y: Axis) -> Panel {
    Panel::new(x, y).legend(Legend::None)
}

/// Force and response of the hits over time, one hit below the other on the same axes.
fn records(analysis: &ResponseAnalysis, bar: &ColorBar) -> Option<Figure> {
    let (label, unit, scale) = match analysis.response {
        ResponseKind::Displacement => ("Displ.", "µm", 1e6),
        ResponseKind::Velocity => ("Vel.", "mm/s", 1e3),
        ResponseKind::Acceleration => ("Acc.", "m/s²", 1.0),
    };
    let every = analysis.curves.len().div_ceil(MOST_RECORDS).max(1);
    let shown: Vec<&HitCurve> = analysis.curves.iter().step_by(every).collect();
    let reach = |values: fn(&HitCurve) -> &[f64]| {
        let all = || shown.iter().flat_map(|curve| values(curve).iter().copied());
        let (low, high) = (all().fold(0.0, f64::min), all().fold(0.0, f64::max));
        let room = 0.08 * (high - low).max(f64::MIN_POSITIVE);
        (low - room, high + room)
    };
    let (forces, responses) = (reach(|curve| &curve.force.1), reach(|curve| &curve.response.1));
    let last = shown.iter().filter_map(|curve| curve.response.0.last().copied());
    let last = 1e3 * last.fold(0.0, f64::max);
    let panels = shown.iter().enumerate().flat_map(|(place, curve)| {
        let color = bar.color(curve.force_peak_n);
        // The title of the time is below the last row.
        let is_last = place + 1 == shown.len();
        let title = if is_last { "Time from trigger" } else { "" };
        let time = Axis::linear(title, if is_last { "ms" } else { "" }).scale(1e3);
        let time = if last > 0.0 { time.range(-TIME_BEFORE * last, last) } else { time };
        let up = Axis::linear("Force", "N").range(forces.0, forces.1);
        let force = plain(pulse_time(analysis, title), up)
            .title(format!("Hit {}: {} N", curve.index, four_digits(curve.force_peak_n)))
            .series_if_visible(line(&curve.force.0, &curve.force.1, color));
        let up = Axis::linear(label, unit).scale(scale);
        let response = plain(time, up.range(scale * responses.0, scale * responses.1))
            .series_if_visible(line(&curve.response.0, &curve.response.1, color));
        [force, response]
    });
    let figure = figure("Hits over time", 2, 170.0, panels)?;
    let height = if shown.len() == 1 { 50.0 } else { 32.0 };
    Some(figure.row_height_mm(height).tags(false))
}

/// Time axis of the force: some widths of the longest pulse.
fn pulse_time(analysis: &ResponseAnalysis, title: &str) -> Axis {
    let axis = Axis::linear(title, if title.is_empty() { "" } else { "ms" }).scale(1e3);
    let widths = analysis.report.hits.iter().filter_map(|hit| hit.pulse_width_s);
    let width = 1e3 * widths.fold(0.0, f64::max);
    let ends = analysis.curves.iter().filter_map(|curve| curve.force.0.last().copied());
    let end = (PULSE.1 * width).min(1e3 * ends.fold(0.0, f64::max));
    if width > 0.0 && end > 0.0 { axis.range(-PULSE.0 * width, end) } else { axis }
}

/// Receptances by force level; magnitude, phase and coherence of the averaged FRF. The band of the
/// fundamental is shaded, the mean frequencies of both peaks are marked.
fn functions(analysis: &ResponseAnalysis, bar: &ColorBar, axis: MagnitudeAxis) -> Option<Figure> {
    let (average, report) = (&analysis.average, &analysis.report);
    let first = report.average.frequency_hz.map(|first| first.mean);
    let top = first.map_or(0.5 * report.sample_rate_hz, |first| RANGE * first);
    let top = top.min(average.frf.frequency_hz.last().copied().unwrap_or(top));
    let resonant = first.map_or(0.0, |first| LEAST * first)..=top;
    let frequency = || Axis::linear("Frequency", "Hz").range(0.0, top);
    let panel = |up: Axis, texts: bool| {
        let text = |text: &'static str| if texts { text } else { "" };
        let mut panel = plain(frequency(), up);
        if let Some([low, high]) = report.settings.band_hz {
            panel = panel.shade(low, high);
        }
        let peaks = [(first, "f_{1}"), (second_frequency(analysis), "f_{2}")];
        for (at, name) in peaks.into_iter().filter_map(|(at, name)| Some((at?, name))) {
            panel = panel.vertical(at, text(name));
        }
        panel
    };

    let points = analysis.curves.iter().flat_map(|curve| {
        let (x, y) = &curve.receptance;
        x.iter().zip(y).filter(|(f, _)| resonant.contains(*f)).map(|(_, y)| *y)
    });
    let mut each = panel(axis.axis("Receptance", "m/N", points), true).color_bar(bar.clone());
    for curve in &analysis.curves {
        let (x, y) = &curve.receptance;
        let y: Vec<f64> = y.iter().map(|magnitude| axis.value(*magnitude)).collect();
        each = each.series_if_visible(line(x, &y, bar.color(curve.force_peak_n)));
    }

    let inside = 1..average.frf.frequency_hz.partition_point(|f| *f <= top).max(1);
    let part = inside.len().div_ceil(MOST_LINES).max(1);
    let lines: Vec<usize> = inside.step_by(part).collect();
    let x: Vec<f64> = lines.iter().map(|&k| average.frf.frequency_hz[k]).collect();
    // The line is broken at frequencies without force.
    let valid = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
        lines.iter().map(|&k| if average.valid[k] { value(k) } else { f64::NAN }).collect()
    };
    let curve = |x: &[f64], y: &[f64]| Series::line("", x, y).color(Color::BLACK).width(0.8);
    let form = average.frf.form;
    let magnitude = valid(&|k| average.frf.values[k].norm());
    let shown = x.iter().zip(&magnitude).filter(|(f, _)| resonant.contains(*f)).map(|(_, m)| *m);
    let up = axis.axis(&format!("Mean {}", form.name()), form.unit(), shown);
    let magnitude: Vec<f64> = magnitude.iter().map(|value| axis.value(*value)).collect();
    let mean = panel(up, false).series_if_visible(curve(&x, &magnitude));
    let (phase_x, phase_y) = phase_line(&x, &valid(&|k| average.frf.values[k].arg()));
    let phase = panel(phase_axis(), false).series_if_visible(curve(&phase_x, &phase_y));
    let coherence = average.coherence.as_ref().map(|coherence| {
        panel(Axis::linear("Coherence", "").range(0.0, 1.0), false)
            .series_if_visible(curve(&x, &valid(&|k| coherence[k])))
    });
    let panels = [each, mean, phase].into_iter().chain(coherence);
    Some(figure("Frequency response functions", 1, 150.0, panels)?.row_height_mm(58.0))
}

/// Magnitude and phase of the averaged functions of several responses, with the modes marked; none
/// for one response.
pub fn responses(analysis: &Analysis, axis: MagnitudeAxis) -> Option<Figure> {
    let [first, _, ..] = analysis.responses.as_slice() else { return None };
    let band = first.report.settings.band_hz;
    let highest = first.average.frf.frequency_hz.last().copied()?;
    let top = band.map_or(highest, |[_, high]| (OVER_BAND * high).min(highest));
    let bottom = band.map_or(0.0, |[low, _]| low / OVER_BAND);
    let panel = |up: Axis| {
        let mut panel = plain(Axis::linear("Frequency", "Hz").range(bottom, top), up);
        if let Some([low, high]) = band {
            panel = panel.shade(low, high);
        }
        analysis
            .modes
            .iter()
            .fold(panel, |panel, mode| panel.vertical(mode.natural_frequency_hz, ""))
    };
    let form = first.average.frf.form;
    let lines = |response: &ResponseAnalysis| -> Vec<usize> {
        let frequencies = &response.average.frf.frequency_hz;
        let inside = frequencies.partition_point(|f| *f < bottom).max(1)
            ..frequencies.partition_point(|f| *f <= top);
        let part = inside.len().div_ceil(MOST_LINES).max(1);
        inside.step_by(part).filter(|&k| response.average.valid[k]).collect()
    };
    let shown = analysis.responses.iter().flat_map(|response| {
        lines(response).into_iter().map(|k| response.average.frf.values[k].norm())
    });
    let shown: Vec<f64> = shown.collect();
    let up = axis.axis(&format!("Mean {}", form.name()), form.unit(), shown.into_iter());
    let (mut magnitude, mut phase) = (panel(up).legend(Legend::Auto), panel(phase_axis()));
    for (number, response) in analysis.responses.iter().enumerate() {
        let lines = lines(response);
        let x: Vec<f64> = lines.iter().map(|&k| response.average.frf.frequency_hz[k]).collect();
        let value = |k: &usize| response.average.frf.values[*k];
        let y: Vec<f64> = lines.iter().map(|k| axis.value(value(k).norm())).collect();
        let angle: Vec<f64> = lines.iter().map(|k| value(k).arg()).collect();
        let line =
            |name: &str, x: &[f64], y: &[f64]| Series::line(name, x, y).category(number).width(0.8);
        magnitude = magnitude.series_if_visible(line(response.name(), &x, &y));
        let (x, y) = phase_line(&x, &angle);
        phase = phase.series_if_visible(line("", &x, &y));
    }
    Some(figure("Responses", 1, 150.0, [magnitude, phase])?.row_height_mm(58.0))
}

/// Mean frequency of the second harmonic over the averaged hits that have one.
fn second_frequency(analysis: &ResponseAnalysis) -> Option<f64> {
    let hits = analysis.report.hits.iter().filter(|hit| hit.averaged);
    let found: Vec<f64> = hits.filter_map(|hit| Some(hit.second_harmonic?.frequency_hz)).collect();
    (!found.is_empty()).then(|| found.iter().sum::<f64>() / found.len() as f64)
}

type Feature = fn(&HitReport) -> Option<f64>;

/// Fundamental frequency, receptance and damping, and the harmonic ratio, over the peak force, each
/// with two standard deviations to either side where they are known. Lines join the means of the
/// force levels.
fn features(analysis: &ResponseAnalysis) -> Option<Figure> {
    let series = |name: &str, value: Feature, deviation: Feature, color: Color| {
        let points = analysis.report.hits.iter().filter(|hit| hit.averaged).filter_map(|hit| {
            Some((hit.force_peak_n?, value(hit)?, deviation(hit).unwrap_or(f64::NAN)))
        });
        let points: Vec<(f64, f64, f64)> = points.collect();
        let column = |of: fn(&(f64, f64, f64)) -> f64| points.iter().map(of).collect::<Vec<f64>>();
        Series::points(name, column(|point| point.0), column(|point| point.1))
            .errors(column(|point| 2.0 * point.2))
            .color(color)
    };
    let panel = |label: &str, unit: &str, factor: f64| {
        plain(Axis::linear("Peak force", "N"), Axis::linear(label, unit).scale(factor))
    };
    let frequency = panel("Fundamental f_{1}", "Hz", 1.0).series_if_visible(series(
        "",
        |hit| Some(hit.fundamental?.frequency_hz),
        |hit| hit.fundamental?.frequency_uncertainty_hz,
        Color::BLUE,
    ));
    let amplitude = panel("Amplitude A_{1}", "nm/N", 1e9).series_if_visible(series(
        "",
        |hit| Some(hit.fundamental?.magnitude),
        |hit| hit.fundamental?.magnitude_uncertainty,
        Color::BLUE,
    ));
    let half_power = series(
        "half power",
        |hit| hit.fundamental?.damping_ratio,
        |hit| hit.fundamental?.damping_ratio_uncertainty,
        Color::BLUE,
    );
    let decrement = series(
        "decrement",
        |hit| hit.fundamental?.damping_ratio_decrement,
        |hit| hit.fundamental?.damping_ratio_decrement_uncertainty,
        Color::ORANGE,
    );
    let damping = panel("Damping ratio", "%", 100.0)
        .series_if_visible(half_power)
        .series_if_visible(decrement.marker(Marker::Diamond))
        .legend(Legend::Auto);
    let ratio = panel("Ratio A_{2}/A_{1}", "", 1.0).series_if_visible(series(
        "",
        |hit| hit.harmonic_ratio,
        |hit| hit.harmonic_ratio_uncertainty,
        Color::BLUE,
    ));
    let levels = &analysis.report.levels;
    let panels = [
        of_levels(frequency, "mean of a force level", levels, |level| level.frequency_hz)
            .legend(Legend::Auto),
        of_levels(amplitude, "", levels, |level| level.magnitude),
        of_levels(damping, "", levels, |level| level.damping_ratio),
        of_levels(ratio, "", levels, |level| level.harmonic_ratio),
    ];
    figure("Features against force", 2, 170.0, panels)
}

/// Adds the means of the force levels as a line, where one has two hits or more.
fn of_levels(
    panel: Panel,
    name: &str,
    levels: &[ForceLevel],
    feature: fn(&ForceLevel) -> Option<HitStatistics>,
) -> Panel {
    let means: Vec<(f64, HitStatistics)> = levels
        .iter()
        .filter_map(|level| Some((level.force_peak_n.mean, feature(level)?)))
        .collect();
    if means.len() < 2 || means.iter().all(|(_, feature)| feature.hits < 2) {
        return panel;
    }
    let (x, y): (Vec<f64>, Vec<f64>) =
        means.into_iter().map(|(force, feature)| (force, feature.mean)).unzip();
    panel.series_if_visible(Series::line(name, x, y).color(Color::GREY).dash(Dash::Dashed))
}

/// Frequency and damping along the decays, until they are noise.
fn backbones(analysis: &ResponseAnalysis, bar: &ColorBar) -> Option<Figure> {
    let amplitude = || Axis::log("Amplitude", "m");
    let mut frequency = plain(amplitude(), Axis::linear("Frequency", "Hz"));
    let up = Axis::linear("Damping ratio", "%").scale(100.0);
    let mut damping = plain(amplitude(), up).color_bar(bar.clone());
    let every = analysis.backbones.len().div_ceil(MOST_DECAYS).max(1);
    for of in analysis.backbones.iter().step_by(every) {
        let noise = |at: usize| {
            let deviation = of.uncertainties.get(at).map_or(0.0, |one| one.damping_ratio);
            deviation / of.points[at].damping_ratio.abs()
        };
        let points = &of.points[..clear(of.points.len(), noise)];
        let column = |value: fn(&BackbonePoint) -> f64| points.iter().map(value).collect();
        let x: Vec<f64> = column(|point| point.amplitude);
        let line = |y: Vec<f64>| line(&x, &y, bar.color(of.force_peak_n)).width(0.8);
        frequency = frequency.series_if_visible(line(column(|point| point.frequency_hz)));
        damping = damping.series_if_visible(line(column(|point| point.damping_ratio)));
    }
    figure("Backbones", 2, 170.0, [frequency, damping])
}
