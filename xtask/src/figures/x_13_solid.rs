//! x13: the rig as a solid.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use asperity_figure::{Axis, Color, Dash, Marker, Panel};
use asperity_scenario::Document;
use asperity_simulation::patches::{assemble_patches, simulate_patches};
use asperity_simulation::summary::Summary;
use asperity_table::Table;
use serde_json::{Value, json};

use super::levels::{self, FREQUENCY, HARMONIC_RATIO, Observable, RECEPTANCE, column};
use super::style;
use crate::reproduce::paper_figure::{Columns, Computed, PaperFigure};
use crate::reproduce::rig::{Case, Law, Rig};
use crate::solid::{Lines, Material, Solid};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x13",
    title: "x13: the rig as a solid",
    caption: "Modified power law: bars, as in all other figures (blue); the rig as a solid of 20-node \
              hexahedra, with 32 contact cells on a quarter of it (orange); and bars with the local \
              compliance of the patch on the wide guide bar in series with the upper contact (green). (a) \
              Fundamental, (b) its amplitude and (c) A2/A1 against force. The table has the natural \
              frequencies at rest, the compliance that brings the bars to the solid, and the compliance of a stiff \
              square on a half space.",
    compute,
    draw,
};

/// Force levels in N.
const FORCES: [f64; 3] = [9.0, 20.0, 32.0];

/// Poisson's ratio of aluminium.
const POISSON: f64 = 0.33;

/// Relative accuracy of the runs of the solid.
const ACCURACY: f64 = 3e-3;

/// Lines over the half side a of the patch, from the axis on, and between it and the half side b of the guide bar.
const ACROSS: [f64; 4] = [0.4, 0.7, 0.9, 1.0];
const BEYOND: [f64; 4] = [0.03, 0.1, 0.25, 0.55];
/// Lines of the guide bar over its length, from the contact up.
const UP: [f64; 8] = [0.003, 0.01, 0.023, 0.05, 0.1, 0.25, 0.5, 1.0];
/// Elements of the sample along its length.
const SAMPLE: usize = 4;

const QUANTITIES: [(&str, Observable); 3] = [
    ("frequency_hz", FREQUENCY),
    ("receptance_m_per_n", RECEPTANCE),
    ("harmonic_ratio", HARMONIC_RATIO),
];

/// The rig as a solid: a quarter of it, with two planes of symmetry.
struct SolidRig {
    scenario: Document,
    half_patch: f64,
    half_guide: f64,
}

impl SolidRig {
    /// Writes the matrices of the bars of `rig` as solids to `folder`.
    fn new(rig: &Rig, folder: &Path) -> Result<Self> {
        let case = rig.struck(Law::Modified, FORCES[0])?;
        let assembly = case.assembly()?;
        let stack = assembly.structure.stack();
        let [guide, sample] = stack.bodies() else { anyhow::bail!("the rig has two bodies") };
        let half_patch = 0.5 * sample.section().sqrt();
        let half_guide = 0.5 * guide.section().sqrt();
        let material = |body: &asperity_mesh::Body| Material {
            youngs_modulus: body.youngs_modulus(),
            poisson: POISSON,
            density: body.density(),
        };
        let line = |shares: &[f64], length: f64| -> Vec<f64> {
            std::iter::once(0.0).chain(shares.iter().map(|share| share * length)).collect()
        };
        let across = line(&ACROSS, half_patch);
        let mut wide = across.clone();
        wide.extend(BEYOND.map(|share| half_patch + share * (half_guide - half_patch)));
        wide.push(half_guide);
        let thick: Vec<f64> =
            (0..=SAMPLE).map(|n| sample.length() * n as f64 / SAMPLE as f64).collect();
        let up = line(&UP, guide.length()).iter().map(|z| sample.length() + z).collect();
        let grids: [Lines; 2] = [[wide.clone(), wide, up], [across.clone(), across, thick]];
        let mut bodies = Vec::new();
        for ((name, body), lines) in [("guide", guide), ("sample", sample)].into_iter().zip(&grids)
        {
            let mut solid = Solid::block(lines, material(body));
            solid.hold_plane(0, 0.0);
            solid.hold_plane(1, 0.0);
            let [low, high] = [lines[2][0], lines[2][lines[2].len() - 1]];
            solid.name_surface("LOWER", low, half_patch);
            solid.name_surface("UPPER", high, half_patch);
            solid.write(folder, name)?;
            bodies.push(json!({
                "name": name, "mesh": format!("{name}.inp"), "reduction": {"modes": 12},
                "matrices": {"format": "calculix", "stiffness": format!("{name}.sti"),
                             "mass": format!("{name}.mas"), "rows": format!("{name}.dof")},
            }));
        }
        let height = sample.length() + guide.length();
        let top = Solid::block(&grids[0], material(guide)).node_at([0.0, 0.0, height]);
        let at = |sign: f64| json!({"body": "guide", "node": top, "direction": [0.0, 0.0, sign]});
        let base: &Value = case.document.value();
        let mut excitation = base["excitation"].clone();
        excitation["at"] = at(-1.0);
        let scenario = json!({
            "schema": base["schema"], "bodies": bodies, "laws": base["laws"],
            "gravity_m_per_s2": [0.0, 0.0, -9.81],
            "interfaces": [
                {"name": "guide-sample", "law": "modified", "above": {"body": "guide", "surface": "LOWER"},
                 "below": {"body": "sample", "surface": "UPPER"}},
                {"name": "sample-disc", "law": "modified", "above": {"body": "sample", "surface": "LOWER"}},
            ],
            "damping": {"kind": "mass_proportional", "rate_per_s": assembly.structure.damping_rate()},
            "excitation": excitation,
            "sensors": [{"name": "top", "at": at(-1.0), "kind": "displacement"}],
            "duration_s": base["duration_s"], "output_rate_hz": 100_000.0, "accuracy": ACCURACY,
        });
        let text = scenario.to_string();
        fs::write(folder.join("solid.json"), &text)?;
        let scenario = Document::parse(&text, folder.join("solid.json"))?;
        Ok(Self { scenario, half_patch, half_guide })
    }

