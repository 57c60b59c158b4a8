//! The script of the page parses, and does what it should in a browser.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use asperity_explore::{ExploreOptions, Explorer};
use asperity_scenario::Document;
use asperity_simulation::run::simulate;
use serde_json::Value;

use crate::client::{Page, changed};

#[test]
fn scripts_parse() {
    let folder = tempfile::tempdir().unwrap();
    let page = Page::new();
    for name in ["explore.js", "figures.js"] {
        let place = folder.path().join(name).with_extension("mjs");
        std::fs::write(&place, page.get(name).body).unwrap();
        let Ok(output) = Command::new("node").arg("--check").arg(&place).output() else {
            return skipped("node");
        };
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

/// Says what is not installed; fails where the browser is a condition, as in the workflow.
#[allow(clippy::print_stderr, reason = "a test says that it was skipped")]
fn skipped(what: &str) {
    let required = std::env::var("ASPERITY_BROWSER").is_ok_and(|value| value == "required");
    assert!(!required, "{what} is not installed");
    eprintln!("skipped: {what} is not installed");
}

/// A browser, which ends with it.
struct Browser(Child);

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A browser and the address of its debugging protocol; none where there is no browser.
fn browser(profile: &Path) -> Option<(Browser, String)> {
    let child = ["chromium", "google-chrome", "chromium-browser"].into_iter().find_map(|name| {
        Command::new(name)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1280,720"])
            .arg("--remote-debugging-port=0")
            .arg(format!("--user-data-dir={}", profile.display()))
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .ok()
    });
    let mut child = child?;
    let mut lines = BufReader::new(child.stderr.take()?).lines().map_while(Result::ok);
    let address =
        lines.find_map(|line| line.strip_prefix("DevTools listening on ").map(str::to_owned));
    // Read to the end, so that the browser never waits.
    std::thread::spawn(move || lines.count());
    Some((Browser(child), address?))
}

/// The report of a script of this folder on what it saw in the browser; none without the program that runs it.
fn driven(script: &str, arguments: &[&str]) -> Option<Value> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite").join(script);
    let mut node = Command::new("node");
    node.args(["--experimental-websocket", "--no-warnings"]).arg(script).args(arguments);
    let output = node.output().ok()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

/// A slider, undo, reload, a dragged point of a law, a fault, a drawn force and saved files, in a browser under the policy of
/// the page; the numbers shown are those of the saved scenario.
#[test]
fn a_browser_moves_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let rig = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/scenarios/nouira2020-modified.json");
    let mut document = Document::read(rig).unwrap();
    document.set("/method", "\"modal\"").unwrap();
    let mut options = ExploreOptions::default();
    let out = folder.path().join("out");
    options.out = Some(out.clone());
    let page = Page::of_document(document, &options);
    let Some((_browser, address)) = browser(&folder.path().join("profile")) else {
        return skipped("Chromium");
    };
    let Some(seen) = driven("drive.mjs", &[&address, &page.url()]) else {
        return skipped("node");
    };
    let of = |step: &str, what: &str| seen[step][what].as_str().unwrap().to_owned();
    assert_eq!(of("start", "force"), "32");
    let force: f64 = of("slid", "force").parse().unwrap();
    assert!(force > 40.0, "{seen}");
    assert_ne!(of("slid", "words"), of("start", "words"));
    assert_eq!(of("undone", "force"), "32");
    for step in ["redone", "reloaded", "knot"] {
        assert_eq!(of(step, "force"), of("slid", "force"), "{step}");
    }
    assert!(of("knot", "hash").contains("/laws/modified/knots/1="), "{}", of("knot", "hash"));
    assert!(seen["fault"].as_str().unwrap().contains("/excitation/rise_s"), "{seen}");
    let points =
        |step: &str| -> Vec<[f64; 2]> { serde_json::from_value(seen[step].clone()).unwrap() };
    let stroke = points("stroke");
    // A stroke begins and ends without a force, and has the points between; undo takes it back at once.
    assert!(stroke.len() == 7 && seen["before"].is_null(), "{seen}");
    assert!(
        stroke[0][1] == 0.0 && stroke[6][1] == 0.0 && stroke.iter().all(|point| point[1] >= 0.0)
    );
    assert!(stroke.windows(2).all(|pair| pair[1][0] > pair[0][0]), "{stroke:?}");
    let (raised, removed) = (points("raised"), points("removed"));
    assert!(raised[2][1] > stroke[2][1] && raised[2][0] == stroke[2][0], "{raised:?}");
    assert_eq!(removed, [&raised[..2], &raised[3..]].concat());
    // The last line has the time of the run.
    let words = |step: &str| {
        of(step, "words").lines().filter(|line| !line.starts_with("run ")).collect::<String>()
    };
    assert_ne!(words("drawn"), words("knot"));
    assert_eq!(words("again"), words("typed"));
    let saved = Document::read(out.join("scenario.json")).unwrap();
    let mut typed = removed;
    typed[1][1] = 17.5;
    let kept: Vec<[f64; 2]> =
        serde_json::from_value(saved.value()["excitation"]["points"].clone()).unwrap();
    assert_eq!(kept, typed, "{seen}");
    let run = simulate(&saved, &saved.scenario().unwrap()).unwrap();
    let words = asperity_plot::run_words(&run.summary);
    for line in words.lines().filter(|line| !line.starts_with("run ")) {
        assert!(of("saved", "words").contains(line), "{line}: {seen}");
    }
}

/// The page in a frame of another page, which carries its requests: as in a notebook.
#[test]
fn a_frame_has_the_same_page() {
    let folder = tempfile::tempdir().unwrap();
    let page = Page::new();
    let framed = folder.path().join("framed.html");
    std::fs::write(&framed, Explorer::framed_page()).unwrap();
    let Some((_browser, address)) = browser(&folder.path().join("profile")) else {
        return skipped("Chromium");
    };
    let Some(seen) = driven("frame.mjs", &[&address, &page.url(), framed.to_str().unwrap()]) else {
        return skipped("node");
    };
    for (step, document) in [
        ("start", changed("/excitation/peak_n", "5")),
        ("changed", changed("/excitation/peak_n", "7.5")),
    ] {
        let run = simulate(&document, &document.scenario().unwrap()).unwrap();
        let words = asperity_plot::run_words(&run.summary);
        for line in words.lines().filter(|line| !line.starts_with("run ")) {
            assert!(seen[step].as_str().unwrap().contains(line), "{line}: {seen}");
        }
    }
    assert_ne!(seen["start"], seen["changed"]);
    assert_eq!(seen["pictures"], 3);
}

/// Contrast, names, keyboard and sizes as the Web Content Accessibility Guidelines 2.2 ask at level AA: in light and dark, at
/// 1280 x 720 and on a tablet held either way.
#[test]
fn the_page_is_accessible() {
    let folder = tempfile::tempdir().unwrap();
    let page = Page::new();
    let Some((_browser, address)) = browser(&folder.path().join("profile")) else {
        return skipped("Chromium");
    };
    let Some(seen) = driven("accessible.mjs", &[&address, &page.url()]) else {
        return skipped("node");
    };
    for screen in seen["screens"].as_array().unwrap() {
        let of = |what: &str| screen[what].as_array().unwrap().is_empty();
        assert!(screen["texts"].as_u64().unwrap() > 50 && of("faint"), "{screen}");
        assert!(screen["overflow"].as_f64().unwrap() <= 0.0, "{screen}");
        // Fingers need larger places than pointers.
        assert!(screen["touch"] == false || (screen["coarse"] == true && of("small")), "{screen}");
    }
    assert!(seen["named"].as_u64().unwrap() > 20, "{seen}");
    for what in ["nameless", "unmarked", "missed"] {
        assert_eq!(seen[what], serde_json::json!([]), "{what}");
    }
    assert!(seen["slid"] == true && seen["shown"] == "true", "{}", seen["shown"]);
}
