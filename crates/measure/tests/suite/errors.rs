//! Errors with file, position and expected content.

use asperity_measure::{Format, MeasureError, ReadOptions, open, read, read_bytes};

use crate::build::{error_of, reference};

#[test]
fn a_missing_file_and_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("none.uff"), folder.path().to_owned()] {
        let error = read(&path, &ReadOptions::default()).unwrap_err();
        assert!(matches!(error, MeasureError::Io { .. }));
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
    }
}

#[test]
fn the_content_decides_on_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("really.csv");
    std::fs::copy(reference("pyuff_binary.uff"), &path).unwrap();
    let reader = open(&path, &ReadOptions::default()).unwrap();
    assert_eq!(reader.format(), Format::UniversalBinary);
}

#[test]
fn unknown_and_unsupported_formats() {
    for (content, expected) in [
        (&b""[..], "unknown format"),
        (b"\x7fELF\0\0\0\0", "unknown format; expected one of UFF 58, text"),
        (b"TDSh\0\0\0\0", "the index of a TDMS file cannot be read; give the `.tdms` file"),
        (b"RF64\0\0\0\0WAVE", "cannot be read; save it as RIFF"),
        (b"RIFF\0\0\0\0WAVE", "the WAVE file"),
        (b"\x93NUMPY\x07\0\0\0", "the NPY version is `7`; expected 1, 2 or 3"),
        (b"PK\x03\x04", "a zip archive"),
    ] {
        let message = error_of(content);
        assert!(message.starts_with("bytes") && message.contains(expected), "{message}");
    }
}

#[test]
fn errors_of_arrays() {
    let array = |text: &str, data: usize| {
        let mut text = text.as_bytes().to_vec();
        text.resize(118, b' ');
        [b"\x93NUMPY\x01\0\x76\0".as_slice(), &text, &vec![0; data]].concat()
    };
    for (text, data, expected) in [
        (
            "{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }",
            31,
            "byte 128: the array needs 32 bytes; the file has 31",
        ),
        (
            "{'descr': '<U8', 'fortran_order': False, 'shape': (4,), }",
            128,
            "the type of the array is `<U8`",
        ),
        (
            "{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (4,), }",
            32,
            "the type of the array",
        ),
        ("{'descr': '<f8', 'fortran_order': 3, 'shape': (4,), }", 32, "expected True or False"),
        (
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-4,), }",
            32,
            "the shape of the array",
        ),
        (
            "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2, 2), }",
            32,
            "one or two dimensions",
        ),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (0,), }", 32, "one or two dimensions"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }", 32, "of shape 2 x 2"),
    ] {
        let message = error_of(array(text, data));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn invalid_options() {
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = ReadOptions { sample_rate_hz: Some(rate), ..ReadOptions::default() };
        let error = read_bytes(b"1\n2\n", &options).unwrap_err();
        assert!(matches!(error, MeasureError::Option { option: "sample_rate_hz", .. }), "{error}");
    }
    // A block of zero samples becomes one of one sample.
    let options = ReadOptions { block: 0, sample_rate_hz: Some(1.0), ..ReadOptions::default() };
    let mut reader =
        asperity_measure::Reader::from_stream("b", std::io::Cursor::new(b"1\n2\n"), &options)
            .unwrap();
    assert_eq!(reader.next_record().unwrap().unwrap().len(), 1);
}

#[test]
fn an_error_ends_the_records() {
    let file = b"time_s,f_N\n0,1\n1,2\n2,x\n3,4\n";
    let mut reader = asperity_measure::Reader::from_stream(
        "f",
        std::io::Cursor::new(&file[..]),
        &ReadOptions::default(),
    )
    .unwrap();
    assert!(reader.next_record().is_err());
    assert_eq!(reader.next_record().unwrap(), None);
}
