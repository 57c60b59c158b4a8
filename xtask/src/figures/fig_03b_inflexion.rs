//! Fig. 3b: the inflexion of the modified law at low pressure.

use anyhow::Result;
use asperity_figure::{Axis, Color, Legend, Panel, Series};
use asperity_law::ContactLaw;
use asperity_table::Table;

use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig03b",
    title: "Fig. 3b: the inflexion at low pressure",
    caption: "The modified power law (blue triangles) below 0.3 MPa, with the power law (black) \
              for comparison and the stiffness slope dK/dp in panel (b): its maximum is the \
              inflexion. The measurements of the paper's reference [6] (black squares there) are \
              not published as numbers and are missing here.",
    compute,
    draw,
};

const ROWS: usize = 301;
const TOP: f64 = 0.3e6;

fn compute(rig: &Rig) -> Result<Computed> {
    let case = rig.struck(Law::Modified, 32.0)?;
    let (power, modified) = (case.law(Law::Power, 0.14e6)?, case.law(Law::Modified, 0.14e6)?);
    let pressure: Vec<f64> = (0..ROWS).map(|row| TOP * row as f64 / (ROWS - 1) as f64).collect();
    let column = |of: &dyn Fn(f64) -> f64| pressure.iter().map(|&p| of(p)).collect::<Vec<_>>();
    let slope = column(&|p| modified.stiffness_slope(p));
    let steepest = (0..ROWS).max_by(|&a, &b| slope[a].total_cmp(&slope[b])).unwrap_or_default();
    let values = vec![("inflexion_pressure", pressure[steepest] / 1e6)];
    let table = Table::new()
        .with_column("modified:stiffness_pa_per_m", column(&|p| modified.stiffness(p)))?
        .with_column("pl:stiffness_pa_per_m", column(&|p| power.stiffness(p)))?
        .with_column("modified:slope_1_per_m", slope)?
        .with_column("pressure_pa", pressure)?;
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let pressure = table.column("pressure_pa")?;
    let quantity = "stiffness_pa_per_m";
    let laws = style::both_laws(table, "pressure_pa", quantity, |series| series.marker_every(25))?;
    let laws = Panel::new(style::pressure_axis(), Axis::linear("Contact stiffness", "Pa/m"))
        .all_series(laws)
        .legend(Legend::BottomRight);
    let slope = Series::line("", pressure, table.column("modified:slope_1_per_m")?);
    let slope = Panel::new(style::pressure_axis(), Axis::linear("Slope dK/dp", "1/m"))
        .series(slope.color(Color::BLUE))
        .legend(Legend::None);
    style::svg("The inflexion at low pressure", [laws, slope])
}
