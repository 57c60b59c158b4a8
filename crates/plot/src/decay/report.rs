//! `report.html` of free decays.

use asperity_experiment::{DecayAnalysis, DecayReport};
use asperity_figure::Figure;
use asperity_figure::report::{Report, TableCell};

/// Most rows of the table.
const MOST_ROWS: usize = 500;

/// Names of the figures, their headings and captions.
const FIGURES: [(&str, &str, &str); 3] = [
    (
        "backbone",
        "Backbones",
        "Frequency and damping over amplitude along each decay; areas are two standard deviations due \
         to noise to either side. A curve ends where the standard deviation of the damping exceeds 5 %.",
    ),
    (
        "harmonics",
        "Harmonics",
        "Amplitudes of the second and the third harmonic over that of the fundamental, as \
         displacements, where they are above the noise.",
    ),
    (
        "decays",
        "Time histories",
        "Extremes of the responses. Shaded: the decays, until they are noise or the samples end.",
    ),
];

/// `report.html`.
pub fn decay_report(analysis: &DecayAnalysis, figures: &[(&'static str, Figure)]) -> String {
    let found = &analysis.report;
    let mut page = Report::new("Free decays");
    page = found.conclusions.iter().cloned().fold(page, Report::intro);
    page = decays(page.section("Decays"), found);
    for (name, title, caption) in FIGURES {
        if let Some((_, figure)) = figures.iter().find(|(drawn, _)| *drawn == name) {
            page = page.section(title).interactive_figure(name, caption, figure);
        }
    }
    if !found.notices.is_empty() {
        page = page.section("Notices");
        page = found.notices.iter().cloned().fold(page, Report::paragraph);
    }
    let version = ("asperity".to_owned(), found.provenance.version.to_owned());
    let bands = found.settings.bands_hz.iter().map(|[low, high]| {
        let chosen = if found.settings.band_given { "given" } else { "chosen" };
        ("band".to_owned(), format!("{low:.1} to {high:.1} Hz, {chosen}"))
    });
    let files = found.provenance.files.iter().map(|file| {
        let (name, format) = (file.file.clone(), &file.format);
        (name, format!("{format}, {} records, SHA-256 {}", file.records, file.sha256))
    });
    let facts = bands.chain(std::iter::once(version)).chain(files);
    page.section("Settings and provenance").key_values(facts).to_html()
}

/// A row for each decay, band and response.
fn decays(mut page: Report, found: &DecayReport) -> Report {
    let all: usize = found.decays.iter().map(|decay| decay.responses.len()).sum();
    if all > MOST_ROWS {
        page = page.paragraph(format!("The first {MOST_ROWS} of {all} rows; decays.csv has all."));
    }
    let rows = found
        .decays
        .iter()
        .flat_map(|decay| decay.responses.iter().map(move |of| (decay, of)))
        .take(MOST_ROWS)
        .map(|(decay, of)| {
            let number = |value: Option<f64>| TableCell::from(value.unwrap_or(f64::NAN));
            let hundred = |value: Option<f64>| number(value.map(|value| 100.0 * value));
            let hertz = |value: Option<f64>, digits: usize| {
                value.map_or("–".into(), |value| TableCell::Number(format!("{value:.digits$}")))
            };
            let warnings = of.warnings.iter().chain(&decay.warnings);
            vec![
                TableCell::Number(decay.index.to_string()),
                decay.origin.replace('_', " ").into(),
                of.response.clone().into(),
                number(Some(of.start_s)),
                number(Some(of.length_s)),
                hertz(of.mean.map(|mean| mean.frequency_hz), 3),
                TableCell::deviation(of.mean.map(|mean| mean.frequency_uncertainty_hz)),
                hundred(of.mean.map(|mean| mean.damping_ratio)),
                TableCell::deviation(of.mean.map(|mean| 100.0 * mean.damping_ratio_uncertainty)),
                number(of.largest.map(|one| one.amplitude_m.unwrap_or(one.amplitude))),
                number(of.smallest.map(|one| one.amplitude_m.unwrap_or(one.amplitude))),
                number(of.second_harmonic.map(|second| second.ratio)),
                warnings.cloned().collect::<Vec<_>>().join("; ").into(),
            ]
        });
    let headers = [
        "Decay",
        "Origin",
        "Response",
        "Start (s)",
        "Length (s)",
        "Frequency (Hz)",
        "± (Hz)",
        "Damping (%)",
        "± (%)",
        "Largest amplitude",
        "Smallest amplitude",
        "A_{2}/A_{1}",
        "Warnings",
    ];
    let text = "Lines through the whole decays, with standard deviations due to noise. Amplitudes in m, \
                or in the unit of a channel without a known one.";
    page.paragraph(text).table(headers, rows)
}
