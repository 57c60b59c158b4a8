//! The program `asperity`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(asperity_cli::run(std::env::args_os()))
}
