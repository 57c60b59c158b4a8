//! Fig. 7: receptance of the modified law from 9 to 32 N.

use anyhow::Result;
use asperity_figure::{Axis, ColorBar, Legend, Panel, Series};
use asperity_table::Table;

use super::levels::{SECOND_HARMONIC, yes};
use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig, levels, response};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig07",
    title: "Fig. 7: receptance from 9 to 32 N",
    caption: "Receptance of the top of the guide bar with the modified power law, struck with 9 \
              to 32 N in steps of 1 N (colour). The fundamental falls in frequency with the \
              force, and the second harmonic grows out of the flank. This is panel (b) of the \
              paper; panel (a), the experiment, is not published as numbers and is missing.",
    compute,
    draw,
};

/// Step of the frequencies shown, from 500 to 2000 Hz.
const STEP: f64 = 5.0;

/// Name of the column of a force level.
fn column(force: f64) -> String {
    format!("modified_{force:.0}_n:receptance_m_per_n")
}

fn compute(rig: &Rig) -> Result<Computed> {
    let frequency: Vec<f64> = (100..=400).map(|n| f64::from(n) * STEP).collect();
    let cases = rig.struck_with(Law::Modified, &levels())?;
    let curves = rig.observe(&cases, |_, run| {
        let response = response(run)?;
        Ok(frequency.iter().map(|&f| response.receptance_at(f).norm()).collect::<Vec<f64>>())
    })?;
    let second = super::levels::column(&rig.sweep(Law::Modified)?, SECOND_HARMONIC);
    // A level without a peak is a level without the number: the claim then has none either.
    let found = second.iter().all(|f| f.is_finite());
    let extreme = |pick: fn(f64, f64) -> f64, start: f64| {
        if found { second.iter().copied().fold(start, pick) } else { f64::NAN }
    };
    let values = vec![
        ("second_harmonic_every_level", yes(found)),
        ("second_harmonic_lowest", extreme(f64::min, f64::INFINITY)),
        ("second_harmonic_highest", extreme(f64::max, 0.0)),
    ];
    let mut table = Table::new().with_column("frequency_hz", frequency)?;
    for (force, curve) in levels().into_iter().zip(curves) {
        table.push(column(force), curve)?;
    }
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let frequency = table.column("frequency_hz")?;
    let forces = levels();
    let (low, high) = (forces[0], forces[forces.len() - 1]);
    let bar = ColorBar::continuous("Force", "N", low, high);
    let mut panel = Panel::new(
        Axis::linear("Frequency", "Hz").range(500.0, 2000.0),
        Axis::log("Receptance", "m/N"),
    )
    .legend(Legend::None)
    .vertical(1400.0, "")
    .vertical(1800.0, "");
    for force in forces {
        let series = Series::line("", frequency, table.column(&column(force))?);
        panel = panel.series(series.color(bar.color(force)).width(0.7));
    }
    style::svg("Receptance from 9 to 32 N", [panel.color_bar(bar)])
}
