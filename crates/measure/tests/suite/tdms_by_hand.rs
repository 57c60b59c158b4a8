//! TDMS files of a few bytes, from "TDMS File Format Internal Structure".

use asperity_measure::{Abscissa, ChannelQuantity, MeasureError, Notice, ReadOptions, read_bytes};

use crate::build::{error_of, parsed, samples};

const METADATA: u32 = 2;
const RAW: u32 = 8;
const NEW_LIST: u32 = 4;
const ALL: u32 = METADATA | RAW | NEW_LIST;

fn text(value: &str) -> Vec<u8> {
    [&u32::try_from(value.len()).unwrap().to_le_bytes(), value.as_bytes()].concat()
}

/// A property that is a double.
fn number(name: &str, value: f64) -> Vec<u8> {
    [&text(name)[..], &10_u32.to_le_bytes(), &value.to_le_bytes()].concat()
}

/// A property that is a string.
fn string(name: &str, value: &str) -> Vec<u8> {
    [text(name), 0x20_u32.to_le_bytes().to_vec(), text(value)].concat()
}

/// A property that is a time: seconds since 1904.
fn time(name: &str, seconds: i64, fraction: u64) -> Vec<u8> {
    let kind = 0x44_u32.to_le_bytes();
    [&text(name)[..], &kind, &fraction.to_le_bytes(), &seconds.to_le_bytes()].concat()
}

/// An object with the description of its samples, and properties.
fn object(path: &str, index: &[u8], properties: &[Vec<u8>]) -> Vec<u8> {
    let count = u32::try_from(properties.len()).unwrap().to_le_bytes();
    [&text(path)[..], index, &count, &properties.concat()].concat()
}

fn index(kind: u32, values: u64) -> Vec<u8> {
    let words = [20_u32, kind, 1].map(u32::to_le_bytes).concat();
    [&words[..], &values.to_le_bytes()].concat()
}

fn segment(contents: u32, objects: &[Vec<u8>], raw: &[u8]) -> Vec<u8> {
    let count = u32::try_from(objects.len()).unwrap().to_le_bytes();
    let metadata = [&count[..], &objects.concat()].concat();
    let metadata = if contents & METADATA == 0 { Vec::new() } else { metadata };
    let length = (metadata.len() + raw.len()) as u64;
    let lead = [b"TDSm".as_slice(), &contents.to_le_bytes(), &4713_u32.to_le_bytes()].concat();
    let offsets = [length, metadata.len() as u64].map(u64::to_le_bytes).concat();
    [lead, offsets, metadata, raw.to_vec()].concat()
}

/// One segment with one channel of doubles and its properties.
fn one_channel(properties: &[Vec<u8>], values: &[f64]) -> Vec<u8> {
    let raw: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    segment(ALL, &[object("/'g'/'c'", &index(10, values.len() as u64), properties)], &raw)
}

fn rate(hz: f64) -> Vec<u8> {
    number("wf_increment", 1.0 / hz)
}

#[test]
fn channels_of_one_group_are_divided_by_rate_length_and_start() {
    let channel = |name: &str, values: u64, properties: &[Vec<u8>]| {
        object(&format!("/'g'/'{name}'"), &index(5, values), properties)
    };
    let at = |seconds, fraction| time("wf_start_time", seconds, fraction);
    let objects = [
        channel("a", 4, &[rate(100.0), at(1000, 0)]),
        channel("b", 4, &[rate(50.0), at(1000, 0)]),
        // 4 ms later: less than half a step.
        channel("c", 4, &[rate(100.0), at(1000, 1 << 56)]),
        channel("d", 4, &[rate(100.0), at(1001, 0)]),
        channel("e", 3, &[rate(100.0), at(1000, 0)]),
        channel("single", 1, &[]),
    ];
    let measured = parsed(segment(ALL, &objects, &(0..20).collect::<Vec<u8>>()));
    let names: Vec<Vec<&str>> = measured
        .records
        .iter()
        .map(|record| record.channels.iter().map(|channel| channel.name.as_str()).collect())
        .collect();
    // `e` ends one sample earlier.
    assert_eq!(names, [vec!["a", "c", "e"], vec!["b"], vec!["d"]]);
    assert_eq!(samples(&measured.records[0], "c"), [8.0, 9.0, 10.0, 11.0]);
    assert_eq!(samples(&measured.records[0], "e"), [16.0, 17.0, 18.0]);
    let single =
        Notice::ArrayLeftOut { array: "single".into(), reason: "a single number without a time" };
    assert!(measured.notices.contains(&single));
}

