//! The files of two test problems, in all formats. Skipped where they are absent.

use std::path::{Path, PathBuf};

use asperity_matrices::{
    Dof, Matrices, MatricesFormat, MatrixFiles, read, read_cells, read_loads, read_reduced,
};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// The folder of the test problems; none where it is absent.
fn problems() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/fe");
    let found = folder.is_dir().then_some(folder);
    if found.is_none() {
        eprintln!("skipped: no ../shared/data/fe");
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
    let Some(folder) = problems() else { return Ok(()) };
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
    let Some(folder) = problems() else { return Ok(()) };
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
    let Some(folder) = problems() else { return Ok(()) };
    let model = read_reduced(&folder.join("brake_reuss/brake_reuss_reduced.mat"))?;
    assert_eq!((model.stiffness.rows(), model.mass.columns()), (125, 125));
    assert_eq!((model.closure.rows(), model.closure.columns()), (76, 125));
    assert_eq!((model.areas_m2.len(), model.loads.len(), model.responses.rows()), (76, 125, 2));
    assert!(model.areas_m2.iter().all(|area| (9e-6..2e-4).contains(area)));
    Ok(())
}
