//! Small structures written in every format, and read back.
#![allow(clippy::unwrap_used, reason = "writing to memory does not fail")]

mod files;
mod hostile;

use asperity_matrices::{
    Dof, Matrices, MatricesError, MatricesFormat, ReducedModel, SparseSymmetric, read_bytes,
};

use files::{Mat, Value, npy, npz};

/// A chain of masses and springs along x and y, with a rotation.
fn structure() -> Matrices {
    let dofs = vec![Dof::new(12, 3), Dof::new(12, 1), Dof::new(120, 1), Dof::new(7, 6)];
    let stiffness =
        [(0, 0, 4.5), (1, 1, 5.25), (2, 2, 6.0), (3, 3, 7.0), (0, 1, -1.1), (2, 1, -2.3)];
    let mass = [(0, 0, 1.0), (1, 1, 1.5), (2, 2, 0.1), (3, 3, 1e-3), (3, 2, 1e-5)];
    let matrix = |triplets: &[(usize, usize, f64)]| {
        SparseSymmetric::from_triplets(4, triplets.iter().copied())
    };
    Matrices::new(matrix(&stiffness), matrix(&mass), dofs).unwrap()
}

/// All entries, column by column.
fn full(matrix: &SparseSymmetric) -> Vec<f64> {
    let size = matrix.size();
    (0..size * size).map(|index| matrix.get(index % size, index / size)).collect()
}

fn rows_of(matrices: &Matrices) -> Vec<f64> {
    let nodes = matrices.dofs().iter().map(|dof| dof.node as f64);
    nodes.chain(matrices.dofs().iter().map(|dof| f64::from(dof.direction))).collect()
}

fn rows_text(matrices: &Matrices) -> String {
    let rows = matrices.dofs().iter().map(|dof| format!("{}.{}\n", dof.node, dof.direction));
    rows.collect::<Vec<_>>().concat()
}

#[test]
fn matlab_files_of_either_byte_order_full_and_sparse() {
    let expected = structure();
    let matrices = [("K", expected.stiffness()), ("M", expected.mass())];
    for big in [false, true] {
        for compressed in [false, true] {
            for sparse in [false, true] {
                let mut mat = Mat::new(big, compressed);
                mat.other("note");
                for (name, matrix) in matrices {
                    let value = full(matrix);
                    mat.add(
                        name,
                        4,
                        4,
                        &if sparse { Value::Sparse(value) } else { Value::Full(value) },
                    );
                }
                mat.add("dof", 4, 2, &Value::Small(rows_of(&expected)));
                let read = read_bytes(MatricesFormat::Matlab, &mat.bytes(), None, None).unwrap();
                assert_eq!(read, expected, "{big} {compressed} {sparse}");
            }
        }
    }
}

#[test]
fn numpy_archives_of_k_and_m_and_of_sdynpy() {
    let expected = structure();
    let shape = "(4, 4)";
    let [k, m] = [expected.stiffness(), expected.mass()].map(full);
    let plain = npz(&[
        ("K", npy("'<f8'", false, shape, &le(&k))),
        ("M", npy("'<f8'", true, shape, &le(&m))),
        ("dof", npy("'<f8'", true, "(4, 2)", &le(&rows_of(&expected)))),
    ]);
    let mut coordinates = Vec::new();
    for dof in expected.dofs() {
        coordinates.extend(dof.node.to_le_bytes());
        coordinates.push(dof.direction);
    }
    let identity: Vec<f64> = (0..16).map(|index| f64::from(u8::from(index % 5 == 0))).collect();
    let kind = "[('node', '<u8'), ('direction', 'i1')]";
    let system = |transformation: &[f64]| {
        npz(&[
            ("mass", npy("'<f8'", false, shape, &le(&m))),
            (
                "stiffness",
                npy(
                    "'>f8'",
                    false,
                    shape,
                    &k.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>(),
                ),
            ),
            ("damping", npy("'<f8'", false, shape, &le(&m))),
            ("transformation", npy("'<f8'", false, shape, &le(transformation))),
            ("coordinate", npy(kind, false, "(4,)", &coordinates)),
            ("enforce_symmetry", npy("'|b1'", false, "()", &[1])),
        ])
    };
    for bytes in [plain, system(&identity)] {
        let read = read_bytes(MatricesFormat::Npz, &bytes, None, None).unwrap();
        assert_eq!(read, expected);
    }
    let error = read_bytes(MatricesFormat::Npz, &system(&k), None, None).unwrap_err().to_string();
    assert!(
        error.starts_with("stiffness, array transformation: it is not the identity"),
        "{error}"
    );
}

