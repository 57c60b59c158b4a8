//! Fig. 4: pressure against interfacial gap, integrated from the modified law.

use anyhow::Result;
use asperity_figure::{Axis, Color, Figure, Legend, Panel, Series};
use asperity_law::ContactLaw;
use asperity_scenario::LawRef;
use asperity_study::assemble::build_law;
use asperity_table::Table;

use super::style;
use crate::reproduce::rig::{Law, Rig};
use crate::reproduce::{Computed, PaperFigure};

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
    let law = build_law(&LawRef::Named("modified".to_owned()), &case.scenario.laws, 0.14e6)?;
    let pressure: Vec<f64> =
        (0..ROWS).map(|row| 1e6 * (row as f64 / (ROWS - 1) as f64).powi(2)).collect();
    let gap: Vec<f64> = pressure.iter().map(|&p| 0.0 - law.closure(p)).collect();
    let static_pressure = case.assembly()?.structure.contacts()[0].pressure();
    let only_first = |value: f64| {
        let mut column = vec![f64::NAN; ROWS];
        column[0] = value;
        column
    };
    let softening = law.stiffness(0.01e6) / law.stiffness(1e6);
    let table = Table::new()
        .with_column("gap_m", gap)?
        .with_column("pressure_pa", pressure)?
        .with_column("static:gap_m", only_first(-law.closure(static_pressure)))?
        .with_column("static:pressure_pa", only_first(static_pressure))?;
    let values = vec![("pressure_gap_nonlinear", f64::from(u8::from(softening < 0.1)))];
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let law =
        Series::line_points("Modified PL", table.column("gap_m")?, table.column("pressure_pa")?);
    let rest = Series::points(
        "static equilibrium",
        table.column("static:gap_m")?,
        table.column("static:pressure_pa")?,
    );
    let panel = Panel::new(
        Axis::linear("Interfacial gap", "µm").scale(1e6),
        Axis::linear("Contact pressure", "MPa").scale(1e-6),
    )
    .series(style::modified(law.marker_every(14)))
    .series(rest.color(Color::RED).filled(true))
    .legend(Legend::TopRight);
    style::svg(&Figure::new("Pressure against gap").panel(panel).width_mm(style::COLUMN))
}
