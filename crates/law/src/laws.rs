//! Laws by name, and the laws that references to them stand for.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde::ser::{Serialize, Serializer};

use crate::contact_law::ContactLaw;
use crate::error::{LawError, LawQuantity};
use crate::in_series::InSeries;
use crate::law_form::LawForm;
use crate::law_spec::{LawRef, LawSpec};
use crate::laws_in_series::{LawsInSeries, SeriesContact};

/// Deepest nesting of laws in series.
pub const MAX_SERIES_DEPTH: usize = 8;

/// Most laws in series, those of nested series included.
pub const MAX_SERIES_LAWS: usize = 100;

/// Contact laws by name, in the order of the scenario.
///
/// ```
/// use asperity_law::{ContactLaw, LawRef, Laws, PowerSpec};
///
/// let mut laws = Laws::default();
/// laws.insert("pl", PowerSpec { coefficient: 1.81e10, exponent: 0.35 }.into());
/// let law = laws.build(&LawRef::Named("pl".to_owned()), 1.4e5)?;
/// assert!((law.stiffness(1.4e5) / 1.145e12 - 1.0).abs() < 1e-3);
/// # Ok::<(), asperity_law::LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, JsonSchema)]
#[schemars(transparent, description = "Contact laws by name.")]
pub struct Laws {
    #[schemars(with = "BTreeMap<String, LawSpec>")]
    entries: Vec<(String, LawSpec)>,
}

impl Laws {
    /// True without any law.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Number of laws.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Law of that name.
    pub fn get(&self, name: &str) -> Option<&LawSpec> {
        let entry = self.entries.iter().find(|(known, _)| known == name);
        entry.map(|(_, law)| law)
    }

    /// Names and laws, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &LawSpec)> {
        self.entries.iter().map(|(name, law)| (name.as_str(), law))
    }

    /// Names, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|(name, _)| name.as_str())
    }

    /// Adds a law, or replaces the law of that name and returns it.
    pub fn insert(&mut self, name: impl Into<String>, law: LawSpec) -> Option<LawSpec> {
        let name = name.into();
        if let Some((_, old)) = self.entries.iter_mut().find(|(known, _)| *known == name) {
            Some(std::mem::replace(old, law))
        } else {
            self.entries.push((name, law));
            None
        }
    }

    /// Law that a reference stands for; `None` for a name that is not among these.
    ///
    /// The inner references of laws in series are resolved in the same way.
    pub fn resolve<'a>(&'a self, reference: &'a LawRef) -> Option<&'a LawSpec> {
        match reference {
            LawRef::Named(name) => self.get(name),
            LawRef::InPlace(law) => Some(law),
        }
    }

    /// Highest pressure \[Pa\] that a table of `law` is to show; 0 for a law without a pressure of its
    /// own.
    ///
    /// # Errors
    /// Those of [`check_series`](Self::check_series).
    pub fn highest_pressure(&self, law: &LawRef) -> Result<f64, LawError> {
        let series = self.series(law)?;
        let forms = series.laws.iter().filter_map(|law| self.resolve(law)?.form());
        Ok(forms.map(LawForm::highest_pressure).fold(0.0, f64::max))
    }

    /// Checks that the laws which `law` has in series end, and are not too many. Names without a law
    /// count as laws.
    ///
    /// # Errors
    /// [`LawError::CyclicLaw`], [`LawError::SeriesTooDeep`] and [`LawError::TooManyInSeries`];
    /// [`LawError::Below`] for a series without a law.
    pub fn check_series(&self, law: &LawRef) -> Result<(), LawError> {
        self.series(law).map(|_| ())
    }

    /// Builds the law that `reference` stands for. A law that never separates counts its closure from
    /// `static_pressure` \[Pa\].
    ///
    /// # Errors
    /// [`LawError`] for a name without a law, laws in series without end, parameters out of range, or a
    /// law that never separates without a pressure to hold it closed.
    pub fn build(
        &self,
        reference: &LawRef,
        static_pressure: f64,
    ) -> Result<Arc<dyn ContactLaw>, LawError> {
        let law = self.resolve(reference).ok_or_else(|| LawError::UnknownLaw {
            name: reference.name().to_owned(),
            known: self.names().collect::<Vec<_>>().join(", "),
        })?;
        if let Some(form) = law.form() {
            return form.build(static_pressure);
        }
        // Layers in series are one layer, and laws in it are inverted by one iteration.
        let Series { laws, layer, .. } = self.series(reference)?;
        let build = |inner: &&LawRef| self.build(inner, static_pressure);
        let mut inner = laws.iter().map(build).collect::<Result<Vec<_>, _>>()?;
        Ok(match (inner.len(), layer) {
            (1, Some(layer)) => Arc::new(InSeries::new(inner.remove(0), layer)?),
            (_, layer) => {
                let contacts = inner.into_iter().map(SeriesContact::new).collect();
                Arc::new(LawsInSeries::new(contacts, layer.map_or(0.0, f64::recip))?)
            }
        })
    }

    fn series<'a>(&'a self, law: &'a LawRef) -> Result<Series<'a>, LawError> {
        let mut series = Series::default();
        series.add(self, law, 0)?;
        Ok(series)
    }
}

/// The laws in series of a law, those of nested series included, and all elastic layers as one.
#[derive(Default)]
struct Series<'a> {
    laws: Vec<&'a LawRef>,
    /// Stiffness of the layers \[Pa/m\].
    layer: Option<f64>,
    /// Names on the way to the law that is added.
    chain: Vec<&'a str>,
}

impl<'a> Series<'a> {
    fn add(&mut self, known: &'a Laws, law: &'a LawRef, depth: usize) -> Result<(), LawError> {
        let names = self.chain.len();
        if let LawRef::Named(name) = law {
            let repeated = self.chain.contains(&name.as_str());
            self.chain.push(name);
            if repeated {
                let chain = self.chain.iter().map(|&name| name.to_owned());
                return Err(LawError::CyclicLaw(chain.collect()));
            }
        }
        if let Some(LawSpec::InSeries(series)) = known.resolve(law) {
            if depth == MAX_SERIES_DEPTH {
                return Err(LawError::SeriesTooDeep { most: MAX_SERIES_DEPTH });
            }
            if series.inner_laws().next().is_none() {
                let quantity = LawQuantity::SeriesContacts;
                return Err(LawError::Below { quantity, value: 0.0, limit: 1.0 });
            }
            if let Some(stiffness) = series.stiffness_pa_per_m {
                let both = |layer: f64| 1.0 / (1.0 / layer + 1.0 / stiffness);
                self.layer = Some(self.layer.map_or(stiffness, both));
            }
            for inner in series.inner_laws() {
                self.add(known, inner, depth + 1)?;
            }
        } else {
            self.laws.push(law);
            if self.laws.len() > MAX_SERIES_LAWS {
                return Err(LawError::TooManyInSeries { most: MAX_SERIES_LAWS });
            }
        }
        self.chain.truncate(names);
        Ok(())
    }
}

impl FromIterator<(String, LawSpec)> for Laws {
    fn from_iter<I: IntoIterator<Item = (String, LawSpec)>>(pairs: I) -> Self {
        let mut laws = Self::default();
        for (name, law) in pairs {
            laws.insert(name, law);
        }
        laws
    }
}

impl Serialize for Laws {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de> Deserialize<'de> for Laws {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries;

        impl<'de> Visitor<'de> for Entries {
            type Value = Laws;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of contact laws by name")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Laws, A::Error> {
                std::iter::from_fn(|| map.next_entry().transpose()).collect()
            }
        }

        deserializer.deserialize_map(Entries)
    }
}
