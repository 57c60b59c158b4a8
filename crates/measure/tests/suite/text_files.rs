//! Texts of loggers, spreadsheets and LabVIEW.

use asperity_measure::{
    Abscissa, ChannelQuantity, ChannelUnit, InvalidCells, Notice, ReadOptions, Reader, read_bytes,
};

use crate::build::{error_of, parsed, samples};

fn rows(count: u32, row: impl Fn(u32) -> String) -> String {
    (0..count).map(row).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_german_export_with_preamble_and_a_row_of_units() {
    // Latin-1, CR LF, decimal comma, time in milliseconds.
    let file = b"Messung;Pr\xfcfstand 3\r\nKanalzahl;2\r\n\r\nZeit;Kraft;Beschleunigung\r\n\
        [ms];[N];[m/s\xb2]\r\n0,00;0,5;-1,25\r\n0,02;1,5;2\r\n0,04;2,5;1e-3\r\n0,06;-3;0\r\n";
    let measured = parsed(file);
    let record = &measured.records[0];
    assert_eq!(record.sample_rate_hz(), Some(50_000.0));
    assert_eq!(samples(record, "Kraft"), [0.5, 1.5, 2.5, -3.0]);
    assert_eq!(samples(record, "Beschleunigung"), [-1.25, 2.0, 0.001, 0.0]);
    assert_eq!(record.of_quantity(ChannelQuantity::Acceleration).unwrap().unit.text(), "m/s^2");
    assert!(measured.notices.iter().any(|notice| matches!(notice, Notice::Latin1 { .. })));
}

#[test]
fn the_same_numbers_in_many_dialects() {
    let mut expected: Option<(Vec<f64>, Vec<f64>)> = None;
    for file in [
        "time_s,force_N,acc_g\n0,0.5,-1\n0.001,1.5,2\n0.002,2.5,3\n",
        "\u{feff}Time (s),Force (N),Acc (g)\n0,0.5,-1\n0.001,1.5,2\n0.002,2.5,3\n",
        "Time [s];Force [N];Acc [g]\n0;0,5;-1\n0,001;1,5;2\n0,002;2,5;3\n",
        "t/s\tF/N\ta/g\n0\t0.5\t-1\n0.001\t1.5\t2\n0.002\t2.5\t3\n",
        "# time_s force_N acc_g\n 0.000e+00  0.5 -1.0\n 1.000e-03  1.5  2.0\n 2.000e-03  2.5  3.0\n",
        "\"Time (s)\",\"Force (N)\",\"Acc (g)\"\n0,0.5,-1,\n0.001,1.5,2,\n\n0.002,2.5,3,\n",
        "time,force,acc\ns,N,g\n0,0.5,-1\n0.001,1.5,2\n0.002,2.5,3",
        "time_ms,force_kN,acc_g\n0,0.0005,-1\n1,0.0015,2\n2,0.0025,3\n",
    ] {
        let mut measured = parsed(file);
        let record = &mut measured.records[0];
        assert_eq!(record.sample_rate_hz(), Some(1000.0), "{file}");
        let si = |quantity| {
            let mut channel = record.of_quantity(quantity).unwrap().clone();
            channel.to_si().unwrap();
            channel.samples.real().unwrap().to_vec()
        };
        let found = (si(ChannelQuantity::Force), si(ChannelQuantity::Acceleration));
        let expected = expected.get_or_insert_with(|| found.clone());
        for (a, b) in found.0.iter().chain(&found.1).zip(expected.0.iter().chain(&expected.1)) {
            assert!((a - b).abs() < 1e-12, "{file}");
        }
    }
}

#[test]
fn rates_come_from_rounded_times() {
    // Six decimals at 51.2 kHz: an error of up to half a microsecond.
    let rows = rows(5120, |n| format!("{:.6},1", f64::from(n) / 51_200.0));
    let measured = parsed(format!("time_s,force_N\n{rows}"));
    assert_eq!(measured.records[0].sample_rate_hz(), Some(51_200.0));
    assert!(measured.notices.iter().any(|notice| matches!(notice, Notice::RateSnapped { .. })));
    // Two decimals are too few: the printed axis is used.
    let rows = self::rows(512, |n| format!("{:.2},1", f64::from(n) / 512.0));
    assert_eq!(parsed(format!("time_s,force_N\n{rows}")).records[0].sample_rate_hz(), None);
}

#[test]
fn an_uneven_axis_is_kept() {
    let measured = parsed("time_s,x_mm\n0,1\n1,2\n5,3\n");
    let channel = &measured.records[0].channels[0];
    assert_eq!(channel.sample_rate_hz(), None);
    assert_eq!([0, 1, 2].map(|n| channel.abscissa.at(n).unwrap()), [0.0, 1.0, 5.0]);
}

#[test]
fn without_names_time_is_found_by_its_values_with_a_notice() {
    let measured = parsed("0 5 1\n0.5 6 1\n1 4 1\n1.5 5 1\n");
    assert_eq!(measured.records[0].sample_rate_hz(), Some(2.0));
    assert_eq!(samples(&measured.records[0], "column 2"), [5.0, 6.0, 4.0, 5.0]);
    assert!(measured.notices.contains(&Notice::TimeByValues { column: "column 1".into() }));
    assert_eq!(measured.records[0].channels[0].unit, ChannelUnit::Missing);
}

#[test]
fn without_time_a_rate_is_needed() {
    for file in
        ["force_N\n1\n5\n2\n", "force_N,acc_g\n1,2\n5,1\n2,2\n", "n,force_N\n0,1\n1,5\n2,2\n"]
    {
        let message = error_of(file);
        assert!(message.ends_with("give the rate (option `sample_rate_hz`)"), "{message}");
        let options = ReadOptions { sample_rate_hz: Some(500.0), ..ReadOptions::default() };
        let measured = read_bytes(file.as_bytes(), &options).unwrap();
        assert_eq!(measured.records[0].sample_rate_hz(), Some(500.0));
        assert_eq!(samples(&measured.records[0], "force"), [1.0, 5.0, 2.0]);
        assert!(measured.notices.contains(&Notice::RateOfOptions { rate_hz: 500.0 }));
    }
}

const LABVIEW: &str = "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n\
    Decimal_Separator\t,\nMulti_Headings\tYes\nX_Columns\tNo\nTime_Pref\tAbsolute\nDate\t2026/11/01\n\
    Description\thit on beam\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t3\t3\t\n\
    Date\t2026/11/01\t2026/11/01\t\nY_Unit_Label\tNewtons\tg\t\nX_Dimension\tTime\tTime\t\n\
    X0\t0,0E+0\t0,0E+0\t\nDelta_X\t1,953125E-5\t1,953125E-5\t\n***End_of_Header***\t\t\t\n\
    X_Value\tHammer\tTip\tComment\n\t1,5\t-0,25\n\t2,5\t0,5\tfirst\n\t3,5\t0,75\n";

#[test]
fn labview_without_a_column_of_times() {
    let second = LABVIEW.split_once("\t\nChannels").unwrap().1;
    let file = format!("{LABVIEW}\t\nChannels{second}");
    let measured = parsed(file);
    assert_eq!(measured.records.len(), 2, "a record for each segment");
    for record in &measured.records {
        assert!(!record.continues);
        assert_eq!(record.sample_rate_hz(), Some(51_200.0));
        assert_eq!((record.title.as_str(), record.date.as_str()), ("hit on beam", "2026/11/01"));
        assert_eq!(samples(record, "Hammer"), [1.5, 2.5, 3.5]);
        assert_eq!(samples(record, "Tip"), [-0.25, 0.5, 0.75]);
        assert_eq!(record.channels[1].unit.text(), "g");
        assert_eq!(record.channels[0].unit.text(), "N");
    }
}

#[test]
fn labview_with_times_in_six_decimals() {
    // 0.000020 in the column, 1.953125E-5 in the header.
    let file = LABVIEW
        .replace("X_Columns\tNo", "X_Columns\tOne")
        .replace("\n\t1,5", "\n0,000000\t1,5")
        .replace("\n\t2,5", "\n0,000020\t2,5")
        .replace("\n\t3,5", "\n0,000039\t3,5");
    let measured = parsed(&file);
    let record = &measured.records[0];
    assert_eq!(record.sample_rate_hz(), Some(51_200.0));
    assert_eq!((record.channels.len(), samples(record, "Tip")), (2, &[-0.25, 0.5, 0.75][..]));
}

/// The fields of the header are above the channels, as in LabVIEW.
const PAIRS: &str = "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tMulti\n\
    ***End_of_Header***\t\n\t\nChannels\t2\t\t\t\nSamples\t4\t\t4\t\n\
    Y_Unit_Label\tN\t\tg\t\nX0\t0.0E+0\t\t1.0E+0\t\nDelta_X\t0.000250\t\t0.000400\t\n\
    ***End_of_Header***\t\t\t\t\nX_Value\tHammer\tX_Value\tTip\tComment\n\
    0.000000\t1\t1.000000\t-5\n0.000250\t2\t1.000400\t-6\n\
    0.000500\t3\t1.000800\t-7\n0.000750\t4\t1.001200\t-8\n";

#[test]
fn labview_with_times_for_each_channel() {
    for options in [ReadOptions::default(), ReadOptions { block: 3, ..ReadOptions::default() }] {
        let stream = std::io::Cursor::new(PAIRS.as_bytes());
        let mut reader = Reader::from_stream("pairs", stream, &options).unwrap();
        let record = reader.next_record().unwrap().unwrap();
        let count = options.block.min(4);
        assert_eq!(samples(&record, "Hammer"), &[1.0, 2.0, 3.0, 4.0][..count]);
        assert_eq!(samples(&record, "Tip"), &[-5.0, -6.0, -7.0, -8.0][..count]);
        assert_eq!(record.sample_rate_hz(), None, "each has its own");
        let (hammer, tip) = (&record.channels[0], &record.channels[1]);
        assert_eq!((hammer.sample_rate_hz(), tip.sample_rate_hz()), (Some(4000.0), Some(2500.0)));
        assert_eq!((hammer.unit.text(), tip.unit.text()), ("N", "g"));
        assert_eq!((hammer.abscissa.at(0), tip.abscissa.at(0)), (Some(0.0), Some(1.0)));
        let rest = reader.next_record().unwrap();
        assert_eq!(rest.map(|rest| (rest.continues, rest.len())), (count < 4).then_some((true, 1)));
    }
    let named = PAIRS.replace("X_Value\tTip", "t2\tTime of tip");
    assert_eq!(samples(&parsed(named).records[0], "Time of tip"), [-5.0, -6.0, -7.0, -8.0]);
    let same = PAIRS.replace("0.000400", "0.000250").replace("\t1.00", "\t0.00");
    let same = same.replace("0.000400", "0.000250").replace("0.000800", "0.000500");
    let record = &parsed(same.replace("0.001200", "0.000750")).records[0];
    assert_eq!(record.sample_rate_hz(), Some(4000.0));
    let uneven = error_of(PAIRS.replace("1.000800", "1.001100"));
    assert!(uneven.contains("the X column of a channel is `uneven for Tip`"), "{uneven}");
    assert!(uneven.contains(", line "), "{uneven}");
    let odd = error_of(PAIRS.replace("\tX_Value\tTip", "\tX_Value").replace("\t-", "\t\t-"));
    assert!(odd.contains("3 columns"), "{odd}");
}

#[test]
fn errors_of_rows_have_the_line() {
    let head = "time_s,force_N\n0,1\n1,2\n2,3\n3,4\n";
    let message = error_of(format!("{head}4,five\n5,6\n"));
    assert!(message.contains("line 6: `five` for `force` is no number"), "{message}");
    let message = error_of(format!("{head}4\n5,6\n"));
    assert!(message.contains("line 6: a row is `1 columns`; expected 2 columns"), "{message}");
    let message = error_of(format!("{head}4,5,6\n5,6\n"));
    assert!(
        message.contains("line 6: a field is `6`; expected nothing after 2 columns"),
        "{message}"
    );
    let cut = parsed(format!("{head}4,"));
    assert_eq!(samples(&cut.records[0], "force"), [1.0, 2.0, 3.0, 4.0]);
    assert!(cut.notices.iter().any(|notice| matches!(notice, Notice::RowCutOff { .. })));
    assert!(error_of("nothing\nbut\nwords\n").contains("no samples; expected rows of numbers"));
}

#[test]
fn a_later_block_with_uneven_times_gives_a_notice() {
    let rows = rows(100, |n| format!("{n}.0,1")) + "\n200,1\n201,1\n";
    let file = format!("time_s,force_N\n{rows}");
    let options = ReadOptions { block: 50, ..ReadOptions::default() };
    let mut reader =
        Reader::from_stream("rows", std::io::Cursor::new(file.as_bytes()), &options).unwrap();
    let mut rates = Vec::new();
    while let Some(record) = reader.next_record().unwrap() {
        rates.push((record.len(), record.continues, record.channels[0].sample_rate_hz()));
    }
    assert_eq!(rates, [(50, false, Some(1.0)), (50, true, Some(1.0)), (2, true, None)]);
    assert!(reader.notices().contains(&Notice::UnevenBlock { sample: 100 }));
}

/// A cell that is no number, or a row with too few, does not make headings of the rows above it.
#[test]
fn an_early_cell_that_is_no_number_is_named() {
    let good = |from: u32, to: u32| -> String {
        let row = |n: u32| format!("0.{n:03},{n},1\n");
        (from..to).flat_map(|n| row(n).into_bytes()).map(char::from).collect()
    };
    let head = "time_s,hammer (N),top (g)\n";
    for cell in ["---", "\u{221e}", "OVL", "-OVL", "1.#INF", "#N/A", "broken", "?", ""] {
        for at in [0, 1, 3, 8] {
            let file = format!("{head}{}0.{at:03},0,{cell}\n{}", good(0, at), good(at + 1, 12));
            let message = error_of(&file);
            let expected = format!("line {}: `{cell}` for `top` is no number", at + 2);
            assert!(message.contains(&expected), "{message}");
            let options = |invalid_cells| ReadOptions { invalid_cells, ..ReadOptions::default() };
            let read =
                |invalid_cells| read_bytes(file.as_bytes(), &options(invalid_cells)).unwrap();
            let measured = read(InvalidCells::Dropout);
            let top = samples(&measured.records[0], "top");
            assert!(top.len() == 12 && top[at as usize].is_nan(), "{top:?}");
            let text = measured.notices[0].to_string();
            assert!(
                text.starts_with("1 cells are no numbers") && text.contains("dropouts"),
                "{text}"
            );
            let measured = read(InvalidCells::Overload);
            let top = samples(&measured.records[0], "top")[at as usize];
            // Nothing was measured in an empty cell.
            assert_eq!((top.is_infinite(), top < 0.0), (!cell.is_empty(), cell == "-OVL"));
            assert_eq!(top.is_nan(), cell.is_empty());
        }
    }
    let short = error_of(format!("{head}{}0.003,3\n{}", good(0, 3), good(4, 12)));
    assert!(short.contains("line 5: a row is `2 columns`; expected 3 columns"), "{short}");
    // The axis must be known.
    let axis = format!("{head}{}---,3,1\n{}", good(0, 3), good(4, 12));
    let options = ReadOptions { invalid_cells: InvalidCells::Dropout, ..ReadOptions::default() };
    let message = read_bytes(axis.as_bytes(), &options).unwrap_err().to_string();
    assert!(message.contains("line 5: `---` for `time`"), "{message}");
    // A channel that is never a number.
    let off = format!("{head}{}", rows(9, |n| format!("0.{n:03},1,OVL")));
    assert!(error_of(off).contains("line 2: `OVL` for `top`"));
}

/// Rows of numbers above a second row of headings are told.
#[test]
fn rows_above_headings_are_told() {
    let file = "t (s),F (N)\n0,1\n1,2\nt (s),F (N)\n0,5\n1,6\n2,7\n";
    let measured = parsed(file);
    assert_eq!(samples(&measured.records[0], "F"), [5.0, 6.0, 7.0]);
    assert!(measured.notices.contains(&Notice::RowsAboveHeadings { rows: 2, line: 2 }));
}

/// Each time belongs to its own channel: by places, by names, without names; columns may end early.
#[test]
fn a_time_for_each_channel() {
    let of = |file: &str, name: &str| {
        let measured = parsed(file);
        let channel = measured.records[0].named(name).unwrap();
        (channel.abscissa.clone(), channel.samples.real().unwrap().to_vec())
    };
    let file =
        "Time 1 (s),Hammer (N),Time 2 (s),Acc (g)\n0,1,5,6\n1,2,5.5,7\n2,3,6,8\n3,4,,\n4,5\n";
    assert_eq!(of(file, "Hammer"), (Abscissa::even_time(0.0, 1.0), vec![1.0, 2.0, 3.0, 4.0, 5.0]));
    assert_eq!(of(file, "Acc"), (Abscissa::even_time(5.0, 2.0), vec![6.0, 7.0, 8.0]));
    let file = "t_acc (s),t_hammer (s),hammer (N),acc (g)\n0,5,1,2\n1,6,3,4\n2,7,5,6\n";
    assert_eq!(of(file, "hammer"), (Abscissa::even_time(5.0, 1.0), vec![1.0, 3.0, 5.0]));
    assert_eq!(of(file, "acc"), (Abscissa::even_time(0.0, 1.0), vec![2.0, 4.0, 6.0]));
    let file = "0.0 7 0.5 1\n0.5 8 1.0 2\n1.0 9 1.5 1\n1.5 9 2.0 1\n";
    assert_eq!(of(file, "column 2").0, Abscissa::even_time(0.0, 2.0));
    assert_eq!(of(file, "column 4").0, Abscissa::even_time(0.5, 2.0));
    let message = error_of(
        "t1,t2,F (N),a (g)\n0,5,1,1\n1,5.5,2,2\n2,6,3,3\n3,6.5,1,1\n4,7,1,2\n5,7.5,1,1\n6,8,1,1\n",
    );
    assert!(
        message.contains("`t1` (1.000000 Hz from 0 s) and `t2` (2.000000 Hz from 5 s)"),
        "{message}"
    );
    // A second time of all channels is no channel.
    let measured = parsed("time (s),clock (s),F (N),a (g)\n0,50,1,1\n1,51,2,2\n2,52,1,3\n");
    assert_eq!(measured.records[0].channels.len(), 2);
    assert_eq!(measured.records[0].sample_rate_hz(), Some(1.0));
}

#[test]
fn rows_of_a_header_that_say_what_they_hold() {
    let file = "Point Id,,1:+Z,2:-X\nX Unit,s,,\nY Unit,,N,m/s^2\n0,1,2\n"
        .replace("Point Id,,", "Point Id,")
        .replace("Y Unit,,", "Y Unit,")
        .replace("X Unit,s,,", "X Unit,s,s");
    let measured = parsed(format!("{file}0.001,2,3\n0.002,1,2\n"));
    let record = &measured.records[0];
    assert_eq!(record.sample_rate_hz(), Some(1000.0));
    let named: Vec<(&str, &str)> =
        record.channels.iter().map(|one| (one.name.as_str(), one.unit.text())).collect();
    assert_eq!(named, [("1:+Z", "N"), ("2:-X", "m/s^2")]);
    // With a row of names below, and tabs.
    let file = "Serial\t12\nPoint Id\thammer\ttop\nX Unit\tms\tms\nY Unit\tN\tg\n\
                Time\tCh 1\tCh 2\n0\t1\t2\n1\t2\t3\n2\t1\t2\n";
    let record = &parsed(file).records[0];
    assert_eq!(record.sample_rate_hz(), Some(1000.0));
    assert_eq!(record.of_quantity(ChannelQuantity::Force).unwrap().name, "hammer");
}

#[test]
fn decimal_commas_between_commas_are_said() {
    let message = error_of("time_s,force_N\n0,000,1,5\n0,001,2,5\n0,002,3,5\n");
    assert!(message.contains("decimal commas between commas"), "{message}");
}

#[test]
fn text_in_utf_16() {
    let text = "time_s;force_N\r\n0,000;1,5\r\n0,001;2,5\r\n0,002;3,5\r\n";
    let units: Vec<u16> = text.encode_utf16().collect();
    let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    for file in [[b"\xff\xfe", &little[..]].concat(), [b"\xfe\xff", &big[..]].concat(), little, big]
    {
        let measured = parsed(file);
        assert_eq!(samples(&measured.records[0], "force"), [1.5, 2.5, 3.5]);
        assert_eq!(measured.records[0].sample_rate_hz(), Some(1000.0));
    }
}

/// The unit of a frequency response function is a quotient.
#[test]
fn units_of_frequency_response_functions() {
    let measured = parsed("frequency_hz,H real [m/s^2/N],H imag [m/s^2/N]\n1,1,0\n2,1,1\n3,0,1\n");
    let channel = &measured.records[0].channels[0];
    let units = channel.origin.frf.unwrap();
    assert_eq!((units.response.symbol(), units.excitation.symbol()), ("m/s^2", "N"));
    assert_eq!(measured.notices, []);
}
