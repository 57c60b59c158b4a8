//! Tables to SVG, PDF, PNG and HTML.
//!
//! A [`Figure`] draws columns of numbers on [`Panel`]s with labelled [`Axis`] pairs; a
//! [`Report`](report::Report) gathers figures and tables into one page.
//!
//! ```
//! use asperity_figure::{Axis, Color, Dash, Figure, Panel, Series};
//! let frequency: Vec<f64> = (0..200).map(f64::from).collect();
//! let gain: Vec<f64> = frequency.iter().map(|f| 1.0 / (1.0 + (f / 50.0).powi(4))).collect();
//! let figure = Figure::new("Gain").panel(
//!     Panel::new(Axis::linear("Frequency", "Hz"), Axis::log("Gain", ""))
//!         .series(Series::line("model", &frequency, &gain).color(Color::BLUE).dash(Dash::Dashed)),
//! );
//! assert!(figure.to_svg().starts_with("<svg"));
//! assert!(!figure.to_png(10.0)?.is_empty());
//! # Ok::<(), asperity_figure::FigureError>(())
//! ```
//!
//! Lengths on the page are CSS pixels of 1/96 inch, rounded to 0.01; text is measured with the
//! bundled Inter so that nothing overlaps, and pictures are rasterised with that font alone. The
//! same numbers give the same bytes on every machine.
//!
//! Labels, names and notes may hold `_{...}` for a subscript and `^{...}` for a superscript.
//!
//! | module | holds |
//! |---|---|
//! | `series`, `axis`, `panel`, `figure` | the figure as data |
//! | `scale`, `ticks`, `tick_label`, `ruler` | axes: from data to the page |
//! | `frame`, `trace` | rectangles, clipping and decimation of curves |
//! | `line`, `mark`, `error_bar`, `plot`, `note`, `legend`, `color_bar` | parts of a panel |
//! | `layout` | frames of all panels in rows and columns; [`Figure::to_svg`] |
//! | `markup`, `svg`, `text` | SVG text, glyph widths |
//! | `raster`, `pdf`, `pdf_font` | SVG text to PNG and PDF |
//! | `interactive` | points of a figure for zoom and values on a page |
//! | [`report`] with `html`, `embed`, `markdown` | pages |

mod axis;
mod color;
mod color_bar;
mod error;
mod error_bar;
mod figure;
mod frame;
mod interactive;
mod layout;
mod legend;
mod line;
mod mark;
mod markup;
mod note;
mod panel;
mod pdf;
mod pdf_font;
mod plot;
mod raster;
pub mod report;
mod ruler;
mod scale;
mod series;
mod svg;
mod text;
mod tick_label;
mod ticks;
mod trace;

pub use axis::Axis;
pub use color::{CATEGORIES, Color};
pub use color_bar::ColorBar;
pub use error::FigureError;
pub use figure::Figure;
pub use interactive::{INTERACTIVE_SCRIPT, InteractiveFigure};
pub use panel::{Anchor, Legend, Panel};
pub use pdf::svg_to_pdf;
pub use raster::svg_to_png;
pub use series::{Dash, Marker, Series};
pub use text::{BUNDLED_FONTS, BundledFont};
