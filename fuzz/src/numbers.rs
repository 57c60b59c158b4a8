//! Numbers, laws and small scenarios from bytes.

use asperity_law::{Draw, LawSpec};
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
        low * (high / low).powf(self.unit())
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

    /// A contact law of the list of all kinds as JSON, sensible near `pressure` \[Pa\] with `stiffness`
    /// \[Pa/m\], or with some numbers replaced by any others.
    pub fn law(&mut self, pressure: f64, stiffness: f64) -> Value {
        let wild = self.below(4) == 0;
        let law = LawSpec::sample(self, pressure, stiffness, 3);
        let mut law = serde_json::to_value(law).expect("a law has a JSON form");
        if wild {
            self.replace_some(&mut law);
        }
        law
    }

    fn replace_some(&mut self, value: &mut Value) {
        match value {
            Value::Number(_) if self.below(2) == 0 => *value = json!(self.positive()),
            Value::Array(values) => values.iter_mut().for_each(|value| self.replace_some(value)),
            Value::Object(entries) => {
                entries.values_mut().for_each(|value| self.replace_some(value));
            }
            _ => {}
        }
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
        let excitation = match self.below(6) {
            0 => json!({"kind": "none"}),
            1 => {
                let acceleration = json!({"kind": "haversine", "peak_m_per_s2": peak_n / above, "duration_s": time});
                json!({"kind": "base_motion", "acceleration": acceleration})
            }
            kind => {
                let mut force = match kind {
                    2 => json!({"kind": "gamma_pulse", "peak_n": peak_n, "rise_s": time}),
                    3 => json!({"kind": "half_sine", "peak_n": peak_n, "duration_s": time}),
                    4 => json!({"kind": "haversine", "peak_n": peak_n, "duration_s": time}),
                    _ => {
                        json!({"kind": "harmonic", "amplitude_n": peak_n, "frequency_hz": 1.0 / time})
                    }
                };
                force["at"] = self.place(&bodies);
                force
            }
        };
        let sensor = json!({"name": "sensor", "at": self.place(&bodies), "kind": "acceleration"});
        let output_rate_hz = self.between(1e2, 1e6);
        json!({
            "schema": "asperity/scenario/1",
            "bodies": bodies,
            "interfaces": interfaces,
            "support": support,
            "damping": {"kind": "mass_proportional", "ratio": self.between(1e-4, 1.0)},
            "excitation": excitation,
            "sensors": [sensor],
            "output_rate_hz": output_rate_hz,
            "duration_s": self.between(20.0, 300.0) / output_rate_hz,
        })
    }
}

impl Numbers<'_> {
    /// A place on one of `bodies` as JSON.
    fn place(&mut self, bodies: &[Value]) -> Value {
        let body = &bodies[self.below(bodies.len())];
        match self.below(3) {
            0 => json!({"body": body["name"], "end": "upper"}),
            1 => json!({"body": body["name"], "end": "lower"}),
            _ => {
                let length = body["length_m"].as_f64().expect("a body has a length");
                json!({"body": body["name"], "position_m": self.unit() * length})
            }
        }
    }
}

impl Draw for Numbers<'_> {
    fn unit(&mut self) -> f64 {
        f64::from(u16::from_le_bytes([self.byte(), self.byte()])) / 65536.0
    }
}
