//! `asperity decay`.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;

use asperity_experiment::{
    DecayCurveReport, DecayOptions, DecayReport, MeasuredDecay, ResponseChoice,
    analyse_decay_sources, input_files,
};
use asperity_measure::MeasurementSource;
use asperity_plot as plot;
use serde_json::json;

use super::ResultFolder;
use crate::args::analyse::Decay;
use crate::failure::Failure;
use crate::file_kind::check_measurements;
use crate::rig;

/// Most rows in the printed table.
const MOST_SHOWN: usize = 40;

/// Analyses the free decays of some files; writes tables and figures.
pub(crate) fn run(asked: &Decay, quiet: bool) -> Result<(), Failure> {
    let files = input_files(&asked.files)?;
    files.iter().try_for_each(|file| check_measurements(file))?;
    let first = files.first().map_or("decay".as_ref(), PathBuf::as_path);
    let folder = ResultFolder::claim_analysis("decay", first, &asked.output, false)?;
    let options = options(asked)?;
    let bar = crate::progress::bar(files.len() as u64, "reading", quiet);
    let sources: Vec<MeasurementSource> = files.iter().cloned().map(Into::into).collect();
    let analysis =
        analyse_decay_sources(&sources, &options, &|files| bar.set_position(files as u64));
    bar.finish_and_clear();
    let analysis = analysis?;

    folder.write("decays.csv", analysis.decays_table().to_csv())?;
    folder.write("backbone.csv", analysis.backbone_table().to_csv())?;
    let figures = plot::decay_figures(&analysis);
    for (name, figure) in &figures {
        folder.draw(name, figure)?;
    }
    folder.write("report.html", plot::decay_report(&analysis, &figures))?;
    let report = &analysis.report;
    let folder = folder.finish("decay.json", &json!(report), asked.output.json)?;
    if !asked.output.json && !quiet {
        crate::progress::show_notices(report.notices.iter().map(|text| options_in(text)));
        answer!("{}", in_words(report));
        answer_line!("written to {}", folder.display());
    }
    Ok(())
}

/// The options of the rig; options of the command line win.
fn options(asked: &Decay) -> Result<DecayOptions, Failure> {
    let rig = rig::measured_options(&asked.measured)?;
    let responses = match (asked.response.as_slice(), rig.responses) {
        ([], ResponseChoice::Channels(channels)) => channels,
        (asked, _) => asked.to_vec(),
    };
    let bands_hz = match asked.band.as_slice() {
        [] => rig.band_hz.into_iter().collect(),
        bands => bands.to_vec(),
    };
    Ok(DecayOptions {
        reading: rig.reading,
        sensitivities: rig.sensitivities,
        responses,
        bands_hz,
        rig: rig.rig,
    })
}

/// A sentence of the library with the options of the command.
fn options_in(text: &str) -> String {
    text.replace("`band_hz`", "--band LO:HI")
}

/// The decays as text.
fn in_words(report: &DecayReport) -> String {
    let mut text = String::from(
        "                                                frequency           damping        largest  \
         second\ndecay curve  response         start s   length s        Hz        ±         %        \
         ±  amplitude  harmonic\n",
    );
    let rows =
        report.decays.iter().flat_map(|decay| decay.responses.iter().map(move |of| (decay, of)));
    let all = rows.clone().count();
    for (decay, of) in rows.take(MOST_SHOWN) {
        text.push_str(&row(decay, of));
    }
    if all > MOST_SHOWN {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "... and {} more in decays.csv", all - MOST_SHOWN);
    }
    let origin = |name: &str| report.decays.iter().filter(|decay| decay.origin == name).count();
    let kinds = [
        (origin("blow"), "after blows"),
        (origin("release"), "after a sustained excitation"),
        (origin("record_start"), "at the beginning of a record"),
    ];
    let kinds: Vec<String> = kinds
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, words)| format!("{count} {words}"))
        .collect();
    let _ = writeln!(text, "decays: {}", kinds.join(", "));
    for sentence in &report.conclusions {
        let _ = writeln!(text, "{sentence}");
    }
    let mut said = BTreeSet::new();
    for decay in &report.decays {
        let own = decay.responses.iter().flat_map(|of| {
            of.warnings.iter().map(move |text| format!("`{}`: {text}", of.response))
        });
        for warning in own.chain(decay.warnings.iter().cloned()) {
            if said.insert(warning.clone()) && said.len() <= MOST_SHOWN {
                let _ = writeln!(text, "decay {}, {}", decay.index, options_in(&warning));
            }
        }
    }
    text
}

fn row(decay: &MeasuredDecay, of: &DecayCurveReport) -> String {
    let number = |value: Option<f64>, width: usize, digits: usize| {
        let shown = value.map_or("-".to_owned(), |value| format!("{value:.digits$}"));
        format!("{shown:>width$}")
    };
    let short: String = of.response.chars().take(14).collect();
    let amplitude = of.largest.map_or("-".to_owned(), |largest| match largest.amplitude_m {
        Some(metres) => format!("{metres:.2e} m"),
        None => format!("{:.2e}", largest.amplitude),
    });
    let deviation = |value: Option<f64>| {
        let shown = value.map_or("-".to_owned(), |value| format!("{value:.0e}"));
        format!("{shown:>8}")
    };
    let hundred = |value: Option<f64>| value.map(|value| 100.0 * value);
    format!(
        "{:>5} {:>5}  {short:<14} {:>9.4} {:>9.4}{} {} {} {} {} {amplitude:>11} {}\n",
        decay.index,
        of.index,
        of.start_s,
        of.length_s,
        if of.reaches_noise { " " } else { "+" },
        number(of.mean.map(|mean| mean.frequency_hz), 9, 3),
        deviation(of.mean.map(|mean| mean.frequency_uncertainty_hz)),
        number(hundred(of.mean.map(|mean| mean.damping_ratio)), 9, 4),
        deviation(hundred(of.mean.map(|mean| mean.damping_ratio_uncertainty))),
        number(
            of.second_harmonic
                .filter(|second| second.origin == Some("harmonic"))
                .map(|second| second.ratio),
            8,
            4
        ),
    )
}
