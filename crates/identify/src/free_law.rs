//! A law without an assumed form.
//!
//! At the pressures `p[0] < ... < p[n]`, evenly spaced in `ln p`, the law is
//!
//! ```text
//! ln K[i+1] - ln K[i] = s(g[i]) (ln p[i+1] - ln p[i]),    g[i] = g0[i] + r[i],
//! ln K(p*) = ln K0(p*) + level,
//! ```
//!
//! with the slope `s` as an increasing function of `g`, the scenario's law `K0` and its `g0`, a Gaussian
//! process `r` in `ln p` and a normal number `level`. Where other parameters are numbers of the scenario's
//! law, `g0` belongs to the law that they give: a form with unknown numbers, a smooth deviation from it, and
//! a level of its own. Every law is positive and increasing; where it is to
//! be concave, `g` is the exponent of the fall of its secants instead of the slope (`rises`). The process
//! has a derivative (Matérn 3/2) or is only continuous (Matérn 1/2, the covariance of a slope that jumps
//! at random pressures: laws with kinks), and amplitude (roughness) and length of a distribution over a
//! grid: the prior of the latents is a mixture of normal distributions.

mod rises;

use asperity_inference::{
    LatentBasis, LatentPrior, Parameter, matern_one_half, matern_three_halves,
};
use asperity_scenario::{JsonPointer, Laws, four_digits};
use serde_json::{Value, json};

use crate::error::IdentificationError;
use crate::problem::{LogNormalSpec, ParameterSpec, SlopeSmoothness};
use crate::scenario_laws::stiffness_curve;
use rises::Rises;

/// Places of the grid of a logarithm, in standard deviations.
const GRID: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];

/// Largest difference of slopes that are the same but for rounding.
const SAME_SLOPE: f64 = 1e-9;

/// Relative variance by which the covariance of neighbouring slopes is positive definite.
const NUGGET: f64 = 1e-8;

/// A law without an assumed form, in terms of its latents: the level and the slopes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FreeLaw {
    /// Name of the law.
    pub(super) name: String,
    /// Pointer to the law.
    pub(super) pointer: String,
    /// Pressures of the table \[Pa\].
    pub(super) pressures: Vec<f64>,
    /// Index of the pressure of the level.
    anchor: usize,
    /// ln K of the scenario's law there.
    centre: f64,
    /// `g0` between the pressures, of the scenario's law.
    numbers: Vec<f64>,
    /// True if other parameters are numbers of the scenario's law.
    form_is_unknown: bool,
    rises: Rises,
    /// Standard deviation of the level.
    level: f64,
    basis: LatentBasis,
    /// The components of the prior: every smoothness with the grid of amplitudes and lengths.
    pub(super) components: Vec<PriorComponent>,
}

/// Smoothness, amplitude and length of one component of the prior, with its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PriorComponent {
    pub(super) smoothness: SlopeSmoothness,
    pub(super) roughness: f64,
    pub(super) length: f64,
    weight: f64,
}

impl PriorComponent {
    /// The components of unknown amplitude, length and smoothness.
    fn grid(
        roughness: &LogNormalSpec,
        length: &LogNormalSpec,
        smoothness: &[SlopeSmoothness],
    ) -> Vec<Self> {
        let places = |spec: &LogNormalSpec| -> Vec<(f64, f64)> {
            if spec.log_deviation == 0.0 {
                return vec![(spec.median, 1.0)];
            }
            let place =
                |z: &f64| (spec.median * (spec.log_deviation * z).exp(), (-0.5 * z * z).exp());
            GRID.iter().map(place).collect()
        };
        let (amplitudes, lengths) = (places(roughness), places(length));
        let mut grid = Vec::new();
        for &smoothness in smoothness {
            for &(roughness, weight) in &amplitudes {
                grid.extend(lengths.iter().map(|&(length, other)| Self {
                    smoothness,
                    roughness,
                    length,
                    weight: weight * other,
                }));
            }
        }
        grid
    }

