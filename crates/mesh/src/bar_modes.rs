//! Component modes of bars in closed form.

use std::f64::consts::PI;

use faer::Mat;

use crate::component_modes::massless_modes;
use crate::mode_count::{checked_count, first_frequency};
use crate::reduction::PortPattern;
use crate::{
    Body, ComponentModes, MeshError, ModeCount, NormalMode, Port, PortPair, ReducedBody,
    ResidualFlexibility, Stack, Support,
};

impl ComponentModes {
    /// The free-free modes of every bar of `stack` in closed form, and its support, with the given
    /// `ports` first, in their order; the faces of the contacts and the guides have ports behind them.
    ///
    /// At a distance x from its upper end a bar has
    ///
    /// ```text
    /// w_n = n pi c / L,    phi_n(x) = sqrt(2 / m) cos(n pi x / L),    phi_0 = sqrt(1 / m),
    /// ```
    ///
    /// and the flexibility of all its elastic modes between x and y, the nearer end being that of
    /// `x <= y`, is `L / (E A) (1/3 - y / L + (x^2 + y^2) / (2 L^2))`: `L / (3 E A)` at a face and
    /// `-L / (6 E A)` across. The mean displacement of a bar, and the inertia of the whole stack under
    /// a base acceleration, have rigid participations only. Each body with friction has a guide, from
    /// the top down, at its mean displacement.
    ///
    /// With the retardation time b of a body its modes have the damping rate `b w_n^2` of their own, and
    /// the flexibility left out is that of massless modes of the same retardation time, one for each
    /// of its eigenvectors between the ports of the body. A loss factor is replaced by viscous damping
    /// of the same ratio at each mode, `eta w_n`; its flexibility left out has no loss.
    ///
    /// # Errors
    /// [`MeshError::ModeCount`] when `modes` asks for none or too many, [`MeshError::Port`] for a port
    /// that is not on `stack`.
    pub fn of_stack(stack: &Stack, modes: ModeCount, ports: &[Port]) -> Result<Self, MeshError> {
        Self::with_counts(stack, &modes.counts(stack)?, ports)
    }

    /// [`of_stack`](Self::of_stack) with a count of modes, the rigid one included, of each body.
    ///
    /// # Errors
    /// [`MeshError::ModeCount`] for no modes or too many; a body without a count has none.
    /// [`MeshError::Port`] for a port that is not on `stack`.
    pub fn with_counts(stack: &Stack, counts: &[usize], ports: &[Port]) -> Result<Self, MeshError> {
        let bodies = stack.bodies();
        let mut all = Vec::new();
        for port in ports {
            all.push(port.check(stack)?);
        }
        let mut contacts = Vec::new();
        for (i, body) in bodies.iter().enumerate() {
            let upper = all.len();
            all.push(Port::Point { body: i, position: body.length() });
            let below = if i + 1 < bodies.len() {
                Some(Port::Point { body: i + 1, position: 0.0 })
            } else {
                (*stack.support() != Support::Rigid).then_some(Port::Support)
            };
            let lower = below.map(|_| all.len());
            all.extend(below);
            contacts.push(PortPair { upper, lower });
        }
        let mut guides = Vec::new();
        for body in (0..bodies.len()).filter(|&body| bodies[body].friction().is_some()) {
            guides.push(all.len());
            all.push(Port::Mean { body });
        }
        let mut modes = Vec::new();
        let mut residual = ResidualFlexibility::zero(all.len());
        for (i, body) in bodies.iter().enumerate() {
            let kept = checked_count(body, counts.get(i).copied().unwrap_or(0))?;
            let bar = Bar { index: i, body };
            for n in 0..kept {
                let w = n as f64 * first_frequency(body);
                let participations = all.iter().map(|port| bar.participation(*port, n)).collect();
                let damping_rate = w * body.damping().loss(w);
                let mode = NormalMode::elastic(w, participations);
                modes.push(NormalMode { damping_rate, ..mode });
            }
            bar.leave_out(kept, &all, &mut modes, &mut residual);
        }
        if let Support::SpringMass { stiffness, mass, .. } = *stack.support() {
            let participation = |port: &Port| match port {
                Port::Support => (1.0 / mass).sqrt(),
                Port::Base => -mass.sqrt(),
                Port::Point { .. } | Port::Mean { .. } | Port::Number(_) => 0.0,
            };
            modes.push(NormalMode {
                mass_damped: false,
                damping_rate: stack.support().damping() / mass,
                ..NormalMode::elastic(
                    (stiffness / mass).sqrt(),
                    all.iter().map(participation).collect(),
                )
            });
        }
        Self::new(modes, residual, contacts, guides)
    }
}

