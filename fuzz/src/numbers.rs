//! Numbers, laws and small scenarios from bytes.

use serde_json::{Value, json};

/// A stream of numbers; zeros follow its end.
#[derive(Debug)]
pub struct Numbers<'a>(&'a [u8]);

impl<'a> Numbers<'a> {
    /// The numbers of these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// A number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        self.byte() as usize % end
    }

    /// A number from `low` to `high`, evenly in its logarithm.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let share = f64::from(u16::from_le_bytes([self.byte(), self.byte()])) / 65535.0;
        low * (high / low).powf(share)
    }

    /// Any positive number, most of them within 1e-15 to 1e15.
    pub fn positive(&mut self) -> f64 {
        match self.byte() {
            0 => f64::MIN_POSITIVE,
            1 => f64::from_bits(1),
            2 => f64::MAX,
            3 => self.between(1e-300, 1e300),
            _ => self.between(1e-15, 1e15),
        }
    }

    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// A contact law as JSON, sensible near `pressure` \[Pa\] with `stiffness` \[Pa/m\], or of any
    /// numbers.
    pub fn law(&mut self, pressure: f64, stiffness: f64) -> Value {
        self.nested_law(pressure, stiffness, 3)
    }

    fn nested_law(&mut self, pressure: f64, stiffness: f64, depth: usize) -> Value {
        let wild = self.below(4) == 0;
        let mut near = |value: f64, spread: f64| {
            if wild { self.positive() } else { value * self.between(1.0 / spread, spread) }
        };
        let (stiffness, pressure) = (near(stiffness, 100.0), near(pressure, 100.0));
        let exponent = near(0.5, 4.0);
        let coefficient = if wild { near(1.0, 1.0) } else { stiffness / pressure.powf(exponent) };
        match self.below(if depth == 0 { 7 } else { 8 }) {
            0 => json!({"kind": "constant", "stiffness_pa_per_m": stiffness}),
            1 => json!({"kind": "constant", "stiffness_pa_per_m": stiffness, "unilateral": true}),
            2 => json!({"kind": "power", "coefficient": coefficient, "exponent": exponent}),
            3 => {
                let top = coefficient * pressure.powf(exponent);
                let knots = self.points(pressure, top);
                json!({"kind": "modified_power", "coefficient": coefficient, "exponent": exponent,
                       "transition_pa": pressure, "knots": knots})
            }
            4 => json!({"kind": "exponential", "length_m": pressure / stiffness}),
            5 => json!({"kind": "hyperbolic", "stiffness_pa_per_m": stiffness,
                        "closure_limit_m": pressure / stiffness}),
            6 => json!({"kind": "table", "points": self.points(10.0 * pressure, stiffness)}),
            _ => {
                let law = self.nested_law(pressure, stiffness, depth - 1);
                json!({"kind": "in_series", "law": law, "stiffness_pa_per_m": stiffness})
            }
        }
    }

    /// One to eight pairs of increasing pressure and stiffness, below these.
    fn points(&mut self, pressure: f64, stiffness: f64) -> Vec<[f64; 2]> {
        let count = 1 + self.below(8);
        let (mut p, mut k) = (0.0, stiffness * self.between(1e-6, 0.1));
        (0..count)
            .map(|_| {
                let point = [p, k];
                p += (pressure - p) * self.between(1e-6, 0.9);
                k += (stiffness - k) * self.between(1e-6, 0.9);
                point
            })
            .collect()
    }

    /// A scenario of one to three bodies with a short run, as JSON.
    pub fn scenario(&mut self) -> Value {
        let count = 1 + self.below(3);
        let mut bodies = Vec::with_capacity(count);
        let mut interfaces = Vec::with_capacity(count);
        let mut above = 0.0;
        for at in 0..count {
            let density = self.between(500.0, 2e4);
            let (length, area) = (self.between(1e-3, 1.0), self.between(1e-6, 1e-2));
            let modulus = self.between(1e8, 1e12);
            above += density * length * area;
            bodies.push(json!({"name": format!("body {at}"), "length_m": length, "area_m2": area,
                               "youngs_modulus_pa": modulus, "density_kg_per_m3": density}));
            let contact = area * self.between(1e-3, 1.0);
            let stiffness = self.between(1e3, 1e11) * above / contact;
            let law = self.law(9.81 * above / contact, stiffness);
            interfaces
                .push(json!({"name": format!("contact {at}"), "area_m2": contact, "law": law}));
        }
        let support = match self.below(2) {
            0 => json!({"kind": "rigid"}),
            _ => json!({"kind": "spring_mass", "stiffness_n_per_m": self.between(1e3, 1e10),
                        "mass_kg": self.between(1e-3, 1e2), "damping_ratio": self.between(1e-4, 2.0)}),
        };
        let sign = if self.below(3) == 0 { -1.0 } else { 1.0 };
        let peak_n = sign * 9.81 * above * self.between(1e-6, 1e4);
        let time = self.between(1e-6, 1e-1);
        let excitation = match self.below(5) {
            0 => json!({"kind": "none"}),
            1 => json!({"kind": "gamma_pulse", "peak_n": peak_n, "rise_s": time}),
            2 => json!({"kind": "half_sine", "peak_n": peak_n, "duration_s": time}),
            3 => json!({"kind": "haversine", "peak_n": peak_n, "duration_s": time}),
            _ => json!({"kind": "harmonic", "amplitude_n": peak_n, "frequency_hz": 1.0 / time}),
        };
        let output_rate_hz = self.between(1e2, 1e6);
        json!({
            "schema": "asperity/scenario/1",
            "bodies": bodies,
            "interfaces": interfaces,
            "support": support,
            "damping": {"kind": "mass_proportional", "ratio": self.between(1e-4, 1.0)},
            "excitation": excitation,
            "output_rate_hz": output_rate_hz,
            "duration_s": self.between(20.0, 300.0) / output_rate_hz,
        })
    }
}
