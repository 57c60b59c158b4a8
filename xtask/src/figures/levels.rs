//! Figures against force: the table of both laws, and its drawing.

use anyhow::Result;
use asperity_figure::{Axis, Figure, Legend, Panel, Series};
use asperity_study::summary::Summary;
use asperity_table::Table;

use super::style;
use crate::reproduce::rig::{Law, Rig, levels};

/// One number of every run of both laws against force.
pub(super) struct Sweep {
    pub(super) power: Vec<f64>,
    pub(super) modified: Vec<f64>,
}

impl Sweep {
    /// `of` for every force level; NaN where a run has no such number.
    pub(super) fn new(rig: &Rig, of: fn(&Summary) -> Option<f64>) -> Result<Self> {
        let column = |law| -> Result<Vec<f64>> {
            Ok(rig.sweep(law)?.iter().map(|summary| of(summary).unwrap_or(f64::NAN)).collect())
        };
        Ok(Self { power: column(Law::Power)?, modified: column(Law::Modified)? })
    }

    /// The columns `force_n`, `pl:quantity` and `modified:quantity`.
    pub(super) fn table(&self, quantity: &str) -> Result<Table> {
        Ok(Table::new()
            .with_column("force_n", levels())?
            .with_column(format!("pl:{quantity}"), self.power.as_slice())?
            .with_column(format!("modified:{quantity}"), self.modified.as_slice())?)
    }
}

/// One if every value is above the one before, else zero.
pub(super) fn rises(values: &[f64]) -> f64 {
    yes(values.windows(2).all(|pair| pair[1] > pair[0]))
}

/// One if every value is below the one before, else zero.
pub(super) fn falls(values: &[f64]) -> f64 {
    yes(values.windows(2).all(|pair| pair[1] < pair[0]))
}

/// One for a statement that holds, zero for one that does not.
pub(super) fn yes(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

/// Decrease from the first value to the last, in per cent of the first.
pub(super) fn drop_percent(values: &[f64]) -> f64 {
    match (values.first(), values.last()) {
        (Some(first), Some(last)) => 100.0 * (1.0 - last / first),
        _ => f64::NAN,
    }
}

/// Both laws against force in the paper's colours and markers, in a column's width.
pub(super) fn draw(
    table: &Table,
    title: &str,
    quantity: &str,
    axis: Axis,
    legend: Legend,
) -> Result<String> {
    let force = table.column("force_n")?;
    let series = |name: &str, law: &str| -> Result<Series> {
        Ok(Series::line_points(name, force, table.column(&format!("{law}:{quantity}"))?).width(0.6))
    };
    let panel = Panel::new(force_axis(), axis)
        .series(style::power(series("PL", "pl")?))
        .series(style::modified(series("Modified PL", "modified")?))
        .legend(legend);
    style::svg(&Figure::new(title).panel(panel).width_mm(style::COLUMN))
}

/// The axis of the force levels.
pub(super) fn force_axis() -> Axis {
    Axis::linear("Force", "N").range(8.0, 33.0)
}
