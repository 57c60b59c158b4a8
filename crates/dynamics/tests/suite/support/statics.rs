//! The static field in closed form, and what the grid makes of it.

use asperity_mesh::{Grid, Stack};
use asperity_structure::StaticDisplacement;

/// Static displacement [m] at every node of the grid, from the top down:
/// `u(x) = u_bottom + integral from x to L of (N + rho A g s) ds / (E A)`.
///
/// It is quadratic, so that the grid's differences of it are exact.
pub fn static_field(stack: &Stack, rest: &StaticDisplacement, grid: &Grid) -> Vec<f64> {
    let mut field = Vec::with_capacity(grid.nodes() + 1);
    let mut load = 0.0;
    for ((body, &(_, bottom)), bar) in stack.bodies().iter().zip(&rest.faces).zip(grid.bars()) {
        let length = body.length();
        let weight = body.mass() * stack.gravity();
        field.extend((0..bar.nodes()).map(|node| {
            let s = node as f64 / bar.cells() as f64;
            let shortening = load * (1.0 - s) + 0.5 * weight * (1.0 - s * s);
            bottom + shortening * length / body.axial_rigidity()
        }));
        load += weight;
    }
    field
}
