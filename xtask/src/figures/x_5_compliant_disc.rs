//! x5: a disc that yields.

use anyhow::{Result, ensure};
use asperity_figure::{Axis, Color, Dash, Figure, Legend, Marker, Panel, Series};
use asperity_table::Table;

use super::levels::{drop_percent, force_axis};
use super::style;
use crate::reproduce::rig::{Case, Law, Rig, few_levels};
use crate::reproduce::{Computed, PaperFigure};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x5",
    title: "x5: a disc that yields",
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
    let law = Law::Modified.key().to_owned();
    let support = format!(
        r#"{{"kind": "spring_mass", "stiffness_n_per_m": {stiffness}, "mass_kg": {mass}, "damping_ratio": 0.01}}"#
    );
    rig.with(&[
        ("/interfaces/0/law", law.clone()),
        ("/interfaces/1/law", law),
        ("/excitation/peak_n", peak.to_string()),
        ("/support", support),
    ])
}

/// The two lowest natural frequencies at rest, in Hz.
fn natural(case: &Case) -> Result<[f64; 2]> {
    let assembly = case.assembly()?;
    let found = assembly.structure.modes(2)?;
    ensure!(found.len() == 2, "the rig has fewer than two modes");
    Ok([found[0].frequency_hz, found[1].frequency_hz])
}

/// The spring in N/m that brings the lowest natural frequency to `target` in Hz.
fn spring(rig: &Rig, mass: f64, target: f64) -> Result<f64> {
    let (mut soft, mut stiff) = (1e6_f64, 1e11_f64);
    for _ in 0..50 {
        let middle = (soft * stiff).sqrt();
        if natural(&on_disc(rig, middle, mass, 32.0)?)?[0] < target {
            soft = middle;
        } else {
            stiff = middle;
        }
    }
    Ok((soft * stiff).sqrt())
}

fn compute(rig: &Rig) -> Result<Computed> {
    let forces = few_levels();
    let first_row = |value: f64| {
        let mut column = vec![f64::NAN; forces.len()];
        column[0] = value;
        column
    };
    let mut table = Table::new().with_column("force_n", forces.as_slice())?;
    let rigid = natural(&rig.struck(Law::Modified, 32.0)?)?;
    let mut push = |name: &str, cases: &[Case], modes: [f64; 2]| -> Result<()> {
        let summaries = rig.summaries(cases)?;
        let peaks = || summaries.iter().map(|summary| summary.fundamental);
        let frequency: Vec<f64> =
            peaks().map(|peak| peak.map_or(f64::NAN, |p| p.frequency_hz)).collect();
        let amplitude: Vec<f64> =
            peaks().map(|peak| peak.map_or(f64::NAN, |p| p.receptance_m_per_n)).collect();
        let fall = drop_percent(&amplitude);
        table.push(format!("{name}:frequency_hz"), frequency)?;
        table.push(format!("{name}:receptance_m_per_n"), amplitude)?;
        table.push(format!("{name}:natural_frequency_hz"), first_row(modes[0]))?;
        table.push(format!("{name}:next_mode_hz"), first_row(modes[1]))?;
        table.push(format!("{name}:amplitude_fall_percent"), first_row(fall))?;
        Ok(())
    };
    let cases: Result<Vec<Case>> =
        forces.iter().map(|&force| rig.struck(Law::Modified, force)).collect();
    push("rigid", &cases?, rigid)?;
    let mut springs = Vec::new();
    for mass in MASSES {
        let stiffness = spring(rig, mass, (1.0 - OFFSET) * rigid[0])?;
        let cases: Result<Vec<Case>> =
            forces.iter().map(|&force| on_disc(rig, stiffness, mass, force)).collect();
        let modes = natural(&on_disc(rig, stiffness, mass, 32.0)?)?;
        push(&format!("disc_{mass}_kg"), &cases?, modes)?;
        springs.push((mass, stiffness));
    }
    for (mass, stiffness) in springs {
        table.push(format!("disc_{mass}_kg:stiffness_n_per_m"), first_row(stiffness))?;
    }
    Ok(Computed { table, values: Vec::new() })
}

fn draw(table: &Table) -> Result<String> {
    let force = table.column("force_n")?;
    let panel = |quantity: &str, axis: Axis| -> Result<Panel> {
        let series = |name: &str, label: &str| -> Result<Series> {
            let column = table.column(&format!("{name}:{quantity}"))?;
            Ok(Series::line_points(label, force, column).width(0.7))
        };
        Ok(Panel::new(force_axis(), axis)
            .series(style::modified(series("rigid", "rigid")?))
            .series(
                series("disc_1_kg", "1 kg")?
                    .color(Color::ORANGE)
                    .marker(Marker::Square)
                    .dash(Dash::Dashed),
            )
            .series(series("disc_5_kg", "5 kg")?.color(Color::GREEN).marker(Marker::Diamond))
            .series(
                series("disc_10_kg", "10 kg")?
                    .color(Color::PURPLE)
                    .marker(Marker::Plus)
                    .dash(Dash::Dotted),
            )
            .legend(Legend::Above))
    };
    let amplitude = Axis::linear("Amplitude A_{1}", "10^{-7} m/N").scale(1e7).low(0.0);
    let figure = Figure::new("A disc that yields")
        .panel(panel("frequency_hz", Axis::linear("Frequency f_{1}", "Hz"))?)
        .panel(panel("receptance_m_per_n", amplitude)?);
    style::svg(&figure.columns(2).width_mm(style::PAGE))
}
