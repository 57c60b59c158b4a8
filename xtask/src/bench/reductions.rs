//! Large structures of matrices: reading, reduction and equilibrium from the command line, with time and memory.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use serde_json::json;

use crate::solid::{Material, Solid};

const STEEL: Material = Material { youngs_modulus: 2.1e11, poisson: 0.3, density: 7850.0 };

/// A block of 20-node hexahedra on the ground, a quarter of it with two planes of symmetry.
struct Block {
    name: &'static str,
    /// Elements along x, y and z, and length of an element \[m\].
    elements: [usize; 3],
    length: f64,
    /// Cells of the contact along x and y.
    split: [usize; 2],
}

/// Some 20,000 and 66,000 degrees of freedom with 36 cells, and 120,000 with 600.
const BLOCKS: [Block; 3] = [
    Block { name: "compact", elements: [12, 12, 9], length: 5e-3, split: [6, 6] },
    Block { name: "slender", elements: [12, 12, 33], length: 5e-3, split: [6, 6] },
    Block { name: "many cells", elements: [30, 20, 14], length: 3e-3, split: [30, 20] },
];

/// Modes that are kept.
const MODES: usize = 40;

/// Time between looks at the memory of the command.
const LOOK: Duration = Duration::from_millis(10);

/// Prints a table of `asperity check` and a short hit: with matrices read and reduced, and with the kept reduction.
pub(crate) fn run(command: &Path) -> Result<()> {
    println!(
        "| block | rows | cells | reduced and checked, s | GB | with the kept reduction, s | hit of 2 ms, s |"
    );
    println!("|---|---|---|---|---|---|---|");
    for block in &BLOCKS {
        let folder = tempfile::tempdir().context("no temporary folder")?;
        let (scenario, rows) = block.write(folder.path())?;
        let check = || timed(Command::new(command).arg("check").arg(&scenario));
        let [first, second] = [check()?, check()?];
        let hit = timed(
            Command::new(command)
                .args(["simulate", "--quiet", "--out"])
                .arg(folder.path().join("hit"))
                .arg(&scenario),
        )?;
        println!(
            "| {} | {rows} | {} | {:.2} | {:.2} | {:.2} | {:.2} |",
            block.name,
            block.split[0] * block.split[1],
            first.seconds,
            first.gigabytes,
            second.seconds,
            hit.seconds
        );
    }
    println!();
    Ok(())
}

impl Block {
    /// Writes matrices, mesh and scenario; the scenario's path and the number of rows.
    fn write(&self, folder: &Path) -> Result<(PathBuf, usize)> {
        let lines = self
            .elements
            .map(|count| (0..=count).map(|n| n as f64 * self.length).collect::<Vec<f64>>());
        let mut solid = Solid::block(&lines, STEEL);
        solid.hold_plane(0, 0.0);
        solid.hold_plane(1, 0.0);
        let [wide, deep, high] = [0, 1, 2].map(|axis| self.length * self.elements[axis] as f64);
        solid.name_surface("LOWER", 0.0, wide.max(deep));
        solid.write(folder, "block")?;
        let rows = fs::read_to_string(folder.join("block.dof"))?.lines().count();
        let at = |sign: f64| json!({"body": "block", "node": solid.node_at([0.0, 0.0, high]), "direction": [0, 0, sign]});
        let weight = 9.81 * STEEL.density * wide * deep * high;
        let scenario = json!({
            "schema": "asperity/scenario/1",
            "bodies": [{"name": "block", "mesh": "block.inp", "reduction": {"modes": MODES},
                "matrices": {"format": "calculix", "stiffness": "block.sti", "mass": "block.mas", "rows": "block.dof"}}],
            "gravity_m_per_s2": [0, 0, -9.81],
            "interfaces": [{"name": "base", "law": "rough", "above": {"body": "block", "surface": "LOWER"},
                "split": self.split}],
            "laws": {"rough": {"kind": "power", "coefficient": 3e10, "exponent": 0.5}},
            "damping": {"kind": "mass_proportional", "ratio": 0.02},
            "excitation": {"kind": "haversine", "peak_n": 0.5 * weight, "duration_s": 4e-4, "at": at(-1.0)},
            "sensors": [{"name": "top", "at": at(-1.0), "kind": "displacement"}],
            "duration_s": 2e-3,
        });
        let path = folder.join("block.json");
        fs::write(&path, scenario.to_string())?;
        Ok((path, rows))
    }
}

/// Time and largest memory of a command.
struct Spent {
    seconds: f64,
    /// NaN where the system does not tell.
    gigabytes: f64,
}

fn timed(command: &mut Command) -> Result<Spent> {
    let started = Instant::now();
    let mut child =
        command.stdout(Stdio::null()).spawn().context("the command cannot be started")?;
    let mut gigabytes = f64::NAN;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        gigabytes = gigabytes.max(peak_gigabytes(child.id()));
        std::thread::sleep(LOOK);
    };
    let seconds = started.elapsed().as_secs_f64();
    ensure!(status.success(), "{command:?} failed");
    Ok(Spent { seconds, gigabytes })
}

/// The largest memory of a process so far \[GB\].
fn peak_gigabytes(process: u32) -> f64 {
    let text = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes / 1e6)
}
