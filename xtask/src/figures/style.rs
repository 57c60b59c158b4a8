//! The paper's colours and markers, the same in every figure.

use anyhow::Result;
use asperity_figure::{Axis, Color, Figure, Marker, Panel, Series};
use asperity_table::Table;

/// Width of a journal column in mm.
pub(super) const COLUMN: f64 = 85.0;
/// Width of a journal page in mm.
const PAGE: f64 = 170.0;

/// The power law: black circles.
pub(super) fn power(series: Series) -> Series {
    series.color(Color::BLACK).marker(Marker::Circle)
}

/// The modified power law: blue triangles.
pub(super) fn modified(series: Series) -> Series {
    series.color(Color::BLUE).marker(Marker::Triangle)
}

/// The columns `pl:quantity` and `modified:quantity` over the column `x`, with the line of `of`.
pub(super) fn both_laws(
    table: &Table,
    x: &str,
    quantity: &str,
    of: fn(Series) -> Series,
) -> Result<[Series; 2]> {
    let series = |name: &str, law: &str| -> Result<Series> {
        let y = table.column(&format!("{law}:{quantity}"))?;
        Ok(of(Series::line_points(name, table.column(x)?, y)))
    };
    Ok([power(series("PL", "pl")?), modified(series("Modified PL", "modified")?)])
}

/// Axis of a contact pressure in Pa.
pub(super) fn pressure_axis() -> Axis {
    Axis::linear("Contact pressure", "MPa").scale(1e-6)
}

/// Axis of an amplitude A1 in m/N.
pub(super) fn amplitude_axis() -> Axis {
    Axis::linear("Amplitude A_{1}", "10^{-7} m/N").scale(1e7).low(0.0)
}

/// The figure of these panels: one as wide as a column, several as wide as a page.
pub(super) fn figure(title: &str, panels: impl IntoIterator<Item = Panel>) -> Figure {
    let panels: Vec<Panel> = panels.into_iter().collect();
    let width = if panels.len() == 1 { COLUMN } else { PAGE };
    panels.into_iter().fold(Figure::new(title).width_mm(width), Figure::panel)
}

/// [`figure`], checked, as SVG.
pub(super) fn svg(title: &str, panels: impl IntoIterator<Item = Panel>) -> Result<String> {
    checked(&figure(title, panels))
}

/// A figure as SVG, if it can be drawn.
pub(super) fn checked(figure: &Figure) -> Result<String> {
    figure.check()?;
    Ok(figure.to_svg())
}
