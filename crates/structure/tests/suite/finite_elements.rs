//! Structures of finite elements against references by an independent program.
//!
//! The data are not part of this repository; without them these tests are skipped by name.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use asperity_law::{Constant, ContactLaw, Power};
use asperity_matrices::{Dof, Matrices, MatricesFormat, MatrixFiles, SparseSymmetric};
use asperity_mesh::{ComponentModes, PortPair, PortPattern, ReducedBody, SparseBody};
use asperity_structure::{
    Damping, PreloadedContact, PreloadedStructure, UnloadedContact, contacts_at_rest,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMat, Triplet};

fn data(problem: &str, test: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/fe").join(problem);
    let found = root.is_dir();
    if !found {
        eprintln!("skipped {test}: no data of {problem}");
    }
    found.then_some(root)
}

fn sparse(matrix: &SparseSymmetric) -> SparseColMat<usize, f64> {
    let (starts, rows) = (matrix.column_starts().to_vec(), matrix.rows().to_vec());
    let size = matrix.size();
    let symbolic = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
    SparseColMat::new(symbolic, matrix.values().to_vec())
}

fn calculix(folder: &Path, name: &str) -> Matrices {
    let file = |ending: &str| folder.join(format!("{name}.{ending}"));
    asperity_matrices::read(&MatrixFiles {
        format: MatricesFormat::Calculix,
        stiffness: file("sti"),
        mass: Some(file("mas")),
        rows: Some(file("dof")),
    })
    .unwrap()
}

/// The blocks at rest under their loads and weight, with ports of cells, loads and hammer.
fn two_blocks(folder: &Path, name: &str, modes: usize) -> PreloadedStructure<ComponentModes> {
    let matrices = calculix(folder, name);
    let row = |dof: Dof| matrices.row(dof).unwrap();
    let cells = asperity_matrices::read_cells(&folder.join("cells.csv")).unwrap();
    let mut ports: Vec<PortPattern> = cells
        .iter()
        .map(|cell| cell.weights.iter().map(|one| (row(one.dof), one.weight)).collect())
        .collect();
    let loads = asperity_matrices::read_loads(&folder.join("loads.csv")).unwrap();
    ports.push(loads.iter().map(|load| (row(load.dof), load.force_n)).collect());
    let deck = asperity_matrices::Deck::read(&folder.join("two_blocks.inp")).unwrap();
    let weight = matrices.gravity_loads([0.0, 0.0, -9.81], Some(deck.nodes()));
    ports.push(weight.into_iter().enumerate().collect());
    ports.push(vec![(row(Dof::new(172, 3)), 1.0)]);
    let body = SparseBody::new(sparse(matrices.stiffness()), sparse(matrices.mass()), Vec::new());
    let reduced = ReducedBody::new(&body.unwrap(), &ports, modes).unwrap();
    let pairs = (0..cells.len()).map(PortPair::on_ground).collect();
    let places: Vec<usize> = (0..ports.len()).collect();
    let bodies = [(&reduced, &places[..])];
    let modes = ReducedBody::joined(&bodies, ports.len(), 4e-7, pairs).unwrap();
    let law: Arc<dyn ContactLaw> = Arc::new(Power::new(1e8, 0.5, 0.0).unwrap());
    let unloaded: Vec<UnloadedContact> = cells
        .iter()
        .map(|cell| UnloadedContact {
            name: cell.name.clone(),
            area: cell.area_m2,
            law: Arc::clone(&law),
            gap: 0.0,
            damping: None,
        })
        .collect();
    let loads = [(cells.len(), 1.0), (cells.len() + 1, 1.0)];
    let contacts = contacts_at_rest(&modes, &unloaded, &loads).unwrap();
    PreloadedStructure::of_components(modes, contacts, Damping::Rate(60.0)).unwrap()
}

fn assert_close(own: f64, expected: f64, tolerance: f64) {
    assert!((own / expected - 1.0).abs() < tolerance, "{own} {expected}");
}

#[test]
fn two_blocks_rest_and_vibrate_as_by_the_reference() {
    let Some(folder) = data("two_blocks", "two_blocks_rest_and_vibrate_as_by_the_reference") else {
        return;
    };
    // The inertia of the modes left out is neglected.
    for (modes, tolerance) in [(20, 3e-6), (60, 2e-6), (492, 1e-8)] {
        let structure = two_blocks(&folder, "two_blocks", modes);
        let force: f64 = structure.contacts().iter().map(|one| one.area() * one.pressure()).sum();
        assert_close(force, 240.850_723_2, 2e-9);
        let pressures = [
            69.148, 107.893, 155.078, 210.786, 76.062, 116.570, 165.576, 223.149, 83.277, 125.570,
            176.454, 236.029, 90.835, 134.929, 187.762, 249.388,
        ];
        for (contact, kilopascal) in structure.contacts().iter().zip(pressures) {
            assert_close(contact.pressure(), 1e3 * kilopascal, 1e-5);
        }
        let found = structure.port_modes(6).unwrap();
        let frequencies =
            [3_429.416_61, 3_642.384_94, 4_383.656_10, 12_060.538_8, 17_288.410_9, 21_862.558_7];
        let ratios = [0.001_410_9, 0.001_336_3, 0.001_120_7, 0.015_550_8, 0.021_999_1, 0.027_690_1];
        for (mode, (frequency, ratio)) in found.iter().zip(frequencies.into_iter().zip(ratios)) {
            assert_close(mode.frequency_hz, frequency, tolerance);
            assert_close(mode.damping_ratio, ratio, 1e-4);
        }
    }
}

