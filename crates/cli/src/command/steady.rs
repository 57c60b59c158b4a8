//! `asperity steady`.

use asperity_plot::{self as plot, steady_words};
use asperity_scenario::Document;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::error::SimulationError;
use asperity_simulation::patches::{assemble_patches, steady_cells};
use asperity_simulation::provenance::Provenance;
use asperity_simulation::static_state::StaticSummary;
use asperity_simulation::steady::{
    Shaken, Steady, SteadyProgress, SteadyRequest, SteadySummary, TimeSweepRequest, backbone_table,
    steady_table, steady_time_table, steady_with_progress,
};
use asperity_structure::PreloadedContact;
use serde_json::{Value, json};

use super::ResultFolder;
use crate::args::{Input, Output, SteadyRange};
use crate::failure::Failure;

/// Follows branches of steady responses; writes table, figure and summary.
pub(crate) fn run(
    input: &Input,
    output: &Output,
    range: &SteadyRange,
    threads: Option<usize>,
    quiet: bool,
) -> Result<(), Failure> {
    let document = super::read(input)?;
    let request = request(range);
    if document.has_matrices() {
        let scenario = super::patches::checked(&document)?;
        let assembly = assemble_patches(&scenario, document.folder())?;
        let (at_rest, title) = (assembly.structure.at_rest(), scenario.title.clone());
        let provenance = || Provenance::of_structure(&document, &scenario);
        let cells = |found: &Steady| Some(steady_cells(&assembly.structure, found).to_csv());
        let own =
            Own { document: &document, title, at_rest, provenance: &provenance, cells: &cells };
        return follow(&assembly, &request, own, output, threads, quiet);
    }
    let scenario = super::checked(&document)?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    super::show_unusual_values(&assembly, quiet);
    let (at_rest, title) = (StaticSummary::of(&assembly), scenario.title.clone());
    let provenance = || Provenance::of_scenario(&document, &scenario);
    let own =
        Own { document: &document, title, at_rest, provenance: &provenance, cells: &|_| None };
    follow(&assembly, &request, own, output, threads, quiet)
}

/// Parts of the results that depend on the kind of scenario.
struct Own<'a> {
    document: &'a Document,
    title: Option<String>,
    at_rest: StaticSummary,
    provenance: &'a dyn Fn() -> Result<Provenance, SimulationError>,
    /// The cells of its patches in the highest responses, if it has some.
    cells: &'a dyn Fn(&Steady) -> Option<String>,
}

fn request(range: &SteadyRange) -> SteadyRequest {
    SteadyRequest {
        amplitudes: range.amplitude.clone(),
        from_hz: range.from,
        to_hz: range.to,
        harmonics: range.harmonics,
        backbone: range.backbone,
        verify: range.verify,
        bodies: range.bodies.into(),
        time_sweep: range.sweep.map(|direction| TimeSweepRequest {
            direction: direction.into(),
            frequencies: range.sweep_points,
        }),
    }
}

/// Follows the branches of an assembled scenario, and writes them.
fn follow<S: Shaken>(
    assembly: &Assembly<S>,
    request: &SteadyRequest,
    own: Own<'_>,
    output: &Output,
    threads: Option<usize>,
    quiet: bool,
) -> Result<(), Failure> {
    let document = own.document;
    let folder = ResultFolder::claim("steady", document.path(), output)?;
    let bar = crate::progress::bar(request.amplitudes.len() as u64, "amplitudes", quiet);
    let progress = |ended| bar.inc(u64::from(ended == SteadyProgress::Level));
    let work = || steady_with_progress(assembly, request, &progress);
    let found = super::on_threads(threads, work);
    bar.finish_and_clear();
    let found = found??;

    let failed: Vec<_> = found
        .levels
        .iter()
        .filter_map(|level| Some((level.force_n, level.outcome.as_ref().err()?)))
        .collect();
    let failure = failed.first().map(|(force_n, error)| Failure::Parts {
        failed: failed.len(),
        of: format!("{} force amplitudes", found.levels.len()),
        first: format!("{force_n} {}", found.unit()),
        reason: error.to_string(),
    });
    // A run without a result keeps the earlier one.
    if let (Some(failure), true) = (failure.as_ref(), failed.len() == found.levels.len())
        && folder.earlier("summary.json").is_some()
    {
        return Err(Failure::Kept {
            folder: folder.0.path().to_owned(),
            reason: failure.to_string(),
        });
    }

    let folder = if failed.is_empty() {
        folder
    } else {
        let is_finished = |earlier: &Value| {
            let levels = earlier["levels"].as_array();
            levels.is_some_and(|levels| levels.iter().all(|level| level.get("error").is_none()))
        };
        let files = ("steady", "summary.json");
        folder.beside_finished("partial", is_finished, files, document.path(), output)?
    };

    let names: Vec<&str> =
        assembly.structure.interfaces().iter().map(PreloadedContact::name).collect();
    folder.write("steady.csv", steady_table(&found, &names).to_csv())?;
    if let Some(backbones) = &found.backbones {
        folder.write("backbone.csv", backbone_table(backbones, found.is_base_motion).to_csv())?;
    }
    if request.time_sweep.is_some() {
        folder.write("steady_time.csv", steady_time_table(&found).to_csv())?;
    }
    let figure = plot::steady(&found);
    if let Some(figure) = &figure {
        folder.draw("steady", figure)?;
    }
    if let Some(cells) = (own.cells)(&found) {
        folder.write("cells.csv", cells)?;
    }
    let provenance = (own.provenance)()?;
    let summary = SteadySummary::new(own.title, own.at_rest, &found, provenance);
    folder.write("report.html", plot::steady_report(&summary, figure.as_ref()))?;
    let folder = folder.finish("summary.json", &json!(summary), output.json)?;
    if !output.json && !quiet {
        answer!("{}", steady_words::branches(&summary));
        answer_line!("written to {}", folder.display());
    }
    failure.map_or(Ok(()), Err)
}
