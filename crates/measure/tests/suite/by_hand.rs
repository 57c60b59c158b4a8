//! Universal files written byte by byte from the description of the format
//! (SDRC universal dataset 58; the binary form of MTS I-DEAS), independent of the writer.

use asperity_measure::{
    ChannelQuantity, Complex64, FilePosition, Format, MeasureError, Notice, ReadOptions, Samples,
    read_bytes,
};

use crate::build::{error_of, parsed};

/// Header lines 1 to 11 of a time response; kind 2, 4, 5 or 6.
fn header(kind: u32, points: usize, even: bool, ordinate: &str) -> String {
    format!(
        "hammer\nNONE\n01-Nov-26\nNONE\nNONE\n\
         \x20   1         0    1         0 BEAM              7   3 BEAM              2  -3\n\
         {kind:>10}{points:>10}{:>10}  0.00000E+00{:>13}  0.00000E+00\n\
         \x20       17    0    0    0 Time                 s                   \n\
         {ordinate}\n\
         \x20        0    0    0    0 NONE                 NONE                \n\
         \x20        0    0    0    0 NONE                 NONE                \n",
        u32::from(even),
        if even { "9.76563E-04" } else { "0.00000E+00" }
    )
}

const FORCE: &str = "        13    0    1    0 Force                N                   ";

/// A dataset 58b: `order` 1 little, 2 big endian.
fn binary(order: u32, announced: usize, header: &str, payload: &[u8], close: &str) -> Vec<u8> {
    let mut file = format!(
        "    -1\n    58b{order:>6}     2          11{announced:>12}     0     0           0           0\n{header}"
    )
    .into_bytes();
    file.extend(payload);
    file.extend(close.as_bytes());
    file
}

fn real(bytes: &[u8]) -> Vec<f64> {
    parsed(bytes).records[0].channels[0].samples.real().unwrap().to_vec()
}

#[test]
fn every_width_and_byte_order() {
    let values = [1.5_f64, -2.25, 1e-3_f32.into()];
    for order in [1, 2] {
        let bytes = |double: bool| -> Vec<u8> {
            values
                .iter()
                .flat_map(|value| match (double, order) {
                    (true, 1) => value.to_le_bytes().to_vec(),
                    (true, _) => value.to_be_bytes().to_vec(),
                    (false, 1) => (*value as f32).to_le_bytes().to_vec(),
                    (false, _) => (*value as f32).to_be_bytes().to_vec(),
                })
                .collect()
        };
        for (kind, double) in [(2, false), (4, true)] {
            let payload = bytes(double);
            let file =
                binary(order, payload.len(), &header(kind, 3, true, FORCE), &payload, "    -1\n");
            let measured = parsed(&file);
            assert_eq!(measured.format, Format::UniversalBinary);
            let channel = &measured.records[0].channels[0];
            assert_eq!(channel.samples.real(), Some(&values[..]), "{kind} {order}");
            // 9.76563E-04 is 1/1024 in six digits.
            assert_eq!(channel.sample_rate_hz(), Some(1024.0));
            assert_eq!(
                (channel.name.as_str(), channel.quantity),
                ("hammer", ChannelQuantity::Force)
            );
            let (response, reference) = (&channel.origin.response, &channel.origin.reference);
            assert_eq!(response.as_ref().map(|node| (node.node, node.direction)), Some((7, 3)));
            assert_eq!(reference.as_ref().map(|node| (node.node, node.direction)), Some((2, -3)));
        }
    }
}

#[test]
fn complex_and_uneven_points() {
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>();
    let payload = floats(&[1.0, -1.0, 0.5, 0.25]);
    let file = binary(2, 16, &header(5, 2, true, FORCE), &payload, "    -1\n");
    let expected = vec![Complex64::new(1.0, -1.0), Complex64::new(0.5, 0.25)];
    assert_eq!(parsed(file).records[0].channels[0].samples, Samples::Complex(expected));

    // Uneven doubles with abscissae in double precision, and in single.
    for single in [false, true] {
        let mut payload = Vec::new();
        for (x, y) in [(0.5, 1.25), (0.75, 3.5), (2.0, -8.0)] {
            if single {
                payload.extend((x as f32).to_le_bytes());
            } else {
                payload.extend(f64::to_le_bytes(x));
            }
            payload.extend(f64::to_le_bytes(y));
        }
        let file = binary(1, payload.len(), &header(4, 3, false, FORCE), &payload, "    -1\n");
        let measured = parsed(file);
        let channel = &measured.records[0].channels[0];
        assert_eq!(channel.samples.real(), Some(&[1.25, 3.5, -8.0][..]), "{single}");
        assert_eq!([0, 1, 2].map(|n| channel.abscissa.at(n).unwrap()), [0.5, 0.75, 2.0]);
    }
}

