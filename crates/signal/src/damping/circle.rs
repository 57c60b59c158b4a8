//! Circle fit of a mobility.

use super::{HalfPower, half_power_crossings};
use crate::fit::{least_squares, pseudo_inverse};
use crate::form::FrfForm;
use crate::frf::convert;
use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::uncertainty::LogReceptanceTerms;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// The circle of a mobility about one resonance, and the mode that describes it.
///
/// ```text
/// Y = B + C / (1 + i q),   q = (w^2 - w0^2) / (2 zeta w0 w),   C = modal constant / (2 zeta w0)
/// ```
///
/// One viscous mode gives a circle through the origin (`B = 0`); neighbouring modes, nearly
/// constant over the band, shift and rotate it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CircleFit {
    /// Undamped natural frequency, in hertz.
    pub natural_hz: f64,
    /// Damping ratio, from the change of the angle with frequency.
    pub ratio: f64,
    /// Centre of the circle, in m/(N s).
    pub centre: Complex64,
    /// Radius of the circle, in m/(N s).
    pub radius: f64,
    /// Modal constant `1/m`, in 1/kg; its angle is not zero for a complex mode or with neighbours.
    pub modal_constant: Complex64,
    /// Root mean square distance of the points from the circle, over the radius.
    pub scatter: f64,
    /// Root mean square difference of the angles from the angles of the mode, in radians.
    pub angle_scatter: f64,
    /// Angle between the first and the last point, in radians.
    pub arc: f64,
}

impl CircleFit {
    /// Largest receptance of the mode alone, `|C| / (w0 sqrt(1 - zeta^2))`, in m/N.
    pub fn peak_receptance(&self) -> f64 {
        let root = (1.0 - self.ratio * self.ratio).sqrt();
        let omega = TAU * self.natural_hz;
        self.modal_constant.norm() / (2.0 * self.ratio * root * omega * omega)
    }
}

/// Number of frequencies of [`circle_fit`].
const POINTS: usize = 61;

/// Circle fit of a peak between its half-power frequencies, half of the circle.
///
/// The mobility is evaluated at 61 frequencies on the exact transform. `None` if the peak
/// has no half-power width, and as for [`circle_fit_of`].
///
/// ```
/// use asperity_signal::{FrequencyResponse, HarmonicOptions, circle_fit, find_harmonics};
///
/// // Impulse response of a 1 kg oscillator at 200 Hz with 2 % of critical damping.
/// let (rate, omega, zeta) = (2e4, std::f64::consts::TAU * 200.0, 0.02_f64);
/// let damped = omega * (1.0 - zeta * zeta).sqrt();
/// let displacement: Vec<f64> = (0..20_000)
///     .map(|n| f64::from(n) / rate)
///     .map(|t| (-zeta * omega * t).exp() * (damped * t).sin() / damped)
///     .collect();
/// let mut force = vec![0.0; displacement.len()];
/// force[0] = rate;
/// let hit = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
/// let found = find_harmonics(&hit, 190.0, &HarmonicOptions::default());
/// let fit = found.fundamental.and_then(|peak| circle_fit(&hit, &peak)).ok_or("a circle")?;
/// assert!((fit.ratio - zeta).abs() < 1e-5 && (fit.modal_constant.re - 1.0).abs() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn circle_fit(response: &FrequencyResponse, peak: &Peak) -> Option<CircleFit> {
    circle_within(response, &half_power_crossings(response, peak)?)
}

/// [`circle_fit`] between known crossings.
pub(super) fn circle_within(response: &FrequencyResponse, width: &HalfPower) -> Option<CircleFit> {
    let (frequencies, values) = mobility_within(response, width);
    circle_fit_of(&frequencies, &values)
}

/// Frequencies between the crossings and the mobility there.
fn mobility_within(response: &FrequencyResponse, width: &HalfPower) -> (Vec<f64>, Vec<Complex64>) {
    let step = (width.upper_hz - width.lower_hz) / (POINTS - 1) as f64;
    let frequencies: Vec<f64> = (0..POINTS).map(|k| width.lower_hz + k as f64 * step).collect();
    let mobility =
        |f: &f64| convert(response.receptance_at(*f), *f, FrfForm::Receptance, FrfForm::Mobility);
    let values = frequencies.iter().map(mobility).collect();
    (frequencies, values)
}

