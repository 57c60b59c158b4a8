//! The monodromy matrix by exact rotations and kicks.

mod passes;

use faer::Mat;

use super::period::Period;
use super::variational_equation::{LinearisedModes, VariationalEquation};
use passes::Passes;

/// Radians of the fastest mode per kick. Multipliers of large motions are then off by 1e-5, rarely
/// 1e-4; beyond about 0.8 the kicks may resonate with the modes.
const RADIANS_PER_KICK: f64 = 0.4;

/// Steps per period, at least and at most.
const STEPS: (usize, usize) = (96, 1 << 12);

/// Steps at least where contact is lost: the stiffness leaves zero with a vertical tangent there,
/// and the order falls to about 1.5.
const STEPS_WITH_LOSS: usize = 352;

/// Rotations and kicks of a step, `B A B A .. B`, symmetric; the last kick is the first of the
/// next step.
///
/// Source: S. Blanes, P. C. Moan, J. Comput. Appl. Math. 2002, 142, 313,
/// doi 10.1016/S0377-0427(01)00492-7: fourth order, six stages, for `q'' = f(q, t)`.
const KICKS: [f64; STAGES] = {
    let [b1, b2, b3] = [0.082_984_406_417_405_2, 0.396_309_801_498_368, -0.039_056_304_922_348_6];
    [b1, b2, b3, 1.0 - 2.0 * (b1 + b2 + b3), b3, b2]
};
const ROTATIONS: [f64; STAGES] = {
    let [a1, a2] = [0.245_298_957_184_271, 0.604_872_665_711_08];
    [a1, a2, 0.5 - a1 - a2, 0.5 - a1 - a2, a2, a1]
};
const STAGES: usize = 6;

/// Share of a step at which each kick acts.
pub(super) const PLACES: [f64; STAGES] = {
    let mut places = [0.0; STAGES];
    let mut stage = 1;
    while stage < STAGES {
        places[stage] = places[stage - 1] + ROTATIONS[stage - 1];
        stage += 1;
    }
    places
};

/// Splitting of `q'' + h q' + (w^2 + Phi^T dK(t) Phi) q = 0` in the modes of the linearised
/// structure, `dK` being the change of the contacts' stiffness from that at rest.
///
/// Each damped mode rotates exactly; the change of stiffness acts in kicks of the velocities. The
/// determinant of the matrix is exact, `exp(-sum h T)` over the modes, as kicks keep volumes. All
/// component modes need one damping rate, and linearised ones may have rates h of their own beside it:
/// else the rotations are coupled.
#[derive(Debug, Clone)]
pub(super) struct Splitting {
    /// Damping rate of each linearised mode [1/s].
    damping_rates: Vec<f64>,
    /// Squares of the linearised frequencies [rad^2/s^2].
    squares: Vec<f64>,
    /// Velocities are divided by these rates [rad/s].
    scales: Vec<f64>,
    /// Closures of the modes, mode by mode.
    shapes: Vec<f64>,
    /// Stiffness at rest, residual flexibility in series, by rows.
    at_rest: Vec<f64>,
    /// Share of the step of each kick.
    weights: Vec<f64>,
    rotations: Vec<[f64; 4]>,
    kicks: Vec<f64>,
    changes: Vec<f64>,
}

impl Splitting {
    /// The splitting of a variational equation about contacts of the stiffness `springs` \[N/m\];
    /// none where modes are damped at different rates.
    pub(super) fn new(variation: &mut VariationalEquation, springs: &[f64]) -> Option<Self> {
        let first = variation.modes.first()?.damping_rate;
        let unequal = |rate: f64| (rate - first).abs() > 1e-12 * first;
        if variation.modes.iter().any(|mode| unequal(mode.damping_rate)) {
            return None;
        }
        let (n, count) = (springs.len(), variation.modes.len());
        let mut at_rest = vec![0.0; n * n];
        variation.stiffness(|i| springs[i], &mut at_rest);
        let LinearisedModes { squares, shapes: coordinates } = variation.linearised(springs)?;
        let modes = &variation.modes;
        let excess = |r: usize| variation.dampers.get(r).map_or(0.0, |damper| damper.excess);
        let damping_rates = (0..count).map(|r| first + excess(r)).collect();
        let largest = squares.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let scales = squares.iter().map(|square| square.max(1e-12 * largest).sqrt()).collect();
        let shape = |r: usize, i: usize| -> f64 {
            (0..count).map(|mode| coordinates[r][mode] * modes[mode].closure[i]).sum()
        };
        let shapes = (0..count * n).map(|place| shape(place / n, place % n)).collect();
        Some(Self {
            damping_rates,
            squares,
            scales,
            shapes,
            at_rest,
            weights: Vec::new(),
            rotations: Vec::new(),
            kicks: Vec::new(),
            changes: Vec::new(),
        })
    }