/// Eight bytes `    -1\n` and more are a valid number.
#[test]
fn a_payload_with_the_bytes_of_a_closing_tag() {
    let tricky = [f64::from_le_bytes(*b"\n    -1\n"), 2.0, f64::from_le_bytes(*b"    -1\r\n")];
    let payload: Vec<u8> = tricky.iter().flat_map(|value| value.to_le_bytes()).collect();
    let file = binary(1, 24, &header(4, 3, true, FORCE), &payload, "    -1\n");
    assert_eq!(real(&file), tricky);
    let twice = [file.clone(), file].concat();
    assert_eq!(parsed(twice).records.len(), 2, "the same channel again is the next hit");
}

#[test]
fn padding_and_wrong_byte_counts() {
    let payload: Vec<u8> = [1.0_f64, 2.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    for close in ["    -1\n", "    -1", "\n    -1\n", "\r\n    -1\r\n", "    -1   \n"] {
        assert_eq!(real(&binary(1, 16, &header(4, 2, true, FORCE), &payload, close)), [1.0, 2.0]);
    }
    // A byte count that is too small gives a notice and is not used.
    let file = binary(1, 8, &header(4, 2, true, FORCE), &payload, "    -1\n");
    let notices = parsed(&file).notices;
    let told =
        |notice: &Notice| matches!(notice, Notice::ByteCount { announced: 8, taken: 16, .. });
    assert!(notices.iter().any(told), "{notices:?}");
    // Padding up to the announced count is skipped.
    let padded = [payload.clone(), vec![7; 4]].concat();
    assert_eq!(real(&binary(1, 20, &header(4, 2, true, FORCE), &padded, "    -1\n")), [1.0, 2.0]);
}

#[test]
fn a_payload_without_closing_tag_is_rejected_at_its_end() {
    let payload = [0x41; 24];
    let head = header(4, 2, true, FORCE);
    let file = binary(1, 16, &head, &payload, "    -1\n");
    let error = read_bytes(&file, &ReadOptions::default()).unwrap_err();
    let end = file.len() - 7 - 8;
    assert!(
        matches!(&error, MeasureError::Malformed { place: FilePosition::Offset(place), .. } if *place == end as u64),
        "{error}"
    );
    assert!(error.to_string().contains("`    -1` after 2 points in 16 bytes"), "{error}");
}

#[test]
fn text_in_single_and_double_precision() {
    let single = " -1.47553E-02  1.72957E-02\n  1.66101E+02\n";
    let double = "  1.250000000000E+00 -3.500000000000E-01  2.000000000000D+00\n";
    for (kind, lines, values) in
        [(2, single, [-1.47553e-2, 1.72957e-2, 166.101]), (4, double, [1.25, -0.35, 2.0])]
    {
        for end in ["\n", "\r\n"] {
            let file = format!("    -1\n    58\n{}{lines}    -1\n", header(kind, 3, true, FORCE))
                .replace('\n', end);
            assert_eq!(real(file.as_bytes()), values);
        }
    }
    let uneven = "  1.00000E+00  1.250000000000E+00  3.00000E+00 -3.500000000000E-01\n";
    let file = format!("    -1\n    58\n{}{uneven}    -1\n", header(4, 2, false, FORCE));
    let measured = parsed(file);
    let channel = &measured.records[0].channels[0];
    assert_eq!(channel.samples.real(), Some(&[1.25, -0.35][..]));
    assert_eq!(channel.abscissa.at(1), Some(3.0));
}

#[test]
fn too_few_and_too_many_numbers() {
    let file = |points, lines: &str| {
        format!("    -1\n    58\n{}{lines}    -1\n", header(2, points, true, FORCE))
    };
    let short = error_of(file(4, " 1.0 2.0 3.0\n"));
    assert!(
        short.contains("line 15: the data is `their end`; expected numbers for 1 more"),
        "{short}"
    );
    let long = error_of(file(2, " 1.0 2.0 3.0\n"));
    assert!(long.contains("line 14: the data is `1 values too many`"), "{long}");
    let longer = error_of(file(2, " 1.0 2.0\n 3.0\n"));
    assert!(
        longer.contains("line 15: the closing tag is `3.0`") || longer.contains("` 3.0`"),
        "{longer}"
    );
    let word = error_of(file(2, " 1.0 two\n"));
    assert!(word.contains("line 14: a line of data"), "{word}");
}

/// Dataset 164 gives factors from SI: in millimetres and millinewtons, 1000.
#[test]
fn channels_without_a_unit_use_the_system_of_units() {
    let system = "    -1\n   164\n         5mm (milli-newton)            2\n\
        \x20 1.0000000000000000D+03   1.0000000000000000D+03   1.0000000000000000D+00\n\
        \x20 2.7314999999999998D+02\n    -1\n";
    let unit_less =
        |kind: u32| format!("{kind:>10}    0    0    0 NONE                 NONE                ");
    for (kind, quantity, factor) in [
        (13, ChannelQuantity::Force, 1e-3),
        (12, ChannelQuantity::Acceleration, 1e-3),
        (8, ChannelQuantity::Displacement, 1e-3),
        // mN per square millimetre: 1000 Pa.
        (15, ChannelQuantity::Pressure, 1e3),
    ] {
        let function = header(2, 2, true, &unit_less(kind));
        let file = format!("{system}    -1\n    58\n{function} 2.0 -4.0\n    -1\n");
        let mut measured = parsed(&file);
        let told = |notice: &Notice| matches!(notice, Notice::UnitOfFile { .. });
        assert!(measured.notices.iter().any(told));
        let channel = &mut measured.records[0].channels[0];
        channel.to_si().unwrap();
        assert_eq!(channel.quantity, quantity);
        for (value, written) in channel.samples.real().unwrap().iter().zip([2.0, -4.0]) {
            assert!((value / (factor * written) - 1.0).abs() < 1e-15, "{quantity}: {value}");
        }
    }
    let labelled =
        format!("{system}    -1\n    58\n{} 2.0 3.0\n    -1\n", header(2, 2, true, FORCE));
    let measured = parsed(labelled);
    assert_eq!(measured.records[0].channels[0].unit.text(), "N", "the label goes before");
    assert!(measured.notices.iter().any(|notice| matches!(notice, Notice::UnitsDisagree { .. })));
}

#[test]
fn other_datasets_are_skipped() {
    let nodes = "    -1\n    15\n         1         0         0        11  0.0  0.0  0.0\n    -1\n";
    let function = format!("    -1\n    58\n{} 1.0 2.0\n    -1\n", header(2, 2, true, FORCE));
    assert_eq!(real(format!("\n{nodes}{function}{nodes}").as_bytes()), [1.0, 2.0]);
    assert!(error_of(nodes).contains("no samples; expected dataset 58"));
    assert!(error_of(&nodes[..40]).contains("expected a closing `    -1`"));
}

/// Times that a file with an uneven flag gives may be even; their rounding does not change that.
#[test]
fn even_times_with_an_uneven_flag() {
    let file = |times: &dyn Fn(f64) -> f64| {
        let points = (0..30).map(|n| format!("{:13.5E}{:13.5E}\n", times(f64::from(n)), 1.0));
        let points = points.map(|line| line.replace("E-", "E-0").replace("E0", "E+00"));
        format!(
            "    -1\n    58\n{}{}    -1\n",
            header(2, 30, false, FORCE),
            points.collect::<String>()
        )
    };
    let rate = |file: String| parsed(file).records[0].sample_rate_hz();
    assert_eq!(rate(file(&|n| 0.25 + n / 1024.0)), Some(1024.0));
    assert_eq!(rate(file(&|n| n * n / 1024.0)), None);
    let payload: Vec<u8> = (0..30)
        .flat_map(|n| [n as f32 / 51_200.0, 1.0].into_iter().flat_map(f32::to_le_bytes))
        .collect();
    let binary = binary(1, payload.len(), &header(2, 30, false, FORCE), &payload, "    -1\n");
    for block in [7, usize::MAX] {
        let options = ReadOptions { block, ..ReadOptions::default() };
        let stream = std::io::Cursor::new(binary.clone());
        let mut reader = asperity_measure::Reader::from_stream("b", stream, &options).unwrap();
        while let Some(record) = reader.next_record().unwrap() {
            assert_eq!(record.sample_rate_hz(), Some(51_200.0));
        }
        let snapped = |notice: &Notice| matches!(notice, Notice::RateSnapped { .. });
        assert!(reader.notices().iter().all(snapped), "{:?}", reader.notices());
    }
}
