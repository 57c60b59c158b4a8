//! Code of the README files and the book, compiled and run as doc tests.
#![cfg(doctest)]

macro_rules! documents {
    ($($name:ident: $path:literal),* $(,)?) => {
        $(#[doc = include_str!(concat!("../../", $path))] mod $name {})*
    };
}

documents! {
    law: "crates/law/README.md",
    mesh: "crates/mesh/README.md",
    structure: "crates/structure/README.md",
    dynamics: "crates/dynamics/README.md",
    harmonic: "crates/harmonic/README.md",
    signal: "crates/signal/README.md",
    measure: "crates/measure/README.md",
    inference: "crates/inference/README.md",
    table: "crates/table/README.md",
    scenario: "crates/scenario/README.md",
    experiment: "crates/experiment/README.md",
    simulation: "crates/simulation/README.md",
    identify: "crates/identify/README.md",
    figure: "crates/figure/README.md",
    asperity: "crates/asperity/README.md",
    use_one_crate: "docs/src/how-to/use-one-crate.md",
}
