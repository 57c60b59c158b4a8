//! `report.html` and `report.md`: figures, claims, verdicts, provenance.

use std::path::Path;

use anyhow::Result;
use asperity_figure::report::{ClaimOutcome, Report, TableCell};

use super::Finished;
use super::claims::{Judged, Verdict};
use super::rig::Rig;

/// Writes both forms of the report into `folder`.
pub(crate) fn write(
    folder: &Path,
    finished: &[Finished],
    judged: &[Judged<'_>],
    rig: &Rig,
    seconds: f64,
) -> Result<()> {
    let mut report = Report::new("Nouira et al. 2020, reproduced").intro(
        "Every figure of \u{201c}Numerical and Experimental Analysis of Nonlinear Vibrational \
         Response due to Pressure-Dependent Interface Stiffness\u{201d} (Lubricants 2020, 8(7), \
         73, doi 10.3390/lubricants8070073) recomputed from Tables 1 to 3, and every statement of \
         its text held against the numbers. The measured hammer pulse and the experimental curves \
         are not published; what stands in for them, and what is missing, is said in each caption.",
    );
    report = report.section("Claims");
    for (verdict, title) in [
        (Verdict::Reproduced, "Reproduced"),
        (Verdict::UnderReading, "Reproduced under a stated reading"),
        (Verdict::NotReproduced, "Not reproduced"),
    ] {
        let rows: Vec<Vec<TableCell>> =
            judged.iter().filter(|claim| claim.verdict == verdict).map(row).collect();
        if !rows.is_empty() {
            let headers = ["Section", "Statement", "Paper", "Here", "Verdict", "Remark"];
            report = report.subsection(title).table(headers, rows);
        }
    }
    for (title, extra) in [("Figures", false), ("What the paper could not show", true)] {
        let chosen: Vec<&Finished> =
            finished.iter().filter(|done| done.figure.id.starts_with('x') == extra).collect();
        if !chosen.is_empty() {
            report = report.section(title);
        }
        for done in chosen {
            let figure = done.figure;
            report =
                report.subsection(figure.title).figure(figure.id, figure.caption, done.svg.clone());
        }
    }
    report = report.section("Provenance").key_values([
        ("asperity", env!("CARGO_PKG_VERSION").to_owned()),
        ("scenario SHA-256", rig.sha256()),
        ("run time", format!("{seconds:.1} s")),
        ("machine", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
    ]);
    write_file(folder, "report.html", &report.to_html())?;
    write_file(folder, "report.md", &report.to_markdown(|id| format!("{id}.png")))
}

fn write_file(folder: &Path, name: &str, text: &str) -> Result<()> {
    super::write(&folder.join(name), text.as_bytes())
}

fn row(judged: &Judged<'_>) -> Vec<TableCell> {
    let claim = judged.claim;
    let badge = match judged.verdict {
        Verdict::Reproduced => ClaimOutcome::Pass,
        Verdict::UnderReading => ClaimOutcome::Warn,
        Verdict::NotReproduced => ClaimOutcome::Fail,
    };
    let mut remark = claim.reason.clone();
    if let Some(reading) = &claim.reading {
        remark = format!("{reading} {remark}");
    }
    if judged.verdict == Verdict::NotReproduced
        && let Some(why) = &claim.why_not
    {
        remark = format!("{why} {remark}");
    }
    let here = match (judged.value, &claim.expected) {
        (value, super::claims::Expected::Holds) => {
            (if value == 1.0 { "holds" } else { "does not hold" }).to_owned()
        }
        (value, _) => format!("{} {}", significant(value), claim.unit),
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

/// Four significant digits.
fn significant(value: f64) -> String {
    if !value.is_finite() {
        return "none".to_owned();
    }
    let exponent = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    if (-3..6).contains(&exponent) {
        format!("{value:.*}", usize::try_from(3 - exponent).unwrap_or(0))
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn four_digits_are_shown() {
        assert_eq!(significant(822.794), "822.8");
        assert_eq!(significant(0.14), "0.1400");
        assert_eq!(significant(1.81e10), "1.810e10");
        assert_eq!(significant(f64::NAN), "none");
    }
}
