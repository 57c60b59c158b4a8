//! Properties of parsers, laws and time steps for arbitrary bytes.
//!
//! | module | properties of |
//! |---|---|
//! | [`readers`] | files of measurements |
//! | [`documents`] | scenarios, `--set`, `--vary`, identification problems, force samples |
//! | [`laws`] | contact laws of any parameters |
//! | [`steps`] | both integrators on any small structure |
//! | [`numbers`] | numbers and laws from bytes |

pub mod documents;
pub mod laws;
pub mod numbers;
pub mod readers;
pub mod steps;
