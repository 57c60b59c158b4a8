//! `cargo xtask campaign`: random scenarios through both engines, disagreements judged.
//!
//! A seed and a number determine a scenario. Both engines run it with their default settings;
//! where their observables differ beyond the tolerances, refined runs decide. An answer that is
//! wrong and does not say so fails the campaign. Scenarios, a report in JSON and one in Markdown
//! go to `target/campaign/`.
//!
//! With `--cases` the scenarios of a folder take the place of random ones, judged by the truths
//! stored beside them.
//!
//! | module | does |
//! |---|---|
//! | [`draw`] | seeded random numbers |
//! | [`random_scenario`] | random but sensible scenarios |
//! | [`answer`] | observables of an engine's answer, and distances in tolerances |
//! | [`judgement`] | classes of answers, by agreement or by refined runs |
//! | [`stated`] | the errors that answers state, against finer runs |
//! | [`steady`] | harmonic balance against exact and integrated responses |
//! | [`structure`] | structures of matrices against their equations on all rows |
//! | [`linear_oracle`] | exact linear response of a stack |
//! | [`cases`] | a folder of scenarios with their truths |
//! | [`report`] | `report.json` and `report.md` |

mod answer;
mod cases;
mod draw;
mod judgement;
mod linear_oracle;
mod random_scenario;
mod report;
mod stated;
mod steady;
mod structure;

use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use anyhow::{Context, Result};
use asperity_scenario::{Document, LoadSamples};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use judgement::{Case, Class, Judgement};
use random_scenario::RandomScenario;
use stated::StatedErrors;
use steady::SteadyJudgement;

/// Options of `cargo xtask campaign`.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Number of random scenarios.
    #[arg(long, value_name = "N", default_value_t = 30, conflicts_with = "cases")]
    count: u64,
    /// Number that determines the scenarios, with their own numbers; "today" for the date.
    #[arg(long, value_name = "S", default_value = "1", value_parser = seed)]
    seed: u64,
    /// First scenario.
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "cases")]
    first: u64,
    /// Run the scenarios of this folder instead, and judge them by its truths.json.
    #[arg(long, value_name = "DIR")]
    cases: Option<PathBuf>,
    /// Determine the missing truths of the folder by refined runs and store them.
    #[arg(long, requires = "cases")]
    bless: bool,
}

/// A scenario that was judged.
struct Judged {
    /// Number of a random scenario, or name of a case.
    name: String,
    judgement: Judgement,
    /// Judgements of the state at rest and of steady responses.
    steady: Vec<SteadyJudgement>,
    /// Errors over the stated ones, where they were compared.
    stated: Option<StatedErrors>,
    seconds: f64,
}

impl Judged {
    /// Name, time and classes, in a line.
    fn line(&self) -> String {
        let Judgement { modal, finite_difference, .. } = &self.judgement;
        let (modal, other) = (modal.class.words(), finite_difference.class.words());
        format!("{}: {:.1} s, modal {modal}, finite differences {other}", self.name, self.seconds)
    }

    /// Classes of all its answers.
    fn classes(&self) -> impl Iterator<Item = Class> {
        let Judgement { modal, finite_difference, .. } = &self.judgement;
        let transient = [modal.class, finite_difference.class];
        transient.into_iter().chain(self.steady.iter().map(|one| one.class))
    }
}

/// Steady responses, and stated errors, are judged for every scenario of this many.
const EVERY: u64 = 4;

/// Carries out the task; true if no answer is silently wrong.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    let root = crate::workspace::workspace_root();
    let folder = root.join("target/campaign");
    std::fs::create_dir_all(&folder).with_context(|| format!("creating {}", folder.display()))?;
    let started = Instant::now();
    let (title, judged) = match &arguments.cases {
        Some(cases) if arguments.bless => return cases::bless(cases).map(|()| true),
        Some(cases) => (format!("cases of {}", cases.display()), cases::judge(cases)?),
        None => {
            let title = format!("{} scenarios, seed {}", arguments.count, arguments.seed);
            (title, judge_random(arguments, &folder)?)
        }
    };
    let seconds = started.elapsed().as_secs_f64();
    report::write(&folder, &title, &judged, seconds)?;
    report::print(&title, &judged, &folder, seconds);
    // A stored case without a truth is known to be chaotic, which its answers have to say.
    let fails = |class| {
        let undecided = arguments.cases.is_some() && class == Class::SilentlyUndecided;
        class == Class::SilentlyWrong || undecided
    };
    Ok(!judged.iter().flat_map(Judged::classes).any(fails))
}

/// Judges the random scenarios, which are written to `folder`.
fn judge_random(arguments: &Arguments, folder: &Path) -> Result<Vec<Judged>> {
    let Arguments { seed, first, count, .. } = *arguments;
    let bar = progress(count);
    let judged = (first..first + count)
        .into_par_iter()
        .map(|number| {
            let started = Instant::now();
            let random = RandomScenario::new(seed, number)?;
            let path = folder.join(format!("seed{seed}-{number}.json"));
            write_scenario(&random, &path)?;
            let document = Document::read(&path)?;
            let scenario = document
                .scenario()
                .with_context(|| format!("the scenario {} is not valid", path.display()))?;
            let judgement = Case { document: &document, scenario: &scenario }.judge();
            let (mut steady, mut stated) = (Vec::new(), None);
            match number % EVERY {
                0 => steady = steady::judge(&document, &scenario, seed, number),
                1 => {
                    let answer = judgement.answer.as_ref();
                    stated = answer.and_then(|one| StatedErrors::of(one, &document, &scenario));
                }
                _ => (),
            }
            steady.extend(structure::judge(folder, seed, number));
            let seconds = started.elapsed().as_secs_f64();
            let judged =
                Judged { name: format!("seed{seed}-{number}"), judgement, steady, stated, seconds };
            bar.inc(1);
            if bar.is_hidden() {
                eprintln!("{}", judged.line());
            }
            Ok(judged)
        })
        .collect::<Result<Vec<_>>>()?;
    bar.finish_and_clear();
    Ok(judged)
}

/// Writes a scenario, and the samples file it names beside it.
fn write_scenario(random: &RandomScenario, path: &PathBuf) -> Result<()> {
    if let Some(LoadSamples { time_s, values }) = &random.samples {
        let rows = time_s.iter().zip(values).map(|(time, force)| format!("{time},{force}\n"));
        let table = format!("time_s,force_n\n{}", rows.collect::<String>());
        crate::reproduce::write(&path.with_extension("csv"), table.as_bytes())?;
    }
    let mut text = serde_json::to_string_pretty(&random.scenario)?;
    text.push('\n');
    crate::reproduce::write(path, text.as_bytes())
}

fn progress(length: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} scenarios, {elapsed} {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
}

/// A seed: a number, or "today" for the days since 1970.
fn seed(text: &str) -> Result<u64, String> {
    if text == "today" {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        return now.map(|since| since.as_secs() / 86_400).map_err(|error| error.to_string());
    }
    text.parse().map_err(|_| format!("{text:?} is not a seed; for example 1, or today"))
}
