//! `asperity convert`.

use asperity_experiment::{ConvertOptions, convert};
use asperity_measure::ReadOptions;
use serde_json::json;

use crate::args::analyse::{Conversion, RecordFormat};
use crate::failure::Failure;
use crate::file_kind::check_measurements;
use crate::rig;

/// Converts one file to another.
pub(crate) fn run(asked: &Conversion, quiet: bool) -> Result<(), Failure> {
    let Conversion { input, output, source, to, si, overwrite, json } = asked;
    check_measurements(input)?;
    let options = ConvertOptions {
        reading: ReadOptions {
            block: ReadOptions::default().block,
            ..rig::options_of(source)?.reading
        },
        format: to.map(RecordFormat::format),
        in_si: *si,
        replace: *overwrite,
    };
    let done = convert(input, output, &options)?;
    if *json {
        let notices: Vec<String> = done.notices.iter().map(ToString::to_string).collect();
        let answer = json!({
            "from": done.from.to_string(),
            "to": done.to.to_string(),
            "records": done.records,
            "notices": notices,
        });
        answer!("{}", super::pretty(&answer));
    } else if !quiet {
        crate::progress::show_notices(&done.notices);
        let records = if done.records == 1 { "record" } else { "records" };
        let (from, to) = (done.from, done.to);
        answer_line!("{} {records}, {from} to {to}: {}", done.records, output.display());
    }
    Ok(())
}
