//! Cells of a contact patch between two surfaces whose meshes need not match.

use std::collections::BTreeMap;

use crate::contact_surface::{Bounds, ContactSurface, Plane, PlaneFace};
use crate::nodes::{dot, norm};
use crate::polygon::{self, Polygon};
use crate::{CellWeight, ContactCell, Dof, MatricesError};

/// Component of a unit normal that is rounding of the places of nodes.
const ROUNDING: f64 = 1e-9;

/// Length of the vector area of a surface over its area, from which it is near a plane: tilts of 18 degrees.
const NEAR_PLANE: f64 = 0.95;

/// Area of a cell, over the area of its face or rectangle, below which it is a sliver by rounding.
const SLIVER: f64 = 1e-9;

/// Part of a cell of the grid by which a face may pass its edge and be of the cell.
const ON_LINE: f64 = 1e-6;

/// Depth by which surfaces may lie in each other, and gap between them, over the root of the area.
const DEEPEST: f64 = 0.1;
const WIDEST: f64 = 1.0;

/// Weight that is zero.
const NO_WEIGHT: f64 = 1e-14;

/// Division of a patch into cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PatchSplit {
    /// A cell for each face of the surface above.
    Faces,
    /// A grid over the patch in its plane.
    Grid {
        /// Numbers of cells along the first and the second direction in the plane.
        cells: [usize; 2],
        /// First direction; without it the first of x, y, z that is not near the normal.
        along: Option<[f64; 3]>,
    },
}

/// Cells of a patch between two surfaces, or of a surface on rigid ground.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceCells {
    /// The cells.
    pub cells: Vec<ContactCell>,
    /// Polygons that cover each cell, at the mean height of the surface above \[m\].
    pub outlines: Vec<Vec<Vec<[f64; 3]>>>,
    /// Unit normal of the patch, out of the body above.
    pub normal: [f64; 3],
    /// Areas of the surfaces above and below \[m2\].
    pub surface_areas_m2: [f64; 2],
}

impl SurfaceCells {
    /// The cells between the surfaces `above` and `below`, or of `above` on rigid ground.
    ///
    /// Faces are projected onto a plane whose normal `n` points from the body above to the body below. A cell
    /// is the area `A` that faces of both surfaces cover there, and its closure the difference of the means of both,
    /// in the shape functions `N` of the faces:
    ///
    /// ```text
    /// d = 1/A integral over A of (u_above - u_below) . n dA,     u = sum_i N_i(x) u_i
    /// ```
    ///
    /// Means are exact for straight edges (of 8-node faces: of parallelograms) and for faces of both sides at one
    /// place; curved edges of others are chords, with an error of the area of 0.1 %. Cells of
    /// [`PatchSplit::Faces`] are named `element:face`, of a grid `column + columns row`, from 0. Cells where one
    /// surface is missing are left out. Surfaces need not be flat, as long as they stay near the plane: areas
    /// are projected.
    ///
    /// # Errors
    /// [`MatricesError`] for surfaces that do not face each other, are not near a plane, lie behind or far from each other,
    /// or do not overlap, and for faces that are folded or have no area.
    ///
    /// ```
    /// use asperity_matrices::{ContactSurface, Deck, PatchSplit, SurfaceCells};
    ///
    /// let deck = Deck::of_text("cube.inp", "\
    /// *NODE
    /// 1, 0, 0, 0
    /// 2, 2, 0, 0
    /// 3, 2, 1, 0
    /// 4, 0, 1, 0
    /// 5, 0, 0, 1
    /// 6, 2, 0, 1
    /// 7, 2, 1, 1
    /// 8, 0, 1, 1
    /// *ELEMENT, TYPE=C3D8, ELSET=CUBE
    /// 1, 1, 2, 3, 4, 5, 6, 7, 8
    /// *SURFACE, NAME=FOOT, TYPE=ELEMENT
    /// CUBE, S1
    /// ")?;
    /// let foot = ContactSurface::of_surface(&deck, "FOOT", None)?;
    /// let split = PatchSplit::Grid { cells: [2, 1], along: None };
    /// let patch = SurfaceCells::new(&foot, None, split)?;
    /// assert_eq!(patch.normal, [0.0, 0.0, -1.0]);
    /// assert!((patch.cells[0].area_m2 - 1.0).abs() < 1e-15);
    /// # Ok::<(), asperity_matrices::MatricesError>(())
    /// ```
    pub fn new(
        above: &ContactSurface<'_>,
        below: Option<&ContactSurface<'_>>,
        split: PatchSplit,
    ) -> Result<Self, MatricesError> {
        let (normal, surface_areas_m2) = common_normal(above, below)?;
        let along = if let PatchSplit::Grid { along, .. } = split { along } else { None };
        let plane = Plane::new(normal, along).ok_or_else(|| {
            let what = format!("the grid of a patch along {along:?}, near its normal {normal:?}");
            MatricesError::inconsistent(what, "expected a direction in the plane of the patch")
        })?;
        let height = plane.height(above);
        let upper = above.in_plane(&plane)?;
        let lower = below.map(|below| below.in_plane(&plane)).transpose()?;
        let bounds = Bounds::of(&upper);
        let bounds = lower.as_ref().map_or(bounds, |faces| bounds.common(Bounds::of(faces)));
        let grid = Grid::new(split, bounds);
        let mut sums: BTreeMap<usize, CellSum> = BTreeMap::new();
        let overlay = Overlay { above, below, grid, lower: lower.map(Sorted::new) };
        for (number, face) in upper.iter().enumerate() {
            overlay.add(number, face, &mut sums)?;
        }
        let nominal = |cell: usize| match overlay.grid {
            Some(grid) => grid.cell_area(),
            None => upper[cell].integrals().1,
        };
        sums.retain(|cell, sum| sum.area > SLIVER * nominal(*cell));
        if sums.is_empty() {
            let what = format!("the surfaces {} do not overlap", names(above, below));
            let remedy = "expected surfaces that face each other across the patch";
            return Err(MatricesError::inconsistent(what, remedy));
        }
        let named = |cell: usize| match overlay.grid {
            Some(_) => cell.to_string(),
            None => format!("{}:S{}", upper[cell].face.element, upper[cell].face.face),
        };
        let cells =
            sums.iter().map(|(&cell, sum)| sum.cell(named(cell), [Some(above), below], normal));
        let cells = cells.collect();
        let placed = |polygon: Polygon| {
            polygon.into_iter().map(|at| plane.place(at, height)).collect::<Vec<_>>()
        };
        let outlines =
            sums.into_values().map(|sum| sum.outlines.into_iter().map(placed).collect()).collect();
        Ok(Self { cells, outlines, normal, surface_areas_m2 })
    }
}

