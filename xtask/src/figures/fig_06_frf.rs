//! Fig. 6: receptance with nonlinear and with constant stiffness.

use anyhow::{Context, Result};
use asperity_figure::{Axis, Color, Dash, Legend, Panel, Series};
use asperity_simulation::summary::Summary;
use asperity_table::Table;

use super::levels::yes;
use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig, response};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig06",
    title: "Fig. 6: receptance, nonlinear and constant stiffness",
    caption: "Receptance of the top of the guide bar struck with 32 N: the modified power law \
              (blue) and a constant stiffness of 8.5e11 Pa/m (dashed). The second harmonic \
              appears near twice the fundamental with the nonlinear law only. The experimental \
              curve is not published as numbers and is missing.",
    compute,
    draw,
};

/// Step of the frequencies shown, from 50 to 2500 Hz.
const STEP: f64 = 2.5;

fn compute(rig: &Rig) -> Result<Computed> {
    let frequency: Vec<f64> = (20..=1000).map(|n| f64::from(n) * STEP).collect();
    let receptance = |law| -> Result<(Vec<f64>, Summary)> {
        let run = rig.run(&rig.struck(law, 32.0)?)?;
        let response = response(&run)?;
        let magnitude = frequency.iter().map(|&f| response.receptance_at(f).norm()).collect();
        Ok((magnitude, run.summary))
    };
    let (modified, nonlinear) = receptance(Law::Modified)?;
    let (constant, linear) = receptance(Law::Constant)?;
    let table = Table::new()
        .with_column("frequency_hz", frequency)?
        .with_column("modified:receptance_m_per_n", modified)?
        .with_column("constant:receptance_m_per_n", constant)?;

    let first = nonlinear.fundamental.context("the modified law gives no fundamental")?;
    let flat = linear.fundamental.context("the constant stiffness gives no fundamental")?;
    let second = nonlinear.second_harmonic;
    let at_twice = second.map_or(f64::NAN, |peak| peak.frequency_hz / first.frequency_hz);
    let values = vec![
        ("fundamental_frequency", first.frequency_hz),
        ("constant_same_frequency", flat.frequency_hz / first.frequency_hz),
        ("second_harmonic_present", yes(second.is_some())),
        ("second_harmonic_at_twice", at_twice),
        ("second_harmonic_absent_constant", yes(linear.second_harmonic.is_none())),
    ];
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let frequency = table.column("frequency_hz")?;
    let nonlinear =
        Series::line("Modified PL", frequency, table.column("modified:receptance_m_per_n")?);
    let constant = Series::line(
        "K = 8.5·10^{11} Pa/m",
        frequency,
        table.column("constant:receptance_m_per_n")?,
    );
    let panel = Panel::new(Axis::linear("Frequency", "Hz"), Axis::log("Receptance", "m/N"))
        .series(nonlinear.color(Color::BLUE))
        .series(constant.color(Color::BLACK).dash(Dash::Dashed))
        .legend(Legend::TopRight);
    style::svg("Receptance", [panel])
}
