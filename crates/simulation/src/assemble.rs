//! From a scenario to the structure at rest, its force and its integrator.

use std::path::Path;
use std::sync::Arc;

use asperity_dynamics::{
    ContactForm, Excitation, FiniteDifference, ForceRecord, Integrator, Modal, Sampling,
};
use asperity_law::{
    Constant, ContactDamping, ContactLaw, Exponential, Friction, GreenwoodWilliamson, Hyperbolic,
    InSeries, LawsInSeries, ModifiedPower, Persson, Power, SeriesContact, Tabulated,
};
use asperity_mesh::{Body, BodyDamping, Interface, Stack, Support};
use asperity_structure::{Damping, PreloadedStructure, StructureError};

use crate::accuracy::DEFAULT_ACCURACY;
use crate::error::{BuildLawError, SimulationError};
use crate::laws::law_name;
use asperity_scenario::{
    BodySpec, ContactDampingSpec, ContactScheme, DampingAmount, DampingSpec, ExcitationSpec,
    ForceSamples, FrictionSpec, LawRef, LawSpec, Laws, MAX_SERIES_DEPTH, MAX_SERIES_LAWS,
    MethodSpec, ModalDampingSpec, ModalSpec, Scenario, SectionSpec, SlipSpec, SupportSpec,
};

/// A scenario turned into the objects that compute.
#[derive(Debug, Clone)]
pub struct Assembly {
    /// Bodies, interfaces and support at rest, with their damping.
    pub structure: PreloadedStructure,
    /// The force on the top.
    pub excitation: Excitation,
    /// Duration and output rate of the record.
    pub sampling: Sampling,
    /// The integrator and its settings.
    pub method: Integrator,
    /// Relative accuracy of a modal response's observables.
    pub accuracy: f64,
}

impl Assembly {
    /// Assembles `scenario`; sample files are looked for in `folder`.
    ///
    /// # Errors
    /// [`SimulationError`] when a part cannot be built or there is no static equilibrium.
    pub fn new(scenario: &Scenario, folder: &Path) -> Result<Self, SimulationError> {
        let (damping, internal) = body_damping(&scenario.damping)?;
        let stack = stack(scenario)?.with_body_damping(internal);
        let mut structure = PreloadedStructure::new(stack, damping)?;
        if let DampingSpec::Modal(ModalDampingSpec { ratios, other_ratio }) = &scenario.damping {
            let other = other_ratio.or_else(|| ratios.last().copied()).unwrap_or_default();
            structure = structure.with_modal_damping(ratios, other)?;
        }
        Ok(Self {
            structure,
            excitation: excitation(&scenario.excitation, folder)?,
            sampling: Sampling::new(scenario.duration_s, scenario.output_rate_hz)?,
            method: integrator(scenario.method),
            accuracy: match scenario.method {
                MethodSpec::Modal(ModalSpec { accuracy: Some(accuracy), .. }) => accuracy,
                _ => DEFAULT_ACCURACY,
            },
        })
    }
}

fn integrator(method: MethodSpec) -> Integrator {
    match method {
        MethodSpec::FiniteDifference(settings) => Integrator::from(FiniteDifference {
            cell: settings.cell_m,
            courant: settings.courant,
            contact: match settings.contact {
                ContactScheme::Centred => ContactForm::Centred,
                ContactScheme::NewLevel => ContactForm::NewLevel,
            },
        }),
        MethodSpec::Modal(settings) => Integrator::from(Modal {
            step: settings.step_s,
            modes_per_body: settings.modes_per_body,
            ..Modal::default()
        }),
    }
}

fn stack(scenario: &Scenario) -> Result<Stack, SimulationError> {
    let bodies = scenario.bodies.iter().map(body).collect::<Result<Vec<_>, _>>()?;
    let areas = scenario.interfaces.iter().map(|interface| interface.area_m2);
    let pressures = asperity_mesh::static_pressures(&bodies, areas, scenario.gravity_m_per_s2);
    let mut interfaces = Vec::with_capacity(scenario.interfaces.len());
    for (spec, &pressure) in scenario.interfaces.iter().zip(&pressures) {
        let law = build_law(&spec.law, &scenario.laws, pressure).map_err(|source| {
            let (law, interface) = (law_name(&spec.law).to_owned(), Some(spec.name.clone()));
            SimulationError::Law { law, interface, pressure_pa: pressure, source }
        })?;
        let interface = Interface::new(&spec.name, spec.area_m2, law);
        let interface = interface.map_err(StructureError::from)?;
        let interface = match spec.damping {
            None => interface,
            Some(damping) => interface.with_damping(contact_damping(&spec.name, damping)?),
        };
        interfaces.push(match spec.friction {
            None => interface,
            Some(one) => interface.with_friction(friction(&spec.name, one)?),
        });
    }
    let support = match scenario.support {
        SupportSpec::Rigid => Support::Rigid,
        SupportSpec::SpringMass { stiffness_n_per_m, mass_kg, damping_ratio } => {
            Support::SpringMass { stiffness: stiffness_n_per_m, mass: mass_kg, damping_ratio }
        }
    };
    let stack = Stack::new(bodies, interfaces, support, scenario.gravity_m_per_s2);
    Ok(stack.map_err(StructureError::from)?)
}