fn names(above: &ContactSurface<'_>, below: Option<&ContactSurface<'_>>) -> String {
    match below {
        Some(below) => format!("{} and {}", above.name, below.name),
        None => above.name.to_owned(),
    }
}

/// The normal from above to below, and the areas of both surfaces.
fn common_normal(
    above: &ContactSurface<'_>,
    below: Option<&ContactSurface<'_>>,
) -> Result<([f64; 3], [f64; 2]), MatricesError> {
    let (upper, upper_area) = mean_normal(above)?;
    let (mut normal, mut lower_area) = (upper, 0.0);
    if let Some(below) = below {
        let (lower, area) = mean_normal(below)?;
        lower_area = area;
        if dot(upper, lower) > -NEAR_PLANE {
            let short = |normal: [f64; 3]| {
                let [x, y, z] = normal.map(|x| format!("{:.3}", x + 0.0));
                format!("({x}, {y}, {z})")
            };
            let what = format!(
                "the surfaces {} do not face each other: their outward normals are {} and {}",
                names(above, Some(below)),
                short(upper),
                short(lower)
            );
            return Err(MatricesError::inconsistent(what, "expected opposite normals"));
        }
        normal = [0, 1, 2].map(|k| upper[k] - lower[k]);
    }
    normal = normal.map(|x| x / norm(normal));
    normal = normal.map(|x| if x.abs() < ROUNDING { 0.0 } else { x });
    normal = normal.map(|x| x / norm(normal));
    if let Some((below, plane)) = below.zip(Plane::new(normal, None)) {
        let gap = plane.height(below) - plane.height(above);
        let size = upper_area.min(lower_area).sqrt();
        if !(-DEEPEST * size..=WIDEST * size).contains(&gap) {
            let side = if gap < 0.0 { "behind" } else { "beyond" };
            let what = format!(
                "the surface {} lies {:.4e} m {side} the surface {}",
                below.name,
                gap.abs(),
                above.name
            );
            let remedy = "expected surfaces in contact; initial_gap_m sets a gap between them";
            return Err(MatricesError::inconsistent(what, remedy));
        }
    }
    Ok((normal, [upper_area, lower_area]))
}

