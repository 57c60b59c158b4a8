//! A bar beside bodies of matrices. Its places are the rows of patterns.

use asperity_mesh::{Body, Port, PortPattern, ReducedBody};
use asperity_scenario::{BarSpec, End, PlaceSpec, StructureBodySpec, UnitsSpec};
use asperity_structure::StructureError;

use super::body::unit;
use crate::error::SimulationError;

/// A bar with the places of it that ports weigh.
pub(super) struct Bar {
    body: Body,
    /// Direction from its upper to its lower end, of unit length.
    axis: [f64; 3],
    places: Vec<Port>,
}

impl Bar {
    /// The bar of a body, if it is one; `place` is where the body stands in the scenario.
    pub(super) fn of(
        spec: &StructureBodySpec,
        place: &str,
    ) -> Result<Option<Self>, SimulationError> {
        let StructureBodySpec { name, matrices, bar, mesh, units, .. } = spec;
        let bar = match (bar, matrices) {
            (Some(bar), None) => bar,
            (None, Some(_)) => return Ok(None),
            _ => {
                let problem = "the body is given twice or not at all";
                return Err(SimulationError::model(place, problem, "\"matrices\" or \"bar\""));
            }
        };
        let refused = [("mesh", mesh.is_some()), ("units", *units != UnitsSpec::default())];
        if let Some((key, _)) = refused.iter().find(|(_, given)| *given) {
            let problem = "a bar is given in SI, without a mesh";
            let accepted = "\"bar\", \"name\" and \"reduction\"";
            return Err(SimulationError::model(&format!("{place}/{key}"), problem, accepted));
        }
        let BarSpec { length_m, area_m2, mass_kg, youngs_modulus_pa, density_kg_per_m3, .. } = *bar;
        let (modulus, density) = (youngs_modulus_pa, density_kg_per_m3);
        let body = match (area_m2, mass_kg) {
            (Some(area), None) => Body::new(name, length_m, area, modulus, density),
            (None, Some(mass)) => Body::with_mass(name, length_m, mass, modulus, density),
            _ => {
                let (problem, accepted) =
                    ("the section is given twice or not at all", "area_m2 or mass_kg");
                return Err(SimulationError::model(&format!("{place}/bar"), problem, accepted));
            }
        };
        let axis = unit(bar.direction).ok_or_else(|| {
            let at = format!("{place}/bar/direction");
            SimulationError::model(&at, "the axis has no direction", "[x, y, z], not all zero")
        })?;
        let body = body.map_err(StructureError::from)?;
        Ok(Some(Self { body, axis, places: Vec::new() }))
    }

    fn row(&mut self, place: Port) -> usize {
        self.places.iter().position(|known| *known == place).unwrap_or_else(|| {
            self.places.push(place);
            self.places.len() - 1
        })
    }

    /// Displacement of a place along the axis.
    pub(super) fn at(&mut self, place: &PlaceSpec) -> Result<PortPattern, SimulationError> {
        let port = place.port(std::slice::from_ref(&self.body))?;
        Ok(vec![(self.row(port), 1.0)])
    }

    /// Displacement of an end along `direction`.
    pub(super) fn end_along(&mut self, end: End, direction: [f64; 3]) -> PortPattern {
        let position = match end {
            End::Upper => 0.0,
            End::Lower => self.body.length(),
        };
        vec![(self.row(Port::Point { body: 0, position }), dot(self.axis, direction))]
    }

    /// Outward normal of an end face.
    pub(super) fn outward(&self, end: End) -> [f64; 3] {
        match end {
            End::Upper => self.axis.map(|part| -part),
            End::Lower => self.axis,
        }
    }

    /// Force of an acceleration of 1 m/s2 along `direction` on all of its mass \[kg\].
    pub(super) fn weight(&mut self, direction: [f64; 3]) -> PortPattern {
        let force = self.body.mass() * dot(self.axis, direction);
        vec![(self.row(Port::Mean { body: 0 }), force)]
    }

    /// The bar in its modes.
    pub(super) fn reduced(
        &self,
        ports: &[PortPattern],
        modes: usize,
    ) -> Result<ReducedBody, SimulationError> {
        let reduced = ReducedBody::of_bar(&self.body, &self.places, ports, modes);
        Ok(reduced.map_err(StructureError::from)?)
    }
}

/// Direction of the axis of a bar, of unit length; none for other bodies.
pub(super) fn axis(spec: &StructureBodySpec) -> Option<[f64; 3]> {
    unit(spec.bar.as_ref()?.direction)
}

/// The scalar product.
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
