//! One axis of a panel: label, unit, range, display factor.

/// A labelled axis, linear or logarithmic.
///
/// Data stay in their own unit; the axis shows them multiplied by its display factor. Ranges and
/// ticks are given in display units, the numbers a reader sees:
///
/// ```
/// use asperity_figure::Axis;
/// // A column in Pa, shown from 0 to 5 MPa.
/// let axis = Axis::linear("Contact pressure", "MPa").scale(1e-6).range(0.0, 5.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub(crate) label: String,
    pub(crate) unit: String,
    pub(crate) log: bool,
    pub(crate) low: Option<f64>,
    pub(crate) high: Option<f64>,
    pub(crate) factor: f64,
    pub(crate) ticks: Option<Vec<(f64, String)>>,
}

impl Axis {
    fn new(label: impl Into<String>, unit: impl Into<String>, log: bool) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            log,
            low: None,
            high: None,
            factor: 1.0,
            ticks: None,
        }
    }

    /// A linear axis; an empty unit is left out of the label.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self::new(label, unit, false)
    }

    /// A logarithmic axis; an empty unit is left out of the label.
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self::new(label, unit, true)
    }

    /// Fixes both ends, in display units; otherwise they follow the data.
    #[must_use]
    pub fn range(self, low: f64, high: f64) -> Self {
        self.low(low).high(high)
    }

    /// Fixes the lower end, in display units.
    #[must_use]
    pub fn low(mut self, low: f64) -> Self {
        self.low = Some(low);
        self
    }

    /// Fixes the upper end, in display units.
    #[must_use]
    pub fn high(mut self, high: f64) -> Self {
        self.high = Some(high);
        self
    }

    /// Sets the display factor: what is shown is the data times `factor`.
    #[must_use]
    pub fn scale(mut self, factor: f64) -> Self {
        self.factor = factor;
        self
    }

    /// Fixes the labelled ticks: position in display units and text.
    #[must_use]
    pub fn ticks<T: Into<String>>(mut self, ticks: impl IntoIterator<Item = (f64, T)>) -> Self {
        self.ticks = Some(ticks.into_iter().map(|(at, text)| (at, text.into())).collect());
        self
    }

    /// Widens fixed ends to those of another axis.
    pub(crate) fn widen(&mut self, other: &Self) {
        let pair = |own: Option<f64>, other: Option<f64>, of: fn(f64, f64) -> f64| {
            own.map(|own| other.map_or(own, |other| of(own, other)))
        };
        self.low = pair(self.low, other.low, f64::min);
        self.high = pair(self.high, other.high, f64::max);
    }

    /// The value shown for a datum, NaN where this axis cannot show it.
    pub(crate) fn shown(&self, datum: f64) -> f64 {
        let value = datum * self.factor;
        if self.can_show(value) { value } else { f64::NAN }
    }

    /// True for a value in display units that this axis can show.
    pub(crate) fn can_show(&self, value: f64) -> bool {
        value.is_finite() && (!self.log || value > 0.0)
    }
}
