//! Written files read back: binary formats and CSV to the last bit, the
//! text of universal files to its last digit.

use asperity_measure::{
    Abscissa, ChannelQuantity, Complex64, Format, ReadOptions, Record, Samples, WriteOptions, read,
    write,
};
use proptest::prelude::*;

use crate::build::{channel, record};

fn there_and_back(records: &[Record], format: Format) -> Vec<Record> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    write(&path, records, format, &WriteOptions::default()).unwrap();
    let measured = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(measured.format, format);
    measured.records
}

/// Finite doubles of every magnitude.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>().prop_filter("finite", |value| value.is_finite()), -100.0..100.0]
}

fn rate() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(25_600.0),
        Just(51_200.0),
        Just(44_100.0),
        Just(204_800.0),
        (1..1_000_000_u32).prop_map(f64::from)
    ]
}

fn unit() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec!["N", "kN", "g", "m/s^2", "mm/s", "um", "V", "psi", "NONE", "furlong"])
}

fn two_channels(length: usize) -> impl Strategy<Value = Record> {
    let samples = || prop::collection::vec(number(), length);
    (samples(), samples(), unit(), unit(), rate()).prop_map(|(one, two, unit, other, rate)| {
        record(vec![channel("hammer", unit, rate, one), channel("top 2", other, rate, two)])
    })
}

/// Twelve decimals, thirteen digits: half a unit of the last.
fn same_to_the_last_digit(one: f64, other: f64) -> bool {
    // Subnormal numbers have fewer digits.
    (one - other).abs() <= 5.000_001e-13 * 10.0 * one.abs().max(f64::MIN_POSITIVE)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn binary_and_shortest_decimals_keep_every_bit(record in (2_usize..40).prop_flat_map(two_channels)) {
        for format in [Format::UniversalBinary, Format::Text, Format::Npz] {
            let back = there_and_back(std::slice::from_ref(&record), format);
            prop_assert_eq!(back.len(), 1);
            for (written, found) in record.channels.iter().zip(&back[0].channels) {
                prop_assert_eq!(&written.name, &found.name);
                prop_assert_eq!(&written.unit, &found.unit, "{}", format);
                prop_assert_eq!(&written.samples, &found.samples, "{}", format);
                prop_assert_eq!(written.sample_rate_hz(), found.sample_rate_hz(), "{}", format);
            }
        }
    }

    #[test]
    fn universal_text_keeps_its_digits(record in (1_usize..40).prop_flat_map(two_channels)) {
        let back = there_and_back(std::slice::from_ref(&record), Format::UniversalText);
        for (written, found) in record.channels.iter().zip(&back[0].channels) {
            prop_assert_eq!(&written.unit, &found.unit);
            prop_assert_eq!(written.sample_rate_hz(), found.sample_rate_hz());
            let (written, found) = (written.samples.real().unwrap(), found.samples.real().unwrap());
            prop_assert_eq!(written.len(), found.len());
            for (one, other) in written.iter().zip(found) {
                prop_assert!(same_to_the_last_digit(*one, *other), "{} {}", one, other);
            }
        }
    }

    #[test]
    fn complex_and_uneven(parts in prop::collection::vec((number(), number(), 1e-3..10.0), 2..30)) {
        let complex = parts.iter().map(|(re, im, _)| Complex64::new(*re, *im)).collect();
        let mut spectrum = channel("spectrum", "N", 1.0, vec![]);
        spectrum.samples = Samples::Complex(complex);
        spectrum.abscissa = Abscissa::Even { start: 10.0, step: 2.5, quantity: ChannelQuantity::Frequency };
        let mut bent = channel("bent", "mm", 1.0, parts.iter().map(|part| part.0).collect());
        let mut time = 0.0;
        let times: Vec<f64> = parts.iter().map(|(_, _, step)| { time += step; time }).collect();
        bent.abscissa = Abscissa::Uneven { values: times, quantity: ChannelQuantity::Time };
        for format in [Format::UniversalBinary, Format::Npz] {
            for channel in [&spectrum, &bent] {
                let back = there_and_back(&[record(vec![channel.clone()])], format);
                let found = &back[0].channels[0];
                prop_assert_eq!(&found.samples, &channel.samples, "{}", format);
                for index in 0..parts.len() {
                    let (written, read) = (channel.abscissa.at(index), found.abscissa.at(index));
                    let (written, read) = (written.unwrap(), read.unwrap());
                    // An even axis of frequencies may be read as start and step, with rounding at its end.
                    prop_assert!((written - read).abs() <= 1e-12 * written.abs() * 100.0);
                }
            }
        }
    }
}

#[test]
fn several_hits_are_several_records() {
    let hit = |factor: f64| {
        record(vec![
            channel("force", "N", 1000.0, vec![factor, 2.0 * factor]),
            channel("acc", "g", 1000.0, vec![-factor, 0.5 * factor]),
        ])
    };
    let records = [hit(1.0), hit(3.0), hit(-2.0)];
    for format in [Format::UniversalText, Format::UniversalBinary, Format::Npz] {
        let back = there_and_back(&records, format);
        assert_eq!(back.len(), 3, "{format}");
        for (written, found) in records.iter().zip(&back) {
            for (written, found) in written.channels.iter().zip(&found.channels) {
                assert_eq!((&written.name, &written.samples), (&found.name, &found.samples));
                assert_eq!(written.abscissa, found.abscissa, "{format}");
            }
        }
    }
}
