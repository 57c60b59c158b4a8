//! TDMS files with the most content for their length, and inconsistent ones.

use asperity_measure::{MeasureError, ReadOptions, read_bytes};

use crate::counting::{peak_of, start_counting};

const METADATA: u32 = 2;
const NEW_LIST: u32 = 4;
const RAW: u32 = 8;
const INTERLEAVED: u32 = 32;
const ALL: u32 = METADATA | NEW_LIST | RAW;

fn word(value: usize) -> [u8; 4] {
    u32::try_from(value).unwrap().to_le_bytes()
}

/// A channel of bytes at a rate.
fn channel(name: usize, values: u64, rate: f64) -> Vec<u8> {
    let path = format!("/'g'/'{name}'");
    let index = [20_u32, 5, 1].map(u32::to_le_bytes).concat();
    let increment = 1.0 / rate;
    let property =
        [&word(12)[..], b"wf_increment", &10_u32.to_le_bytes(), &increment.to_le_bytes()].concat();
    let head = [&word(path.len())[..], path.as_bytes(), &index, &values.to_le_bytes()].concat();
    [head, 1_u32.to_le_bytes().to_vec(), property].concat()
}

fn segment(contents: u32, objects: &[Vec<u8>], raw: &[u8]) -> Vec<u8> {
    let metadata = if contents & METADATA == 0 {
        Vec::new()
    } else {
        [&word(objects.len())[..], &objects.concat()].concat()
    };
    let (metadata_length, length) = (metadata.len() as u64, (metadata.len() + raw.len()) as u64);
    [
        b"TDSm".as_slice(),
        &contents.to_le_bytes(),
        &4713_u32.to_le_bytes(),
        &length.to_le_bytes(),
        &metadata_length.to_le_bytes(),
        &metadata,
        raw,
    ]
    .concat()
}

fn bytes(count: usize) -> Vec<u8> {
    (0..count).map(|n| (n % 251) as u8).collect()
}

/// Samples of the first channel, and peak memory as a multiple of the file.
fn read(file: &[u8]) -> (Result<usize, MeasureError>, f64) {
    start_counting();
    let measured = read_bytes(file, &ReadOptions::default());
    let ratio = peak_of().saturating_sub(1 << 20) as f64 / file.len() as f64;
    (measured.map(|measured| measured.records[0].len()), ratio)
}

#[test]
fn valid_files_stay_within_ten_times_their_size() {
    let two = [channel(1, 1_000_000, 100.0), channel(2, 1_000_000, 100.0)];
    let one = segment(ALL, &[channel(1, 1, 100.0)], &[7]);
    let single = segment(RAW, &[], &[7]);
    let again = segment(METADATA | RAW, &[channel(1, 1, 100.0)], &[7]);
    let twice = segment(RAW, &[], &[7, 7]);
    let pair = |first, second| [channel(1, first, 100.0), channel(2, second, 100.0)];
    let both = [segment(ALL, &pair(1, 1), &[7; 2]), segment(RAW, &[], &[7; 2]).repeat(50_000)];
    let (even, odd) = (
        segment(METADATA | RAW, &pair(1, 1), &[7; 2]),
        segment(METADATA | RAW, &pair(2, 2), &[7; 4]),
    );
    let uneven = [segment(ALL, &pair(1, 1), &[7; 2]), [even, odd].concat().repeat(10_000)];
    for (name, file, samples) in [
        ("two channels, a segment a sample", both.concat(), 50_001),
        ("two channels, uneven segments", uneven.concat(), 30_001),
        ("one after the other", segment(ALL, &two, &bytes(2_000_000)), 1_000_000),
        ("interleaved", segment(ALL | INTERLEAVED, &two, &bytes(2_000_000)), 1_000_000),
        ("many chunks", segment(ALL, &[channel(1, 1, 100.0)], &bytes(2_000_000)), 2_000_000),
        ("a segment a sample", [one.clone(), single.repeat(50_000)].concat(), 50_001),
        ("with metadata each", [one.clone(), again.repeat(20_000)].concat(), 20_001),
        ("uneven segments", [one, [single, twice].concat().repeat(20_000)].concat(), 60_001),
    ] {
        let (found, ratio) = read(&file);
        assert_eq!(found.unwrap(), samples, "{name}");
        assert!(ratio < 10.0, "{name}: {ratio:.1} times the file");
    }
}

/// Each segment changes one channel of thousands: the memory of the positions of
/// their samples is limited by the size of the file.
#[test]
fn a_list_of_thousands_of_channels_repeated_in_each_segment() {
    let channels: Vec<Vec<u8>> = (0..4000).map(|n| channel(n, 1, 100.0)).collect();
    let mut file = segment(ALL, &channels, &bytes(4000));
    for n in 0..400 {
        let size = 1 + n % 2;
        file.extend(segment(
            METADATA | RAW,
            &[channel(0, size, 100.0)],
            &bytes(3999 + size as usize),
        ));
    }
    let (found, ratio) = read(&file);
    assert!(ratio < 10.0, "{ratio:.1} times the file");
    if let Err(error) = found {
        assert!(matches!(error, MeasureError::TooLarge { .. }), "{error}");
    }
}

/// Each channel with another rate needs a pass over all rows.
#[test]
fn thousands_of_rates_in_one_row() {
    let channels: Vec<Vec<u8>> = (0..4000).map(|n| channel(n, 500, 1.0 + n as f64)).collect();
    let (found, ratio) = read(&segment(ALL | INTERLEAVED, &channels, &bytes(2_000_000)));
    let message = found.unwrap_err().to_string();
    assert!(message.contains("scattered over 65 rates"), "{message}");
    assert!(ratio < 10.0, "{ratio:.1} times the file");
}

#[test]
fn more_channels_than_accepted() {
    let channels: Vec<Vec<u8>> = (0..60_000)
        .map(|n| {
            let path = format!("/'g'/'{n}'");
            [&word(path.len())[..], path.as_bytes(), &[0xff; 4], &[0; 4]].concat()
        })
        .collect();
    let (found, ratio) = read(&segment(METADATA, &channels, &[]));
    let message = found.unwrap_err().to_string();
    assert!(message.contains("the number of channels is"), "{message}");
    assert!(ratio < 10.0, "{ratio:.1} times the file");
}

/// Channels whose texts take no bytes.
#[test]
fn counts_beyond_the_file() {
    let many = segment(METADATA | RAW, &[channel(1, u64::MAX, 100.0), channel(2, 3, 1.0)], &[1; 8]);
    let (found, _) = read(&many);
    assert!(found.unwrap_err().to_string().contains("expected a multiple of"));
    let mut objects = segment(METADATA, &[channel(1, 1, 1.0)], &[]);
    objects[28..32].copy_from_slice(&[0xff; 4]);
    let (found, _) = read(&objects);
    assert!(matches!(found.unwrap_err(), MeasureError::Truncated { .. }));
}
