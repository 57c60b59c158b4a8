//! The subcommands, one a file, and their common steps: reading the scenario, writing the results.

pub(crate) mod analyse;
pub(crate) mod check;
pub(crate) mod completions;
pub(crate) mod convert;
pub(crate) mod decay;
pub(crate) mod explore;
pub(crate) mod identify;
pub(crate) mod inspect;
pub(crate) mod law;
pub(crate) mod man;
pub(crate) mod modes;
mod patches;
pub(crate) mod schema;
mod shown;
pub(crate) mod simulate;
pub(crate) mod steady;
pub(crate) mod study;
pub(crate) mod sweep;
pub(crate) mod watch;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity_figure::Figure;
use asperity_scenario::{Document, Scenario};
use asperity_simulation::assemble::Assembly;
use asperity_simulation::output::file_name::file_name;
use asperity_simulation::output::{OutputFolder, OutputRequest};
use asperity_simulation::plausibility::plausibility_notes;
use serde_json::Value;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use tracing::info_span;

use crate::args::analyse::AnalysisOutput;
use crate::args::figures::FigureFormat;
use crate::args::{Input, Output};
use crate::failure::{Failure, INTERRUPTED};
use crate::file_kind::{FileKind, check_document, check_name};

/// Reads the scenario and applies its changes, without checking it.
fn read(input: &Input) -> Result<Document, Failure> {
    let _span = info_span!("read").entered();
    let mut document = read_document(&input.scenario, FileKind::Scenario)?;
    for argument in &input.set {
        let (pointer, value) = argument.split_once('=').ok_or_else(|| Failure::SetForm {
            argument: argument.clone(),
            accepted: "accepted: POINTER=VALUE, e.g. /excitation/peak_n=20",
        })?;
        document.set(pointer, value).map_err(|source| Failure::Set { source })?;
    }
    Ok(document)
}

/// Reads a JSON document that is of this kind, or does not name its kind.
pub(crate) fn read_document(path: &Path, kind: FileKind) -> Result<Document, Failure> {
    check_name(path, kind)?;
    let document = Document::read(path)?;
    check_document(path, document.value(), kind)?;
    Ok(document)
}

/// Refuses a structure of matrices where bars alone are taken.
fn of_bars(document: &Document) -> Result<(), Failure> {
    if document.has_matrices() {
        return Err(Failure::OfMatrices { path: document.path().to_owned() });
    }
    Ok(())
}

/// The typed scenario of a document that is valid.
fn checked(document: &Document) -> Result<Scenario, Failure> {
    of_bars(document)?;
    document.scenario().map_err(|source| Failure::Invalid {
        kind: "scenario",
        text: document.text().to_owned(),
        path: document.path().to_owned(),
        source,
    })
}

/// Shows the values of an assembled scenario that are possible and unusual.
fn show_unusual_values(assembly: &Assembly, quiet: bool) {
    if !quiet {
        crate::progress::show_notices(plausibility_notes(assembly));
    }
}

/// Results of `work` in a pool of `threads` threads, or of all cores.
fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, Failure> {
    asperity_simulation::sweep::on_threads(threads, work)
        .ok_or(Failure::Threads { threads: threads.unwrap_or_default() })
}

/// Sets the flag at the first Ctrl-C, or request to terminate; the second ends the command at once.
fn stop_on_signals(stop: &Arc<AtomicBool>) {
    for signal in [SIGINT, SIGTERM] {
        let registered =
            flag::register_conditional_shutdown(signal, INTERRUPTED.into(), Arc::clone(stop))
                .and_then(|_| flag::register(signal, Arc::clone(stop)));
        if let Err(error) = registered {
            tracing::debug!("signal {signal} ends the command at once: {error}");
        }
    }
}

/// Pixels a millimetre of a figure as PNG: 300 dpi.
const PIXELS_PER_MM: f64 = 300.0 / 25.4;

/// The folder that takes the result of a command, and the formats of its figures.
struct ResultFolder(OutputFolder, Vec<FigureFormat>);

impl ResultFolder {
    /// Claims the folder of `output` for `command`, by default out/ and the name of the file `input`,
    /// for `steady` with `-steady`.
    fn claim(command: &str, input: &Path, output: &Output) -> Result<Self, Failure> {
        Self::claim_at(
            command,
            input,
            output.out.as_deref(),
            output.overwrite,
            &output.figures.figures,
        )
    }

    /// Claims the folder of an analysis; `replaces_own` where the command has written to it before.
    fn claim_analysis(
        command: &str,
        input: &Path,
        output: &AnalysisOutput,
        replaces_own: bool,
    ) -> Result<Self, Failure> {
        let overwrite = output.overwrite || replaces_own;
        Self::claim_at(command, input, output.out.as_deref(), overwrite, &output.figures.figures)
    }