#[test]
fn units_and_axes_by_properties() {
    let values = [1.0, 2.0, 3.0];
    let unit = |properties: &[Vec<u8>]| {
        let measured = parsed(one_channel(properties, &values));
        measured.records[0].channels[0].unit.text().to_owned()
    };
    assert_eq!(unit(&[rate(10.0), string("NI_UnitDescription", "Newtons")]), "N");
    let both = [string("unit_string", ""), string("NI_UnitDescription", "g"), rate(10.0)];
    assert_eq!(unit(&both), "g");
    assert_eq!(unit(&[rate(10.0), string("unit_string", "furlong")]), "furlong");

    let spectrum = [number("wf_increment", 2.5), string("wf_xunit_string", "Hz")];
    let measured = parsed(one_channel(&spectrum, &values));
    let even = Abscissa::Even { start: 0.0, step: 2.5, quantity: ChannelQuantity::Frequency };
    assert_eq!(measured.records[0].channels[0].abscissa, even);
    let in_ms = [
        number("wf_increment", 0.5),
        number("wf_start_offset", -2.0),
        string("wf_xunit_string", "ms"),
    ];
    let measured = parsed(one_channel(&in_ms, &values));
    assert_eq!(measured.records[0].sample_rate_hz(), Some(2000.0));
    assert_eq!(measured.records[0].channels[0].abscissa.at(0), Some(-0.002));
}

#[test]
fn a_channel_of_times_is_the_axis() {
    let column = |from: f64, step: f64| {
        (0..8_u32).flat_map(|n| (from + step * f64::from(n)).to_le_bytes()).collect::<Vec<u8>>()
    };
    let file = |times: Vec<u8>| {
        let objects = [
            object("/'g'/'Time (ms)'", &index(10, 8), &[]),
            object("/'g'/'Force (N)'", &index(10, 8), &[]),
        ];
        segment(ALL, &objects, &[times, column(0.0, 1.0)].concat())
    };
    let measured = parsed(file(column(5.0, 0.5)));
    let record = &measured.records[0];
    assert_eq!((record.channels.len(), record.sample_rate_hz()), (1, Some(2000.0)));
    assert_eq!(record.channels[0].abscissa.at(0), Some(0.005));
    assert_eq!((record.channels[0].name.as_str(), record.channels[0].unit.text()), ("Force", "N"));
    // Uneven times.
    let times: Vec<u8> = (0..8_u32).flat_map(|n| f64::from(n * n).to_le_bytes()).collect();
    let measured = parsed(file(times));
    assert_eq!(measured.records[0].sample_rate_hz(), None);
    assert_eq!(measured.records[0].channels[0].abscissa.at(7), Some(0.049));
}

#[test]
fn other_scales_are_rejected() {
    let scaled = |properties: &[Vec<u8>]| error_of(one_channel(properties, &[1.0, 2.0]));
    let thermocouple = [rate(10.0), string("NI_Scale[0]_Scale_Type", "Thermocouple")];
    let message = scaled(&thermocouple);
    // The type of the property is at byte 129, after a path of 8 bytes.
    assert!(message.contains("the scale of a channel is `Thermocouple`"), "{message}");
    assert!(message.contains("expected Linear or Polynomial"), "{message}");
    assert!(message.starts_with("bytes, byte "), "{message}");
    let missing = [rate(10.0), string("NI_Scale[0]_Scale_Type", "Linear")];
    assert!(scaled(&missing).contains("expected a finite NI_Scale[0]_Linear_Y_Intercept"));
    let circle = [
        rate(10.0),
        string("NI_Scale[0]_Scale_Type", "Linear"),
        number("NI_Scale[0]_Linear_Slope", 1.0),
        number("NI_Scale[0]_Linear_Y_Intercept", 0.0),
        number("NI_Scale[0]_Linear_Input_Source", 0.0),
    ];
    assert!(scaled(&circle).contains("the input of a scale is `0`"));
    let status = [string("NI_Scaling_Status", "perhaps"), thermocouple[1].clone()];
    assert!(scaled(&status).contains("expected scaled or unscaled"));
    let done = [string("NI_Scaling_Status", "scaled"), thermocouple[1].clone(), rate(10.0)];
    assert_eq!(parsed(one_channel(&done, &[1.0, 2.0])).records[0].len(), 2);
    let most = [rate(10.0), string("NI_Scale[4294967295]_Scale_Type", "Linear")];
    assert!(scaled(&most).contains("at most 64 scales"));
}

