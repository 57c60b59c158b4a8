//! Measured hits: time records, FRFs, coherence, features and backbones.

use asperity_experiment::{Analysis, HitReport};
use asperity_figure::{Axis, Color, ColorBar, Figure, Legend, Panel, Series};
use asperity_signal::{BackbonePoint, ResponseKind};

use super::figure;

/// Most frequencies of the averaged FRF that are drawn: more than a screen has columns.
const MOST_LINES: usize = 6000;
/// Highest frequency of the FRFs drawn, over the fundamental.
const RANGE: f64 = 4.0;
/// Most decays that are drawn.
const MOST_DECAYS: usize = 48;

/// The figures of an analysis with their file names; those without anything to draw are left out.
pub(crate) fn figures(analysis: &Analysis) -> Vec<(&'static str, Figure)> {
    let bar = force_bar(analysis);
    let all = [
        ("records.svg", records(analysis, &bar)),
        ("frf.svg", functions(analysis, &bar)),
        ("features.svg", features(analysis)),
        ("backbone.svg", backbones(analysis, &bar)),
    ];
    all.into_iter().filter_map(|(name, figure)| Some((name, figure?))).collect()
}

/// Colours by force level.
fn force_bar(analysis: &Analysis) -> ColorBar {
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

/// Force and response of the hits over time.
fn records(analysis: &Analysis, bar: &ColorBar) -> Option<Figure> {
    let (label, unit, scale) = match analysis.response {
        ResponseKind::Displacement => ("Displacement", "µm", 1e6),
        ResponseKind::Velocity => ("Velocity", "mm/s", 1e3),
        ResponseKind::Acceleration => ("Acceleration", "m/s²", 1.0),
    };
    let time = || Axis::linear("Time from trigger", "ms").scale(1e3);
    let mut force = plain(time(), Axis::linear("Force", "N"));
    let mut response = plain(time(), Axis::linear(label, unit).scale(scale)).color_bar(bar.clone());
    for curve in &analysis.curves {
        let color = bar.color(curve.force_peak_n);
        force = force.series_if_visible(line(&curve.force.0, &curve.force.1, color));
        response = response.series_if_visible(line(&curve.response.0, &curve.response.1, color));
    }
    figure("Hits over time", 2, 170.0, [force, response])
}

/// Receptances by force level, the averaged FRF, and the coherence.
fn functions(analysis: &Analysis, bar: &ColorBar) -> Option<Figure> {
    let average = &analysis.average;
    let top = match analysis.report.average.frequency_hz {
        Some(first) => RANGE * first.mean,
        None => 0.5 * analysis.report.sample_rate_hz,
    };
    let top = top.min(average.frf.frequency_hz.last().copied().unwrap_or(top));
    let frequency = || Axis::linear("Frequency", "Hz").range(0.0, top);
    let mut each = plain(frequency(), Axis::log("Receptance", "m/N")).color_bar(bar.clone());
    for curve in &analysis.curves {
        let (x, y) = &curve.receptance;
        each = each.series_if_visible(line(x, y, bar.color(curve.force_peak_n)));
    }
    let inside = 1..average.frf.frequency_hz.partition_point(|f| *f <= top).max(1);
    let part = inside.len().div_ceil(MOST_LINES).max(1);
    let lines: Vec<usize> = inside.step_by(part).collect();
    let x: Vec<f64> = lines.iter().map(|&k| average.frf.frequency_hz[k]).collect();
    // The line is broken at frequencies without force.
    let valid = |value: &dyn Fn(usize) -> f64| {
        let y = lines.iter().map(|&k| if average.valid[k] { value(k) } else { f64::NAN });
        Series::line("", &x, y.collect::<Vec<f64>>()).color(Color::BLACK)
    };
    let form = average.frf.form;
    let mean = plain(frequency(), Axis::log(format!("Averaged {}", form.name()), form.unit()))
        .series_if_visible(valid(&|k| average.frf.values[k].norm()));
    let coherence = average.coherence.as_ref().map(|coherence| {
        plain(frequency(), Axis::linear("Coherence", "").range(0.0, 1.0))
            .series_if_visible(valid(&|k| coherence[k]))
    });
    let panels = [each, mean].into_iter().chain(coherence);
    figure("Frequency response functions", 1, 150.0, panels)
}

type Feature = fn(&HitReport) -> Option<f64>;

/// Fundamental frequency, receptance and damping, and the harmonic ratio, over the peak force.
fn features(analysis: &Analysis) -> Option<Figure> {
    let observables: [(&str, &str, Feature); 4] = [
        ("Fundamental f_{1}", "Hz", |hit| Some(hit.fundamental?.frequency_hz)),
        ("Amplitude A_{1}", "m/N", |hit| Some(hit.fundamental?.magnitude)),
        ("Damping ratio", "", |hit| hit.fundamental?.damping_ratio),
        ("Ratio A_{2}/A_{1}", "", |hit| hit.harmonic_ratio),
    ];
    let panels = observables.map(|(label, unit, value)| {
        let points = analysis.report.hits.iter().filter(|hit| hit.averaged);
        let (x, y): (Vec<f64>, Vec<f64>) =
            points.filter_map(|hit| Some((hit.force_peak_n?, value(hit)?))).unzip();
        plain(Axis::linear("Peak force", "N"), Axis::linear(label, unit))
            .series_if_visible(Series::points("", x, y).color(Color::BLUE))
    });
    figure("Features against force", 2, 170.0, panels)
}

/// Frequency and damping along the decays.
fn backbones(analysis: &Analysis, bar: &ColorBar) -> Option<Figure> {
    let amplitude = || Axis::log("Amplitude", "m");
    let mut frequency = plain(amplitude(), Axis::linear("Frequency", "Hz"));
    let mut damping = plain(amplitude(), Axis::linear("Damping ratio", "")).color_bar(bar.clone());
    let every = analysis.backbones.len().div_ceil(MOST_DECAYS).max(1);
    for of in analysis.backbones.iter().step_by(every) {
        let column = |value: fn(&BackbonePoint) -> f64| of.points.iter().map(value).collect();
        let x: Vec<f64> = column(|point| point.amplitude);
        let line = |y: Vec<f64>| line(&x, &y, bar.color(of.force_peak_n)).width(0.8);
        frequency = frequency.series_if_visible(line(column(|point| point.frequency_hz)));
        damping = damping.series_if_visible(line(column(|point| point.damping_ratio)));
    }
    figure("Backbones", 2, 170.0, [frequency, damping])
}
