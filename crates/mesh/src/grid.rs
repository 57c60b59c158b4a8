//! The finite-difference grid of Eqs. (2) to (4).

use crate::{Body, MeshError, Stack, Support};

/// Most nodes a grid may have: 1e8 nodes are 1.6 GB of displacements.
const MOST_NODES: f64 = 1e8;

/// The grid of one body: `cells + 1` nodes, the two at the ends with half a cell's mass.
#[derive(Debug, Clone, PartialEq)]
pub struct BarGrid {
    cells: usize,
    cell_length: f64,
    cell_mass: f64,
    cell_stiffness: f64,
    wave_speed: f64,
    retardation_time: f64,
}

impl BarGrid {
    fn new(body: &Body, cell: f64) -> Self {
        let cells = (body.length() / cell).round().max(1.0) as usize;
        let cell_length = body.length() / cells as f64;
        Self {
            cells,
            cell_length,
            cell_mass: body.density() * body.section() * cell_length,
            cell_stiffness: body.axial_rigidity() / cell_length,
            wave_speed: body.wave_speed(),
            retardation_time: body.damping().retardation_time().unwrap_or(0.0),
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Number of nodes, `cells + 1`.
    pub fn nodes(&self) -> usize {
        self.cells + 1
    }

    /// Cell length dx \[m\].
    pub fn cell_length(&self) -> f64 {
        self.cell_length
    }

    /// Mass of a whole cell, `rho A dx` \[kg\]; end nodes carry half of it.
    pub fn cell_mass(&self) -> f64 {
        self.cell_mass
    }

    /// Mass at an end node, `rho A dx / 2` \[kg\].
    pub fn end_mass(&self) -> f64 {
        0.5 * self.cell_mass
    }

    /// Stiffness of one cell, `E A / dx` \[N/m\].
    pub fn cell_stiffness(&self) -> f64 {
        self.cell_stiffness
    }

    /// Time in which a wave crosses a cell, `dx / c` \[s\].
    pub fn crossing_time(&self) -> f64 {
        self.cell_length / self.wave_speed
    }

    /// Retardation time b of the body's Kelvin-Voigt damping \[s\].
    pub fn retardation_time(&self) -> f64 {
        self.retardation_time
    }

    /// Longest stable step of this grid \[s\]: `dx / c` without internal damping (Eq. 3), with it the
    /// root of `dt^2 + 2 b dt = (dx / c)^2`.
    ///
    /// The highest frequency of the grid is `w = 2 c / dx`. With the one-sided difference of the
    /// velocity its motion has `z^2 - (2 - w^2 dt^2 - b w^2 dt) z + 1 - b w^2 dt = 0`, which reaches
    /// `z = -1` there.
    pub fn critical_step(&self) -> f64 {
        let (crossing, b) = (self.crossing_time(), self.retardation_time);
        crossing * (crossing / (b + b.hypot(crossing)))
    }
}

/// The grids of all bodies of a stack, from the top down.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_law::Constant;
/// use asperity_mesh::{Body, Grid, Interface, Stack, Support};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
/// let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(8.5e11)?))?;
/// let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
/// let grid = Grid::new(&stack, 1e-3)?;
/// let (step, _) = grid.step_within(5e-6, 0.95)?;
/// assert!(step < grid.critical_step());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    bars: Vec<BarGrid>,
    critical_step: f64,
}

impl Grid {
    /// Divides each body into the whole number of equal cells next to its length over `cell` \[m\], at
    /// least one: they are of `cell` where it divides the length.
    ///
    /// # Errors
    /// [`MeshError`] for a cell that is not positive and finite, or so small
    /// that the grid would not fit in memory.
    pub fn new(stack: &Stack, cell: f64) -> Result<Self, MeshError> {
        crate::error::positive("grid", "cell length [m]", cell)?;
        let nodes: f64 = stack.bodies().iter().map(|body| body.length() / cell + 1.0).sum();
        if nodes > MOST_NODES {
            return Err(MeshError::TooManyNodes { cell_m: cell, nodes, limit: MOST_NODES });
        }
        let bars: Vec<_> = stack.bodies().iter().map(|body| BarGrid::new(body, cell)).collect();
        let bar_limit = bars.iter().map(BarGrid::critical_step).fold(f64::INFINITY, f64::min);
        let critical_step = match *stack.support() {
            Support::Rigid => bar_limit,
            Support::SpringMass { stiffness, mass, .. } => {
                bar_limit.min(2.0 * (mass / stiffness).sqrt())
            }
        };
        Ok(Self { bars, critical_step })
    }

    /// Grids of the bodies, from the top down.
    pub fn bars(&self) -> &[BarGrid] {
        &self.bars
    }

