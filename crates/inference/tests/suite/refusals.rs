//! What is refused, and how it is said.

use asperity_inference::{FitOptions, IdentifyError, Loss, Prior, Scale, Unknown, fit};

use crate::models::{Formula, linear, observations, silent};

fn refused(unknowns: Vec<Unknown>, values: &[f64], sd: f64, options: FitOptions) -> IdentifyError {
    let count = values.len();
    let model = Formula {
        unknowns,
        observations: observations(values, sd),
        predict: move |x: &[f64]| vec![x[0]; count],
    };
    fit(&model, &options, &silent).unwrap_err()
}

#[test]
fn impossible_requests_are_named() {
    let (x, y) = (linear("x", 0.0, [-1.0, 1.0]), linear("y", 0.0, [-1.0, 1.0]));
    let plain = FitOptions::default();
    let one = || vec![x.clone()];
    assert_eq!(refused(Vec::new(), &[1.0], 1.0, plain), IdentifyError::NoUnknowns);
    assert_eq!(refused(one(), &[], 1.0, plain), IdentifyError::NoObservations);
    let twice = refused(vec![x.clone(), x.clone()], &[1.0, 1.0], 1.0, plain);
    assert_eq!(twice, IdentifyError::DuplicateName { name: "x".into() });
    let few = refused(vec![x.clone(), y], &[1.0], 1.0, plain);
    assert_eq!(few, IdentifyError::TooFew { observations: 1, priors: 0, unknowns: 2 });
    assert!(matches!(refused(one(), &[f64::NAN], 1.0, plain), IdentifyError::Observation { .. }));
    assert!(matches!(refused(one(), &[1.0], 0.0, plain), IdentifyError::Observation { .. }));
    for options in [
        FitOptions { starts: 0, ..plain },
        FitOptions { tolerance: f64::NAN, ..plain },
        FitOptions { difference_step: 0.5, ..plain },
        FitOptions { most_iterations: 0, ..plain },
        FitOptions { loss: Loss::Huber { threshold: 0.0 }, ..plain },
    ] {
        let error = refused(one(), &[1.0], 1.0, options);
        assert!(matches!(error, IdentifyError::Option { .. }), "{error}");
    }
}

#[test]
fn unknowns_are_checked_when_they_are_made() {
    let new = |start, bounds, scale, prior| Unknown::new("k", start, bounds, scale, prior);
    let prior = |mean, standard_deviation| Some(Prior { mean, standard_deviation });
    let (log, linear) = (Scale::Logarithmic, Scale::Linear);
    assert!(matches!(new(1.0, [0.0, 2.0], log, None), Err(IdentifyError::Bounds { .. })));
    assert!(matches!(new(1.0, [2.0, 0.0], linear, None), Err(IdentifyError::Bounds { .. })));
    assert!(matches!(new(1.0, [0.0, f64::NAN], linear, None), Err(IdentifyError::Bounds { .. })));
    assert!(matches!(new(3.0, [0.0, 2.0], linear, None), Err(IdentifyError::Start { .. })));
    assert!(matches!(new(f64::NAN, [0.0, 2.0], linear, None), Err(IdentifyError::Start { .. })));
    assert!(matches!(
        new(1.0, [0.0, 2.0], linear, prior(0.0, 0.0)),
        Err(IdentifyError::Prior { .. })
    ));
    assert!(matches!(
        new(1.0, [0.0, 2.0], linear, prior(f64::NAN, 1.0)),
        Err(IdentifyError::Prior { .. })
    ));
    assert!(new(1.0, [0.5, 2.0], log, prior(0.0, 1.0)).is_ok());
}
