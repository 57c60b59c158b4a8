//! Three measured hammer hits, if the data are available.

use std::path::Path;

/// Rate of the three hits, in hertz.
pub(crate) const RATE: f64 = 25_600.0;

/// Rows of a two-dimensional npy file of little-endian float64 in C order.
fn rows(bytes: &[u8], count: usize) -> Vec<Vec<f64>> {
    let header = usize::from(u16::from_le_bytes([bytes[8], bytes[9]])) + 10;
    let text = String::from_utf8_lossy(&bytes[..header]);
    assert!(text.contains("'<f8'") && text.contains("False"), "{text}");
    let (words, _) = bytes[header..].as_chunks::<8>();
    let values: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
    values.chunks(values.len() / count).map(<[f64]>::to_vec).collect()
}

/// Force \[N\] and acceleration \[m/s^2\] of the three hits; `None` where the data are absent.
pub(crate) fn hits(test: &str) -> Option<Vec<(Vec<f64>, Vec<f64>)>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/pyfrf_hammer");
    let read = |n: u32| {
        let bytes = std::fs::read(folder.join(format!("hit_{n}.npy"))).ok()?;
        let mut rows = rows(&bytes, 3);
        let response = rows.pop()?;
        Some((rows.pop()?, response))
    };
    let found: Option<Vec<_>> = (1..=3).map(read).collect();
    if found.is_none() {
        eprintln!("skipped {test}: no measured hits at {}", folder.display());
    }
    found
}
