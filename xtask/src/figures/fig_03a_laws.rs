//! Fig. 3a: the contact laws, and the measurements of Table 3.

use anyhow::{Context, Result};
use asperity_figure::{Axis, Figure, Legend, Panel, Series};
use asperity_law::{ContactLaw, fit_power};
use asperity_scenario::{LawRef, LawSpec};
use asperity_study::assemble::build_law;
use asperity_table::Table;

use super::style;
use crate::reproduce::rig::{Law, Rig};
use crate::reproduce::{Computed, PaperFigure};

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
    let laws = &case.scenario.laws;
    let law = |law: Law| build_law(&LawRef::Named(law.key().to_owned()), laws, 0.14e6);
    let (power, modified) = (law(Law::Power)?, law(Law::Modified)?);
    let pressure: Vec<f64> =
        (0..ROWS).map(|row| 1e6 * (row as f64 / (ROWS - 1) as f64).powi(2)).collect();
    let stiffness =
        |law: &dyn ContactLaw| pressure.iter().map(|&p| law.stiffness(p)).collect::<Vec<_>>();
    let Some(LawSpec::Table { points }) = laws.get("measured") else {
        anyhow::bail!("the scenario has no table of measurements named \"measured\"");
    };
    let points: Vec<(f64, f64)> = points.iter().map(|&[p, k]| (p, k)).collect();
    let padded = |pick: fn(&(f64, f64)) -> f64| {
        let mut column: Vec<f64> = points.iter().map(pick).collect();
        column.resize(ROWS, f64::NAN);
        column
    };
    let fit = fit_power(&points).context("fitting Table 3")?;
    let worst =
        points.iter().map(|&(p, k)| (power.stiffness(p) / k - 1.0).abs()).fold(0.0, f64::max);
    let transition = 2e5;
    let values = vec![
        ("table3_coefficient", fit.coefficient),
        ("table3_exponent", fit.exponent),
        ("table3_agreement", worst),
        (
            "modified_equals_pl_above",
            f64::from(u8::from(
                [transition, 4e5, 1e6]
                    .iter()
                    .all(|&p| (modified.stiffness(p) / power.stiffness(p) - 1.0).abs() < 1e-12),
            )),
        ),
        (
            "modified_below_pl",
            f64::from(u8::from(
                [1e4, 5e4, 1e5, 1.4e5].iter().all(|&p| modified.stiffness(p) < power.stiffness(p)),
            )),
        ),
    ];
    let table = Table::new()
        .with_column("pl:stiffness_pa_per_m", stiffness(&power))?
        .with_column("modified:stiffness_pa_per_m", stiffness(&modified))?
        .with_column("pressure_pa", pressure)?
        .with_column("table3:pressure_pa", padded(|point| point.0))?
        .with_column("table3:stiffness_pa_per_m", padded(|point| point.1))?;
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let pressure = table.column("pressure_pa")?;
    let line = |name: &str, column: &str| -> Result<Series> {
        Ok(Series::line_points(name, pressure, table.column(column)?).marker_every(14))
    };
    let measured = Series::points(
        "Table 3",
        table.column("table3:pressure_pa")?,
        table.column("table3:stiffness_pa_per_m")?,
    );
    let panel = Panel::new(
        Axis::linear("Contact pressure", "MPa").scale(1e-6),
        Axis::linear("Contact stiffness", "Pa/m"),
    )
    .series(style::power(line("PL", "pl:stiffness_pa_per_m")?))
    .series(style::modified(line("Modified PL", "modified:stiffness_pa_per_m")?))
    .series(style::experiment(measured).marker_size(6.0))
    .legend(Legend::BottomRight);
    style::svg(&Figure::new("Contact laws").panel(panel).width_mm(style::COLUMN))
}
