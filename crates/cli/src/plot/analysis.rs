//! Measured hits: time records, FRFs, coherence, features and backbones.

use asperity_experiment::{Analysis, HitReport};
use asperity_figure::{Axis, Color, ColorBar, Figure, Legend, Marker, Panel, Series};
use asperity_signal::ResponseKind;

/// Most frequencies of the averaged FRF that are drawn: more than a screen has columns.
const MOST_LINES: usize = 6000;
/// Highest frequency of the FRFs drawn, over the fundamental.
const RANGE: f64 = 4.0;
/// Most decays that are drawn.
const MOST_DECAYS: usize = 48;

/// The figures of an analysis with their file names; those without anything to draw are left out.
pub(crate) fn figures(analysis: &Analysis) -> Vec<(&'static str, Figure)> {
    let shades = Shades::of(analysis);
    let all = [
        ("records.svg", records(analysis, &shades)),
        ("frf.svg", functions(analysis, &shades)),
        ("features.svg", features(analysis)),
        ("backbone.svg", backbones(analysis, &shades)),
    ];
    all.into_iter().filter_map(|(name, figure)| Some((name, figure?))).collect()
}

/// Colours by force level.
struct Shades(ColorBar);

impl Shades {
    fn of(analysis: &Analysis) -> Self {
        let forces = || analysis.report.hits.iter().filter_map(|hit| hit.force_peak_n);
        let low = forces().fold(f64::INFINITY, f64::min);
        let high = forces().fold(f64::NEG_INFINITY, f64::max);
        // One level still needs a bar of some length.
        let (low, high) = if high > low { (low, high) } else { (0.9 * low, 1.1 * high) };
        Self(ColorBar::continuous("Peak force", "N", low, high))
    }

    fn color(&self, force: f64) -> Color {
        self.0.color(force)
    }
}

/// Force and response of the hits over time.
fn records(analysis: &Analysis, shades: &Shades) -> Option<Figure> {
    let (label, unit, scale) = match analysis.response {
        ResponseKind::Displacement => ("Displacement", "µm", 1e6),
        ResponseKind::Velocity => ("Velocity", "mm/s", 1e3),
        ResponseKind::Acceleration => ("Acceleration", "m/s²", 1.0),
    };
    let time = || Axis::linear("Time from trigger", "ms").scale(1e3);
    let mut blow = Panel::new(time(), Axis::linear("Force", "N")).legend(Legend::None);
    let mut response = Panel::new(time(), Axis::linear(label, unit).scale(scale))
        .legend(Legend::None)
        .color_bar(shades.0.clone());
    let drawn = |x: &[f64], y: &[f64], force: f64| {
        let any = x.iter().zip(y).any(|(x, y)| x.is_finite() && y.is_finite());
        any.then(|| Series::line("", x, y).color(shades.color(force)).width(0.6))
    };
    let mut any = false;
    for curve in &analysis.curves {
        let force = drawn(&curve.force.0, &curve.force.1, curve.force_peak_n);
        let motion = drawn(&curve.response.0, &curve.response.1, curve.force_peak_n);
        if let (Some(force), Some(motion)) = (force, motion) {
            (blow, response) = (blow.series(force), response.series(motion));
            any = true;
        }
    }
    any.then(|| {
        Figure::new("Hits over time").panel(blow).panel(response).columns(2).width_mm(170.0)
    })
}

