//! `asperity watch`.

mod commands;

use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use asperity_experiment::{
    AnalysisError, AnalysisOptions, CompleteFile, FrequencyBand, HitReport, NextLevel, RejectedHit,
    WatchedFolder, analyse,
};
use asperity_identify::{IdentificationError, IdentificationProblem, Work, identify};
use serde_json::{Value, json};

use commands::Command;

use super::{ResultFolder, analyse as analysis, stop_on_signals};
use crate::args::analyse::Watch;
use crate::failure::Failure;
use crate::file_kind::FileKind;
use asperity_plot::measurement;

/// Time between two looks at the folder.
const LOOK: Duration = Duration::from_millis(200);

/// Judges each file that is added to a folder, until Ctrl-C.
pub(crate) fn run(asked: &Watch, quiet: bool) -> Result<(), Failure> {
    if let Some(level) = asked.levels.iter().find(|level| !(**level > 0.0 && level.is_finite())) {
        let (found, expected) = (level.to_string(), "forces above zero in N, such as 5,10,20");
        return Err(AnalysisError::Setting { name: "the list of levels", found, expected }.into());
    }
    // Hits are rejected by the numbers of this watch.
    let options = AnalysisOptions { rejected: Vec::new(), ..analysis::options(&asked.analysis)? };
    let mut planner = asked.problem.as_deref().map(Planner::new).transpose()?;
    // Fails now rather than after the first hit.
    let output = &asked.analysis.output;
    drop(ResultFolder::claim_analysis("analyse", &asked.folder, output, false)?);
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signals(&stop);
    let mut session = Session {
        asked,
        quiet,
        judged: AnalysisOptions { keep_all: true, keep_frfs: false, ..options.clone() },
        options,
        good: Vec::new(),
        hits: Vec::new(),
        written: None,
    };
    let words = commands::of_standard_input();
    let mut watched = WatchedFolder::new(&asked.folder);
    while !stop.load(Ordering::Relaxed) {
        let mut is_new = false;
        for CompleteFile { path, is_left } in watched.look()? {
            // One that has been replaced.
            is_new |= session.forget(&path);
            if session.judge(&path, is_left)? {
                watched.accept(&path);
                is_new = true;
            }
        }
        for path in watched.take_gone() {
            if session.forget(&path) {
                is_new = true;
                let name = file_name(&path);
                let text = format!("{name} is gone: its hits are left out");
                session.say(&text, || json!({ "file": name, "gone": true }))?;
            }
        }
        for word in words.try_iter() {
            is_new |= session.obey(&word)?;
        }
        if is_new
            && session.update()?
            && let Some(planner) = &mut planner
        {
            planner.start();
        }
        if let Some(sentence) = planner.as_mut().and_then(Planner::finished) {
            session.say(&sentence, || json!({ "plan": sentence }))?;
        }
        if asked.once && watched.is_settled() && planner.as_ref().is_none_or(Planner::is_idle) {
            break;
        }
        std::thread::sleep(LOOK);
    }
    if let Some(planner) = planner {
        planner.stop();
    }
    match &session.written {
        Some(folder) if !quiet && !asked.analysis.output.json => {
            answer_line!("written to {}", folder.display());
        }
        Some(_) => {}
        None => session.say("no good hit", || json!({ "hits": 0 }))?,
    }
    Ok(())
}

/// The files so far and their analysis.
struct Session<'a> {
    asked: &'a Watch,
    quiet: bool,
    /// Options of the analysis of all files, and of single ones, whose bad hits are looked at too.
    options: AnalysisOptions,
    judged: AnalysisOptions,
    /// Files with hits.
    good: Vec<PathBuf>,
    /// Hits by their numbers, from 1, which stay when a file goes.
    hits: Vec<JudgedHit>,
    /// Folder of the results.
    written: Option<PathBuf>,
}

/// A hit with its place.
struct JudgedHit {
    file: PathBuf,
    time_s: f64,
    rejected: bool,
    /// True if its file is gone or has been replaced.
    is_gone: bool,
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

impl Session<'_> {
    /// Leaves out a file that is gone or has been replaced. True if it had hits.
    fn forget(&mut self, path: &Path) -> bool {
        let files = self.good.len();
        self.good.retain(|known| known != path);
        self.hits.iter_mut().filter(|hit| hit.file == path).for_each(|hit| hit.is_gone = true);
        self.good.len() < files
    }

