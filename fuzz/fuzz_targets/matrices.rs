//! Matrices in every format: the first byte is the format, the rest the file of the stiffness.
//! A matrix that is read is the lower triangle with the diagonal, in order.
#![no_main]

use asperity_matrices::{MatricesFormat, ReducedModel, SparseSymmetric, read_bytes};
use libfuzzer_sys::fuzz_target;

const ROWS: &[u8] = b"1.1\n1.2\n12.3\n";
const INDEXED: &[u8] = b"1 1 1.0\n2 2 1.0\n3 3 1.0\n";
const LABELLED: &[u8] = b"1,1, 1,1, 1.0\n";
const MARKET: &[u8] = b"%%MatrixMarket matrix coordinate real symmetric\n3 3 1\n1 1 1.0\n";

fuzz_target!(|data: &[u8]| {
    let Some((kind, file)) = data.split_first() else { return };
    let formats = MatricesFormat::ALL;
    let Some(format) = formats.get(usize::from(*kind) % (formats.len() + 1)) else {
        let _ = ReducedModel::of_bytes("reduced", file);
        return;
    };
    let (mass, rows) = match format {
        MatricesFormat::Calculix => (Some(INDEXED), Some(ROWS)),
        MatricesFormat::Abaqus => (Some(LABELLED), None),
        MatricesFormat::MatrixMarket => (Some(MARKET), Some(ROWS)),
        _ => (None, None),
    };
    if let Ok(matrices) = read_bytes(*format, file, mass, rows) {
        check(matrices.stiffness());
        check(matrices.mass());
        let _ = matrices.findings(None);
    }
});

fn check(matrix: &SparseSymmetric) {
    for column in 0..matrix.size() {
        let rows: Vec<usize> = matrix.column(column).map(|(row, _)| row).collect();
        assert!(rows[0] == column && rows.is_sorted_by(|a, b| a < b), "column {column}: {rows:?}");
    }
    assert!(matrix.values().iter().all(|value| value.is_finite()));
}
