//! From scenarios to results: transient runs, sweeps, steady responses, derivatives.
//!
//! A checked [`Scenario`](asperity_scenario::Scenario) is assembled to bodies with contact laws at
//! their interfaces, at static equilibrium ([`assemble`]). Its response to a force,
//!
//! ```text
//! rho A (u'' + h u' - g) = d/dx(E A du/dx)        bodies (Eq. 1)
//! p = p(d), d = u_above - u_below                 contacts (Eq. 5)
//! ```
//!
//! is integrated in time, and every command reads the same [`observables`] off it: the harmonics of
//! the receptance, extremes and averages of each contact, the energy balance, and [`warning`]s.
//! [`quantity`] is the table of them: key, unit, label, accessor, error scale and derivative.
//!
//! | step | modules |
//! |---|---|
//! | prepare | [`gap_table`], [`assemble`], [`static_state`], [`prepared_scenario`], [`parameter`], [`plausibility`] |
//! | compute | [`run`], [`mod@sweep`], [`row_simulator`], [`mod@steady`], [`modes`], [`sensitivity`], [`laws`], [`accuracy`], [`error_control`] |
//! | structures of matrices | [`patches`] |
//! | observe | [`quantity`], [`observables`], [`observable_extractor`], [`contact_path`], [`warning`] |
//! | write | [`contact_deck`], [`summary`], [`provenance`], [`record`], [`output`], [`error`] |

pub mod accuracy;
pub mod assemble;
pub mod contact_deck;
pub mod contact_path;
pub mod error;
pub mod error_control;
mod finite_differences;
pub mod gap_table;
pub mod laws;
pub mod modes;
pub mod observable_extractor;
pub mod observables;
pub mod output;
pub mod parameter;
pub mod patches;
pub mod plausibility;
pub mod prepared_scenario;
pub mod provenance;
pub mod quantity;
pub mod record;
mod response_parts;
mod row_inputs;
mod row_runner;
pub mod row_simulator;
pub mod run;
pub mod sensitivity;
mod shared_laws;
pub mod static_state;
pub mod steady;
pub mod summary;
pub mod sweep;
pub mod warning;

pub use laws::{ScenarioLaws, fit};
pub use patches::simulate_patches;
pub use run::{simulate, simulate_with_progress};
pub use sensitivity::sensitivities;
pub use steady::{SteadyProgress, steady, steady_with_progress};
pub use sweep::{sweep, sweep_with_progress};
