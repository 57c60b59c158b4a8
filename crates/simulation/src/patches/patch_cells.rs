//! Cells of contact patches: from a file, between two surfaces, or of a reduced model.

use std::path::Path;

use asperity_matrices::{
    CellWeight, ContactCell, ContactSurface, Dof, MatricesError, PatchSplit, ReducedModel,
    SurfaceCells,
};
use asperity_mesh::{PortPair, PortPattern};
use asperity_scenario::{PatchSpec, SideSpec, SplitSpec};

use super::body::Body;
use super::ports::{Patch, Ports};
use crate::error::SimulationError;

/// Most cells of a structure, with its springs.
const MOST_CELLS: usize = asperity_dynamics::MOST_CONTACTS;

/// Cells of a patch, with polygons that cover them where they are known.
pub(super) struct Cells {
    pub(super) cells: Vec<ContactCell>,
    outlines: Vec<Vec<Vec<[f64; 3]>>>,
}

impl Cells {
    /// One cell of `area` \[m2\], whose place is not known.
    pub(super) fn one(name: &str, area: f64) -> Self {
        let cell = ContactCell { name: name.to_owned(), area_m2: area, weights: Vec::new() };
        Self { cells: vec![cell], outlines: Vec::new() }
    }
}

impl Ports<'_> {
    /// Adds an interface.
    pub(super) fn add_patch(
        &mut self,
        patch: &PatchSpec,
        number: usize,
        folder: &Path,
    ) -> Result<(), SimulationError> {
        let place = format!("/interfaces/{number}");
        let (Cells { cells, outlines }, pairs) = self.cells_and_pairs(patch, &place, folder)?;
        let first = self.map.pairs.len();
        if first + cells.len() > MOST_CELLS {
            let problem = format!("{} cells in all", first + cells.len());
            let key = match (&patch.cells, &patch.array) {
                (Some(_), _) => "cells",
                (None, Some(_)) => "array",
                (None, None) => "split",
            };
            let accepted =
                format!("at most {MOST_CELLS}; a grid such as \"split\": [12, 3] has few");
            return Err(SimulationError::model(&format!("{place}/{key}"), problem, accepted));
        }
        self.map.pairs.extend(pairs);
        self.map.areas.extend(cells.iter().map(|cell| cell.area_m2));
        self.map.patches.push(Patch {
            name: patch.name.clone(),
            cells: first..self.map.pairs.len(),
            cell_names: cells.into_iter().map(|cell| cell.name).collect(),
            outlines,
        });
        Ok(())
    }

    /// The cells of a patch, and the ports that each joins.
    fn cells_and_pairs(
        &mut self,
        patch: &PatchSpec,
        place: &str,
        folder: &Path,
    ) -> Result<(Cells, Vec<PortPair>), SimulationError> {
        if let Some(area) = patch.area_m2 {
            return self.place_contact(patch, area, place);
        }
        let end = |side: &Option<SideSpec>| side.as_ref().is_some_and(|side| side.end.is_some());
        if end(&patch.above) || end(&patch.below) {
            let (PatchSpec { cells: None, body: None, array: None, .. }, Some(above), Some(below)) =
                (patch, &patch.above, &patch.below)
            else {
                let problem = "the contact of an end of a bar has no area";
                let accepted = "\"area_m2\", or the other side with a \"surface\" or a \"set\"";
                return Err(SimulationError::model(place, problem, accepted));
            };
            return self.end_contact(patch, (above, below), place);
        }
        let cells = self.cells(patch, place, folder)?;
        let pairs = cells.cells.iter().map(|cell| self.cell_pair(cell, patch, place));
        let pairs = pairs.collect::<Result<_, _>>()?;
        Ok((cells, pairs))
    }

    /// The cells of a patch, from its file or between its surfaces, with polygons that cover them.
    fn cells(
        &self,
        patch: &PatchSpec,
        place: &str,
        folder: &Path,
    ) -> Result<Cells, SimulationError> {
        let above = match patch {
            PatchSpec {
                cells: Some(file),
                above: None,
                below: None,
                split: None,
                along: None,
                array: None,
                ..
            } => {
                let cells = asperity_matrices::read_cells(&folder.join(file))?;
                return Ok(Cells { cells, outlines: Vec::new() });
            }
            PatchSpec {
                cells: None,
                body: Some(body),
                array: Some(_),
                above: None,
                below: None,
                split: None,
                along: None,
                ..
            } => {
                let model = self.model(body, &format!("{place}/body"))?;
                return Ok(Cells { cells: cells_of(model, body), outlines: Vec::new() });
            }
            PatchSpec { cells: None, body: None, array: None, above: Some(above), .. } => above,
            _ => {
                let problem = "the cells are given twice or not at all";
                let accepted = "\"cells\", a file, with or without \"body\"; \"above\" with or without \"below\", \"split\" and \"along\"; or \"body\" and \"array\" of a reduced model";
                return Err(SimulationError::model(place, problem, accepted));
            }
        };
        let below = patch.below.as_ref();
        let [above_at, below_at] = ["above", "below"].map(|key| format!("{place}/{key}"));
        let below = below.map(|below| (below, below_at.as_str()));
        Ok(self.surface_cells(patch, (above, &above_at), below)?.0)
    }

    /// Cells between surfaces, or of one on rigid ground, and the normal from the first to the second; each side with its place in
    /// the scenario.
    pub(super) fn surface_cells(
        &self,
        patch: &PatchSpec,
        (above, above_at): (&SideSpec, &str),
        below: Option<(&SideSpec, &str)>,
    ) -> Result<(Cells, [f64; 3]), SimulationError> {
        let split = match patch.split {
            Some(SplitSpec::Grid(cells)) => PatchSplit::Grid { cells, along: patch.along },
            None | Some(SplitSpec::Faces(_)) if patch.along.is_none() => PatchSplit::Faces,
            _ => {
                let problem = "a direction without a grid";
                let accepted = "\"along\" beside \"split\": [columns, rows]";
                let parent = above_at.rsplit_once('/').map_or("", |(parent, _)| parent);
                let at = format!("{parent}/along");
                return Err(SimulationError::model(&at, problem, accepted));
            }
        };
        let upper = self.surface(above, above_at)?;
        let lower = below.map(|(side, at)| self.surface(side, at)).transpose()?;
        let made = SurfaceCells::new(&upper, lower.as_ref(), split);
        let fault_at = below.map_or(above_at, |(_, below_at)| below_at);
        let SurfaceCells { cells, outlines, surface_areas_m2, normal, .. } =
            made.map_err(|error| at(fault_at, error))?;
        let area: f64 = cells.iter().map(|cell| cell.area_m2).sum();
        let [above, below] = surface_areas_m2;
        tracing::info!(
            interface = patch.name,
            cells = cells.len(),
            "contact area {area:.6e} m2 of surfaces of {above:.6e} m2 and {below:.6e} m2"
        );
        Ok((Cells { cells, outlines }, normal))
    }

    fn surface<'b>(
        &'b self,
        side: &'b SideSpec,
        place: &str,
    ) -> Result<ContactSurface<'b>, SimulationError> {
        let body = self.body(&side.body, &format!("{place}/body"))?;
        let deck = self.deck(body, &format!("{place}/body"))?;
        let (key, found) = match (&side.surface, &side.set) {
            _ if side.node.is_some() || side.end.is_some() => {
                let (problem, accepted) = ("the side has no area", "\"area_m2\" of the interface");
                return Err(SimulationError::model(place, problem, accepted));
            }
            (Some(name), None) => {
                ("surface", ContactSurface::of_surface(deck, name, Some(&side.body)))
            }
            (None, Some(name)) => {
                ("set", ContactSurface::of_node_set(deck, name, Some(&side.body)))
            }
            _ => {
                let problem = "the surface is given twice or not at all";
                return Err(SimulationError::model(place, problem, "\"surface\" or \"set\""));
            }
        };
        found.map_err(|error| at(&format!("{place}/{key}"), error))
    }

    /// The closure of a cell: of one body a port of its own, of two the difference of two ports.
    fn cell_pair(
        &mut self,
        cell: &ContactCell,
        patch: &PatchSpec,
        place: &str,
    ) -> Result<PortPair, SimulationError> {
        let mut patterns: Vec<(usize, PortPattern)> = Vec::new();
        for weight in &cell.weights {
            let name = weight.body.as_ref().or(patch.body.as_ref()).ok_or_else(|| {
                let accepted = "\"body\" of the interface, or a column body in the file of cells";
                SimulationError::model(place, "the cells have no body", accepted)
            })?;
            let body = self.body(name, &format!("{place}/body"))?;
            let row = |body: &Body| body.row(weight.dof, &format!("{place}/cells"));
            let row = self.bodies[body].as_ref().map(row).transpose()?.flatten();
            let known = patterns.iter().position(|(own, _)| *own == body);
            let number = known.unwrap_or_else(|| {
                patterns.push((body, PortPattern::new()));
                patterns.len() - 1
            });
            // Rows that are held do not move.
            patterns[number].1.extend(row.map(|row| (row, weight.weight)));
        }
        let mut patterns = patterns.into_iter();
        match (patterns.next(), patterns.next(), patterns.next()) {
            (Some((body, pattern)), None, None) => Ok(PortPair::on_ground(self.add(body, pattern))),
            (Some((above, upper)), Some((below, lower)), None) => {
                let upper = self.add(above, upper);
                let negative = lower.into_iter().map(|(row, weight)| (row, -weight)).collect();
                Ok(PortPair::between(upper, self.add(below, negative)))
            }
            _ => {
                let problem = format!("cell {} joins more than two bodies", cell.name);
                Err(SimulationError::model(
                    &format!("{place}/cells"),
                    problem,
                    "cells of one or two bodies",
                ))
            }
        }
    }
}

/// The cells of a reduced model, numbered from 0.
fn cells_of(model: &ReducedModel, body: &str) -> Vec<ContactCell> {
    let weights = |cell: usize| {
        let weight = |(node, column): (i64, usize)| CellWeight {
            body: Some(body.to_owned()),
            dof: Dof::new(node, 1),
            weight: model.closure.get(cell, column),
        };
        let columns = (1..).zip(0..model.closure.columns());
        columns.map(weight).filter(|one| one.weight != 0.0).collect()
    };
    let cell = |(cell, area): (usize, &f64)| ContactCell {
        name: cell.to_string(),
        area_m2: *area,
        weights: weights(cell),
    };
    model.areas_m2.iter().enumerate().map(cell).collect()
}

/// A fault of a mesh with the place in the scenario that names it.
fn at(place: &str, error: MatricesError) -> SimulationError {
    match error {
        MatricesError::Inconsistent { what, remedy } => SimulationError::model(place, what, remedy),
        other => other.into(),
    }
}
