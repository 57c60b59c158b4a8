//! The files of two test problems, in all formats. Skipped where they are absent.
#![allow(clippy::print_stderr, reason = "a test without its data says that it was skipped")]

use std::path::{Path, PathBuf};

use asperity_matrices::{
    Deck, Dof, Matrices, MatricesFormat, MatrixFiles, RigidMotions, read, read_cells, read_loads,
    read_reduced,
};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// The folder of the test problems; none where it is absent, for the test of this name.
fn problems(test: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/fe");
    let found = folder.is_dir().then_some(folder);
    if found.is_none() {
        eprintln!("skipped {test}: no ../shared/data/fe");
    }
    found
}

fn files(folder: &Path, format: MatricesFormat, names: [&str; 3]) -> MatrixFiles {
    let path = |name: &str| (!name.is_empty()).then(|| folder.join("two_blocks").join(name));
    MatrixFiles {
        format,
        stiffness: path(names[0]).unwrap_or_default(),
        mass: path(names[1]),
        rows: path(names[2]),
    }
}

/// Every entry by the degrees of freedom of row and column.
fn entries(matrices: &Matrices) -> [Vec<(Dof, Dof, u64)>; 2] {
    [matrices.stiffness(), matrices.mass()].map(|matrix| {
        let dofs = matrices.dofs();
        let mut entries: Vec<_> = matrix
            .triplets()
            .map(|(row, column, value)| {
                let (a, b) = (dofs[row].max(dofs[column]), dofs[row].min(dofs[column]));
                (a, b, value.to_bits())
            })
            .collect();
        entries.sort_unstable();
        entries
    })
}

#[test]
fn all_formats_hold_the_same_numbers() -> Outcome {
    let Some(folder) = problems("all_formats_hold_the_same_numbers") else { return Ok(()) };
    let calculix = ["two_blocks.sti", "two_blocks.mas", "two_blocks.dof"];
    let calculix = read(&files(&folder, MatricesFormat::Calculix, calculix))?;
    assert_eq!(calculix.size(), 492);
    // Zeros off the diagonal are dropped.
    assert_eq!(calculix.stiffness().stored(), 13_067);
    assert_eq!(calculix.mass().stored(), 4_578);
    let market = ["two_blocks_stiffness.mtx", "two_blocks_mass.mtx", "two_blocks.dof"];
    let abaqus = ["two_blocks_abaqus_STIF1.mtx", "two_blocks_abaqus_MASS1.mtx", ""];
    let others = [
        (MatricesFormat::MatrixMarket, market),
        (MatricesFormat::Abaqus, abaqus),
        (MatricesFormat::Abaqus, [abaqus[0], abaqus[1], "two_blocks.dof"]),
        (MatricesFormat::Matlab, ["two_blocks.mat", "", ""]),
        (MatricesFormat::Matlab, ["two_blocks_permuted.mat", "", ""]),
    ];
    let expected = entries(&calculix);
    for (format, names) in others {
        let other = read(&files(&folder, format, names))?;
        assert!(entries(&other) == expected, "{format}, {names:?}");
        let same_order = names[0] != "two_blocks_permuted.mat";
        assert_eq!(other.dofs() == calculix.dofs(), same_order, "{format}, {names:?}");
    }
    Ok(())
}

#[test]
fn cells_and_loads_name_rows() -> Outcome {
    let Some(folder) = problems("cells_and_loads_name_rows") else { return Ok(()) };
    let names = ["two_blocks.sti", "two_blocks.mas", "two_blocks.dof"];
    let matrices = read(&files(&folder, MatricesFormat::Calculix, names))?;
    let cells = read_cells(&folder.join("two_blocks/cells.csv"))?;
    assert_eq!(cells.len(), 16);
    for cell in &cells {
        assert!((cell.area_m2 - 1e-4).abs() < 1e-9);
        assert!(cell.weights.iter().all(|weight| matrices.row(weight.dof).is_some()));
        // Both faces approach as much as they move together.
        let sum: f64 = cell.weights.iter().map(|weight| weight.weight).sum();
        assert!(sum.abs() < 1e-12, "{sum}");
    }
    let loads = read_loads(&folder.join("two_blocks/loads.csv"))?;
    let total: f64 = loads.iter().map(|load| load.force_n).sum();
    assert!((total + 240.0).abs() < 1e-6, "{total}");
    Ok(())
}

