//! Measurements, if available: copies of the same hits in four
//! formats agree to the precision of each. They are not part of the
//! repository; without them these tests are skipped with a message.

use std::path::PathBuf;

use asperity_measure::{ChannelQuantity, Format, Measurement, Notice, ReadOptions, open, read};

fn data(name: &str) -> Option<PathBuf> {
    let path =
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).join(name);
    if !path.exists() {
        eprintln!("skipped: {name} is not at hand");
        return None;
    }
    Some(path)
}

fn measured(name: &str) -> Option<Measurement> {
    data(name).map(|path| read(&path, &ReadOptions::default()).unwrap())
}

fn largest_difference(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn three_hits_of_force_and_acceleration() {
    for (name, format) in [
        ("pyfrf_hammer/hits_1_to_3_binary.uff", Format::UniversalBinary),
        ("pyfrf_hammer/hits_1_to_3_ascii.uff", Format::UniversalText),
    ] {
        let Some(measured) = measured(name) else { return };
        assert_eq!((measured.format, measured.records.len()), (format, 3));
        assert_eq!(measured.notices, []);
        for record in &measured.records {
            assert_eq!(record.sample_rate_hz(), Some(25_600.0));
            assert_eq!((record.channels.len(), record.len()), (2, 25_600));
            let force = record.of_quantity(ChannelQuantity::Force).unwrap();
            let acceleration = record.of_quantity(ChannelQuantity::Acceleration).unwrap();
            assert_eq!((force.unit.text(), acceleration.unit.text()), ("N", "m/s^2"));
            let peak = force.samples.real().unwrap().iter().copied().fold(0.0, f64::max);
            assert!((68.5..89.5).contains(&peak), "the data's own note: peaks of 69 to 89");
        }
    }
}

#[test]
fn four_copies_of_a_hit_agree() {
    let binary = measured("pyfrf_hammer/hits_1_to_3_binary.uff");
    let ascii = measured("pyfrf_hammer/hits_1_to_3_ascii.uff");
    let (Some(binary), Some(ascii)) = (binary, ascii) else { return };
    for hit in 1..=3 {
        let Some(array) = measured(&format!("pyfrf_hammer/hit_{hit}.npy")) else { return };
        assert_eq!(array.records[0].sample_rate_hz(), Some(25_600.0));
        for channel in 0..2 {
            let exact = array.records[0].channels[channel].samples.real().unwrap();
            let doubles = binary.records[hit - 1].channels[channel].samples.real().unwrap();
            assert_eq!(exact, doubles, "doubles to the last bit");
            let printed = ascii.records[hit - 1].channels[channel].samples.real().unwrap();
            for (exact, printed) in exact.iter().zip(printed) {
                // Eleven decimals: half a unit of the twelfth digit.
                assert!((exact - printed).abs() <= 5.1e-12 * exact.abs().max(printed.abs()) * 10.0);
            }
        }
    }
    let Some(text) = measured("pyfrf_hammer/hit_1.csv") else { return };
    assert_eq!(text.records[0].sample_rate_hz(), Some(25_600.0));
    let (force, exact) = (&text.records[0].channels[0], &binary.records[0].channels[0]);
    assert_eq!((force.name.as_str(), force.unit.text()), ("force", "N"));
    assert_eq!(text.records[0].channels[1].unit.text(), "m/s^2");
    // Eight digits of at most 89 N: half a unit of 1e-6.
    let difference =
        largest_difference(force.samples.real().unwrap(), exact.samples.real().unwrap());
    assert!(difference <= 5.1e-7, "{difference}");
}

#[test]
fn a_microphone_as_text_and_binary() {
    let text = measured("uff_samples/Sample_UFF58_ascii.uff");
    let binary = measured("uff_samples/Sample_UFF58b_bin.uff");
    let (Some(text), Some(binary)) = (text, binary) else { return };
    for measured in [&text, &binary] {
        let channel = &measured.records[0].channels[0];
        assert_eq!((channel.quantity, channel.unit.text()), (ChannelQuantity::Pressure, "Pa"));
        // The printed step of 1.52588E-05 alone gives a rate of 65535.95 Hz.
        assert_eq!(channel.sample_rate_hz(), Some(65_536.0));
        let snapped =
            |notice: &Notice| matches!(notice, Notice::RateSnapped { taken_hz: 65_536.0, .. });
        assert!(measured.notices.iter().any(snapped));
        assert_eq!(channel.origin.date, "18-Apr-16 13:49:58");
    }
    let samples =
        |measured: &Measurement| measured.records[0].channels[0].samples.real().unwrap().to_vec();
    let (text, binary) = (samples(&text), samples(&binary));
    assert_eq!(text.len(), 79_292);
    for (printed, single) in text.iter().zip(&binary) {
        // Six digits: half a unit of the sixth.
        assert!((printed - single).abs() <= 5.1e-6 * printed.abs(), "{printed} {single}");
    }
}

#[test]
fn blocks_join_to_the_whole() {
    for name in [
        "pyfrf_hammer/hits_1_to_3_binary.uff",
        "pyfrf_hammer/hits_1_to_3_ascii.uff",
        "pyfrf_hammer/hit_1.csv",
        "pyfrf_hammer/hit_1.npy",
    ] {
        let (Some(path), Some(whole)) = (data(name), measured(name)) else { return };
        let options = ReadOptions { block: 7_001, ..ReadOptions::default() };
        let mut reader = open(&path, &options).unwrap();
        for record in &whole.records {
            let mut channels = vec![Vec::new(); record.channels.len()];
            while channels[0].len() < record.len() {
                let block = reader.next_record().unwrap().unwrap();
                assert_eq!(block.continues, !channels[0].is_empty(), "{name}");
                let start = block.channels[0].abscissa.at(0).unwrap();
                assert!((start - channels[0].len() as f64 / 25_600.0).abs() < 1e-9, "{name}");
                for (channel, samples) in block.channels.iter().zip(&mut channels) {
                    samples.extend_from_slice(channel.samples.real().unwrap());
                }
            }
            for (channel, samples) in record.channels.iter().zip(channels) {
                assert_eq!(channel.samples.real(), Some(&samples[..]), "{name}");
            }
        }
        assert_eq!(reader.next_record().unwrap(), None);
    }
}
