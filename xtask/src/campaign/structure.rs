//! Random structures of matrices against the same equations on all of their rows.
//!
//! One or two networks of masses and springs that move along z, with patches of cells between them or on the
//! ground, some behind a gap, under static forces, as files of matrices that are reduced to some of their modes.
//!
//! | quantity | truth |
//! |---|---|
//! | pressures of cells at rest | Newton steps on all rows, with a search along each |
//! | lowest natural frequency | inverse iteration with the dense matrices about that rest |
//! | motion after a hit | Runge-Kutta steps of all rows, with two steps |

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Result};
use asperity_law::{ContactLaw, Draw as _, LawRef, LawSpec, Laws, rounded};
use asperity_scenario::Document;
use asperity_simulation::patches::{PatchRun, simulate_patches};
use serde_json::{Value, json};

use super::draw::Draw;
use super::judgement::Class;
use super::random_scenario::has_quadrature;
use super::steady::{AMPLITUDE, LINEAR, SteadyJudgement};

/// Quantities compared.
const PRESSURES: &str = "pressures of cells of a structure of matrices";
const FREQUENCY: &str = "lowest natural frequency of a structure of matrices";
const HIT: &str = "motion of a structure of matrices after a hit";

/// Stream of random numbers of a structure.
const STREAM: u64 = 1 << 33;

/// Pressure for which laws are built that depend on one \[Pa\], as in structures of matrices.
const LAW_PRESSURE: f64 = 1e5;

/// Periods of the lowest mode in a record, and samples in each.
const PERIODS: f64 = 4.0;
const SAMPLES: f64 = 60.0;

/// Steps of the truth in a radian of the highest frequency that the springs allow.
const STEPS: f64 = 1.0;

/// Newton steps, halvings of each, and inverse iterations, at most.
const MOST_STEPS: usize = 300;
const MOST_HALVINGS: usize = 60;
const MOST_ITERATIONS: usize = 2000;

/// A cell: rows and weights of its closure, its area \[m2\] and its gap \[m\].
struct Cell {
    rows: Vec<(usize, f64)>,
    area: f64,
    gap: f64,
}

/// A random structure.
struct Structure {
    /// Rows of the first body; the others are those of the second.
    first: usize,
    masses: Vec<f64>,
    /// Springs between rows, and from rows to the ground \[N/m\].
    springs: Vec<(usize, Option<usize>, f64)>,
    /// Cells, one patch after the other.
    cells: Vec<Cell>,
    law: Arc<dyn ContactLaw>,
    /// Static forces along -z \[N\].
    loads: Vec<(usize, f64)>,
    rate: f64,
    time: f64,
    hit: usize,
    peak: f64,
    pulse: f64,
    /// Frequency of the first body as one mass on its contacts \[Hz\].
    typical: f64,
    scenario: Value,
}

/// Judges the structure of this number, whose files go to `folder`.
pub(super) fn judge(folder: &Path, seed: u64, number: u64) -> Vec<SteadyJudgement> {
    let attempt = || judge_all(folder, seed, number);
    match catch_unwind(AssertUnwindSafe(attempt)) {
        Ok(Ok(found)) => found,
        Ok(Err(error)) => {
            vec![SteadyJudgement::without(HIT, Class::Refused, format!("{error:#}"))]
        }
        Err(_) => vec![SteadyJudgement::without(HIT, Class::SilentlyWrong, "panic".to_owned())],
    }
}

fn judge_all(folder: &Path, seed: u64, number: u64) -> Result<Vec<SteadyJudgement>> {
    let structure = Structure::random(&mut Draw::new(seed, number, STREAM))?;
    let folder = folder.join(format!("seed{seed}-{number}-structure"));
    let path = structure.write(&folder)?;
    let Some(rest) = structure.rest() else {
        let remark = "no rest was found on all rows".to_owned();
        return Ok(vec![SteadyJudgement::without(PRESSURES, Class::NamedUndecided, remark)]);
    };
    let natural = structure.lowest_frequency(&rest);
    let mut document = Document::read(&path)?;
    // A record that fits the lowest natural frequency.
    document.set("/duration_s", &rounded(PERIODS / natural).to_string())?;
    document.set("/output_rate_hz", &rounded(SAMPLES * natural).to_string())?;
    let scenario = document.structure_scenario()?;
    let run = simulate_patches(&document, &scenario, &|_| ())?;

    let found: Vec<f64> = run.cells.iter().flatten().map(|cell| cell.pressure_pa).collect();
    let truth: Vec<f64> =
        structure.cells.iter().map(|cell| structure.pressure(cell, &rest)).collect();
    let size = truth.iter().fold(0.0, |most: f64, p| most.max(*p));
    let apart = found.iter().zip(&truth).map(|(p, q)| (p - q).abs()).fold(0.0, f64::max);
    let open = truth.iter().filter(|p| **p == 0.0).count();
    let remark = format!(
        "{} rows, {} cells, {open} open; {}",
        rest.len(),
        truth.len(),
        structure.scenario["laws"]["rough"]["kind"]
    );
    let pressures = SteadyJudgement::new(PRESSURES, apart / size, LINEAR, remark);
    let own = run.run.summary.at_rest.natural_frequency_hz.unwrap_or(0.0);
    let error = (own / natural - 1.0).abs();
    let frequency = SteadyJudgement::new(FREQUENCY, error, LINEAR, format!("{natural:.4} Hz"));
    Ok(vec![pressures, frequency, structure.motion(&rest, &run)])
}

