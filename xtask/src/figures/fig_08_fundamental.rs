//! Fig. 8: frequency of the fundamental against force.

use anyhow::Result;
use asperity_figure::{Axis, Legend};
use asperity_table::Table;

use super::levels::{self, FREQUENCY, SECOND_HARMONIC, Sweep, drop_percent, falls, yes};
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::Rig;

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig08",
    title: "Fig. 8: fundamental against force",
    caption: "Frequency of the fundamental against the peak force, power law (black circles) and \
              modified power law (blue triangles). The measured frequencies (red crosses in the \
              paper) are not published as numbers and are missing. \
              The table also has the frequency of the second harmonic.",
    compute,
    draw,
};

const QUANTITY: &str = "frequency_hz";

fn compute(rig: &Rig) -> Result<Computed> {
    let sweep = Sweep::new(rig, FREQUENCY)?;
    let (modified, power) = (drop_percent(&sweep.modified), drop_percent(&sweep.power));
    let values = vec![
        ("fundamental_falls_modified", falls(&sweep.modified)),
        ("fundamental_falls_pl", falls(&sweep.power)),
        ("fundamental_drop_modified", modified),
        ("fundamental_drop_pl", power),
        ("fundamental_drop_greater", yes(modified > power)),
    ];
    let second = Sweep::new(rig, SECOND_HARMONIC)?;
    let table = sweep
        .table(QUANTITY)?
        .with_column("pl:second_harmonic_hz", second.power)?
        .with_column("modified:second_harmonic_hz", second.modified)?;
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let axis = Axis::linear("Frequency f_{1}", "Hz").range(800.0, 1000.0);
    levels::draw(table, "Fundamental against force", QUANTITY, axis, Legend::TopRight)
}