    /// Covariance of the deviations of the slopes at places in ln p.
    fn covariance(&self, places: &[f64]) -> Vec<Vec<f64>> {
        let mut covariance = match self.smoothness {
            SlopeSmoothness::Differentiable => matern_three_halves(places, self.length),
            SlopeSmoothness::Continuous => matern_one_half(places, self.length),
        };
        for (i, row) in covariance.iter_mut().enumerate() {
            row[i] += NUGGET;
            for entry in row {
                *entry *= self.roughness.powi(2);
            }
        }
        covariance
    }
}

/// The latents of deviations of slopes with the mean covariance of some components.
fn basis(
    components: &[PriorComponent],
    weights: &[f64],
    places: &[f64],
) -> Result<LatentBasis, IdentificationError> {
    let mut mean = vec![vec![0.0; places.len()]; places.len()];
    let total: f64 = weights.iter().sum();
    for (component, weight) in components.iter().zip(weights) {
        let own = component.covariance(places);
        let pairs = mean.iter_mut().flatten().zip(own.iter().flatten());
        pairs.for_each(|(sum, entry)| *sum += weight / total * entry);
    }
    Ok(LatentBasis::new(&mean)?)
}

impl FreeLaw {
    /// The law that a parameter of the problem describes, with its pressures; `None` for another kind.
    pub(super) fn new(
        spec: &ParameterSpec,
        scenario: &Value,
    ) -> Result<Option<Self>, IdentificationError> {
        let ParameterSpec::FreeLaw {
            law,
            pressures_pa,
            points,
            at_pa,
            level,
            roughness,
            length,
            smoothness,
            exponent_between_0_and_1: below_one,
            concave_above_pa,
        } = spec
        else {
            return Ok(None);
        };
        let refuse = |reason: String| IdentificationError::FreeLaw { law: law.clone(), reason };
        if smoothness.is_empty() || smoothness[1..].contains(&smoothness[0]) || smoothness.len() > 2
        {
            return Err(refuse(
                "smoothness is not a list of different kinds; expected \"differentiable\", \
                 \"continuous\" or both"
                    .to_owned(),
            ));
        }
        let Some([low, high]) = *pressures_pa else {
            return Err(refuse("the pressures are not known; expected pressures_pa".to_owned()));
        };
        if !(low > 0.0 && high > 1.5 * low && high.is_finite()) {
            return Err(refuse(format!(
                "pressures_pa are {low} and {high} Pa; expected a positive one and one at least 1.5 \
                 times as large"
            )));
        }
        let step = (high / low).ln() / (points - 1) as f64;
        let pressures: Vec<f64> = (0..*points).map(|i| low * (step * i as f64).exp()).collect();
        let at = at_pa.unwrap_or((low * high).sqrt());
        let anchor = (((at / low).ln() / step).round().max(0.0) as usize).min(points - 1);
        let first_falling = match *concave_above_pa {
            // The first secant of all pressures from the given one on cannot fall.
            Some(from) => pressures.partition_point(|&pressure| pressure < from) + 1,
            None => points - 1,
        };
        if concave_above_pa.is_some() && first_falling >= points - 1 {
            return Err(refuse(format!(
                "concave_above_pa leaves fewer than three pressures; expected at most {} Pa",
                four_digits(pressures[points - 3])
            )));
        }
        let rises = Rises { step, below_one: *below_one, first_falling };
        let components = PriorComponent::grid(roughness, length, smoothness);
        let weights: Vec<f64> = components.iter().map(|component| component.weight).collect();
        let places = places(points - 1, step);
        let mut found = Self {
            name: law.clone(),
            pointer: JsonPointer::root().child("laws").child(law).to_string(),
            anchor,
            centre: 0.0,
            numbers: Vec::new(),
            form_is_unknown: false,
            rises,
            pressures,
            level: *level,
            basis: basis(&components, &weights, &places)?,
            components,
        };
        (found.centre, found.numbers) = found.form_in(scenario)?;
        Ok(Some(found))
    }