#[test]
fn scales_of_the_file_apply_without_nearer_ones() {
    let linear = |slope: f64| {
        vec![
            string("NI_Scale[0]_Scale_Type", "Linear"),
            number("NI_Scale[0]_Linear_Slope", slope),
            number("NI_Scale[0]_Linear_Y_Intercept", 1.0),
        ]
    };
    let none = u32::MAX.to_le_bytes();
    let with_rate = |properties: Vec<Vec<u8>>| [properties, vec![rate(10.0)]].concat();
    let objects = [
        object("/", &none, &linear(10.0)),
        object("/'g'", &none, &linear(100.0)),
        object("/'g'/'own'", &index(5, 2), &with_rate(linear(1000.0))),
        object("/'g'/'of group'", &index(5, 2), &with_rate(Vec::new())),
        object("/'h'/'of file'", &index(5, 2), &with_rate(Vec::new())),
    ];
    let measured = parsed(segment(ALL, &objects, &[1, 2, 3, 4, 5, 6]));
    assert_eq!(samples(&measured.records[0], "own"), [1001.0, 2001.0]);
    assert_eq!(samples(&measured.records[0], "of group"), [301.0, 401.0]);
    assert_eq!(samples(&measured.records[1], "of file"), [51.0, 61.0]);
}

#[test]
fn raw_data_of_the_driver_and_index_files_are_rejected() {
    let good = one_channel(&[rate(10.0)], &[1.0, 2.0]);
    let flagged = [&good[..4], &[good[4] | 0x80], &good[5..]].concat();
    let driver = object("/'g'/'c'", &0x1269_u32.to_le_bytes(), &[]);
    for file in [flagged, segment(ALL, &[driver], &[0; 8])] {
        let message = error_of(file);
        assert!(message.contains("raw data of NI-DAQmx cannot be read; save it from"), "{message}");
    }
    let message = error_of([b"TDSh", &good[4..]].concat());
    assert!(message.ends_with("give the `.tdms` file beside it"), "{message}");
}

#[test]
fn errors_have_the_position() {
    let good = one_channel(&[rate(10.0)], &[1.0, 2.0]);
    let change = |at: usize, bytes: &[u8]| {
        let mut file = good.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        error_of(file)
    };
    assert_eq!(good[28 + 4 + 4..28 + 4 + 4 + 8], *b"/'g'/'c'");
    for (at, bytes, expected) in [
        (8, &[0x69_u8, 0x11][..], "byte 8: the version is `4457`; expected 4712"),
        (20, &[0xff, 0xff], "byte 0: the length of the metadata is `65535`; expected at most"),
        (20, &[60, 0], "the metadata is `"),
        (28, &[9, 9], "the objects of a segment needs"),
        (36, b"x", "byte 32: the path of an object is `x"),
        (44, &[21], "the length of a raw data index is `21`; expected 20"),
        (48, &[11], "byte 48: the type of a channel is `11`; expected a number of 1 to 8 bytes"),
        (52, &[2], "the dimension of a channel is `2`; expected 1"),
        (44, &[0, 0, 0, 0], "the raw data index is `0`; expected a description"),
    ] {
        let message = change(at, bytes);
        assert!(message.contains(expected), "{message}");
    }
    // The file ends early: in the samples, and in the lead-in of another segment.
    let message = error_of(&good[..good.len() - 1]);
    assert!(message.contains("byte 28: a segment needs"), "{message}");
    let message = error_of([&good[..], b"TDSm"].concat());
    assert!(
        message.contains("the lead-in of a segment needs 28 bytes; the file has 4"),
        "{message}"
    );
    let message = error_of([&good[..], &[0; 40]].concat());
    assert!(message.contains("the tag of a segment is"), "{message}");
    // A number of samples beyond any file.
    let two = [
        object("/'g'/'a'", &index(10, u64::MAX), &[rate(1.0)]),
        object("/'g'/'b'", &index(10, u64::MAX / 4), &[rate(1.0)]),
    ];
    let message = error_of(segment(ALL, &two, &[0; 64]));
    assert!(message.contains("the raw data of a segment is `64 bytes long`"), "{message}");
    // Raw data before any metadata.
    let message = error_of(segment(RAW, &[], &[0; 8]));
    assert!(message.contains("expected empty: no channel has samples here"), "{message}");
    let nothing = read_bytes(&segment(METADATA, &[], &[]), &ReadOptions::default()).unwrap_err();
    assert!(matches!(nothing, MeasureError::NoSamples { .. }), "{nothing}");
}

