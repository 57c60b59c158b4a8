//! `asperity sweep`.

use std::collections::BTreeMap;
use std::time::Instant;

use asperity_plot as plot;
use asperity_simulation::provenance::Provenance;
use asperity_simulation::sweep::{Variation, input_files, number_of_runs, sweep_with_progress};
use serde_json::{Value, json};

use super::ResultFolder;
use crate::args::{Input, Output};
use crate::failure::Failure;

/// Simulates the product of the variations; writes table, figure and provenance.
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
    let folder = ResultFolder::claim("sweep", document.path(), output)?;
    let bar = crate::progress::bar(runs as u64, "runs", quiet);
    let started = Instant::now();
    let work =
        || sweep_with_progress(&document, &variations, &|done, _| bar.set_position(done as u64));
    let results = super::on_threads(threads, work);
    bar.finish_and_clear();
    let results = results??;
    let wall_s = started.elapsed().as_secs_f64();

    let failed = results.failed().count();
    let failure = results.failed().next().map(|(index, error)| {
        let (of, first) = (format!("{runs} runs"), format!("run {}", index + 1));
        Failure::Parts { failed, of, first, reason: error.to_string() }
    });
    // A sweep without a result keeps the earlier one.
    if let (Some(failure), true) = (failure.as_ref(), failed == runs)
        && folder.earlier("sweep.json").is_some()
    {
        return Err(Failure::Kept {
            folder: folder.0.path().to_owned(),
            reason: failure.to_string(),
        });
    }
    let folder = if failed > 0 {
        let is_finished = |earlier: &Value| earlier["failed"] == 0;
        let own = ("sweep", "sweep.json");
        folder.beside_finished("partial", is_finished, own, document.path(), output)?
    } else {
        folder
    };
    folder.write("sweep.csv", results.csv())?;
    if let Some(figure) = plot::sweep(&results) {
        folder.draw("sweep", &figure)?;
    }
    let report = json!({
        "schema": "asperity/sweep/1",
        "vary": variations.iter().map(|v| json!({"pointer": v.pointer, "values": v.values}))
            .collect::<Vec<_>>(),
        "runs": runs,
        "failed": failed,
        "warnings": results.warning_counts().into_iter().collect::<BTreeMap<_, _>>(),
        "wall_s": wall_s,
        "provenance": Provenance::new(&document, input_files(&document, &variations)?),
    });
    let folder = folder.finish("sweep.json", &report, output.json)?;
    if !output.json && !quiet {
        answer_line!("{runs} runs in {wall_s:.2} s, written to {}", folder.display());
    }
    failure.map_or(Ok(()), Err)
}
