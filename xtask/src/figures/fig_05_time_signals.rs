//! Fig. 5: force and acceleration at 32 N.

use anyhow::Result;
use asperity_figure::{Axis, Color, Legend, Panel, Series};
use asperity_table::Table;

use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig05",
    title: "Fig. 5: force and acceleration at 32 N",
    caption: "(a) Hammer force and (b) acceleration of the top of the guide bar with the modified \
              power law. The measured force and acceleration are not published as numbers: the \
              pulse F (t/tp)^{2} exp(2 (1 - t/tp)) with tp = 0.34 ms and a peak of 32 N stands in \
              for the measured one, and the experimental acceleration is missing.",
    compute,
    draw,
};

/// The part of the run that the figure shows, in s; its end is not, however times are rounded.
const SHOWN: f64 = 0.02;

fn compute(rig: &Rig) -> Result<Computed> {
    let run = rig.run(&rig.struck(Law::Modified, 32.0)?)?;
    let history = &run.transient.history;
    let shown = history.time.partition_point(|&time| time < SHOWN * (1.0 - 1e-9));
    let table = Table::new()
        .with_column("time_s", &history.time[..shown])?
        .with_column("force_n", &history.load[..shown])?
        .with_column("acceleration_m_per_s2", &history.sensors[0].acceleration[..shown])?;
    let peak = history.load.iter().copied().fold(0.0, f64::max);
    Ok(Computed { table, values: vec![("force_level", peak)] })
}

fn draw(table: &Table) -> Result<String> {
    let time = table.column("time_s")?;
    let panel = |column: &str, label: &str, unit: &str, color| -> Result<Panel> {
        let axis = Axis::linear("Time", "ms").scale(1e3);
        let series = Series::line("", time, table.column(column)?).color(color);
        Ok(Panel::new(axis, Axis::linear(label, unit)).series(series).legend(Legend::None))
    };
    let force = panel("force_n", "Force", "N", Color::BLACK)?;
    let acceleration = panel("acceleration_m_per_s2", "Acceleration", "m/s²", Color::BLUE)?;
    style::svg("Force and acceleration", [force, acceleration])
}
