//! Fig. 11: amplitude of the fundamental against force.

use anyhow::Result;
use asperity_figure::Legend;
use asperity_table::Table;

use super::levels::{self, RECEPTANCE, Sweep, yes};
use super::style::amplitude_axis;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::Rig;

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig11",
    title: "Fig. 11: amplitude of the fundamental against force",
    caption: "Magnitude A1 of the receptance at the fundamental against the peak force, power law \
              (black circles) and modified power law (blue triangles). The measured amplitudes \
              (red crosses in the paper) are not published as numbers and are missing.",
    compute,
    draw,
};

const QUANTITY: &str = "receptance_m_per_n";

fn compute(rig: &Rig) -> Result<Computed> {
    let sweep = Sweep::new(rig, RECEPTANCE)?;
    let nowhere_up = |values: &[f64]| yes(values.windows(2).all(|pair| pair[1] <= pair[0]));
    let values = vec![
        ("amplitude_not_rising_modified", nowhere_up(&sweep.modified)),
        ("amplitude_not_rising_pl", nowhere_up(&sweep.power)),
    ];
    Ok(Computed { table: sweep.table(QUANTITY)?, values })
}

fn draw(table: &Table) -> Result<String> {
    let (title, axis) = ("Amplitude of the fundamental", amplitude_axis());
    levels::draw(table, title, QUANTITY, axis, Legend::BottomLeft)
}