    /// ln K at the pressure of the level, and `g0`, of the law in a scenario.
    fn form_in(&self, scenario: &Value) -> Result<(f64, Vec<f64>), IdentificationError> {
        let refuse =
            |reason: String| IdentificationError::FreeLaw { law: self.name.clone(), reason };
        let laws = scenario.get("laws").cloned().unwrap_or_default();
        let laws: Laws = serde_json::from_value(laws).map_err(|error| refuse(error.to_string()))?;
        let logarithms: Vec<f64> = stiffness_curve(&laws, &self.name, &self.pressures)?
            .iter()
            .map(|stiffness| stiffness.ln())
            .collect();
        if logarithms.iter().any(|value| !value.is_finite()) {
            return Err(refuse(
                "the scenario's law has no positive stiffness at all pressures".to_owned(),
            ));
        }
        let rises: Vec<f64> = logarithms.windows(2).map(|pair| pair[1] - pair[0]).collect();
        Ok((logarithms[self.anchor], self.rises.centre(&rises)))
    }

    /// Marks the form as unknown: the law deviates from the form that other parameters have written.
    pub(super) fn with_unknown_form(&mut self) {
        self.form_is_unknown = true;
    }

    /// True if the forms of both laws have the same slopes.
    pub(super) fn has_slopes_of(&self, other: &Self) -> bool {
        let mut pairs = self.numbers.iter().zip(&other.numbers);
        pairs.all(|(one, other)| (one - other).abs() <= SAME_SLOPE)
    }

    /// The same law in other latents: those that are independent and standard normal under the mean covariance of the
    /// components with these weights.
    pub(super) fn with_weights(&self, weights: &[f64]) -> Result<Self, IdentificationError> {
        let basis = basis(&self.components, weights, &self.places())?;
        Ok(Self { basis, ..self.clone() })
    }

    /// The latents of this law for those of `other`, which differs in its latents alone.
    pub(super) fn latents_of(&self, other: &Self, latents: &[f64]) -> Vec<f64> {
        let slopes = self.basis.latents(&other.basis.values(&latents[1..]));
        std::iter::once(latents[0]).chain(slopes).collect()
    }

    /// The law about the form in a scenario, where its numbers are unknown.
    pub(super) fn about(&self, scenario: &Value) -> Result<Self, IdentificationError> {
        let mut own = self.clone();
        if self.form_is_unknown {
            (_, own.numbers) = self.form_in(scenario)?;
        }
        Ok(own)
    }

    /// Number of latents.
    pub(super) fn count(&self) -> usize {
        self.pressures.len()
    }

    /// The latents as parameters.
    pub(super) fn parameters(&self) -> Vec<Parameter> {
        let name = &self.name;
        let level = Parameter::latent(format!("{name}: level"));
        let slopes = (1..self.count()).map(|i| Parameter::latent(format!("{name}: slope {i}")));
        std::iter::once(level).chain(slopes).collect()
    }

    /// The latents in words.
    pub(super) fn labels(&self) -> Vec<String> {
        let at = four_digits(1e-6 * self.pressures[self.anchor]);
        let level = format!("ln K({at} MPa) of \"{}\"", self.name);
        let slope = |i: usize| format!("latent {i} of the slope of \"{}\"", self.name);
        std::iter::once(level).chain((1..self.count()).map(slope)).collect()
    }

    /// The numbers `g` of the rises of a law about a form with the numbers `g0`.
    fn moved_numbers(&self, form: &[f64], latents: &[f64]) -> Vec<f64> {
        let deviations = self.basis.values(&latents[1..]);
        form.iter().zip(deviations).map(|(centre, r)| centre + r).collect()
    }

    /// ln K at the pressures, of a law about a form with the numbers `g0`.
    fn log_stiffness(&self, form: &[f64], latents: &[f64]) -> Vec<f64> {
        let rises = self.rises.of(&self.moved_numbers(form, latents));
        self.summed(self.centre + self.level * latents[0], &rises)
    }

    /// Derivative of ln K along a change of the latents.
    pub(super) fn log_stiffness_change(&self, latents: &[f64], change: &[f64]) -> Vec<f64> {
        let moved = self.basis.values(&change[1..]);
        let rises = self.rises.change(&self.moved_numbers(&self.numbers, latents), &moved);
        self.summed(self.level * change[0], &rises)
    }

    /// The change of the latents that changes ln K, to first order.
    pub(super) fn latent_change(&self, latents: &[f64], change: &[f64]) -> Vec<f64> {
        let rises: Vec<f64> = change.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let moved = self.rises.inverse_change(&self.moved_numbers(&self.numbers, latents), &rises);
        let level = change[self.anchor] / self.level;
        std::iter::once(level).chain(self.basis.latents(&moved)).collect()
    }

