//! ccx (`CalculiX`) run on the matrices, and with contact on the exported table, of two plates that overlap.
//!
//! Lengths in mm, masses in t, pressures in MPa. ccx has contacts at nodes, asperity between faces: the difference is of
//! second order in the size of the elements.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde_json::json;

use super::calculix::{ccx, frequencies};
use super::{answer, export, number};

/// Static force on both plates \[N\], and the stiffness of a pin \[N/m\].
const BOLT: f64 = 80.0;
const PIN: f64 = 1e8;

/// A plate of C3D8 elements, 20 mm wide and 5 mm thick.
struct Plate {
    /// Number of the node at each place of the grid.
    nodes: BTreeMap<[usize; 3], usize>,
    /// Place of a node \[mm\] over its place in the grid, and the place of the first.
    spacing: [f64; 3],
    start: [f64; 3],
    /// Nodes of each element, with its layer.
    elements: Vec<(usize, usize, [usize; 8])>,
}

impl Plate {
    /// A plate of 80 mm from `start`, `fine` elements in 10 mm of length and width and two in the thickness.
    fn new(start: [f64; 3], fine: usize, first: usize) -> Self {
        let count = [8 * fine, 2 * fine, 2];
        let mut nodes = BTreeMap::new();
        let mut elements = Vec::new();
        for i in 0..count[0] {
            for j in 0..count[1] {
                for k in 0..count[2] {
                    let corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)];
                    let both = [0, 1].map(|up| corners.map(|(a, b, _)| [i + a, j + b, k + up]));
                    let numbers = both.concat().into_iter().map(|place| {
                        let next = first + nodes.len();
                        *nodes.entry(place).or_insert(next)
                    });
                    let numbers: Vec<usize> = numbers.collect();
                    let number = first + elements.len();
                    elements.push((number, k, numbers.try_into().unwrap()));
                }
            }
        }
        let spacing = [10.0 / fine as f64, 10.0 / fine as f64, 2.5];
        Self { nodes, spacing, start, elements }
    }

    fn place(&self, at: &[usize; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.start[axis] + self.spacing[axis] * at[axis] as f64)
    }

    /// Nodes at places of which this holds.
    fn nodes_where(&self, holds: impl Fn([f64; 3]) -> bool) -> Vec<usize> {
        let found = self.nodes.iter().filter(|(at, _)| holds(self.place(at)));
        found.map(|(_, number)| *number).collect()
    }

    /// The only node near a place.
    fn node(&self, place: [f64; 3]) -> usize {
        let near = |at: [f64; 3]| (0..3).all(|axis| (at[axis] - place[axis]).abs() < 1e-6);
        let [node] = self.nodes_where(near)[..] else { panic!("no node at {place:?}") };
        node
    }

    /// Elements of a layer over the lap, 50 to 80 mm.
    fn over_lap(&self, layer: usize) -> Vec<usize> {
        let along = |node: &usize| {
            let at = self.nodes.iter().find(|(_, number)| *number == node).unwrap().0;
            self.place(at)[0]
        };
        let inside = |element: &&(usize, usize, [usize; 8])| {
            let (_, own, nodes) = element;
            *own == layer && nodes.iter().all(|node| (49.999..80.001).contains(&along(node)))
        };
        self.elements.iter().filter(inside).map(|(number, ..)| *number).collect()
    }

    fn deck(&self, name: &str) -> String {
        let mut text = "*NODE,NSET=ALL\n".to_owned();
        for (at, number) in &self.nodes {
            let [x, y, z] = self.place(at);
            writeln!(text, "{number},{x:.9},{y:.9},{z:.9}").unwrap();
        }
        writeln!(text, "*ELEMENT,TYPE=C3D8,ELSET={name}").unwrap();
        for (number, _, nodes) in &self.elements {
            let nodes = nodes.map(|node| node.to_string()).join(",");
            writeln!(text, "{number},{nodes}").unwrap();
        }
        text + &format!("*SOLID SECTION,ELSET={name},MATERIAL=STEEL\n")
    }
}