/// Changes of a circle fit due to changes of the receptance.
pub(crate) struct CircleSensitivity {
    /// Of the logarithm of the natural frequency.
    pub(crate) natural: LogReceptanceTerms,
    /// Of the logarithm of the damping ratio.
    pub(crate) ratio: LogReceptanceTerms,
    /// Of the logarithm of the magnitude of the modal constant.
    pub(crate) modal_constant: LogReceptanceTerms,
}

impl CircleSensitivity {
    /// The sensitivity of [`circle_fit`] for points near their circle.
    ///
    /// A point moved by `dz` changes the centre and the radius through its radial part
    /// (least squares on the distances), and its angle through the tangential part of `dz` less the
    /// motion of the centre, over its distance; the angles change frequency and damping by their
    /// own least squares.
    pub(crate) fn of(
        response: &FrequencyResponse,
        width: &HalfPower,
        fit: &CircleFit,
    ) -> Option<Self> {
        let (frequencies, values) = mobility_within(response, width);
        let spokes: Vec<Complex64> = values.iter().map(|y| y - fit.centre).collect();
        let radial: Vec<Complex64> = spokes.iter().map(|spoke| spoke / spoke.norm()).collect();
        let rows: Vec<[f64; 3]> = radial.iter().map(|u| [u.re, u.im, 1.0]).collect();
        let centre = pseudo_inverse(&rows)?;
        let angles = AngleFit { natural_hz: fit.natural_hz, ratio: fit.ratio, turn: 0.0 };
        let rows: Vec<[f64; 3]> =
            frequencies.iter().map(|f| angles.observation(*f, 0.0).0).collect();
        let angular = pseudo_inverse(&rows)?;
        // Clockwise angles: -i u is the direction in which they grow.
        let growth: Vec<Complex64> = (radial.iter().zip(&spokes))
            .map(|(u, spoke)| u * Complex64::new(0.0, -1.0) / spoke.norm())
            .collect();
        let terms = |gradient: &dyn Fn(usize) -> Complex64| {
            let term = |k: usize| (frequencies[k], gradient(k).conj() * values[k]);
            LogReceptanceTerms { terms: (0..values.len()).map(term).collect() }
        };
        let of_angles = |parameter: usize| {
            let with_centre: Complex64 =
                growth.iter().zip(&angular).map(|(growth, row)| growth * row[parameter]).sum();
            terms(&|k| {
                let along = centre[k][0] * with_centre.re + centre[k][1] * with_centre.im;
                growth[k] * angular[k][parameter] - radial[k] * along
            })
        };
        let (natural, ratio) = (of_angles(1), of_angles(2));
        let ln_radius = terms(&|k| radial[k] * (centre[k][2] / fit.radius));
        let modal_constant = ln_radius.plus(&natural).plus(&ratio);
        Some(Self { natural, ratio, modal_constant })
    }
}

