//! `report.html` of steady responses: peaks, figure, bifurcations, backbones, provenance.

use asperity_figure::Figure;
use asperity_figure::report::{Report, TableCell};
use asperity_simulation::steady::{
    BackboneSummary, BranchSummary, LevelSummary, LoadAmplitude, SteadySummary, TerminationSummary,
    TimeSweepSummary,
};

use crate::steady_words;

/// `report.html`.
pub fn steady_report(summary: &SteadySummary, figure: Option<&Figure>) -> String {
    let title = summary.title.clone().unwrap_or_else(|| "Steady responses".to_owned());
    let mut page = Report::new(title);
    if let Some(rest) = summary.at_rest.natural_frequency_hz {
        page = page.intro(format!("Natural frequency at rest {rest:.2} Hz."));
    }
    page = peaks(page.section("Peaks"), summary);
    if let Some(figure) = figure {
        page = page.section("Responses").interactive_figure(
            "steady",
            "Fundamental of the top, displacement ratio and lowest pressure of all contacts over \
             frequency. Solid: stable; dashed: unstable; dotted: the harmonics kept do not suffice. Marks: bifurcations, first loss of contact, \
             and ends of branches before the end of the range.",
            figure,
        );
    }
    page = bifurcations(page, summary);
    if let Some(backbones) = &summary.backbone {
        let rows =
            [("phase resonance", &backbones.phase_resonance), ("damped mode", &backbones.mode)];
        let rows = rows.map(|(name, found)| backbone(name, found));
        let headers = ["Backbone", "Points", "Last f (Hz)", "Last u_{1} (m)", "End"];
        page = page.section("Backbones").table(headers, rows);
    }
    if !summary.time_sweeps.is_empty() {
        let words = |sweep: &TimeSweepSummary| {
            format!(
                "{} {}: {}",
                sweep.load.value(),
                sweep.load.unit(),
                steady_words::time_sweep(sweep)
            )
        };
        let sweeps = summary.time_sweeps.iter().map(words);
        page = sweeps.fold(page.section("Time integration"), Report::paragraph);
    }
    let warned: Vec<String> = solved(summary)
        .flat_map(|branch| {
            let (force, unit) = (branch.load.value(), branch.load.unit());
            branch.warnings.iter().map(move |warning| format!("{force} {unit}: {warning}"))
        })
        .collect();
    if !warned.is_empty() {
        page = warned.into_iter().fold(page.section("Warnings"), Report::paragraph);
    }
    let provenance = &summary.provenance;
    let pairs = [
        ("asperity", provenance.version.to_owned()),
        ("scenario SHA-256", provenance.scenario_sha256.clone()),
        ("run time", format!("{:.2} s", summary.wall_s)),
    ];
    page.section("Provenance").key_values(pairs).to_html()
}

fn solved(summary: &SteadySummary) -> impl Iterator<Item = &BranchSummary> {
    summary.parts().filter_map(|level| match level {
        LevelSummary::Solved(branch) => Some(&**branch),
        LevelSummary::Failed { .. } => None,
    })
}

/// Heading of the column of amplitudes of the load.
fn load_header(summary: &SteadySummary) -> &'static str {
    let first = summary.levels.first().map(|level| match level {
        LevelSummary::Solved(branch) => branch.load,
        LevelSummary::Failed { load, .. } => *load,
    });
    match first {
        Some(LoadAmplitude::Base { .. }) => "Base acceleration (m/s²)",
        _ => "Force (N)",
    }
}

/// A row for each part of the branch of each force amplitude.
fn peaks(page: Report, summary: &SteadySummary) -> Report {
    let rows = summary.parts().enumerate().map(|(index, level)| match level {
        LevelSummary::Failed { load, error } => {
            let mut row = vec![TableCell::from(load.value())];
            row.extend((0..5).map(|_| TableCell::from("")));
            row.push(error.clone().into());
            row
        }
        LevelSummary::Solved(branch) => {
            let number = |value: Option<f64>| TableCell::from(value.unwrap_or(f64::NAN));
            let is_other = index >= summary.levels.len();
            let other = if is_other { steady_words::other_part(branch) } else { String::new() };
            let mut remarks = vec![other + &steady_words::end(branch)];
            if !branch.peak_is_inside {
                remarks.push("no peak; the numbers are the largest computed".to_owned());
            }
            remarks.extend(steady_words::advice(branch).map(str::to_owned));
            remarks.extend(steady_words::remarks(branch));
            if let Some(check) = &branch.verify {
                remarks.push(steady_words::check(check));
            }
            vec![
                TableCell::from(branch.load.value()),
                number(branch.peak_frequency_hz),
                number(branch.peak_amplitude_1_m),
                number(branch.displacement_ratio),
                TableCell::Number(branch.harmonics.to_string()),
                TableCell::Number(branch.points.to_string()),
                remarks.join("; ").into(),
            ]
        }
    });
    let headers = [
        load_header(summary),
        "Peak (Hz)",
        "u_{1} (m)",
        "u_{2}/u_{1}",
        "Harmonics",
        "Points",
        "Remarks",
    ];
    page.table(headers, rows)
}

/// A row for each bifurcation; none without any.
fn bifurcations(page: Report, summary: &SteadySummary) -> Report {
    let rows: Vec<Vec<TableCell>> = solved(summary)
        .flat_map(|branch| {
            branch.bifurcations.iter().map(|found| {
                vec![
                    TableCell::from(branch.load.value()),
                    found.kind.replace('_', " ").into(),
                    TableCell::from(found.frequency_hz),
                    TableCell::from(found.amplitude_1_m),
                ]
            })
        })
        .collect();
    if rows.is_empty() {
        return page;
    }
    let headers = [load_header(summary), "Kind", "Frequency (Hz)", "u_{1} (m)"];
    page.section("Bifurcations").table(headers, rows)
}

fn backbone(name: &str, found: &BackboneSummary) -> Vec<TableCell> {
    match found {
        BackboneSummary::Failed { error } => {
            vec![name.into(), "".into(), "".into(), "".into(), error.clone().into()]
        }
        BackboneSummary::Solved { points, end: of, last_frequency_hz, last_amplitude_1_m } => vec![
            name.into(),
            TableCell::Number(points.to_string()),
            TableCell::from(last_frequency_hz.unwrap_or(f64::NAN)),
            TableCell::from(last_amplitude_1_m.unwrap_or(f64::NAN)),
            end(of).into(),
        ],
    }
}

/// The end of a branch in words.
fn end(end: &TerminationSummary) -> String {
    match end {
        TerminationSummary::Reached => "complete".to_owned(),
        TerminationSummary::Returned => "returns to its start".to_owned(),
        TerminationSummary::NotConverged => "ends without convergence".to_owned(),
        TerminationSummary::PointLimit => "ends at the largest number of points".to_owned(),
        TerminationSummary::BeyondLaw { interface, closure_m } => {
            format!("ends beyond the law of {interface}, at a closure of {closure_m:.3e} m")
        }
        _ => "ends".to_owned(),
    }
}
