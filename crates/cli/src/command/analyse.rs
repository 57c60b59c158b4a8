//! `asperity analyse`.

use std::fmt::Write as _;
use std::path::PathBuf;

use asperity_experiment::{
    Analysis, AnalysisError, AnalysisOptions, AnalysisReport, ForceLevel, HitReport, HitStatistics,
    Mode, RejectedHit, ResponseAnalysis, analyse_sources, input_files,
};
use asperity_measure::{MeasurementSource, WriteOptions};
use asperity_plot as plot;
use asperity_scenario::four_digits;
use asperity_simulation::output::file_name::distinct_file_names;
use serde_json::json;

use super::{ResultFolder, pretty};
use crate::args::analyse::{Analyse, AnalysisArguments};
use crate::failure::Failure;
use crate::file_kind::check_measurements;
use crate::rig;

/// Most hits in the printed table.
const MOST_SHOWN: usize = 30;

/// Analyses the files of one test; writes tables and figures.
pub(crate) fn run(asked: &Analyse, quiet: bool) -> Result<(), Failure> {
    let Analyse { files, analysis: asked } = asked;
    let files = input_files(files)?;
    files.iter().try_for_each(|file| check_measurements(file))?;
    let first = files.first().map_or("analysis".as_ref(), PathBuf::as_path);
    let folder = ResultFolder::claim_analysis("analyse", first, &asked.output, false)?;
    let bar = crate::progress::bar(2 * files.len() as u64, "reading", quiet);
    let sources: Vec<MeasurementSource> = files.iter().cloned().map(Into::into).collect();
    let analysis = analyse_sources(&sources, &options(asked)?, &|passes| {
        bar.set_position(passes as u64);
    });
    bar.finish_and_clear();
    let analysis = analysis?;
    let folder = write(folder, &analysis, asked, asked.output.json)?;
    if let (Some(first), false) = (analysis.responses.first(), asked.output.json || quiet) {
        crate::progress::show_notices(first.report.notices.iter().map(|notice| {
            let notice = notice.replace("`band_hz`", "--band LO:HI");
            notice.replace("`flip_force`", "--flip-force")
        }));
        answer!("{}", in_words(&analysis));
        answer_line!("written to {}", folder.display());
    }
    Ok(())
}

/// Writes tables, figures and pages, and puts them in place; prints the report if `print`.
pub(super) fn write(
    folder: ResultFolder,
    analysis: &Analysis,
    asked: &AnalysisArguments,
    print: bool,
) -> Result<PathBuf, Failure> {
    let names = suffixes(analysis);
    for (response, suffix) in analysis.responses.iter().zip(&names) {
        folder.write(&format!("hits{suffix}.csv"), response.hits_table().to_csv())?;
        folder.write(&format!("frf{suffix}.csv"), response.frf_table().to_csv())?;
        folder.write(&format!("backbone{suffix}.csv"), response.backbone_table().to_csv())?;
    }
    folder.write("modes.csv", analysis.modes_table().to_csv())?;
    if let Some(format) = asked.frfs {
        let options = WriteOptions { title: "asperity analyse".to_owned(), ..Default::default() };
        let place = folder.unfinished(format.frf_file_name())?;
        let record = analysis.frf_record(format.is_text());
        asperity_measure::write(&place, &[record], format.format(), &options)
            .map_err(AnalysisError::from)?;
    }
    for (number, (response, suffix)) in analysis.responses.iter().zip(&names).enumerate() {
        let mut figures = plot::figures(response, asked.magnitude.into());
        if number == 0 {
            let all = plot::responses(analysis, asked.magnitude.into());
            figures.extend(all.map(|figure| ("responses", figure)));
        }
        for (name, figure) in &figures {
            folder.draw(&format!("{name}{suffix}"), figure)?;
        }
        folder.write(&format!("report{suffix}.html"), plot::analysis_report(response, &figures))?;
        if number > 0 {
            folder.write(&format!("analysis{suffix}.json"), pretty(&json!(response.report)))?;
        }
    }
    let report = analysis.responses.first().map(|first| json!(first.report)).unwrap_or_default();
    folder.finish("analysis.json", &report, print)
}

