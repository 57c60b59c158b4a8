//! Fig. 11: amplitude of the fundamental against force.

use anyhow::Result;
use asperity_figure::{Axis, Legend};
use asperity_table::Table;

use super::levels::{self, Sweep, yes};
use crate::reproduce::rig::Rig;
use crate::reproduce::{Computed, PaperFigure};

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
    let sweep = Sweep::new(rig, |summary| summary.fundamental.map(|peak| peak.receptance_m_per_n))?;
    let nowhere_up = |values: &[f64]| yes(values.windows(2).all(|pair| pair[1] <= pair[0]));
    let values = vec![
        ("amplitude_not_rising_modified", nowhere_up(&sweep.modified)),
        ("amplitude_not_rising_pl", nowhere_up(&sweep.power)),
    ];
    Ok(Computed { table: sweep.table(QUANTITY)?, values })
}

fn draw(table: &Table) -> Result<String> {
    let axis = Axis::linear("Amplitude A_{1}", "10^{-7} m/N").scale(1e7).low(0.0);
    levels::draw(table, "Amplitude of the fundamental", QUANTITY, axis, Legend::BottomLeft)
}
