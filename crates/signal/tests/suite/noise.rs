//! Noise from a fixed seed.

/// A small generator of normal numbers: the same sequence on every machine.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Uniform in (0, 1): splitmix64 (Steele, Lea and Flood 2014).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        ((z >> 11) as f64 + 0.5) / 2.0_f64.powi(53)
    }

    /// Normal with mean zero and deviation one: Box and Muller 1958.
    pub(crate) fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }

    /// Samples with normal noise of this deviation added.
    pub(crate) fn added_to(&mut self, samples: &[f64], deviation: f64) -> Vec<f64> {
        samples.iter().map(|x| x + deviation * self.normal()).collect()
    }
}