/// Start times join the channels of different starts in one record, in blocks too; hits with the same
/// names remain apart.
#[test]
fn start_times_line_up_channels() {
    let channel = |path: &str, values: u64, properties: &[Vec<u8>]| {
        object(path, &index(5, values), properties)
    };
    // In units of 2^-64 s: 20 ms.
    let later = (0.02 * 2f64.powi(64)) as u64;
    let at = |fraction| [rate(100.0), time("wf_start_time", 1000, fraction)];
    let objects = [channel("/'Hammer'/'force'", 6, &at(0)), channel("/'Tip'/'acc'", 5, &at(later))];
    let file = segment(ALL, &objects, &(0..11).collect::<Vec<u8>>());
    let measured = parsed(&file);
    assert_eq!(measured.records.len(), 1);
    let record = &measured.records[0];
    let start = |name: &str| record.named(name).unwrap().abscissa.at(0).unwrap();
    assert!(start("force") == 0.0 && (start("acc") - 0.02).abs() < 1e-12);
    assert_eq!(samples(record, "acc"), [6.0, 7.0, 8.0, 9.0, 10.0]);
    let options = ReadOptions { block: 4, ..ReadOptions::default() };
    let stream = std::io::Cursor::new(file);
    let mut reader = asperity_measure::Reader::from_stream("t", stream, &options).unwrap();
    let mut read = Vec::new();
    while let Some(block) = reader.next_record().unwrap() {
        read.push((samples(&block, "force").len(), samples(&block, "acc").len()));
    }
    assert_eq!(read, [(4, 4), (2, 1)]);

    let hits = [
        channel("/'1'/'force'", 4, &at(0)),
        channel("/'1'/'acc'", 4, &at(0)),
        channel("/'2'/'force'", 4, &at(0)),
        channel("/'2'/'acc'", 4, &at(0)),
    ];
    assert_eq!(parsed(segment(ALL, &hits, &[0; 16])).records.len(), 2);
}

/// A time channel for each channel.
#[test]
fn each_time_channel_is_that_of_its_own_channels() {
    let column = |from: f64, step: f64| {
        (0..8_u32).flat_map(|n| (from + step * f64::from(n)).to_le_bytes()).collect::<Vec<u8>>()
    };
    let named = |name: &str| object(&format!("/'g'/'{name}'"), &index(10, 8), &[]);
    let names = ["Time force", "Force (N)", "Time acc", "Acc (g)"];
    let objects = names.map(named);
    let columns = [column(0.0, 0.5), column(0.0, 1.0), column(1.0, 0.25), column(2.0, 1.0)];
    let measured = parsed(segment(ALL, &objects, &columns.concat()));
    assert_eq!(measured.records.len(), 1);
    let axis = |name: &str| measured.records[0].named(name).unwrap().abscissa.clone();
    assert_eq!(axis("Force"), Abscissa::even_time(0.0, 2.0));
    assert_eq!(axis("Acc"), Abscissa::even_time(1.0, 4.0));
}
