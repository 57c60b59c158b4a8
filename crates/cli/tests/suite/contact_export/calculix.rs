//! ccx (`CalculiX`) run on exported tables: one block, and the paper's rig as a column of one section.
//!
//! Lengths in mm, masses in t, pressures in MPa. Lateral displacements are zero and Poisson's ratio
//! is 0, so that the column is the one-dimensional model.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use super::{ContactLaw, answer, contact, export, fixture, modified, modified_rig, number};

/// Section of sample and contacts \[mm2\], length of the guide \[mm\] and its mass \[t\].
const SECTION: f64 = 115.0;
const GUIDE_LENGTH: f64 = 229.0;
const GUIDE_MASS: f64 = 1.61e-3;

/// Young's modulus \[MPa\] and density \[t/mm3\] of aluminium.
const MODULUS: f64 = 71e3;
const DENSITY: f64 = 2.71e-9;

/// Runs ccx on `deck` in `folder`; the text of its `.dat` file, or `None` where ccx is missing.
pub(super) fn ccx(folder: &Path, deck: &str) -> Option<String> {
    std::fs::write(folder.join("deck.inp"), deck).unwrap();
    let run = Command::new("ccx").args(["-i", "deck"]).current_dir(folder).output();
    let output = match run {
        Ok(output) => output,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: ccx (CalculiX) is not installed");
            return None;
        }
        Err(error) => panic!("ccx: {error}"),
    };
    let log = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && log.contains("Job finished"), "{log}");
    Some(std::fs::read_to_string(folder.join("deck.dat")).unwrap())
}

/// A column of C3D8 elements of square section along z.
struct Column {
    nodes: String,
    elements: String,
    /// First and last element, and last node.
    first_element: usize,
    last_element: usize,
    last_node: usize,
}

impl Column {
    /// `count` elements from height `bottom` to `top`, numbered after `before`.
    fn new(name: &str, before: Option<&Self>, [bottom, top]: [f64; 2], count: usize) -> Self {
        let (node, element) = before.map_or((0, 0), |other| (other.last_node, other.last_element));
        let side = SECTION.sqrt();
        let mut nodes = format!("*NODE,NSET=N{name}\n");
        for layer in 0..=count {
            let z = bottom + (top - bottom) * layer as f64 / count as f64;
            let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
            for (corner, (x, y)) in corners.into_iter().enumerate() {
                let number = node + 4 * layer + corner + 1;
                writeln!(nodes, "{number},{x:.9},{y:.9},{z:.9}").unwrap();
            }
        }
        let mut elements = format!("*ELEMENT,TYPE=C3D8,ELSET=E{name}\n");
        for layer in 0..count {
            let numbers = (1..=8).map(|corner| (node + 4 * layer + corner).to_string());
            let numbers = numbers.collect::<Vec<_>>().join(",");
            writeln!(elements, "{},{numbers}", element + layer + 1).unwrap();
        }
        Self {
            nodes,
            elements,
            first_element: element + 1,
            last_element: element + count,
            last_node: node + 4 * (count + 1),
        }
    }

    fn surfaces(&self, name: &str) -> String {
        format!(
            "*SURFACE,NAME={name}BOTTOM,TYPE=ELEMENT\n{},S1\n\
             *SURFACE,NAME={name}TOP,TYPE=ELEMENT\n{},S2\n",
            self.first_element, self.last_element
        )
    }
}

fn material(name: &str, factor: f64) -> String {
    let (modulus, density) = (MODULUS * factor, DENSITY * factor);
    format!(
        "*MATERIAL,NAME=M{name}\n*ELASTIC\n{modulus:.9E},0.\n*DENSITY\n{density:.9E}\n\
         *SOLID SECTION,ELSET=E{name},MATERIAL=M{name}\n"
    )
}

fn pair(interaction: &str, slave: &str, master: &str) -> String {
    format!("*CONTACT PAIR,INTERACTION={interaction},TYPE=NODE TO SURFACE\n{slave},{master}\n")
}

/// The rows of numbers after a heading of a `.dat` file.
fn rows_after(dat: &str) -> Vec<Vec<f64>> {
    let lines = dat.lines().skip(1).skip_while(|line| line.trim().is_empty());
    let rows = lines.map_while(|line| {
        let numbers = line.split_whitespace().map(str::parse);
        numbers.collect::<Result<Vec<f64>, _>>().ok().filter(|row| !row.is_empty())
    });
    rows.collect()
}

