//! `asperity steady`.

use asperity_structure::PreloadedContact;
use asperity_study::assemble::Assembly;
use asperity_study::provenance::Provenance;
use asperity_study::static_state::StaticSummary;
use asperity_study::steady::{
    Steady, SteadyRequest, SteadySummary, backbone_csv, steady_csv, steady_with_progress,
};
use serde_json::json;

use super::ResultFolder;
use crate::args::{Input, Output, SteadyRange};
use crate::failure::Failure;
use crate::plot;

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
    let request = SteadyRequest {
        amplitudes: range.amplitude.clone(),
        from_hz: range.from,
        to_hz: range.to,
        harmonics: range.harmonics,
        backbone: range.backbone,
        verify: range.verify,
    };
    let folder = ResultFolder::claim("steady", document.path(), output)?;
    let bar = crate::progress::bar(request.amplitudes.len() as u64, "amplitudes", quiet);
    let work = || steady_with_progress(&assembly, &request, &|| bar.inc(1));
    let found = super::on_threads(threads, work);
    bar.finish_and_clear();
    let found = found??;

    let names: Vec<&str> =
        assembly.structure.contacts().iter().map(PreloadedContact::name).collect();
    folder.write("steady.csv", steady_csv(&found, &names))?;
    if let Some(backbones) = &found.backbones {
        folder.write("backbone.csv", backbone_csv(backbones))?;
    }
    if let Some(figure) = plot::steady(&found) {
        folder.draw("steady.svg", &figure)?;
    }
    let at_rest = StaticSummary::of(&assembly);
    let provenance = Provenance::of_scenario(&document, &scenario)?;
    let summary = SteadySummary::new(scenario.title, at_rest, &found, provenance);
    let folder = folder.finish("summary.json", &json!(summary), output.json)?;
    if !output.json && !quiet {
        print_peaks(&found)?;
        answer_line!("written to {}", folder.display());
    }
    let failed: Vec<_> = found
        .levels
        .iter()
        .filter_map(|level| Some((level.force_n, level.outcome.as_ref().err()?)))
        .collect();
    match failed.first() {
        None => Ok(()),
        Some((force_n, error)) => Err(Failure::Parts {
            failed: failed.len(),
            of: format!("{} force amplitudes", found.levels.len()),
            first: format!("{force_n} N"),
            reason: error.to_string(),
        }),
    }
}

/// Prints a line for the peak of each force amplitude.
fn print_peaks(found: &Steady) -> Result<(), Failure> {
    for level in &found.levels {
        let Some(peak) = level.outcome.as_ref().ok().and_then(|branch| branch.highest()) else {
            continue;
        };
        let (hz, a1, ratio) = (peak.frequency_hz(), peak.amplitude(1), peak.harmonic_ratio());
        let force_n = level.force_n;
        answer!("{force_n:>10} N   peak {hz:.3} Hz   A1 {a1:.5e} m   A2/A1 {ratio:.5}");
        if let Some(check) = level.check {
            let unsettled = if check.settled { "" } else { ", which has not settled" };
            let difference = check.relative_difference;
            answer!("   differs from time integration{unsettled} by {difference:.1e}");
        }
        answer_line!("{}", if peak.contact_lost() { "   contact lost" } else { "" });
    }
    Ok(())
}
