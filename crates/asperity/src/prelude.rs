//! Names of everyday programs, for `use asperity::prelude::*`.

pub use crate::{HitError, SimulatedHit, Simulation, StackBuilder};

pub use asperity_dynamics::{FiniteDifference, Integrator, Modal, Transient};
pub use asperity_figure::{Axis, Figure, Panel, Series};
pub use asperity_harmonic::{
    Branch, ContactSystem, Continuation, HarmonicSettings, LawEvaluation, PeriodicResponse, trace,
};
pub use asperity_inference::{
    Fit, FitOptions, ForwardModel, FunctionModel, InferenceError, Observation, Parameter, fit,
};
pub use asperity_law::{
    Constant, ContactLaw, Exponential, GreenwoodWilliamson, Hyperbolic, InSeries, LawError,
    ModifiedPower, Persson, Power, Tabulated, fit_power,
};
pub use asperity_mesh::{Body, Port, Stack, Support};
pub use asperity_scenario::Document;
pub use asperity_signal::{
    FrequencyResponse, HarmonicOptions, ReceptanceFeatures, find_harmonics, half_power,
    logarithmic_decrement,
};
pub use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};
pub use asperity_table::Table;
