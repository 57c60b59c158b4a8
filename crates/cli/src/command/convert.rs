//! `asperity convert`.

use std::path::Path;

use asperity_experiment::convert;
use asperity_measure::ReadOptions;
use serde_json::json;

use crate::args::analyse::{Knowledge, RecordFormat};
use crate::failure::Failure;

/// How the answer is written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Written {
    /// Format; that of the name if not given.
    pub(crate) to: Option<RecordFormat>,
    /// Whether in SI.
    pub(crate) si: bool,
    /// Whether what was done is told as JSON.
    pub(crate) json: bool,
}

/// One file to another.
pub(crate) fn run(
    from: &Path,
    to: &Path,
    knowledge: &Knowledge,
    written: Written,
    quiet: bool,
) -> Result<(), Failure> {
    let options = knowledge.reading(&ReadOptions::default());
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
        for notice in &done.notices {
            eprintln!("note: {notice}");
        }
        let records = if done.records == 1 { "record" } else { "records" };
        answer_line!("{} {records}, {} to {}: {}", done.records, done.from, done.to, to.display());
    }
    Ok(())
}
