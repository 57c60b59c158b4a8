//! Valid files of a few megabytes with the most numbers, channels or
//! datasets for their length: memory stays within ten times their size.

use asperity_measure::{ReadOptions, read_bytes};

use crate::counting::{peak_of, start_counting};

fn stays_small(name: &str, bytes: &[u8], records: usize) {
    let options = ReadOptions { sample_rate_hz: Some(1000.0), ..ReadOptions::default() };
    start_counting();
    let measured = read_bytes(bytes, &options).unwrap();
    let ratio = peak_of() as f64 / bytes.len() as f64;
    assert_eq!(measured.records.len(), records, "{name}");
    assert!(ratio < 10.5, "{name}: {ratio:.1} times the file");
}

fn dataset(points: usize, numbers: &str) -> String {
    // Lines without blanks at their ends, the shortest with a node.
    let nodes = "    1         0    1         0 BEAM               7   3 BEAM               1   3";
    format!(
        "    -1\n    58\nforce\n\n\n\n\n{nodes}\n2 {points} 1 0 1 0\n\n\n\n\n{numbers}\n    -1\n"
    )
}

#[test]
fn numbers_of_one_digit() {
    stays_small("two columns", "1 2\n".repeat(500_000).as_bytes(), 1);
    stays_small("one column", "1\n".repeat(1_000_000).as_bytes(), 1);
    let uneven: String =
        (0..200_000_u64).fold(String::new(), |text, n| text + &(n * n).to_string() + " 1\n");
    stays_small("uneven", format!("time_s f_N\n{uneven}").as_bytes(), 1);
    stays_small("dataset 58", dataset(1_000_000, &"1 1 1 1\n".repeat(250_000)).as_bytes(), 1);
}

#[test]
fn datasets_of_one_point() {
    let one = dataset(1, "1");
    stays_small("tiny datasets", one.repeat(20_000).as_bytes(), 20_000);
}

#[test]
fn bytes_as_numbers() {
    let npy = |shape: &str, kind: &str| {
        let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}")
            .into_bytes();
        text.resize(118, b' ');
        let data = (0..2_000_000_u32).map(|n| (n % 251) as u8);
        [b"\x93NUMPY\x01\x00\x76\x00".as_slice(), &text]
            .concat()
            .into_iter()
            .chain(data)
            .collect::<Vec<u8>>()
    };
    stays_small("rows of bytes", &npy("(2, 1000000)", "|u1"), 1);
    stays_small("columns of bytes", &npy("(1000000, 2)", "|i1"), 1);
    stays_small("many short channels", &npy("(8000, 250)", "|u1"), 1);
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 8000,
        bits_per_sample: 8,
        sample_format: hound::SampleFormat::Int,
    };
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, spec).unwrap();
    for n in 0..2_000_000_u32 {
        writer.write_sample((n % 100) as i8).unwrap();
    }
    writer.finalize().unwrap();
    stays_small("8 bit", &bytes.into_inner(), 1);
}
