//! Seconds and megabytes per second of the readers of texts.
//!
//! `cargo bench -p asperity-matrices` writes the matrices of a lattice of `n^3` nodes, each coupled to its
//! neighbours in three directions (28, or the first argument: 66,000 rows, some 2.5 million entries a
//! file), and reads them. Each row is the best of three runs.
#![allow(missing_docs, reason = "a benchmark has no callers")]
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]
#![allow(clippy::unwrap_used, reason = "its files are valid")]

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

use asperity_matrices::{MatricesFormat, MatrixFiles, read};

const ROUNDS: usize = 3;

fn main() {
    let side = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(28);
    let folder = tempfile::tempdir().unwrap();
    let entries = lattice(side);
    let rows = side * side * side * 3;
    println!("{rows} rows, {} entries", entries.len());
    println!("format          megabytes   seconds    MB/s");
    for format in [MatricesFormat::Calculix, MatricesFormat::Abaqus, MatricesFormat::MatrixMarket] {
        let path = |name: &str| folder.path().join(name);
        let files = MatrixFiles {
            format,
            stiffness: path("stiffness"),
            mass: Some(path("mass")),
            rows: (format != MatricesFormat::Abaqus).then(|| path("rows")),
        };
        for name in ["stiffness", "mass"] {
            write(&path(name), format, &entries, rows);
        }
        let mut out = BufWriter::new(File::create(path("rows")).unwrap());
        for row in 0..rows {
            writeln!(out, "{}.{}", row / 3 + 1, row % 3 + 1).unwrap();
        }
        out.flush().unwrap();
        let mut best = f64::INFINITY;
        for _ in 0..ROUNDS {
            let started = Instant::now();
            let matrices = read(&files).unwrap();
            best = best.min(started.elapsed().as_secs_f64());
            assert_eq!(matrices.size(), rows);
        }
        let size = 2.0 * std::fs::metadata(path("stiffness")).unwrap().len() as f64 / 1e6;
        println!("{:<15} {size:>9.0} {best:>9.2} {:>7.0}", format.name(), size / best);
    }
}

/// Rows and columns of the upper triangle, column by column, from zero.
fn lattice(side: usize) -> Vec<(usize, usize)> {
    let mut entries = Vec::new();
    let number = |x: usize, y: usize, z: usize| x + side * (y + side * z);
    let near = |x: usize| x.saturating_sub(1)..=(x + 1).min(side - 1);
    for (z, y, x) in
        (0..side).flat_map(|z| (0..side).flat_map(move |y| (0..side).map(move |x| (z, y, x))))
    {
        for direction in 0..3 {
            let column = 3 * number(x, y, z) + direction;
            for c in near(z) {
                for b in near(y) {
                    for a in near(x) {
                        let row = 3 * number(a, b, c);
                        entries.extend(
                            (row..row + 3).filter(|row| *row <= column).map(|row| (row, column)),
                        );
                    }
                }
            }
        }
    }
    entries
}

fn write(path: &Path, format: MatricesFormat, entries: &[(usize, usize)], rows: usize) {
    let mut out = BufWriter::new(File::create(path).unwrap());
    if format == MatricesFormat::MatrixMarket {
        let count = entries.len();
        writeln!(out, "%%MatrixMarket matrix coordinate real symmetric\n{rows} {rows} {count}")
            .unwrap();
    }
    for (row, column) in entries {
        let value = if row == column { 8e8 } else { -1.234_567_890_123_4e8 / (1 + row % 7) as f64 };
        match format {
            MatricesFormat::Abaqus => {
                let (i, j) = (row / 3 + 1, column / 3 + 1);
                let (a, b) = (row % 3 + 1, column % 3 + 1);
                writeln!(out, "{i},{a}, {j},{b}, {value:.15e}").unwrap();
            }
            _ => writeln!(out, "{} {} {value:.13e}", row + 1, column + 1).unwrap(),
        }
    }
    out.flush().unwrap();
}
