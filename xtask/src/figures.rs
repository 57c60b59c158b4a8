//! The paper's figures, one file each.

mod fig_01_rig;
mod fig_02_model;
mod fig_03a_laws;
mod fig_03b_inflexion;
mod fig_04_pressure_gap;
mod fig_05_time_signals;
mod fig_06_frf;
mod fig_07_frf_levels;
mod fig_08_fundamental;
mod fig_09_pressure;
mod fig_10_average_stiffness;
mod fig_11_amplitude;
mod fig_12_ratio;
mod levels;
mod sketch;
mod style;
mod x_10_sensitivity;
mod x_11_prediction_bands;
mod x_12_free_law;
mod x_13_solid;
mod x_1_linear_floor;
mod x_2_pulse_shape;
mod x_3_convergence;
mod x_4_contact_loss;
mod x_5_compliant_disc;
mod x_6_readings;
mod x_7_second_path;
mod x_8_identified_law;
mod x_9_dissipation;

use crate::reproduce::paper_figure::PaperFigure;

/// Every figure, in the order of the paper, then what it could not show.
pub(crate) const FIGURES: &[&PaperFigure] = &[
    &fig_01_rig::FIGURE,
    &fig_02_model::FIGURE,
    &fig_03a_laws::FIGURE,
    &fig_03b_inflexion::FIGURE,
    &fig_04_pressure_gap::FIGURE,
    &fig_05_time_signals::FIGURE,
    &fig_06_frf::FIGURE,
    &fig_07_frf_levels::FIGURE,
    &fig_08_fundamental::FIGURE,
    &fig_09_pressure::FIGURE,
    &fig_10_average_stiffness::FIGURE,
    &fig_11_amplitude::FIGURE,
    &fig_12_ratio::FIGURE,
    &x_1_linear_floor::FIGURE,
    &x_2_pulse_shape::FIGURE,
    &x_3_convergence::FIGURE,
    &x_4_contact_loss::FIGURE,
    &x_5_compliant_disc::FIGURE,
    &x_6_readings::FIGURE,
    &x_7_second_path::FIGURE,
    &x_8_identified_law::FIGURE,
    &x_9_dissipation::FIGURE,
    &x_10_sensitivity::FIGURE,
    &x_11_prediction_bands::FIGURE,
    &x_12_free_law::FIGURE,
    &x_13_solid::FIGURE,
];
