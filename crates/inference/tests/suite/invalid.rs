//! Errors of invalid input.

use asperity_inference::{
    FitOptions, FunctionModel, InferenceError, Loss, Observation, Parameter, ParameterScale, Prior,
    fit,
};

use crate::models::linear;

fn error_of(
    parameters: Vec<Parameter>,
    values: &[f64],
    sd: f64,
    options: FitOptions,
) -> InferenceError {
    let count = values.len();
    let model = FunctionModel {
        parameters,
        observations: Observation::list(values, sd),
        function: move |x: &[f64]| vec![x[0]; count],
    };
    fit(&model, &options).unwrap_err()
}

#[test]
fn invalid_input_has_its_error() {
    let (x, y) = (linear("x", 0.0, [-1.0, 1.0]), linear("y", 0.0, [-1.0, 1.0]));
    let plain = FitOptions::default();
    let one = || vec![x.clone()];
    assert_eq!(error_of(Vec::new(), &[1.0], 1.0, plain), InferenceError::NoParameters);
    assert_eq!(error_of(one(), &[], 1.0, plain), InferenceError::NoObservations);
    let twice = error_of(vec![x.clone(), x.clone()], &[1.0, 1.0], 1.0, plain);
    assert_eq!(twice, InferenceError::DuplicateName("x".into()));
    let few = error_of(vec![x.clone(), y], &[1.0], 1.0, plain);
    assert_eq!(few, InferenceError::TooFew { observations: 1, priors: 0, parameters: 2 });
    assert!(matches!(error_of(one(), &[f64::NAN], 1.0, plain), InferenceError::Observation { .. }));
    assert!(matches!(error_of(one(), &[1.0], 0.0, plain), InferenceError::Observation { .. }));
    for options in [
        FitOptions { starts: 0, ..plain },
        FitOptions { tolerance: f64::NAN, ..plain },
        FitOptions { difference_step: 0.5, ..plain },
        FitOptions { max_iterations: 0, ..plain },
        FitOptions { loss: Loss::Huber { threshold: 0.0 }, ..plain },
    ] {
        let error = error_of(one(), &[1.0], 1.0, options);
        assert!(matches!(error, InferenceError::Option { .. }), "{error}");
    }
}

#[test]
fn parameters_are_checked_at_construction() {
    let new = |start, bounds, scale, prior| Parameter::new("k", start, bounds, scale, prior);
    let prior = |mean, standard_deviation| Some(Prior { mean, standard_deviation });
    let (log, linear) = (ParameterScale::Logarithmic, ParameterScale::Linear);
    assert!(matches!(new(1.0, [0.0, 2.0], log, None), Err(InferenceError::Bounds { .. })));
    assert!(matches!(new(1.0, [2.0, 0.0], linear, None), Err(InferenceError::Bounds { .. })));
    assert!(matches!(new(1.0, [0.0, f64::NAN], linear, None), Err(InferenceError::Bounds { .. })));
    assert!(matches!(new(3.0, [0.0, 2.0], linear, None), Err(InferenceError::Start { .. })));
    assert!(matches!(new(f64::NAN, [0.0, 2.0], linear, None), Err(InferenceError::Start { .. })));
    assert!(matches!(
        new(1.0, [0.0, 2.0], linear, prior(0.0, 0.0)),
        Err(InferenceError::Prior { .. })
    ));
    assert!(matches!(
        new(1.0, [0.0, 2.0], linear, prior(f64::NAN, 1.0)),
        Err(InferenceError::Prior { .. })
    ));
    assert!(new(1.0, [0.5, 2.0], log, prior(0.0, 1.0)).is_ok());
}
