//! The scheme of Eqs. (2) to (5) once more, written the plain way: absolute
//! displacements under gravity, one loop over nodes, and at each contact the
//! law itself solved by safeguarded Newton at every step.

use asperity_dynamics::ContactForm;
use asperity_law::ContactLaw;
use asperity_mesh::{Grid, Stack, Support};
use asperity_structure::LoadCase;

use super::at_rest;
use super::statics::static_field;

/// Samples of the plain scheme, in absolute coordinates.
#[derive(Debug, Default)]
pub struct AbsoluteRun {
    /// Displacement of the top, less its static value [m].
    pub displacement: Vec<f64>,
    /// Closure of each interface [m].
    pub closure: Vec<Vec<f64>>,
    /// Pressure of each interface in the step from each sample on [Pa].
    pub pressure: Vec<Vec<f64>>,
}

/// Runs the plain scheme; `excitation` must start from zero force.
pub fn integrate(
    stack: &Stack,
    (cell, form): (f64, ContactForm),
    rate: f64,
    excitation: &LoadCase,
    (step, stride, samples): (f64, usize, usize),
) -> AbsoluteRun {
    let rest = at_rest(stack).static_displacement();
    let grid = Grid::new(stack, cell).unwrap();
    let field = static_field(stack, &rest, &grid);
    let mut first = 0;
    let mut now: Vec<Vec<f64>> = Vec::new();
    for bar in grid.bars() {
        now.push(field[first..first + bar.nodes()].to_vec());
        first += bar.nodes();
    }
    let static_top = now[0][0];
    let mut before = now.clone();
    let (mut disc, mut disc_before) = (rest.support, rest.support);
    let interfaces = stack.interfaces();
    let mut run = AbsoluteRun {
        closure: vec![Vec::new(); interfaces.len()],
        pressure: vec![Vec::new(); interfaces.len()],
        ..AbsoluteRun::default()
    };
    let dt = step;
    for n in 0..samples * stride {
        let force = excitation.value(n as f64 * dt);
        // Every node without contact pressure: m (u+ - 2u + u-)/dt2 + m h (u+ - u)/dt = f.
        let mut after = now.clone();
        for (i, bar) in grid.bars().iter().enumerate() {
            let (u, old) = (&now[i], &before[i]);
            let last = bar.cells();
            for node in 0..=last {
                let mass = if node == 0 || node == last { bar.end_mass() } else { bar.cell_mass() };
                let mut push = mass * stack.gravity();
                if node > 0 {
                    push += bar.cell_stiffness() * (u[node - 1] - u[node]);
                }
                if node < last {
                    push += bar.cell_stiffness() * (u[node + 1] - u[node]);
                }
                if i == 0 && node == 0 {
                    push += force;
                }
                let inertia = 2.0 * u[node] - old[node] + rate * dt * u[node];
                after[i][node] = (inertia + push * dt * dt / mass) / (1.0 + rate * dt);
            }
        }
        let (mut disc_after, disc_compliance) = match *stack.support() {
            Support::Rigid => (0.0, 0.0),
            Support::SpringMass { stiffness, mass, .. } => {
                let c = stack.support().damping();
                let push = mass * stack.gravity() - stiffness * disc + c * disc_before / (2.0 * dt);
                let unit = mass / (dt * dt) + c / (2.0 * dt);
                let inertia = mass * (2.0 * disc - disc_before) / (dt * dt);
                ((inertia + push) / unit, 1.0 / unit)
            }
        };
        for (i, interface) in interfaces.iter().enumerate() {
            let area = interface.area();
            let compliance =
                |body: usize| dt * dt / (grid.bars()[body].end_mass() * (1.0 + rate * dt));
            let last = grid.bars()[i].cells();
            let lowest = i + 1 == interfaces.len();
            let (free_below, soft_below, below_now, below_old) = if lowest {
                (disc_after, disc_compliance, disc, disc_before)
            } else {
                (after[i + 1][0], compliance(i + 1), now[i + 1][0], before[i + 1][0])
            };
            let b = area * (compliance(i) + soft_below);
            let free = after[i][last] - free_below;
            let (closure, old) = (now[i][last] - below_now, before[i][last] - below_old);
            let law = interface.law();
            let pressure = match form {
                ContactForm::NewLevel => pressure_in_series(&**law, free, b),
                ContactForm::Centred => pressure_in_series(&**law, 0.5 * (free + old), 0.5 * b),
            };
            after[i][last] -= area * compliance(i) * pressure;
            if lowest {
                disc_after += area * disc_compliance * pressure;
            } else {
                after[i + 1][0] += area * compliance(i + 1) * pressure;
            }
            if n % stride == 0 {
                run.closure[i].push(closure);
                run.pressure[i].push(pressure);
            }
        }
        if n % stride == 0 {
            run.displacement.push(now[0][0] - static_top);
        }
        before = std::mem::replace(&mut now, after);
        (disc_before, disc) = (disc, disc_after);
    }
    run
}

/// The pressure that solves `x + b p(x) = c`, a monotone equation, by Newton
/// within a bracket that shrinks.
fn pressure_in_series(law: &dyn ContactLaw, c: f64, b: f64) -> f64 {
    let at_most = law.pressure(c).value;
    let (mut low, mut high) =
        if at_most >= 0.0 { (c - b * at_most, c) } else { (c, c - b * at_most) };
    let mut x = 0.5 * (low + high);
    for _ in 0..200 {
        let p = law.pressure(x);
        let off = x + b * p.value - c;
        if off > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - off / (1.0 + b * p.tangent);
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        // Next to the last digits of a closure of about 1e-7 m.
        if (next - x).abs() <= 1e-22 {
            return law.pressure(next).value;
        }
        x = next;
    }
    law.pressure(x).value
}