impl Structure {
    fn random(draw: &mut Draw) -> Result<Self> {
        let first = draw.whole(6..=24);
        let second = if draw.chance(0.5) { draw.whole(4..=12) } else { 0 };
        let mass = draw.log_uniform(0.05, 5.0);
        let typical = draw.log_uniform(100.0, 3000.0);
        let masses = (0..first + second)
            .map(|_| rounded(mass / first as f64 * draw.uniform(0.5, 1.5)))
            .collect::<Vec<f64>>();
        let mut springs = Vec::new();
        let spring = |draw: &mut Draw| {
            let frequency = typical * draw.log_uniform(4.0, 20.0);
            rounded(mass / first as f64 * (TAU * frequency).powi(2))
        };
        for (start, count) in [(0, first), (first, second)] {
            for row in 1..count {
                springs.push((start + row, Some(start + draw.whole(0..=row - 1)), spring(draw)));
            }
            for _ in 0..count {
                let (a, b) = (draw.whole(0..=count.max(1) - 1), draw.whole(0..=count.max(1) - 1));
                if a != b {
                    springs.push((start + a, Some(start + b), spring(draw)));
                }
            }
        }
        // The second body stands on the ground.
        springs.extend((0..second).map(|row| (first + row, None, spring(draw))));

        let count = draw.whole(2..=6.min(first));
        let pressure = draw.log_uniform(2e4, 2e6);
        let area = draw.log_uniform(1e-5, 1e-3);
        let stiffness = mass * (TAU * typical).powi(2) / (count as f64 * area);
        let (spec, law) = law(draw, pressure, stiffness)?;
        let closure = law.closure(pressure) - law.domain().closure_lost.unwrap_or(0.0);
        let gap = if draw.chance(0.4) { rounded(closure * draw.uniform(0.2, 1.5)) } else { 0.0 };
        let behind = if gap > 0.0 { draw.whole(1..=count - 1) } else { 0 };
        let cells = (0..count).map(|cell| {
            let mut rows = vec![(cell, -1.0)];
            if second > 0 {
                rows.push((first + draw.whole(0..=second - 1), 1.0));
            }
            let area = rounded(area * draw.uniform(0.6, 1.4));
            Cell { rows, area, gap: if cell < count - behind { 0.0 } else { gap } }
        });
        let cells: Vec<Cell> = cells.collect();
        let total = pressure * area * count as f64;
        let loaded = draw.whole(1..=3);
        let loads = (0..loaded)
            .map(|_| (draw.whole(0..=first - 1), rounded(total / loaded as f64)))
            .collect();
        let ratio = draw.uniform(0.003, 0.03);
        let mut found = Self {
            first,
            masses,
            springs,
            cells,
            law,
            loads,
            rate: rounded(ratio * TAU * typical),
            time: rounded(ratio / (TAU * typical)),
            hit: draw.whole(0..=first - 1),
            peak: rounded(total * draw.log_uniform(0.05, 5.0)),
            pulse: rounded(draw.uniform(0.3, 1.0) / typical),
            typical,
            scenario: Value::Null,
        };
        let modes = draw.whole(first.div_ceil(2)..=first);
        found.scenario = found.scenario_of(&spec, behind, modes)?;
        Ok(found)
    }