/// Frequencies \[Hz\] of the joint by asperity and by ccx with contact; `None` where ccx is missing.
fn joint(folder: &Path, fine: usize) -> Option<[Vec<f64>; 2]> {
    let fixed = Plate::new([0.0; 3], fine, 1);
    let free = Plate::new([50.0, 0.0, 5.0], fine, 100_001);
    let bolt = |z: f64| {
        move |at: [f64; 3]| {
            at[2] == z && (59.0..71.0).contains(&at[0]) && (4.0..16.0).contains(&at[1])
        }
    };
    let (upper, lower) = (free.nodes_where(bolt(10.0)), fixed.nodes_where(bolt(0.0)));
    let pins = [60.0, 70.0].map(|x| [free.node([x, 10.0, 5.0]), fixed.node([x, 10.0, 5.0])]);
    let set = |name: &str, nodes: &[usize]| {
        let nodes: Vec<String> = nodes.iter().map(|node| format!("{node}\n")).collect();
        format!("*NSET,NSET={name}\n{}", nodes.concat())
    };
    let surface = |name: &str, elements: Vec<usize>, face: &str| {
        let faces: Vec<String> = elements.iter().map(|one| format!("{one},{face}\n")).collect();
        format!("*SURFACE,NAME={name},TYPE=ELEMENT\n{}", faces.concat())
    };
    let mut mesh = fixed.deck("FIXED") + &free.deck("FREE");
    mesh += &set("CLAMPED", &fixed.nodes_where(|at| at[0] == 0.0));
    mesh += &(set("BOLT_UPPER", &upper) + &set("BOLT_LOWER", &lower));
    mesh += &surface("UPPER", free.over_lap(0), "S1");
    mesh += &surface("LOWER", fixed.over_lap(1), "S2");
    mesh += "*MATERIAL,NAME=STEEL\n*ELASTIC\n210000.,0.3\n*DENSITY\n7.85E-9\n";
    let clamped = "*BOUNDARY\nCLAMPED,1,3\n";
    let matrices = "*STEP\n*FREQUENCY,SOLVER=MATRIXSTORAGE\n*END STEP\n";
    ccx(folder, &(mesh.clone() + clamped + matrices))?;

    let at = |node: usize, direction: [i32; 3]| json!({"body": "joint", "node": node, "direction": direction});
    let pin = |[above, below]: [usize; 2], direction| json!({"from": at(above, direction), "to": at(below, direction), "stiffness_n_per_m": PIN});
    let load = |set: &str, direction: i32| json!({"body": "joint", "set": set, "direction": [0, 0, direction], "force_n": BOLT});
    let scenario = json!({
        "schema": "asperity/scenario/1",
        "bodies": [{"name": "joint", "mesh": "deck.inp",
            "units": {"length_m": 1e-3, "mass_kg": 1e3, "time_s": 1},
            "matrices": {"format": "calculix", "stiffness": "deck.sti", "mass": "deck.mas", "rows": "deck.dof"}}],
        "gravity_m_per_s2": [0, 0, -9.81],
        "loads": [load("BOLT_UPPER", -1), load("BOLT_LOWER", 1)],
        "springs": [pin(pins[0], [1, 0, 0]), pin(pins[0], [0, 1, 0]), pin(pins[1], [0, 1, 0])],
        "interfaces": [{"name": "lap", "law": "rough", "above": {"body": "joint", "surface": "UPPER"},
            "below": {"body": "joint", "surface": "LOWER"}, "split": "faces"}],
        "laws": {"rough": {"kind": "power", "coefficient": 1e8, "exponent": 0.5}},
        "damping": {"kind": "rayleigh", "rate_per_s": 20, "time_s": 1e-6},
        "excitation": {"kind": "haversine", "peak_n": 1, "duration_s": 1e-3, "at": at(upper[0], [0, 0, -1])},
        "sensors": [{"name": "bolt", "kind": "displacement", "at": at(upper[0], [0, 0, 1])}],
        "duration_s": 0.1,
    });
    std::fs::write(folder.join("joint.json"), scenario.to_string()).unwrap();
    let exported = answer(folder, &export("joint.json", "calculix", "mm-t-s"));
    assert_eq!(exported["export"]["contacts"][0]["surface_interaction"], "LAP");
    let modes = answer(folder, &["modes", "joint.json", "--json", "--out", "modes"]);
    let own = (0..3).map(|mode| number(&modes, &format!("/modes/{mode}/frequency_hz"))).collect();

    let mut deck = mesh;
    let [[above, below], [far_above, far_below]] = pins;
    write!(
        deck,
        "*ELEMENT,TYPE=SPRING2,ELSET=ALONG\n900001,{above},{below}\n\
         *ELEMENT,TYPE=SPRING2,ELSET=ACROSS\n900002,{above},{below}\n900003,{far_above},{far_below}\n\
         *SPRING,ELSET=ALONG\n1,1\n{0:.6E}\n*SPRING,ELSET=ACROSS\n2,2\n{0:.6E}\n",
        1e-3 * PIN
    )
    .unwrap();
    deck += "*INCLUDE,INPUT=out/contacts-calculix.inp\n";
    deck += "*CONTACT PAIR,INTERACTION=LAP,TYPE=NODE TO SURFACE\nUPPER,LOWER\n";
    deck += clamped;
    deck +=
        "*STEP,NLGEOM,INC=500\n*CONTROLS,PARAMETERS=FIELD\n1.E-6,1.E-6\n*STATIC\n0.1,1.\n*CLOAD\n";
    for (nodes, sign) in [(&upper, -1.0), (&lower, 1.0)] {
        for node in nodes {
            writeln!(deck, "{node},3,{}", sign * BOLT / nodes.len() as f64).unwrap();
        }
    }
    deck += "*DLOAD\nFIXED,GRAV,9810.,0.,0.,-1.\nFREE,GRAV,9810.,0.,0.,-1.\n*END STEP\n";
    deck += "*STEP,PERTURBATION\n*FREQUENCY\n3\n*END STEP\n";
    Some([own, frequencies(&ccx(folder, &deck)?)])
}

/// The difference falls with the square of the size of the elements: at least threefold from one mesh to another
/// twice as fine.
#[test]
fn a_bolted_joint_has_the_frequencies_of_ccx_with_contact() {
    let mut before: Option<Vec<f64>> = None;
    for fine in [1, 2] {
        let folder = tempfile::tempdir().unwrap();
        let Some([own, found]) = joint(folder.path(), fine) else { return };
        let errors = own.iter().zip(&found).map(|(own, found)| (own / found - 1.0).abs());
        let errors: Vec<f64> = errors.collect();
        eprintln!("{fine}: asperity {own:.2?} Hz, ccx {found:.2?} Hz");
        if let Some(before) = before {
            assert!(errors.iter().all(|error| *error < 0.02), "{errors:?}");
            assert!(
                errors[0] < before[0] / 3.0 && errors[2] < before[2] / 3.0,
                "{before:?} {errors:?}"
            );
        }
        before = Some(errors);
    }
}
