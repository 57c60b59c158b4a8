//! A body as its files have it.

use std::path::Path;

use asperity_matrices::{
    Deck, Dof, Matrices, MatricesError, MatricesFormat, MatrixFiles, MatrixUnits, ReducedModel,
    SparseSymmetric,
};
use asperity_mesh::{PortPattern, SparseBody};
use asperity_scenario::{MatricesFormatSpec, MatricesSpec, StructureBodySpec, UnitsSpec};
use asperity_structure::StructureError;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::error::SimulationError;

/// A body as its files have it, without the rows that are held.
pub(super) struct Body {
    name: String,
    pub(super) matrices: Matrices,
    /// Forces on its rows of a gravity of 1 m/s2 along each axis that has gravity \[kg\].
    pub(super) weights: [PortPattern; 3],
}

/// The mesh of a body in metres, if it has one.
pub(super) fn read_deck(
    spec: &StructureBodySpec,
    folder: &Path,
) -> Result<Option<Deck>, SimulationError> {
    let Some(file) = &spec.mesh else { return Ok(None) };
    let mut deck = Deck::read(&folder.join(file))?;
    deck.convert(units(spec)?);
    Ok(Some(deck))
}

fn units(spec: &StructureBodySpec) -> Result<MatrixUnits, MatricesError> {
    MatrixUnits::new(spec.units.length_m, spec.units.mass_kg, spec.units.time_s)
}

/// The reduced model of a body, if it is one.
pub(super) fn read_model(
    spec: &StructureBodySpec,
    folder: &Path,
    place: &str,
) -> Result<Option<ReducedModel>, SimulationError> {
    let Some(matrices) = &spec.matrices else { return Ok(None) };
    let MatricesSpec { format, stiffness, mass, rows } = matrices;
    if *format != MatricesFormatSpec::Reduced {
        return Ok(None);
    }
    let refused = [
        ("matrices/mass", mass.is_some()),
        ("matrices/rows", rows.is_some()),
        ("mesh", spec.mesh.is_some()),
        ("units", spec.units != UnitsSpec::default()),
    ];
    if let Some((key, _)) = refused.iter().find(|(_, given)| *given) {
        let problem = "a reduced model is one file in SI, without rows of nodes";
        let accepted = "\"matrices\": {\"format\": \"reduced\", \"stiffness\": FILE}";
        return Err(SimulationError::model(&format!("{place}/{key}"), problem, accepted));
    }
    Ok(Some(asperity_matrices::read_reduced(&folder.join(stiffness))?))
}

impl Body {
    /// The body of a reduced model.
    pub(super) fn of_model(name: &str, model: &ReducedModel) -> Result<Self, SimulationError> {
        Ok(Self { name: name.to_owned(), matrices: model.matrices()?, weights: Default::default() })
    }

    /// The body of the `matrices` of `spec`, under `gravity` along some axes, with `held` displacements.
    pub(super) fn read(
        (spec, matrices): (&StructureBodySpec, &MatricesSpec),
        folder: &Path,
        deck: Option<&Deck>,
        gravity: [bool; 3],
        held: &[Dof],
    ) -> Result<Self, SimulationError> {
        let name = &spec.name;
        let format = match matrices.format {
            MatricesFormatSpec::Calculix => MatricesFormat::Calculix,
            MatricesFormatSpec::Abaqus => MatricesFormat::Abaqus,
            MatricesFormatSpec::MatrixMarket => MatricesFormat::MatrixMarket,
            MatricesFormatSpec::Nastran => MatricesFormat::Nastran,
            MatricesFormatSpec::Npz => MatricesFormat::Npz,
            MatricesFormatSpec::Matlab | MatricesFormatSpec::Reduced => MatricesFormat::Matlab,
        };
        let at = |file: &String| folder.join(file);
        let mut read = asperity_matrices::read(&MatrixFiles {
            format,
            stiffness: at(&matrices.stiffness),
            mass: matrices.mass.as_ref().map(at),
            rows: matrices.rows.as_ref().map(at),
        })?;
        read.convert(units(spec)?);
        let nodes = deck.map(Deck::nodes);
        let findings = read.findings(nodes);
        if let Some(fault) = findings.iter().find(|finding| finding.is_fault) {
            let accepted = "matrices of a structure without contact";
            let problem = format!("{name}: {fault}");
            return Err(SimulationError::model("/bodies", problem, accepted));
        }
        for finding in &findings {
            tracing::info!(body = name, "{finding}");
        }
        // The weight of rows that are held still acts on their neighbours.
        let unit = |axis: usize| [0, 1, 2].map(|other| f64::from(u8::from(other == axis)));
        let forces = [0, 1, 2].map(|axis| {
            if gravity[axis] { read.gravity_loads(unit(axis), nodes) } else { Vec::new() }
        });
        let all = read.dofs().to_vec();
        let matrices = read.hold(held)?;
        let weights = forces.map(|forces| {
            let own = all.iter().zip(forces).filter(|(_, force)| *force != 0.0);
            own.filter_map(|(dof, force)| Some((matrices.row(*dof)?, force))).collect()
        });
        Ok(Self { name: name.clone(), matrices, weights })
    }

    /// The row of a degree of freedom; none if it is held.
    pub(super) fn row(&self, dof: Dof, place: &str) -> Result<Option<usize>, SimulationError> {
        let row = self.matrices.row(dof);
        if row.is_none() && self.matrices.held().binary_search(&dof).is_err() {
            let problem = format!("body \"{}\" has no row of {dof}", self.name);
            let accepted =
                "degrees of freedom that are in the matrices: neither held nor dependent";
            return Err(SimulationError::model(place, problem, accepted));
        }
        Ok(row)
    }

    /// Rows of a node along a direction.
    pub(super) fn along(
        &self,
        node: i64,
        direction: [f64; 3],
        place: &str,
    ) -> Result<PortPattern, SimulationError> {
        let Some(direction) = unit(direction) else {
            let at = format!("{place}/direction");
            return Err(SimulationError::model(
                &at,
                "the direction has no length",
                "three numbers, not all zero",
            ));
        };
        let mut pattern = PortPattern::new();
        for (part, axis) in direction.iter().zip(1_u8..).filter(|(part, _)| **part != 0.0) {
            let row = self.row(Dof::new(node, axis), place)?;
            pattern.extend(row.map(|row| (row, *part)));
        }
        if pattern.is_empty() {
            let problem = format!("node {node} of body \"{}\" is held there", self.name);
            return Err(SimulationError::model(place, problem, "a direction that moves"));
        }
        Ok(pattern)
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

/// A direction of unit length; none for one without a length.
pub(super) fn unit(direction: [f64; 3]) -> Option<[f64; 3]> {
    let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
    (length.is_finite() && length > 0.0).then(|| direction.map(|part| part / length))
}