/// The mean outward normal of a surface, and its area.
fn mean_normal(surface: &ContactSurface<'_>) -> Result<([f64; 3], f64), MatricesError> {
    let areas = surface.vector_areas()?;
    let sum = areas.iter().fold([0.0; 3], |sum, area| [0, 1, 2].map(|k| sum[k] + area[k]));
    let area: f64 = areas.iter().map(|area| norm(*area)).sum();
    let length = norm(sum);
    if !(area > 0.0 && length > NEAR_PLANE * area) {
        let what = format!("the surface {} is not near a plane", surface.name);
        let remedy =
            "expected faces with normals within 18 degrees; split a curved surface into patches";
        return Err(MatricesError::inconsistent(what, remedy));
    }
    let normal = sum.map(|x| x / length);
    let away = areas.iter().position(|area| dot(*area, normal) <= 0.5 * norm(*area));
    if let Some(face) = away {
        let problem = "has no area, or looks away from the others by 60 degrees or more";
        return Err(surface.wrong(&surface.faces[face], problem));
    }
    Ok((normal, area))
}

/// Cells of a grid.
#[derive(Debug, Clone, Copy)]
struct Grid {
    cells: [usize; 2],
    low: [f64; 2],
    /// Sides of a cell.
    sides: [f64; 2],
}

impl Grid {
    fn new(split: PatchSplit, bounds: Bounds) -> Option<Self> {
        let PatchSplit::Grid { cells, .. } = split else { return None };
        let cells = cells.map(|count| count.max(1));
        let sides = [0, 1].map(|k| (bounds.high[k] - bounds.low[k]) / cells[k] as f64);
        Some(Self { cells, low: bounds.low, sides })
    }

    fn cell_area(self) -> f64 {
        self.sides[0] * self.sides[1]
    }

    /// Columns and rows that a face lies in.
    fn range(self, bounds: &Bounds) -> [std::ops::Range<usize>; 2] {
        [0, 1].map(|k| {
            let first = ((bounds.low[k] - self.low[k]) / self.sides[k] + ON_LINE).floor().max(0.0);
            let end = ((bounds.high[k] - self.low[k]) / self.sides[k] - ON_LINE).ceil();
            let end = (end.max(0.0) as usize).min(self.cells[k]);
            (first as usize).min(end)..end
        })
    }

    fn number(self, column: usize, row: usize) -> usize {
        column + self.cells[0] * row
    }

    fn rectangle(self, column: usize, row: usize) -> Polygon {
        let at = |i: usize, j: usize| {
            [self.low[0] + i as f64 * self.sides[0], self.low[1] + j as f64 * self.sides[1]]
        };
        vec![at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)]
    }
}

/// Faces by their lowest first coordinate.
struct Sorted<'a> {
    faces: Vec<PlaneFace<'a>>,
}

impl<'a> Sorted<'a> {
    fn new(mut faces: Vec<PlaneFace<'a>>) -> Self {
        faces.sort_by(|a, b| a.bounds.low[0].total_cmp(&b.bounds.low[0]));
        Self { faces }
    }

    fn near(&self, bounds: &Bounds) -> Vec<&PlaneFace<'a>> {
        let end = self.faces.partition_point(|face| face.bounds.low[0] < bounds.high[0]);
        self.faces[..end].iter().filter(|face| face.bounds.overlaps(bounds)).collect()
    }
}

/// Sums of a cell: integrals of the shape functions of both sides.
#[derive(Debug, Default)]
struct CellSum {
    area: f64,
    /// Area of the faces of each side: equal, but for rounding.
    areas: [f64; 2],
    integrals: [BTreeMap<i64, f64>; 2],
    outlines: Vec<Polygon>,
}

impl CellSum {
    fn add_whole(&mut self, side: usize, face: &PlaneFace<'_>) {
        let (integrals, area) = face.integrals();
        self.areas[side] += area;
        for (node, value) in face.face.nodes.iter().zip(integrals) {
            *self.integrals[side].entry(*node).or_default() += value;
        }
        if side == 0 {
            self.area += area;
            self.outlines.push(face.outline());
        }
    }

