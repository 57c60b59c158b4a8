//! Stacks whose light bodies are condensed into series laws of their contacts.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_law::{ContactDamping, LawsInSeries, SeriesContact};
use asperity_mesh::{Body, BodyDamping, Interface, Port, Stack};
use asperity_structure::{Damping, LinearisedMode, PreloadedContact, PreloadedStructure};

use crate::{ContactSystem, HarmonicError, LawEvaluation, PeriodicResponse, PressureRange};

/// Offsets of pressure below this part of the pressure are rounding.
const ROUNDING: f64 = 1e-12;

/// Most modes whose kinetic energy is compared with the energy of the condensed bodies.
const MOST_MODES: usize = 40;

/// A stack without the inertia of some bodies between contacts.
///
/// A light body between two contacts has modes on them far above the band of interest. When a contact
/// is lost these modes are excited: the motion is no longer periodic, and a branch of harmonic
/// balance folds without end. Without inertia such bodies and their contacts are one contact that
/// carries one force, with the law in series
///
/// ```text
/// d(p) = sum_i d_i(p_i) + p sum L / E,    p_i = p S / S_i + weights between / S_i,
/// ```
///
/// with the pressure p and the area S of the contact that is lost first. That holds below the frequency of
/// the bodies on their contacts, [`body_frequency`](Self::body_frequency), and for bodies with little of
/// the kinetic energy, [`inertia_shares`](Self::inertia_shares): a heavy body on one stiff contact has a high
/// frequency and moves with what it is in contact with. On the paper's rig frequencies change by 3e-4.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_harmonic::{CondensedStack, LawEvaluation};
/// use asperity_law::Power;
/// use asperity_mesh::{Body, Interface, Stack, Support};
/// use asperity_structure::{Damping, PreloadedStructure};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let law = Arc::new(Power::new(1.81e10, 0.35, 0.0)?);
/// let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
/// let sample = Body::new("sample", 0.015, 1.15e-4, 71e9, 2710.0)?;
/// let contact = |name| Interface::new(name, 1.15e-4, law.clone());
/// let contacts = vec![contact("guide-sample")?, contact("sample-disc")?];
/// let stack = Stack::new(vec![guide, sample], contacts, Support::Rigid, 9.81)?;
/// let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035))?;
///
/// assert_eq!(CondensedStack::candidates(&structure), [1]);
/// assert!(CondensedStack::body_frequency(&structure, 1) > 30e3);
/// assert!(CondensedStack::inertia_shares(&structure, 2e3)?[1] < 0.003);
/// let condensed = CondensedStack::new(&structure, &[1], LawEvaluation::default())?;
/// assert_eq!(condensed.system().contacts().len(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct CondensedStack {
    system: ContactSystem,
    bodies: Vec<usize>,
    /// The interfaces of the stack, from the top down.
    interfaces: Vec<CondensedInterface>,
}

/// An interface of the stack as a part of a contact of the condensed one.
#[derive(Debug, Clone)]
struct CondensedInterface {
    /// The contact of the condensed stack.
    contact: usize,
    /// The pressure of the interface from that of the contact.
    series: SeriesContact,
}

impl CondensedStack {
    /// The bodies that can be condensed, by their places: those between two contacts of equal damping
    /// proportional to the stiffness, or of none, and without friction at either or in a guide. The top
    /// body has no contact above, and keeps its inertia. Internal damping of the body must be that of its contacts.
    pub fn candidates(structure: &PreloadedStructure) -> Vec<usize> {
        let contacts = structure.contacts();
        let alike = |body: &usize| {
            let [above, below] = [&contacts[body - 1], &contacts[*body]];
            let own = structure.stack().bodies()[*body].damping();
            let of_contacts = |time| ContactDamping::kelvin_voigt(time).ok() == above.damping();
            let elastic = own == BodyDamping::NONE;
            let rubs = [above, below].iter().any(|contact| contact.friction().is_some())
                || structure.stack().bodies()[*body].friction().is_some();
            // The slip force of a body above is a share of the force of its contact, which carries
            // tension first.
            let bounds = structure.guides().iter().any(|guide| {
                guide.contact() + 1 == *body && guide.friction().share_of_contact() > 0.0
            }) && above.law().domain().is_bilateral();
            !rubs
                && !bounds
                && (elastic || own.retardation_time().is_some_and(of_contacts))
                && above.damping() == below.damping()
                && above.damping().is_none_or(|damping| damping.is_proportional_to_stiffness())
        };
        (1..contacts.len()).filter(alike).collect()
    }

