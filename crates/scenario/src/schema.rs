//! The JSON Schema of the scenario.

use std::sync::LazyLock;

use schemars::generate::SchemaSettings;
use serde_json::Value;

use crate::Scenario;

/// The JSON Schema (draft 2020-12) of a scenario, generated from the types in
/// [`crate::scenario`].
///
/// It is the single statement of keys, types and bounds:
/// [`crate::schema_check`] walks it to check a scenario, and editors use it to
/// complete one.
pub fn schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
        let generator = SchemaSettings::draft2020_12().into_generator();
        generator.into_root_schema_for::<Scenario>().to_value()
    });
    &SCHEMA
}
