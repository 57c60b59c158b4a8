//! Laws against values computed elsewhere: SciPy 1.17.1 for the interpolants, mpmath at 40 digits
//! for the integrals and the power law.

use asperity_law::{ContactLaw, ModifiedPower, Power, Tabulated, fit_power};

const TABLE_3: [(f64, f64); 4] =
    [(0.14e6, 1.15e12), (0.35e6, 1.75e12), (0.57e6, 1.63e12), (1e6, 2.46e12)];

const KNOTS: [(f64, f64); 4] =
    [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];

fn close(what: &str, found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off <= relative, "{what}: {found:e}, expected {expected:e}, off by {off:e}");
}

/// `PchipInterpolator` and its derivative; 1e-13 is the rounding of two cubics in other forms.
#[test]
fn table_is_scipys_pchip() {
    let law = Tabulated::new(&TABLE_3).unwrap();
    for (p, k, slope) in [
        (0.2e6, 1_407_283_390_553.442_9, 3_959_652.118_171_34),
        (0.3e6, 1_705_143_680_345.388_7, 1_726_485.822_356_728_6),
        (0.4e6, 1_734_222_389_181.067, -574_755.822_689_706_9),
        (0.5e6, 1_658_715_251_690.458_3, -709_992.486_851_990_9),
        (0.7e6, 1_713_882_231_067.133, 1_263_763.853_840_199),
        (0.95e6, 2_289_619_446_798.940_4, 3_243_272.892_979_208),
    ] {
        close("stiffness", law.stiffness(p), k, 1e-13);
        close("slope", law.stiffness_slope(p), slope, 1e-11);
    }
    // Held below the first point.
    close("closure", law.closure(0.5e6), 3.488_214_018_400_698e-7, 1e-14);
    close("energy", law.energy(law.closure(0.5e6)), 0.078_932_158_385_118_5, 1e-14);
}

#[test]
fn table_is_held_outside_its_points() {
    let law = Tabulated::new(&TABLE_3).unwrap();
    assert_eq!(law.measured_range(), Some((0.14e6, 1e6)));
    for p in [0.0, 0.07e6, 0.139e6] {
        assert_eq!((law.stiffness(p), law.stiffness_slope(p)), (1.15e12, 0.0));
    }
    for p in [1e6, 1e7, 1e12] {
        assert_eq!((law.stiffness(p), law.stiffness_slope(p)), (2.46e12, 0.0));
    }
    let high = law.closure(3e6) - law.closure(1e6);
    close("closure above", high, 2e6 / 2.46e12, 1e-14);
}

/// Slopes where secants change sign, flat data, and ends that need limiting (all from SciPy).
#[test]
fn slopes_are_scipys() {
    type Case = (&'static [(f64, f64)], &'static [f64]);
    let cases: [Case; 4] = [
        (
            &[(0.0, 1.0), (1.0, 1.1), (2.0, 5.0), (5.0, 4.0), (6.0, 9.0), (10.0, 9.5)],
            &[0.0, 0.195_000_000_000_000_15, 0.0, 0.0, 0.301_204_819_277_108_46],
        ),
        (&[(0.0, 1.0), (1.0, 6.0), (4.0, 5.0)], &[6.333_333_333_333_333, 0.0]),
        (&[(0.0, 4.0), (3.0, 5.0), (4.0, 30.0)], &[0.0, 0.785_340_314_136_125_7]),
        (&[(0.0, 1.0), (3.0, 4.0), (4.0, 1.5)], &[3.0, 0.0]),
    ];
    for (points, slopes) in cases {
        let law = Tabulated::new(points).unwrap();
        for (point, slope) in points.iter().zip(slopes) {
            let found = law.stiffness_slope(point.0);
            assert!((found - slope).abs() < 1e-14 * (1.0 + slope), "{found}, expected {slope}");
        }
    }
    // From the left of the last point.
    let law = Tabulated::new(&[(0.0, 4.0), (3.0, 5.0), (4.0, 30.0)]).unwrap();
    close("last slope", law.stiffness_slope(4.0_f64.next_down()), 31.166_666_666_666_67, 1e-13);
}

