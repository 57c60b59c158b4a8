//! The figures that the subcommands write, from the same numbers as their tables.

mod analysis;
mod answers;
mod decay;
mod identification;
mod magnitude;
mod response;
mod steady;
mod structure;
mod sweep;

use asperity_figure::{Figure, Panel};

pub(crate) use analysis::{analysis_report, figures, responses};
pub(crate) use answers::answers;
pub(crate) use decay::{decay_figures, decay_report};
pub(crate) use identification::{identification, identification_report, measurement};
pub(crate) use response::{frf, history};
pub(crate) use steady::{steady, steady_report};
pub(crate) use structure::{laws, modes};
pub(crate) use sweep::sweep;

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
