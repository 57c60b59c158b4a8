//! `asperity sweep`.

use std::time::Instant;

use asperity_study::summary::Provenance;
use asperity_study::sweep::{Variation, number_of_runs, sweep};
use serde_json::json;

use crate::args::{Input, Output};
use crate::failure::Failure;
use crate::plot;

/// The product of the variations: table, figure, provenance.
pub(crate) fn run(
    input: &Input,
    output: &Output,
    vary: &[String],
    threads: Option<usize>,
    quiet: bool,
) -> Result<(), Failure> {
    let document = super::read(input)?;
    let variations: Vec<Variation> =
        vary.iter().map(|text| Variation::parse(text)).collect::<Result<_, _>>()?;
    let runs = number_of_runs(&variations)?;
    let folder = super::claim(document.path(), output)?;
    let bar = crate::progress::bar(runs as u64, "runs", quiet);
    let started = Instant::now();
    let work = || sweep(&document, &variations, &|done, _| bar.set_position(done as u64));
    let outcome = asperity_study::sweep::on_threads(threads, work);
    bar.finish_and_clear();
    let results = match outcome {
        Some(results) => results?,
        None => return Err(Failure::Threads { threads: threads.unwrap_or_default() }),
    };
    let wall_s = started.elapsed().as_secs_f64();

    folder.write("sweep.csv", results.csv())?;
    if let Some(figure) = plot::sweep(&results) {
        super::draw(&folder, "sweep.svg", &figure)?;
    }
    let failed = results.failed().count();
    let report = json!({
        "schema": "asperity/sweep/1",
        "vary": variations.iter().map(|v| json!({"pointer": v.pointer, "values": v.values}))
            .collect::<Vec<_>>(),
        "runs": runs,
        "failed": failed,
        "wall_s": wall_s,
        "provenance": Provenance::new(document.sha256()),
    });
    folder.write("sweep.json", super::pretty(&report))?;
    if output.json {
        answer!("{}", super::pretty(&report));
    } else if !quiet {
        answer_line!("{runs} runs in {wall_s:.2} s, written to {}", folder.path().display());
    }
    if let Some((index, error)) = results.failed().next() {
        let (first, reason) = (index + 1, error.to_string());
        return Err(Failure::Runs { failed, runs, first, reason });
    }
    Ok(())
}
