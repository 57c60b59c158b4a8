//! `report.html`: the answer in words, the tables, the figures.

use asperity_figure::Figure;
use asperity_figure::report::{ClaimOutcome, Report, TableCell, digits, four_digits};
use asperity_identify::{
    CandidateMeasurement, Identification, IdentificationProblem, ReasonKind, StartAgreement,
    StiffnessOrigin,
};
use asperity_inference::ModelAssessment;
use asperity_scenario::digits_apart;
use serde_json::Value;

use super::design::measurement;
use super::percent;
use super::uncertainty::MOST_PARAMETERS;

/// Least weight with which a parameter is named in a combination.
const LEAST_WEIGHT: f64 = 0.2;

/// `report.html`.
pub fn identification_report(
    problem: &IdentificationProblem,
    found: &Identification,
    figures: &[(&'static str, Figure)],
) -> String {
    let title = problem.spec.title.clone().unwrap_or_else(|| "Identification".to_owned());
    let mut report = found.conclusions().into_iter().fold(Report::new(title), Report::intro);
    let percent = percent(found.level);

    let void = if found.judgement().is_void() {
        "The result is not to be used, and the values and intervals below are void. "
    } else {
        ""
    };
    report = report.section("Parameters").paragraph(format!(
        "{void}Best fit with its standard deviation, and intervals that hold the value with a probability \
         of {percent}. R-hat and the effective sample size (ESS) measure how far the chains agree."
    ));
    report = estimates(report, found);
    for (section, names) in [
        ("Contact law", &["law"][..]),
        ("Data and predictions", &["features", "receptance", "backbone", "steady", "residuals"]),
        ("Uncertainty", &["profiles", "pairs"]),
    ] {
        report = draw(report, found, figures, Some(section), names);
    }
    report = undetermined(report, found);
    report = given(report, found);
    report = explanations(report, found);
    if found.comparison.is_some() {
        report = report.section("Laws compared");
        report = comparison(report, found);
        report = draw(report, found, figures, None, &["comparison"]);
    }
    if found.design.is_some() {
        report = report.section("What to measure next");
        report = draw(report, found, figures, None, &["design"]);
        report = design(report, found);
    }
    report = diagnostics(report, found);
    if !found.notices.is_empty() {
        report = report.section("Notices");
        report = found.notices.iter().cloned().fold(report, Report::paragraph);
    }
    provenance(report, problem, found).to_html()
}

/// Adds the figures of these names, under a heading if there are any.
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
        report = report.interactive_figure(*name, caption(name, found), figure);
    }
    report
}

/// The caption of a figure.
fn caption(name: &str, found: &Identification) -> String {
    let percent = percent(found.level);
    match name {
        "law" => format!(
            "Contact stiffness of law \u{201c}{}\u{201d} over pressure: best fit and {percent} \
             band; where the band is thin, the same in per cent of the median. Last: uncertainty of ln K \
             left, over that before the data, and for a free law the width of its averaging kernel. Shaded \
             pressures are not informed by the data: they were not reached, or more than a third of \
             the uncertainty is left, or the law is given there (grey): no parameter acts on it, and there is \
             no line of its uncertainty. Dashed verticals: lowest and highest pressure reached, and the pressure \
             at rest.",
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
            "Frequency, and damping where it is used, along the decay. Marks: measured, with two standard deviations to either \
             side; lines: best fit with its {percent} band."
        ),
        "steady" => format!(
            "Steady responses to a shaker over frequency, by level of force. Marks: measured, with two \
             standard deviations to either side; lines: best fit with its {percent} band."
        ),
        "residuals" => "Residuals, predicted less measured, in standard deviations as given, with lines at ±2. Last panel: \
             in their order against a normal distribution; on the dashed line they are as large as \
             the standard deviations say. Data without a prediction are left out."
            .to_owned(),
        "profiles" => format!(
            "Deviance over each parameter, all others fitted again at every point. Where it is below \
             the dashed horizontal the value is within the {percent} interval, whose ends are the \
             dashed verticals; a side without one is open."
        ),
        "pairs" => {
            let count = found.names.len();
            let part = if count > MOST_PARAMETERS {
                format!(" Of {count} parameters the first {MOST_PARAMETERS} are drawn.")
            } else {
                String::new()
            };
            format!(
                "Draws from the posterior: each parameter on the diagonal, pairs below it. The area \
                 of a mark follows the weight of the draw.{part}"
            )
        }
        "comparison" => {
            "(a) Logarithm of the probability of hits that were left out, less that of \
             the best law, with one standard error: further left is worse. (b) AICc less that of \
             the best law: further right is worse. Circle: best; diamond: not distinguished from it; \
             cross: rejected."
                .to_owned()
        }
        "design" => {
            let hits = found.design.as_ref().map_or(0, |design| design.hits);
            format!(
                "Effect of {hits} more hits of each kind, and of a quasi-static stiffness. Left: \
                 standard deviation of ln K left, over that now, averaged over the pressures of the \
                 design: lower is better. Right: information about all parameters."
            )
        }
        _ => String::new(),
    }
}