/// Circle fit of any mobility in a band about one resonance.
///
/// The circle is fitted by least squares in the complex plane (algebraic, then on the distances).
/// The angles about its centre, `2 atan(q)` from that at
/// resonance, then give the natural frequency, the damping ratio and
/// the angle of the diameter. Limiting case: exact for a single viscous mode without noise,
/// from any arc.
///
/// - `frequency_hz`: increasing and positive, in hertz.
/// - `mobility`: as many values, in m/(N s).
///
/// `None` for fewer than 5 points, values that are not finite, and points that
/// are not on a circle or do not follow it clockwise.
///
/// Source: C. C. Kennedy and C. D. P. Pancu, J. Aeronaut. Sci. 14 (1947),
/// 603-625; D. J. Ewins, *Modal Testing*, 2nd ed. 2000, sec. 4.4.
///
/// ```
/// use asperity_signal::{Complex64, circle_fit_of};
///
/// // Mobility of a mode of 2 kg at 100 Hz with 1 % of critical damping.
/// let tau = std::f64::consts::TAU;
/// let frequencies: Vec<f64> = (0..21).map(|k| 99.0 + 0.1 * f64::from(k)).collect();
/// let mobility = |f: &f64| {
///     let (w0, w) = (tau * 100.0, tau * f);
///     let stiffness = Complex64::new(w0 * w0 - w * w, 2.0 * 0.01 * w0 * w);
///     Complex64::new(0.0, w) / (stiffness * 2.0)
/// };
/// let values: Vec<Complex64> = frequencies.iter().map(mobility).collect();
/// let fit = circle_fit_of(&frequencies, &values).ok_or("a mode is a circle")?;
/// assert!((fit.ratio - 0.01).abs() < 1e-9);
/// assert!((fit.modal_constant.re - 0.5).abs() < 1e-6);
/// # Ok::<(), &str>(())
/// ```
pub fn circle_fit_of(frequency_hz: &[f64], mobility: &[Complex64]) -> Option<CircleFit> {
    let count = mobility.len();
    let valid = count >= 5
        && frequency_hz.len() == count
        && frequency_hz.iter().all(|f| f.is_finite() && *f > 0.0)
        && mobility.iter().all(|y| y.re.is_finite() && y.im.is_finite());
    if !valid {
        return None;
    }
    let (centre, radius) = least_squares_circle(mobility)?;
    let largest = (0..count).max_by(|&a, &b| mobility[a].norm().total_cmp(&mobility[b].norm()))?;
    // Clockwise from the point farthest from the origin, near the resonance.
    let reference = mobility[largest] - centre;
    let angles: Vec<f64> =
        mobility.iter().map(|y| -((y - centre) * reference.conj()).arg()).collect();
    let sweep = AngleFit::fitted(frequency_hz, &angles)?;
    let direction = reference / reference.norm() * Complex64::from_polar(1.0, -sweep.turn);
    let square = mobility.iter().map(|y| ((y - centre).norm() - radius).powi(2)).sum::<f64>();
    let omega = TAU * sweep.natural_hz;
    Some(CircleFit {
        natural_hz: sweep.natural_hz,
        ratio: sweep.ratio,
        centre,
        radius,
        modal_constant: direction * (4.0 * radius * sweep.ratio * omega),
        scatter: (square / count as f64).sqrt() / radius,
        angle_scatter: (sweep.square(frequency_hz, &angles) / count as f64).sqrt(),
        arc: (angles[count - 1] - angles[0]).abs(),
    })
}

/// Most steps of either iteration; both converge quadratically.
const STEPS: usize = 50;

/// Centre and radius with the least sum of squared distances.
fn least_squares_circle(points: &[Complex64]) -> Option<(Complex64, f64)> {
    let count = points.len() as f64;
    let mean = points.iter().sum::<Complex64>() / count;
    let scale = (points.iter().map(|z| (z - mean).norm_sqr()).sum::<f64>() / count).sqrt();
    if scale.is_nan() || scale <= 0.0 {
        return None;
    }
    let unit: Vec<(f64, f64)> =
        points.iter().map(|z| (z - mean) / scale).map(|z| (z.re, z.im)).collect();
    // |z|^2 = 2 a x + 2 b y + c, linear in a, b and c.
    let algebraic =
        least_squares(unit.iter().map(|&(x, y)| ([2.0 * x, 2.0 * y, 1.0], x * x + y * y)))?;
    let [mut a, mut b, c] = algebraic;
    let mut radius = (c + a * a + b * b).sqrt();
    for _ in 0..STEPS {
        let observation = |&(x, y): &(f64, f64)| {
            let distance = (x - a).hypot(y - b);
            ([(x - a) / distance, (y - b) / distance, 1.0], distance - radius)
        };
        let [da, db, dr] = least_squares(unit.iter().map(observation))?;
        (a, b, radius) = (a + da, b + db, radius + dr);
        if da.abs() + db.abs() + dr.abs() < 1e-14 * radius {
            break;
        }
    }
    let found = radius.is_finite() && radius > 0.0 && a.is_finite() && b.is_finite();
    found.then(|| (mean + Complex64::new(a, b) * scale, radius * scale))
}

