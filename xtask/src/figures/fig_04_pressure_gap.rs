//! Fig. 4: pressure against interfacial gap, integrated from the modified law.

use anyhow::Result;
use asperity_figure::{Axis, Color, Legend, Panel, Series};
use asperity_law::ContactLaw;
use asperity_table::Table;

use super::levels::yes;
use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig04",
    title: "Fig. 4: contact pressure against gap",
    caption: "Contact pressure against the interfacial gap for the modified power law, the \
              integral of dp / K(p). The gap is zero at first contact and negative in \
              compression; the dot is static equilibrium under the weight of the guide bar.",
    compute,
    draw,
};

const ROWS: usize = 201;

fn compute(rig: &Rig) -> Result<Computed> {
    let case = rig.struck(Law::Modified, 32.0)?;
    let law = case.law(Law::Modified, 0.14e6)?;
    let pressure: Vec<f64> =
        (0..ROWS).map(|row| 1e6 * (row as f64 / (ROWS - 1) as f64).powi(2)).collect();
    let gap: Vec<f64> = pressure.iter().map(|&p| 0.0 - law.closure(p)).collect();
    let static_pressure = case.assembly()?.structure.contacts()[0].pressure();
    let softening = law.stiffness(0.01e6) / law.stiffness(1e6);
    let mut columns = Columns::default();
    columns.push("gap_m", gap);
    columns.push("pressure_pa", pressure);
    columns.push("static:gap_m", [-law.closure(static_pressure)]);
    columns.push("static:pressure_pa", [static_pressure]);
    let values = vec![("pressure_gap_nonlinear", yes(softening < 0.1))];
    Ok(Computed { values, ..columns.computed()? })
}

fn draw(table: &Table) -> Result<String> {
    let law =
        Series::line_points("Modified PL", table.column("gap_m")?, table.column("pressure_pa")?);
    let rest = Series::points(
        "static equilibrium",
        table.column("static:gap_m")?,
        table.column("static:pressure_pa")?,
    );
    let gap = Axis::linear("Interfacial gap", "µm").scale(1e6);
    let panel = Panel::new(gap, style::pressure_axis())
        .series(style::modified(law.marker_every(14)))
        .series(rest.color(Color::RED).filled(true))
        .legend(Legend::TopRight);
    style::svg("Pressure against gap", [panel])
}
