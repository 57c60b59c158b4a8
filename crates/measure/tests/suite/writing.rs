//! Written files are complete and have the layout that other tools expect.

use asperity_measure::{
    Abscissa, ChannelQuantity, Complex64, DegreeOfFreedom, Format, MeasureError, ReadOptions,
    Samples, WriteOptions, read, write,
};

use crate::build::{channel, record};

const WRITABLE: [Format; 4] =
    [Format::UniversalText, Format::UniversalBinary, Format::Text, Format::Npz];

#[test]
fn a_universal_file_byte_by_byte() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hit.uff");
    let mut force = channel("hammer", "N", 51_200.0, vec![1.5, -2.0, 0.0, 4.0, 1e-3]);
    force.origin.response = Some(DegreeOfFreedom { entity: "BEAM".into(), node: 7, direction: -3 });
    let options =
        WriteOptions { title: "beam".into(), date: "2026-11-01".into(), ..WriteOptions::default() };
    write(&path, &[record(vec![force])], Format::UniversalText, &options).unwrap();
    let text = std::fs::read_to_string(path).unwrap();
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    // The columns of the description of the format.
    assert_eq!(&lines[..3], ["    -1", "   151", "beam"]);
    assert_eq!(
        &lines[9..13],
        ["    -1", "    -1", "   164", "         1SI: Meter (newton)           2",]
    );
    assert_eq!(
        &lines[13..16],
        [
            "   1.0000000000000000D+00   1.0000000000000000D+00   1.0000000000000000D+00",
            "   2.7314999999999998D+02",
            "    -1"
        ]
    );
    assert_eq!(
        &lines[16..],
        [
            "    -1",
            "    58",
            "hammer",
            "NONE",
            "NONE",
            "NONE",
            "NONE",
            "    1         0    1         0 BEAM               7  -3 NONE               0   0",
            "         4         5         1  0.00000e+00 1.953125e-05  0.00000e+00",
            "        17    0    0    0 Time                 s",
            "        13    0    0    0 Force                N",
            "         0    0    0    0 NONE                 NONE",
            "         0    0    0    0 NONE                 NONE",
            "  1.500000000000e+00 -2.000000000000e+00  0.000000000000e+00  4.000000000000e+00",
            "  1.000000000000e-03",
            "    -1"
        ]
    );
}

#[test]
fn text_begins_with_names_and_units() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hit.csv");
    let channels = vec![
        channel("hammer", "N", 4.0, vec![1.5, -2.0]),
        channel("top, left", "g", 4.0, vec![1e-7, 3.0]),
        channel("raw", "NONE", 4.0, vec![0.0, 1.0]),
    ];
    write(&path, &[record(channels)], Format::Text, &WriteOptions::default()).unwrap();
    assert_eq!(
        std::fs::read_to_string(path).unwrap(),
        "time_s,hammer [N],\"top, left [g]\",raw\n0,1.5,1e-7,0\n0.25,-2,3,1\n"
    );
}

#[test]
fn a_failed_write_keeps_the_existing_file() {
    let options = WriteOptions { replace: true, ..WriteOptions::default() };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept");
    std::fs::write(&path, "as it was").unwrap();
    let mut bad = channel("bad", "N", 1.0, vec![1.0, 2.0]);
    bad.abscissa = Abscissa::Uneven { values: vec![0.0], quantity: ChannelQuantity::Time };
    let mut order = channel("order", "N", 1.0, vec![1.0, 2.0]);
    order.abscissa = Abscissa::Even { start: 0.0, step: 1.0, quantity: ChannelQuantity::Unknown };
    let good = channel("good", "N", 1.0, vec![1.0, 2.0]);
    let long = channel(&"n".repeat(81), "N", 1.0, vec![1.0, 2.0]);
    let brackets = channel("a [b] c [", "N", 1.0, vec![1.0, 2.0]);
    for (format, channel) in [
        (Format::UniversalText, &bad),
        (Format::UniversalBinary, &long),
        (Format::Text, &order),
        (Format::Text, &brackets),
        (Format::Npz, &order),
        (Format::Npz, &brackets),
    ] {
        // The error occurs after part of the file has been written.
        let records = [record(vec![good.clone(), channel.clone()])];
        let records =
            if channel.name == "order" { &[record(vec![channel.clone()])] } else { &records };
        let error = write(&path, records, format, &options).unwrap_err();
        assert!(
            matches!(&error, MeasureError::NotExpressible { format: told, .. } if *told == format),
            "{error}"
        );
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "as it was");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file stays");
    }
    let nowhere = folder.path().join("none/file");
    let records = [record(vec![good.clone()])];
    for format in WRITABLE {
        assert!(matches!(
            write(&nowhere, &records, format, &options),
            Err(MeasureError::Io { .. })
        ));
    }
    let refused = write(&path, &records, Format::Wav, &options).unwrap_err();
    assert!(matches!(refused, MeasureError::Unsupported { .. }));
    let two = [record(vec![good.clone()]), record(vec![good])];
    let refused = write(&path, &two, Format::Text, &options).unwrap_err();
    assert!(refused.to_string().contains("text holds one record"), "{refused}");
}

