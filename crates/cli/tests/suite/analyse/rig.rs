//! Settings of a rig from a file.

use asperity_measure::{ChannelUnit, Format, Record};
use serde_json::{Value, json};

use super::exact::blows;
use super::hammer::{DAMPING, channel};
use super::store;
use crate::{answer, asperity};

/// Three channels in volts without names: acceleration at 100 mV/g, a thermometer, a force at
/// -2 mV/N.
fn record() -> Record {
    let [force, .., acceleration] = blows(DAMPING, &[20.0, 21.0, 19.0]);
    let volts = |samples: &[f64], factor: f64| samples.iter().map(|x| factor * x).collect();
    Record {
        channels: vec![
            channel("ai0", "V", volts(&acceleration, 0.1 / 9.80665)),
            channel("ai1", "V", vec![0.7; force.len()]),
            channel("ai2", "V", volts(&force, -2e-3)),
        ],
        ..Record::default()
    }
}

fn rig() -> Value {
    json!({
        "schema": "asperity/rig/1",
        "title": "guide bar",
        "channels": [
            {"name": "top", "sensitivity": "100mV/g"}, {}, {"name": "hammer", "sensitivity": "2mV/N"}
        ],
        "force": "hammer", "responses": ["top"], "flip_force": true,
        "band_hz": [700, 1000], "estimator": "hv", "window": "none", "pre_trigger_s": 0.01,
    })
}

/// A rig's file gives the analysis of its options on the command line, to the last byte; options win
/// over it, and the analysis records it.
#[test]
fn a_rig_stands_for_its_options() {
    let folder = tempfile::tempdir().unwrap();
    let file = store(folder.path(), "test.uff", record(), Format::UniversalBinary);
    std::fs::write(folder.path().join("rig.json"), rig().to_string()).unwrap();
    let by_options = [
        "analyse",
        &file,
        "--names",
        "top,,hammer",
        "--sensitivity",
        "#1=100mV/g",
        "--sensitivity",
        "#3=2mV/N",
        "--force",
        "hammer",
        "--response",
        "top",
        "--flip-force",
        "--band",
        "700:1000",
        "--estimator",
        "hv",
        "--window",
        "none",
        "--pre-trigger",
        "0.01",
        "--out",
        "a",
        "--json",
    ];
    let expected = answer(folder.path(), &by_options);
    let found =
        answer(folder.path(), &["analyse", &file, "--rig", "rig.json", "--out", "b", "--json"]);
    for key in ["hits", "average", "settings", "channels", "levels", "modes"] {
        assert_eq!(found[key], expected[key], "{key}");
    }
    assert_eq!(found["hits"].as_array().unwrap().len(), 3);
    let recorded = &found["provenance"]["rig"];
    assert_eq!(recorded["file"], "rig.json");
    assert_eq!(recorded["sha256"].as_str().unwrap().len(), 64);
    assert!(expected["provenance"].get("rig").is_none());

    let over = ["--estimator", "h1", "--sensitivity", "hammer=4mV/N", "--out", "c", "--json"];
    let other =
        answer(folder.path(), &[&["analyse", &file, "--rig", "rig.json"], &over[..]].concat());
    assert_eq!(other["settings"]["estimator"], "h1");
    let force = |of: &Value| of["hits"][0]["force_peak_n"].as_f64().unwrap();
    assert!((force(&other) / force(&found) - 0.5).abs() < 1e-6);

    // The same settings for the other commands that read measurements.
    let seen = answer(folder.path(), &["inspect", &file, "--rig", "rig.json", "--json"]);
    assert_eq!((&seen["force"]["channel"], &seen["response"]["channel"]), (&json!(3), &json!(1)));
    let converted = ["convert", &file, "named.uff", "--rig", "rig.json", "--json"];
    answer(folder.path(), &converted);
    let named = answer(folder.path(), &["inspect", "named.uff", "--json"]);
    assert_eq!(named["channels"][2]["name"], "hammer");
}

/// Every fault at its place in the text, with the accepted values; a file of another kind by name.
#[test]
fn faults_of_a_rig_are_shown_in_its_text() {
    let folder = tempfile::tempdir().unwrap();
    let file = store(folder.path(), "test.uff", record(), Format::UniversalBinary);
    let failed = |rig: &str| {
        std::fs::write(folder.path().join("rig.json"), rig).unwrap();
        let out = asperity(folder.path(), &["analyse", &file, "--rig", "rig.json"]);
        assert_eq!(out.status.code(), Some(2));
        String::from_utf8_lossy(&out.stderr).into_owned()
    };
    let mut faulty = rig();
    faulty["bandhz"] = json!([1, 2]);
    faulty["estimator"] = json!("h3");
    let message = failed(&faulty.to_string());
    for words in ["is not a valid file of settings of a rig: 2 problems", "band_hz", "\"hv\""] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let mut faulty = rig();
    faulty["window"] = json!("hann");
    faulty["channels"][0]["sensitivity"] = json!("100");
    faulty["channels"][1]["unit"] = json!("furlong");
    faulty["band_hz"] = json!([1000, 700]);
    let message = failed(&faulty.to_string());
    for words in [
        "4 problems",
        "/channels/0/sensitivity",
        "100mV/g",
        "force+exponential",
        "a band from 1000 to 700 Hz",
    ] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let message = failed(r#"{"schema": "asperity/scenario/1"}"#);
    assert!(message.contains("rig.json is a scenario; accepted: settings of a rig"), "{message}");
}

/// `inspect` writes settings that `analyse` reads, and keeps a file that exists.
#[test]
fn inspect_proposes_a_rig() {
    let folder = tempfile::tempdir().unwrap();
    let mut record = record();
    for (channel, (name, unit)) in
        record.channels.iter_mut().zip([("acc", "m/s^2"), ("t", "K"), ("hammer", "N")])
    {
        (channel.name, channel.unit) = (name.to_owned(), ChannelUnit::of_text(unit));
    }
    let file = store(folder.path(), "test.uff", record, Format::UniversalBinary);
    let asked = ["inspect", &file, "--write-rig", "rig.json"];
    assert!(asperity(folder.path(), &asked).status.success());
    let text = std::fs::read_to_string(folder.path().join("rig.json")).unwrap();
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&found["force"], &found["responses"]), (&json!("hammer"), &json!(["acc"])));
    assert_eq!(found["channels"][1], json!({"name": "t"}));
    let analysed = ["analyse", &file, "--rig", "rig.json", "--flip-force", "--out", "a", "--json"];
    assert_eq!(answer(folder.path(), &analysed)["channels"][0]["name"], "hammer");

    let again = asperity(folder.path(), &asked);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("rig.json exists"));
    assert!(asperity(folder.path(), &[&asked[..], &["--overwrite"]].concat()).status.success());

    let schema = asperity(folder.path(), &["schema", "--rig"]);
    let schema: Value = serde_json::from_slice(&schema.stdout).unwrap();
    assert!(schema["properties"]["channels"].is_object());
}