    fn claim_at(
        command: &str,
        input: &Path,
        out: Option<&Path>,
        overwrite: bool,
        figures: &[FigureFormat],
    ) -> Result<Self, Failure> {
        let stem = input.file_stem().unwrap_or(input.as_os_str()).to_string_lossy();
        // Its summary would replace that of `simulate`.
        let ending = if command == "steady" { "-steady" } else { "" };
        let name = || PathBuf::from("out").join(file_name(&format!("{stem}{ending}")));
        let is_measured = matches!(command, "analyse" | "decay" | "identify");
        let folder = out.map_or_else(name, Path::to_owned);
        let claimed = OutputFolder::claim(&OutputRequest {
            folder: &folder,
            command,
            document: input,
            // Two files of one name, from two folders, have the same folder by default; measured results
            // are not computed again as easily.
            replace_other_document: overwrite || out.is_some() && !is_measured,
            overwrite,
        })?;
        Ok(Self(claimed, figures.to_vec()))
    }

    /// The folder for a result that is `how` ("stopped", "partial"): this folder, or, if its earlier result is
    /// finished, one beside it whose name ends in `how`.
    ///
    /// - `(command, summary)`: the command that writes and the file that tells whether its earlier result
    ///   `is_finished`.
    fn beside_finished(
        self,
        how: &str,
        is_finished: impl FnOnce(&Value) -> bool,
        (command, summary): (&str, &str),
        input: &Path,
        output: &Output,
    ) -> Result<Self, Failure> {
        let earlier = self.earlier(summary).and_then(|file| std::fs::read(file).ok());
        let earlier = serde_json::from_slice(&earlier.unwrap_or_default()).unwrap_or_default();
        if !is_finished(&earlier) {
            return Ok(self);
        }
        let mut name = self.0.path().file_name().unwrap_or_default().to_os_string();
        name.push(format!("-{how}"));
        let beside = self.0.path().with_file_name(name);
        crate::progress::show_line(&format!(
            "{} keeps its finished result; the result of the {how} run is written to {}",
            self.0.path().display(),
            beside.display()
        ));
        let figures = &output.figures.figures;
        Self::claim_at(command, input, Some(&beside), output.overwrite, figures)
    }

    /// Writes a file.
    fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), Failure> {
        let _span = info_span!("write", file = name).entered();
        self.0.write(name, contents)?;
        Ok(())
    }

    /// The file `name` of the command's earlier result; `None` without one.
    fn earlier(&self, name: &str) -> Option<PathBuf> {
        self.0.earlier(name)
    }

    /// Place of a file until the result is finished.
    fn unfinished(&self, name: &str) -> Result<PathBuf, Failure> {
        Ok(self.0.unfinished(name)?)
    }

    /// Draws a figure as `stem.svg` and in the other formats asked for. One that cannot be drawn is
    /// left out, with a warning.
    fn draw(&self, stem: &str, figure: &Figure) -> Result<(), Failure> {
        for (name, data) in drawn(stem, figure, &self.1) {
            self.write(&name, data)?;
        }
        Ok(())
    }

    /// Writes the answer of a command, puts the result in place, and prints the answer where `print`
    /// is set. Returns the folder.
    fn finish(self, name: &str, answer: &Value, print: bool) -> Result<PathBuf, Failure> {
        let text = pretty(answer);
        let folder = {
            let _span = info_span!("write", file = name).entered();
            self.0.finish(name, &text)?
        };
        if print {
            answer!("{text}");
        }
        Ok(folder)
    }
}

/// A figure as `stem.svg` and in the other formats asked for, as files with their names. One that
/// cannot be drawn is left out, with a warning.
fn drawn(stem: &str, figure: &Figure, formats: &[FigureFormat]) -> Vec<(String, Vec<u8>)> {
    let mut formats = formats.to_vec();
    formats.sort_unstable();
    formats.dedup();
    let mut files = Vec::new();
    for format in formats {
        let name = match format {
            FigureFormat::Svg => format!("{stem}.svg"),
            FigureFormat::Pdf => format!("{stem}.pdf"),
            FigureFormat::Png => format!("{stem}.png"),
        };
        let drawn = info_span!("draw", file = name).in_scope(|| match format {
            FigureFormat::Svg => figure.check().map(|()| figure.to_svg().into_bytes()),
            FigureFormat::Pdf => figure.to_pdf(),
            FigureFormat::Png => figure.to_png(PIXELS_PER_MM),
        });
        match drawn {
            Ok(data) => files.push((name, data)),
            Err(error) => tracing::warn!("{name} cannot be drawn: {error}"),
        }
    }
    files
}

/// JSON with indentation and a line break at its end.
pub(crate) fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}
