//! x9: where the energy goes.

use anyhow::{Context, Result};
use asperity_figure::{Axis, Color, Dash, Marker, Panel};
use asperity_structure::PreloadedContact;
use asperity_table::Table;

use super::levels::{
    self, FREQUENCY, HARMONIC_RATIO, Observable, RECEPTANCE, column, drop_percent,
};
use super::style;
use crate::reproduce::paper_figure::{Computed, PaperFigure};
use crate::reproduce::rig::{Case, Law, Rig, few_levels};

pub(crate) const FIGURE: PaperFigure = PaperFigure {
    id: "x9",
    title: "x9: where the energy goes",
    caption: "Modified power law under losses of five kinds: viscous in the bodies (blue, as in all \
              other figures), in the contacts in proportion to their stiffness (Kelvin-Voigt, \
              orange) and to the pressure (green), each of a damping ratio of 3.5 % at rest; \
              viscous of 2 % and friction of the bar in its guide, of 0.2 N (purple) and of 0.02 \
              times the force of the contact below (red). (a) Amplitude and (b) A2/A1 against \
              force. Only friction, whose share of the loss falls with the amplitude, lets A1 \
              rise from 9 to 32 N; its highest is within. The table has more kinds, f1, and the change of A1.",
    compute,
    draw,
};

/// Damping ratio of the linearised fundamental.
const RATIO: f64 = 0.035;
/// Viscous damping ratio beside friction.
const BESIDE_FRICTION: f64 = 0.02;
/// Stiffness of stuck friction in N/m: 20 times that of a contact.
const STUCK: f64 = 2e9;

const QUANTITIES: [(&str, Observable); 4] = [
    ("frequency_hz", FREQUENCY),
    ("receptance_m_per_n", RECEPTANCE),
    ("harmonic_ratio", HARMONIC_RATIO),
    ("damping_ratio", |summary| summary.fundamental?.damping_ratio),
];

/// Changes of the scenario, beside the force.
type Changes = Vec<(&'static str, String)>;

fn bodies(ratio: f64) -> (&'static str, String) {
    ("/damping", format!(r#"{{"kind": "mass_proportional", "ratio": {ratio}}}"#))
}

/// Contact damping `c = c0 (p / p0)^n` of the ratio [`RATIO`] at rest; Kelvin-Voigt without n.
fn contacts(rig: &Rig, exponent: Option<f64>) -> Result<Changes> {
    let at_rest = rig.struck(Law::Modified, 9.0)?.assembly()?.structure;
    let pressures: Vec<f64> = at_rest.contacts().iter().map(PreloadedContact::pressure).collect();
    let changes = |size: f64| -> Changes {
        let damping = |pressure: f64| match exponent {
            Some(exponent) => format!(
                r#"{{"kind": "power", "coefficient_pa_s_per_m": {}, "reference_pa": {pressure}, "exponent": {exponent}}}"#,
                size * 1e12
            ),
            None => format!(r#"{{"kind": "kelvin_voigt", "time_s": {size}}}"#),
        };
        let places = ["/interfaces/0/damping", "/interfaces/1/damping"];
        let each = places.into_iter().zip(&pressures);
        let mut changes: Changes = each.map(|(place, &p)| (place, damping(p))).collect();
        changes.push(bodies(0.0));
        changes
    };
    // The ratio is proportional to the size.
    let trial = 1e-6;
    let modes = rig.with(Law::Modified, &changes(trial))?.assembly()?.structure.modes(1)?;
    let found = modes.first().context("a mode")?.damping_ratio;
    Ok(changes(trial * RATIO / found))
}

fn friction(slip: &str) -> Changes {
    let element = format!(r#"{{"stiffness_n_per_m": {STUCK}, {slip}}}"#);
    vec![bodies(BESIDE_FRICTION), ("/bodies/0/friction", element)]
}

/// The kinds of loss, by name.
fn kinds(rig: &Rig) -> Result<Vec<(&'static str, Changes)>> {
    Ok(vec![
        ("bodies", vec![bodies(RATIO)]),
        ("kelvin_voigt", contacts(rig, None)?),
        ("power_minus_1", contacts(rig, Some(-1.0))?),
        ("power_1", contacts(rig, Some(1.0))?),
        ("power_2", contacts(rig, Some(2.0))?),
        ("none", vec![bodies(0.0)]),
        ("friction_0.2_n", friction(r#""slip_force_n": 0.2"#)),
        ("friction_0.02", friction(r#""coefficient": 0.02"#)),
    ])
}

fn compute(rig: &Rig) -> Result<Computed> {
    let forces = few_levels();
    let mut table = Table::new().with_column("force_n", forces.as_slice())?;
    let mut values = Vec::new();
    for (name, changes) in kinds(rig)? {
        let case = |&force: &f64| -> Result<Case> {
            let mut changes = changes.clone();
            changes.push(("/excitation/peak_n", force.to_string()));
            rig.with(Law::Modified, &changes)
        };
        let cases = forces.iter().map(case).collect::<Result<Vec<Case>>>()?;
        let summaries = rig.summaries(&cases)?;
        for (quantity, of) in QUANTITIES {
            table.push(format!("{name}:{quantity}"), column(&summaries, of))?;
        }
        let amplitude = column(&summaries, RECEPTANCE);
        let mut change = vec![-drop_percent(&amplitude)];
        change.resize(forces.len(), f64::NAN);
        table.push(format!("{name}:amplitude_change_percent"), change)?;
        if name == "friction_0.02" {
            values.push(("amplitude_change_friction", -drop_percent(&amplitude)));
        }
    }
    Ok(Computed { table, values })
}

fn draw(table: &Table) -> Result<String> {
    let panel = |quantity: &str, axis: Axis| -> Result<Panel> {
        let variants = [
            ("bodies", "bodies", Color::BLUE, Marker::Triangle, Dash::Solid),
            ("kelvin_voigt", "K-V", Color::ORANGE, Marker::Square, Dash::Dashed),
            ("power_1", "c ~ p", Color::GREEN, Marker::Diamond, Dash::Dotted),
            ("friction_0.2_n", "0.2 N", Color::PURPLE, Marker::Plus, Dash::Solid),
            ("friction_0.02", "0.02 F", Color::RED, Marker::Cross, Dash::Solid),
        ];
        levels::variants(table, quantity, axis, &variants)
    };
    let amplitude = panel("receptance_m_per_n", style::amplitude_axis())?;
    let ratio = panel("harmonic_ratio", Axis::linear("Ratio A_{2}/A_{1}", ""))?;
    style::svg("Where the energy goes", [amplitude, ratio])
}
