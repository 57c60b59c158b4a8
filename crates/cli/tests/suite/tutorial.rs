//! The tutorial of finite elements, run as it stands.

use std::path::Path;

use crate::{asperity, fixture, text};

/// Commands that take longer than a test may; nightly runs include them.
const LONG: [&str; 2] = ["steady", "sweep"];

/// Commands of the page on `asperity`, each with the lines that it prints there.
fn commands(page: &str) -> Vec<(Vec<String>, Vec<String>)> {
    let blocks = page.split("```console\n").skip(1);
    let blocks = blocks.map(|block| block.split_once("```").unwrap().0);
    let mut found: Vec<(Vec<String>, Vec<String>)> = Vec::new();
    for line in blocks.flat_map(str::lines) {
        if let Some(command) = line.strip_prefix("$ ") {
            let words = command.split_whitespace().map(|word| word.trim_matches('"').to_owned());
            found.push((words.collect(), Vec::new()));
        } else if let Some((_, printed)) = found.last_mut() {
            printed.push(line.to_owned());
        }
    }
    found.retain(|(words, _)| words[0] == "asperity");
    found
}

#[test]
fn the_tutorial_of_finite_elements_prints_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let source = fixture("structures/lap-joint");
    for file in ["lap.json", "lap.inp", "lap.dof", "lap.sti.gz", "lap.mas.gz"] {
        std::fs::copy(source.join(file), folder.path().join(file)).unwrap();
    }
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/tutorial/finite-elements.md");
    let commands = commands(&std::fs::read_to_string(Path::new(page)).unwrap());
    assert_eq!(commands.len(), 7);
    let is_long = std::env::var_os("ASPERITY_LONG").is_some();
    for (words, expected) in commands {
        if LONG.contains(&words[1].as_str()) && !is_long {
            continue;
        }
        let arguments: Vec<&str> = words[1..].iter().map(String::as_str).collect();
        let output = asperity(folder.path(), &arguments);
        assert!(output.status.success(), "{words:?}: {}", text(&output.stderr));
        let printed = text(&output.stdout);
        for line in expected {
            assert!(printed.contains(line.trim_end()), "{words:?}: no line `{line}` in\n{printed}");
        }
    }
    let shapes = std::fs::read_to_string(folder.path().join("out/modes/modes-1.svg")).unwrap();
    for frequency in ["226.6 Hz", "710.9 Hz", "989.6 Hz", "1702.8 Hz", "Motion over largest"] {
        assert!(shapes.contains(frequency), "{frequency}");
    }
    // Six instants, each with its time, and a time series of files that are there.
    let read =
        |name: &str| std::fs::read_to_string(folder.path().join("out/hit").join(name)).unwrap();
    let motion = read("motion-1.svg");
    assert_eq!(motion.matches(" ms<").count(), 6);
    assert!(motion.contains("Displacement (µm)"));
    let series = read("motion.pvd");
    let files = series.split("file=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    assert_eq!(files.clone().count(), 12);
    for file in files {
        assert!(read(file).contains("<VTKFile type=\"UnstructuredGrid\""), "{file}");
    }
    assert!(read("cells-history.svg").contains("Closure of cell (µm)"));
    assert!(read("cells-history.csv").starts_with("time_s,lap:3:pressure_pa,lap:3:closure_m,"));
}
