//! x2: influence of the pulse shape, which the paper does not give.

use anyhow::Result;
use asperity_figure::{Axis, Color, Dash, Marker, Panel};
use asperity_table::Table;

use super::levels::{
    self, CONTACT_LOST, FREQUENCY, HARMONIC_RATIO, Observable, PRESSURE_MIN, RECEPTANCE, column,
};
use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Case, Law, Rig, few_levels};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x2",
    title: "x2: the shape of the pulse",
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

const QUANTITIES: [(&str, Observable); 5] = [
    ("frequency_hz", FREQUENCY),
    ("receptance_m_per_n", RECEPTANCE),
    ("harmonic_ratio", HARMONIC_RATIO),
    ("pressure_min_pa", PRESSURE_MIN),
    ("contact_lost_s", CONTACT_LOST),
];

fn struck(rig: &Rig, law: Law, pulse: (&str, f64), peak: f64) -> Result<Case> {
    let (kind, stretch) = pulse;
    if kind == "gamma_pulse" {
        return rig.struck(law, peak);
    }
    let duration = RISE * stretch;
    let excitation = format!(r#"{{"kind": "{kind}", "peak_n": {peak}, "duration_s": {duration}}}"#);
    rig.with(law, &[("/excitation", excitation)])
}

fn compute(rig: &Rig) -> Result<Computed> {
    let forces = few_levels();
    let mut table = Table::new().with_column("force_n", forces.as_slice())?;
    for law in [Law::Modified, Law::Power] {
        for pulse in PULSES {
            let cases = forces.iter().map(|&force| struck(rig, law, pulse, force));
            let summaries = rig.summaries(&cases.collect::<Result<Vec<Case>>>()?)?;
            for (quantity, of) in QUANTITIES {
                let name = format!("{}:{}:{quantity}", law.key(), pulse.0);
                table.push(name, column(&summaries, of))?;
            }
        }
    }
    Ok(Computed { table, values: Vec::new() })
}

fn draw(table: &Table) -> Result<String> {
    let panel = |quantity: &str, axis: Axis| -> Result<Panel> {
        let variants = [
            ("modified:gamma_pulse", "gamma", Color::BLUE, Marker::Triangle, Dash::Solid),
            ("modified:half_sine", "half-sine", Color::ORANGE, Marker::Square, Dash::Dashed),
            ("modified:haversine", "haversine", Color::GREEN, Marker::Diamond, Dash::Dotted),
        ];
        levels::variants(table, quantity, axis, &variants)
    };
    let frequency = panel("frequency_hz", Axis::linear("Frequency f_{1}", "Hz"))?;
    let ratio = panel("harmonic_ratio", Axis::log("Ratio A_{2}/A_{1}", ""))?;
    style::svg("The shape of the pulse", [frequency, ratio])
}
