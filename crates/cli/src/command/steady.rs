//! `asperity steady`.

use asperity_plot::{self as plot, steady_words};
use asperity_simulation::assemble::Assembly;
use asperity_simulation::provenance::Provenance;
use asperity_simulation::static_state::StaticSummary;
use asperity_simulation::steady::{
    LevelSummary, SteadyRequest, SteadySummary, TimeSweepRequest, backbone_table, steady_table,
    steady_time_table, steady_with_progress,
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
    let scenario = super::checked(&document)?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    super::show_unusual_values(&assembly, quiet);
    let request = SteadyRequest {
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
    };
    let folder = ResultFolder::claim("steady", document.path(), output)?;
    let bar = crate::progress::bar(request.amplitudes.len() as u64, "amplitudes", quiet);
    let work = || steady_with_progress(&assembly, &request, &|| bar.inc(1));
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
        let own = ("steady", "summary.json");
        folder.beside_finished("partial", is_finished, own, document.path(), output)?
    };

    let names: Vec<&str> =
        assembly.structure.contacts().iter().map(PreloadedContact::name).collect();
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
    let at_rest = StaticSummary::of(&assembly);
    let provenance = Provenance::of_scenario(&document, &scenario)?;
    let summary = SteadySummary::new(scenario.title, at_rest, &found, provenance);
    folder.write("report.html", plot::steady_report(&summary, figure.as_ref()))?;
    let folder = folder.finish("summary.json", &json!(summary), output.json)?;
    if !output.json && !quiet {
        print_branches(&summary)?;
        answer_line!("written to {}", folder.display());
    }
    failure.map_or(Ok(()), Err)
}

/// Prints the peak of each force amplitude, or the reason why there is none, and the special points.
fn print_branches(summary: &SteadySummary) -> Result<(), Failure> {
    for level in &summary.levels {
        let LevelSummary::Solved(branch) = level else { continue };
        let (value, unit) = (branch.load.value(), branch.load.unit());
        answer_line!("{value:>10} {unit}   {}", steady_words::peak(branch));
        if let Some(advice) = steady_words::advice(branch) {
            answer_line!("{:14} {advice}", "");
        }
        answer_line!("{:14} {}", "", steady_words::remarks(branch).join("; "));
        if let Some(check) = branch.verify {
            answer_line!("{:14} {}", "", steady_words::check(&check));
        }
    }
    for sweep in &summary.time_sweeps {
        let (value, unit) = (sweep.load.value(), sweep.load.unit());
        answer_line!("{value:>10} {unit}   {}", steady_words::time_sweep(sweep));
    }
    Ok(())
}
