//! Cells between two surfaces: exact means on meshes that the tests make, the cells of an independent program, and
//! faults.
#![allow(clippy::print_stderr, reason = "a test without its data says that it was skipped")]
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use asperity_matrices::{
    ContactCell, ContactSurface, Deck, Dof, PatchSplit, SurfaceCells, read_cells,
};

type Outcome = Result<(), Box<dyn std::error::Error>>;

const HEXAHEDRON_EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 0],
    [4, 5],
    [5, 6],
    [6, 7],
    [7, 4],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];
const WEDGE_EDGES: [[usize; 2]; 9] =
    [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];

/// A plate of one layer of elements of a type, and the map of its places.
struct Plate<'a> {
    kind: &'a str,
    /// Elements along x and y; a wedge is half of one.
    elements: [usize; 2],
    low: [f64; 2],
    high: [f64; 2],
    /// Lower and upper face.
    z: [f64; 2],
    map: &'a dyn Fn([f64; 3]) -> [f64; 3],
}

impl Plate<'_> {
    /// A deck with the surfaces BOTTOM and TOP and the node set BELOW of the nodes of BOTTOM.
    fn deck(&self) -> Deck {
        let Self { kind, elements: [nx, ny], low, high, z, map } = self;
        let mut numbers: BTreeMap<[i64; 3], usize> = BTreeMap::new();
        let (mut nodes, mut elements) = (String::from("*NODE\n"), String::new());
        let mut below = String::new();
        let mut count = 0;
        let mut add = |corners: &[[f64; 3]], edges: &[[usize; 2]]| {
            let middle =
                |[a, b]: &[usize; 2]| [0, 1, 2].map(|k| 0.5 * (corners[*a][k] + corners[*b][k]));
            let places = corners.iter().copied().chain(edges.iter().map(middle));
            let mut line = Vec::new();
            for place in places {
                let key = place.map(|x| (x * 1e7).round() as i64);
                let next = numbers.len() + 1;
                let number = *numbers.entry(key).or_insert(next);
                if number == next {
                    let [x, y, z_here] = map(place);
                    writeln!(nodes, "{number},{x:.17e},{y:.17e},{z_here:.17e}").unwrap();
                    if place[2] == z[0] {
                        writeln!(below, "{number}").unwrap();
                    }
                }
                line.push(number.to_string());
            }
            count += 1;
            writeln!(elements, "{count},{}", line.join(",\n")).unwrap();
        };
        let at = |i: usize, j: usize, z: f64| {
            let x = low[0] + (high[0] - low[0]) * i as f64 / *nx as f64;
            [x, low[1] + (high[1] - low[1]) * j as f64 / *ny as f64, z]
        };
        let wedge = kind.starts_with("C3D6") || kind.starts_with("C3D15");
        let quadratic = kind.starts_with("C3D15") || kind.starts_with("C3D20");
        for (i, j) in (0..*nx).flat_map(|i| (0..*ny).map(move |j| (i, j))) {
            let square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let parts: &[&[usize]] =
                if wedge { &[&[0, 1, 2], &[0, 2, 3]] } else { &[&[0, 1, 2, 3]] };
            for part in parts {
                let layer = |z: f64| part.iter().map(move |&n| at(square[n].0, square[n].1, z));
                let corners: Vec<[f64; 3]> = layer(z[0]).chain(layer(z[1])).collect();
                let edges: &[[usize; 2]] = match (quadratic, wedge) {
                    (false, _) => &[],
                    (true, true) => &WEDGE_EDGES,
                    (true, false) => &HEXAHEDRON_EDGES,
                };
                add(&corners, edges);
            }
        }
        let surfaces = "*SURFACE, NAME=BOTTOM, TYPE=ELEMENT\nALL, S1\n*SURFACE, NAME=TOP, TYPE=ELEMENT\nALL, S2\n";
        let text = format!(
            "{nodes}*ELEMENT, TYPE={kind}, ELSET=ALL\n{elements}*NSET, NSET=BELOW\n{below}{surfaces}"
        );
        Deck::of_text("plate.inp", &text).unwrap()
    }
}

/// A polynomial of second degree of a place in the plane.
#[derive(Clone, Copy)]
struct Field([f64; 6]);

impl Field {
    fn at(&self, x: f64, y: f64) -> f64 {
        let [a, b, c, d, e, f] = self.0;
        a + b * x + c * y + d * x * x + e * x * y + f * y * y
    }

