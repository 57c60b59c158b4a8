//! Settings of a rig from a file.

use std::io::Write;
use std::path::Path;
use std::sync::LazyLock;

use asperity_experiment::{AnalysisError, AnalysisOptions, ResponseChoice, RigFile, RigSettings};
use asperity_measure::{MeasureError, write_whole};
use asperity_scenario::{Diagnostic, Fault, schema_of};
use serde_json::{Value, json};

use crate::args::analyse::{HammerChannels, MeasuredOptions, SourceOptions};
use crate::command::{pretty, read_document};
use crate::failure::Failure;
use crate::file_kind::FileKind;

/// The JSON Schema of a rig's settings.
pub(crate) fn rig_schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(schema_of::<RigSettings>);
    &SCHEMA
}

/// The options that a source's rig and its own options give; the defaults for the rest.
pub(crate) fn options_of(source: &SourceOptions) -> Result<AnalysisOptions, Failure> {
    let mut options = source.rig.as_deref().map(read).transpose()?.unwrap_or_default();
    options.reading = source.read_options(&options.reading);
    Ok(options)
}

/// The options that files of measurements and their rig give; the first sensor of a channel counts.
pub(crate) fn measured_options(measured: &MeasuredOptions) -> Result<AnalysisOptions, Failure> {
    let mut options = options_of(&measured.source)?;
    options.sensitivities.splice(..0, measured.sensitivity.iter().cloned());
    Ok(options)
}

/// The options of a hammer test's channels and their rig.
pub(crate) fn channel_options(channels: &HammerChannels) -> Result<AnalysisOptions, Failure> {
    let mut options = measured_options(&channels.measured)?;
    options.force = channels.force.clone().or(options.force);
    if !channels.response.is_empty() {
        options.responses = ResponseChoice::of(&channels.response);
    }
    Ok(options)
}

/// The options of an analysis by a rig's file.
fn read(path: &Path) -> Result<AnalysisOptions, Failure> {
    let document = read_document(path, FileKind::Rig)?;
    let invalid = |source| Failure::Invalid {
        kind: "file of settings of a rig",
        text: document.text().to_owned(),
        path: document.path().to_owned(),
        source,
    };
    let settings: RigSettings = document.checked(rig_schema(), Vec::new()).map_err(invalid)?;
    let options = settings.options().map_err(|faults| {
        let diagnostics = faults.into_iter().map(|fault| {
            let pointer = fault.pointer.parse().unwrap_or_default();
            Diagnostic::new(&pointer, Fault::NotAccepted(fault.found), fault.accepted)
        });
        invalid(document.with_spans(diagnostics.collect()))
    })?;
    let rig = RigFile { file: path.display().to_string(), sha256: document.sha256() };
    Ok(AnalysisOptions { rig: Some(rig), ..options })
}

/// Writes settings to a file, over an existing one only if `overwrite`.
pub(crate) fn write(
    path: &Path,
    settings: &RigSettings,
    overwrite: bool,
) -> Result<(), AnalysisError> {
    write_file(path, pretty(&json!(settings)).as_bytes(), overwrite)
}

/// Writes a file, over an existing one only if `overwrite`.
pub(crate) fn write_file(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), AnalysisError> {
    let io = |source| MeasureError::Io { file: path.display().to_string(), source };
    Ok(write_whole(path, overwrite, |out| out.write_all(bytes).map_err(io))?)
}
