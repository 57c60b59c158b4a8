//! `report.html`: the answer in words, the numbers, the figures.

use asperity_figure::Figure;
use asperity_figure::report::Report;
use asperity_identify::{Identification, Problem};

use super::{findings, pairs};

/// `report.html`.
pub(crate) fn identification_report(
    problem: &Problem,
    found: &Identification,
    figures: &[(&'static str, Figure)],
) -> String {
    let title = problem.spec.title.clone().unwrap_or_else(|| "Identification".to_owned());
    let mut report = found.words().into_iter().fold(Report::new(title), Report::intro);
    let percent = findings::percent(found.level);

    report = report.section("Unknowns").paragraph(format!(
        "Best fit with its standard deviation, and intervals that hold the value with a probability \
         of {percent}. R-hat and the effective sample size (ESS) tell how far the chains agree."
    ));
    report = findings::estimates(report, found);
    for (section, names) in [
        ("Contact law", &["law"][..]),
        ("Data and predictions", &["features", "receptance", "backbone", "residuals"]),
        ("Uncertainty", &["profiles", "pairs"]),
    ] {
        report = draw(report, found, figures, Some(section), names);
    }
    report = findings::undetermined(report, found);
    if found.choice.is_some() {
        report = report.section("Laws compared");
        report = findings::comparison(report, found);
        report = draw(report, found, figures, None, &["comparison"]);
    }
    if found.design.is_some() {
        report = report.section("What to measure next");
        report = draw(report, found, figures, None, &["design"]);
        report = findings::design(report, found);
    }
    report = findings::diagnostics(report, found);
    if !found.notices.is_empty() {
        report = report.section("Notices");
        report = found.notices.iter().cloned().fold(report, Report::paragraph);
    }
    findings::provenance(report, problem, found).to_html()
}

/// The figures of these names under a heading; nothing where none of them was drawn.
fn draw(
    mut report: Report,
    found: &Identification,
    figures: &[(&'static str, Figure)],
    section: Option<&str>,
    names: &[&str],
) -> Report {
    let of = |name: &&str| figures.iter().find(|figure| figure.0 == *name);
    let drawn: Vec<_> = names.iter().filter_map(of).collect();
    if let (Some(section), false) = (section, drawn.is_empty()) {
        report = report.section(section);
    }
    for (name, figure) in drawn {
        report = report.figure(*name, caption(name, found), figure.to_svg());
    }
    report
}

/// What is seen in a figure.
fn caption(name: &str, found: &Identification) -> String {
    let percent = findings::percent(found.level);
    match name {
        "law" => format!(
            "(a) Contact stiffness of law \u{201c}{}\u{201d} over pressure: best fit and {percent} \
             band. (b) What is left of the uncertainty of ln K, over that beforehand. Shaded \
             pressures are not informed by the data: they were not reached, or more than a third of \
             the uncertainty is left. Where (b) has no line, no unknown acts on \
             the law. Dashed verticals: lowest and highest pressure reached, and the pressure at rest.",
            found.law.name
        ),
        "features" => format!(
            "Features of the hits over the peak force. Marks: measured, with two standard \
             deviations to either side; lines: best fit; bands: where the prediction lies with a \
             probability of {percent}, without the noise of a measurement."
        ),
        "receptance" => format!(
            "Parts of the receptance. Marks: measured, with two standard deviations to either \
             side; lines: best fit with its {percent} band."
        ),
        "backbone" => format!(
            "Frequency along the decay. Marks: measured, with two standard deviations to either \
             side; lines: best fit with its {percent} band."
        ),
        "residuals" => "Residuals, predicted less measured, in standard deviations as given, with lines at ±2. Last panel: \
             in their order against a normal distribution; on the dashed line they are as large as \
             the standard deviations say. Data without a prediction are left out."
            .to_owned(),
        "profiles" => format!(
            "Deviance over each unknown, all others fitted anew at every point. Where it is below \
             the dashed horizontal the value is within the {percent} interval, whose ends are the \
             dashed verticals; a side without one is open."
        ),
        "pairs" => {
            let count = found.names.len();
            let part = if count > pairs::MOST_UNKNOWNS {
                format!(" Of {count} unknowns the first {} are drawn.", pairs::MOST_UNKNOWNS)
            } else {
                String::new()
            };
            format!(
                "Draws from the posterior: each unknown on the diagonal, pairs below it. The area \
                 of a mark follows the weight of the draw.{part}"
            )
        }
        "comparison" => {
            "(a) Logarithm of the probability of hits that were left out, less that of \
             the best law, with one standard error: further left is worse. (b) AICc less that of \
             the best law: further right is worse. Green: best; orange: not told from it; red: \
             rejected."
                .to_owned()
        }
        "design" => {
            let hits = found.design.as_ref().map_or(0, |design| design.hits);
            format!(
                "What {hits} more hits of each kind would do. (a) Standard deviation of ln K left, \
                 of that now, averaged over the pressures reached: lower is better. (b) Information \
                 gained about all unknowns."
            )
        }
        _ => String::new(),
    }
}