#[test]
fn matrices_of_scipy_in_files_of_their_own() {
    let expected = structure();
    let words = |values: &[usize]| {
        values.iter().flat_map(|v| (*v as u32).to_le_bytes()).collect::<Vec<_>>()
    };
    let archive = |matrix: &SparseSymmetric, coordinates: bool| {
        let values = full(matrix);
        let kept: Vec<usize> = (0..16).filter(|index| values[*index] != 0.0).collect();
        let data: Vec<f64> = kept.iter().map(|index| values[*index]).collect();
        let rows: Vec<usize> = kept.iter().map(|index| index % 4).collect();
        let count = format!("({},)", kept.len());
        let mut arrays = vec![
            ("data", npy("'<f8'", false, &count, &le(&data))),
            ("shape", npy("'<i8'", false, "(2,)", &[4_i64, 4].map(i64::to_le_bytes).concat())),
            ("format", npy("'|S3'", false, "()", b"csc")),
        ];
        if coordinates {
            let columns: Vec<usize> = kept.iter().map(|index| index / 4).collect();
            arrays.push(("row", npy("'<i4'", false, &count, &words(&rows))));
            arrays.push(("col", npy("'<i4'", false, &count, &words(&columns))));
        } else {
            let starts =
                (0..=4).map(|column| kept.iter().filter(|index| **index < 4 * column).count());
            arrays.push(("indices", npy("'<i4'", false, &count, &words(&rows))));
            arrays
                .push(("indptr", npy("'<i4'", false, "(5,)", &words(&starts.collect::<Vec<_>>()))));
        }
        npz(&arrays)
    };
    let rows = rows_text(&expected);
    for coordinates in [false, true] {
        let [k, m] =
            [expected.stiffness(), expected.mass()].map(|matrix| archive(matrix, coordinates));
        let read = read_bytes(MatricesFormat::Npz, &k, Some(&m), Some(rows.as_bytes())).unwrap();
        assert_eq!(read, expected);
        let error = read_bytes(MatricesFormat::Npz, &k, Some(&m), Some(b"1.1\n1.2\n")).unwrap_err();
        assert_eq!(error.to_string(), "stiffness, array K: 4 x 4; expected 2 x 2");
    }
}

fn le(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

#[test]
fn texts_plain_and_gzip_are_the_same() {
    let expected = structure();
    let text = |matrix: &SparseSymmetric| -> String {
        let mut entries: Vec<_> = matrix.triplets().collect();
        entries.sort_by_key(|&(row, column, _)| (row, column));
        entries
            .iter()
            .map(|(row, column, value)| format!("{} {} {value:e}\n", column + 1, row + 1))
            .collect::<Vec<_>>()
            .concat()
    };
    let [k, m] = [expected.stiffness(), expected.mass()].map(text);
    let rows = rows_text(&expected);
    let plain = [k.as_bytes(), m.as_bytes(), rows.as_bytes()];
    let folded = plain.map(files::gzip);
    let [fk, fm, fr] = folded.each_ref().map(Vec::as_slice);
    for [k, m, rows] in [plain, [fk, fm, fr]] {
        let read = read_bytes(MatricesFormat::Calculix, k, Some(m), Some(rows)).unwrap();
        assert_eq!(read, expected);
    }
    let cut = &fk[..fk.len() - 9];
    let error = read_bytes(MatricesFormat::Calculix, cut, Some(fm), Some(fr)).unwrap_err();
    assert!(matches!(error, MatricesError::Io { .. }), "{error}");
    let bomb = files::gzip(&vec![b' '; 1 << 24]);
    let error =
        read_bytes(MatricesFormat::Calculix, &bomb, Some(fm), Some(fr)).unwrap_err().to_string();
    assert!(error.contains("times its size") || error.contains("a line of more than"), "{error}");
}

#[test]
fn a_row_that_is_not_there_is_explained() {
    let matrices = structure();
    assert_eq!(matrices.require_row(Dof::new(120, 1)).unwrap(), 2);
    let error =
        |node, direction| matrices.require_row(Dof::new(node, direction)).unwrap_err().to_string();
    assert!(
        error(12, 2).starts_with(
            "no row of node 12 direction 2; the node has rows in the directions 1, 3;"
        )
    );
    assert!(
        error(13, 2).starts_with(
            "no row of node 13 direction 2; the node has no rows: it is held, dependent"
        )
    );
}

#[test]
fn formats_are_told_by_their_first_lines() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("k.mtx");
    let cases: [(&[u8], _); 6] = [
        (b"$ punch\nDMIG    KAAX           0       6       2\n", MatricesFormat::Nastran),
        (b"%%MatrixMarket matrix coordinate real symmetric\n", MatricesFormat::MatrixMarket),
        (b"** comment\n5,1, 5,1,  2.0e+00\n", MatricesFormat::Abaqus),
        (b"1 1 2.0\n", MatricesFormat::Calculix),
        (b"PK\x03\x04", MatricesFormat::Npz),
        (&Mat::new(false, false).bytes(), MatricesFormat::Matlab),
    ];
    for (bytes, format) in cases {
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(MatricesFormat::detect(&path).unwrap(), format);
    }
    std::fs::write(&path, "<html>").unwrap();
    let error = MatricesFormat::detect(&path).unwrap_err().to_string();
    assert!(error.contains("line 1: `<html>`; expected the start of a matrix"), "{error}");
}

