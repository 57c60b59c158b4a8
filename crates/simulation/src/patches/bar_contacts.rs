//! Contacts of ends of bars: with surfaces, with places of other bodies, with the ground.
//!
//! The end face of a bar is plane and does not turn: every cell of a surface closes against the one displacement of the
//! end, along its normal.

use asperity_mesh::{PortPair, PortPattern};
use asperity_scenario::{End, PatchSpec, SideSpec};

use super::bar::{Bar, dot};
use super::patch_cells::Cells;
use super::ports::{Ports, no_bar};
use crate::error::SimulationError;

/// Cosine of the largest angle between the normals of faces that face each other.
const FACING: f64 = 0.999;

impl Ports<'_> {
    /// The contact of `area` \[m2\] between two places, one of which is the end of a bar: one cell.
    pub(super) fn place_contact(
        &mut self,
        patch: &PatchSpec,
        area: f64,
        place: &str,
    ) -> Result<(Cells, Vec<PortPair>), SimulationError> {
        let PatchSpec {
            cells: None,
            body: None,
            array: None,
            split: None,
            along: None,
            above: Some(above),
            below,
            ..
        } = patch
        else {
            let problem = "the contact of an area joins two places";
            let accepted = "\"area_m2\" and \"above\" with or without \"below\"";
            return Err(SimulationError::model(place, problem, accepted));
        };
        let below = below.as_ref();
        let sides = [Some((above, "above")), below.map(|below| (below, "below"))];
        let mut outward = [None; 2];
        for ((side, key), found) in sides.into_iter().flatten().zip(&mut outward) {
            if let Some(end) = side.end {
                *found = Some(self.bar(side, &format!("{place}/{key}"))?.1.outward(end));
            }
        }
        let normal = match outward {
            [Some(above), Some(below)] => {
                facing(above, below, &format!("{place}/below"))?;
                above
            }
            [Some(normal), None] => normal,
            [None, Some(below)] => below.map(|part| -part),
            [None, None] => {
                let problem = "no side is an end of a bar, whose axis is the normal";
                let accepted = "an \"end\"; between bodies of matrices surfaces, or \"cells\"";
                return Err(SimulationError::model(place, problem, accepted));
            }
        };
        let upper = self.side_port(above, normal, &format!("{place}/above"))?;
        let lower = below.map(|below| self.side_port(below, normal, &format!("{place}/below")));
        let pair = PortPair { upper, lower: lower.transpose()? };
        Ok((Cells::one("0", area), vec![pair]))
    }

    /// The contact of an end of a bar with a surface: the cells of the surface.
    pub(super) fn end_contact(
        &mut self,
        patch: &PatchSpec,
        (above, below): (&SideSpec, &SideSpec),
        place: &str,
    ) -> Result<(Cells, Vec<PortPair>), SimulationError> {
        let [above_at, below_at] = ["above", "below"].map(|key| format!("{place}/{key}"));
        let is_above = above.end.is_some();
        let ((end, end_at), (face, face_at)) = if is_above {
            ((above, &above_at), (below, &below_at))
        } else {
            ((below, &below_at), (above, &above_at))
        };
        if face.end.is_some() {
            let problem = "two ends of bars have no surface";
            let accepted = "the \"area_m2\" of their contact";
            return Err(SimulationError::model(place, problem, accepted));
        }
        let (cells, outward) = self.surface_cells(patch, (face, face_at), None)?;
        let (bar, own) = self.bar(end, end_at)?;
        let which = end.end.unwrap_or(End::Lower);
        facing(own.outward(which), outward, face_at)?;
        // From the body above to the body below.
        let normal = if is_above { outward.map(|part| -part) } else { outward };
        let pattern = own.end_along(which, normal);
        let of_end = self.add(bar, pattern);
        let body = self.body(&face.body, face_at)?;
        let mut pairs = Vec::with_capacity(cells.cells.len());
        for cell in &cells.cells {
            // Closures of cells on the ground are displacements along the outward normal.
            let turned = if is_above { -1.0 } else { 1.0 };
            let mut pattern = PortPattern::new();
            if let Some(read) = &self.bodies[body] {
                for one in &cell.weights {
                    let row = read.row(one.dof, face_at)?;
                    pattern.extend(row.map(|row| (row, turned * one.weight)));
                }
            }
            let of_cell = self.add(body, pattern);
            let (upper, lower) = if is_above { (of_end, of_cell) } else { (of_cell, of_end) };
            pairs.push(PortPair::between(upper, lower));
        }
        Ok((cells, pairs))
    }

    /// The bar of a side that is an end of one, with its number.
    fn bar(&mut self, side: &SideSpec, place: &str) -> Result<(usize, &mut Bar), SimulationError> {
        let number = self.body(&side.body, &format!("{place}/body"))?;
        let bar = self.bars[number].as_mut().ok_or_else(|| no_bar(&side.body, place))?;
        Ok((number, bar))
    }

    /// The port of the displacement of a side along `normal`: of an end, a node, or the mean of the nodes of a set.
    fn side_port(
        &mut self,
        side: &SideSpec,
        normal: [f64; 3],
        place: &str,
    ) -> Result<usize, SimulationError> {
        let (body, pattern) = match *side {
            SideSpec { end: Some(end), node: None, set: None, surface: None, .. } => {
                let (number, bar) = self.bar(side, place)?;
                (number, bar.end_along(end, normal))
            }
            SideSpec { end: None, node, ref set, surface: None, .. }
                if node.is_some() != set.is_some() =>
            {
                let body = self.body(&side.body, &format!("{place}/body"))?;
                let nodes = match (node, set) {
                    (Some(node), _) => vec![node],
                    (None, set) => self.set(body, set.as_deref().unwrap_or_default(), place)?,
                };
                if self.bars[body].is_some() {
                    let problem = "a bar has no nodes";
                    return Err(SimulationError::model(place, problem, "an \"end\" of the bar"));
                }
                (body, self.mean_along(body, &nodes, normal, place)?)
            }
            _ => {
                let problem = "the side of a contact with an area is no place";
                let accepted =
                    "one of \"end\", \"node\" and \"set\"; without \"area_m2\" a \"surface\" too";
                return Err(SimulationError::model(place, problem, accepted));
            }
        };
        Ok(self.add(body, pattern))
    }
}

/// Checks that faces with these outward normals face each other.
fn facing(above: [f64; 3], below: [f64; 3], place: &str) -> Result<(), SimulationError> {
    if dot(above, below) <= -FACING {
        return Ok(());
    }
    let problem = format!(
        "the face, whose outward normal is {below:.3?}, does not face the other, {above:.3?}"
    );
    let accepted =
        "opposite normals; the \"direction\" of a bar goes from its upper to its lower end";
    Err(SimulationError::model(place, problem, accepted))
}
