//! Figures and report pages of results, from the same numbers as their tables.
//!
//! A result is drawn by one function, whichever program asks: the command `asperity` writes its
//! figures to files, the Python package shows them in notebooks.
//!
//! | result | figures | page |
//! |---|---|---|
//! | transient run | [`history`], [`frf`], [`pressure_closure`] | in the words of [`run_words`] |
//! | sweep | [`sweep`] | |
//! | laws, modes | [`laws`], [`modes`] | |
//! | contact patches at rest | [`pressure_maps`] | |
//! | modes, and motion in a run, on the mesh of a body | [`mesh_shapes`], [`mesh_motion`] | |
//! | cells of contact patches over time | [`cell_histories`] | |
//! | steady responses | [`steady`] | [`steady_report`], in the words of [`steady_words`] |
//! | measured hits | [`figures`], [`responses`] | [`analysis_report`] |
//! | functions of a file | [`frf_file`] | |
//! | free decays | [`decay_figures`] | [`decay_report`] |
//! | identification | [`identification`] | [`identification_report`] |
//! | study | [`answers`] | |
//!
//! A function returns no figure where there is nothing to draw. Magnitudes have the
//! [`MagnitudeAxis`] that is asked for.
//!
//! ```
//! # use asperity_scenario::Document;
//! let scenario = Document::read("../simulation/examples/block.json")?.scenario()?;
//! let tables = asperity_simulation::ScenarioLaws::of_bars(&scenario)?.tables()?;
//! let svg = asperity_plot::laws(&tables).to_svg();
//! assert!(svg.contains("Contact stiffness"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod analysis;
mod answers;
mod axes;
mod decay;
mod frf_file;
mod identification;
mod magnitude;
mod mesh_shapes;
mod pressure_closure;
mod pressure_map;
mod response;
mod run_words;
mod steady;
pub mod steady_words;
mod structure;
mod sweep;

use asperity_figure::{Figure, Panel};

pub use analysis::{analysis_report, figures, responses};
pub use answers::answers;
pub use axes::pointer_words;
pub use decay::{decay_figures, decay_report};
pub use frf_file::frf_file;
pub use identification::{feature_name, identification, identification_report, measurement};
pub use magnitude::MagnitudeAxis;
pub use mesh_shapes::{mesh_motion, mesh_shapes};
pub use pressure_closure::pressure_closure;
pub use pressure_map::pressure_maps;
pub use response::{cell_histories, frf, history, measured_frf};
pub use run_words::run_words;
pub use steady::{steady, steady_report};
pub use structure::{VisitedRange, laws, laws_visited, modes};
pub use sweep::{HitSeries, hit_levels, sweep};

/// The text, cut to `most` characters.
fn fitted(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let kept: String = text.chars().take(most.saturating_sub(1)).collect();
    format!("{}…", kept.trim_end())
}

/// The text with a capital first.
fn capital(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_uppercase().collect::<String>());
    first.unwrap_or_default() + characters.as_str()
}

/// A figure of the panels that have a series; none without any.
fn figure(
    title: &str,
    columns: usize,
    width_mm: f64,
    panels: impl IntoIterator<Item = Panel>,
) -> Option<Figure> {
    let mut panels = panels.into_iter().filter(|panel| !panel.is_empty()).peekable();
    panels.peek()?;
    let figure = panels.fold(Figure::new(title), Figure::panel);
    Some(figure.columns(columns).width_mm(width_mm))
}
