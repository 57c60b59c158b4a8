//! Features of other packages that the workspace as a whole turns on; see `Cargo.toml`.
