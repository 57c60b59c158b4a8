//! The root of the checkout, and cargo there.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The cargo that runs this task, or else the one on the path, at the root of the workspace.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(workspace_root());
    command
}

/// The root of the checkout that this program runs in: cargo names the folder of xtask when it
/// runs it. Without cargo it is the current folder.
pub(crate) fn workspace_root() -> PathBuf {
    let own = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    own.as_deref().and_then(Path::parent).map_or_else(|| PathBuf::from("."), Path::to_owned)
}