    /// Its mean over a rectangle, by Simpson's rule, which is exact.
    fn mean(&self, low: [f64; 2], high: [f64; 2]) -> f64 {
        let line = |a: f64, b: f64| [(a, 1.0 / 6.0), (0.5 * (a + b), 4.0 / 6.0), (b, 1.0 / 6.0)];
        let mut sum = 0.0;
        for (x, a) in line(low[0], high[0]) {
            for (y, b) in line(low[1], high[1]) {
                sum += a * b * self.at(x, y);
            }
        }
        sum
    }
}

/// Turns by the unit quaternion (0.8, 0.36, 0.48, 0) and back.
fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
    let rows = rotation();
    [0, 1, 2].map(|k| rows[k][0] * x + rows[k][1] * y + rows[k][2] * z)
}

fn turned_back(place: [f64; 3]) -> [f64; 3] {
    let rows = rotation();
    [0, 1, 2].map(|k| (0..3).map(|j| rows[j][k] * place[j]).sum())
}

fn rotation() -> [[f64; 3]; 3] {
    let (w, x, y, z) = (0.8, 0.36, 0.48, 0.0);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// The part of the closure of a cell by one body, for displacements of its nodes.
fn part(cell: &ContactCell, body: &str, displacement: &dyn Fn(Dof) -> f64) -> f64 {
    let own = cell.weights.iter().filter(|weight| weight.body.as_deref() == Some(body));
    own.map(|weight| weight.weight * displacement(weight.dof)).sum()
}

/// On meshes that do not match, of all kinds of faces, means over the cells of a grid are exact: of linear
/// fields by linear faces, of quadratic ones by quadratic faces. The patch is oblique to x, y and z.
#[test]
fn means_of_both_sides_are_exact_on_meshes_that_do_not_match() -> Outcome {
    let linear = [Field([0.3, -1.2, 0.7, 0.0, 0.0, 0.0]), Field([-0.4, 0.9, 2.1, 0.0, 0.0, 0.0])];
    let quadratic =
        [Field([0.3, -1.2, 0.7, 1.9, -0.8, 0.6]), Field([0.1, 0.2, -2.0, -1.1, 0.9, 0.4])];
    let normal = turned([0.0, 0.0, -1.0]);
    for (upper, lower) in [
        ("C3D8", "C3D8I"),
        ("C3D20", "C3D8"),
        ("C3D6", "C3D20R"),
        ("C3D15", "C3D20"),
        ("C3D8", "C3D15"),
        ("C3D20", "C3D20"),
    ] {
        let is_quadratic = |kind: &str| kind.starts_with("C3D20") || kind.starts_with("C3D15");
        let side = |kind, elements, low, high, z| {
            Plate { kind, elements, low, high, z, map: &turned }.deck()
        };
        // The patch is x from 0 to 0.7, y from -0.1 to 0.6: neither plate is within the other.
        let above = side(upper, [5, 3], [0.0, -0.1], [1.0, 0.6], [0.001, 0.2]);
        let below = side(lower, [3, 4], [-0.2, -0.3], [0.7, 0.9], [-0.3, 0.0]);
        let along = Some(turned([1.0, 0.0, 0.0]));
        let top = ContactSurface::of_surface(&below, "top", Some("lower"))?;
        let bottom = ContactSurface::of_surface(&above, "BOTTOM", Some("upper"))?;
        let split = PatchSplit::Grid { cells: [4, 3], along };
        let patch = SurfaceCells::new(&bottom, Some(&top), split)?;
        assert_eq!(patch.cells.len(), 12);
        let area: f64 = patch.cells.iter().map(|cell| cell.area_m2).sum();
        assert!((area / 0.49 - 1.0).abs() < 1e-12, "{area}");
        assert!(patch.normal.iter().zip(normal).all(|(a, b)| (a - b).abs() < 1e-14));
        let forward = is_forward(&patch);
        for (number, cell) in patch.cells.iter().enumerate() {
            assert_eq!(cell.name, number.to_string());
            let (column, row) = ((number % 4) as f64, (number / 4) as f64);
            let sides = [0.7 / 4.0, 0.7 / 3.0];
            // The second direction of the grid may be -y of the plates.
            let y = if forward { -0.1 + row * sides[1] } else { 0.6 - (row + 1.0) * sides[1] };
            let low = [column * sides[0], y];
            let high = [low[0] + sides[0], low[1] + sides[1]];
            let fields = [0, 1].map(|side| {
                if is_quadratic([upper, lower][side]) { quadratic[side] } else { linear[side] }
            });
            for (side, (deck, body, sign)) in
                [(&above, "upper", 1.0), (&below, "lower", -1.0)].into_iter().enumerate()
            {
                let displacement = |dof: Dof| {
                    let place = turned_back(deck.nodes().get(dof.node).unwrap());
                    let k = usize::from(dof.direction - 1);
                    // Motion across the normal closes nothing.
                    let tangent = turned([0.6, 0.8, 0.0])[k];
                    fields[side].at(place[0], place[1]) * normal[k] + 3.0 * place[0] * tangent
                };
                let own = sign * part(cell, body, &displacement);
                let mean = fields[side].mean(low, high);
                assert!(
                    (own - mean).abs() < 1e-12,
                    "{upper} {lower} {number} {body}: {own} {mean}"
                );
            }
            // Forces of both sides balance: a motion of both closes nothing.
            let one = |dof: Dof| [0.3, -0.9, 0.5][usize::from(dof.direction - 1)];
            let closure = part(cell, "upper", &one) + part(cell, "lower", &one);
            assert!(closure.abs() < 1e-14, "{closure}");
        }
    }
    Ok(())
}

/// True if rows of the grid follow y of the plates.
fn is_forward(patch: &SurfaceCells) -> bool {
    let centre = |cell: usize| {
        let points: Vec<[f64; 3]> =
            patch.outlines[cell].iter().flatten().map(|place| turned_back(*place)).collect();
        points.iter().map(|place| place[1]).sum::<f64>() / points.len() as f64
    };
    centre(11) > centre(0)
}

/// Linear fields have exact means on distorted meshes too, where faces are no parallelograms; cells of faces add up
/// to the patch.
#[test]
fn faces_of_a_distorted_mesh_have_exact_means_of_linear_fields() -> Outcome {
    let bent = |[x, y, z]: [f64; 3]| [x + 0.1 * x * y, y + 0.15 * x * y - 0.05 * y, z];
    let field = Field([0.2, 1.4, -0.6, 0.0, 0.0, 0.0]);
    for kind in ["C3D8", "C3D20", "C3D15"] {
        let above = Plate {
            kind,
            elements: [3, 3],
            low: [0.0; 2],
            high: [1.0; 2],
            z: [0.0, 0.2],
            map: &bent,
        }
        .deck();
        let flat = |place| place;
        let below = Plate {
            kind: "C3D8",
            elements: [4, 5],
            low: [-0.5; 2],
            high: [2.0; 2],
            z: [-0.2, 0.0],
            map: &flat,
        }
        .deck();
        let bottom = ContactSurface::of_node_set(&above, "BELOW", Some("upper"))?;
        let top = ContactSurface::of_surface(&below, "TOP", Some("lower"))?;
        let patch = SurfaceCells::new(&bottom, Some(&top), PatchSplit::Faces)?;
        assert_eq!(patch.cells.len(), if kind == "C3D15" { 18 } else { 9 });
        let area: f64 = patch.cells.iter().map(|cell| cell.area_m2).sum();
        let whole = SurfaceCells::new(&bottom, None, PatchSplit::Faces)?;
        let ground: f64 = whole.cells.iter().map(|cell| cell.area_m2).sum();
        assert!((area / ground - 1.0).abs() < 1e-12);
        assert_eq!(patch.surface_areas_m2[0], whole.surface_areas_m2[0]);
        assert!((whole.surface_areas_m2[0] / area - 1.0).abs() < 1e-12);
        for (cell, alone) in patch.cells.iter().zip(&whole.cells) {
            assert_eq!(cell.name, alone.name);
            let at = |deck: &Deck, dof: Dof| {
                let [x, y, _] = deck.nodes().get(dof.node).unwrap();
                field.at(x, y)
            };
            let upper = part(cell, "upper", &|dof| at(&above, dof));
            let lower = part(cell, "lower", &|dof| at(&below, dof));
            assert!((upper + lower).abs() < 1e-12, "{kind}: {upper} {lower}");
            // Diagonals of wedges are bent: chords in the patch, and exact in the face alone.
            let ground = part(alone, "upper", &|dof| at(&above, dof));
            let tolerance = if kind == "C3D15" { 1e-4 } else { 1e-12 };
            assert!((upper - ground).abs() < tolerance, "{kind}: {upper} {ground}");
        }
    }
    Ok(())
}

/// Rings of curved faces: at the same places exact, turned against each other by chords.
#[test]
fn curved_faces_are_exact_where_they_coincide_and_chords_elsewhere() -> Outcome {
    let ring = |turn: f64| {
        move |[x, y, z]: [f64; 3]| {
            let angle = 2.0 * std::f64::consts::PI * x + turn;
            [(1.0 + y) * angle.cos(), (1.0 + y) * angle.sin(), z]
        }
    };
    let deck = |turn: f64, z| {
        let map = ring(turn);
        Plate {
            kind: "C3D20",
            elements: [12, 2],
            low: [0.0; 2],
            high: [0.999_999, 1.0],
            z,
            map: &map,
        }
        .deck()
    };
    let (above, below, apart) =
        (deck(0.0, [0.0, 0.3]), deck(0.0, [-0.3, 0.0]), deck(0.2, [-0.3, 0.0]));
    let bottom = ContactSurface::of_surface(&above, "BOTTOM", None)?;
    let areas = |below: Option<&Deck>| -> Result<Vec<f64>, Box<dyn std::error::Error>> {
        let top = below.map(|deck| ContactSurface::of_surface(deck, "TOP", None)).transpose()?;
        let patch = SurfaceCells::new(&bottom, top.as_ref(), PatchSplit::Faces)?;
        Ok(patch.cells.iter().map(|cell| cell.area_m2).collect())
    };
    let ground = areas(None)?;
    assert_eq!(ground.len(), 24);
    assert_eq!(areas(Some(&below))?, ground);
    for (area, exact) in areas(Some(&apart))?.iter().zip(&ground) {
        assert!((area / exact - 1.0).abs() < 2e-3, "{area} {exact}");
    }
    Ok(())
}

fn data(test: &str, problem: &str) -> Option<PathBuf> {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/fe").join(problem);
    if !folder.is_dir() {
        eprintln!("skipped {test}: no data of {problem}");
        return None;
    }
    Some(folder)
}

/// Largest differences of areas (relative) and weights from the cells of a file, by their nodes.
fn differences(cells: &[ContactCell], file: &Path) -> Result<[f64; 2], Box<dyn std::error::Error>> {
    let expected = read_cells(file)?;
    assert_eq!(cells.len(), expected.len());
    let mut most = [0.0_f64; 2];
    let nodes = |cell: &ContactCell| -> BTreeSet<Dof> {
        cell.weights.iter().map(|weight| weight.dof).collect()
    };
    for other in &expected {
        let own = cells.iter().find(|cell| nodes(cell) == nodes(other)).ok_or("no such cell")?;
        most[0] = most[0].max((own.area_m2 / other.area_m2 - 1.0).abs());
        let mut weights: BTreeMap<Dof, f64> =
            own.weights.iter().map(|weight| (weight.dof, weight.weight)).collect();
        for weight in &other.weights {
            *weights.entry(weight.dof).or_default() -= weight.weight;
        }
        most[1] = weights.values().fold(most[1], |most, x| most.max(x.abs()));
    }
    Ok(most)
}

/// The file's points of Gauss have ten digits: its areas are 1.13e-10 above the exact 1e-4 m2, its weights off by as
/// much.
#[test]
fn cells_of_two_blocks_are_those_of_an_independent_program() -> Outcome {
    let test = "cells_of_two_blocks_are_those_of_an_independent_program";
    let Some(folder) = data(test, "two_blocks") else { return Ok(()) };
    let deck = Deck::read(&folder.join("two_blocks.inp"))?;
    let upper = ContactSurface::of_surface(&deck, "CONTACT_UPPER", None)?;
    let lower = ContactSurface::of_surface(&deck, "CONTACT_LOWER", None)?;
    for split in [PatchSplit::Faces, PatchSplit::Grid { cells: [4, 4], along: None }] {
        let patch = SurfaceCells::new(&upper, Some(&lower), split)?;
        let [area, weight] = differences(&patch.cells, &folder.join("cells.csv"))?;
        assert!(area < 1.2e-10 && weight < 1e-10, "{area:e} {weight:e}");
        for cell in &patch.cells {
            assert!((cell.area_m2 / 1e-4 - 1.0).abs() < 1e-13, "{}", cell.area_m2);
            for weight in &cell.weights {
                let exact = [-1.0 / 12.0, 1.0 / 3.0, -0.25];
                let near = |exact: &f64| (weight.weight - exact).abs() < 1e-12;
                assert!(exact.iter().any(near), "{}", weight.weight);
            }
        }
    }
    Ok(())
}

#[test]
fn curved_cells_of_the_lap_joint_are_those_of_an_independent_program() -> Outcome {
    let test = "curved_cells_of_the_lap_joint_are_those_of_an_independent_program";
    let Some(folder) = data(test, "brake_reuss") else { return Ok(()) };
    let deck = Deck::read(&folder.join("brake_reuss.inp.gz"))?;
    let upper = ContactSurface::of_surface(&deck, "CONTACT_UPPER", None)?;
    let lower = ContactSurface::of_surface(&deck, "CONTACT_LOWER", None)?;
    let patch = SurfaceCells::new(&upper, Some(&lower), PatchSplit::Faces)?;
    let [area, weight] = differences(&patch.cells, &folder.join("cells.csv"))?;
    assert!(area < 1e-9 && weight < 1e-9, "{area:e} {weight:e}");
    Ok(())
}

#[test]
fn faults_of_surfaces_are_named() {
    let flat = |place| place;
    let block = |z: [f64; 2], low: f64| {
        Plate { kind: "C3D8", elements: [2, 2], low: [low; 2], high: [low + 1.0; 2], z, map: &flat }
            .deck()
    };
    let (upper, lower) = (block([0.0, 1.0], 0.0), block([-1.0, 0.0], 0.0));
    let (aside, far) = (block([-1.0, 0.0], 2.0), block([-5.0, -4.0], 0.0));
    let patch = |above: (&Deck, &str), below: (&Deck, &str), split| {
        let above = ContactSurface::of_surface(above.0, above.1, Some("a"))?;
        let below = ContactSurface::of_surface(below.0, below.1, Some("b"))?;
        SurfaceCells::new(&above, Some(&below), split)
    };
    let faces = PatchSplit::Faces;
    let cases = [
        (
            patch((&upper, "BOTTOM"), (&lower, "BOTTOM"), faces),
            "the surfaces BOTTOM and BOTTOM do not face each other: their outward normals are (0.000, 0.000, -1.000) and (0.000, 0.000, -1.000)",
        ),
        (patch((&upper, "BOTTOM"), (&aside, "TOP"), faces), "do not overlap"),
        (patch((&upper, "BOTTOM"), (&far, "TOP"), faces), "lies 4.0000e0 m beyond"),
        (patch((&upper, "BOTTOM"), (&upper, "TOP"), faces), "lies 1.0000e0 m behind"),
        (
            patch((&upper, "BOTTOM"), (&lower, "TIP"), faces),
            "plate.inp: no surface TIP; the deck has BOTTOM, TOP",
        ),
        (
            patch(
                (&upper, "BOTTOM"),
                (&lower, "TOP"),
                PatchSplit::Grid { cells: [2, 2], along: Some([0.0, 0.1, 1.0]) },
            ),
            "expected a direction in the plane of the patch",
        ),
    ];
    for (outcome, expected) in cases {
        let message = outcome.unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
    let error = |deck: &Deck| {
        let surface = ContactSurface::of_surface(deck, "BOTTOM", None).unwrap();
        SurfaceCells::new(&surface, None, faces).unwrap_err().to_string()
    };
    let rolled = |[x, y, z]: [f64; 3]| [(2.0 - z) * x.sin(), y, (2.0 - z) * x.cos()];
    let rolled = Plate {
        kind: "C3D8",
        elements: [9, 1],
        low: [0.0; 2],
        high: [3.0, 1.0],
        z: [0.0, 0.1],
        map: &rolled,
    };
    assert!(error(&rolled.deck()).contains("the surface BOTTOM is not near a plane"));
    let squeezed = |[x, y, z]: [f64; 3]| [if x > 0.5 { 0.5 } else { x }, y, z];
    let squeezed = Plate { elements: [2, 1], high: [1.0; 2], map: &squeezed, ..rolled };
    let message = error(&squeezed.deck());
    assert!(message.contains("face S1 of element 2 in BOTTOM has no area"), "{message}");
}
