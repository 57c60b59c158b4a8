//! Writers of small files: MATLAB 5, NumPy archives, gzip.

use std::io::{Cursor, Write};

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// A MATLAB file of version 5.
pub(crate) struct Mat {
    bytes: Vec<u8>,
    big: bool,
    compressed: bool,
}

/// The values of a variable, column by column.
pub(crate) enum Value {
    Full(Vec<f64>),
    /// Stored as unsigned numbers of 16 bits, as MATLAB stores small whole numbers.
    Small(Vec<f64>),
    /// Values that are not zero.
    Sparse(Vec<f64>),
}

impl Mat {
    pub(crate) fn new(big: bool, compressed: bool) -> Self {
        let mut bytes = vec![b' '; 124];
        bytes.extend(if big { b"\x01\x00MI" } else { b"\x00\x01IM" });
        Self { bytes, big, compressed }
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.bytes.clone()
    }

    /// A variable of text, which readers leave out.
    pub(crate) fn other(&mut self, name: &str) {
        let content = [self.head(4, 1, 2, name), self.element(4, &[0, 65, 0, 66])].concat();
        self.variable(&content);
    }

    pub(crate) fn add(&mut self, name: &str, rows: usize, columns: usize, value: &Value) {
        let doubles = |values: &[f64]| -> Vec<u8> {
            let bytes =
                |value: &f64| if self.big { value.to_be_bytes() } else { value.to_le_bytes() };
            values.iter().flat_map(bytes).collect()
        };
        let content = match value {
            Value::Full(values) => {
                [self.head(6, rows, columns, name), self.element(9, &doubles(values))].concat()
            }
            Value::Small(values) => {
                let short = |value: &f64| {
                    let value = *value as u16;
                    if self.big { value.to_be_bytes() } else { value.to_le_bytes() }
                };
                let bytes: Vec<u8> = values.iter().flat_map(short).collect();
                [self.head(6, rows, columns, name), self.element(4, &bytes)].concat()
            }
            Value::Sparse(values) => {
                let (mut row_of, mut starts, mut kept) = (Vec::new(), vec![0], Vec::new());
                for column in values.chunks(rows) {
                    for (row, value) in
                        column.iter().enumerate().filter(|(_, value)| **value != 0.0)
                    {
                        row_of.push(row as u32);
                        kept.push(*value);
                    }
                    starts.push(kept.len() as u32);
                }
                let words = |words: &[u32]| -> Vec<u8> {
                    words.iter().flat_map(|w| self.word(*w)).collect()
                };
                [
                    self.head(5, rows, columns, name),
                    self.element(5, &words(&row_of)),
                    self.element(5, &words(&starts)),
                    self.element(9, &doubles(&kept)),
                ]
                .concat()
            }
        };
        self.variable(&content);
    }

    fn word(&self, word: u32) -> [u8; 4] {
        if self.big { word.to_be_bytes() } else { word.to_le_bytes() }
    }

    fn head(&self, class: u32, rows: usize, columns: usize, name: &str) -> Vec<u8> {
        let words = |words: [u32; 2]| words.map(|word| self.word(word)).concat();
        let flags = self.element(6, &words([class, 0]));
        let dimensions = self.element(5, &words([rows as u32, columns as u32]));
        [flags, dimensions, self.element(1, name.as_bytes())].concat()
    }

    /// An element; a small one if it has at most four bytes.
    fn element(&self, kind: u32, data: &[u8]) -> Vec<u8> {
        let length = data.len() as u32;
        let small = (1..=4).contains(&length);
        let mut bytes = if small {
            self.word(length << 16 | kind).to_vec()
        } else {
            [self.word(kind), self.word(length)].concat()
        };
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    fn variable(&mut self, content: &[u8]) {
        let whole = [&self.word(14), &self.word(content.len() as u32), content].concat();
        if !self.compressed {
            self.bytes.extend(whole);
            return;
        }
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&whole).unwrap();
        let folded = encoder.finish().unwrap();
        let head = [self.word(15), self.word(folded.len() as u32)].concat();
        self.bytes.extend(head);
        self.bytes.extend(folded);
    }
}

/// An array of NumPy.
pub(crate) fn npy(kind: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// An archive of arrays.
pub(crate) fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        writer.start_file(format!("{name}.npy"), SimpleFileOptions::default()).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

pub(crate) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
