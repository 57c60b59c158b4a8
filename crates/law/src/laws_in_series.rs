//! Laws in series through light bodies.

use std::sync::Arc;

use crate::contact_law::{ContactLaw, Pressure, inverse};
use crate::domain::{Domain, no_less};
use crate::error::{LawError, LawQuantity, above, at_least};

/// A contact of a series: its law, and its pressure as a function of that of the series.
#[derive(Debug, Clone)]
pub struct SeriesContact {
    /// The law of the contact.
    pub law: Arc<dyn ContactLaw>,
    /// Ratio r of a pressure increment of the contact to that of the series \[-\]: the ratio of the
    /// areas, as all contacts carry one force.
    pub pressure_ratio: f64,
    /// Pressure dp of the contact where that of the series is zero \[Pa\]: the weights between them.
    pub pressure_offset: f64,
}

impl SeriesContact {
    /// A contact of the area of the series, with its pressure.
    pub fn new(law: Arc<dyn ContactLaw>) -> Self {
        Self { law, pressure_ratio: 1.0, pressure_offset: 0.0 }
    }

    /// Pressure of the contact \[Pa\] at `pressure` of the series \[Pa\].
    pub fn pressure(&self, pressure: f64) -> f64 {
        self.pressure_ratio * pressure + self.pressure_offset
    }

    /// Pressure of the series \[Pa\] where that of the contact is `own` \[Pa\].
    fn series_pressure(&self, own: f64) -> f64 {
        (own - self.pressure_offset) / self.pressure_ratio
    }

    /// Closure from pressure `from` of the series to pressure `to` over the `increment` between
    /// them \[Pa\].
    ///
    /// From the lower of two far pressures, whose relative precision a difference would not keep.
    fn closure_over(&self, (from, to): (f64, f64), increment: f64) -> f64 {
        let (start, end) = (self.pressure(from), self.pressure(to));
        let increment = self.pressure_ratio * increment;
        if end >= 0.5 * start || self.law.domain().is_bilateral() {
            self.law.closure_increment(start, increment)
        } else if end > 0.0 || self.law.domain().separates() {
            -self.law.closure_increment(end, -increment)
        } else {
            self.law.closure(end)
        }
    }
}

/// Any number of laws in series, with elastic layers between them.
///
/// The closures add at one force. With the pressure p of the series, `r_i p + dp_i` that of contact
/// i, and the compliance c of the layers,
///
/// ```text
/// d(p) = sum_i [d_i(r_i p + dp_i) - d_i(dp_i)] + c p,    1/K(p) = sum_i r_i / K_i(r_i p + dp_i) + c.
/// ```
///
/// It is the law of a stack of bodies whose inertia does not matter: `c = sum L / E` for bodies of
/// the area of the series, and dp the pressure that their weights add. One contact with a layer is
/// [`InSeries`](crate::InSeries) of stiffness `1/c`; n equal contacts are n times as soft.
///
/// Contact is lost where the first contact loses it, the one without an offset: the series counts
/// its pressure. Closures count from there; for laws that never separate from the reference pressure
/// of the first such contact.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_law::{ContactLaw, LawsInSeries, Power, SeriesContact};
///
/// let law = Arc::new(Power::new(1.81e10, 0.35, 0.0)?);
/// let upper = SeriesContact::new(law.clone());
/// // A sample of 4.7 g lies between the contacts.
/// let lower = SeriesContact { pressure_offset: 399.0, ..SeriesContact::new(law.clone()) };
/// let both = LawsInSeries::new(vec![upper, lower], 0.015 / 71e9)?;
/// let closure = law.closure(1.4e5) + law.closure_increment(399.0, 1.4e5) + 1.4e5 * 0.015 / 71e9;
/// assert!((both.closure(1.4e5) / closure - 1.0).abs() < 1e-12);
/// # Ok::<(), asperity_law::LawError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LawsInSeries {
    contacts: Vec<SeriesContact>,
    compliance: f64,
    reference: f64,
    domain: Domain,
}

impl LawsInSeries {
    /// Contacts in series with layers of the compliance `compliance` c >= 0 \[m/Pa\].
    ///
    /// # Errors
    /// [`LawError`] for no contact, a ratio that is not positive, a compliance or the offset of a
    /// law without tension that is negative, and for offsets of laws without tension that are all
    /// positive: the pressure of the series is that of the contact lost first.
    pub fn new(contacts: Vec<SeriesContact>, compliance: f64) -> Result<Self, LawError> {
        at_least(LawQuantity::SeriesContacts, contacts.len() as f64, 1.0)?;
        at_least(LawQuantity::Compliance, compliance, 0.0)?;
        let mut lowest = f64::INFINITY;
        for contact in &contacts {
            above(LawQuantity::PressureRatio, contact.pressure_ratio, 0.0)?;
            let offset = contact.pressure_offset;
            if contact.law.domain().is_bilateral() {
                at_least(LawQuantity::PressureOffset, offset, f64::MIN)?;
            } else {
                lowest = lowest.min(at_least(LawQuantity::PressureOffset, offset, 0.0)?);
            }
        }
        if lowest.is_finite() && lowest > 0.0 {
            let quantity = LawQuantity::PressureOffset;
            return Err(LawError::Above { quantity, value: lowest, limit: 0.0 });
        }
        let never_lost = |contact: &&SeriesContact| {
            let domain = contact.law.domain();
            contact.pressure_offset == 0.0 && !domain.is_bilateral() && !domain.separates()
        };
        let bilateral = lowest == f64::INFINITY;
        let reference = contacts
            .iter()
            .find(never_lost)
            .map_or(0.0, |contact| contact.series_pressure(contact.law.reference_pressure()));
        let mut series = Self { contacts, compliance, reference, domain: Domain::BILATERAL };
        if !bilateral {
            let separates = reference == 0.0;
            series.domain = Domain {
                pressure_min: 0.0,
                closure_lost: separates.then_some(0.0),
                closure_limit: f64::INFINITY,
            };
        }
        series.domain.closure_limit = series.closure_limit();
        Ok(series)
    }