/// Closures of the contact above 0.3 times the static pressure, from ccx and from the law.
#[test]
fn a_block_in_ccx_has_the_closures_of_the_law() {
    let folder = tempfile::tempdir().unwrap();
    answer(folder.path(), &export(&modified_rig(), "calculix", "mm-t-s"));
    let below = Column::new("B", None, [-10.0, 0.0], 1);
    let above = Column::new("T", Some(&below), [0.0, 10.0], 1);
    let mut deck = [&below, &above].map(|part| part.nodes.clone() + &part.elements).concat();
    deck += &(below.surfaces("B") + &above.surfaces("T") + &material("B", 1.0));
    deck += &(material("T", 1.0) + "*INCLUDE,INPUT=out/contacts-calculix.inp\n");
    deck += &(pair("GUIDE-SAMPLE", "TBOTTOM", "BTOP") + "*BOUNDARY\nNB,1,3\nNT,1,2\n");
    let pressures = [0.0413, 0.05, 0.08, 0.1, 0.13734, 0.14, 0.2, 0.3, 0.55, 0.9];
    for pressure in pressures {
        write!(
            deck,
            "*STEP,NLGEOM,INC=200\n*CONTROLS,PARAMETERS=FIELD\n1.E-6,1.E-6\n*STATIC\n1.,1.\n\
             *DLOAD,OP=NEW\n{},P2,{pressure}\n*CONTACT PRINT,SLAVE=TBOTTOM,MASTER=BTOP\nCDIS,CSTR\n\
             *END STEP\n",
            above.last_element
        )
        .unwrap();
    }
    let Some(dat) = ccx(folder.path(), &deck) else { return };
    let law = modified();
    // Step i ends at time i; other outputs are of increments within a step.
    let is_end = |text: &&str| {
        let time = text.lines().next().and_then(|line| line.rsplit(' ').next());
        time.is_some_and(|time| time.parse::<f64>().is_ok_and(|time| time.fract() == 0.0))
    };
    let outputs = dat.split(" relative contact displacement").skip(1);
    let closures: Vec<_> = outputs.filter(is_end).collect();
    assert_eq!(closures.len(), pressures.len(), "{dat}");
    for (text, pressure) in closures.into_iter().zip(pressures) {
        let nodes = rows_after(text);
        assert_eq!(nodes.len(), 4);
        for row in nodes {
            let error = -1e-3 * row[1] / law.closure(1e6 * pressure) - 1.0;
            assert!(error.abs() < 2e-5, "{pressure} MPa: {error:.2e}");
        }
    }
}

/// First natural frequency \[Hz\] of the paper's rig under its weight, by ccx on tables of `scenario`.
fn rig_in_ccx(folder: &Path) -> Option<f64> {
    let disc = Column::new("D", None, [-17.0, -15.0], 1);
    let sample = Column::new("S", Some(&disc), [-15.0, 0.0], 4);
    let guide = Column::new("G", Some(&sample), [0.0, GUIDE_LENGTH], 40);
    let parts = [
        ("D", &disc, 1.0),
        ("S", &sample, 1.0),
        ("G", &guide, GUIDE_MASS / (DENSITY * GUIDE_LENGTH * SECTION)),
    ];
    let mut deck = parts.map(|(_, part, _)| part.nodes.clone() + &part.elements).concat();
    deck += &parts.map(|(name, part, _)| part.surfaces(name)).concat();
    deck += &parts.map(|(name, _, factor)| material(name, factor)).concat();
    deck += "*INCLUDE,INPUT=out/contacts-calculix.inp\n";
    deck += &pair("GUIDE-SAMPLE", "STOP", "GBOTTOM");
    deck += &pair("SAMPLE-DISC", "SBOTTOM", "DTOP");
    deck += "*BOUNDARY\nND,1,3\nNS,1,2\nNG,1,2\n";
    deck += "*STEP,NLGEOM,INC=500\n*CONTROLS,PARAMETERS=FIELD\n1.E-6,1.E-6\n*STATIC\n1.,1.\n\
             *DLOAD\nEG,GRAV,9810.,0.,0.,-1.\nES,GRAV,9810.,0.,0.,-1.\n*END STEP\n\
             *STEP,PERTURBATION\n*FREQUENCY\n1\n*END STEP\n";
    Some(frequencies(&ccx(folder, &deck)?)[0])
}

/// Natural frequencies \[Hz\] of a `.dat` file.
pub(super) fn frequencies(dat: &str) -> Vec<f64> {
    // Mode, eigenvalue, rad/time, cycles/time, imaginary part.
    let output = dat.split_once("E I G E N V A L U E   O U T P U T").unwrap().1;
    let rows = output.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let rows = rows.skip_while(|fields| fields.first() != Some(&"1"));
    let rows = rows.take_while(|fields| fields.len() == 5);
    rows.map(|fields| fields[3].parse().unwrap()).collect()
}

#[test]
fn the_papers_rig_in_ccx_has_the_frequency_of_the_one_dimensional_model() {
    for (file, expected) in [("modified", 875.488), ("constant", 831.982)] {
        let folder = tempfile::tempdir().unwrap();
        let scenario = fixture(&format!("scenarios/nouira2020-{file}.json")).display().to_string();
        let exported = answer(folder.path(), &export(&scenario, "calculix", "mm-t-s"));
        let stated = contact(&exported, "GUIDE-SAMPLE");
        assert!((number(stated, "/static_pressure_pa") / 0.13734e6 - 1.0).abs() < 1e-4);
        let modes = answer(folder.path(), &["modes", &scenario, "--json", "--out", "modes"]);
        let own = number(&modes, "/static/natural_frequency_hz");
        assert!((own / expected - 1.0).abs() < 1e-6, "{own}");
        let Some(frequency) = rig_in_ccx(folder.path()) else { return };
        let error = frequency / expected - 1.0;
        eprintln!("{file}: ccx {frequency} Hz, one-dimensional {own:.4} Hz, {error:.1e}");
        assert!(error.abs() < 5e-5, "{file}: {frequency} Hz, {error:.1e}");
    }
}