impl ReducedBody {
    /// A bar in its `modes` lowest free-free modes, the rigid one included, with the flexibility of all others, both in
    /// closed form as [`ComponentModes::of_stack`] states them, to be [joined](Self::joined) with other bodies.
    ///
    /// `places` of the bar, as of body 0, are what `ports` weigh: points, and its mean for a force spread by its
    /// mass. Internal damping and friction of `body` do not count.
    ///
    /// ```
    /// use asperity_mesh::{Body, Port, ReducedBody};
    ///
    /// let bar = Body::new("bar", 0.5, 1e-4, 200e9, 7800.0)?;
    /// let ends = [0.0, 0.5].map(|position| Port::Point { body: 0, position });
    /// let elongation = vec![(1, 1.0), (0, -1.0)];
    /// let reduced = ReducedBody::of_bar(&bar, &ends, &[elongation], 1)?;
    /// // Forces at both ends stretch the bar by L / (E A) each.
    /// assert!((reduced.residual.get(0, 0) * 200e9 * 1e-4 / 0.5 - 1.0).abs() < 1e-12);
    /// # Ok::<(), asperity_mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::ModeCount`] for no modes or too many; [`MeshError::Port`] for a position that is not on the bar;
    /// [`MeshError::DegreeOfFreedom`] for a port at a place that does not exist.
    pub fn of_bar(
        body: &Body,
        places: &[Port],
        ports: &[PortPattern],
        modes: usize,
    ) -> Result<Self, MeshError> {
        let modes = checked_count(body, modes)?;
        let size = places.len();
        if let Some(&(dof, _)) = ports.iter().flatten().find(|(dof, _)| *dof >= size) {
            return Err(MeshError::DegreeOfFreedom { dof, size });
        }
        for &place in places {
            if let Port::Point { position, .. } = place
                && !(0.0..=body.length()).contains(&position)
            {
                let (quantity, most) = ("position [m]", body.length());
                return Err(MeshError::Port { quantity, value: position, most });
            }
        }
        let bar = Bar { index: 0, body };
        let first = first_frequency(body);
        let participation = |n: usize, pattern: &PortPattern| -> f64 {
            pattern
                .iter()
                .map(|&(place, weight)| weight * bar.participation(places[place], n))
                .sum()
        };
        let participations: Vec<Vec<f64>> = (0..modes)
            .map(|n| ports.iter().map(|pattern| participation(n, pattern)).collect())
            .collect();
        let points: Vec<(usize, f64)> = points(places, 0).collect();
        let left = Mat::from_fn(points.len(), points.len(), |a, b| {
            bar.left_out(modes, places, points[a], points[b])
        });
        let row_of = |place: usize| points.iter().position(|(own, _)| *own == place);
        let between = |a: &PortPattern, b: &PortPattern| -> f64 {
            let pairs = a.iter().flat_map(|x| b.iter().map(move |y| (x, y)));
            pairs.filter_map(|(x, y)| Some(x.1 * y.1 * left[(row_of(x.0)?, row_of(y.0)?)])).sum()
        };
        let rows: Vec<Vec<f64>> =
            ports.iter().map(|a| ports.iter().map(|b| between(a, b)).collect()).collect();
        Ok(Self {
            angular_frequencies: (0..modes).map(|n| n as f64 * first).collect(),
            participations,
            residual: ResidualFlexibility::from_rows(&rows)?,
        })
    }
}

/// The points of body `index` among `places`: number and position \[m\] of each.
fn points(places: &[Port], index: usize) -> impl Iterator<Item = (usize, f64)> {
    places.iter().enumerate().filter_map(move |(number, place)| match *place {
        Port::Point { body, position } if body == index => Some((number, position)),
        _ => None,
    })
}

/// One bar of a stack, free at both ends.
struct Bar<'a> {
    index: usize,
    body: &'a Body,
}

impl Bar<'_> {
    /// Participation of mode `n` at a port \[kg^-1/2\].
    fn participation(&self, port: Port, n: usize) -> f64 {
        let mass = self.body.mass();
        match port {
            Port::Point { body, position } if body == self.index => {
                let shape = (if n == 0 { 1.0 } else { 2.0 } / mass).sqrt();
                let part = position / self.body.length();
                // Exact at both ends.
                let cosine = if part == 0.0 {
                    1.0
                } else if part == 1.0 {
                    if n.is_multiple_of(2) { 1.0 } else { -1.0 }
                } else {
                    (n as f64 * PI * part).cos()
                };
                shape * cosine
            }
            // The mean displacement of an elastic mode of a free bar is zero.
            Port::Mean { body } if body == self.index && n == 0 => (1.0 / mass).sqrt(),
            Port::Base if n == 0 => -mass.sqrt(),
            _ => 0.0,
        }
    }

    /// Flexibility of all elastic modes between two places \[m/N\].
    fn flexibility(&self, x: f64, y: f64) -> f64 {
        let length = self.body.length();
        let (x, y) = (x / length, y / length);
        let parts = 1.0 / 3.0 - x.max(y) + 0.5 * (x * x + y * y);
        parts * length / self.body.axial_rigidity()
    }

    /// Flexibility of the modes from `kept` on between two of `places`, each with its position \[m/N\].
    fn left_out(
        &self,
        kept: usize,
        places: &[Port],
        (a, x): (usize, f64),
        (b, y): (usize, f64),
    ) -> f64 {
        let of_mode = |n: usize| {
            let w = n as f64 * first_frequency(self.body);
            let [a, b] = [a, b].map(|place| self.participation(places[place], n));
            a * b / (w * w)
        };
        self.flexibility(x, y) - (1..kept).map(of_mode).sum::<f64>()
    }

    /// Adds the flexibility of the modes from `kept` on: to the residual, or as massless modes where
    /// the bar has a retardation time.
    fn leave_out(
        &self,
        kept: usize,
        all: &[Port],
        modes: &mut Vec<NormalMode>,
        residual: &mut ResidualFlexibility,
    ) {
        let places: Vec<(usize, f64)> = points(all, self.index).collect();
        let left = |a: (usize, f64), b: (usize, f64)| self.left_out(kept, all, a, b);
        let time = self.body.damping().retardation_time().unwrap_or(0.0);
        if time == 0.0 {
            for (number, &a) in places.iter().enumerate() {
                for &b in &places[number..] {
                    residual.add_between(a.0, b.0, left(a, b));
                }
            }
            return;
        }
        let matrix = Mat::from_fn(places.len(), places.len(), |i, j| left(places[i], places[j]));
        let w = kept as f64 * first_frequency(self.body);
        let ports: Vec<usize> = places.iter().map(|place| place.0).collect();
        modes.extend(massless_modes(&matrix, (&ports, all.len()), w, time));
    }
}