    /// Frequency \[Hz\] of a rigid body on its contacts at rest, `sqrt((k_above + k_below) / m)`, the
    /// other bodies at rest; NaN for a body that does not exist or is the top one.
    pub fn body_frequency(structure: &PreloadedStructure, body: usize) -> f64 {
        let contacts = structure.contacts();
        let (Some(above), Some(below), Some(own)) = (
            body.checked_sub(1).and_then(|above| contacts.get(above)),
            contacts.get(body),
            structure.stack().bodies().get(body),
        ) else {
            return f64::NAN;
        };
        ((above.spring() + below.spring()) / own.mass()).sqrt() / TAU
    }

    /// Largest share of each body, from the top, in the kinetic energy of a mode up to `highest` \[Hz\], at
    /// least of the lowest mode,
    ///
    /// ```text
    /// m u^2 / phi^T M phi,
    /// ```
    ///
    /// with u the largest displacement of its own faces and of those opposite. Without inertia a body moves
    /// between the faces opposite, whichever contact is open, so the share bounds its inertia at every amplitude.
    /// By Rayleigh's quotient a natural frequency changes by half the share of the bodies left out, and the
    /// response at resonance as much.
    ///
    /// # Errors
    /// [`HarmonicError::Structure`] where the modes cannot be computed.
    pub fn inertia_shares(
        structure: &PreloadedStructure,
        highest: f64,
    ) -> Result<Vec<f64>, HarmonicError> {
        let bodies = structure.stack().bodies();
        let mut modes = structure.modes(1)?;
        while modes.len() < MOST_MODES
            && modes.last().is_some_and(|mode| mode.frequency_hz <= highest)
        {
            modes = structure.modes(2 * modes.len())?;
        }
        let share = |(number, body): (usize, &Body)| {
            let of = |mode: &LinearisedMode| {
                let own = mode.faces[number];
                let above = number.checked_sub(1).map_or(0.0, |above| mode.faces[above].1);
                let below = mode.faces.get(number + 1).map_or(mode.support, |below| below.0);
                let faces = [own.0, own.1, above, below];
                let largest = faces.into_iter().fold(0.0, |most: f64, u| most.max(u.abs()));
                body.mass() * largest * largest / mode.modal_mass_kg
            };
            let counts =
                |(i, mode): &(usize, &LinearisedMode)| *i == 0 || mode.frequency_hz <= highest;
            let within = modes.iter().enumerate().filter(counts);
            within.map(|(_, mode)| of(mode)).fold(0.0, f64::max)
        };
        Ok(bodies.iter().enumerate().map(share).collect())
    }

    /// The stack of `structure` with these `bodies` condensed, by their places from the top.
    ///
    /// # Errors
    /// [`HarmonicError::NotCondensable`] for a body that is not among the
    /// [`candidates`](Self::candidates); those of [`ContactSystem::new`].
    pub fn new(
        structure: &PreloadedStructure,
        bodies: &[usize],
        evaluation: LawEvaluation,
    ) -> Result<Self, HarmonicError> {
        let candidates = Self::candidates(structure);
        if let Some(&body) = bodies.iter().find(|body| !candidates.contains(body)) {
            return Err(HarmonicError::NotCondensable { body });
        }
        let stack = structure.stack();
        let (mut kept, mut contacts, mut interfaces) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        for (last, _) in stack.bodies().iter().enumerate() {
            if bodies.contains(&(last + 1)) {
                continue;
            }
            kept.push(stack.bodies()[first].clone());
            let own = condense(structure, first, last)?;
            let number = contacts.len();
            contacts.push(own.contact);
            let parts = own.parts.into_iter();
            interfaces.extend(parts.map(|series| CondensedInterface { contact: number, series }));
            first = last + 1;
        }
        let joints = contacts.iter().map(|contact| {
            Interface::new(contact.name(), contact.area(), Arc::clone(contact.law()))
        });
        let joints = joints.collect::<Result<Vec<_>, _>>().map_err(mesh)?;
        // The bodies as a linear system: the contacts keep the weights of all.
        let support = *stack.support();
        let stack = Stack::new(kept, joints, support, stack.gravity()).map_err(mesh)?;
        let rate = Damping::Rate(structure.damping_rate());
        let linear = match structure.modal_ratios() {
            Some((ratios, other)) => {
                PreloadedStructure::new(stack, rate)?.with_modal_damping(ratios, other)?
            }
            None => PreloadedStructure::new(stack, rate)?,
        };
        let system = ContactSystem::new(Arc::new(linear), contacts, evaluation)?;
        Ok(Self { system, bodies: bodies.to_vec(), interfaces })
    }

