//! The paper's figures, one file each.

mod fig_02_model;
mod fig_03a_laws;
mod fig_03b_inflexion;
mod fig_04_pressure_gap;
mod fig_05_time_signals;
mod fig_06_frf;
mod style;

use crate::reproduce::PaperFigure;

/// Every figure, in the order of the paper.
pub(crate) const FIGURES: &[&PaperFigure] = &[
    &fig_02_model::FIGURE,
    &fig_03a_laws::FIGURE,
    &fig_03b_inflexion::FIGURE,
    &fig_04_pressure_gap::FIGURE,
    &fig_05_time_signals::FIGURE,
    &fig_06_frf::FIGURE,
];
