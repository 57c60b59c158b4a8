//! TDMS files written by npTDMS and by hand; see PROVENANCE.md beside them.

use asperity_measure::{
    Abscissa, ChannelQuantity, ChannelUnit, Format, MeasureError, Notice, ReadOptions, open, read,
};

use crate::build::{read_reference, reference, samples};

fn left_out<'n>(notices: &'n [Notice], name: &str) -> Option<&'n str> {
    notices.iter().find_map(|notice| match notice {
        Notice::ArrayLeftOut { array, reason } if array == name => Some(*reason),
        _ => None,
    })
}

fn start_of(abscissa: &Abscissa) -> f64 {
    abscissa.at(0).unwrap()
}

#[test]
fn hits_in_segments_by_nptdms() {
    let expected = read_reference("expected.npz");
    let (force, acc) =
        (samples(&expected.records[0], "force"), samples(&expected.records[0], "acc"));
    let measured = read_reference("hits.tdms");
    assert_eq!((measured.format, measured.records.len()), (Format::Tdms, 2));
    let first = &measured.records[0];
    assert_eq!(first.title, "Hit 1");
    assert_eq!(first.date, "2026-11-01T10:00:00.250000Z");
    assert_eq!(first.sample_rate_hz(), Some(51_200.0));
    assert_eq!(start_of(&first.channels[0].abscissa), -0.001);
    assert_eq!(samples(first, "hammer"), force, "doubles to the last bit");
    let single: Vec<f64> = acc.iter().map(|value| f64::from(*value as f32)).collect();
    assert_eq!(samples(first, "top"), single);
    assert_eq!(first.of_quantity(ChannelQuantity::Force).unwrap().name, "hammer");
    assert_eq!(first.named("top").unwrap().unit.text(), "g");
    assert_eq!(first.named("hammer").unwrap().origin.description, "tip: steel");
    let second = &measured.records[1];
    assert_eq!(second.title, "Dr. T's hit");
    let doubled: Vec<f64> = force.iter().map(|value| 2.0 * value).collect();
    assert_eq!(samples(second, "ham'mer"), doubled);
    assert_eq!(left_out(&measured.notices, "remarks"), Some("its values are texts"));
    assert_eq!(measured.notices.len(), 1, "{:?}", measured.notices);
}

#[test]
fn scales_as_nptdms_applies_them() {
    let expected = read_reference("scales_expected.npz");
    let measured = read_reference("scales.tdms");
    let record = &measured.records[0];
    for name in ["by group", "by both"] {
        let (found, theirs) = (samples(record, name), samples(&expected.records[0], name));
        for (found, theirs) in found.iter().zip(theirs) {
            // Products and sums of three terms, perhaps fused by one of the two.
            assert!((found - theirs).abs() <= 1e-14 * theirs.abs().max(1.0), "{name}");
        }
    }
    // By hand: counts of 100 times the force, 0.01 a count, less 2.
    let force = samples(&read_reference("expected.npz").records[0], "force")[12];
    let by_hand = (100.0 * force).round() * 0.01 - 2.0;
    assert!((samples(record, "by group")[12] - by_hand).abs() < 1e-12);
    let raw = samples(record, "done");
    let both = samples(record, "by both");
    for (raw, both) in raw.iter().zip(both) {
        let volts = 0.125 * raw + 1.0;
        assert_eq!(raw.fract(), 0.0, "said to be scaled already: counts as they are");
        assert!((both - (0.5 - 2.0 * volts + 0.25 * volts * volts)).abs() < 1e-9);
    }
}

#[test]
fn every_type_of_numbers_and_no_rate() {
    let error = read(&reference("types.tdms"), &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, MeasureError::NoSampleRate { .. }), "{error}");
    let options = ReadOptions { sample_rate_hz: Some(100.0), ..ReadOptions::default() };
    let measured = read(&reference("types.tdms"), &options).unwrap();
    assert_eq!(measured.records[0].channels.len(), 10);
    assert!(measured.notices.contains(&Notice::RateOfOptions { rate_hz: 100.0 }));
    for channel in &measured.records[0].channels {
        assert_eq!(channel.samples.real(), Some(&[0.0, 1.0, 2.0, 100.0][..]), "{}", channel.name);
        assert_eq!(channel.sample_rate_hz(), Some(100.0));
        assert_eq!(channel.unit, ChannelUnit::Missing);
    }
}

#[test]
fn interleaved_big_endian_rows() {
    let measured = read_reference("interleaved.tdms");
    let record = &measured.records[0];
    assert_eq!((measured.records.len(), record.sample_rate_hz()), (1, Some(4.0)));
    let expected: Vec<f64> = (0..12).map(|n| 0.5 * f64::from(n)).collect();
    assert_eq!(samples(record, "a"), expected);
    let expected: Vec<f64> = (0..12).map(|n| -f64::from(n)).collect();
    assert_eq!(samples(record, "b"), expected);
}

#[test]
fn incremental_segments_and_one_not_closed() {
    let options = ReadOptions { sample_rate_hz: Some(8.0), ..ReadOptions::default() };
    let measured = read(&reference("incremental.tdms"), &options).unwrap();
    let channel = |name: &str| {
        let record = measured.records.iter().find(|record| record.named(name).is_some()).unwrap();
        record.named(name).unwrap()
    };
    let (a, b) = (channel("a").samples.real().unwrap(), channel("b").samples.real().unwrap());
    assert_eq!((a.len(), b.len()), (16, 20));
    assert!(a.iter().enumerate().all(|(n, value)| *value == n as f64), "{a:?}");
    assert!(b.iter().enumerate().all(|(n, value)| *value == -(n as f64)), "{b:?}");
    assert_eq!(start_of(&channel("a").abscissa), 1.5, "the property that came last");
    let cut = |notice: &Notice| matches!(notice, Notice::SegmentCutOff { .. });
    assert_eq!(measured.notices.iter().filter(|notice| cut(notice)).count(), 1);
}

#[test]
fn blocks_join_to_the_whole() {
    for name in ["hits.tdms", "scales.tdms", "interleaved.tdms", "incremental.tdms"] {
        let whole_options = ReadOptions { sample_rate_hz: Some(8.0), ..ReadOptions::default() };
        let whole = read(&reference(name), &whole_options).unwrap();
        let options = ReadOptions { block: 5, ..whole_options };
        let mut reader = open(&reference(name), &options).unwrap();
        for record in &whole.records {
            let mut channels = vec![Vec::new(); record.channels.len()];
            while channels[0].len() < record.len() {
                let block = reader.next_record().unwrap().unwrap();
                assert_eq!(block.continues, !channels[0].is_empty(), "{name}");
                let at = record.channels[0].abscissa.at(channels[0].len());
                assert!((start_of(&block.channels[0].abscissa) - at.unwrap()).abs() < 1e-12);
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