    /// The contacts.
    pub fn contacts(&self) -> &[SeriesContact] {
        &self.contacts
    }

    /// Compliance c of the layers \[m/Pa\].
    pub fn compliance(&self) -> f64 {
        self.compliance
    }

    /// Finite if every law becomes rigid at a finite closure and no layer yields.
    fn closure_limit(&self) -> f64 {
        if self.compliance > 0.0 {
            return f64::INFINITY;
        }
        let room = |contact: &SeriesContact| {
            let start = contact.pressure(self.reference);
            contact.law.domain().closure_limit - contact.law.closure(start)
        };
        self.contacts.iter().map(room).sum()
    }

    /// Closure over an `increment` of the pressure, which leads from the one to the other \[Pa\].
    fn closure_over(&self, ends: (f64, f64), increment: f64) -> f64 {
        let of = |contact: &SeriesContact| contact.closure_over(ends, increment);
        self.contacts.iter().map(of).sum::<f64>() + self.compliance * increment
    }

    /// Closure from pressure `from` to pressure `to` \[Pa\].
    fn closure_between(&self, from: f64, to: f64) -> f64 {
        self.closure_over((from, to), to - from)
    }

    /// Compliance of each contact \[m/Pa\] at `pressure` of the series \[Pa\].
    fn compliances(&self, pressure: f64) -> impl Iterator<Item = f64> {
        let of = move |contact: &SeriesContact| {
            contact.pressure_ratio / contact.law.stiffness(contact.pressure(pressure))
        };
        self.contacts.iter().map(of)
    }
}

impl ContactLaw for LawsInSeries {
    fn stiffness(&self, pressure: f64) -> f64 {
        if pressure < self.domain.pressure_min {
            return 0.0;
        }
        (self.compliances(pressure).sum::<f64>() + self.compliance).recip()
    }

    /// `sum_i (r_i K / K_i)^2 dK_i/dp_i`: each contact by its share of a closure increment.
    fn stiffness_slope(&self, pressure: f64) -> f64 {
        if pressure < self.domain.pressure_min {
            return 0.0;
        }
        let soft = self.compliances(pressure).filter(|c| *c == f64::INFINITY).count();
        let total = self.compliances(pressure).sum::<f64>() + self.compliance;
        let slopes = self.contacts.iter().zip(self.compliances(pressure)).map(|(contact, own)| {
            // Contacts without stiffness take all of the closure.
            let share = match soft {
                0 => own / total,
                _ if own == f64::INFINITY => 1.0 / soft as f64,
                _ => return 0.0,
            };
            share * share * contact.law.stiffness_slope(contact.pressure(pressure))
        });
        slopes.sum()
    }

    fn domain(&self) -> Domain {
        self.domain
    }

    fn reference_pressure(&self) -> f64 {
        self.reference
    }

    fn kinks(&self) -> Vec<f64> {
        let of = |contact: &SeriesContact| {
            let own = contact.law.kinks();
            own.into_iter().map(|p| contact.series_pressure(p)).collect::<Vec<_>>()
        };
        let mut kinks: Vec<f64> = self.contacts.iter().flat_map(of).collect();
        // Contacts with an offset have all of their pressures below in use already.
        kinks.retain(|p| *p > self.domain.pressure_min);
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        kinks
    }

    fn measured_range(&self) -> Option<(f64, f64)> {
        let of = |contact: &SeriesContact| {
            let (low, high) = contact.law.measured_range()?;
            Some((contact.series_pressure(low), contact.series_pressure(high)))
        };
        let ranges = self.contacts.iter().filter_map(of);
        ranges.reduce(|(low, high), (a, b)| (low.max(a), high.min(b)))
    }

    fn closure(&self, pressure: f64) -> f64 {
        let p = no_less(pressure, self.domain.pressure_min);
        let closure = self.closure_between(self.reference, p);
        // Next to the limit the closures that add up to it are rounded.
        if closure > self.domain.closure_limit { self.domain.closure_limit } else { closure }
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        let dp = no_less(increment, self.domain.pressure_min - from);
        self.closure_over((from, from + dp), dp)
    }

    fn pressure(&self, closure: f64) -> Pressure {
        inverse::pressure_by(self, closure, &|from, to| self.closure_between(from, to))
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        let between = |from: f64, to: f64| self.closure_between(from, to);
        inverse::pressure_increment_by(self, from, closure_increment, &between)
    }
}
