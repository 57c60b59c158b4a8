//! Scenario files: what is computed, as typed data, and every fault of a text at its place.
//!
//! A [`Document`](document::Document) is the text of a scenario with its `--set` changes. Checked
//! against the schema that the types generate ([`mod@schema`], [`schema_check`]) and against the
//! conditions between values ([`validate`](mod@validate)), it becomes a typed [`Scenario`].
//!
//! | step | modules |
//! |---|---|
//! | types | [`scenario`], [`body`], [`damping`], [`excitation`], [`interface`], [`law`], [`method`], [`support`] |
//! | read and change | [`document`], [`input`], [`samples`], [`locate`], [`mod@pointer`] |
//! | check | [`mod@schema`], [`schema_check`], [`validate`](mod@validate), [`diagnostic`], [`suggest`] |

pub mod body;
pub mod damping;
pub mod diagnostic;
pub mod document;
pub mod excitation;
pub mod input;
pub mod interface;
pub mod law;
pub mod locate;
pub mod method;
pub mod pointer;
pub mod samples;
pub mod scenario;
pub mod schema;
pub mod schema_check;
pub mod suggest;
pub mod support;
pub mod validate;

pub use body::{BodySpec, Section};
pub use damping::{DampingAmount, DampingSpec};
pub use excitation::ExcitationSpec;
pub use interface::InterfaceSpec;
pub use law::{LawRef, LawSpec, Laws};
pub use method::{ContactScheme, FiniteDifference, MethodSpec, Modal};
pub use scenario::{
    DEFAULT_GRAVITY_M_PER_S2, DEFAULT_OUTPUT_RATE_HZ, MOST_OUTPUT_RATE_HZ, Scenario, SchemaId,
};
pub use support::SupportSpec;
