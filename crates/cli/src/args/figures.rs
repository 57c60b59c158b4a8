//! The options of figures.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

use clap::{Args as Group, ValueEnum};

/// Formats of the figures.
#[derive(Debug, Group)]
pub(crate) struct FigureOptions {
    /// Formats of the figures, separated by commas: svg, pdf, png (300 dpi).
    #[arg(
        long,
        value_name = "FORMAT,...",
        value_delimiter = ',',
        default_value = "svg",
        hide_possible_values = true
    )]
    pub(crate) figures: Vec<FigureFormat>,
}

/// Format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub(crate) enum FigureFormat {
    /// Scalable Vector Graphics.
    Svg,
    /// Portable Document Format, for documents.
    Pdf,
    /// Portable Network Graphics, for slides.
    Png,
}

/// Axis of the magnitudes of frequency response functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum MagnitudeAxis {
    /// Linear.
    Linear,
    /// Logarithmic.
    #[default]
    Log,
    /// Decibels, relative to one unit.
    Db,
}

impl From<MagnitudeAxis> for asperity_plot::MagnitudeAxis {
    fn from(axis: MagnitudeAxis) -> Self {
        match axis {
            MagnitudeAxis::Linear => Self::Linear,
            MagnitudeAxis::Log => Self::Log,
            MagnitudeAxis::Db => Self::Db,
        }
    }
}
