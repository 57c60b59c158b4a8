//! Figures against force: the table of both laws, and its drawing.

use std::sync::Arc;

use anyhow::Result;
use asperity_figure::{Axis, Color, Dash, Legend, Marker, Panel, Series};
use asperity_simulation::summary::Summary;
use asperity_table::Table;

use super::style;
use crate::reproduce::rig::{Law, Rig, levels};

/// A number of a run; none where the run has no such number.
pub(super) type Observable = fn(&Summary) -> Option<f64>;

/// Frequency of the fundamental.
pub(super) const FREQUENCY: Observable = |summary| Some(summary.fundamental?.frequency_hz);
/// Receptance at the fundamental.
pub(super) const RECEPTANCE: Observable = |summary| Some(summary.fundamental?.amplitude.value());
/// Frequency of the second harmonic.
pub(super) const SECOND_HARMONIC: Observable =
    |summary| Some(summary.second_harmonic?.frequency_hz);
/// Ratio of second harmonic and fundamental.
pub(super) const HARMONIC_RATIO: Observable = |summary| summary.harmonic_ratio;
/// Lowest pressure between guide bar and sample.
pub(super) const PRESSURE_MIN: Observable =
    |summary| Some(summary.interfaces.first()?.pressure_min_pa);
/// Time without contact between guide bar and sample.
pub(super) const CONTACT_LOST: Observable =
    |summary| Some(summary.interfaces.first()?.contact_lost_s);
/// Average stiffness between guide bar and sample.
pub(super) const STIFFNESS_AVERAGE: Observable =
    |summary| Some(summary.interfaces.first()?.stiffness_average_pa_per_m);

/// An observable of each run; NaN where a run has no such number.
pub(super) fn column(summaries: &[Arc<Summary>], of: Observable) -> Vec<f64> {
    summaries.iter().map(|summary| of(summary).unwrap_or(f64::NAN)).collect()
}

/// One number of every run of both laws against force.
pub(super) struct Sweep {
    pub(super) power: Vec<f64>,
    pub(super) modified: Vec<f64>,
}

impl Sweep {
    /// `of` for every force level; NaN where a run has no such number.
    pub(super) fn new(rig: &Rig, of: Observable) -> Result<Self> {
        let (power, modified) = (rig.sweep(Law::Power)?, rig.sweep(Law::Modified)?);
        Ok(Self { power: column(&power, of), modified: column(&modified, of) })
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
    style::svg(title, [both_laws(table, quantity, force_axis(), axis)?.legend(legend)])
}

/// A quantity of both laws against force.
pub(super) fn both_laws(table: &Table, quantity: &str, force: Axis, axis: Axis) -> Result<Panel> {
    let laws = style::both_laws(table, "force_n", quantity, |series| series.width(0.6))?;
    Ok(Panel::new(force, axis).all_series(laws))
}

/// Columns `name:quantity` against force, each with its label, colour, marker and line.
pub(super) fn variants(
    table: &Table,
    quantity: &str,
    axis: Axis,
    variants: &[(&str, &str, Color, Marker, Dash)],
) -> Result<Panel> {
    let force = table.column("force_n")?;
    let mut panel = Panel::new(force_axis(), axis).legend(Legend::Above);
    for &(name, label, color, marker, dash) in variants {
        let column = table.column(&format!("{name}:{quantity}"))?;
        let series = Series::line_points(label, force, column).width(0.7);
        panel = panel.series(series.color(color).marker(marker).dash(dash));
    }
    Ok(panel)
}

/// The axis of the force levels.
pub(super) fn force_axis() -> Axis {
    Axis::linear("Force", "N").range(8.0, 33.0)
}
