//! `asperity man`.

use std::fs;
use std::path::Path;

use clap::CommandFactory;

use crate::args::Args;
use crate::failure::Failure;

/// Writes the manual pages of the command and its subcommands into a folder.
pub(crate) fn run(folder: &Path, quiet: bool) -> Result<(), Failure> {
    let written =
        fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(Args::command(), folder));
    written.map_err(|source| Failure::Pages { folder: folder.to_owned(), source })?;
    if !quiet {
        answer_line!("manual pages written to {}", folder.display());
    }
    Ok(())
}
