//! A bar at one frequency, in closed form.

use asperity_mesh::Body;
use num_complex::Complex64;

use crate::Dual;

/// A bar at one frequency.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bar<'a> {
    pub(crate) body: &'a Body,
    /// `w^2 - i w h`.
    s: Dual,
    /// Modulus over E under internal damping, `1 + i loss(w)`.
    modulus: Dual,
    /// Wave number \[1/m\], `sqrt(s / m) / c` with the modulus m.
    kappa: Dual,
}

/// A place of a bar or the support.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Place {
    /// At this distance from the upper end \[m\].
    Point(f64),
    /// The average of a bar.
    Mean,
    /// The support.
    Whole,
}

impl<'a> Bar<'a> {
    pub(crate) fn new(body: &'a Body, s: Dual, w: f64) -> Self {
        let damping = body.damping();
        let modulus = Dual {
            value: Complex64::new(1.0, damping.loss(w)),
            d_frequency: Complex64::new(0.0, damping.loss_slope()),
            d_anti_damping: Complex64::ZERO,
        };
        let square = if modulus == Dual::ONE { s } else { s * modulus.inverse() };
        let value = root(square.value);
        let kappa = square.chain(value, (2.0 * value).inv()) * body.wave_speed().recip();
        Self { body, s, modulus, kappa }
    }

    /// The entries of the dynamic stiffness for the mean of the ends and half their difference.
    pub(crate) fn stiffness(&self) -> [Dual; 2] {
        let half = self.kappa * (0.5 * self.body.length());
        let tan = tangent(half.value);
        let tan = half.chain(tan, Complex64::ONE + tan * tan);
        let impedance = self.modulus * self.kappa * (2.0 * self.body.axial_rigidity());
        [impedance * tan * -1.0, impedance * tan.inverse()]
    }

    /// Shares of the mean of the ends and half their difference in the motion of a place.
    pub(crate) fn shape(&self, place: Place) -> [Dual; 2] {
        match place {
            Place::Point(0.0) => [Dual::ONE, Dual::ONE],
            Place::Point(x) if x == self.body.length() => [Dual::ONE, Dual::ONE * -1.0],
            Place::Point(x) => {
                let half = 0.5 * self.body.length();
                let (d, near) = ((half - x).abs(), half - (half - x).abs());
                let ratio = wave(self.kappa * d) * wave(self.kappa * half).inverse();
                let sine = turn(self.kappa * near) * ratio;
                [Dual::ONE + self.point_excess(x), if x > half { sine * -1.0 } else { sine }]
            }
            Place::Mean | Place::Whole => [Dual::ONE + self.mean_excess(), Dual::default()],
        }
    }

    /// `1 / (m s)` \[m/N\].
    pub(crate) fn per_inertia(&self) -> Dual {
        (self.s * self.body.mass()).inverse()
    }

    /// `cos(kappa d) / cos(th / 2) - 1` at x, `2 sin(kappa x / 2) sin(kappa (L - x) / 2) / cos(th / 2)`.
    pub(crate) fn point_excess(&self, x: f64) -> Dual {
        let [above, below] =
            [x, self.body.length() - x].map(|length| wave(self.kappa * (0.5 * length)));
        let half = turn(self.kappa * (0.5 * self.body.length()));
        above * below * (Dual::ONE + half * half).inverse() * -1.0
    }

    /// Receptance of two points of the bar whose ends are held, at these distances from the ends
    /// \[m/N\].
    pub(crate) fn held(&self, above: f64, below: f64) -> Dual {
        let between = self.body.length() - above - below;
        let sines = wave(self.kappa * above) * wave(self.kappa * below);
        let ratio =
            sines * turn(self.kappa * between) * wave(self.kappa * self.body.length()).inverse();
        let impedance = self.modulus * self.kappa * self.body.axial_rigidity();
        ratio * impedance.inverse() * Complex64::new(0.0, -0.5)
    }

    /// `tan(x) / x - 1` at `x = th / 2`.
    pub(crate) fn mean_excess(&self) -> Dual {
        let x = self.kappa * (0.5 * self.body.length());
        if x.value.norm_sqr() < 0.01 {
            const SERIES: [f64; 5] =
                [1.0 / 3.0, 2.0 / 15.0, 17.0 / 315.0, 62.0 / 2835.0, 1382.0 / 155_925.0];
            let (square, constant) = (x * x, |factor: f64| Dual::constant(factor.into()));
            let terms = SERIES.iter().rev();
            square * terms.fold(Dual::default(), |sum, &factor| sum * square + constant(factor))
        } else {
            let tan = tangent(x.value);
            x.chain(tan, Complex64::ONE + tan * tan) * x.inverse() - Dual::ONE
        }
    }
}

/// `exp(-i x)`, which does not overflow for the strongly damped, whose imaginary part is negative.
fn turn(x: Dual) -> Dual {
    let i = Complex64::new(0.0, 1.0);
    let value = (-i * x.value).exp();
    x.chain(value, -i * value)
}

/// `1 - exp(-2 i x) = 2 i sin(x) exp(-i x)`, without cancellation for small x.
fn wave(x: Dual) -> Dual {
    let i = Complex64::new(0.0, 1.0);
    let turn = (-i * x.value).exp();
    let square = turn * turn;
    let small = x.value.norm_sqr() < 0.25;
    let value = if small { 2.0 * i * x.value.sin() * turn } else { Complex64::ONE - square };
    x.chain(value, 2.0 * i * square)
}

/// The root with a positive real part, without the angles of the general function.
fn root(x: Complex64) -> Complex64 {
    let size = x.norm_sqr().sqrt();
    if x.re <= 0.0 || !size.is_normal() {
        return x.sqrt();
    }
    let re = (0.5 * (size + x.re)).sqrt();
    Complex64::new(re, 0.5 * x.im / re)
}

/// `tan(x)`, without overflow for the strongly damped, whose imaginary part is negative, and
/// without cancellation for small x.
fn tangent(x: Complex64) -> Complex64 {
    let i = Complex64::new(0.0, 1.0);
    if x.norm_sqr() < 0.25 {
        x.sin() / x.cos()
    } else {
        let turn = (-2.0 * i * x).exp();
        -i * (Complex64::ONE - turn) / (Complex64::ONE + turn)
    }
}