    /// The solid struck with `peak` in N: a quarter of the force moves a quarter of the rig.
    fn summary(&self, peak: f64) -> Result<Summary> {
        let mut document = self.scenario.clone();
        document.set("/excitation/peak_n", &(peak / 4.0).to_string())?;
        let scenario = document.structure_scenario()?;
        let found = simulate_patches(&document, &scenario, &|_| ())?;
        Ok(found.run.summary)
    }

    fn natural_frequency(&self) -> Result<f64> {
        let scenario = self.scenario.structure_scenario()?;
        let assembly = assemble_patches(&scenario, self.scenario.folder())?;
        assembly.structure.structure.natural_frequency().context("the solid has no frequency")
    }

    /// Compliance in m/N of a stiff square on a half space, times (1 - a/b)^1.5 for the finite width.
    fn square_compliance(&self, modulus: f64) -> f64 {
        let (a, b) = (self.half_patch, self.half_guide);
        0.946 * (1.0 - POISSON * POISSON) * (1.0 - a / b).powf(1.5) / (2.0 * a * modulus)
    }
}

/// The bars with a layer of this stiffness in Pa/m in series with the upper contact.
fn in_series(rig: &Rig, stiffness: f64, peak: f64) -> Result<Case> {
    let law = json!({"kind": "in_series", "law": "modified", "stiffness_pa_per_m": stiffness});
    let peak = ("/excitation/peak_n", peak.to_string());
    rig.with(Law::Modified, &[peak, ("/interfaces/0/law", law.to_string())])
}

/// The layer in Pa/m that brings the lowest natural frequency of the bars to `target` in Hz.
fn layer(rig: &Rig, target: f64) -> Result<f64> {
    let (mut soft, mut stiff) = (1e12_f64, 1e15_f64);
    for _ in 0..50 {
        let middle = (soft * stiff).sqrt();
        if in_series(rig, middle, FORCES[0])?.natural_frequencies()?[0] < target {
            soft = middle;
        } else {
            stiff = middle;
        }
    }
    Ok((soft * stiff).sqrt())
}

fn compute(rig: &Rig) -> Result<Computed> {
    let folder = tempfile::tempdir()?;
    let solid = SolidRig::new(rig, folder.path())?;
    let bars = rig.struck(Law::Modified, FORCES[0])?;
    let natural = solid.natural_frequency()?;
    let stiffness = layer(rig, natural)?;
    let patch = (2.0 * solid.half_patch).powi(2);
    let modulus = bars.assembly()?.structure.stack().bodies()[0].youngs_modulus();

    let mut columns = Columns::default();
    columns.push("force_n", FORCES);
    let layered = |force: &f64| in_series(rig, stiffness, *force);
    let layered = FORCES.iter().map(layered).collect::<Result<Vec<Case>>>()?;
    let solids = FORCES.iter().map(|force| Ok(solid.summary(*force)?.into()));
    let variants = [
        ("bars", rig.summaries(&rig.struck_with(Law::Modified, &FORCES)?)?),
        ("solid", solids.collect::<Result<Vec<_>>>()?),
        ("bars_on_layer", rig.summaries(&layered)?),
    ];
    for (name, summaries) in &variants {
        for (quantity, of) in QUANTITIES {
            let mut values = column(summaries, of);
            if (*name, quantity) == ("solid", "receptance_m_per_n") {
                // Per newton on the whole rig.
                for value in &mut values {
                    *value /= 4.0;
                }
            }
            columns.push(format!("{name}:{quantity}"), values);
        }
    }
    let at_rest = bars.natural_frequencies()?[0];
    columns.push("bars:natural_frequency_hz", [at_rest]);
    columns.push("solid:natural_frequency_hz", [natural]);
    columns.push("layer:compliance_m_per_n", [1.0 / (stiffness * patch)]);
    columns.push("square:compliance_m_per_n", [solid.square_compliance(modulus)]);
    let computed = columns.computed()?;
    Ok(Computed { values: vec![("solid_natural_frequency", natural)], ..computed })
}

fn draw(table: &Table) -> Result<String> {
    let panel = |quantity: &str, axis: Axis| -> Result<Panel> {
        let variants = [
            ("bars", "bars", Color::BLUE, Marker::Triangle, Dash::Solid),
            ("solid", "solid", Color::ORANGE, Marker::Square, Dash::Solid),
            ("bars_on_layer", "bars with compliance", Color::GREEN, Marker::Plus, Dash::Dashed),
        ];
        levels::variants(table, quantity, axis, &variants)
    };
    let frequency = panel("frequency_hz", Axis::linear("Frequency f_{1}", "Hz"))?;
    let amplitude = panel("receptance_m_per_n", style::amplitude_axis())?;
    let ratio = panel("harmonic_ratio", Axis::linear("A_{2}/A_{1}", ""))?;
    style::svg("The rig as a solid", [frequency, amplitude, ratio])
}