    /// Adds a polygon that lies in the faces; none if a face is folded there.
    fn add_part(&mut self, polygon: Polygon, faces: &[&PlaneFace<'_>]) -> Option<()> {
        for (place, weight) in polygon::rule(&polygon) {
            for (side, face) in faces.iter().enumerate() {
                let at = face.shape.locate(&face.places, place, face.size)?;
                self.areas[side] += weight;
                for (node, value) in face.face.nodes.iter().zip(face.shape.at(at).values) {
                    *self.integrals[side].entry(*node).or_default() += weight * value;
                }
            }
            self.area += weight;
        }
        self.outlines.push(polygon);
        Some(())
    }

    fn cell(
        &self,
        name: String,
        surfaces: [Option<&ContactSurface<'_>>; 2],
        normal: [f64; 3],
    ) -> ContactCell {
        // A node of both surfaces, of one mesh, has the difference.
        let mut by_dof: BTreeMap<(Option<&str>, Dof), f64> = BTreeMap::new();
        for ((integrals, surface), (sign, area)) in
            self.integrals.iter().zip(surfaces).zip([1.0, -1.0].into_iter().zip(self.areas))
        {
            let Some(surface) = surface else { continue };
            for (&node, integral) in integrals {
                for (direction, part) in (1..).zip(normal) {
                    let weight = sign * integral / area * part;
                    *by_dof.entry((surface.body, Dof::new(node, direction))).or_default() += weight;
                }
            }
        }
        let kept = by_dof.into_iter().filter(|(_, weight)| weight.abs() > NO_WEIGHT);
        let weights = kept.map(|((body, dof), weight)| CellWeight {
            body: body.map(str::to_owned),
            dof,
            weight,
        });
        ContactCell { name, area_m2: self.area, weights: weights.collect() }
    }
}

/// Two surfaces and the cells between them.
struct Overlay<'a> {
    above: &'a ContactSurface<'a>,
    below: Option<&'a ContactSurface<'a>>,
    grid: Option<Grid>,
    lower: Option<Sorted<'a>>,
}

impl Overlay<'_> {
    /// Adds a face of the surface above to the cells that it is in.
    fn add(
        &self,
        number: usize,
        face: &PlaneFace<'_>,
        sums: &mut BTreeMap<usize, CellSum>,
    ) -> Result<(), MatricesError> {
        // The cells that the face is in, with their rectangles where there are several.
        let cells: Vec<(usize, Option<Polygon>)> = match self.grid {
            None => vec![(number, None)],
            Some(grid) => {
                let [columns, rows] = grid.range(&face.bounds);
                let single = columns.len() == 1 && rows.len() == 1;
                let of_row = |row| columns.clone().map(move |column| (column, row));
                let cell = |(column, row)| {
                    let rectangle = (!single).then(|| grid.rectangle(column, row));
                    (grid.number(column, row), rectangle)
                };
                rows.flat_map(of_row).map(cell).collect()
            }
        };
        let near = self.lower.as_ref().map(|lower| lower.near(&face.bounds));
        if let [(cell, None)] = cells.as_slice() {
            // The whole face is of one cell.
            let partner = near.as_ref().map(|near| near.iter().find(|other| face.coincides(other)));
            if partner.is_none_or(|partner| partner.is_some()) {
                let sum = sums.entry(*cell).or_default();
                sum.add_whole(0, face);
                if let Some(partner) = partner.flatten() {
                    sum.add_whole(1, partner);
                }
                return Ok(());
            }
        }
        let mut add = |cell, polygon: Polygon, faces: &[&PlaneFace<'_>]| {
            if polygon::area(&polygon) <= NO_WEIGHT * face.size * face.size {
                return Ok(());
            }
            let sum: &mut CellSum = sums.entry(cell).or_default();
            sum.add_part(polygon, faces).ok_or_else(|| match (faces, self.below) {
                ([own, ..], None) => self.above.wrong(own.face, "is folded"),
                ([own, other], Some(below)) => {
                    let own_is_folded =
                        own.shape.locate(&own.places, centre(own), own.size).is_none();
                    let (surface, folded) =
                        if own_is_folded { (self.above, own) } else { (below, other) };
                    surface.wrong(folded.face, "is folded, or too curved to be clipped")
                }
                _ => self.above.wrong(face.face, "is folded"),
            })
        };
        for (cell, rectangle) in cells {
            for (facet, _) in &face.facets {
                let part = match &rectangle {
                    Some(rectangle) => polygon::clipped(facet, rectangle),
                    None => facet.clone(),
                };
                if part.len() < 3 {
                    continue;
                }
                let Some(near) = &near else {
                    add(cell, part, &[face])?;
                    continue;
                };
                let around = Bounds::of_places(&part);
                for other in near {
                    for (facet, _) in other.facets.iter().filter(|(_, own)| own.overlaps(&around)) {
                        let common = polygon::clipped(&part, facet);
                        if common.len() >= 3 {
                            add(cell, common, &[face, other])?;
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

fn centre(face: &PlaneFace<'_>) -> [f64; 2] {
    [0, 1].map(|k| 0.5 * (face.bounds.low[k] + face.bounds.high[k]))
}
