//! `report.html` and `report.md`: figures, claims, verdicts, provenance.

use anyhow::Result;
use asperity_figure::report::{ClaimOutcome, Report, TableCell, four_digits};
use asperity_simulation::output::OutputFolder;

use super::claims::{CheckedClaim, Expected, Verdict};
use super::paper_figure::Finished;
use super::rig::Rig;

/// Writes both forms of the report, and puts the results in place.
pub(crate) fn write(
    output: OutputFolder,
    finished: &[Finished],
    checked: &[CheckedClaim<'_>],
    rig: &Rig,
    seconds: f64,
) -> Result<()> {
    let report = Report::new("Nouira et al. 2020, reproduced").intro(
        "Every figure of \u{201c}Numerical and Experimental Analysis of Nonlinear Vibrational \
         Response due to Pressure-Dependent Interface Stiffness\u{201d} (Lubricants 2020, 8(7), \
         73, doi 10.3390/lubricants8070073) recomputed from Tables 1 to 3, and every statement of \
         its text held against the numbers. The measured hammer pulse and the experimental curves \
         are not published; what stands in for them, and what is missing, is said in each caption.",
    );
    let mut report = report.section("Claims");
    for (verdict, title) in [
        (Verdict::Reproduced, "Reproduced"),
        (Verdict::UnderReading, "Reproduced under a stated reading"),
        (Verdict::NotReproduced, "Not reproduced"),
    ] {
        let rows: Vec<Vec<TableCell>> =
            checked.iter().filter(|claim| claim.verdict == verdict).map(row).collect();
        if !rows.is_empty() {
            let headers = ["Section", "Statement", "Paper", "Here", "Verdict", "Remark"];
            report = report.subsection(title).table(headers, rows);
        }
    }
    let is_extra = |done: &Finished| done.figure.id.starts_with('x');
    for group in finished.chunk_by(|a, b| is_extra(a) == is_extra(b)) {
        let extra = is_extra(&group[0]);
        report = report.section(if extra { "What the paper could not show" } else { "Figures" });
        for Finished { figure, svg, .. } in group {
            report = report.subsection(figure.title).figure(figure.id, figure.caption, svg);
        }
    }
    report = report.section("Provenance").key_values([
        ("asperity", env!("CARGO_PKG_VERSION").to_owned()),
        ("scenario SHA-256", rig.sha256()),
        ("run time", format!("{seconds:.1} s")),
        ("machine", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
    ]);
    output.write("report.md", report.to_markdown(|id| format!("{id}.png")))?;
    output.finish("report.html", report.to_html())?;
    Ok(())
}

fn row(checked: &CheckedClaim<'_>) -> Vec<TableCell> {
    let claim = checked.claim;
    let badge = match checked.verdict {
        Verdict::Reproduced => ClaimOutcome::Pass,
        Verdict::UnderReading => ClaimOutcome::Warn,
        Verdict::NotReproduced => ClaimOutcome::Fail,
    };
    let why_not = claim.why_not.iter().filter(|_| checked.verdict == Verdict::NotReproduced);
    let remarks = why_not.chain(&claim.reading).chain([&claim.reason]);
    let remark = remarks.map(String::as_str).collect::<Vec<_>>().join(" ");
    let here = match claim.expected {
        Expected::Holds if checked.value == 1.0 => "holds".to_owned(),
        Expected::Holds => "does not hold".to_owned(),
        _ => format!("{} {}", four_digits(checked.value), claim.unit),
    };
    vec![
        TableCell::from(claim.section.as_str()),
        TableCell::from(claim.quote.as_str()),
        TableCell::from(format!("{} {}", claim.expected.in_words(), claim.unit)),
        TableCell::from(here),
        TableCell::from(badge),
        TableCell::from(remark),
    ]
}
