//! `asperity analyse`.

use std::fmt::Write as _;
use std::path::PathBuf;

use asperity_experiment::{AnalysisOptions, AnalysisReport, HitReport, analyse_with_progress};
use serde_json::json;

use super::ResultFolder;
use crate::args::analyse::Analyse;
use crate::failure::Failure;
use crate::plot;

/// Most hits in the printed table.
const MOST_SHOWN: usize = 30;

/// Analyses the files of one test; writes tables and figures.
pub(crate) fn run(asked: &Analyse, quiet: bool) -> Result<(), Failure> {
    let first = asked.files.first().map_or("analysis".as_ref(), PathBuf::as_path);
    let out = asked.out.as_deref();
    let folder = ResultFolder::claim_at("analyse", first, out, asked.overwrite)?;
    let bar = crate::progress::bar(2 * asked.files.len() as u64, "reading", quiet);
    let analysis = analyse_with_progress(&asked.files, &options(asked), &|passes| {
        bar.set_position(passes as u64);
    });
    bar.finish_and_clear();
    let analysis = analysis?;

    folder.write("hits.csv", analysis.hits_csv())?;
    folder.write("frf.csv", analysis.frf_csv())?;
    folder.write("backbone.csv", analysis.backbone_csv())?;
    for (name, figure) in plot::figures(&analysis) {
        folder.draw(name, &figure)?;
    }
    let folder = folder.finish("analysis.json", &json!(analysis.report), asked.json)?;
    if !asked.json && !quiet {
        crate::progress::show_notices(analysis.report.notices.iter().map(|notice| {
            let notice = notice.replace("`band_hz`", "--band LO:HI");
            notice.replace("`flip_force`", "--flip-force")
        }));
        answer!("{}", in_words(&analysis.report));
        answer_line!("written to {}", folder.display());
    }
    Ok(())
}

fn options(asked: &Analyse) -> AnalysisOptions {
    let default = AnalysisOptions::default();
    AnalysisOptions {
        reading: asked.source.read_options(&default.reading),
        sensitivities: asked.sensitivity.clone(),
        force: asked.force.clone(),
        response: asked.response.clone(),
        flip_force: asked.flip_force,
        hits: asked.hits,
        trigger_level_n: asked.trigger_level,
        hit_length_s: asked.hit_length,
        pre_trigger_s: asked.pre_trigger,
        hold_off_s: asked.hold_off,
        estimator: asked.estimator,
        form: asked.form,
        windows: asked.window,
        band_hz: asked.band,
        keep_all: asked.keep_all,
    }
}

/// The analysis as text.
fn in_words(report: &AnalysisReport) -> String {
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
    let (average, all, estimator) =
        (&report.average, report.hits.len(), &report.settings.estimator);
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
