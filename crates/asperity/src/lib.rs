//! Dynamics of structures with rough contact interfaces, whose stiffness depends on pressure.
//!
//! Rough faces touch at their asperities. Their contact stiffness per area is a function of the
//! contact pressure, and a structure on such contacts obeys
//!
//! ```text
//! K(p) = dp/dd,    M w'' + h M w' + k w = f(t) - sum_i S_i (p_i(d_i) - p_i0) (e_above - e_below)
//! ```
//!
//! about its static equilibrium: pressure p, closure d of an interface of area S, displacement w,
//! mass M, stiffness k, damping rate h, force f. This crate contains all parts of asperity, one
//! module for each of its crates. [`prelude`] has the names of everyday programs, [`StackBuilder`]
//! and [`Simulation`] build a structure and hit it.
//!
//! # Example
//! One simulated hit on a bar on two rough contacts:
//! ```
//! use asperity::prelude::*;
//!
//! let law = Power::new(1.81e10, 0.35, 0.0)?;
//! let structure = StackBuilder::new()
//!     .body(Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0)?)
//!     .interface("guide-sample", 1.15e-4, law)
//!     .body(Body::new("sample", 0.015, 1.15e-4, 71e9, 2710.0)?)
//!     .interface("sample-disc", 1.15e-4, law)
//!     .preloaded(Damping::Ratio(0.035))?;
//! let hit = Simulation::of_hit(9.0).run(&structure)?;
//! let at_rest = structure.natural_frequency().ok_or("no stiffness at rest")?;
//! let fundamental = hit.fundamental_hz().ok_or("no peak")?;
//! assert!(fundamental < at_rest); // softer with amplitude
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Tour
//! From a law to a simulation:
//!
//! | step | module | entry |
//! |---|---|---|
//! | contact laws | [`law`] | [`law::ContactLaw`], [`law::Power`], [`law::Tabulated`], [`law::fit_power`] |
//! | bodies and interfaces | [`mesh`] | [`StackBuilder`], [`mesh::Stack`], [`mesh::ComponentModes`] |
//! | static equilibrium, linearised modes | [`structure`] | [`structure::PreloadedStructure`] |
//! | response to a hit | [`dynamics`] | [`Simulation`], [`dynamics::Integrator`] |
//! | response to a shaker, backbones | [`harmonic`] | [`harmonic::trace`] |
//! | spectra, FRFs, harmonics, damping | [`signal`] | [`signal::FrequencyResponse`], [`signal::hammer_test`] |
//! | files of finite-element programs | [`matrices`] | [`matrices::read()`], [`matrices::Deck`] |
//!
//! From a measurement to a law:
//!
//! | step | module | entry |
//! |---|---|---|
//! | files to samples | [`measure`] | [`measure::read`], [`measure::open`] |
//! | hits to features | [`experiment`] | [`experiment::analyse`] |
//! | fit, uncertainty, design | [`inference`] | [`inference::fit()`] |
//! | contact law of a measured structure | [`identify`] | [`identify`] |
//!
//! Many runs of any model:
//!
//! | step | module | entry |
//! |---|---|---|
//! | distributions, designs | [`sampling`] | [`sampling::InputSpace`], [`sampling::Design`] |
//! | quantiles, exceedance, Sobol indices | [`sampling`] | [`sampling::WeightedSample`], [`sampling::SensitivitySums`] |
//!
//! With files, as the command `asperity` does it:
//!
//! | step | module | entry |
//! |---|---|---|
//! | scenario files | [`scenario`] | [`scenario::Document`] |
//! | simulation, sweeps, steady responses | [`simulation`] | [`simulation::simulate`], [`simulation::sweep()`], [`simulation::steady()`] |
//! | studies of any size | [`study`] | [`study::StudyPlan`], [`study::run()`] |
//! | CSV | [`table`] | [`table::Table`] |
//! | figures | [`figure`] | [`figure::Figure`] |
//! | figures of results | [`plot`] | [`plot::history`], [`plot::steady()`] |
//!
//! All quantities are `f64` in SI units; positions and displacements point down, pressure is
//! positive in compression and closure when two faces approach.
//!
//! # Features
//! `hdf5` adds HDF5 files of measurements.

mod hit_simulation;
pub mod prelude;
mod stack_builder;

pub use hit_simulation::{HitError, SimulatedHit, Simulation};
pub use stack_builder::StackBuilder;

pub use asperity_dynamics as dynamics;
pub use asperity_experiment as experiment;
pub use asperity_figure as figure;
pub use asperity_harmonic as harmonic;
pub use asperity_identify as identify;
pub use asperity_inference as inference;
pub use asperity_law as law;
pub use asperity_matrices as matrices;
pub use asperity_measure as measure;
pub use asperity_mesh as mesh;
pub use asperity_plot as plot;
pub use asperity_sampling as sampling;
pub use asperity_scenario as scenario;
pub use asperity_signal as signal;
pub use asperity_simulation as simulation;
pub use asperity_structure as structure;
pub use asperity_study as study;
pub use asperity_table as table;
