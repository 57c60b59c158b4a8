//! Files cut anywhere and changed at random: a result or an error, never a panic, and no memory by announcement.

use asperity_matrices::{Deck, MatricesFormat, ReducedModel, read_bytes};

use crate::files::{Mat, Value, npy, npz};

const ROWS: &[u8] = b"1.1\n1.2\n2.1\n";
const MASS: &[u8] = b"1 1 1.0\n2 2 1.0\n3 3 1.0\n";

/// Marsaglia's xorshift64.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit.max(1) as u64) as usize
    }

    fn changed(&mut self, seed: &[u8]) -> Vec<u8> {
        const WORDS: [&[u8]; 10] = [
            b"99999999999",
            b"-1",
            b"\n",
            b"nan",
            b",",
            b"\xff\xff\xff\x7f",
            b"\0\0\0\0",
            b"\x80",
            b"*NSET, NSET=A\n",
            b"1e999",
        ];
        let mut bytes = seed.to_vec();
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len());
            match self.below(4) {
                0 if !bytes.is_empty() => bytes[at] ^= 1 << self.below(8),
                1 if !bytes.is_empty() => {
                    let end = (at + 1 + self.below(16)).min(bytes.len());
                    bytes.drain(at..end);
                }
                _ => {
                    let word = WORDS[self.below(WORDS.len())];
                    bytes.splice(at..at, word.iter().copied());
                }
            }
        }
        bytes
    }
}

fn try_all(seed: &[u8], read: impl Fn(&[u8]) -> bool) {
    assert!(read(seed), "the seed is readable");
    let mut refused = 0;
    for length in 0..seed.len() {
        refused += usize::from(!read(&seed[..length]));
    }
    let mut random = Random(0x9e37_79b9);
    for _ in 0..2000 {
        refused += usize::from(!read(&random.changed(seed)));
    }
    assert!(refused > seed.len() / 4, "{refused} of {}", seed.len());
}

#[test]
fn texts() {
    let read = |format, stiffness: &[u8], mass: &[u8]| {
        read_bytes(format, stiffness, Some(mass), Some(ROWS)).is_ok()
    };
    let calculix = b"1 1  4.0e+00\n1 2 -1.0e+00\n2 2  5.0e+00\n2 3 -2.0e+00\n3 3  6.0e+00\n";
    try_all(calculix, |bytes| read(MatricesFormat::Calculix, bytes, MASS));
    try_all(calculix, |bytes| read(MatricesFormat::Abaqus, bytes, MASS));
    let abaqus = b"1,1, 1,1,  4.0e+00\n1,2, 1,1, -1.0e+00\n1,2,1,2,5.0\n2,1,2,1,6.0e+00\n";
    let mass = b"1,1,1,1,1.0\n";
    try_all(abaqus, |bytes| read_bytes(MatricesFormat::Abaqus, bytes, Some(mass), None).is_ok());
    let market =
        |entries: &str| format!("%%MatrixMarket matrix coordinate real general\n3 3 {entries}");
    let (stiffness, mass) = (market("4\n1 1 1\n2 2 1\n3 3 1e0\n2 1 0.0\n"), market("1\n1 1 1.0\n"));
    try_all(stiffness.as_bytes(), |bytes| {
        read(MatricesFormat::MatrixMarket, bytes, mass.as_bytes())
    });
    let punch = "DMIG    KAAX           0       6       2\nDMIG*   KAAX                          21               2\n\
                 *                     21               2 4.000000000D+00\nDMIG,MAAX,0,6,1\nDMIG,MAAX,21,2,,21,2,1.5-3\n";
    try_all(punch.as_bytes(), |bytes| {
        read_bytes(MatricesFormat::Nastran, bytes, None, None).is_ok()
    });
    try_all(ROWS, |rows| {
        read_bytes(MatricesFormat::Calculix, calculix, Some(MASS), Some(rows)).is_ok()
    });
}

#[test]
fn arrays() {
    let k = vec![2.0, -1.0, 0.0, -1.0, 2.0, 0.0, 0.0, 0.0, 1.0];
    let rows = vec![1.0, 1.0, 2.0, 1.0, 2.0, 1.0];
    for compressed in [false, true] {
        for sparse in [false, true] {
            let value = |values: &[f64]| {
                if sparse { Value::Sparse(values.to_vec()) } else { Value::Full(values.to_vec()) }
            };
            let mut mat = Mat::new(false, compressed);
            mat.add("K", 3, 3, &value(&k));
            mat.add("M", 3, 3, &value(&k));
            mat.add("dof", 3, 2, &Value::Small(rows.clone()));
            try_all(&mat.bytes(), |bytes| {
                read_bytes(MatricesFormat::Matlab, bytes, None, None).is_ok()
            });
            let mut mat = Mat::new(true, compressed);
            mat.add("K", 3, 3, &value(&k));
            mat.add("M", 3, 3, &value(&k));
            mat.add("W", 1, 3, &Value::Full(vec![1.0; 3]));
            mat.add("area", 1, 1, &Value::Full(vec![1e-4]));
            try_all(&mat.bytes(), |bytes| ReducedModel::of_bytes("r.mat", bytes).is_ok());
        }
    }
    let le =
        |values: &[f64]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>();
    let archive = npz(&[
        ("K", npy("'<f8'", false, "(3, 3)", &le(&k))),
        ("M", npy("'<f8'", true, "(3, 3)", &le(&k))),
        ("dof", npy("'<f8'", true, "(3, 2)", &le(&rows))),
    ]);
    try_all(&archive, |bytes| read_bytes(MatricesFormat::Npz, bytes, None, None).is_ok());
}

#[test]
fn decks() {
    let deck = "*NODE, NSET=N\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, ELSET=E\n7,1,2,3,4\n\
                *NSET, NSET=A, GENERATE\n1,3,2\n*NSET, NSET=B\nA,2\n*SURFACE, NAME=S\nE,S1\n7,S2\n";
    try_all(deck.as_bytes(), |bytes| {
        Deck::of_text("a.inp", &String::from_utf8_lossy(bytes))
            .is_ok_and(|deck| deck.surface("S").is_ok())
    });
}