/// The mass-proportional and the internal damping of the bodies.
fn body_damping(spec: &DampingSpec) -> Result<(Damping, BodyDamping), SimulationError> {
    let (mass, internal) = match *spec {
        DampingSpec::MassProportional(DampingAmount::Ratio(ratio)) => {
            (Damping::Ratio(ratio), Ok(BodyDamping::NONE))
        }
        DampingSpec::MassProportional(DampingAmount::RatePerS(rate)) => {
            (Damping::Rate(rate), Ok(BodyDamping::NONE))
        }
        DampingSpec::Rayleigh(ref rayleigh) => {
            let (rate, time) = rayleigh.coefficients();
            (Damping::Rate(rate), BodyDamping::kelvin_voigt(time))
        }
        DampingSpec::LossFactor(factor) => (Damping::Rate(0.0), BodyDamping::loss_factor(factor)),
        // Of linearised modes, once the structure is at rest.
        DampingSpec::Modal(_) => (Damping::Rate(0.0), Ok(BodyDamping::NONE)),
    };
    Ok((mass, internal.map_err(StructureError::from)?))
}

/// The damping of the interface `name`.
fn contact_damping(
    name: &str,
    spec: ContactDampingSpec,
) -> Result<ContactDamping, SimulationError> {
    let damping = match spec {
        ContactDampingSpec::KelvinVoigt { time_s } => ContactDamping::kelvin_voigt(time_s),
        ContactDampingSpec::LossRatio { ratio, frequency_hz } => {
            ContactDamping::loss_ratio(ratio, frequency_hz)
        }
        ContactDampingSpec::Power { coefficient_pa_s_per_m, reference_pa, exponent } => {
            ContactDamping::power(coefficient_pa_s_per_m, reference_pa, exponent)
        }
    };
    let interface = name.to_owned();
    damping.map_err(|source| SimulationError::ContactDamping { interface, source })
}

/// The friction element of the contact or body `name`.
fn friction(name: &str, spec: FrictionSpec) -> Result<Friction, SimulationError> {
    let stiffness = spec.stiffness_n_per_m;
    let friction = match spec.slip {
        SlipSpec::ForceN(force) => Friction::slip_force(stiffness, force),
        SlipSpec::Coefficient(coefficient) => Friction::coefficient(stiffness, coefficient),
    };
    let element = name.to_owned();
    friction.map_err(|source| SimulationError::Friction { element, source })
}

/// The body that `spec` describes.
///
/// # Errors
/// [`SimulationError::Structure`] and [`SimulationError::Friction`] for values out of range.
pub fn body(spec: &BodySpec) -> Result<Body, SimulationError> {
    let BodySpec { name, length_m, youngs_modulus_pa, density_kg_per_m3, .. } = spec;
    let body = match spec.section {
        SectionSpec::AreaM2(area) => {
            Body::new(name, *length_m, area, *youngs_modulus_pa, *density_kg_per_m3)
        }
        SectionSpec::MassKg(mass) => {
            Body::with_mass(name, *length_m, mass, *youngs_modulus_pa, *density_kg_per_m3)
        }
    };
    let body = body.map_err(StructureError::from)?;
    Ok(match spec.friction {
        None => body,
        Some(one) => body.with_friction(friction(name, one)?),
    })
}

