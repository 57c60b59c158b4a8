//! Files that announce more than they contain.

use asperity_measure::{MeasureError, ReadOptions, read_bytes};

use crate::counting::{peak_of, start_counting};
use crate::survive;

fn error_of(bytes: &[u8]) -> MeasureError {
    survive("a lie", bytes);
    read_bytes(bytes, &ReadOptions::default()).map(drop).unwrap_err()
}

#[test]
fn a_trillion_points_in_a_small_universal_file() {
    for kind in ["    58", "    58b     1     2          11           0"] {
        let file = format!(
            "    -1\n{kind}\na\n\n\n\n\n    1\n         4 999999999999 1 0 1e-3 0\n\n\n\n\n1.0 2.0\n    -1\n"
        );
        let error = error_of(file.as_bytes());
        assert!(matches!(error, MeasureError::Truncated { .. }), "{error}");
        assert!(error.to_string().starts_with("bytes, byte "), "{error}");
    }
}

#[test]
fn an_array_of_a_trillion_numbers() {
    for shape in ["(1000000000000,)", "(18446744073709551615, 18446744073709551615)", "(2, 3)"] {
        let mut text =
            format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}").into_bytes();
        text.resize(118, b' ');
        let file = [b"\x93NUMPY\x01\x00\x76\x00".as_slice(), &text, &[0; 16]].concat();
        let error = error_of(&file);
        assert!(matches!(error, MeasureError::Truncated { available: 16, .. }), "{error}");
    }
}

#[test]
fn a_header_that_nests_without_end() {
    let text = [b"{'descr': ".as_slice(), &b"(".repeat(60_000)].concat();
    let length = u32::try_from(text.len()).unwrap().to_le_bytes();
    let file = [b"\x93NUMPY\x02\x00".as_slice(), &length, &text].concat();
    assert!(error_of(&file).to_string().contains("at most 16384"));
}

/// A zip archive of 64 MB of zeros in some 64 kB.
#[test]
fn a_zip_that_expands_to_a_thousand_times_its_size() {
    use std::io::Write;
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut archive = zip::ZipWriter::new(&mut bytes);
    let options = zip::write::SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated);
    archive.start_file("force.npy", options).unwrap();
    let mut text = b"{'descr': '<f8', 'fortran_order': False, 'shape': (8000000,), }".to_vec();
    text.resize(118, b' ');
    archive.write_all(&[b"\x93NUMPY\x01\x00\x76\x00".as_slice(), &text].concat()).unwrap();
    let zeros = vec![0; 64_000];
    for _ in 0..1000 {
        archive.write_all(&zeros).unwrap();
    }
    archive.finish().unwrap();
    let file = bytes.into_inner();
    assert!(file.len() < 200_000);
    assert!(matches!(error_of(&file), MeasureError::TooLarge { announced: 64_000_000.., .. }));
    // Accepted with the option.
    let options =
        ReadOptions { sample_rate_hz: Some(1.0), expansion: 2000, ..ReadOptions::default() };
    assert_eq!(read_bytes(&file, &options).unwrap().records[0].len(), 8_000_000);
}

/// Nested structures: one level is read, without recursion.
#[test]
fn structures_nested_a_thousand_deep() {
    fn element(kind: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes =
            [kind.to_le_bytes(), u32::try_from(data.len()).unwrap().to_le_bytes()].concat();
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }
    let head = |class: u32, name: &[u8]| {
        let flags = [class.to_le_bytes(), [0; 4]].concat();
        let one = [1_u32.to_le_bytes(); 2].concat();
        [element(6, &flags), element(5, &one), element(1, name)].concat()
    };
    let mut inner = element(14, &[head(6, b""), element(9, &1.5_f64.to_le_bytes())].concat());
    for _ in 0..1000 {
        let fields = [element(5, &4_u32.to_le_bytes()), element(1, b"x\0\0\0")].concat();
        inner = element(14, &[head(2, b"s"), fields, inner].concat());
    }
    let mut file = b"MATLAB 5.0 MAT-file".to_vec();
    file.resize(124, b' ');
    file.extend(b"\x00\x01IM");
    file.extend(inner);
    assert!(matches!(error_of(&file), MeasureError::NoSamples { .. }));
}

#[test]
fn a_line_without_end() {
    let file = [b"time_s,force_N\n0,1\n1,2\n".as_slice(), &b"1".repeat(4 << 20)].concat();
    let error = error_of(&file);
    assert!(error.to_string().contains("line 4: a line is"), "{error}");
}

#[test]
fn a_row_of_half_a_million_columns() {
    let file = [b"1,".repeat(500_000), b"1\n".to_vec()].concat();
    start_counting();
    assert!(read_bytes(&file, &ReadOptions::default()).is_err());
    assert!(peak_of() < 10 * file.len());
}

/// A line of a header with as many fields as bytes, each of them a text in memory.
#[test]
fn a_labview_header_of_half_a_million_fields() {
    let head = "LabVIEW Measurement\n***End_of_Header***\n\nChannels\t1\n";
    let fields = "\t".repeat(500_000);
    for file in [
        format!("{head}Y_Unit_Label{fields}\n***End_of_Header***\nX_Value\ta\n0\t1\n1\t2\n"),
        format!("{head}Delta_X{fields}\n***End_of_Header***\nX_Value\ta\n0\t1\n1\t2\n"),
        format!("{head}***End_of_Header***\nX_Value{fields}\n0\t1\n"),
    ] {
        start_counting();
        let _ = read_bytes(file.as_bytes(), &ReadOptions::default());
        assert!(peak_of() < 10 * file.len() + (1 << 20), "{} bytes held", peak_of());
    }
}