/// Rows of incompatible modes are kept as rows without weight.
#[test]
fn internal_rows_are_no_displacements() {
    let Some(folder) = data("two_blocks", "internal_rows_are_no_displacements") else { return };
    let structure = two_blocks(&folder, "two_blocks_c3d8i", 60);
    let found = structure.port_modes(6).unwrap();
    let frequencies =
        [3_427.440_38, 3_640.002_06, 4_379.209_02, 11_247.646_7, 16_039.648_2, 20_241.446_2];
    for (mode, frequency) in found.iter().zip(frequencies) {
        assert_close(mode.frequency_hz, frequency, 2e-6);
    }
}

/// A lap joint of two beams, bolted: free, with open cells and bolts that pull on both.
#[test]
fn the_reduced_beam_rests_and_vibrates_as_by_the_reference() {
    let Some(folder) =
        data("brake_reuss", "the_reduced_beam_rests_and_vibrates_as_by_the_reference")
    else {
        return;
    };
    let model = asperity_matrices::read_reduced(&folder.join("brake_reuss_reduced.mat")).unwrap();
    let dense = |matrix: &asperity_matrices::DenseMatrix| {
        faer::Mat::from_fn(matrix.rows(), matrix.columns(), |i, j| matrix.get(i, j))
    };
    let (stiffness, mass) = (dense(&model.stiffness), dense(&model.mass));
    let size = mass.nrows();
    let row = |matrix: &asperity_matrices::DenseMatrix, row: usize| -> PortPattern {
        (0..size).map(|column| (column, matrix.get(row, column))).collect()
    };
    let cells = model.areas_m2.len();
    let mut ports: Vec<PortPattern> = (0..cells).map(|cell| row(&model.closure, cell)).collect();
    ports.push(model.loads.iter().copied().enumerate().collect());
    let pairs = (0..cells).map(PortPair::on_ground).collect();
    let lower = |matrix: &faer::Mat<f64>| {
        let entries = (0..size).flat_map(|j| (j..size).map(move |i| (i, j)));
        let entries: Vec<_> = entries.map(|(i, j)| Triplet::new(i, j, matrix[(i, j)])).collect();
        SparseColMat::try_new_from_triplets(size, size, &entries).unwrap()
    };
    let body = SparseBody::new(lower(&stiffness), lower(&mass), Vec::new()).unwrap();
    let reduced = ReducedBody::new(&body, &ports, 100).unwrap();
    let places: Vec<usize> = (0..ports.len()).collect();
    let modes = ReducedBody::joined(&[(&reduced, &places[..])], ports.len(), 0.0, pairs).unwrap();
    let contacts = |law: Arc<dyn ContactLaw>| {
        let contact = |area: &f64| UnloadedContact {
            name: "cell".to_owned(),
            area: *area,
            law: Arc::clone(&law),
            gap: 0.0,
            damping: None,
        };
        model.areas_m2.iter().map(contact).collect::<Vec<_>>()
    };
    let frequencies = |law: Arc<dyn ContactLaw>| {
        let at_rest = contacts_at_rest(&modes, &contacts(law), &[(cells, 1.0)]).unwrap();
        let open = at_rest.iter().filter(|contact| contact.gap() > 0.0).count();
        let least = at_rest.iter().map(PreloadedContact::pressure).fold(f64::INFINITY, f64::min);
        let structure =
            PreloadedStructure::of_components(modes.clone(), at_rest, Damping::Rate(0.0)).unwrap();
        let found = structure.port_modes(16).unwrap();
        let elastic: Vec<f64> = found
            .iter()
            .map(|mode| mode.frequency_hz)
            .filter(|frequency| *frequency > 1.0)
            .collect();
        assert_eq!(found.len() - elastic.len(), 6);
        (open, least, elastic)
    };
    let (open, _, linear) = frequencies(Arc::new(Constant::new(1_042_475_690_030.833_6).unwrap()));
    assert_eq!(open, 0);
    let expected = [
        147.0118,
        156.5419,
        584.4114,
        648.8191,
        921.0021,
        963.3504,
        1_139.065_5,
        1_510.237_3,
        1_725.063_5,
        1_931.884_0,
    ];
    for (own, expected) in linear.iter().zip(expected) {
        assert_close(*own, expected, 1.2e-5);
    }
    let (open, least, power) = frequencies(Arc::new(Power::new(2.5e9, 0.5, 0.0).unwrap()));
    assert_eq!(open, 0);
    let expected = [
        148.4033,
        156.5448,
        588.0532,
        649.0043,
        921.4469,
        963.7154,
        1_140.134_4,
        1_539.956_7,
        1_734.847_3,
        1_933.486_4,
    ];
    for (own, expected) in power.iter().zip(expected) {
        assert_close(*own, expected, 1.2e-5);
    }
    assert_close(least, 305_605.438_374_5, 1e-7);
}
