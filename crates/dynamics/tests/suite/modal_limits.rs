//! Hard steps, laws and forces for modal steps: each is right, against finite differences, or refused.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::support::agreement::{agrees, attempt, off};
use crate::support::{Law, constant, every_law, exponential, modified, power, pulse, rig};
use asperity_dynamics::{DynamicsError, Modal};
use asperity_law::{Constant, ContactLaw, Hyperbolic, Tabulated};
use asperity_mesh::{Stack, Support};
use asperity_structure::{LoadCase, TimeFunction};

/// Steps from 1 us to 1 ms, as a user may give them: each answer is as good as its energy balance
/// says, or there is none.
#[test]
fn a_step_too_long_is_an_error_or_shows_in_the_energy() {
    let unilateral: Law = Arc::new(Constant::unilateral(8.5e11).unwrap());
    let cases = [
        ("modified", rig(&modified()), 20.0),
        ("constant", rig(&constant()), 20.0),
        ("power", rig(&power()), 32.0),
        ("unilateral", rig(&unilateral), 32.0),
        ("hyperbolic", rig(&every_law()[7].1), 20.0),
    ];
    for (name, stack, peak) in cases {
        let at = |step: f64| {
            let method = Modal { step: Some(step), modes_per_body: Some(3), ..Modal::default() };
            // What bounces on a kink forgets its past soon.
            let duration = if name == "unilateral" { 1e-3 } else { 6e-3 };
            attempt(&stack, method, &pulse(peak), duration)
        };
        let fine = at(1e-7).unwrap();
        let (mut accepted, mut refused) = (0, 0);
        for n in 0..=36 {
            let step = 1e-6 * 10.0_f64.powf(f64::from(n) / 12.0);
            match at(step) {
                Ok(run) => {
                    accepted += 1;
                    let ((u, _), residual) = (off(&run, &fine), run.energy.residual_relative());
                    // In phase by (w h)^2 / 24 for 6 ms at most, where the pressure is averaged;
                    // what bounces forget their past: found 1e-2.
                    let turn = TAU * 832.0 * step;
                    let phase = turn * turn / 24.0 * TAU * 832.0 * 6e-3;
                    assert!(u < 1e-2 + 1.5 * phase + 2.0 * residual, "{name} {step:e}: {u:e}");
                }
                Err(DynamicsError::Coarse { .. }) => {
                    refused += 1;
                }
                Err(error) => {
                    refused += 1;
                    assert!(matches!(error, DynamicsError::Setting { .. }), "{error:?}");
                    assert!(step > 3e-5, "{name} {step:e}: {error}");
                }
            }
        }
        assert!(accepted >= 8 && refused >= 9, "{name}: {accepted} and {refused}");
    }
}

/// A table with slopes that jump by a factor of hundreds, and a unilateral spring that is hit.
#[test]
fn laws_with_kinks() {
    let points = [(0.0, 1e10), (1e5, 1e10), (1.2e5, 5e12), (2e5, 5e12), (2.1e5, 2e10), (1e6, 2e10)];
    let abrupt: Law = Arc::new(Tabulated::new(&points).unwrap());
    let unilateral = every_law()[1].1.clone();
    agrees("abrupt", &rig(&abrupt), &pulse(20.0), (3e-3, 0.5e-3), (5e-3, 0.1));
    agrees("unilateral", &rig(&unilateral), &pulse(20.0), (2e-3, 0.5e-3), (1e-2, 0.3));
}

/// Without gravity faces just touch, with no stiffness there is for a power law.
#[test]
fn without_gravity_every_law_that_separates_runs() {
    for (name, law) in every_law() {
        if law.domain().separates() {
            let at = rig(&law);
            let (bodies, interfaces) = (at.bodies().to_vec(), at.interfaces().to_vec());
            let stack = Stack::new(bodies, interfaces, Support::Rigid, 0.0).unwrap();
            agrees(name, &stack, &pulse(20.0), (2e-3, 0.5e-3), (2e-3, 0.1));
        }
    }
}

/// Fifteen decades of force, both ways.
#[test]
fn forces_from_a_nanonewton_to_a_meganewton() {
    for law in [modified(), constant(), exponential()] {
        for peak in [1e-9, -1e-9, 1e-6, 1e-3, -1.0] {
            agrees(&format!("{peak:e} N"), &rig(&law), &pulse(peak), (3e-3, 1e-3), (1e-3, 5e-3));
        }
    }
    for peak in [1e6, -1e6] {
        agrees(&format!("{peak:e} N"), &rig(&constant()), &pulse(peak), (3e-3, 1e-3), (1e-3, 5e-3));
        for (name, law) in every_law() {
            // An error if no table holds such pressures. Displacements are those of flight.
            match attempt(&rig(&law), Modal::default(), &pulse(peak), 3e-3) {
                Ok(run) => {
                    let limit = run.energy.residual_relative();
                    assert!(
                        limit < 2e-2
                            && run.history.sensors[0].displacement.iter().all(|u| u.is_finite())
                    );
                    let lowest = law.domain().pressure_min;
                    assert!(run.contacts.iter().all(|contact| contact.pressure_min >= lowest));
                }
                Err(error) => {
                    assert!(matches!(error, DynamicsError::Law { .. }), "{name}: {error}");
                }
            }
        }
    }
}

/// 17 MPa and 54 times the law's scale of pressure: 0.98 of the closure where it is rigid.
#[test]
fn a_hyperbolic_law_near_its_closure_limit() {
    let law = Hyperbolic::new(3e11, 1e-6).unwrap();
    let run = attempt(&rig(&every_law()[7].1), Modal::default(), &pulse(1e3), 8e-4).unwrap();
    let highest = law.closure(run.contacts[0].pressure_max) / 1e-6;
    assert!(highest > 0.97);
    agrees("hyperbolic", &rig(&every_law()[7].1), &pulse(1e3), (8e-4, 0.25e-3), (5e-3, 5e-2));
}

/// Down to a thousandth of the static pressure, and far beyond where the faces would part.
#[test]
fn an_exponential_law_pulled_almost_open() {
    for (peak, left) in [(-10.0, 0.4), (-15.0, 0.03), (-16.5, 1e-3), (-40.0, 1e-5)] {
        let pull = LoadCase::force(TimeFunction::Haversine { duration: 5e-3 }, peak);
        let stack = rig(&exponential());
        let run = attempt(&stack, Modal::default(), &pull, 4e-3).unwrap();
        let share = run.contacts[0].pressure_min / 137_340.0;
        assert!(share > 0.0 && share < left && run.contacts[0].lost == 0.0);
        agrees("exponential", &stack, &pull, (4e-3, 0.5e-3), (1e-3, 1e-2));
    }
}