/// Natural frequency, damping ratio and the angle at resonance (`turn`).
#[derive(Debug, Clone, Copy)]
struct AngleFit {
    natural_hz: f64,
    ratio: f64,
    turn: f64,
}

impl AngleFit {
    /// Least squares of `turn + 2 atan(q)` on the angles.
    fn fitted(frequency_hz: &[f64], angles: &[f64]) -> Option<Self> {
        let mut best = Self::start(frequency_hz, angles)?;
        let mut square = best.square(frequency_hz, angles);
        for _ in 0..STEPS {
            let pairs = frequency_hz.iter().zip(angles);
            let step = least_squares(pairs.map(|(f, angle)| best.observation(*f, *angle)))?;
            let mut factor = 1.0;
            let mut better = None;
            for _ in 0..20 {
                let trial = best.moved(&step, factor);
                let found = trial.square(frequency_hz, angles);
                if found < square {
                    better = Some((trial, found));
                    break;
                }
                factor *= 0.5;
            }
            // No shorter step reduces the sum: the minimum to rounding.
            let Some((trial, found)) = better else {
                break;
            };
            (best, square) = (trial, found);
        }
        let found = best.ratio.is_finite() && best.ratio > 0.0 && best.natural_hz.is_finite();
        found.then_some(best)
    }

    /// The start, without `turn`: `x tan(angle / 2) = alpha (x^2 - 1) + (alpha - beta)`, a line,
    /// with `x = w` over the middle one, `alpha = 1/(2 zeta x0)`, `beta = x0/(2 zeta)`.
    fn start(frequency_hz: &[f64], angles: &[f64]) -> Option<Self> {
        let middle = frequency_hz[frequency_hz.len() / 2];
        let near = |angle: &f64| angle.abs() < 0.8 * PI;
        let point = |(f, angle): (&f64, &f64)| {
            let over = f / middle;
            ((over - 1.0) * (over + 1.0), over * (0.5 * angle).tan())
        };
        let pairs = frequency_hz.iter().zip(angles).filter(|(_, angle)| near(angle));
        let points: Vec<(f64, f64)> = pairs.map(point).collect();
        let count = points.len() as f64;
        let x_mean = points.iter().map(|(x, _)| x).sum::<f64>() / count;
        let y_mean = points.iter().map(|(_, y)| y).sum::<f64>() / count;
        let cross: f64 = points.iter().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
        let square: f64 = points.iter().map(|(x, _)| (x - x_mean).powi(2)).sum();
        let alpha = cross / square;
        let beta = alpha - (y_mean - alpha * x_mean);
        (alpha > 0.0 && beta > 0.0 && alpha.is_finite()).then(|| Self {
            natural_hz: middle * (beta / alpha).sqrt(),
            ratio: 0.5 / (alpha * beta).sqrt(),
            turn: 0.0,
        })
    }

    fn q(&self, frequency: f64) -> f64 {
        let over = frequency / self.natural_hz;
        (over - 1.0 / over) / (2.0 * self.ratio)
    }

    /// Derivatives of the angle with respect to `turn`, `ln w0` and `ln zeta`, and its residual.
    fn observation(&self, frequency: f64, angle: f64) -> ([f64; 3], f64) {
        let q = self.q(frequency);
        let over = frequency / self.natural_hz;
        let slope = 2.0 / (1.0 + q * q);
        let d_frequency = -slope * (over + 1.0 / over) / (2.0 * self.ratio);
        ([1.0, d_frequency, -slope * q], self.residual(frequency, angle))
    }

    fn residual(&self, frequency: f64, angle: f64) -> f64 {
        let residual = angle - self.turn - 2.0 * self.q(frequency).atan();
        residual - TAU * (residual / TAU).round()
    }

    fn square(&self, frequency_hz: &[f64], angles: &[f64]) -> f64 {
        frequency_hz.iter().zip(angles).map(|(f, angle)| self.residual(*f, *angle).powi(2)).sum()
    }

    fn moved(&self, step: &[f64; 3], factor: f64) -> Self {
        Self {
            turn: self.turn + factor * step[0],
            natural_hz: self.natural_hz * (factor * step[1]).exp(),
            ratio: self.ratio * (factor * step[2]).exp(),
        }
    }
}