    /// Rejects hits, or takes them back. True if one has changed.
    fn obey(&mut self, word: &Command) -> Result<bool, Failure> {
        let (numbers, rejected) = match word {
            Command::Reject(numbers) => (numbers, true),
            Command::Keep(numbers) => (numbers, false),
            Command::Unknown(text) => {
                let text = format!("`{text}` is not understood; accepted: reject 3,7 and keep 3,7");
                self.say(&text, || json!({ "error": text }))?;
                return Ok(false);
            }
        };
        let mut is_changed = false;
        for number in numbers {
            let hit = number.checked_sub(1).and_then(|at| self.hits.get_mut(at));
            let done = match hit.filter(|hit| !hit.is_gone) {
                Some(hit) => {
                    is_changed |= hit.rejected != rejected;
                    hit.rejected = rejected;
                    if rejected { "rejected" } else { "kept" }
                }
                None => "not there",
            };
            let text = format!("#{number} {done}");
            self.say(&text, || json!({ "number": number, "verdict": done }))?;
        }
        Ok(is_changed)
    }

    /// Says what the hits of a file are. False for a file that cannot be read yet.
    fn judge(&mut self, path: &Path, is_left: bool) -> Result<bool, Failure> {
        let name = file_name(path);
        let found = match analyse(&[path.to_owned()], &self.judged) {
            Ok(found) => found,
            Err(AnalysisError::NoHit { .. }) => {
                self.say(
                    &format!("{name}: no hit"),
                    || json!({ "file": name, "hits": [], "verdict": "no hit" }),
                )?;
                return Ok(true);
            }
            // Still being written.
            Err(_) if !is_left => return Ok(false),
            Err(error) => {
                let text = error.to_string();
                self.say(
                    &format!("{name}: cannot be analysed: {text}"),
                    || json!({ "file": name, "error": text }),
                )?;
                return Ok(true);
            }
        };
        let Some(first) = found.responses.first() else { return Ok(true) };
        let report = &first.report;
        if self.judged.band_hz.is_none()
            && let Some([low_hz, high_hz]) = report.settings.band_hz
        {
            // That of the first file, as in the analysis of all.
            self.judged.band_hz = Some(FrequencyBand { low_hz, high_hz });
        }
        for hit in &report.hits {
            let number = self.hits.len() + 1;
            let rejected = self.asked.analysis.reject.contains(&number);
            let (file, time_s) = (path.to_owned(), hit.time_s);
            self.hits.push(JudgedHit { file, time_s, rejected, is_gone: false });
            let ending = if rejected { ", rejected" } else { "" };
            let verdict = if rejected { "rejected" } else { verdict(hit) };
            self.say(
                &format!("#{number} {name}: {}{ending}", in_words(hit)),
                || json!({ "file": name, "number": number, "verdict": verdict, "hit": hit }),
            )?;
        }
        self.good.push(path.to_owned());
        Ok(true)
    }

    /// Analyses all files, writes the results, and says what to hit next. False without a good hit.
    fn update(&mut self) -> Result<bool, Failure> {
        // One that has just gone is noticed at the next look.
        self.good.retain(|path| path.is_file());
        let rejected = self.hits.iter().filter(|hit| hit.rejected && !hit.is_gone);
        self.options.rejected = rejected
            .map(|hit| RejectedHit::At { file: hit.file.display().to_string(), time_s: hit.time_s })
            .collect();
        let all = match analyse(&self.good, &self.options) {
            Ok(all) => all,
            Err(
                AnalysisError::NoHit { .. }
                | AnalysisError::NoGoodHit { .. }
                | AnalysisError::NoFile,
            ) => {
                return Ok(false);
            }
            Err(error) => {
                let text = error.to_string();
                self.say(&format!("all files: {text}"), || json!({ "error": text }))?;
                return Ok(false);
            }
        };
        // After the first results the folder holds those of this command.
        let (place, output) = (&self.asked.folder, &self.asked.analysis.output);
        let again = self.written.is_some();
        let folder = ResultFolder::claim_analysis("analyse", place, output, again)?;
        self.written = Some(analysis::write(folder, &all, &self.asked.analysis, false)?);
        let Some(first) = all.responses.first() else { return Ok(false) };
        let report = &first.report;
        let next = NextLevel::of(&report.levels, &self.asked.levels);
        let levels: Vec<String> = report
            .levels
            .iter()
            .map(|level| format!("{:.2} N: {}", level.force_peak_n.mean, level.hits.len()))
            .collect();
        let good = report.average.hits;
        let text = format!("   {good} good hits ({}); {}", levels.join(", "), next.sentence);
        self.say(
            &text,
            || json!({ "average": report.average, "levels": report.levels, "next": next }),
        )?;
        Ok(true)
    }

