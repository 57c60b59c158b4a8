//! The list of all kinds of contact laws.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::draw::{Draw, rounded};
use crate::in_series::InSeriesSpec;
use crate::law_form::{LawFault, LawForm};

/// A random law with about a stiffness \[Pa/m\] at a pressure \[Pa\]; see [`LawForm::sample`].
pub type Sampler = fn(draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> LawSpec;

/// The union of the kinds, each with its document form.
macro_rules! kinds {
    ($($kind:ident($form:ty)),* $(,)?) => {
        /// Contact law: stiffness per area K as a function of the contact pressure p.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "kind", rename_all = "snake_case")]
        #[expect(missing_docs, reason = "the document form states what a kind is")]
        pub enum LawSpec {
            $($kind($form),)*
            InSeries(InSeriesSpec<LawRef>),
        }

        impl LawSpec {
            /// A sampler of each kind but laws in series.
            pub const SAMPLERS: &[Sampler] =
                &[$(|draw, pressure, stiffness| <$form>::sample(draw, pressure, stiffness).into()),*];

            /// The form of a single law; `None` for laws in series.
            pub fn form(&self) -> Option<&dyn LawForm> {
                match self {
                    $(Self::$kind(form) => Some(form),)*
                    Self::InSeries(_) => None,
                }
            }
        }

        $(impl From<$form> for LawSpec {
            fn from(form: $form) -> Self {
                Self::$kind(form)
            }
        })*
    };
}

// One line a kind. The schema, the conformance suite, the campaign of random scenarios and the fuzzers
// draw from this list.
kinds! {
    Constant(crate::constant::ConstantSpec),
    Power(crate::power::PowerSpec),
    ModifiedPower(crate::modified_power::ModifiedPowerSpec),
    Exponential(crate::exponential::ExponentialSpec),
    Hyperbolic(crate::hyperbolic::HyperbolicSpec),
    GreenwoodWilliamson(crate::greenwood_williamson::GreenwoodWilliamsonSpec),
    Persson(crate::persson::PerssonSpec),
    Table(crate::tabulated::TableSpec),
}

impl LawSpec {
    /// `law` in series with an elastic layer of this stiffness \[Pa/m\].
    pub fn with_layer(law: LawRef, stiffness_pa_per_m: f64) -> Self {
        Self::InSeries(InSeriesSpec {
            law: Some(law),
            laws: Vec::new(),
            stiffness_pa_per_m: Some(stiffness_pa_per_m),
        })
    }

    /// The laws that this one has in series; none for a law of its own.
    pub fn inner_laws(&self) -> impl Iterator<Item = &LawRef> {
        let series = if let Self::InSeries(series) = self { Some(series) } else { None };
        series.into_iter().flat_map(InSeriesSpec::inner_laws)
    }

    /// Faults that the schema does not state, without those of inner laws.
    pub fn faults(&self) -> Box<dyn Iterator<Item = LawFault> + '_> {
        match self {
            Self::InSeries(series) => Box::new(series.faults()),
            law => law.form().map_or_else(|| Box::new(std::iter::empty()) as _, LawForm::faults),
        }
    }

    /// A random law of any kind with about `stiffness` \[Pa/m\] at `pressure` \[Pa\]; layers in series
    /// nest to `depth`.
    pub fn sample(draw: &mut dyn Draw, pressure: f64, stiffness: f64, depth: usize) -> Self {
        let layered = usize::from(depth > 0);
        let kind = draw.whole(0..=Self::SAMPLERS.len() - 1 + layered);
        if let Some(sample) = Self::SAMPLERS.get(kind) {
            return sample(draw, pressure, stiffness);
        }
        let layer = rounded(stiffness * draw.log_uniform(0.5, 50.0));
        let law = Self::sample(draw, pressure, stiffness, depth - 1);
        Self::with_layer(law.into(), layer)
    }
}

/// Contact law, by its name in "laws" or written in place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum LawRef {
    /// Name of a law in "laws".
    Named(String),
    /// Law written in place.
    InPlace(Box<LawSpec>),
}

impl LawRef {
    /// The name of the law in messages and tables: "in place" for one without a name.
    pub fn name(&self) -> &str {
        match self {
            Self::Named(name) => name,
            Self::InPlace(_) => "in place",
        }
    }
}

impl From<LawSpec> for LawRef {
    fn from(law: LawSpec) -> Self {
        Self::InPlace(Box::new(law))
    }
}
