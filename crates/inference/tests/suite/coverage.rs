//! Intervals hold the truth as often as they say.

use asperity_inference::{FitOptions, FunctionModel, Observation, ProfileOptions, fit};

use crate::models::{Noise, linear};

/// A decay `a exp(-b t)` measured 300 times over. The number of intervals at 68.27 % that hold
/// the truth is binomial: 205 with standard deviation 8.1; four of these are allowed, so that a
/// correct program fails less than once in ten thousand seeds.
#[test]
fn intervals_cover_as_often_as_they_say() {
    const TRIALS: usize = 300;
    const LEVEL: f64 = 0.682_689_492_137_086;
    let (truth, deviation) = ([2.0, 0.8], 0.05);
    let decay = |x: &[f64]| (0..12).map(|i| x[0] * (-x[1] * 0.3 * f64::from(i)).exp()).collect();
    let exact: Vec<f64> = decay(&truth);
    let mut noise = Noise(11);
    let (mut normal, mut profiled) = ([0_usize; 2], 0_usize);
    for _ in 0..TRIALS {
        let values: Vec<f64> = exact.iter().map(|y| y + deviation * noise.normal()).collect();
        let model = FunctionModel {
            parameters: vec![linear("a", 1.0, [-40.0, 40.0]), linear("b", 0.5, [-10.0, 10.0])],
            observations: Observation::list(&values, deviation),
            function: decay,
        };
        let found = fit(&model, &FitOptions::default()).unwrap();
        let spread = found.covariance().unwrap();
        for j in 0..2 {
            let [low, high] = spread.interval(j, LEVEL).unwrap();
            normal[j] += usize::from((low..=high).contains(&truth[j]));
        }
        let options = ProfileOptions { level: LEVEL, ..ProfileOptions::default() };
        let [low, high] = found.profile(&spread, &[1], &options).unwrap()[0].interval;
        profiled += usize::from((low..=high).contains(&truth[1]));
    }
    let mean = TRIALS as f64 * LEVEL;
    let bound = 4.0 * (mean * (1.0 - LEVEL)).sqrt();
    for covered in [normal[0], normal[1], profiled] {
        assert!((covered as f64 - mean).abs() < bound, "{covered} of {TRIALS}, {mean} expected");
    }
}
