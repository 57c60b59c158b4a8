//! The figures that the subcommands write, from the same numbers as their tables.

mod analysis;
mod identification;
mod response;
mod steady;
mod structure;
mod sweep;

pub(crate) use analysis::figures;
pub(crate) use identification::{identification, identification_report};
pub(crate) use response::{frf, history};
pub(crate) use steady::steady;
pub(crate) use structure::{laws, modes};
pub(crate) use sweep::sweep;
