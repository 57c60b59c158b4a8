//! Scenario files: one computation as typed data, with every fault of a text at its place.
//!
//! A scenario is a JSON object that states a stack of elastic bodies with rough contacts, its
//! damping, the force on its top and the method of time integration. [`Document::read`] (or
//! [`Document::parse`]) takes the text, [`Document::set`] changes single values, and
//! [`Document::scenario`] returns the typed [`Scenario`] or all faults of the text:
//!
//! ```text
//! text -> JSON value -> JSON Schema of the types -> conditions between values -> Scenario
//! ```
//!
//! ```
//! use asperity_scenario::Document;
//!
//! let text = r#"{
//!   "schema": "asperity/scenario/1",
//!   "bodies": [{"name": "bar", "length_m": 0.1, "area_m2": 1e-4,
//!               "youngs_modulus_pa": 71e9, "density_kg_per_m3": 2710}],
//!   "interfaces": [{"name": "foot", "area_m2": 1e-4,
//!                   "law": {"kind": "power", "coefficient": 1.81e10, "exponent": 0.35}}],
//!   "damping": {"kind": "mass_proportional", "ratio": 0.035},
//!   "duration_s": 0.05
//! }"#;
//! let mut document = Document::parse(text, "bar.json")?;
//! document.set("/bodies/0/length_m", "0.2")?;
//! let scenario = document.scenario()?;
//! assert_eq!(scenario.bodies[0].length_m, 0.2);
//! assert_eq!(scenario.output_rate_hz, asperity_scenario::DEFAULT_OUTPUT_RATE_HZ);
//!
//! document.set("/duration_s", "-1")?;
//! let invalid = document.scenario().unwrap_err();
//! assert_eq!(invalid.diagnostics[0].pointer, "/duration_s");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | step | items |
//! |---|---|
//! | data | [`Scenario`], [`BodySpec`], [`InterfaceSpec`], [`LawSpec`], [`SupportSpec`], [`DampingSpec`], [`RayleighSpec`], [`ContactDampingSpec`], [`ExcitationSpec`], [`MethodSpec`] |
//! | text | [`Document`], [`JsonPointer`], [`set_value`], [`open_input`], [`SyntaxError`] |
//! | checks | [`scenario_schema`], [`check_schema`], [`validate`], [`validate_json`] |
//! | faults | [`InvalidDocument`], [`Diagnostic`], [`Fault`] |
//! | structures of matrices | [`StructureScenario`], [`structure_schema`] |
//! | measured loads | [`LoadSamples`] |

mod body;
mod diagnostic;
mod document;
mod fault;
mod input_file;
mod load_samples;
mod locate;
mod method;
mod pointer;
mod scenario;
mod schema_check;
mod set_value;
mod sha256;
mod structure_scenario;
mod suggest;
mod validate;
mod wording;

pub use asperity_law::{ContactDampingSpec, FrictionSpec, LawRef, LawSpec, Laws, Slip};
pub use asperity_structure::{
    AccelerationSpec, Along, Damping, DampingSpec, DisplacementSpec, End, ExcitationSpec,
    ModalDampingSpec, PlaceSpec, RatioAtFrequency, RayleighSpec, SamplesFile, SensorKind,
    SensorSpec, VelocitySpec,
};
pub use body::{BodySpec, SectionSpec};
pub use diagnostic::{Diagnostic, InvalidDocument, MAX_FAULTS};
pub use document::{Document, DocumentError, MAX_DOCUMENT_BYTES, with_absolute_files};
pub use fault::{Bound, Fault};
pub use input_file::{InputError, open_input, read_text};
pub use load_samples::{LoadSamples, MAX_SAMPLE_BYTES, SamplesError};
pub use locate::{ExpectedToken, MAX_NESTING, SyntaxError, SyntaxFault};
pub use method::{
    ContactScheme, DEFAULT_CELL_M, DEFAULT_COURANT, FiniteDifferenceSpec, MethodSpec, ModalSpec,
};
pub use pointer::{JsonPointer, PointerError};
pub use scenario::{
    DEFAULT_GRAVITY_M_PER_S2, DEFAULT_OUTPUT_RATE_HZ, InterfaceSpec, MAX_OUTPUT_RATE_HZ, Scenario,
    SchemaId, SupportSpec, scenario_schema, schema_of,
};
pub use schema_check::check_schema;
pub use set_value::{SetError, set_value};
pub use sha256::{file_sha256, text_sha256};
pub use structure_scenario::{
    AnyScenario, BarSpec, ClosureArray, DEFAULT_REDUCED_MODES, HeldSpec, LoadArray,
    MatricesFormatSpec, MatricesSpec, PatchSpec, ReductionSpec, SideSpec, SplitFaces, SplitSpec,
    SpringSpec, StaticLoadSpec, StructureBodySpec, StructureScenario, UnitsSpec, structure_schema,
};
pub use validate::{
    MAX_CELLS, MAX_HISTORY_NUMBERS, MAX_STEPS, MIN_SAMPLES, has_matrices, validate, validate_json,
};
pub use wording::{digits_apart, four_digits, with_digits};