/// Receptances by force level, the averaged FRF, and the coherence.
fn functions(analysis: &Analysis, shades: &Shades) -> Option<Figure> {
    let average = &analysis.average;
    let top = match analysis.report.average.frequency_hz {
        Some(first) => RANGE * first.mean,
        None => 0.5 * analysis.report.sample_rate_hz,
    };
    let top = top.min(average.frf.frequency_hz.last().copied().unwrap_or(top));
    let frequency = || Axis::linear("Frequency", "Hz").range(0.0, top);
    let mut each = Panel::new(frequency(), Axis::log("Receptance", "m/N"))
        .legend(Legend::None)
        .color_bar(shades.0.clone());
    let mut any = false;
    for curve in &analysis.curves {
        let (x, y) = &curve.receptance;
        if x.iter().zip(y).any(|(x, y)| x.is_finite() && *y > 0.0 && y.is_finite()) {
            let line = Series::line("", x, y).color(shades.color(curve.force_peak_n)).width(0.6);
            each = each.series(line);
            any = true;
        }
    }
    let inside = 1..average.frf.frequency_hz.partition_point(|f| *f <= top).max(1);
    let part = inside.len().div_ceil(MOST_LINES).max(1);
    let lines: Vec<usize> = inside.step_by(part).collect();
    let x: Vec<f64> = lines.iter().map(|&k| average.frf.frequency_hz[k]).collect();
    // The line is broken at frequencies without force.
    let valid = |k: usize, value: f64| if average.valid[k] { value } else { f64::NAN };
    let magnitude: Vec<f64> =
        lines.iter().map(|&k| valid(k, average.frf.values[k].norm())).collect();
    let mut figure = Figure::new("Frequency response functions").columns(1).width_mm(150.0);
    if any {
        figure = figure.panel(each);
    }
    if magnitude.iter().any(|m| m.is_finite() && *m > 0.0) {
        let form = average.frf.form;
        let label = format!("Averaged {}", form.name());
        let panel = Panel::new(frequency(), Axis::log(label, form.unit()))
            .series(Series::line("", &x, &magnitude).color(Color::BLACK))
            .legend(Legend::None);
        figure = figure.panel(panel);
        any = true;
    }
    if let Some(coherence) = &average.coherence {
        let y: Vec<f64> = lines.iter().map(|&k| valid(k, coherence[k])).collect();
        if y.iter().any(|y| y.is_finite()) {
            let panel = Panel::new(frequency(), Axis::linear("Coherence", "").range(0.0, 1.0))
                .series(Series::line("", &x, &y).color(Color::BLACK))
                .legend(Legend::None);
            figure = figure.panel(panel);
        }
    }
    any.then_some(figure)
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
    let mut figure = Figure::new("Features against force").columns(2).width_mm(170.0);
    let mut any = false;
    for (label, unit, value) in observables {
        let points = analysis.report.hits.iter().filter(|hit| hit.averaged);
        let (x, y): (Vec<f64>, Vec<f64>) =
            points.filter_map(|hit| Some((hit.force_peak_n?, value(hit)?))).unzip();
        if !x.is_empty() {
            let series = Series::points("", &x, &y).color(Color::BLUE).marker(Marker::Circle);
            let panel = Panel::new(Axis::linear("Peak force", "N"), Axis::linear(label, unit));
            figure = figure.panel(panel.series(series).legend(Legend::None));
            any = true;
        }
    }
    any.then_some(figure)
}

/// Frequency and damping along the decays.
fn backbones(analysis: &Analysis, shades: &Shades) -> Option<Figure> {
    let amplitude = || Axis::log("Amplitude", "m");
    let mut frequency =
        Panel::new(amplitude(), Axis::linear("Frequency", "Hz")).legend(Legend::None);
    let mut damping = Panel::new(amplitude(), Axis::linear("Damping ratio", ""))
        .legend(Legend::None)
        .color_bar(shades.0.clone());
    let every = analysis.backbones.len().div_ceil(MOST_DECAYS).max(1);
    let mut any = false;
    for of in analysis.backbones.iter().step_by(every) {
        let x: Vec<f64> = of.points.iter().map(|point| point.amplitude).collect();
        let line = |value: fn(&asperity_signal::BackbonePoint) -> f64| {
            let y: Vec<f64> = of.points.iter().map(value).collect();
            Series::line("", &x, &y).color(shades.color(of.force_peak_n)).width(0.8)
        };
        frequency = frequency.series(line(|point| point.frequency_hz));
        damping = damping.series(line(|point| point.damping_ratio));
        any = true;
    }
    let figure = Figure::new("Backbones").panel(frequency).panel(damping);
    any.then(|| figure.columns(2).width_mm(170.0))
}
