//! Fig. 9: contact pressure and stiffness at 9 and 32 N.

use anyhow::Result;
use asperity_figure::{Axis, Color, Dash, Legend, Panel, Series};
use asperity_law::ContactLaw;
use asperity_table::Table;

use super::levels::yes;
use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig09",
    title: "Fig. 9: contact pressure and stiffness at 9 and 32 N",
    caption: "Contact between guide bar and sample with the modified power law, struck with 32 N \
              (red) and 9 N (black): (a) contact pressure against time, with the paper's quoted \
              extremes dashed, and (b) stiffness against the pressures passed through. The paper \
              counts stress, so its extremes are negative there. Both curves of (b) lie on the \
              law; they differ in how far they reach.",
    compute,
    draw,
};

/// The part of the run that the figure shows, in s.
const SHOWN: f64 = 0.02;
/// Every so many of the samples are shown.
const STRIDE: usize = 4;
/// The pressures that the paper quotes for 9 N and 32 N, in Pa.
const QUOTED: [f64; 2] = [0.078e6, 0.025e6];

fn compute(rig: &Rig) -> Result<Computed> {
    let mut table = Table::new();
    let mut values = Vec::new();
    for (force, lowest, average) in [
        (9.0, "lowest_pressure_9_n", "average_stiffness_9_n"),
        (32.0, "lowest_pressure_32_n", "average_stiffness_32_n"),
    ] {
        let run = rig.run(&rig.struck(Law::Modified, force)?)?;
        let history = &run.transient.history;
        let shown = history.time.partition_point(|&time| time <= SHOWN);
        let every = |values: &[f64]| -> Vec<f64> {
            values[..shown].iter().copied().step_by(STRIDE).collect()
        };
        if !table.has_column("time_s") {
            table.push("time_s", every(&history.time))?;
        }
        let contact = &history.interfaces[0];
        table.push(format!("{force:.0}_n:pressure_pa"), every(&contact.pressure))?;
        table.push(format!("{force:.0}_n:stiffness_pa_per_m"), every(&contact.stiffness))?;
        let summary = &run.summary.interfaces[0];
        values.push((lowest, summary.pressure_min_pa / 1e6));
        values.push((average, summary.stiffness_average_pa_per_m));
    }
    let law = rig.struck(Law::Modified, 32.0)?.law(Law::Modified, 0.14e6)?;
    values.push(("stiffness_at_quoted_9_n", law.stiffness(QUOTED[0])));
    values.push(("stiffness_at_quoted_32_n", law.stiffness(QUOTED[1])));
    for (law, id) in [(Law::Modified, "compression_modified"), (Law::Power, "compression_pl")] {
        let sweep = rig.sweep(law)?;
        let mut contacts = sweep.iter().flat_map(|summary| &summary.interfaces);
        let held = contacts.all(|c| c.pressure_min_pa > 0.0 && c.contact_lost_s == 0.0);
        values.push((id, yes(held)));
    }
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let time = table.column("time_s")?;
    let pressure_axis = || style::pressure_axis().low(0.0);
    let time_axis = Axis::linear("Time", "ms").scale(1e3).range(0.0, 20.0);
    let mut history = Panel::new(time_axis, pressure_axis()).legend(Legend::TopRight);
    let stiffness_axis = Axis::linear("Contact stiffness", "10^{12} Pa/m").scale(1e-12).low(0.0);
    let mut law = Panel::new(pressure_axis(), stiffness_axis).legend(Legend::None);
    // The larger history is drawn first, so that the smaller one shows on it.
    for (force, color, quoted) in [("32", Color::RED, QUOTED[1]), ("9", Color::BLACK, QUOTED[0])] {
        let pressure = table.column(&format!("{force}_n:pressure_pa"))?;
        let stiffness = table.column(&format!("{force}_n:stiffness_pa_per_m"))?;
        let name = format!("{force} N");
        let level = Series::line("", [0.0, SHOWN], [quoted, quoted]);
        history = history
            .series(level.color(color).dash(Dash::Dashed).width(0.5))
            .series(Series::line(name, time, pressure).color(color));
        let mut reached: Vec<(f64, f64)> =
            pressure.iter().copied().zip(stiffness.iter().copied()).collect();
        reached.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (x, y): (Vec<f64>, Vec<f64>) = reached.into_iter().unzip();
        let series = Series::line("", x, y).color(color);
        law = law.series(series.width(if force == "9" { 2.4 } else { 1.0 }));
    }
    style::svg("Contact pressure and stiffness", [history, law])
}
