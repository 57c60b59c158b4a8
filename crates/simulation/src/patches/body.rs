//! A body as its files have it.

use std::path::Path;

use asperity_matrices::{
    Deck, Dof, Matrices, MatricesError, MatricesFormat, MatrixFiles, MatrixUnits, SparseSymmetric,
};
use asperity_mesh::{PortPattern, SparseBody};
use asperity_scenario::{MatricesFormatSpec, MatrixBodySpec};
use asperity_structure::StructureError;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::error::SimulationError;

/// A body as its files have it.
pub(super) struct Body {
    name: String,
    pub(super) matrices: Matrices,
}

/// The mesh of a body in metres, if it has one.
pub(super) fn read_deck(
    spec: &MatrixBodySpec,
    folder: &Path,
) -> Result<Option<Deck>, SimulationError> {
    let Some(file) = &spec.mesh else { return Ok(None) };
    let mut deck = Deck::read(&folder.join(file))?;
    deck.convert(units(spec)?);
    Ok(Some(deck))
}

fn units(spec: &MatrixBodySpec) -> Result<MatrixUnits, MatricesError> {
    MatrixUnits::new(spec.units.length_m, spec.units.mass_kg, spec.units.time_s)
}

impl Body {
    pub(super) fn read(
        spec: &MatrixBodySpec,
        folder: &Path,
        deck: Option<&Deck>,
    ) -> Result<Self, SimulationError> {
        let MatrixBodySpec { name, matrices, .. } = spec;
        let format = match matrices.format {
            MatricesFormatSpec::Calculix => MatricesFormat::Calculix,
            MatricesFormatSpec::Abaqus => MatricesFormat::Abaqus,
            MatricesFormatSpec::MatrixMarket => MatricesFormat::MatrixMarket,
            MatricesFormatSpec::Nastran => MatricesFormat::Nastran,
            MatricesFormatSpec::Matlab => MatricesFormat::Matlab,
            MatricesFormatSpec::Npz => MatricesFormat::Npz,
        };
        let at = |file: &String| folder.join(file);
        let mut read = asperity_matrices::read(&MatrixFiles {
            format,
            stiffness: at(&matrices.stiffness),
            mass: matrices.mass.as_ref().map(at),
            rows: matrices.rows.as_ref().map(at),
        })?;
        read.convert(units(spec)?);
        let findings = read.findings(deck.map(Deck::nodes));
        if let Some(fault) = findings.iter().find(|finding| finding.is_fault) {
            let accepted = "matrices of a structure without contact";
            return Err(SimulationError::model("/bodies", format!("{name}: {fault}"), accepted));
        }
        for finding in &findings {
            tracing::info!(body = name, "{finding}");
        }
        Ok(Self { name: name.clone(), matrices: read })
    }

    pub(super) fn row(&self, dof: Dof, place: &str) -> Result<usize, SimulationError> {
        self.matrices.row(dof).ok_or_else(|| {
            let problem = format!("body \"{}\" has no row of {dof}", self.name);
            let accepted =
                "degrees of freedom that are in the matrices: neither held nor dependent";
            SimulationError::model(place, problem, accepted)
        })
    }

    /// Rows of a node along a direction.
    pub(super) fn along(
        &self,
        node: i64,
        direction: [f64; 3],
        place: &str,
    ) -> Result<PortPattern, SimulationError> {
        let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
        if !(length.is_finite() && length > 0.0) {
            let at = format!("{place}/direction");
            return Err(SimulationError::model(
                &at,
                "the direction has no length",
                "three numbers, not all zero",
            ));
        }
        let parts = direction.iter().zip(1_u8..).filter(|(part, _)| **part != 0.0);
        let row =
            |(part, axis): (&f64, u8)| Ok((self.row(Dof::new(node, axis), place)?, part / length));
        parts.map(row).collect()
    }

    /// The body for a reduction, with the places of its rows if it has a mesh.
    pub(super) fn sparse(&self, deck: Option<&Deck>) -> Result<SparseBody, SimulationError> {
        let Self { matrices, .. } = self;
        let place = |deck: &Deck| {
            matrices.dofs().iter().map(|dof| deck.nodes().get(dof.node)).collect::<Vec<_>>()
        };
        let places = deck.map(place).unwrap_or_default();
        let body = SparseBody::new(sparse(matrices.stiffness()), sparse(matrices.mass()), places);
        Ok(body.map_err(StructureError::from)?)
    }
}

fn sparse(matrix: &SparseSymmetric) -> SparseColMat<usize, f64> {
    let size = matrix.size();
    let (starts, rows) = (matrix.column_starts().to_vec(), matrix.rows().to_vec());
    let symbolic = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
    SparseColMat::new(symbolic, matrix.values().to_vec())
}