/// Unfinished files that no run has locked are those of killed runs.
#[test]
fn unfinished_files_of_killed_runs_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let names =
        [".hit.csv.asperity-dead.tmp", ".hit.csv.asperity-live.tmp", ".hit.uff.asperity-a.tmp"];
    for name in names {
        std::fs::write(place(name), "half a fi").unwrap();
    }
    let live = std::fs::File::open(place(names[1])).unwrap();
    live.lock().unwrap();
    let good = record(vec![channel("good", "N", 1.0, vec![1.0, 2.0])]);
    write(&place("hit.csv"), &[good], Format::Text, &WriteOptions::default()).unwrap();
    let left = names.map(|name| place(name).exists());
    assert_eq!(left, [false, true, true], "dead, live and of another file");
}

#[test]
fn an_existing_file_is_kept_unless_it_is_to_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hit.csv");
    std::fs::write(&path, "as it was").unwrap();
    let records = [record(vec![channel("good", "N", 1.0, vec![1.0, 2.0])])];
    for format in WRITABLE {
        let refused = write(&path, &records, format, &WriteOptions::default()).unwrap_err();
        assert!(matches!(refused, MeasureError::Exists { .. }), "{refused}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "as it was");
    }
    let replacing = WriteOptions { replace: true, ..WriteOptions::default() };
    write(&path, &records, Format::Text, &replacing).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("time_s,good"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file stays");
}

#[cfg(unix)]
#[test]
fn links_stay_and_only_regular_files_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let good = [record(vec![channel("good", "N", 1.0, vec![1.0, 2.0])])];
    let options = WriteOptions { replace: true, ..WriteOptions::default() };
    std::fs::write(place("disk.csv"), "as it was").unwrap();
    std::os::unix::fs::symlink(place("disk.csv"), place("hit.csv")).unwrap();
    write(&place("hit.csv"), &good, Format::Text, &options).unwrap();
    assert!(std::fs::symlink_metadata(place("hit.csv")).unwrap().is_symlink());
    assert!(std::fs::read_to_string(place("disk.csv")).unwrap().starts_with("time_s,good"));
    let _socket = std::os::unix::net::UnixListener::bind(place("device")).unwrap();
    let refused = write(&place("device"), &good, Format::Text, &options).unwrap_err();
    assert!(refused.to_string().contains("regular file"), "{refused}");
}

#[test]
fn complex_samples_cannot_be_written_as_text() {
    let folder = tempfile::tempdir().unwrap();
    let mut spectrum = channel("spectrum", "N", 1.0, vec![]);
    spectrum.samples = Samples::Complex(vec![Complex64::new(1.0, 2.0)]);
    let error = write(
        &folder.path().join("x"),
        &[record(vec![spectrum])],
        Format::Text,
        &WriteOptions::default(),
    );
    assert!(error.unwrap_err().to_string().contains("its samples are complex"));
}

/// Blocks of a long measurement are written as one record.
#[test]
fn records_that_continue_are_joined() {
    let folder = tempfile::tempdir().unwrap();
    let values: Vec<f64> = (0..10).map(f64::from).collect();
    let mut blocks = Vec::new();
    for (index, part) in values.chunks(3).enumerate() {
        let mut block = record(vec![channel("a", "g", 2.0, part.to_vec())]);
        block.continues = index > 0;
        block.channels[0].abscissa = Abscissa::even_time(1.5 * index as f64, 2.0);
        blocks.push(block);
    }
    for format in WRITABLE {
        let path = folder.path().join(format!("joined {format:?}"));
        write(&path, &blocks, format, &WriteOptions::default()).unwrap();
        let measured = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(measured.records.len(), 1, "{format}");
        let channel = &measured.records[0].channels[0];
        assert_eq!(channel.samples.real(), Some(&values[..]), "{format}");
        assert_eq!(channel.sample_rate_hz(), Some(2.0), "{format}");
    }
}
