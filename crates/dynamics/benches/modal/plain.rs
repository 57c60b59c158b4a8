//! The same method as a plain loop: modes as two-state recurrences, forces linear over a step for
//! the bodies and averaged for the last, two contacts by Newton's method on tabulated laws.

use asperity_law::CompiledLaw;
use asperity_mesh::ComponentModes;
use asperity_structure::{LoadCase, PreloadedStructure};

pub(crate) struct Rig {
    structure: PreloadedStructure<ComponentModes>,
    areas: [f64; 2],
    tables: [CompiledLaw; 2],
    rate: f64,
}

struct Mode {
    shape: [f64; 2],
    drive: f64,
    decay: f64,
    spring: f64,
    taps: [f64; 3],
    push: f64,
    q: f64,
    gain: f64,
    forces: [f64; 2],
}

impl Rig {
    pub(crate) fn new(structure: PreloadedStructure<ComponentModes>) -> Self {
        let contacts = structure.contacts();
        let table = |i: usize| {
            let state = contacts[i].pressure();
            CompiledLaw::uniform(contacts[i].law(), state, state + 1e6, 1e-5).unwrap()
        };
        Self {
            areas: [0, 1].map(|i| contacts[i].area()),
            tables: [table(0), table(1)],
            rate: structure.damping_rate(),
            structure,
        }
    }

    /// The lowest pressure gain and the output's last displacement of a hit.
    pub(crate) fn march(&self, drive: &LoadCase, h: f64, duration: f64) -> (f64, f64) {
        let pairs = self.structure.component_modes().contacts();
        let mut modes: Vec<Mode> = self
            .structure
            .component_modes()
            .modes()
            .iter()
            .map(|mode| {
                let (w, c) = (mode.angular_frequency, self.rate);
                let damped = (w * w - 0.25 * c * c).abs().sqrt();
                let root = (-0.5 * c * h).exp();
                let turn = if w > 0.5 * c { (damped * h).cos() } else { (damped * h).cosh() };
                // Newmark's average for stiff contacts, else a third of the linear course.
                let light = pairs.iter().all(|&pair| mode.closure(pair) != 0.0);
                let taps =
                    if light { [0.25, 0.5, 0.25] } else { [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0] };
                Mode {
                    shape: [mode.closure(pairs[0]), mode.closure(pairs[1])],
                    drive: mode.ports[0],
                    decay: root * root,
                    spring: 1.0 + root * root - 2.0 * root * turn,
                    taps: taps.map(|tap| tap * h * h * root),
                    push: h * h * root,
                    q: 0.0,
                    gain: 0.0,
                    forces: [0.0; 2],
                }
            })
            .collect();
        let mut coupling = [[0.0; 2]; 2];
        for (i, row) in coupling.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let own = modes.iter().map(|mode| mode.shape[i] * mode.shape[j] * mode.taps[0]);
                let left_out = self.structure.component_modes().residual();
                let residual = left_out.closure(pairs[i], pairs[j]);
                *entry = (residual + own.sum::<f64>()) * self.areas[j];
            }
        }
        let (mut closures, mut lowest, mut output) = ([[0.0; 2]; 3], 0.0_f64, 0.0);
        for n in 0..(duration / h).round() as usize {
            let force = drive.value(n as f64 * h);
            let mut target = [0.0; 2];
            for mode in &mut modes {
                let carried = mode.taps[1] * mode.forces[0] + mode.taps[2] * mode.forces[1];
                mode.gain = mode.decay * mode.gain - mode.spring * mode.q - carried
                    + mode.push * mode.drive * force;
                for (target, shape) in target.iter_mut().zip(mode.shape) {
                    *target += shape * (mode.q + mode.gain);
                }
            }
            let [x0, x1, x2] = closures;
            let mut x = [0, 1].map(|i| 3.0 * (x0[i] - x1[i]) + x2[i]);
            let mut pressure = [0.0; 2];
            for _ in 0..8 {
                let at = [0, 1].map(|i| self.tables[i].get_with_tangent(x[i]));
                let miss = [0, 1].map(|i| {
                    target[i] - x[i] - coupling[i][0] * at[0].0 - coupling[i][1] * at[1].0
                });
                let (a, b) = (1.0 + coupling[0][0] * at[0].1, coupling[0][1] * at[1].1);
                let (c, d) = (coupling[1][0] * at[0].1, 1.0 + coupling[1][1] * at[1].1);
                let determinant = a * d - b * c;
                let correction = [
                    (d * miss[0] - b * miss[1]) / determinant,
                    (a * miss[1] - c * miss[0]) / determinant,
                ];
                for i in 0..2 {
                    x[i] += correction[i];
                    pressure[i] = at[i].0 + at[i].1 * correction[i];
                }
                if correction.iter().all(|step| step.abs() < 1e-9) {
                    break;
                }
            }
            closures = [x, x0, x1];
            lowest = lowest.min(pressure[0]);
            output = 0.0;
            for mode in &mut modes {
                let force: f64 = (0..2).map(|i| mode.shape[i] * self.areas[i] * pressure[i]).sum();
                mode.gain -= mode.taps[0] * force;
                mode.q += mode.gain;
                mode.forces = [force, mode.forces[0]];
                output += mode.drive * mode.q;
            }
        }
        (lowest, output)
    }
}
