//! Fig. 10: average contact stiffness against force.

use anyhow::Result;
use asperity_figure::{Axis, Legend};
use asperity_table::Table;

use super::levels::{self, PRESSURE_MIN, STIFFNESS_AVERAGE, Sweep, falls};
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::Rig;

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig10",
    title: "Fig. 10: average contact stiffness against force",
    caption: "K_avr of Eq. (8) over the whole run of 0.12 s, contact between guide bar and \
              sample, power law (black circles) and modified power law (blue triangles). The \
              average depends on how long the ring-down is watched: the longer, the nearer to \
              the static stiffness. The table also has the lowest pressure of each run and the \
              law's stiffness there.",
    compute,
    draw,
};

const QUANTITY: &str = "stiffness_average_pa_per_m";

fn compute(rig: &Rig) -> Result<Computed> {
    let sweep = Sweep::new(rig, STIFFNESS_AVERAGE)?;
    let lowest = Sweep::new(rig, PRESSURE_MIN)?;
    let there = Sweep::new(rig, |summary| {
        Some(summary.interfaces.first()?.stiffness_at_pressure_min_pa_per_m)
    })?;
    let table = sweep
        .table(QUANTITY)?
        .with_column("pl:pressure_min_pa", lowest.power)?
        .with_column("modified:pressure_min_pa", lowest.modified)?
        .with_column("pl:stiffness_at_pressure_min_pa_per_m", there.power)?
        .with_column("modified:stiffness_at_pressure_min_pa_per_m", there.modified)?;
    let values = vec![
        ("average_stiffness_falls_modified", falls(&sweep.modified)),
        ("average_stiffness_falls_pl", falls(&sweep.power)),
    ];
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let axis = Axis::linear("Average stiffness K_{avr}", "10^{12} Pa/m").scale(1e-12);
    levels::draw(table, "Average contact stiffness", QUANTITY, axis, Legend::Auto)
}
