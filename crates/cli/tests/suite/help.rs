//! Completions and manual pages cover every command; wrong options and files are named in words.

use std::path::Path;

use crate::{asperity, files, fixture, text};

/// Subcommands that the help lists, `help` included, each with its long options.
fn commands() -> Vec<(String, Vec<String>)> {
    let here = Path::new(".");
    let overview = text(&asperity(here, &["--help"]).stdout);
    let listed = overview.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = listed
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| Some(line.split_whitespace().next()?.to_owned()));
    let options = |name: &String| {
        let help = text(&asperity(here, &["help", name]).stdout);
        let words = help.lines().map(|line| line.trim_start().trim_start_matches("-h, "));
        let long = words.filter(|line| line.starts_with("--"));
        let word = |line: &str| line.split([' ', ',', '=']).next().unwrap_or(line).to_owned();
        long.map(word).collect::<Vec<String>>()
    };
    let found: Vec<_> = names.map(|name| (name.clone(), options(&name))).collect();
    assert!(found.len() >= 12, "{found:?}");
    assert!(found.iter().any(|(name, options)| name == "analyse" && options.len() > 15));
    found
}

#[test]
fn completions_cover_every_command_and_option() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let output = asperity(Path::new("."), &["completions", shell]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let script = text(&output.stdout);
        for (command, options) in commands() {
            assert!(script.contains(&command), "{shell}: {command}");
            for option in options {
                // Fish writes long options without their dashes.
                let name = option.trim_start_matches('-');
                assert!(script.contains(name), "{shell}: {command} {option}");
            }
        }
    }
    let refused = asperity(Path::new("."), &["completions", "cmd"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("zsh"), "{}", text(&refused.stderr));
}

#[test]
fn a_manual_page_describes_every_command_with_its_options() {
    let folder = tempfile::tempdir().unwrap();
    let output = asperity(folder.path(), &["man", "man1"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let pages = folder.path().join("man1");
    let mut expected = vec!["asperity.1".to_owned()];
    for (command, options) in commands().into_iter().filter(|(command, _)| command != "help") {
        let name = format!("asperity-{command}.1");
        // In roff a hyphen within words is `\-`.
        let page = std::fs::read_to_string(pages.join(&name)).unwrap().replace("\\-", "-");
        for option in options {
            assert!(page.contains(&option), "{name}: {option}");
        }
        expected.push(name);
    }
    // Parts of commands have pages of their own.
    expected.extend(
        ["answers", "merge", "slurm", "unfinished"].map(|part| format!("asperity-study-{part}.1")),
    );
    expected.sort();
    assert_eq!(files(&pages), expected);
}

/// The messages of a request that is wrong.
fn refusal(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = asperity(folder.path(), arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stderr));
    assert!(files(folder.path()).is_empty(), "{arguments:?}");
    text(&output.stderr)
}

#[test]
fn a_file_of_another_kind_is_named_with_the_command_that_reads_it() {
    let scenario = fixture("scenarios/nouira2020-modified.json").display().to_string();
    let problem = fixture("problems/twin.json").display().to_string();
    let folder = tempfile::tempdir().unwrap();
    let measured = folder.path().join("hit.csv").display().to_string();
    std::fs::write(&measured, "time,force\n0,1\n1,2\n").unwrap();
    let result = folder.path().join("analysis.json").display().to_string();
    std::fs::write(&result, r#"{"schema": "asperity/analysis/1"}"#).unwrap();
    for (arguments, kind, command) in [
        (vec!["simulate", &problem], "a problem of `asperity identify`", "asperity identify"),
        (vec!["check", &problem], "a problem of `asperity identify`", "asperity identify"),
        (vec!["identify", &scenario], "is a scenario; accepted: a problem", "asperity simulate"),
        (vec!["analyse", &scenario], "is a scenario; accepted: measurements", "asperity simulate"),
        (vec!["convert", &scenario, "out.npz"], "is a scenario", "asperity simulate"),
        (vec!["modes", &measured], "is measurements; accepted: a scenario", "asperity analyse"),
        (vec!["identify", &result], "is a result of `asperity analyse`", "accepted: a problem"),
    ] {
        let message = refusal(&arguments);
        assert!(message.contains(kind) && message.contains(command), "{message}");
        assert!(message.lines().count() <= 2, "{message}");
    }
}

#[test]
fn a_refused_value_is_said_once() {
    for (arguments, said) in [
        (["analyse", "hit.uff", "--band", "5"], "error: --band: the band is `5`; accepted: LO:HI"),
        (["analyse", "hit.uff", "--hits", "0"], "error: --hits: the number of hits is `0`"),
    ] {
        let message = refusal(&arguments);
        assert!(message.starts_with(said), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn force_without_a_channel_points_to_overwrite() {
    let message = refusal(&["analyse", "hit.uff", "--force"]);
    assert!(message.contains("hint: --force selects the channel"), "{message}");
    assert!(message.contains("--overwrite"), "{message}");
}

#[test]
fn a_negative_number_is_the_value_of_its_option() {
    let scenario = fixture("scenarios/nouira2020-modified.json").display().to_string();
    let shaker = ["steady", &scenario, "--amplitude", "-1", "--from", "700", "--to", "900"];
    let message = refusal(&shaker);
    assert!(message.contains("-1") && message.contains("positive"), "{message}");
}

#[test]
fn figures_are_written_in_the_formats_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = fixture("scenarios/nouira2020-modified.json").display().to_string();
    let law = ["law", &scenario, "--out", "law", "--figures", "png,pdf,svg,pdf"];
    let output = asperity(folder.path(), &law);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let read = |name: &str| std::fs::read(folder.path().join("law").join(name)).unwrap();
    assert!(read("law.svg").starts_with(b"<svg"));
    assert!(read("law.pdf").starts_with(b"%PDF-1.7"));
    assert!(read("law.png").starts_with(b"\x89PNG"));
    // 170 mm at 300 dpi.
    let width =
        read("law.png")[16..20].iter().fold(0, |width, byte| 256 * width + u32::from(*byte));
    assert_eq!(width, 2008);
    let only = ["law", &scenario, "--out", "only", "--figures", "pdf"];
    assert!(asperity(folder.path(), &only).status.success());
    let written = files(&folder.path().join("only"));
    assert!(written.contains(&"law.pdf".to_owned()) && !written.contains(&"law.svg".to_owned()));
}

#[test]
fn magnitudes_have_the_axis_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = fixture("scenarios/nouira2020-modified.json").display().to_string();
    for (axis, label) in [("linear", "Receptance ("), ("log", "(m/N)"), ("db", "dB re 1 m/N")] {
        let run = [
            "simulate",
            &scenario,
            "--out",
            axis,
            "--magnitude",
            axis,
            "--set",
            "/duration_s=0.04",
        ];
        let output = asperity(folder.path(), &run);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let svg = std::fs::read_to_string(folder.path().join(axis).join("frf.svg")).unwrap();
        assert!(svg.contains(label) && svg.contains("Phase (°)"), "{axis}");
        assert_eq!(axis == "db", svg.contains("dB re"), "{axis}");
    }
}