    /// The condensed system with its load and its sensors at these ports of the whole stack. A base
    /// acceleration acts on the bodies that keep their inertia.
    ///
    /// # Errors
    /// [`HarmonicError::NotCondensable`] for a port of a condensed body; those of
    /// [`ContactSystem::with_ports`].
    pub fn with_ports(self, load: Port, sensors: &[Port]) -> Result<Self, HarmonicError> {
        let place = |body: usize| {
            let above = self.bodies.iter().filter(|&&own| own < body).count();
            let condensed = self.bodies.contains(&body);
            if condensed { Err(HarmonicError::NotCondensable { body }) } else { Ok(body - above) }
        };
        let port = |port: &Port| match *port {
            Port::Point { body, position } => Ok(Port::Point { body: place(body)?, position }),
            Port::Mean { body } => Ok(Port::Mean { body: place(body)? }),
            other => Ok(other),
        };
        let sensors = sensors.iter().map(port).collect::<Result<Vec<_>, HarmonicError>>()?;
        let system = self.system.clone().with_ports(port(&load)?, &sensors)?;
        Ok(Self { system, ..self })
    }

    /// The condensed system: its contacts are fewer than those of the stack.
    pub fn system(&self) -> &ContactSystem {
        &self.system
    }

    /// The bodies condensed, by their places from the top.
    pub fn bodies(&self) -> &[usize] {
        &self.bodies
    }

    /// Extremes of the pressure at each interface of the stack over a response of the condensed system.
    pub fn pressures(&self, response: &PeriodicResponse) -> Vec<PressureRange> {
        let range = |interface: &CondensedInterface| {
            let whole = response.pressures[interface.contact];
            let [lowest, highest] =
                [whole.lowest, whole.highest].map(|p| interface.series.pressure(p));
            let separates = interface.series.law.domain().separates();
            PressureRange { lowest, highest, contact_lost: separates && lowest <= 0.0 }
        };
        self.interfaces.iter().map(range).collect()
    }
}

/// A contact that stands for some, with the pressure of each.
struct Condensed {
    contact: PreloadedContact,
    parts: Vec<SeriesContact>,
}

/// Interfaces `first` to `last` as one contact, the bodies between them condensed.
fn condense(
    structure: &PreloadedStructure,
    first: usize,
    last: usize,
) -> Result<Condensed, HarmonicError> {
    let own = &structure.contacts()[first..=last];
    let part = |contact: &PreloadedContact| SeriesContact::new(Arc::clone(contact.law()));
    if let [contact] = own {
        return Ok(Condensed { contact: contact.clone(), parts: vec![part(contact)] });
    }
    // The pressure of the series is that of the contact lost first, the uppermost without tension.
    let lost_first = own.iter().find(|contact| !contact.law().domain().is_bilateral());
    let reference = lost_first.unwrap_or(&own[0]);
    let parts: Vec<SeriesContact> = own
        .iter()
        .map(|contact| {
            let pressure_ratio = reference.area() / contact.area();
            let offset = contact.pressure() - pressure_ratio * reference.pressure();
            let rounding = offset.abs() <= ROUNDING * contact.pressure();
            let pressure_offset = if rounding { 0.0 } else { offset };
            SeriesContact { pressure_ratio, pressure_offset, ..part(contact) }
        })
        .collect();
    let bodies = &structure.stack().bodies()[first + 1..=last];
    let flexibility: f64 = bodies.iter().map(|body| body.length() / body.axial_rigidity()).sum();
    let names: Vec<&str> = own.iter().map(PreloadedContact::name).collect();
    let name = names.join(" + ");
    let named = |source| HarmonicError::Law { interface: name.clone(), source };
    let law = LawsInSeries::new(parts.clone(), reference.area() * flexibility).map_err(named)?;
    let contact =
        PreloadedContact::new(&name, reference.area(), Arc::new(law), reference.pressure())?;
    Ok(Condensed { contact: contact.with_damping(reference.damping()), parts })
}

fn mesh(error: asperity_mesh::MeshError) -> HarmonicError {
    HarmonicError::Structure(error.into())
}
