//! A lattice of masses on a contact patch, as matrices for asperity and by steps of its equations on all rows.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

/// Columns, each with a cell under it, and rows.
const COLUMNS: usize = 6;
const ROWS: usize = 4;

/// Mass of a node \[kg\], springs along columns and between them \[N/m\].
const MASS: f64 = 0.4 / (COLUMNS * ROWS) as f64;
const ALONG: f64 = 2e8;
const BETWEEN: f64 = 6e7;

/// Area of a cell \[m2\].
const AREA: f64 = 1e-4;

/// Mass-proportional and stiffness-proportional damping.
const RATE: f64 = 200.0;
const TIME: f64 = 2e-7;

/// Length of a record, of the pulse and of a step \[s\], and steps between samples of the transforms.
const DURATION: f64 = 0.04;
const PULSE: f64 = 6e-4;
const STEP: f64 = 2e-6;
const EVERY: usize = 5;

/// Rate of the samples \[Hz\].
pub const RATE_HZ: f64 = 1.0 / (STEP * EVERY as f64);

/// Nodes of the force and of the sensor, and of the static load, which is off centre.
const HIT: usize = node(2, ROWS - 1);
const LOAD: usize = node(3, ROWS - 1);

/// Number of a node from 0.
const fn node(column: usize, row: usize) -> usize {
    column + COLUMNS * row
}

/// Nodes that move along z, joined by springs; the lowest stand on cells. The columns have different masses.
pub struct Lattice {
    springs: Vec<(usize, usize, f64)>,
    masses: Vec<f64>,
}