    fn scenario_of(&self, law: &LawSpec, behind: usize, modes: usize) -> Result<Value> {
        let names = self.names();
        let body = |name: &&str| {
            let matrices = json!({"format": "calculix", "stiffness": format!("{name}.sti"),
                "mass": format!("{name}.mas"), "rows": format!("{name}.dof")});
            json!({"name": name, "matrices": matrices, "reduction": {"modes": modes}})
        };
        let patch = |name: &str, cells: &[Cell]| {
            let gap = cells.first().map_or(0.0, |cell| cell.gap);
            json!({"name": name, "law": "rough", "cells": format!("{name}.csv"), "initial_gap_m": gap})
        };
        let (near, far) = self.cells.split_at(self.cells.len() - behind);
        let mut interfaces = vec![patch("near", near)];
        if behind > 0 {
            interfaces.push(patch("far", far));
        }
        let at = json!({"body": "a", "node": self.hit + 1, "direction": [0, 0, -1]});
        let loads = self.loads.iter().map(|(row, force)| {
            json!({"body": "a", "node": row + 1, "direction": [0, 0, -1], "force_n": force})
        });
        Ok(json!({
            "schema": "asperity/scenario/1",
            "bodies": names.iter().map(body).collect::<Vec<_>>(),
            "loads": loads.collect::<Vec<_>>(),
            "interfaces": interfaces,
            "laws": {"rough": serde_json::to_value(law)?},
            "damping": {"kind": "rayleigh", "rate_per_s": self.rate, "time_s": self.time},
            "excitation": {"kind": "haversine", "peak_n": self.peak, "duration_s": self.pulse, "at": at},
            "sensors": [{"name": "hit", "at": at, "kind": "displacement"}],
            "duration_s": PERIODS / self.typical,
            "output_rate_hz": SAMPLES * self.typical,
        }))
    }