/// Estimates of the parameters.
fn estimates(report: Report, found: &Identification) -> Report {
    let interval = |ends: [Option<f64>; 2], count: usize| -> TableCell {
        if ends == [None, None] {
            return "open".into();
        }
        let end = |end: Option<f64>| end.map_or("open".to_owned(), |end| digits(end, count));
        format!("{} to {}", end(ends[0]), end(ends[1])).into()
    };
    let stiffnesses = found.stiffnesses.iter().map(|one| {
        let origin = match one.origin {
            StiffnessOrigin::Data => "data",
            StiffnessOrigin::Smoothness => "smoothness",
            StiffnessOrigin::Given => "given",
            StiffnessOrigin::Open => "left open by the data",
        };
        let [low, high] = one.interval_pa_per_m;
        let count = digits_apart(&[low, one.stiffness_pa_per_m, high], 4);
        vec![
            TableCell::from(one.law.as_str()),
            TableCell::from(1e-6 * one.pressure_pa),
            TableCell::Number(digits(one.stiffness_pa_per_m, count)),
            interval([Some(low), Some(high)], count),
            origin.into(),
        ]
    });
    let report = if found.stiffnesses.is_empty() {
        report
    } else {
        let headers = ["Law", "Pressure (MPa)", "Stiffness (Pa/m)", "Posterior", "From"];
        report.table(headers, stiffnesses)
    };
    let rows = found.estimates().into_iter().map(|estimate| {
        let [low, high] = estimate.posterior_interval;
        let count = digits_apart(&[low, estimate.value, high], 4);
        vec![
            TableCell::from(estimate.label),
            TableCell::Number(digits(estimate.value, count)),
            TableCell::deviation(estimate.standard_deviation),
            interval(estimate.profile_interval, count),
            interval(estimate.posterior_interval.map(Some), count),
            TableCell::Number(format!("{:.3}", estimate.r_hat)),
            TableCell::Number(format!("{:.0}", estimate.effective_sample_size)),
            if estimate.at_bound { "on a bound".into() } else { "".into() },
        ]
    });
    let headers = ["Parameter", "Value", "Std. dev.", "Profile", "Posterior", "R-hat", "ESS", ""];
    report.table(headers, rows)
}

/// Combinations of parameters that the data leave open.
fn undetermined(report: Report, found: &Identification) -> Report {
    let report = report.section("What the data do not determine");
    let open = &found.identifiability.undetermined;
    if open.is_empty() {
        return report.paragraph("Every combination of the parameters is determined by the data.");
    }
    let rows = open.iter().map(|combination| {
        let parts = combination.weights.iter().filter(|(_, weight)| weight.abs() > LEAST_WEIGHT);
        let parts: Vec<String> =
            parts.map(|(name, weight)| format!("{weight:+.2} {name}").replace('-', "−")).collect();
        vec![parts.join("  ").into(), TableCell::Number(percent_of(combination.remaining))]
    });
    let text = "Weights are per standard deviation before the data.";
    report.paragraph(text).table(["Combination", "Uncertainty left"], rows)
}

/// Changes of the model that would explain the data better.
fn explanations(report: Report, found: &Identification) -> Report {
    if found.explanations.is_empty() {
        return report;
    }
    let number = |value: Option<f64>| {
        TableCell::Number(value.map_or_else(String::new, |value| format!("{value:.1}")))
    };
    let rows = found.explanations.iter().map(|one| {
        vec![one.cause.as_str().into(), number(one.expected_chi_square), number(one.chi_square)]
    });
    let text = format!(
        "Chi-square of the fit is {:.1} for {} degrees of freedom. Expected: with the change, by the \
         linearised model. Fitted: a short fit with it, of those that promise most. A suggestion is no \
         finding: several changes may do the same.",
        found.goodness.chi_square, found.goodness.degrees_of_freedom
    );
    let headers = ["Change of the model", "Expected chi-square", "Fitted"];
    report.section("What would explain the data better").paragraph(text).table(headers, rows)
}

/// Numbers that the law depends on and that no parameter changes.
fn given(report: Report, found: &Identification) -> Report {
    let Some(first) = found.given.first() else { return report };
    let rows = found.given.iter().map(|one| {
        vec![
            TableCell::from(one.label.as_str()),
            TableCell::from(one.value),
            TableCell::Number(format!("{:+.3}", one.sensitivity)),
            TableCell::Number(format!("{} %", four_digits(100.0 * one.relative))),
            if one.is_stated { "stated" } else { "by its digits" }.into(),
        ]
    });
    let text = format!(
        "Numbers of the scenario that no parameter changes. Sensitivity: the change of K({} MPa) in \
         per cent for one per cent of the number, the parameters fitted again. Tolerance: standard \
         deviation over the value, which the band of the law contains.",
        four_digits(1e-6 * first.pressure_pa)
    );
    let headers = ["Number", "Value", "Sensitivity", "Tolerance", ""];
    report.section("What was taken as given").paragraph(text).table(headers, rows)
}

