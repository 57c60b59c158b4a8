//! The paper's colours and markers, the same in every figure.

use asperity_figure::{Color, Dash, Figure, Marker, Series};

/// Width of a journal column in mm.
pub(super) const COLUMN: f64 = 85.0;
/// Width of a journal page in mm.
pub(super) const PAGE: f64 = 170.0;

/// The power law: black circles.
pub(super) fn power(series: Series) -> Series {
    series.color(Color::BLACK).marker(Marker::Circle)
}

/// The modified power law: blue triangles.
pub(super) fn modified(series: Series) -> Series {
    series.color(Color::BLUE).marker(Marker::Triangle)
}

/// Measurements: red crosses.
pub(super) fn experiment(series: Series) -> Series {
    series.color(Color::RED).marker(Marker::Cross)
}

/// The constant stiffness: a grey dashed line.
pub(super) fn constant(series: Series) -> Series {
    series.color(Color::GREY).dash(Dash::Dashed)
}

/// A checked figure as SVG.
pub(super) fn svg(figure: &Figure) -> anyhow::Result<String> {
    figure.check()?;
    Ok(figure.to_svg())
}
