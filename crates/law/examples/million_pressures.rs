//! Time of a million stiffnesses of a power law, in seconds: the reference of
//! `crates/python/benches/speed.py`.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use asperity_law::{ContactLaw, LawError, Power};

const COUNT: usize = 1_000_000;
const ROUNDS: usize = 20;

fn main() -> Result<(), LawError> {
    let law: Arc<dyn ContactLaw> = Arc::new(Power::new(1.81e10, 0.35, 0.0)?);
    let pressures: Vec<f64> = (0..COUNT).map(|i| 1e6 * i as f64 / COUNT as f64).collect();
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let started = Instant::now();
        let found: Vec<f64> = black_box(&pressures).iter().map(|&p| law.stiffness(p)).collect();
        black_box(&found);
        drop(found);
        best = best.min(started.elapsed().as_secs_f64());
    }
    #[expect(clippy::print_stdout, reason = "the answer of an example")]
    {
        println!("{best}");
    }
    Ok(())
}