/// Comparison of the laws.
fn comparison(mut report: Report, found: &Identification) -> Report {
    let Some(choice) = &found.comparison else { return report };
    let Some(best) = choice.candidates.get(choice.best) else { return report };
    if found.comparison_noise_factor > 1.0 {
        report = report.paragraph(format!(
            "No law explains the data within their standard deviations: all were compared with \
             standard deviations {:.2} times as large, for which the best one does.",
            found.comparison_noise_factor
        ));
    }
    let number = |value: Option<f64>| TableCell::from(value.unwrap_or(f64::NAN));
    let rows = choice.candidates.iter().map(|candidate| {
        let goodness = &candidate.goodness;
        vec![
            TableCell::from(candidate.name.as_str()),
            TableCell::from(match candidate.assessment {
                ModelAssessment::Best => "best",
                ModelAssessment::Rejected { .. } | ModelAssessment::Misfit { .. } => "rejected",
                ModelAssessment::Undecided => "undecided",
            }),
            number(candidate.score_difference),
            TableCell::deviation(candidate.difference_error),
            TableCell::from(candidate.aicc - best.aicc),
            TableCell::from(candidate.bic - best.bic),
            TableCell::from(goodness.chi_square),
            TableCell::Number(goodness.degrees_of_freedom.to_string()),
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

/// The proposed sequence, and each candidate hit alone.
fn design(report: Report, found: &Identification) -> Report {
    let Some(design) = &found.design else { return report };
    let row = |one: &CandidateMeasurement| {
        vec![
            measurement(&one.kind).into(),
            TableCell::Number(percent_of(one.remaining)),
            TableCell::from(one.information),
        ]
    };
    let numbered = design.sequence.iter().enumerate().map(|(index, one)| {
        let mut cells = vec![TableCell::Number((index + 1).to_string())];
        cells.extend(row(one));
        cells
    });
    let headers = ["Measurement", "Uncertainty of ln K left", "Information (nat)"];
    report
        .subsection("Proposed sequence")
        .paragraph(format!("Each is {} hits or one stiffness, measured after those above; its uncertainty left is relative to what those leave.", design.hits))
        .table(std::iter::once("").chain(headers), numbered)
        .subsection("Each alone")
        .table(headers, design.candidates.iter().map(row))
}

/// Convergence of fit and posterior.
fn diagnostics(report: Report, found: &Identification) -> Report {
    let goodness = &found.goodness;
    let chains = &found.posterior.diagnostics;
    let (fit, starts) = (&found.fit, &found.fit.starts);
    let converged = starts.iter().filter(|start| start.termination.converged()).count();
    let badge =
        |good: bool| TableCell::from(if good { ClaimOutcome::Pass } else { ClaimOutcome::Warn });
    let row = |name: &str, text: String, good: Option<bool>| {
        vec![name.into(), text.into(), good.map_or("".into(), badge)]
    };
    let p = goodness.p_value.map_or_else(|| "none".to_owned(), four_digits);
    let draws = found.posterior.draws.len();
    let shape = chains.pareto_shape;
    let r_hat = chains.r_hat.iter().copied().fold(0.0, f64::max);
    let derivatives = match found.linearisation.derivative_difference {
        Some(difference) => {
            format!("exact; off differences by {} of the largest", four_digits(difference))
        }
        None => "by differences".to_owned(),
    };
    let reasons = found.judgement().reasons;
    let derivatives_agree = reasons.iter().all(|reason| reason.kind != ReasonKind::Derivatives);
    let rows = vec![
        row(
            "Chi-square of the fit",
            format!(
                "{} for {} degrees of freedom, p = {p}",
                four_digits(goodness.chi_square),
                goodness.degrees_of_freedom
            ),
            Some(found.explains()),
        ),
        row("Noise factor", four_digits(found.noise_factor), None),
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
        row(
            "Starts at the lowest cost",
            format!("{} of {}", found.starts_at_best(), starts.len()),
            match StartAgreement::of(fit) {
                StartAgreement::All => Some(true),
                StartAgreement::NotTested => None,
                _ => Some(false),
            },
        ),
        row(
            "Derivatives",
            derivatives,
            found.linearisation.derivative_difference.map(|_| derivatives_agree),
        ),
        row("Condition of the scaled Jacobian", four_digits(found.identifiability.condition), None),
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
                four_digits(chains.surrogate_error)
            ),
            None,
        ),
    ];
    report.section("Diagnostics").table(["Quantity", "Value", ""], rows)
}

/// Versions, hashes, time.
fn provenance(report: Report, problem: &IdentificationProblem, found: &Identification) -> Report {
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