/// Builds the law that `reference` names among `laws`. A law that never
/// separates counts its closure from `static_pressure` \[Pa\].
///
/// # Errors
/// [`BuildLawError`] for a name without a law, parameters out of range, or a law that never
/// separates without a pressure to hold it closed.
pub fn build_law(
    reference: &LawRef,
    laws: &Laws,
    static_pressure: f64,
) -> Result<Arc<dyn ContactLaw>, BuildLawError> {
    let spec = laws.resolve(reference).ok_or_else(|| BuildLawError::Missing {
        name: law_name(reference).to_owned(),
        known: laws.names().collect::<Vec<_>>().join(", "),
    })?;
    Ok(match spec {
        LawSpec::Constant { stiffness_pa_per_m, unilateral: false } => {
            Arc::new(Constant::new(*stiffness_pa_per_m)?)
        }
        LawSpec::Constant { stiffness_pa_per_m, unilateral: true } => {
            Arc::new(Constant::unilateral(*stiffness_pa_per_m)?)
        }
        LawSpec::Power { coefficient, exponent } => {
            let reference_pressure = if *exponent < 1.0 { 0.0 } else { static_pressure };
            Arc::new(Power::new(*coefficient, *exponent, reference_pressure)?)
        }
        LawSpec::ModifiedPower { coefficient, exponent, transition_pa, knots } => {
            let knots: Vec<_> = knots.iter().map(|&[p, k]| (p, k)).collect();
            Arc::new(ModifiedPower::new(*coefficient, *exponent, *transition_pa, &knots)?)
        }
        LawSpec::Exponential { length_m } => {
            Arc::new(Exponential::new(*length_m, static_pressure)?)
        }
        LawSpec::Hyperbolic { stiffness_pa_per_m, closure_limit_m } => {
            Arc::new(Hyperbolic::new(*stiffness_pa_per_m, *closure_limit_m)?)
        }
        LawSpec::GreenwoodWilliamson {
            summit_density_per_m2,
            summit_radius_m,
            summit_height_rms_m,
            contact_modulus_pa,
        } => Arc::new(GreenwoodWilliamson::new(
            *summit_density_per_m2,
            *summit_radius_m,
            *summit_height_rms_m,
            *contact_modulus_pa,
            static_pressure,
        )?),
        LawSpec::Persson {
            height_rms_m,
            hurst_exponent,
            roll_off_per_m,
            cut_off_per_m,
            contact_modulus_pa,
        } => Arc::new(Persson::new(
            *height_rms_m,
            *hurst_exponent,
            [*roll_off_per_m, *cut_off_per_m],
            *contact_modulus_pa,
            static_pressure,
        )?),
        LawSpec::Table { points } => {
            let points: Vec<_> = points.iter().map(|&[p, k]| (p, k)).collect();
            Arc::new(Tabulated::new(&points)?)
        }
        LawSpec::InSeries { .. } => {
            // Layers in series are one layer, and laws in it are inverted by one iteration.
            let mut series = Series::default();
            series.add(spec, laws, 0)?;
            let build = |inner: &&LawRef| build_law(inner, laws, static_pressure);
            let mut inner = series.laws.iter().map(build).collect::<Result<Vec<_>, _>>()?;
            match (inner.len(), series.layer) {
                (1, Some(layer)) => Arc::new(InSeries::new(inner.remove(0), layer)?),
                (_, layer) => {
                    let contacts = inner.into_iter().map(SeriesContact::new).collect();
                    Arc::new(LawsInSeries::new(contacts, layer.map_or(0.0, f64::recip))?)
                }
            }
        }
    })
}

/// The laws in series of a law, those of nested series included, and all elastic layers as one.
#[derive(Default)]
struct Series<'a> {
    laws: Vec<&'a LawRef>,
    /// Stiffness of the layers \[Pa/m\].
    layer: Option<f64>,
}

impl<'a> Series<'a> {
    fn add(
        &mut self,
        spec: &'a LawSpec,
        laws: &'a Laws,
        depth: usize,
    ) -> Result<(), BuildLawError> {
        if depth == MAX_SERIES_DEPTH {
            return Err(BuildLawError::SeriesTooDeep { most: MAX_SERIES_DEPTH });
        }
        if let LawSpec::InSeries { stiffness_pa_per_m: Some(stiffness), .. } = spec {
            self.layer =
                Some(self.layer.map_or(*stiffness, |layer| 1.0 / (1.0 / layer + 1.0 / stiffness)));
        }
        for inner in spec.inner_laws() {
            match laws.resolve(inner) {
                Some(nested @ LawSpec::InSeries { .. }) => self.add(nested, laws, depth + 1)?,
                _ => self.laws.push(inner),
            }
            if self.laws.len() > MAX_SERIES_LAWS {
                return Err(BuildLawError::TooManyInSeries { most: MAX_SERIES_LAWS });
            }
        }
        Ok(())
    }
}