#[test]
fn the_reduced_model_is_read() -> Outcome {
    let Some(folder) = problems("the_reduced_model_is_read") else { return Ok(()) };
    let model = read_reduced(&folder.join("brake_reuss/brake_reuss_reduced.mat"))?;
    assert_eq!((model.stiffness.rows(), model.mass.columns()), (125, 125));
    assert_eq!((model.closure.rows(), model.closure.columns()), (76, 125));
    assert_eq!((model.areas_m2.len(), model.loads.len(), model.responses.rows()), (76, 125, 2));
    assert!(model.areas_m2.iter().all(|area| (9e-6..2e-4).contains(area)));
    Ok(())
}

/// Areas of faces with straight edges, by their corners.
fn area(deck: &Deck, corners: &[i64]) -> f64 {
    let place = |node: i64| deck.nodes().get(node).unwrap_or([f64::NAN; 3]);
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let (a, b) =
        (minus(place(corners[2]), place(corners[0])), minus(place(corners[3]), place(corners[1])));
    // The faces are horizontal.
    0.5 * (a[0] * b[1] - a[1] * b[0])
}

#[test]
fn surfaces_of_the_deck_are_the_cells() -> Outcome {
    let Some(folder) = problems("surfaces_of_the_deck_are_the_cells") else { return Ok(()) };
    let deck = Deck::read(&folder.join("two_blocks/two_blocks.inp"))?;
    assert_eq!(deck.nodes().count(), 230);
    assert_eq!(deck.node_set("HAMMER")?, [172]);
    for (name, sign, nodes) in [("CONTACT_UPPER", -1.0, 4), ("contact_lower", 1.0, 8)] {
        let faces = deck.surface(name)?;
        assert_eq!(faces.len(), 16);
        for face in faces {
            assert_eq!(face.nodes.len(), nodes);
            // Faces look at each other: the upper one down, the lower one up.
            assert!((sign * area(&deck, face.corners()) - 1e-4).abs() < 1e-12);
        }
    }
    let brake = Deck::read(&folder.join("brake_reuss/brake_reuss.inp.gz"))?;
    assert_eq!(brake.elements().len(), 1032);
    assert_eq!(brake.surface("CONTACT_UPPER")?.len(), 76);
    assert_eq!(brake.surface("CONTACT_LOWER")?.len(), 76);
    Ok(())
}

#[test]
fn internal_rows_of_incompatible_modes_have_no_weight() -> Outcome {
    let Some(folder) = problems("internal_rows_of_incompatible_modes_have_no_weight") else {
        return Ok(());
    };
    let deck = Deck::read(&folder.join("two_blocks/two_blocks.inp"))?;
    let names = ["two_blocks_c3d8i.sti", "two_blocks_c3d8i.mas", "two_blocks_c3d8i.dof"];
    let c3d8i = read(&files(&folder, MatricesFormat::Calculix, names))?;
    let names = ["two_blocks.sti", "two_blocks.mas", "two_blocks.dof"];
    let c3d8 = read(&files(&folder, MatricesFormat::Calculix, names))?;
    let nodes = Some(deck.nodes());
    let internal = c3d8i.internal_rows(nodes);
    assert_eq!((c3d8i.size(), internal.iter().filter(|internal| **internal).count()), (780, 288));
    assert!(c3d8.internal_rows(nodes).iter().all(|internal| !internal));
    // The same mesh and density: the same weight, although the sum of the mass matrix is not the mass.
    let weight = |matrices: &Matrices| -> f64 {
        matrices.gravity_loads([0.0, 0.0, -9.81], nodes).iter().sum()
    };
    assert!((weight(&c3d8i) / weight(&c3d8) - 1.0).abs() < 1e-12);
    let ones: f64 = c3d8i.mass().multiply(&vec![1.0; 780]).iter().sum();
    assert!(ones > 3.0 * 0.212);
    // The lower block is held. The upper one may lift and rock: its guides hold x, y and spin.
    for matrices in [&c3d8, &c3d8i] {
        assert!(matrices.findings(nodes).iter().all(|finding| !finding.is_fault));
        let parts = matrices.parts(deck.nodes());
        let motions: Vec<_> =
            parts.iter().map(|part| matrices.rigid_motions(deck.nodes(), Some(part))).collect();
        let counts: Vec<usize> = motions.iter().map(RigidMotions::free_count).collect();
        assert_eq!(counts, [0, 3]);
        let axes: Vec<&str> =
            motions[1].free_axes().map(|axis| RigidMotions::NAMES[axis]).collect();
        assert_eq!(axes, ["along z", "about x", "about y"]);
        let upper = motions[1].translational_mass()[2];
        assert!((upper / (0.04 * 0.04 * 0.02 * 2710.0) - 1.0).abs() < 1e-6, "{upper}");
    }
    Ok(())
}
