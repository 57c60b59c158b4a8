//! The tables of the report.

use asperity_figure::report::{Cell, Report, Verdict};
use asperity_identify::{DesignedHit, Identification, Problem};
use asperity_inference::ModelVerdict;
use serde_json::Value;

use super::design::changes;

/// Combinations in which an unknown has less weight than this do not name it.
const LEAST_WEIGHT: f64 = 0.2;

/// A probability in percent.
pub(super) fn percent(probability: f64) -> String {
    let text = format!("{:.3}", 100.0 * probability);
    format!("{} %", text.trim_end_matches('0').trim_end_matches('.'))
}

/// The unknowns, identified.
pub(super) fn estimates(report: Report, found: &Identification) -> Report {
    let interval = |ends: [Option<f64>; 2]| -> Cell {
        if ends == [None, None] {
            return "open".into();
        }
        let end = |end: Option<f64>| end.map_or("open".to_owned(), written);
        format!("{} to {}", end(ends[0]), end(ends[1])).into()
    };
    let rows = found.estimates().into_iter().map(|estimate| {
        vec![
            Cell::from(estimate.name),
            Cell::from(estimate.value),
            Cell::from(estimate.standard_deviation),
            interval(estimate.profile_interval),
            interval(estimate.posterior_interval.map(Some)),
            Cell::Number(format!("{:.3}", estimate.r_hat)),
            Cell::Number(format!("{:.0}", estimate.effective_sample_size)),
            if estimate.at_bound { "on a bound".into() } else { "".into() },
        ]
    });
    let headers = ["Unknown", "Value", "Std. dev.", "Profile", "Posterior", "R-hat", "ESS", ""];
    report.table(headers, rows)
}

/// Combinations of unknowns that the data leave open.
pub(super) fn undetermined(report: Report, found: &Identification) -> Report {
    let report = report.section("What the data do not determine");
    let open = &found.identifiability.undetermined;
    if open.is_empty() {
        return report.paragraph("Every combination of the unknowns is determined by the data.");
    }
    let rows = open.iter().map(|combination| {
        let parts = combination.weights.iter().filter(|(_, weight)| weight.abs() > LEAST_WEIGHT);
        let parts: Vec<String> =
            parts.map(|(name, weight)| format!("{weight:+.2} {name}").replace('-', "−")).collect();
        vec![parts.join("  ").into(), Cell::Number(percent_of(combination.remaining))]
    });
    let text = "Weights are per standard deviation beforehand.";
    report.paragraph(text).table(["Combination", "Uncertainty left"], rows)
}

/// The laws compared.
pub(super) fn comparison(mut report: Report, found: &Identification) -> Report {
    let Some(choice) = &found.choice else { return report };
    let Some(best) = choice.candidates.get(choice.best) else { return report };
    if found.choice_noise_factor > 1.0 {
        report = report.paragraph(format!(
            "No law explains the data as they are: all were compared with standard deviations {:.2} \
             times as large, so that the best one does.",
            found.choice_noise_factor
        ));
    }
    let number = |value: Option<f64>| Cell::from(value.unwrap_or(f64::NAN));
    let rows = choice.candidates.iter().map(|candidate| {
        let goodness = &candidate.goodness;
        vec![
            Cell::from(candidate.name.as_str()),
            Cell::from(match candidate.verdict {
                ModelVerdict::Best => "best",
                ModelVerdict::Rejected { .. } | ModelVerdict::Misfit { .. } => "rejected",
                ModelVerdict::Undecided => "undecided",
            }),
            number(candidate.score_difference),
            number(candidate.difference_error),
            Cell::from(candidate.aicc - best.aicc),
            Cell::from(candidate.bic - best.bic),
            Cell::from(goodness.chi_square),
            Cell::Number(goodness.degrees_of_freedom.to_string()),
            number(goodness.p_value),
        ]
    });
    let headers = [
        "Law",
        "Verdict",
        "Score difference",
        "Its standard error",
        "AICc difference",
        "BIC difference",
        "Chi-square",
        "Degrees of freedom",
        "p",
    ];
    report.table(headers, rows)
}

