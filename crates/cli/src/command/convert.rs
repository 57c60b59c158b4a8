//! `asperity convert`.

use std::path::Path;

use asperity_experiment::convert;
use asperity_measure::ReadOptions;
use serde_json::json;

use crate::args::analyse::{RecordFormat, SourceOptions};
use crate::failure::Failure;

/// Format of the converted file and of the answer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Written {
    /// Format; by default that of the extension.
    pub(crate) to: Option<RecordFormat>,
    /// True for SI units.
    pub(crate) si: bool,
    /// True for an answer in JSON.
    pub(crate) json: bool,
}

/// Converts one file to another.
pub(crate) fn run(
    from: &Path,
    to: &Path,
    source: &SourceOptions,
    written: Written,
    quiet: bool,
) -> Result<(), Failure> {
    let options = source.read_options(&ReadOptions::default());
    let format = written.to.map(RecordFormat::format);
    let done = convert(from, to, format, written.si, &options)?;
    if written.json {
        let notices: Vec<String> = done.notices.iter().map(ToString::to_string).collect();
        answer!(
            "{}",
            super::pretty(&json!({
                "from": done.from.to_string(),
                "to": done.to.to_string(),
                "records": done.records,
                "notices": notices,
            }))
        );
    } else if !quiet {
        crate::progress::show_notices(&done.notices);
        let records = if done.records == 1 { "record" } else { "records" };
        answer_line!("{} {records}, {} to {}: {}", done.records, done.from, done.to, to.display());
    }
    Ok(())
}