    fn names(&self) -> &'static [&'static str] {
        if self.masses.len() > self.first { &["a", "b"] } else { &["a"] }
    }

    /// Writes matrices, cells and scenario, and returns the path of the scenario.
    fn write(&self, folder: &Path) -> Result<std::path::PathBuf> {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("creating {}", folder.display()))?;
        let write = |name: &str, text: &str| -> Result<()> {
            let path = folder.join(name);
            std::fs::write(&path, text).with_context(|| format!("writing {}", path.display()))
        };
        let full = self.stiffness();
        let starts = [0, self.first, self.masses.len()];
        for (name, ends) in self.names().iter().zip(starts.windows(2)) {
            let (mut stiffness, mut mass, mut rows) = (String::new(), String::new(), String::new());
            let size = ends[1] - ends[0];
            for column in 0..size {
                for row in 0..=column {
                    let value = full[ends[0] + row][ends[0] + column];
                    if value != 0.0 {
                        writeln!(stiffness, "{} {} {value:e}", row + 1, column + 1)?;
                    }
                }
                writeln!(mass, "{0} {0} {1:e}", column + 1, self.masses[ends[0] + column])?;
                writeln!(rows, "{}.3", column + 1)?;
            }
            write(&format!("{name}.sti"), &stiffness)?;
            write(&format!("{name}.mas"), &mass)?;
            write(&format!("{name}.dof"), &rows)?;
        }
        let near = self.cells.iter().filter(|cell| cell.gap == 0.0).count();
        let (near, far) = self.cells.split_at(near);
        for (name, cells) in [("near.csv", near), ("far.csv", far)] {
            let mut text = String::from("cell,area_m2,body,node,direction,weight\n");
            for (number, cell) in cells.iter().enumerate() {
                for &(row, weight) in &cell.rows {
                    let (body, node) =
                        if row < self.first { ("a", row) } else { ("b", row - self.first) };
                    writeln!(text, "{number},{:e},{body},{},3,{weight}", cell.area, node + 1)?;
                }
            }
            write(name, &text)?;
        }
        let path = folder.join("structure.json");
        write("structure.json", &serde_json::to_string_pretty(&self.scenario)?)?;
        Ok(path)
    }

    fn stiffness(&self) -> Vec<Vec<f64>> {
        let size = self.masses.len();
        let mut full = vec![vec![0.0; size]; size];
        for &(a, b, k) in &self.springs {
            full[a][a] += k;
            if let Some(b) = b {
                full[b][b] += k;
                full[a][b] -= k;
                full[b][a] -= k;
            }
        }
        full
    }

    /// Elastic forces on the rows at displacements along z \[N\], or damping forces at velocities.
    fn elastic(&self, u: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; u.len()];
        for &(a, b, k) in &self.springs {
            let force = k * (b.map_or(0.0, |b| u[b]) - u[a]);
            forces[a] += force;
            if let Some(b) = b {
                forces[b] -= force;
            }
        }
        forces
    }

    /// Pressure \[Pa\] and tangent \[Pa/m\] of a cell.
    fn pressed(&self, cell: &Cell, u: &[f64]) -> (f64, f64) {
        let closure: f64 = cell.rows.iter().map(|&(row, weight)| weight * u[row]).sum();
        let at = closure - cell.gap;
        if self.law.domain().is_open(at) {
            return (0.0, 0.0);
        }
        let found = self.law.pressure(at);
        (found.value, found.tangent)
    }

    fn pressure(&self, cell: &Cell, u: &[f64]) -> f64 {
        self.pressed(cell, u).0
    }

    /// All forces but the hit \[N\].
    fn forces(&self, u: &[f64]) -> Vec<f64> {
        let mut forces = self.elastic(u);
        for &(row, force) in &self.loads {
            forces[row] -= force;
        }
        for cell in &self.cells {
            let force = cell.area * self.pressure(cell, u);
            for &(row, weight) in &cell.rows {
                forces[row] -= weight * force;
            }
        }
        forces
    }

    /// Tangent stiffness, with a floor for open cells \[N/m\].
    fn tangent(&self, u: &[f64], floor: f64) -> Vec<Vec<f64>> {
        let mut full = self.stiffness();
        for cell in &self.cells {
            let along = cell.area * self.pressed(cell, u).1;
            let along = if along.is_finite() { along.max(floor) } else { floor };
            for &(a, of_a) in &cell.rows {
                for &(b, of_b) in &cell.rows {
                    full[a][b] += along * of_a * of_b;
                }
            }
        }
        full
    }

    /// Displacements at rest, where the forces vanish; none if no search finds them.
    fn rest(&self) -> Option<Vec<f64>> {
        let total: f64 = self.loads.iter().map(|(_, force)| force).sum();
        let area: f64 = self.cells.iter().map(|cell| cell.area).sum();
        let closure = self.law.closure(total / area);
        let size = self.masses.len();
        let mut u: Vec<f64> =
            (0..size).map(|row| if row < self.first { -closure } else { 0.0 }).collect();
        let typical = self.masses[..self.first].iter().sum::<f64>() * (TAU * self.typical).powi(2);
        for _ in 0..MOST_STEPS {
            let rest = self.forces(&u);
            let left = rest.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
            if left <= 1e-9 * total {
                return Some(u);
            }
            let step = solved(self.tangent(&u, 1e-9 * typical), &rest);
            let along = |from: &[f64]| -> f64 {
                self.forces(from).iter().zip(&step).map(|(force, x)| force * x).sum()
            };
            // The energy is convex: its slope along a step falls from the start on.
            let slope = along(&u);
            let mut part = 1.0;
            for _ in 0..MOST_HALVINGS {
                let next: Vec<f64> = u.iter().zip(&step).map(|(x, dx)| x + part * dx).collect();
                if along(&next).abs() <= 0.9 * slope.abs() {
                    break;
                }
                part *= 0.5;
            }
            for (x, dx) in u.iter_mut().zip(&step) {
                *x += part * dx;
            }
        }
        None
    }

    /// Lowest natural frequency \[Hz\] about a rest.
    fn lowest_frequency(&self, rest: &[f64]) -> f64 {
        let full = self.tangent(rest, 0.0);
        let mut shape: Vec<f64> = (0..rest.len()).map(|row| 1.0 + 0.1 * row as f64).collect();
        let mut square = 0.0;
        for _ in 0..MOST_ITERATIONS {
            let moved: Vec<f64> = shape.iter().zip(&self.masses).map(|(x, m)| x * m).collect();
            let next = solved(full.clone(), &moved);
            let norm: f64 = next.iter().zip(&self.masses).map(|(x, m)| m * x * x).sum();
            let work: f64 = next.iter().zip(&moved).map(|(x, f)| x * f).sum();
            let found = work / norm;
            shape = next.iter().map(|x| x / norm.sqrt()).collect();
            if (found / square - 1.0_f64).abs() < 1e-13 {
                break;
            }
            square = found;
        }
        square.sqrt() / TAU
    }

    /// The motion at the hit by a run against two integrations of all rows.
    fn motion(&self, rest: &[f64], run: &PatchRun) -> SteadyJudgement {
        let history = &run.run.transient.history;
        let found = &history.sensors[0].displacement;
        let interval = history.time[1] - history.time[0];
        let full = self.tangent(rest, 0.0);
        let highest = full
            .iter()
            .zip(&self.masses)
            .map(|(row, mass)| row.iter().map(|k| k.abs()).sum::<f64>() / mass);
        let step = 1.0 / (STEPS * highest.fold(0.0, f64::max).sqrt());
        let parts = (interval / step).ceil() as usize;
        let [coarse, fine] =
            [parts, 2 * parts].map(|parts| self.integrated(rest, interval, parts, found.len()));
        let size = fine.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let apart = |one: &[f64]| {
            let distances = one.iter().zip(&fine).map(|(a, b)| (a - b).abs());
            distances.fold(0.0, f64::max) / size
        };
        let (error, doubt) = (apart(found), apart(&coarse));
        let lost = run.cells.iter().flatten().filter(|cell| cell.loses_contact()).count();
        let remark = format!("{lost} cells lose contact, truth within {doubt:.1e}");
        let warned = !run.run.observables.warnings.is_empty();
        let class = match (error <= AMPLITUDE, doubt <= 0.1 * AMPLITUDE, warned) {
            (true, true, _) => Class::Right,
            (false, true, true) => Class::NamedWrong,
            (false, true, false) => Class::SilentlyWrong,
            (_, false, true) => Class::NamedUndecided,
            (_, false, false) => Class::SilentlyUndecided,
        };
        SteadyJudgement { of: HIT, class, error: Some(error), remark }
    }

    /// Displacements along -z at the hit from rest, by Runge-Kutta steps.
    fn integrated(&self, rest: &[f64], interval: f64, parts: usize, samples: usize) -> Vec<f64> {
        let (size, h) = (rest.len(), interval / parts as f64);
        let force = |t: f64| {
            if t < self.pulse { self.peak * (PI * t / self.pulse).sin().powi(2) } else { 0.0 }
        };
        let rate = |t: f64, state: &[f64]| -> Vec<f64> {
            let (u, v) = state.split_at(size);
            let mut forces = self.forces(u);
            forces[self.hit] -= force(t);
            let damped = self.elastic(v);
            let accelerations = (0..size)
                .map(|i| (forces[i] + self.time * damped[i]) / self.masses[i] - self.rate * v[i]);
            v.iter().copied().chain(accelerations).collect()
        };
        let ahead = |state: &[f64], slope: &[f64], h: f64| -> Vec<f64> {
            state.iter().zip(slope).map(|(x, k)| x + h * k).collect()
        };
        let mut state: Vec<f64> = rest.iter().copied().chain(vec![0.0; size]).collect();
        let mut motion = Vec::with_capacity(samples);
        for sample in 0..samples {
            motion.push(rest[self.hit] - state[self.hit]);
            for part in 0..parts {
                let t = sample as f64 * interval + part as f64 * h;
                let a = rate(t, &state);
                let b = rate(t + 0.5 * h, &ahead(&state, &a, 0.5 * h));
                let c = rate(t + 0.5 * h, &ahead(&state, &b, 0.5 * h));
                let d = rate(t + h, &ahead(&state, &c, h));
                for (i, x) in state.iter_mut().enumerate() {
                    *x += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
                }
            }
        }
        motion
    }
}

