//! The options of figures.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

use std::path::{Path, PathBuf};

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

impl FigureFormat {
    /// The format of a file by the ending of its name.
    pub(crate) fn of_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_lowercase();
        Self::from_str(&ending, true).ok()
    }
}

/// The name of a figure.
pub(crate) fn figure_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let known = FigureFormat::of_path(&path).is_some();
    known.then_some(path).ok_or_else(|| "accepted: a name that ends in .svg, .pdf or .png".into())
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