    /// ln K from its value at the anchor and its rises.
    fn summed(&self, level: f64, rises: &[f64]) -> Vec<f64> {
        let mut values = vec![level; self.count()];
        for i in (0..self.anchor).rev() {
            values[i] = values[i + 1] - rises[i];
        }
        for i in self.anchor + 1..values.len() {
            values[i] = values[i - 1] + rises[i - 1];
        }
        values
    }

    /// Writes the law into a scenario, as a table in place of its form.
    ///
    /// # Errors
    /// [`IdentificationError::FreeLaw`] without its place, or for a form without a positive stiffness.
    pub(super) fn write(
        &self,
        scenario: &mut Value,
        latents: &[f64],
    ) -> Result<(), IdentificationError> {
        let values = if self.form_is_unknown {
            self.log_stiffness(&self.form_in(scenario)?.1, latents)
        } else {
            self.log_stiffness(&self.numbers, latents)
        };
        let points: Vec<[f64; 2]> =
            self.pressures.iter().zip(values).map(|(&p, value)| [p, value.exp()]).collect();
        let place = scenario.pointer_mut(&self.pointer).ok_or_else(|| {
            let reason = "the scenario has no such law".to_owned();
            IdentificationError::FreeLaw { law: self.name.clone(), reason }
        })?;
        *place = json!({"kind": "table", "points": points});
        Ok(())
    }

    /// Places in ln p of the slopes.
    fn places(&self) -> Vec<f64> {
        places(self.count() - 1, (self.pressures[1] / self.pressures[0]).ln())
    }

    /// The prior of the latents, which are parameters from index `first` on.
    pub(super) fn prior(&self, first: usize) -> Result<LatentPrior, IdentificationError> {
        let places = self.places();
        let component = |own: &PriorComponent| {
            let slopes = self.basis.latent_covariance(&own.covariance(&places));
            let entry = |i: usize, j: usize| match (i, j) {
                (0, 0) => 1.0,
                (0, _) | (_, 0) => 0.0,
                _ => 0.5 * (slopes[i - 1][j - 1] + slopes[j - 1][i - 1]),
            };
            let row = |i: usize| (0..self.count()).map(|j| entry(i, j)).collect();
            (own.weight, (0..self.count()).map(row).collect())
        };
        let components = self.components.iter().map(component).collect();
        Ok(LatentPrior::new(first, components)?)
    }
}

fn places(count: usize, step: f64) -> Vec<f64> {
    (0..count).map(|i| step * i as f64).collect()
}

#[cfg(test)]
mod tests {
    use asperity_inference::prior_draws;
    use asperity_law::{ContactLaw, Tabulated};

    use super::*;

    /// Exponents between 0 and 1 or not, a law that is concave from 0.1 MPa on or not.
    const SHAPES: [(bool, bool); 4] = [(false, false), (true, false), (false, true), (true, true)];

    fn free((below_one, concave): (bool, bool)) -> FreeLaw {
        let scenario =
            json!({"laws": {"k": {"kind": "power", "coefficient": 1.8e10, "exponent": 0.4}}});
        let spec = json!({"kind": "free_law", "law": "k", "pressures_pa": [1e4, 1e6], "at_pa": 1.4e5,
            "exponent_between_0_and_1": below_one, "concave_above_pa": concave.then_some(1e5)});
        let spec: ParameterSpec = serde_json::from_value(spec).unwrap();
        FreeLaw::new(&spec, &scenario).unwrap().unwrap()
    }

    #[test]
    fn latents_of_zero_are_the_law_of_the_scenario() {
        for shape in SHAPES {
            let law = free(shape);
            let values = law.log_stiffness(&law.numbers, &vec![0.0; law.count()]);
            for (pressure, value) in law.pressures.iter().zip(values) {
                let expected = (1.8e10 * pressure.powf(0.4)).ln();
                assert!((value - expected).abs() < 1e-12, "{value} {expected}");
            }
        }
    }