/// The proposed sequence, and all hits that were weighed.
pub(super) fn design(report: Report, found: &Identification) -> Report {
    let Some(design) = &found.design else { return report };
    let row = |hit: &DesignedHit| {
        vec![
            Cell::from(hit.force_peak_n),
            changes(&hit.set).into(),
            Cell::Number(percent_of(hit.remaining)),
            Cell::from(hit.information),
        ]
    };
    let numbered = design.sequence.iter().enumerate().map(|(index, hit)| {
        let mut cells = vec![Cell::Number((index + 1).to_string())];
        cells.extend(row(hit));
        cells
    });
    let headers = ["Peak force (N)", "Rig", "Uncertainty of ln K left", "Information (nat)"];
    report
        .subsection("Proposed sequence")
        .paragraph(format!("Each is {} hits, measured after those before; its uncertainty left is of what those leave.", design.hits))
        .table(std::iter::once("").chain(headers), numbered)
        .subsection("Each alone")
        .table(headers, design.candidates.iter().map(row))
}

/// Whether fit and posterior can be trusted.
pub(super) fn diagnostics(report: Report, found: &Identification) -> Report {
    let goodness = &found.goodness;
    let chains = &found.posterior.diagnostics;
    let (fit, starts) = (&found.fit, &found.fit.starts);
    let converged = starts.iter().filter(|start| start.ending.converged()).count();
    let badge = |good: bool| Cell::from(if good { Verdict::Pass } else { Verdict::Warn });
    let row = |name: &str, text: String, verdict: Option<bool>| {
        vec![name.into(), text.into(), verdict.map_or("".into(), badge)]
    };
    let p = goodness.p_value.map_or_else(|| "none".to_owned(), written);
    let draws = found.posterior.draws.len();
    let shape = chains.pareto_shape;
    let r_hat = chains.r_hat.iter().copied().fold(0.0, f64::max);
    let derivatives = match found.linearisation.derivative_difference {
        Some(difference) => format!("exact; differences agree to {}", written(difference)),
        None => "by differences".to_owned(),
    };
    let rows = vec![
        row(
            "Chi-square of the fit",
            format!(
                "{} for {} degrees of freedom, p = {p}",
                written(goodness.chi_square),
                goodness.degrees_of_freedom
            ),
            Some(found.explains()),
        ),
        row("Noise factor", written(found.noise_factor), None),
        row(
            "Data without a prediction",
            fit.missing.len().to_string(),
            Some(fit.missing.is_empty()),
        ),
        row(
            "Searches",
            format!(
                "{converged} of {} converged, to {} distinct optima; {} points",
                starts.len(),
                fit.distinct_optima.len(),
                fit.evaluations
            ),
            Some(fit.converged),
        ),
        row("Derivatives", derivatives, None),
        row("Condition of the scaled Jacobian", written(found.identifiability.condition), None),
        row(
            "Effective draws",
            format!("{:.0} of {draws}", chains.effective_draws),
            Some(5.0 * chains.effective_draws >= draws as f64),
        ),
        row("Largest R-hat", format!("{r_hat:.3}"), Some(r_hat < 1.02)),
        row(
            "Pareto shape of the weights",
            shape.map_or_else(|| "none".to_owned(), |shape| format!("{shape:.2}")),
            shape.map(|shape| shape < 0.7),
        ),
        row("Accepted moves", percent_of(chains.acceptance), None),
        row(
            "Response surfaces",
            format!(
                "{}; the last is off by {} standard deviations at most",
                chains.rounds,
                written(chains.surrogate_error)
            ),
            None,
        ),
    ];
    report.section("Diagnostics").table(["Quantity", "Value", ""], rows)
}

/// Versions, hashes, time.
pub(super) fn provenance(report: Report, problem: &Problem, found: &Identification) -> Report {
    let record = found.report(problem);
    let text = |pointer: &str| {
        record.pointer(pointer).and_then(Value::as_str).unwrap_or_default().to_owned()
    };
    report.section("Provenance").key_values([
        ("asperity", text("/provenance/version")),
        ("problem", problem.document.path().display().to_string()),
        ("problem SHA-256", text("/provenance/problem_sha256")),
        ("scenario SHA-256", text("/provenance/scenario_sha256")),
        ("seed", problem.spec.seed.to_string()),
        ("run time", format!("{:.1} s", found.wall_s)),
        ("machine", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
    ])
}

fn percent_of(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}

/// A number of a sentence, as a table writes it.
fn written(value: f64) -> String {
    match Cell::from(value) {
        Cell::Number(text) | Cell::Text(text) => text,
        Cell::Verdict(_) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn percent_has_no_idle_decimals() {
        assert_eq!(percent(0.95), "95 %");
        assert_eq!(percent(0.6827), "68.27 %");
        assert_eq!(percent(0.9), "90 %");
    }
}
