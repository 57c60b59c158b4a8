//! `cargo xtask reproduce`: every figure of the paper, every claim checked.
//!
//! Each figure is one file under `figures/` and one constant, a [`PaperFigure`]:
//! it computes a table and the numbers that the claims ask for, and draws from
//! the table alone. The results go to `target/reproduce/`, a CSV, an SVG and a
//! PNG for each figure, and a report in HTML and Markdown, and replace those of the
//! run before.
//!
//! | module | does |
//! |---|---|
//! | [`rig`] | the paper's rig from the fixtures, and its runs, each computed once |
//! | [`paper_figure`] | one figure: its table and its numbers |
//! | [`claims`] | statements of the paper and their outcomes |
//! | [`references`] | the stored tables that `--check` compares with |
//! | [`report`] | `report.html` and `report.md` |

pub(crate) mod claims;
pub(crate) mod paper_figure;
mod references;
mod report;
pub(crate) mod rig;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use asperity_figure::svg_to_png;
use asperity_simulation::output::{OutputFolder, OutputRequest};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use crate::figures::FIGURES;
use claims::{CheckedClaim, Verdict};
use paper_figure::{Finished, PaperFigure};
use rig::Rig;

/// Resolution of the PNG files, in pixels per millimetre: 300 dots per inch.
const PIXELS_PER_MM: f64 = 12.0;

/// Options of `cargo xtask reproduce`.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Only the figure of this id, e.g. fig06; repeatable.
    #[arg(long, value_name = "ID")]
    only: Vec<String>,
    /// Compare tables and verdicts with the stored ones, and fail on a difference.
    #[arg(long)]
    check: bool,
    /// Cells of 4 mm: a first look in a moment. Not for --check.
    #[arg(long, conflicts_with = "check")]
    quick: bool,
    /// Store this run's tables and verdicts as the reference for --check.
    #[arg(long, conflicts_with_all = ["check", "quick", "only"])]
    bless: bool,
}

/// Carries out the task; whether everything asked of it held.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    let started = Instant::now();
    let root = crate::workspace::workspace_root();
    let chosen = choose(&arguments.only)?;
    let folder = root.join("target/reproduce");
    let claims_file = root.join("fixtures/paper/claims.json");
    let output = OutputFolder::claim(&OutputRequest {
        folder: &folder,
        command: "reproduce",
        document: &claims_file,
        replace_other_document: true,
        overwrite: true,
    })?;
    let bar = progress(chosen.len() as u64);
    let rig = Rig::load(&root.join("fixtures/scenarios"), arguments.quick, bar.clone())?;
    let mut finished = Vec::new();
    let mut values = BTreeMap::new();
    for figure in chosen {
        bar.set_prefix(figure.id);
        let computed =
            (figure.compute)(&rig).with_context(|| format!("computing {}", figure.id))?;
        let svg =
            (figure.draw)(&computed.table).with_context(|| format!("drawing {}", figure.id))?;
        values.extend(computed.values.into_iter().map(|(id, value)| (id.to_owned(), value)));
        finished.push(Finished { figure, table: computed.table, svg });
        bar.inc(1);
    }
    bar.finish_and_clear();

    let claims = claims::load(&claims_file)?;
    let checked = claims::check(&claims, &values, arguments.only.is_empty())?;
    write_figures(&output, &finished)?;
    let seconds = started.elapsed().as_secs_f64();
    report::write(output, &finished, &checked, &rig, seconds)?;
    print_summary(&checked, &folder, finished.len(), seconds);

    let stored = root.join("fixtures/reference/figures");
    if arguments.bless {
        references::store(&stored, &finished)?;
        println!("stored as the reference in {}", stored.display());
    }
    if !arguments.check {
        return Ok(true);
    }
    let mut differences = references::compare(&stored, &finished)?;
    differences.extend(checked.iter().filter_map(CheckedClaim::difference));
    for difference in &differences {
        eprintln!("check: {difference}");
    }
    if differences.is_empty() {
        println!("check: tables and verdicts are as stored");
    }
    Ok(differences.is_empty())
}

fn choose(only: &[String]) -> Result<Vec<&'static PaperFigure>> {
    let known: Vec<&str> = FIGURES.iter().map(|figure| figure.id).collect();
    if let Some(unknown) = only.iter().find(|id| !known.contains(&id.as_str())) {
        bail!("there is no figure \"{unknown}\"; accepted: {}", known.join(", "));
    }
    let wanted = |figure: &&PaperFigure| only.is_empty() || only.iter().any(|id| id == figure.id);
    Ok(FIGURES.iter().copied().filter(wanted).collect())
}

fn progress(length: u64) -> ProgressBar {
    let style =
        ProgressStyle::with_template("reproduce [{bar:40}] {pos}/{len} {elapsed} {prefix} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
}

fn write_figures(output: &OutputFolder, finished: &[Finished]) -> Result<()> {
    for done in finished {
        let name = |extension: &str| format!("{}.{extension}", done.figure.id);
        output.write(&name("csv"), done.table.to_csv())?;
        output.write(&name("svg"), &done.svg)?;
        output.write(&name("png"), svg_to_png(&done.svg, PIXELS_PER_MM)?)?;
    }
    Ok(())
}

/// Writes a file whole: under another name first.
pub(crate) fn write(place: &PathBuf, contents: &[u8]) -> Result<()> {
    let temporary = place.with_extension("tmp");
    std::fs::write(&temporary, contents)
        .and_then(|()| std::fs::rename(&temporary, place))
        .with_context(|| format!("writing {}", place.display()))
}

fn print_summary(checked: &[CheckedClaim<'_>], folder: &Path, figures: usize, seconds: f64) {
    let count = |verdict| checked.iter().filter(|claim| claim.verdict == verdict).count();
    println!("{figures} figures in {seconds:.1} s: {}", folder.join("report.html").display());
    println!(
        "{} claims: {} reproduced, {} under a stated reading, {} not reproduced",
        checked.len(),
        count(Verdict::Reproduced),
        count(Verdict::UnderReading),
        count(Verdict::NotReproduced)
    );
}