    /// Nodes of all bodies together.
    pub fn nodes(&self) -> usize {
        self.bars.iter().map(BarGrid::nodes).sum()
    }

    /// Longest step at which the explicit scheme is stable \[s\]: the smallest
    /// [critical step](BarGrid::critical_step) of the bodies, and `2 / w` of a spring-mass support.
    pub fn critical_step(&self) -> f64 {
        self.critical_step
    }

    /// A step \[s\] of at most `courant` times the critical one that divides
    /// `interval` \[s\] into a whole number of steps, and that number.
    ///
    /// # Errors
    /// [`MeshError::Courant`] unless `0 < courant < 1`.
    pub fn step_within(&self, interval: f64, courant: f64) -> Result<(f64, usize), MeshError> {
        if !(courant > 0.0 && courant < 1.0) {
            return Err(MeshError::Courant { courant });
        }
        // The tolerance keeps a ratio that is whole but for round-off from gaining a step.
        let steps = (interval / (courant * self.critical_step) * (1.0 - 1e-12)).ceil().max(1.0);
        Ok((interval / steps, steps as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interface;
    use asperity_law::Constant;
    use std::sync::Arc;

    fn stack(support: Support) -> Stack {
        let law = Arc::new(Constant::new(1e12).unwrap());
        let guide = Body::new("guide", 0.229, 1e-3, 71e9, 2710.0).unwrap();
        let interface = Interface::new("contact", 1e-4, law).unwrap();
        Stack::new(vec![guide], vec![interface], support, 9.81).unwrap()
    }

    #[test]
    fn cells_fill_the_length_and_masses_add_up() {
        for (cell, cells) in [(1e-3, 229), (3e-3, 76), (0.7e-3, 327), (10.0, 1)] {
            let grid = Grid::new(&stack(Support::Rigid), cell).unwrap();
            let bar = &grid.bars()[0];
            assert_eq!(bar.cells(), cells);
            assert!((bar.cells() as f64 * bar.cell_length() - 0.229).abs() < 1e-15);
            let mass = (bar.nodes() - 2) as f64 * bar.cell_mass() + 2.0 * bar.end_mass();
            assert!((mass - 0.229 * 1e-3 * 2710.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_step_divides_the_interval_and_keeps_the_courant_number() {
        let grid = Grid::new(&stack(Support::Rigid), 1e-3).unwrap();
        let (step, steps) = grid.step_within(5e-6, 0.95).unwrap();
        assert_eq!(steps, 27);
        assert!((step * 27.0 - 5e-6).abs() < 1e-20);
        assert!(step <= 0.95 * grid.critical_step());
        for courant in [0.0, 1.0, 1.2, -0.5, f64::NAN] {
            assert!(matches!(grid.step_within(5e-6, courant), Err(MeshError::Courant { .. })));
        }
    }

    #[test]
    fn a_stiff_light_support_limits_the_step() {
        let support = Support::SpringMass { stiffness: 1e12, mass: 1e-3, damping_ratio: 0.0 };
        let grid = Grid::new(&stack(support), 1e-3).unwrap();
        assert!((grid.critical_step() - 2.0 * (1e-15_f64).sqrt()).abs() < 1e-20);
    }

    /// The highest motion of the grid, of frequency 2 c / dx, neither grows below the critical step nor
    /// decays above it.
    #[test]
    fn internal_damping_shortens_the_critical_step() {
        for b in [1e-9, 1e-7, 1e-6, 1e-4] {
            let damping = crate::BodyDamping::kelvin_voigt(b).unwrap();
            let stack = stack(Support::Rigid).with_body_damping(damping);
            let bar = Grid::new(&stack, 1e-3).unwrap().bars()[0].clone();
            let largest = |step: f64| {
                let stretch = 4.0 * (step / bar.crossing_time()).powi(2);
                let (p, q) = (2.0 - stretch * (1.0 + b / step), 1.0 - stretch * b / step);
                let root = p * p - 4.0 * q;
                if root < 0.0 { q.sqrt() } else { 0.5 * (p.abs() + root.sqrt()) }
            };
            let critical = bar.critical_step();
            assert!(critical < bar.crossing_time());
            assert!(largest(0.999 * critical) < 1.0 && largest(1.001 * critical) > 1.0, "{b}");
        }
    }

    #[test]
    fn cells_too_many_for_memory_are_an_error() {
        assert!(matches!(
            Grid::new(&stack(Support::Rigid), 1e-12),
            Err(MeshError::TooManyNodes { .. })
        ));
        assert!(Grid::new(&stack(Support::Rigid), 0.0).is_err());
    }
}