    /// The derivative of ln K against differences, and its inverse.
    #[test]
    fn changes_of_the_law_are_those_of_its_latents() {
        for shape in SHAPES {
            let law = free(shape);
            let at: Vec<f64> = (0..law.count()).map(|i| 0.3 * (1.7 * i as f64).sin()).collect();
            let change: Vec<f64> = (0..law.count()).map(|i| (0.9 * i as f64).cos()).collect();
            let step = 1e-5;
            let moved = |sign: f64| {
                let pairs = at.iter().zip(&change);
                let point: Vec<f64> = pairs.map(|(z, dz)| z + sign * step * dz).collect();
                law.log_stiffness(&law.numbers, &point)
            };
            let exact = law.log_stiffness_change(&at, &change);
            let largest = exact.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            for ((above, below), exact) in moved(1.0).iter().zip(moved(-1.0)).zip(&exact) {
                assert!(((above - below) / (2.0 * step) - exact).abs() < 1e-6 * largest);
            }
            for (back, expected) in law.latent_change(&at, &exact).iter().zip(&change) {
                assert!((back - expected).abs() < 1e-6, "{back} {expected}");
            }
        }
    }

    /// Every draw of the prior is a positive, increasing law that a table accepts, with the exponent
    /// below one if that was asked; half of the draws at the anchor are above the scenario's law, and
    /// the deviation of ln K there has the stated standard deviation.
    #[test]
    fn draws_of_the_prior_are_laws_about_the_scenario_s() {
        for shape in SHAPES {
            let law = free(shape);
            let prior = law.prior(0).unwrap();
            let draws = prior_draws(&law.parameters(), std::slice::from_ref(&prior), 400, 1);
            let (mut squares, mut convex) = (0.0, 0);
            for draw in &draws {
                let values = law.log_stiffness(&law.numbers, draw);
                let step = (law.pressures[1] / law.pressures[0]).ln();
                for pair in values.windows(2) {
                    let exponent = (pair[1] - pair[0]) / step;
                    assert!(exponent >= 0.0 && (!shape.0 || exponent <= 1.0 + 1e-9), "{exponent}");
                }
                let secant = |i: usize| {
                    let [low, high] = [i, i + 1].map(|at| (law.pressures[at], values[at].exp()));
                    (high.1 - low.1) / (high.0 - low.0)
                };
                let concave = (1..law.count() - 1).filter(|&i| law.pressures[i - 1] >= 1e5);
                // Secants of laws that hardly rise are known to the rounding of the stiffness.
                let rounding = |i: usize| 1e-12 * values[i].exp() / law.pressures[i];
                let rises = |&i: &usize| secant(i) > (1.0 + 1e-9) * secant(i - 1) + rounding(i);
                convex += concave.filter(rises).count();
                squares += (values[law.anchor] - law.centre).powi(2) / 400.0;
                let points: Vec<(f64, f64)> =
                    law.pressures.iter().zip(&values).map(|(&p, value)| (p, value.exp())).collect();
                assert!(Tabulated::new(&points).unwrap().stiffness(2e5) > 0.0);
            }
            assert!((squares - 1.0).abs() < 0.02, "{squares}");
            assert_eq!(convex == 0, shape.1, "{convex}");
        }
    }