/// Endings of the names of each response's files: none for the first, then `_` and the channel.
fn suffixes(analysis: &Analysis) -> Vec<String> {
    let names = distinct_file_names(analysis.responses.iter().map(ResponseAnalysis::name));
    let ending = |(number, name)| if number == 0 { String::new() } else { format!("_{name}") };
    names.into_iter().enumerate().map(ending).collect()
}

/// The options of the rig; options of the command line win.
pub(super) fn options(asked: &AnalysisArguments) -> Result<AnalysisOptions, Failure> {
    let rig = rig::channel_options(&asked.channels)?;
    Ok(AnalysisOptions {
        flip_force: asked.flip_force || rig.flip_force,
        hits: asked.hits,
        trigger_level_n: asked.trigger_level.or(rig.trigger_level_n),
        hit_length_s: asked.hit_length.or(rig.hit_length_s),
        pre_trigger_s: asked.pre_trigger.unwrap_or(rig.pre_trigger_s),
        hold_off_s: asked.hold_off.unwrap_or(rig.hold_off_s),
        estimator: asked.estimator.unwrap_or(rig.estimator),
        form: asked.form,
        windows: asked.window.unwrap_or(rig.windows),
        band_hz: asked.band.or(rig.band_hz),
        high_pass_hz: asked.high_pass.or(rig.high_pass_hz),
        rejected: asked.reject.iter().copied().map(RejectedHit::Number).collect(),
        keep_all: asked.keep_all || rig.keep_all,
        keep_frfs: asked.frfs.is_some(),
        ..rig
    })
}

/// The analysis as text.
fn in_words(analysis: &Analysis) -> String {
    let [first, others @ ..] = analysis.responses.as_slice() else { return String::new() };
    let mut text = response_in_words(&first.report);
    for other in others {
        let _ = writeln!(text, "\n{}:", other.name());
        text.push_str(&average(&other.report));
        for sentence in &other.report.conclusions {
            let _ = writeln!(text, "{sentence}");
        }
    }
    let is_nonlinear =
        |mode: &Mode| mode.responses.iter().any(|at| at.frequency_change_hz.is_some());
    if analysis.modes.len() > 1 || !others.is_empty() || analysis.modes.iter().any(is_nonlinear) {
        text.push_str(&modes(&analysis.modes));
    }
    text
}

/// The modal table.
fn modes(modes: &[Mode]) -> String {
    if modes.is_empty() {
        return "\nno mode in the band is in half of the hits\n".to_owned();
    }
    let mut text = String::from(
        "\n mode  response            f0 Hz       +-   damping %       +-   constant 1/kg  phase deg\n",
    );
    // A value has the digits of its deviation, which has two.
    let pair = |value: f64, deviation: Option<f64>, width: usize, digits: usize| {
        let digits = deviation
            .filter(|sigma| *sigma > 0.0 && sigma.is_finite())
            .map_or(digits, |sigma| (1.0 - sigma.log10().floor()).clamp(0.0, 6.0) as usize);
        let sigma = deviation.map_or("-".to_owned(), |sigma| format!("{sigma:.digits$}"));
        format!("{value:>width$.digits$} {sigma:>8}")
    };
    for mode in modes {
        for (place, at) in mode.responses.iter().enumerate() {
            let first = if place == 0 { mode.number.to_string() } else { String::new() };
            let [re, im] = at.modal_constant_per_kg;
            let percent = |value: Option<f64>| value.map(|value| 100.0 * value);
            let _ = writeln!(
                text,
                "{first:>5}  {:<14} {} {} {:>15} {:>10.1}{}",
                at.response,
                pair(at.natural_frequency_hz, at.natural_frequency_uncertainty_hz, 10, 3),
                pair(100.0 * at.damping_ratio, percent(at.damping_ratio_uncertainty), 11, 4),
                four_digits(re.hypot(im)),
                at.phase_deg,
                if at.frequency_change_hz.is_some() { "  nonlinear: see backbone.csv" } else { "" },
            );
        }
    }
    text
}