impl Lattice {
    pub fn new() -> Self {
        let mut springs = Vec::new();
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                if column + 1 < COLUMNS {
                    springs.push((node(column, row), node(column + 1, row), BETWEEN));
                }
                if row + 1 < ROWS {
                    springs.push((node(column, row), node(column, row + 1), ALONG));
                }
            }
        }
        let mass = |number: usize| MASS * (0.8 + 0.08 * (number % COLUMNS) as f64);
        Self { springs, masses: (0..COLUMNS * ROWS).map(mass).collect() }
    }

    /// Writes its matrices and its cells.
    pub fn write(&self, folder: &Path) {
        let count = self.masses.len();
        let mut full = vec![vec![0.0; count]; count];
        for &(a, b, k) in &self.springs {
            full[a][a] += k;
            full[b][b] += k;
            full[a.min(b)][a.max(b)] -= k;
        }
        let (mut stiffness, mut mass, mut rows) = (String::new(), String::new(), String::new());
        for column in 0..count {
            for (row, entries) in full.iter().enumerate().take(column + 1) {
                if entries[column] != 0.0 {
                    writeln!(stiffness, "{} {} {:e}", row + 1, column + 1, entries[column])
                        .unwrap();
                }
            }
            writeln!(mass, "{0} {0} {1:e}", column + 1, self.masses[column]).unwrap();
            writeln!(rows, "{}.3", column + 1).unwrap();
        }
        let mut cells = String::from("cell,area_m2,node,direction,weight\n");
        for column in 0..COLUMNS {
            writeln!(cells, "{column},{AREA:e},{},3,-1", node(column, 0) + 1).unwrap();
        }
        for (name, text) in
            [("a.sti", stiffness), ("a.mas", mass), ("a.dof", rows), ("cells.csv", cells)]
        {
            fs::write(folder.join(name), text).unwrap();
        }
    }

    /// Its scenario with a law.
    pub fn scenario(law: &Value) -> Value {
        let at =
            |node: usize, z: f64| json!({"body": "a", "node": node + 1, "direction": [0, 0, z]});
        json!({
            "schema": "asperity/scenario/1",
            "bodies": [{"name": "a", "matrices": {"format": "calculix", "stiffness": "a.sti", "mass": "a.mas", "rows": "a.dof"},
                        "reduction": {"modes": 6}}],
            "loads": [{"body": "a", "node": LOAD + 1, "direction": [0, 0, -1], "force_n": 60}],
            "interfaces": [{"name": "foot", "law": "rough", "body": "a", "cells": "cells.csv"}],
            "laws": {"rough": law},
            "damping": {"kind": "rayleigh", "rate_per_s": RATE, "time_s": TIME},
            "excitation": {"kind": "haversine", "peak_n": 10, "duration_s": PULSE, "at": at(HIT, -1.0)},
            "sensors": [{"name": "top", "at": at(HIT, -1.0), "kind": "displacement"},
                        {"name": "corner", "at": at(node(0, ROWS - 1), -1.0), "kind": "displacement"}],
            "duration_s": DURATION,
            "output_rate_hz": 25600,
        })
    }

    /// f1 \[Hz\] and A1 \[m/N\] of a hit of this peak \[N\] under a preload \[N\], with the law `K = C p^m`: the peak of the
    /// receptance by a search over its transform.
    pub fn hit(&self, law: [f64; 2], preload: f64, peak: f64) -> [f64; 2] {
        let (forces, motion) = self.motion(law, preload, peak, DURATION);
        let receptance = |f: f64| {
            let [re, im] = Self::receptance(&forces, &motion, f);
            re.hypot(im)
        };
        let coarse = (0..200).map(|i| 300.0 + 10.0 * f64::from(i));
        let nearest = coarse.max_by(|a, b| receptance(*a).total_cmp(&receptance(*b))).unwrap();
        let (mut low, mut high) = (nearest - 10.0, nearest + 10.0);
        while high - low > 1e-3 {
            let third = (high - low) / 3.0;
            if receptance(low + third) < receptance(high - third) {
                low += third;
            } else {
                high -= third;
            }
        }
        let f1 = 0.5 * (low + high);
        [f1, receptance(f1)]
    }

    /// Receptance of samples at a frequency \[Hz\], real and imaginary part \[m/N\].
    pub fn receptance(forces: &[f64], motion: &[f64], frequency: f64) -> [f64; 2] {
        let transform = |samples: &[f64]| {
            samples.iter().enumerate().fold([0.0, 0.0], |[re, im], (n, x)| {
                let phase = TAU * frequency * n as f64 / RATE_HZ;
                [re + x * phase.cos(), im - x * phase.sin()]
            })
        };
        let ([a, b], [c, d]) = (transform(motion), transform(forces));
        let size = c * c + d * d;
        [(a * c + b * d) / size, (b * c - a * d) / size]
    }

    /// Samples of the force \[N\] and of the displacement of the node that is hit \[m\] over a `duration` \[s\]: all rows by
    /// Runge-Kutta steps.
    pub fn motion(
        &self,
        law: [f64; 2],
        preload: f64,
        peak: f64,
        duration: f64,
    ) -> (Vec<f64>, Vec<f64>) {
        let rest = self.rest(law, preload);
        let count = self.masses.len();
        let force = |t: f64| if t < PULSE { peak * (PI * t / PULSE).sin().powi(2) } else { 0.0 };
        let rate = |t: f64, state: &[f64]| -> Vec<f64> {
            let (u, v) = state.split_at(count);
            let mut accelerations = self.forces(law, preload, u);
            let damped = self.elastic(v);
            accelerations[HIT] += force(t);
            for i in 0..count {
                accelerations[i] =
                    (accelerations[i] + TIME * damped[i]) / self.masses[i] - RATE * v[i];
            }
            [v, &accelerations].concat()
        };
        let ahead = |state: &[f64], slope: &[f64], h: f64| -> Vec<f64> {
            state.iter().zip(slope).map(|(x, k)| x + h * k).collect()
        };
        let mut state = [rest.clone(), vec![0.0; count]].concat();
        let (mut motion, mut forces) = (Vec::new(), Vec::new());
        for step in 0..(duration / STEP).round() as usize {
            let t = step as f64 * STEP;
            if step % EVERY == 0 {
                motion.push(state[HIT] - rest[HIT]);
                forces.push(force(t));
            }
            let a = rate(t, &state);
            let b = rate(t + 0.5 * STEP, &ahead(&state, &a, 0.5 * STEP));
            let c = rate(t + 0.5 * STEP, &ahead(&state, &b, 0.5 * STEP));
            let d = rate(t + STEP, &ahead(&state, &c, STEP));
            for (i, x) in state.iter_mut().enumerate() {
                *x += STEP / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
        }
        (forces, motion)
    }

    /// Elastic forces on the nodes \[N\] at displacements, or damping forces at velocities.
    fn elastic(&self, u: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; u.len()];
        for &(a, b, k) in &self.springs {
            let force = k * (u[b] - u[a]);
            forces[a] += force;
            forces[b] -= force;
        }
        forces
    }

    /// Static, elastic and contact forces along -z, in which displacements count.
    fn forces(&self, [c, m]: [f64; 2], preload: f64, u: &[f64]) -> Vec<f64> {
        let mut forces = self.elastic(u);
        forces[LOAD] += preload;
        for column in 0..COLUMNS {
            let closure = u[node(column, 0)].max(0.0);
            forces[node(column, 0)] -= AREA * ((1.0 - m) * c * closure).powf(1.0 / (1.0 - m));
        }
        forces
    }

    /// Displacements at rest, by Newton steps with a dense elimination.
    fn rest(&self, law: [f64; 2], preload: f64) -> Vec<f64> {
        let count = self.masses.len();
        let [c, m] = law;
        let pressure = preload / (AREA * COLUMNS as f64);
        let mut u = vec![pressure.powf(1.0 - m) / (c * (1.0 - m)); count];
        for _ in 0..60 {
            let rest = self.forces(law, preload, &u);
            let mut rows = vec![vec![0.0; count + 1]; count];
            for &(a, b, k) in &self.springs {
                rows[a][a] += k;
                rows[b][b] += k;
                rows[a][b] -= k;
                rows[b][a] -= k;
            }
            for column in 0..COLUMNS {
                let at = node(column, 0);
                let closure = u[at].max(1e-12);
                let p = ((1.0 - m) * c * closure).powf(1.0 / (1.0 - m));
                rows[at][at] += AREA * c * p.powf(m);
            }
            for (row, force) in rows.iter_mut().zip(&rest) {
                row[count] = *force;
            }
            // The matrix is positive definite: no pivots are exchanged.
            for k in 0..count {
                for i in k + 1..count {
                    let factor = rows[i][k] / rows[k][k];
                    let (above, below) = rows.split_at_mut(i);
                    for (x, y) in below[0][k..].iter_mut().zip(&above[k][k..]) {
                        *x -= factor * y;
                    }
                }
            }
            let mut step = vec![0.0; count];
            for k in (0..count).rev() {
                let known: f64 = (k + 1..count).map(|j| rows[k][j] * step[j]).sum();
                step[k] = (rows[k][count] - known) / rows[k][k];
            }
            for (x, dx) in u.iter_mut().zip(&step) {
                *x += dx;
            }
        }
        u
    }
}
