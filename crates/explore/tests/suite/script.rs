//! The script of the page is an ES module that parses.

use std::process::Command;

use crate::client::Page;

#[test]
fn scripts_parse() {
    let folder = tempfile::tempdir().unwrap();
    let page = Page::new();
    for name in ["explore.js", "figures.js"] {
        let place = folder.path().join(name).with_extension("mjs");
        std::fs::write(&place, page.get(name).body).unwrap();
        let Ok(output) = Command::new("node").arg("--check").arg(&place).output() else {
            eprintln!("skipped: node is not installed");
            return;
        };
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
