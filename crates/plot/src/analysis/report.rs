//! `report.html` of an analysis: features, figures, issues of the hits, settings.

use asperity_experiment::{AnalysisReport, HitReport, HitStatistics, ResponseAnalysis};
use asperity_figure::Figure;
use asperity_figure::report::{Report, TableCell, four_digits};

/// Most hits in the table.
const MOST_HITS: usize = 500;

/// `report.html`.
pub fn analysis_report(analysis: &ResponseAnalysis, figures: &[(&'static str, Figure)]) -> String {
    let found = &analysis.report;
    let mut page = Report::new("Measured hits").intro(conclusion(found));
    page = found.conclusions.iter().cloned().fold(page, Report::intro);
    page = features(page.section("Features"), found);
    page = modes(levels(page, found), found);
    for (name, title, caption) in FIGURES {
        if let Some((_, figure)) = figures.iter().find(|(drawn, _)| *drawn == name) {
            page = page.section(title).interactive_figure(name, caption, figure);
        }
    }
    page = hits(page.section("Hits"), found);
    if !found.notices.is_empty() {
        page = page.section("Notices");
        page = found.notices.iter().cloned().fold(page, Report::paragraph);
    }
    provenance(settings(page.section("Settings"), found), found).to_html()
}

/// Names of the figures, their headings and captions.
const FIGURES: [(&str, &str, &str); 5] = [
    (
        "features",
        "Features against force",
        "Features of the averaged hits over the peak force; bars are two standard deviations to \
         either side, where they are known. Dashed: means of the force levels, of damping by half \
         power.",
    ),
    (
        "frf",
        "Frequency response",
        "Receptances of the hits by peak force; magnitude and phase of the average, and its \
         coherence. Shaded: the band of the fundamental; dashed: mean f_{1} and f_{2} of the hits.",
    ),
    (
        "responses",
        "Responses",
        "Averaged functions of all responses. Shaded: the band; dashed: natural frequencies of the \
         modes.",
    ),
    (
        "records",
        "Time histories",
        "Force during its pulse and response until it has decayed, one hit below the other on the same \
         axes; of more than twelve hits some, spread over the test.",
    ),
    (
        "backbone",
        "Backbones",
        "Frequency and damping along the decays, by peak force, until the standard deviation of the \
         damping exceeds 5 %.",
    ),
];

/// The average in one sentence.
fn conclusion(found: &AnalysisReport) -> String {
    let (average, all) = (&found.average, found.hits.len());
    let counted = format!("Average of {} of {all} hits", average.hits);
    let Some(first) = average.fundamental else { return format!("{counted}.") };
    let magnitude = four_digits(first.magnitude);
    let mut facts = vec![format!("{counted}: {:.2} Hz", first.frequency_hz), magnitude + " m/N"];
    if let Some(ratio) = first.damping_ratio {
        facts.push(format!("damping {} % (half power)", four_digits(100.0 * ratio)));
    }
    if let Some(coherence) = first.coherence {
        facts.push(format!("coherence {coherence:.5}"));
    }
    facts.join(", ") + "."
}

/// Statistics of the features over the averaged hits.
fn features(page: Report, found: &AnalysisReport) -> Report {
    let average = &found.average;
    let row = |name: &str, statistics: Option<HitStatistics>, hertz: bool| {
        let of = |value: fn(&HitStatistics) -> f64| match statistics.as_ref().map(value) {
            Some(value) if hertz && value.is_finite() => TableCell::Number(format!("{value:.3}")),
            value => TableCell::from(value.unwrap_or(f64::NAN)),
        };
        let count = statistics.map_or(0, |one| one.hits);
        vec![
            name.into(),
            of(|one| one.mean),
            TableCell::deviation(statistics.and_then(|one| one.standard_deviation)),
            of(|one| one.smallest),
            of(|one| one.largest),
            TableCell::Number(count.to_string()),
        ]
    };
    let rows = [
        row("Fundamental f_{1} (Hz)", average.frequency_hz, true),
        row("Receptance A_{1} (m/N)", average.magnitude, false),
        row("Ratio A_{2}/A_{1}", average.harmonic_ratio, false),
    ];
    let headers = ["Feature", "Mean", "Standard deviation", "Least", "Largest", "Hits"];
    page.paragraph("Over the averaged hits, whatever their force.").table(headers, rows)
}

/// A row for each force level; nothing for one.
fn levels(page: Report, found: &AnalysisReport) -> Report {
    if found.levels.len() < 2 {
        return page;
    }
    let rows = found.levels.iter().map(|level| {
        let mean = |statistics: Option<HitStatistics>, factor: f64| {
            TableCell::from(statistics.map_or(f64::NAN, |one| factor * one.mean))
        };
        let deviation = level.frequency_hz.and_then(|one| one.standard_deviation);
        let hertz = |value: Option<f64>| {
            value.map_or("–".into(), |value| TableCell::Number(format!("{value:.3}")))
        };
        vec![
            TableCell::from(level.force_peak_n.mean),
            TableCell::Number(level.hits.len().to_string()),
            hertz(level.frequency_hz.map(|one| one.mean)),
            TableCell::deviation(deviation),
            mean(level.magnitude, 1.0),
            mean(level.damping_ratio, 100.0),
            mean(level.harmonic_ratio, 1.0),
            level.coherence.map_or("–".into(), |c| TableCell::Number(format!("{c:.5}"))),
        ]
    });
    let headers = [
        "Force (N)",
        "Hits",
        "f_{1} (Hz)",
        "Scatter (Hz)",
        "A_{1} (m/N)",
        "Damping (%)",
        "A_{2}/A_{1}",
        "Coherence",
    ];
    let text = "Means of hits of about one force; damping by half power.";
    page.section("Force levels").paragraph(text).table(headers, rows)
}

/// The modal table; nothing without a mode.
fn modes(page: Report, found: &AnalysisReport) -> Report {
    if found.modes.is_empty() {
        return page;
    }
    let rows = found.modes.iter().flat_map(|mode| {
        mode.responses.iter().map(|at| {
            let optional = |value: Option<f64>| TableCell::from(value.unwrap_or(f64::NAN));
            let [re, im] = at.modal_constant_per_kg;
            vec![
                TableCell::Number(mode.number.to_string()),
                at.response.clone().into(),
                TableCell::Number(at.hits.to_string()),
                TableCell::Number(format!("{:.3}", at.natural_frequency_hz)),
                TableCell::deviation(at.natural_frequency_uncertainty_hz),
                (100.0 * at.damping_ratio).into(),
                TableCell::deviation(at.damping_ratio_uncertainty.map(|value| 100.0 * value)),
                re.hypot(im).into(),
                TableCell::deviation(at.modal_constant_uncertainty_per_kg),
                TableCell::Number(format!("{:.1}", at.phase_deg)),
                optional(at.frequency_change_hz),
            ]
        })
    });
    let headers = [
        "Mode",
        "Response",
        "Hits",
        "f_{0} (Hz)",
        "± (Hz)",
        "Damping (%)",
        "± (%)",
        "Constant (1/kg)",
        "± (1/kg)",
        "Phase (°)",
        "Change (Hz)",
    ];
    let text = "Modes in the band by circle fits to the mobility of each hit: natural frequency, \
                damping ratio and modal constant, means over the hits with their standard deviations. \
                A mode whose frequency changes within a hit is nonlinear: see the backbone.";
    page.section("Modes").paragraph(text).table(headers, rows)
}

/// A row for each hit.
fn hits(mut page: Report, found: &AnalysisReport) -> Report {
    if found.hits.len() > MOST_HITS {
        let all = found.hits.len();
        page = page.paragraph(format!("The first {MOST_HITS} of {all} hits; hits.csv has all."));
    }
    let rows = found.hits.iter().take(MOST_HITS).map(|hit| {
        let number = |value: Option<f64>| TableCell::from(value.unwrap_or(f64::NAN));
        let hundred = |value: Option<f64>| number(value.map(|value| 100.0 * value));
        let first = hit.fundamental;
        vec![
            TableCell::Number(hit.index.to_string()),
            number(hit.force_peak_n),
            number(hit.pulse_width_s.map(|width| 1e3 * width)),
            first.map_or("–".into(), |f| TableCell::Number(format!("{:.2}", f.frequency_hz))),
            number(first.map(|first| first.magnitude)),
            hundred(first.and_then(|first| first.damping_ratio)),
            hundred(first.and_then(|first| first.damping_ratio_decrement)),
            number(hit.harmonic_ratio),
            remarks(hit).into(),
        ]
    });
    let headers = [
        "Hit",
        "Force (N)",
        "Width (ms)",
        "f_{1} (Hz)",
        "A_{1} (m/N)",
        "Half power (%)",
        "Decrement (%)",
        "A_{2}/A_{1}",
        "Issues",
    ];
    page.table(headers, rows)
}

fn remarks(hit: &HitReport) -> String {
    let left_out = (!hit.averaged).then(|| "left out".to_owned());
    left_out.into_iter().chain(hit.issues.iter().cloned()).collect::<Vec<_>>().join("; ")
}

fn settings(page: Report, found: &AnalysisReport) -> Report {
    let settings = &found.settings;
    let band = settings.band_hz.map_or("none".to_owned(), |[low, high]| {
        let chosen = if settings.band_given { "given" } else { "chosen" };
        format!("{low:.1} to {high:.1} Hz, {chosen}")
    });
    let window = match (settings.force_window, settings.exponential_window_s) {
        (false, None) => "none".to_owned(),
        (true, None) => "force".to_owned(),
        (force, Some(tau)) => {
            let force = if force { "force and " } else { "" };
            format!("{force}exponential, time constant {} s", four_digits(tau))
        }
    };
    let mut pairs = vec![("sample rate".to_owned(), format!("{} Hz", found.sample_rate_hz))];
    for channel in &found.channels {
        pairs.push((channel.role.to_string(), format!("{} ({})", channel.name, channel.unit)));
    }
    pairs.extend([
        ("trigger level".to_owned(), format!("{} N", four_digits(settings.trigger_level_n))),
        ("noise of the force".to_owned(), format!("{} N", four_digits(settings.noise_n))),
        ("longest hit".to_owned(), format!("{} s", four_digits(settings.hit_length_s))),
        ("band of the fundamental".to_owned(), band),
        ("estimator".to_owned(), settings.estimator.to_owned()),
        ("window".to_owned(), window),
    ]);
    page.key_values(pairs)
}

fn provenance(page: Report, found: &AnalysisReport) -> Report {
    let version = ("asperity".to_owned(), found.provenance.version.to_owned());
    let files = found.provenance.files.iter().map(|file| {
        let (name, format) = (file.file.clone(), &file.format);
        (name, format!("{format}, {} records, SHA-256 {}", file.records, file.sha256))
    });
    page.section("Provenance").key_values(std::iter::once(version).chain(files))
}