/// The force that `spec` describes; sample files are looked for in `folder`.
///
/// # Errors
/// [`SimulationError`] for samples that cannot be read or values out of range.
pub fn excitation(spec: &ExcitationSpec, folder: &Path) -> Result<Excitation, SimulationError> {
    Ok(match *spec {
        ExcitationSpec::None => Excitation::None,
        ExcitationSpec::GammaPulse { peak_n, rise_s } => {
            Excitation::GammaPulse { peak: peak_n, rise: rise_s }
        }
        ExcitationSpec::HalfSine { peak_n, duration_s } => {
            Excitation::HalfSine { peak: peak_n, duration: duration_s }
        }
        ExcitationSpec::Haversine { peak_n, duration_s } => {
            Excitation::Haversine { peak: peak_n, duration: duration_s }
        }
        ExcitationSpec::Harmonic { amplitude_n, frequency_hz } => {
            Excitation::Harmonic { amplitude: amplitude_n, frequency: frequency_hz }
        }
        ExcitationSpec::Samples { ref file, peak_n } => {
            let path = folder.join(file);
            let read = || {
                let samples = ForceSamples::read(&path)?;
                match peak_n {
                    Some(peak) => samples.rescaled(peak),
                    None => Ok(samples),
                }
            };
            let samples =
                read().map_err(|source| SimulationError::Samples { path: path.clone(), source })?;
            Excitation::Record(ForceRecord::new(samples.time_s, samples.force_n)?)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_layers_in_series_are_one_layer() {
        let power = LawSpec::Power { coefficient: 1.81e10, exponent: 0.35 };
        let in_series = |law: LawSpec, stiffness_pa_per_m| {
            let law = LawRef::InPlace(Box::new(law));
            LawSpec::with_layer(law, stiffness_pa_per_m)
        };
        let nested = [4e12, 4e12, 2e12].into_iter().fold(power.clone(), in_series);
        let built = |law: LawSpec| {
            let law = LawRef::InPlace(Box::new(law));
            format!("{:?}", build_law(&law, &Laws::default(), 1e5).unwrap())
        };
        assert_eq!(built(nested), built(in_series(power, 1e12)));
    }

    /// Closures add at one pressure, whatever the nesting; two equal laws are half as stiff.
    #[test]
    fn laws_in_series_add_their_closures() {
        let power = LawSpec::Power { coefficient: 1.81e10, exponent: 0.35 };
        let constant = LawSpec::Constant { stiffness_pa_per_m: 8e11, unilateral: true };
        let in_place = |law: &LawSpec| LawRef::InPlace(Box::new(law.clone()));
        let series = |laws: &[&LawSpec], stiffness_pa_per_m: Option<f64>| {
            let laws = laws.iter().map(|law| in_place(law)).collect();
            LawSpec::InSeries { law: None, laws, stiffness_pa_per_m }
        };
        let built = |law: &LawSpec| build_law(&in_place(law), &Laws::default(), 1e5).unwrap();
        let both = built(&series(&[&power, &constant], Some(4e12)));
        let twice = built(&series(&[&power, &power], None));
        let inner = series(&[&power, &constant], Some(8e12));
        let nested = built(&series(&[&inner, &power], Some(8e12)));
        let [one, other] = [built(&power), built(&constant)];
        for pressure in [1e3, 1e5, 3e6] {
            let closure = one.closure(pressure) + other.closure(pressure) + pressure / 4e12;
            assert!((both.closure(pressure) / closure - 1.0).abs() < 1e-12);
            let stiffness = twice.stiffness(pressure);
            assert!((stiffness / one.stiffness(pressure) - 0.5).abs() < 1e-12);
            let closure = closure + one.closure(pressure);
            assert!((nested.closure(pressure) / closure - 1.0).abs() < 1e-12);
        }
    }

    /// A law that refers to itself is refused without validation too.
    #[test]
    fn endless_series_are_refused() {
        let named = || LawRef::Named("a".to_owned());
        let law = |laws| LawSpec::InSeries { law: None, laws, stiffness_pa_per_m: None };
        let laws = Laws::from_iter([("a".to_owned(), law(vec![named(), named()]))]);
        let error = build_law(&named(), &laws, 1e5).unwrap_err();
        assert!(error.to_string().contains("nested"), "{error}");
        let error = build_law(&LawRef::InPlace(Box::new(law(vec![]))), &laws, 1e5).unwrap_err();
        assert!(matches!(error, BuildLawError::Law(_)), "{error}");
    }
}