    /// A line on standard output: text, or JSON.
    fn say(&self, text: &str, value: impl FnOnce() -> Value) -> Result<(), Failure> {
        if self.asked.analysis.output.json {
            answer_line!("{}", value());
        } else if !self.quiet {
            answer_line!("{text}");
        }
        crate::answer::finish()
    }
}

/// The verdict on a hit in a word or two.
fn verdict(hit: &HitReport) -> &'static str {
    let is_weak = hit.fundamental.is_none_or(|first| first.frequency_uncertainty_hz.is_none());
    match hit {
        _ if hit.overload => "overload",
        _ if hit.double_hit => "double hit",
        _ if hit.dropout => "dropout",
        _ if is_weak => "weak",
        _ => "good",
    }
}

/// The verdict on a hit with its numbers.
fn in_words(hit: &HitReport) -> String {
    let verdict = match verdict(hit) {
        // In colour where someone looks.
        word if stdout().is_terminal() => {
            let colour = if word == "good" { 32 } else { 31 };
            format!("\u{1b}[{colour}m{word}\u{1b}[0m")
        }
        word => word.to_owned(),
    };
    let force = hit.force_peak_n.map(|force| format!(", {force:.2} N")).unwrap_or_default();
    let first = hit.fundamental.map(|first| format!(", f1 {:.2} Hz", first.frequency_hz));
    let issues = match hit.issues.as_slice() {
        [] => String::new(),
        issues => format!(" ({})", issues.join("; ")),
    };
    format!("{verdict}{force}{}{issues}", first.unwrap_or_default())
}

/// Identifications in the background, one at a time.
struct Planner {
    path: PathBuf,
    running: Option<(Arc<Work>, JoinHandle<String>)>,
    /// True if hits came during the one that runs.
    again: bool,
}

impl Planner {
    /// A planner by a problem that has a design.
    fn new(path: &Path) -> Result<Self, Failure> {
        let problem = read_problem(path)?;
        if problem.spec.design.is_none() {
            return Err(Failure::NoDesign { path: path.to_owned() });
        }
        Ok(Self { path: path.to_owned(), running: None, again: false })
    }

    fn is_idle(&self) -> bool {
        self.running.is_none()
    }

    fn start(&mut self) {
        if self.running.is_some() {
            self.again = true;
            return;
        }
        let problem = match read_problem(&self.path) {
            Ok(problem) => problem,
            Err(error) => {
                tracing::warn!("{error}");
                return;
            }
        };
        let work = Arc::clone(problem.work());
        self.running = Some((work, std::thread::spawn(move || plan(&problem))));
    }

    /// The sentence of an identification that has ended; starts the next if hits came meanwhile.
    fn finished(&mut self) -> Option<String> {
        let (_, running) = self.running.take_if(|(_, running)| running.is_finished())?;
        if std::mem::take(&mut self.again) {
            self.start();
        }
        running.join().ok()
    }

    fn stop(self) {
        if let Some((work, running)) = self.running {
            work.stop();
            // Its result is not waited for any more.
            let _ = running.join();
        }
    }
}

fn read_problem(path: &Path) -> Result<IdentificationProblem, Failure> {
    let document = super::read_document(path, FileKind::Problem)?;
    Ok(IdentificationProblem::of(document)?)
}

/// The best next hits by the identification of a problem.
fn plan(problem: &IdentificationProblem) -> String {
    let found = match identify(problem) {
        Ok(found) => found,
        Err(IdentificationError::Stopped(_)) => return "the identification was stopped".to_owned(),
        Err(error) => return format!("the identification failed: {error}"),
    };
    let Some(design) = found.design else { return "the problem has no design".to_owned() };
    let Some(best) = design.sequence.first() else {
        return "no measurement of the design can be simulated".to_owned();
    };
    let then: Vec<String> =
        design.sequence.iter().skip(1).map(|one| measurement(&one.kind)).collect();
    let then = if then.is_empty() { String::new() } else { format!(", then {}", then.join(", ")) };
    format!(
        "by the identification, next: {}, which leaves {:.0} % of the uncertainty of the law{then}",
        measurement(&best.kind),
        100.0 * best.remaining
    )
}