/// The table of the hits, the average, and the force levels.
fn response_in_words(report: &AnalysisReport) -> String {
    let mut text = String::from(
        "                                                       damping %\n \
          hit  force N  impulse Ns  width ms     f1 Hz    A1 m/N  half power  decrement   A2/A1\n",
    );
    for hit in report.hits.iter().take(MOST_SHOWN) {
        text.push_str(&row(hit));
    }
    if report.hits.len() > MOST_SHOWN {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "... and {} more in hits.csv", report.hits.len() - MOST_SHOWN);
    }
    text.push_str(&average(report));
    text.push_str(&levels(&report.levels));
    for sentence in &report.conclusions {
        let _ = writeln!(text, "{sentence}");
    }
    text
}

/// The average in a line.
fn average(report: &AnalysisReport) -> String {
    let (average, all, estimator) =
        (&report.average, report.hits.len(), &report.settings.estimator);
    let mut text = String::new();
    let _ = write!(text, "average of {} of {all} hits ({estimator})", average.hits);
    if let Some(first) = average.fundamental {
        let _ = write!(text, ": {:.2} Hz, {:.4e} m/N", first.frequency_hz, first.magnitude);
        if let Some(ratio) = first.damping_ratio {
            let _ = write!(text, ", damping {:.3} % (half power)", 100.0 * ratio);
        }
        if let Some(coherence) = first.coherence {
            let _ = write!(text, ", coherence {coherence:.5}");
        }
    }
    text.push('\n');
    text
}

/// The table of the force levels; empty for one.
fn levels(levels: &[ForceLevel]) -> String {
    if levels.len() < 2 {
        return String::new();
    }
    let mut text = String::from(
        "\n   force N  hits        f1 Hz   scatter    A1 m/N  scatter %  damping %     A2/A1  coherence\n",
    );
    for level in levels {
        let of = |statistics: Option<HitStatistics>, factor: f64, width: usize, digits: usize| {
            let shown = statistics.map(|one| format!("{:.digits$}", factor * one.mean));
            format!("{:>width$}", shown.unwrap_or_else(|| "-".to_owned()))
        };
        let scatter = |statistics: Option<HitStatistics>| statistics?.standard_deviation;
        let number = |value: Option<f64>, width: usize, digits: usize| {
            let shown = value.map_or("-".to_owned(), |value| format!("{value:.digits$}"));
            format!("{shown:>width$}")
        };
        let height = level.magnitude.map_or("-".to_owned(), |one| format!("{:.3e}", one.mean));
        let relative =
            level.magnitude.and_then(|one| Some(100.0 * one.standard_deviation? / one.mean));
        let _ = writeln!(
            text,
            "{:>10.2} {:>5} {} {} {height:>9} {} {} {} {}",
            level.force_peak_n.mean,
            level.hits.len(),
            of(level.frequency_hz, 1.0, 12, 2),
            number(scatter(level.frequency_hz), 9, 3),
            number(relative, 10, 2),
            of(level.damping_ratio, 100.0, 10, 3),
            of(level.harmonic_ratio, 1.0, 9, 4),
            number(level.coherence, 10, 5),
        );
    }
    text.push('\n');
    text
}

fn row(hit: &HitReport) -> String {
    let number = |value: Option<f64>, factor: f64, width: usize, digits: usize| {
        let shown = value.map_or("-".to_owned(), |value| format!("{:.digits$}", factor * value));
        format!("{shown:>width$}")
    };
    let first = hit.fundamental;
    let height = first.map_or("-".to_owned(), |first| format!("{:.3e}", first.magnitude));
    let mut text = format!(
        "{:>4} {} {} {} {} {height:>9} {} {} {}",
        hit.index,
        number(hit.force_peak_n, 1.0, 8, 2),
        number(hit.impulse_ns, 1.0, 11, 5),
        number(hit.pulse_width_s, 1e3, 9, 4),
        number(first.map(|first| first.frequency_hz), 1.0, 9, 2),
        number(first.and_then(|first| first.damping_ratio), 100.0, 11, 3),
        number(first.and_then(|first| first.damping_ratio_decrement), 100.0, 10, 3),
        number(hit.harmonic_ratio, 1.0, 7, 4),
    );
    if !hit.averaged {
        text.push_str("  left out");
    }
    if !hit.issues.is_empty() {
        let _ = write!(text, "  ({})", hit.issues.join("; "));
    }
    text.push('\n');
    text
}
