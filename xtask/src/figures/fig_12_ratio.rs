//! Fig. 12: second harmonic over fundamental against force.

use anyhow::Result;
use asperity_figure::{Axis, Legend};
use asperity_law::ContactLaw;
use asperity_table::Table;

use super::levels::{self, HARMONIC_RATIO, Sweep, rises, yes};
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig12",
    title: "Fig. 12: second harmonic over fundamental against force",
    caption: "Ratio A2/A1 of the receptance at its second harmonic and at its fundamental against \
              the peak force, power law (black circles) and modified power law (blue triangles). \
              The measured ratios (red crosses in the paper) are not published as numbers and are \
              missing.",
    compute,
    draw,
};

const QUANTITY: &str = "harmonic_ratio";

fn compute(rig: &Rig) -> Result<Computed> {
    let sweep = Sweep::new(rig, HARMONIC_RATIO)?;
    let above = sweep.modified.iter().zip(&sweep.power).all(|(modified, power)| modified > power);
    let case = rig.struck(Law::Modified, 32.0)?;
    let pressure = case.assembly()?.structure.contacts()[0].pressure();
    let nonlinearity = |law: Law| -> Result<f64> {
        let law = case.law(law, pressure)?;
        Ok(law.stiffness_slope(pressure) / law.stiffness(pressure))
    };
    let values = vec![
        ("ratio_rises_modified", rises(&sweep.modified)),
        ("ratio_rises_pl", rises(&sweep.power)),
        ("ratio_modified_above_pl", yes(above)),
        ("modified_more_nonlinear", yes(nonlinearity(Law::Modified)? > nonlinearity(Law::Power)?)),
    ];
    Ok(Computed { table: sweep.table(QUANTITY)?, values })
}

fn draw(table: &Table) -> Result<String> {
    let axis = Axis::linear("Ratio A_{2}/A_{1}", "").low(0.0);
    levels::draw(table, "Second harmonic over fundamental", QUANTITY, axis, Legend::TopLeft)
}