    /// Latents weighted otherwise describe the same law, and are independent where one component has all of the weight.
    #[test]
    fn other_latents_describe_the_same_law() {
        let law = free((true, false));
        let mut weights = vec![0.0; law.components.len()];
        weights[7] = 0.4;
        let other = law.with_weights(&weights).unwrap();
        let at: Vec<f64> = (0..law.count()).map(|i| 0.3 * (1.7 * i as f64).sin()).collect();
        let same = other.latents_of(&law, &at);
        assert!(same.iter().zip(&at).any(|(a, b)| (a - b).abs() > 1e-2));
        let of = |law: &FreeLaw, latents: &[f64]| law.log_stiffness(&law.numbers, latents);
        for (a, b) in of(&law, &at).iter().zip(of(&other, &same)) {
            assert!((a - b).abs() < 1e-10, "{a} {b}");
        }
        for (back, expected) in law.latents_of(&other, &same).iter().zip(&at) {
            assert!((back - expected).abs() < 1e-6, "{back} {expected}");
        }
        let prior = other.prior(0).unwrap();
        for (i, row) in prior.covariances()[7].iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((entry - expected).abs() < 1e-6, "{i} {j}: {entry}");
            }
        }
    }

    /// Slopes without a derivative change from one pressure to the next by the root of their distance,
    /// those with one by the distance: over 0.011 of the length by 15 % and 2.0 % of their
    /// deviation. Both kinds have the same probability.
    #[test]
    fn the_kinds_of_smoothness_differ_in_small_changes_of_the_slope() {
        let known = json!({"median": 0.5, "log_deviation": 0});
        let law = |kinds: Value| {
            let mut spec = json!({"kind": "free_law", "law": "k", "pressures_pa": [1e5, 1.6e5],
                "points": 42, "roughness": known, "length": {"median": 1, "log_deviation": 0}});
            if kinds != Value::Null {
                spec["smoothness"] = kinds;
            }
            let scenario = json!({"laws": {"k": {"kind": "constant", "stiffness_pa_per_m": 1e12}}});
            let spec: ParameterSpec = serde_json::from_value(spec).unwrap();
            FreeLaw::new(&spec, &scenario)
        };
        let change = |kinds: Value| {
            let law = law(kinds).unwrap().unwrap();
            let prior = law.prior(0).unwrap();
            let draws = prior_draws(&law.parameters(), std::slice::from_ref(&prior), 4000, 3);
            let square = |draw: &Vec<f64>| {
                let r = law.basis.values(&draw[1..]);
                (r[21] - r[20]).powi(2)
            };
            (draws.iter().map(square).sum::<f64>() / 4000.0).sqrt() / 0.5
        };
        let h = 1.6_f64.ln() / 41.0;
        let a = 3.0_f64.sqrt() * h;
        let smooth = (2.0 * (1.0 - (1.0 + a) * (-a).exp())).sqrt();
        let rough = (2.0 * (1.0 - (-h).exp())).sqrt();
        assert!((smooth / 0.0197 - 1.0).abs() < 0.01 && (rough / 0.1510 - 1.0).abs() < 0.01);
        let both = (0.5 * (smooth * smooth + rough * rough)).sqrt();
        for (kinds, expected) in [
            (json!(["differentiable"]), smooth),
            (json!(["continuous"]), rough),
            (Value::Null, both),
        ] {
            let shown = change(kinds);
            assert!((shown / expected - 1.0).abs() < 0.06, "{shown} {expected}");
        }
        for wrong in [json!([]), json!(["continuous", "continuous"])] {
            let error = law(wrong).unwrap_err().to_string();
            assert!(error.contains("not a list of different kinds"), "{error}");
        }
    }

    /// Variance and correlation of the slope's deviation in the prior equal the mixture's.
    #[test]
    fn slopes_of_the_prior_have_the_covariance_of_the_mixture() {
        let law = free((false, false));
        let prior = law.prior(0).unwrap();
        let draws = prior_draws(&law.parameters(), std::slice::from_ref(&prior), 20_000, 2);
        let grid = &law.components;
        let total: f64 = grid.iter().map(|own| own.weight).sum();
        let step = (law.pressures[1] / law.pressures[0]).ln();
        for (i, j) in [(0, 0), (20, 20), (20, 21), (18, 22)] {
            let distance = step * (j as f64 - i as f64).abs();
            let correlation = |own: &PriorComponent| match own.smoothness {
                SlopeSmoothness::Differentiable => {
                    let a = 3.0_f64.sqrt() * distance / own.length;
                    (1.0 + a) * (-a).exp()
                }
                SlopeSmoothness::Continuous => (-distance / own.length).exp(),
            };
            let expected: f64 = grid
                .iter()
                .map(|own| own.weight / total * own.roughness.powi(2) * correlation(own))
                .sum();
            let moment = |draw: &Vec<f64>| {
                let r = law.basis.values(&draw[1..]);
                r[i] * r[j]
            };
            let products: Vec<f64> = draws.iter().map(moment).collect();
            let mean = products.iter().sum::<f64>() / products.len() as f64;
            let spread = products.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            let error = spread.sqrt() / products.len() as f64;
            assert!((mean - expected).abs() < 4.0 * error, "{i} {j}: {mean} {expected} {error}");
        }
    }
}