/// `CubicHermiteSpline` with PCHIP slopes and the power law's at the joint.
#[test]
fn modified_power_of_the_paper() {
    let law = ModifiedPower::new(1.81e10, 0.35, 2e5, &KNOTS).unwrap();
    for (p, k, slope) in [
        (0.01e6, 57_370_533_527.802_93, 3_896_138.868_051_519_6),
        (0.05e6, 237_865_574_209.366_64, 5_078_606.941_614_899),
        (0.1e6, 590_952_415_189.951_2, 10_080_913.682_757_994),
        (0.17e6, 1_167_903_102_352.168_5, 5_905_428.564_973_501_5),
        (0.195e6, 1_283_929_442_415.560_3, 3_063_834.533_471_604),
    ] {
        close("stiffness", law.stiffness(p), k, 1e-13);
        close("slope", law.stiffness_slope(p), slope, 1e-11);
    }
    close("closure", law.closure(0.17e6), 8.244_716_039_606_587e-7, 1e-14);
    close("energy", law.energy(law.closure(0.17e6)), 0.029_577_451_070_835_117, 1e-14);
    close("closure above", law.closure(1e6), 1.286_637_482_986_879_7e-6, 1e-14);
    // Once continuously differentiable at the joint.
    let power = Power::new(1.81e10, 0.35, 0.0).unwrap();
    for p in [2e5_f64.next_down(), 2e5] {
        close("joint", law.stiffness(p), power.stiffness(p), 1e-14);
        close("joint slope", law.stiffness_slope(p), power.stiffness_slope(p), 1e-11);
    }
}

/// Closure increments next to m = 1, where the textbook form is wrong by 11 %.
#[test]
fn power_keeps_its_precision_next_to_one() {
    let (c, p0) = (1.81e10, 1.4e5);
    for (m, dp, expected) in [
        (1.0 - 1e-6, 1.4e-4, 5.524_927_342_364_093e-20),
        (1.0 - 1e-6, -7e4, -3.829_586_484_839_324e-11),
        (1.0 - 1e-6, 1e9, 4.902_846_769_294_755e-10),
        (0.35, 1.4e-4, 1.222_657_027_045_946_7e-16),
        (0.35, -7e4, -6.822_796_514_300_971e-8),
        (0.35, 1e9, 5.999_126_193_394_909e-5),
        (1.0, 1.4e-4, 5.524_861_875_690_607e-20),
        (1.0, -7e4, -3.829_542_434_032_847e-11),
        (1.0, 1e9, 4.902_766_920_196_621e-10),
        (1.0 + 1e-6, 1.4e-4, 5.524_796_409_792_865e-20),
        (1.0 + 1e-6, -7e4, -3.829_498_383_733_234e-11),
        (1.0 + 1e-6, 1e9, 4.902_687_072_431_113e-10),
        (2.5, 1.4e-4, 1.054_701_032_274_458_6e-27),
        (2.5, -7e4, -1.285_629_318_879_321_5e-18),
        (2.5, 1e9, 7.031_328_578_966_237e-19),
    ] {
        let law = Power::new(c, m, p0).unwrap();
        // A power, a product and a quotient.
        close("increment", law.closure_increment(p0, dp), expected, 1e-15);
        let condition = 1.0 + law.stiffness(p0 + dp) * expected / dp;
        close("inverse", law.pressure_increment(p0, expected).value, dp, 1e-15 * condition);
    }
}

#[test]
fn power_energy() {
    let law = Power::new(1.81e10, 2.5, 1.4e5).unwrap();
    let d = law.closure(7e4);
    close("energy", law.energy(d), -1.223_240_122_616_606e-13, 1e-14);
    let law = Power::new(1.81e10, 1.0, 1.4e5).unwrap();
    close("energy", law.energy(law.closure(7e4)), -3.867_403_314_917_127e-6, 1e-14);
}

/// `scipy.stats.linregress` on the logarithms; C is the exponential of an intercept, which
/// magnifies rounding by the mean of ln K, 28.
#[test]
fn fit_of_table_3() {
    let fit = fit_power(&TABLE_3).unwrap();
    close("coefficient", fit.coefficient, 18_101_387_236.153_915, 1e-12);
    close("exponent", fit.exponent, 0.350_885_960_683_815_7, 1e-13);
    close("rms", fit.residual_log_rms, 0.093_771_228_650_718_63, 1e-12);
    let errors = fit.errors.unwrap();
    close("error of ln C", errors.log_coefficient, 1.189_058_631_396_655_6, 1e-12);
    close("error of m", errors.exponent, 0.091_882_108_154_880_52, 1e-12);
    let law = fit.law(0.0).unwrap();
    assert_eq!((law.coefficient(), law.exponent()), (fit.coefficient, fit.exponent));
}

#[test]
fn fit_of_a_power_law_is_that_law() {
    let law = Power::new(3e9, 0.6, 0.0).unwrap();
    let points: Vec<_> = [1e3, 2e4, 3e5, 4e6].map(|p| (p, law.stiffness(p))).to_vec();
    for count in 2..=4 {
        let fit = fit_power(&points[..count]).unwrap();
        close("coefficient", fit.coefficient, 3e9, 1e-13);
        close("exponent", fit.exponent, 0.6, 1e-14);
        assert!(fit.residual_log_rms < 1e-14);
        assert_eq!(fit.errors.is_some(), count > 2);
    }
}
