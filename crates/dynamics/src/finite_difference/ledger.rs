//! The energy balance of the discrete motion.

/// Work and loss, summed during the run.
///
/// Multiplying the scheme by `(w+ - w-) / 2` shows that the work of the force
/// over a step is `F (w+ - w-) / 2`, and that `v M v / 2 + w k w- / 2` at half
/// steps changes by exactly that less the losses. The viscous power
/// `h sum m v^2` is smooth on the scale of many steps, so it is measured only
/// now and then and integrated by the trapezoidal rule.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    /// Work of the force so far \[J\].
    pub(super) input: f64,
    /// Viscous loss up to the latest measurement \[J\].
    pub(super) dissipated: f64,
    power: f64,
    time: f64,
}

impl Ledger {
    /// Takes in the viscous `power` \[W\] at `time` \[s\].
    pub(super) fn measure(&mut self, power: f64, time: f64) {
        self.dissipated += 0.5 * (self.power + power) * (time - self.time);
        (self.power, self.time) = (power, time);
    }

    /// Extends the viscous loss to the end of the run at `time` \[s\].
    pub(super) fn close(&mut self, time: f64) {
        self.measure(self.power, time);
    }
}