#[test]
fn rows_held_by_large_diagonals_are_removed() {
    let stiffness = "1,1, 1,1, 1.000000000000000e+36\n1,1, 2,1, -3.0e+00\n2,1, 2,1, 5.0e+00\n2,1, 3,1, -2.0e+00\n\
                     2,1, 1,1, -3.0e+00\n3,1, 2,1, -2.0e+00\n3,1, 3,1, 2.0e+00\n";
    let mass = "1,1, 1,1, 1.0e+00\n2,1, 2,1, 1.0e+00\n1,1, 2,1, 2.0e-01\n3,1, 3,1, 1.0e+00\n";
    let read = |stiffness: &str| {
        read_bytes(MatricesFormat::Abaqus, stiffness.as_bytes(), Some(mass.as_bytes()), None)
    };
    let matrices = read(stiffness).unwrap();
    assert_eq!(matrices.held(), [Dof::new(1, 1)]);
    assert_eq!(matrices.dofs(), [Dof::new(2, 1), Dof::new(3, 1)]);
    assert_eq!(
        matrices.stiffness().triplets().collect::<Vec<_>>(),
        [(0, 0, 5.0), (1, 0, -2.0), (1, 1, 2.0)]
    );
    assert_eq!(matrices.mass().diagonal(), [1.0, 1.0]);
    assert_eq!(
        matrices.findings(None)[0].to_string(),
        "1 rows are held by diagonals of 1e36, and removed"
    );
    // The large diagonal does not hide an entry that is not symmetric.
    let error = read(&stiffness.replace("3,1, 2,1, -2.0e+00", "3,1, 2,1, -2.5e+00"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("not symmetric"), "{error}");
}

#[test]
fn faults_of_arrays_are_named() {
    let expected = structure();
    let [k, m] = [expected.stiffness(), expected.mass()].map(full);
    let rows = rows_of(&expected);
    let mat = |parts: &[(&str, usize, usize, &[f64])]| {
        let mut mat = Mat::new(false, true);
        for (name, rows, columns, values) in parts {
            mat.add(name, *rows, *columns, &Value::Full(values.to_vec()));
        }
        read_bytes(MatricesFormat::Matlab, &mat.bytes(), None, None).unwrap_err().to_string()
    };
    // Twelve and three tenths is no row.
    let decimals = [12.3, 12.1, 120.1, 7.6];
    let error = mat(&[("K", 4, 4, &k), ("M", 4, 4, &m), ("dof", 4, 1, &decimals)]);
    assert_eq!(
        error,
        "stiffness, array dof: 4 x 1; expected n x 2, full: a node and a direction for each row of the matrices"
    );
    let mut wrong = rows.clone();
    wrong[1] = 12.5;
    let error = mat(&[("K", 4, 4, &k), ("M", 4, 4, &m), ("dof", 4, 2, &wrong)]);
    assert!(
        error.starts_with("stiffness, array dof: row 2 is (12.5, 1); expected a node"),
        "{error}"
    );
    let error = mat(&[("K", 4, 4, &k), ("mass_matrix", 4, 4, &m), ("dof", 4, 2, &rows)]);
    assert_eq!(error, "stiffness: no array M or mass; the file has mass_matrix");
    let error = mat(&[("K", 2, 2, &k[..4]), ("M", 4, 4, &m), ("dof", 4, 2, &rows)]);
    assert_eq!(error, "stiffness, array K: 2 x 2; expected 4 x 4");
    let mut infinite = k.clone();
    infinite[6] = f64::INFINITY;
    let error = mat(&[("K", 4, 4, &infinite), ("M", 4, 4, &m), ("dof", 4, 2, &rows)]);
    assert_eq!(error, "stiffness, array K: the element (3, 2) is inf; expected finite numbers");
    let mut skewed = k.clone();
    skewed[1] = 1.1;
    let error = mat(&[("K", 4, 4, &skewed), ("M", 4, 4, &m), ("dof", 4, 2, &rows)]);
    assert!(
        error.starts_with(
            "stiffness, array K: the matrix is not symmetric: the entry of row 2 (node 12"
        ),
        "{error}"
    );
}

#[test]
fn files_of_matlab_that_cannot_be_read_say_what_to_do() {
    let read = |bytes: &[u8]| {
        read_bytes(MatricesFormat::Matlab, bytes, None, None).unwrap_err().to_string()
    };
    let mut header = Mat::new(false, false).bytes();
    assert_eq!(read(&header), "stiffness: no array dof or coordinate; the file has none");
    assert_eq!(read(&header[..90]), "stiffness ends early, at byte 90: the header has 128 bytes");
    header[..12].copy_from_slice(b"MATLAB 7.3 M");
    assert_eq!(
        read(&header),
        "stiffness, byte 0: a file of MATLAB 7.3 cannot be read; save it with the option '-v7'"
    );
    let mut mat = Mat::new(false, false);
    mat.add("K", 2, 2, &Value::Full(vec![1.0; 4]));
    let bytes = mat.bytes();
    let error = read(&bytes[..bytes.len() - 8]);
    assert!(error.contains("ends early") && error.contains("the variable at byte 128"), "{error}");
}

/// Name, rows, columns and values of arrays.
type Parts = Vec<(&'static str, usize, usize, Vec<f64>)>;

#[test]
fn a_reduced_model_has_matching_shapes() {
    let parts = [
        ("K", 2, 2, vec![2.0, -1.0, -1.0, 2.0]),
        ("M", 2, 2, vec![1.0, 0.5, 0.5, 1.0]),
        ("W", 3, 2, vec![1.0, 0.0, 1.0, 0.0, 1.0, -1.0]),
        ("area", 1, 3, vec![1e-4, 2e-4, 3e-4]),
        ("f", 2, 1, vec![0.0, -5.0]),
        ("R", 1, 2, vec![1.0, 0.0]),
    ];
    let read = |change: &dyn Fn(&mut Parts)| {
        let mut parts = parts.to_vec();
        change(&mut parts);
        let mut mat = Mat::new(false, true);
        for (name, rows, columns, values) in parts {
            mat.add(name, rows, columns, &Value::Full(values));
        }
        ReducedModel::of_bytes("r.mat", &mat.bytes())
    };
    let model = read(&|_| ()).unwrap();
    assert_eq!(model.closure.multiply(&[1.0, 2.0]), [1.0, 2.0, -1.0]);
    assert_eq!(model.closure.transposed().multiply(&[1.0, 1.0, 1.0]), [2.0, 0.0]);
    assert_eq!((model.areas_m2[2], model.loads[1], model.responses.get(0, 0)), (3e-4, -5.0, 1.0));
    // Loads and responses may be absent.
    let model = read(&|parts| parts.truncate(4)).unwrap();
    assert_eq!((model.loads, model.responses.rows()), (vec![0.0; 2], 0));
    let error = |change: &dyn Fn(&mut Parts)| read(change).unwrap_err().to_string();
    assert_eq!(
        error(&|parts| parts[3].3[1] = 0.0),
        "r.mat, array area: element 2 is 0; expected positive areas"
    );
    assert_eq!(
        error(&|parts| parts[2] = ("W", 2, 3, vec![0.0; 6])),
        "r.mat, array W: 2 x 3; expected 2 x 2"
    );
    assert_eq!(error(&|parts| parts[1].3[1] = 0.6).split(':').next(), Some("r.mat, array M"));
}
