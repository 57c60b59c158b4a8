//! Receptance at any frequency by a direct Fourier sum, and its peaks.

use asperity_dynamics::History;
use faer::c64;

/// `sum x_n exp(-i 2 pi f n dt) dt`, with no grid of frequencies.
pub fn transform(samples: &[f64], interval: f64, frequency: f64) -> c64 {
    let turn = c64::cis(-std::f64::consts::TAU * frequency * interval);
    let mut phase = c64::new(1.0, 0.0);
    let mut sum = c64::new(0.0, 0.0);
    for &sample in samples {
        sum += phase * sample;
        phase *= turn;
    }
    sum * interval
}

/// A peak of the receptance.
#[derive(Debug, Clone, Copy)]
pub struct Peak {
    pub frequency: f64,
    pub magnitude: f64,
}

/// `|U(f) / F(f)|` [m/N] over the whole history.
pub fn magnitude(history: &History, frequency: f64) -> f64 {
    let interval = history.time[1];
    let over = history.load.iter().rposition(|&f| f != 0.0).map_or(0, |last| last + 1);
    let displacement = transform(&history.sensors[0].displacement, interval, frequency);
    displacement.norm() / transform(&history.load[..over], interval, frequency).norm()
}

/// The highest true local maximum of the receptance between two frequencies,
/// or none: the ends of the range are no peaks. Scanned every 2 Hz, a quarter
/// of the width of the window's main lobe, then refined by golden section.
pub fn peak(history: &History, (low, high): (f64, f64)) -> Option<Peak> {
    let scan_step = 2.0;
    let count = ((high - low) / scan_step) as usize;
    let at = |i: usize| low + i as f64 * scan_step;
    let scan: Vec<f64> = (0..=count).map(|i| magnitude(history, at(i))).collect();
    let top = (1..count)
        .filter(|&i| scan[i] >= scan[i - 1] && scan[i] > scan[i + 1])
        .max_by(|&a, &b| scan[a].total_cmp(&scan[b]))?;
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (at(top - 1), at(top + 1));
    // 30 steps leave 4 Hz * 0.618^30, 2 uHz.
    for _ in 0..30 {
        let (left, right) = (b - golden * (b - a), a + golden * (b - a));
        if magnitude(history, left) > magnitude(history, right) { b = right } else { a = left }
    }
    let frequency = 0.5 * (a + b);
    Some(Peak { frequency, magnitude: magnitude(history, frequency) })
}