/// A law of any kind that separates, or a constant stiffness, without quadratures in its steps.
fn law(draw: &mut Draw, pressure: f64, stiffness: f64) -> Result<(LawSpec, Arc<dyn ContactLaw>)> {
    loop {
        let spec = LawSpec::sample(draw, pressure, stiffness, 2);
        if has_quadrature(&spec) {
            continue;
        }
        let law = Laws::default().build(&LawRef::from(spec.clone()), LAW_PRESSURE)?;
        if law.domain().separates() || law.domain().is_bilateral() {
            return Ok((spec, law));
        }
    }
}

/// Solution of equations with a positive definite matrix.
fn solved(mut rows: Vec<Vec<f64>>, right: &[f64]) -> Vec<f64> {
    let size = right.len();
    let mut x = right.to_vec();
    for k in 0..size {
        for i in k + 1..size {
            let factor = rows[i][k] / rows[k][k];
            if factor != 0.0 {
                let (above, below) = rows.split_at_mut(i);
                for (entry, of_k) in below[0][k..].iter_mut().zip(&above[k][k..]) {
                    *entry -= factor * of_k;
                }
                x[i] -= factor * x[k];
            }
        }
    }
    for k in (0..size).rev() {
        let known: f64 = (k + 1..size).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (x[k] - known) / rows[k][k];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Structures of a few numbers are right, whatever is drawn.
    #[test]
    fn structures_of_some_numbers_are_right() {
        let folder = tempfile::tempdir().unwrap();
        for number in 0..20 {
            let found = judge(folder.path(), 1, number);
            let wrong = found.iter().find(|one| one.class != Class::Right);
            assert!(found.len() == 3 && wrong.is_none(), "{number}: {found:?}");
        }
    }
}
