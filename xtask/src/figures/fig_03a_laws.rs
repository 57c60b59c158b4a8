//! Fig. 3a: the contact laws, and the measurements of Table 3.

use anyhow::{Context, Result};
use asperity_figure::{Axis, Color, Legend, Marker, Panel, Series};
use asperity_law::{ContactLaw, fit_power};
use asperity_table::Table;

use super::levels::yes;
use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Law, Rig};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "fig03a",
    title: "Fig. 3a: contact stiffness against pressure",
    caption: "Contact stiffness against contact pressure: the power law fitted to Table 3 (PL, \
              black circles), the modified power law (blue triangles), and Table 3 itself (red \
              crosses). The paper gives no formula for the modified law: this one is \
              reconstructed from the stiffnesses that its text quotes for Fig. 9.",
    compute,
    draw,
};

/// Pressures from 0 to 1 MPa, crowded towards zero.
const ROWS: usize = 201;

fn compute(rig: &Rig) -> Result<Computed> {
    let case = rig.struck(Law::Modified, 32.0)?;
    let (power, modified) = (case.law(Law::Power, 0.14e6)?, case.law(Law::Modified, 0.14e6)?);
    let pressure: Vec<f64> =
        (0..ROWS).map(|row| 1e6 * (row as f64 / (ROWS - 1) as f64).powi(2)).collect();
    let stiffness =
        |law: &dyn ContactLaw| pressure.iter().map(|&p| law.stiffness(p)).collect::<Vec<_>>();
    let points = case.table_3()?;
    let fit = fit_power(&points).context("fitting Table 3")?;
    let worst =
        points.iter().map(|&(p, k)| (power.stiffness(p) / k - 1.0).abs()).fold(0.0, f64::max);
    let mut same =
        [2e5, 4e5, 1e6].iter().map(|&p| (modified.stiffness(p) / power.stiffness(p) - 1.0).abs());
    let mut lower = [1e4, 5e4, 1e5, 1.4e5].into_iter();
    let values = vec![
        ("table3_coefficient", fit.coefficient),
        ("table3_exponent", fit.exponent),
        ("table3_agreement", worst),
        ("modified_equals_pl_above", yes(same.all(|difference| difference < 1e-12))),
        ("modified_below_pl", yes(lower.all(|p| modified.stiffness(p) < power.stiffness(p)))),
    ];
    let (measured_pressure, measured): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    let mut columns = Columns::default();
    columns.push("pl:stiffness_pa_per_m", stiffness(&power));
    columns.push("modified:stiffness_pa_per_m", stiffness(&modified));
    columns.push("pressure_pa", pressure);
    columns.push("table3:pressure_pa", measured_pressure);
    columns.push("table3:stiffness_pa_per_m", measured);
    Ok(Computed { values, ..columns.computed()? })
}

fn draw(table: &Table) -> Result<String> {
    let quantity = "stiffness_pa_per_m";
    let laws = style::both_laws(table, "pressure_pa", quantity, |series| series.marker_every(14))?;
    let measured = Series::points(
        "Table 3",
        table.column("table3:pressure_pa")?,
        table.column("table3:stiffness_pa_per_m")?,
    );
    let panel = Panel::new(style::pressure_axis(), Axis::linear("Contact stiffness", "Pa/m"))
        .all_series(laws)
        .series(measured.color(Color::RED).marker(Marker::Cross).marker_size(6.0))
        .legend(Legend::BottomRight);
    style::svg("Contact laws", [panel])
}
