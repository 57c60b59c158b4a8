//! Convergence diagnostics against chains whose properties are known.

use asperity_inference::{effective_sample_size, r_hat};

use crate::models::Noise;

/// First-order autoregressive chains with unit variance.
fn autoregressive(correlation: f64, chains: u64, length: usize, apart: f64) -> Vec<Vec<f64>> {
    let innovation = (1.0 - correlation * correlation).sqrt();
    let chain = |k: u64| {
        let mut noise = Noise(17 + 1000 * k);
        let mut state = noise.normal();
        let step = |_| {
            state = correlation * state + innovation * noise.normal();
            state + apart * k as f64
        };
        (0..length).map(step).collect()
    };
    (0..chains).map(chain).collect()
}

/// `ESS / N = (1 - rho) / (1 + rho)` exactly. The estimate of the time sums about `W = 5 tau`
/// lags, which spreads it by `sqrt(2 (2 W + 1) / N)`: 3 % at rho = 0.6, 6 % at 0.9; four of
/// these are allowed.
#[test]
fn the_effective_sample_size_of_autoregressive_chains_is_exact() {
    for (correlation, allowed) in [(0.0, 0.06), (0.6, 0.13), (0.9, 0.25)] {
        let chains = autoregressive(correlation, 4, 20_000, 0.0);
        let share = effective_sample_size(&chains) / 80_000.0;
        let expected = (1.0 - correlation) / (1.0 + correlation);
        assert!((share / expected - 1.0).abs() < allowed, "{correlation}: {share}, {expected}");
        assert!(r_hat(&chains) < 1.01);
    }
}

#[test]
fn stuck_chains_are_seen() {
    // Each chain looks fine alone, but they sit three deviations apart.
    assert!(r_hat(&autoregressive(0.3, 4, 2000, 3.0)) > 1.5);
    // One chain that drifts: its halves differ.
    let drift: Vec<f64> = autoregressive(0.0, 1, 2000, 0.0)[0]
        .iter()
        .enumerate()
        .map(|(n, x)| x + n as f64 / 300.0)
        .collect();
    assert!(r_hat(&[drift]) > 1.3);
    // Nothing moves at all.
    assert!(r_hat(&[vec![1.0; 100], vec![2.0; 100]]) > 1e3);
    assert!(r_hat(&[vec![1.0; 100], vec![1.0; 100]]).is_nan());
    assert!(r_hat(&[vec![1.0, 2.0]]).is_nan() && r_hat(&[]).is_nan());
}
