//! x2: what the unpublished shape of the blow does.

use anyhow::Result;
use asperity_figure::{Axis, Color, Dash, Figure, Legend, Marker, Panel, Series};
use asperity_study::summary::Summary;
use asperity_table::Table;

use super::levels::force_axis;
use super::style;
use crate::reproduce::rig::{Case, Law, Rig, few_levels};
use crate::reproduce::{Computed, PaperFigure};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x2",
    title: "x2: the shape of the blow",
    caption: "Modified power law struck with three pulses of equal peak and equal impulse: the \
              gamma pulse of all other figures (blue), a half-sine of 0.987 ms (orange) and a \
              haversine of 1.256 ms (green). The last two have a zero in their spectrum next to \
              the second harmonic, at 1520 and 1592 Hz: the receptance divides by it, and where \
              no peak is left A2/A1 is missing. The table has both laws, with A1, the lowest \
              pressure and the time without contact.",
    compute,
    draw,
};

/// Rise of the gamma pulse, in s.
const RISE: f64 = 0.34e-3;
/// The square of Euler's number.
const E2: f64 = std::f64::consts::E * std::f64::consts::E;
/// The pulses: name, duration over the gamma pulse's rise for an equal impulse.
/// The impulses over peak are e^2 / 4 of the rise, and 2/pi and 1/2 of the duration.
const PULSES: [(&str, f64); 3] =
    [("gamma_pulse", 1.0), ("half_sine", E2 * std::f64::consts::PI / 8.0), ("haversine", E2 / 2.0)];

type Quantity = (&'static str, fn(&Summary) -> Option<f64>);
const QUANTITIES: [Quantity; 5] = [
    ("frequency_hz", |summary| summary.fundamental.map(|peak| peak.frequency_hz)),
    ("receptance_m_per_n", |summary| summary.fundamental.map(|peak| peak.receptance_m_per_n)),
    ("harmonic_ratio", |summary| summary.harmonic_ratio),
    ("pressure_min_pa", |summary| summary.interfaces.first().map(|c| c.pressure_min_pa)),
    ("contact_lost_s", |summary| summary.interfaces.first().map(|c| c.contact_lost_s)),
];

fn struck(rig: &Rig, law: Law, pulse: (&str, f64), peak: f64) -> Result<Case> {
    let (kind, stretch) = pulse;
    if kind == "gamma_pulse" {
        return rig.struck(law, peak);
    }
    let duration = RISE * stretch;
    let excitation = format!(r#"{{"kind": "{kind}", "peak_n": {peak}, "duration_s": {duration}}}"#);
    let law = law.key().to_owned();
    rig.with(&[
        ("/interfaces/0/law", law.clone()),
        ("/interfaces/1/law", law),
        ("/excitation", excitation),
    ])
}

fn compute(rig: &Rig) -> Result<Computed> {
    let forces = few_levels();
    let mut table = Table::new().with_column("force_n", forces.as_slice())?;
    for law in [Law::Modified, Law::Power] {
        for pulse in PULSES {
            let cases: Vec<Case> = forces
                .iter()
                .map(|&force| struck(rig, law, pulse, force))
                .collect::<Result<_>>()?;
            let summaries = rig.summaries(&cases)?;
            for (quantity, of) in QUANTITIES {
                let column: Vec<f64> =
                    summaries.iter().map(|summary| of(summary).unwrap_or(f64::NAN)).collect();
                table.push(format!("{}:{}:{quantity}", law.key(), pulse.0), column)?;
            }
        }
    }
    Ok(Computed { table, values: Vec::new() })
}

fn draw(table: &Table) -> Result<String> {
    let force = table.column("force_n")?;
    let panel = |quantity: &str, axis: Axis| -> Result<Panel> {
        let mut panel = Panel::new(force_axis(), axis).legend(Legend::Above);
        for (pulse, label, color, marker, dash) in [
            ("gamma_pulse", "gamma", Color::BLUE, Marker::Triangle, Dash::Solid),
            ("half_sine", "half-sine", Color::ORANGE, Marker::Square, Dash::Dashed),
            ("haversine", "haversine", Color::GREEN, Marker::Diamond, Dash::Dotted),
        ] {
            let column = table.column(&format!("modified:{pulse}:{quantity}"))?;
            let series = Series::line_points(label, force, column).width(0.7);
            panel = panel.series(series.color(color).marker(marker).dash(dash));
        }
        Ok(panel)
    };
    let figure = Figure::new("The shape of the blow")
        .panel(panel("frequency_hz", Axis::linear("Frequency f_{1}", "Hz"))?)
        .panel(panel("harmonic_ratio", Axis::log("Ratio A_{2}/A_{1}", ""))?);
    style::svg(&figure.columns(2).width_mm(style::PAGE))
}
