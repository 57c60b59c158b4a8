//! The subcommands, one a file, and their common steps: reading the scenario, writing the results.

pub(crate) mod analyse;
pub(crate) mod check;
pub(crate) mod convert;
pub(crate) mod identify;
pub(crate) mod law;
pub(crate) mod modes;
pub(crate) mod schema;
pub(crate) mod simulate;
pub(crate) mod steady;
pub(crate) mod sweep;

use std::path::{Path, PathBuf};

use asperity_figure::{Figure, FigureError};
use asperity_scenario::{Document, Scenario};
use asperity_study::output::file_name::file_name;
use asperity_study::output::{OutputFolder, OutputRequest};
use serde_json::Value;
use tracing::info_span;

use crate::args::{Input, Output};
use crate::failure::Failure;

/// Reads the scenario and applies its changes, without checking it.
fn read(input: &Input) -> Result<Document, Failure> {
    let _span = info_span!("read").entered();
    let mut document = Document::read(&input.scenario)?;
    for argument in &input.set {
        let (pointer, value) = argument.split_once('=').ok_or_else(|| Failure::SetForm {
            argument: argument.clone(),
            accepted: "accepted: POINTER=VALUE, e.g. /excitation/peak_n=20",
        })?;
        document.set(pointer, value).map_err(|source| Failure::Set { source })?;
    }
    Ok(document)
}

/// The typed scenario of a document that is valid.
fn checked(document: &Document) -> Result<Scenario, Failure> {
    document.scenario().map_err(|source| Failure::Invalid {
        text: document.text().to_owned(),
        path: document.path().to_owned(),
        source,
    })
}

/// Results of `work` in a pool of `threads` threads, or of all cores.
fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, Failure> {
    asperity_study::sweep::on_threads(threads, work)
        .ok_or(Failure::Threads { threads: threads.unwrap_or_default() })
}

/// The folder that takes the result of a command.
struct ResultFolder(OutputFolder);

impl ResultFolder {
    /// Claims the folder of `output` for `command`, by default out/ and the name of the file `input`.
    fn claim(command: &str, input: &Path, output: &Output) -> Result<Self, Failure> {
        Self::claim_at(command, input, output.out.as_deref(), output.overwrite)
    }

    fn claim_at(
        command: &str,
        input: &Path,
        out: Option<&Path>,
        overwrite: bool,
    ) -> Result<Self, Failure> {
        let stem = input.file_stem().unwrap_or(input.as_os_str()).to_string_lossy();
        let name = || PathBuf::from("out").join(file_name(&stem));
        let folder = out.map_or_else(name, Path::to_owned);
        Ok(Self(OutputFolder::claim(&OutputRequest {
            folder: &folder,
            command,
            document: input,
            // Two files of one name, from two folders, have the same folder by default.
            replace_other_document: overwrite || out.is_some(),
            overwrite,
        })?))
    }

    /// Writes a file.
    fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), Failure> {
        let _span = info_span!("write", file = name).entered();
        self.0.write(name, contents)?;
        Ok(())
    }

    /// Place of a file until the result is finished.
    fn unfinished(&self, name: &str) -> Result<PathBuf, Failure> {
        Ok(self.0.unfinished(name)?)
    }

    /// Draws a figure as SVG. One that cannot be drawn is left out, with a warning.
    fn draw(&self, name: &str, figure: &Figure) -> Result<(), Failure> {
        let svg = info_span!("draw", file = name).in_scope(|| {
            figure.check()?;
            Ok::<String, FigureError>(figure.to_svg())
        });
        match svg {
            Ok(svg) => self.write(name, svg),
            Err(error) => {
                tracing::warn!("{name} cannot be drawn: {error}");
                Ok(())
            }
        }
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

/// JSON with indentation and a line break at its end.
fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}
