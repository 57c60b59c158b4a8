//! x5: a compliant disc.

use anyhow::Result;
use asperity_figure::{Axis, Color, Dash, Marker, Panel};
use asperity_table::Table;

use super::levels::{self, FREQUENCY, RECEPTANCE, column, drop_percent};
use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Case, Law, Rig, few_levels};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x5",
    title: "x5: a compliant disc",
    caption: "Modified power law on a rigid disc (blue) and on a disc of 1, 5 and 10 kg on a \
              spring whose stiffness lowers the natural frequency at rest by 13 %, the offset \
              that the paper ascribes to its disc; the disc's own damping ratio is 0.01. (a) \
              Fundamental and (b) its amplitude against force. The compliance closes the \
              offset in frequency; A1 still falls with force. The table has the stiffnesses, \
              the next mode and the fall of A1 in per cent.",
    compute,
    draw,
};

/// Masses of the disc in kg.
const MASSES: [f64; 3] = [1.0, 5.0, 10.0];
/// The offset between model and experiment that the paper states.
const OFFSET: f64 = 0.13;

/// The rig struck with `peak` on a disc of `mass` in kg on a spring in N/m.
fn on_disc(rig: &Rig, stiffness: f64, mass: f64, peak: f64) -> Result<Case> {
    let support = format!(
        r#"{{"kind": "spring_mass", "stiffness_n_per_m": {stiffness}, "mass_kg": {mass}, "damping_ratio": 0.01}}"#
    );
    rig.with(Law::Modified, &[("/excitation/peak_n", peak.to_string()), ("/support", support)])
}

/// The spring in N/m that brings the lowest natural frequency to `target` in Hz.
fn spring(rig: &Rig, mass: f64, target: f64) -> Result<f64> {
    let (mut soft, mut stiff) = (1e6_f64, 1e11_f64);
    for _ in 0..50 {
        let middle = (soft * stiff).sqrt();
        if on_disc(rig, middle, mass, 32.0)?.natural_frequencies()?[0] < target {
            soft = middle;
        } else {
            stiff = middle;
        }
    }
    Ok((soft * stiff).sqrt())
}

fn compute(rig: &Rig) -> Result<Computed> {
    let forces = few_levels();
    let mut columns = Columns::default();
    columns.push("force_n", forces.as_slice());
    let rigid = rig.struck(Law::Modified, 32.0)?.natural_frequencies()?;
    let mut push = |name: &str, cases: &[Case], modes: [f64; 2]| -> Result<()> {
        let summaries = rig.summaries(cases)?;
        let amplitude = column(&summaries, RECEPTANCE);
        let fall = drop_percent(&amplitude);
        columns.push(format!("{name}:frequency_hz"), column(&summaries, FREQUENCY));
        columns.push(format!("{name}:receptance_m_per_n"), amplitude);
        columns.push(format!("{name}:natural_frequency_hz"), [modes[0]]);
        columns.push(format!("{name}:next_mode_hz"), [modes[1]]);
        columns.push(format!("{name}:amplitude_fall_percent"), [fall]);
        Ok(())
    };
    push("rigid", &rig.struck_with(Law::Modified, &forces)?, rigid)?;
    let mut springs = Vec::new();
    for mass in MASSES {
        let stiffness = spring(rig, mass, (1.0 - OFFSET) * rigid[0])?;
        let on_disc = |force: f64| on_disc(rig, stiffness, mass, force);
        let cases = forces.iter().map(|&force| on_disc(force)).collect::<Result<Vec<Case>>>()?;
        push(&format!("disc_{mass}_kg"), &cases, on_disc(32.0)?.natural_frequencies()?)?;
        springs.push((mass, stiffness));
    }
    for (mass, stiffness) in springs {
        columns.push(format!("disc_{mass}_kg:stiffness_n_per_m"), [stiffness]);
    }
    columns.computed()
}

fn draw(table: &Table) -> Result<String> {
    let panel = |quantity: &str, axis: Axis| -> Result<Panel> {
        let variants = [
            ("rigid", "rigid", Color::BLUE, Marker::Triangle, Dash::Solid),
            ("disc_1_kg", "1 kg", Color::ORANGE, Marker::Square, Dash::Dashed),
            ("disc_5_kg", "5 kg", Color::GREEN, Marker::Diamond, Dash::Solid),
            ("disc_10_kg", "10 kg", Color::PURPLE, Marker::Plus, Dash::Dotted),
        ];
        levels::variants(table, quantity, axis, &variants)
    };
    let frequency = panel("frequency_hz", Axis::linear("Frequency f_{1}", "Hz"))?;
    let amplitude = panel("receptance_m_per_n", style::amplitude_axis())?;
    style::svg("A compliant disc", [frequency, amplitude])
}