    /// Steps of a period with the angular frequency `w` whose stiffest contacts bring the fastest mode
    /// to `fastest` \[rad/s\]; none where that takes too many.
    pub(super) fn steps(fastest: f64, w: f64, lost: bool) -> Option<usize> {
        let wanted = std::f64::consts::TAU * fastest / (w * RADIANS_PER_KICK * STAGES as f64);
        if wanted.is_nan() || wanted > STEPS.1 as f64 {
            return None;
        }
        let fewest = if lost { STEPS_WITH_LOSS } else { STEPS.0 };
        Some(super::period::rounded(wanted).clamp(fewest, STEPS.1))
    }

    /// The monodromy matrix over a period sampled at the kicks.
    pub(super) fn monodromy(&mut self, period: &Period, w: f64) -> Mat<f64> {
        let steps = period.steps();
        let step = std::f64::consts::TAU / (w * steps as f64);
        self.prepare(period, step);
        let size = 2 * self.squares.len();
        let mut matrix = Mat::zeros(size, size);
        let passes = Passes {
            interfaces: period.interfaces(),
            weights: &self.weights,
            rotations: &self.rotations,
            shapes: &self.shapes,
            kicks: &self.kicks,
            changes: &self.changes,
        };
        passes.columns(&mut matrix);
        matrix
    }

    /// The rotations of each stage of a step, the factors of the kicks, and the changes of stiffness.
    fn prepare(&mut self, period: &Period, step: f64) {
        self.rotations.clear();
        for share in ROTATIONS {
            let modes = self.squares.iter().zip(&self.scales).zip(&self.damping_rates);
            for ((square, scale), rate) in modes {
                self.rotations.push(rotation(*square, *scale, *rate, share * step));
            }
        }
        let kicks = period.steps() * STAGES;
        self.weights.clear();
        self.weights.extend((0..=kicks).map(|place| match place % STAGES {
            0 if place > 0 && place < kicks => 2.0 * KICKS[0],
            stage => KICKS[stage],
        }));
        let n = period.interfaces();
        self.kicks.clear();
        for (shape, scale) in self.shapes.chunks_exact(n).zip(&self.scales) {
            self.kicks.extend(shape.iter().map(|phi| phi * step / scale));
        }
        self.changes.clear();
        for stiffness in period.stiffness().chunks_exact(n * n) {
            self.changes.extend(stiffness.iter().zip(&self.at_rest).map(|(k, rest)| k - rest));
        }
    }
}

/// The state `(q, q' / scale)` a time `dt` later under `q'' + h q' + square q = 0`, by rows.
fn rotation(square: f64, scale: f64, h: f64, dt: f64) -> [f64; 4] {
    let half = 0.5 * h;
    let difference = square - half * half;
    let rate = difference.abs().sqrt();
    // cos(r t) and sin(r t) / r, or their continuation where the mode is overdamped.
    let (cos, sin) = if rate == 0.0 {
        (1.0, dt)
    } else if difference > 0.0 {
        ((rate * dt).cos(), (rate * dt).sin() / rate)
    } else {
        ((rate * dt).cosh(), (rate * dt).sinh() / rate)
    };
    let decay = (-half * dt).exp();
    [
        decay * (cos + half * sin),
        decay * sin * scale,
        -decay * square * sin / scale,
        decay * (cos - half * sin),
    ]
}
