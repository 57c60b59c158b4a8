//! Units, their spellings and their factors to SI.

use std::fmt;

use crate::{ChannelQuantity, MeasureError};

/// Standard gravity \[m/s^2\], exact (BIPM, 3rd CGPM).
pub const STANDARD_GRAVITY: f64 = 9.80665;
/// Pound-force \[N\], exact: 0.45359237 kg times standard gravity.
const POUND_FORCE: f64 = 4.448_221_615_260_5;
/// Inch \[m\], exact.
const INCH: f64 = 0.0254;

/// A unit of a quantity: `value in SI = factor * value in this unit`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    symbol: &'static str,
    quantity: ChannelQuantity,
    factor: f64,
}

/// Symbol, spellings once normalised (see [`normalised`]), quantity, factor to SI.
type UnitRow = (&'static str, &'static [&'static str], ChannelQuantity, f64);

const TABLE: &[UnitRow] = &[
    ("N", &["N", "Newton", "newton", "newtons"], ChannelQuantity::Force, 1.0),
    ("kN", &["kN"], ChannelQuantity::Force, 1e3),
    ("mN", &["mN"], ChannelQuantity::Force, 1e-3),
    ("MN", &["MN"], ChannelQuantity::Force, 1e6),
    ("lbf", &["lbf", "lb_f"], ChannelQuantity::Force, POUND_FORCE),
    ("kgf", &["kgf", "kp"], ChannelQuantity::Force, STANDARD_GRAVITY),
    // Masses do not occur in hammer tests: g is the acceleration.
    (
        "g",
        &["g", "G", "gs", "g's", "g_n", "gn", "g0"],
        ChannelQuantity::Acceleration,
        STANDARD_GRAVITY,
    ),
    ("mg", &["mg"], ChannelQuantity::Acceleration, 1e-3 * STANDARD_GRAVITY),
    ("m/s^2", &["m/s2", "m/s/s", "ms-2", "m/(s2)"], ChannelQuantity::Acceleration, 1.0),
    ("mm/s^2", &["mm/s2", "mm/s/s", "mms-2"], ChannelQuantity::Acceleration, 1e-3),
    ("in/s^2", &["in/s2", "in/s/s"], ChannelQuantity::Acceleration, INCH),
    ("m/s", &["m/s", "ms-1"], ChannelQuantity::Velocity, 1.0),
    ("mm/s", &["mm/s", "mms-1"], ChannelQuantity::Velocity, 1e-3),
    ("um/s", &["um/s"], ChannelQuantity::Velocity, 1e-6),
    ("in/s", &["in/s", "ips"], ChannelQuantity::Velocity, INCH),
    ("m", &["m"], ChannelQuantity::Displacement, 1.0),
    ("mm", &["mm"], ChannelQuantity::Displacement, 1e-3),
    ("um", &["um", "micron"], ChannelQuantity::Displacement, 1e-6),
    ("nm", &["nm"], ChannelQuantity::Displacement, 1e-9),
    ("in", &["in", "inch"], ChannelQuantity::Displacement, INCH),
    ("mil", &["mil", "mils"], ChannelQuantity::Displacement, 1e-3 * INCH),
    ("V", &["V", "Volt", "volt", "volts"], ChannelQuantity::Voltage, 1.0),
    ("mV", &["mV"], ChannelQuantity::Voltage, 1e-3),
    ("uV", &["uV"], ChannelQuantity::Voltage, 1e-6),
    ("FS", &["FS"], ChannelQuantity::FullScale, 1.0),
    ("Pa", &["Pa", "N/m2"], ChannelQuantity::Pressure, 1.0),
    ("kPa", &["kPa"], ChannelQuantity::Pressure, 1e3),
    ("MPa", &["MPa"], ChannelQuantity::Pressure, 1e6),
    ("bar", &["bar"], ChannelQuantity::Pressure, 1e5),
    ("psi", &["psi"], ChannelQuantity::Pressure, POUND_FORCE / (INCH * INCH)),
    ("m/m", &["m/m"], ChannelQuantity::Strain, 1.0),
    ("um/m", &["um/m", "ustrain", "microstrain"], ChannelQuantity::Strain, 1e-6),
    ("s", &["s", "second", "seconds"], ChannelQuantity::Time, 1.0),
    ("ms", &["ms"], ChannelQuantity::Time, 1e-3),
    ("us", &["us"], ChannelQuantity::Time, 1e-6),
    ("min", &["min"], ChannelQuantity::Time, 60.0),
    ("Hz", &["Hz", "1/s"], ChannelQuantity::Frequency, 1.0),
    ("kHz", &["kHz"], ChannelQuantity::Frequency, 1e3),
];

impl Unit {
    /// The unit of a text; none if it is unknown.
    ///
    /// Brackets, blanks, `^`, `**`, `·` and superscripts are ignored:
    /// `m/s^2`, `m/s**2`, `m/s²`, `[m/s2]`. Case matters, since `mN` and `MN`
    /// differ, unless only one unit has the spelling of two letters or more without regard to
    /// case (`PA`, `LBF`, `M/S2`). `g` is
    /// the acceleration. `-`, `NONE` and the like are no unit.
    pub fn parse(text: &str) -> Option<Self> {
        let normal = normalised(text);
        let exact = TABLE.iter().find(|row| row.1.contains(&normal.as_str()));
        exact.or_else(|| case_blind(&normal)).map(Self::of_row)
    }

    /// The unit of a text, or the error of an unknown one.
    pub(crate) fn require(text: &str) -> Result<Self, MeasureError> {
        Self::parse(text).ok_or_else(|| MeasureError::NotUnderstood {
            quantity: "unit",
            text: text.to_owned(),
            example: "m/s^2",
        })
    }

    /// The SI unit of `quantity`; none for [`ChannelQuantity::Unknown`].
    pub fn si(quantity: ChannelQuantity) -> Option<Self> {
        let row = TABLE.iter().find(|row| row.2 == quantity && row.3 == 1.0);
        row.map(Self::of_row)
    }

    /// A unit that a file defines by its factor to SI.
    pub(crate) fn of_factor(quantity: ChannelQuantity, factor: f64) -> Self {
        let named = TABLE.iter().find(|row| row.2 == quantity && row.3 == factor);
        named.map_or(Self { symbol: "unit of the file", quantity, factor }, Self::of_row)
    }

    fn of_row(&(symbol, _, quantity, factor): &UnitRow) -> Self {
        Self { symbol, quantity, factor }
    }

    /// Symbol, such as `m/s^2`.
    pub fn symbol(&self) -> &'static str {
        self.symbol
    }

    /// Quantity of the unit.
    pub fn quantity(&self) -> ChannelQuantity {
        self.quantity
    }

    /// Value in SI of one unit.
    pub fn factor(&self) -> f64 {
        self.factor
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol)
    }
}

/// True for a text that states no unit: empty, `-`, `NONE`, `unknown`.
pub(crate) fn says_none(text: &str) -> bool {
    let bare = text.trim().trim_matches(|c| "[]()".contains(c)).trim().to_lowercase();
    ["", "-", "--", "none", "unknown", "n/a", "null"].contains(&bare.as_str())
}

fn case_blind(normal: &str) -> Option<&'static UnitRow> {
    if normal.len() < 2 {
        return None;
    }
    let mut fitting =
        TABLE.iter().filter(|row| row.1.iter().any(|known| known.eq_ignore_ascii_case(normal)));
    let first = fitting.next()?;
    fitting.next().is_none().then_some(first)
}

/// The spelling without blanks and signs of powers, in ASCII letters.
fn normalised(text: &str) -> String {
    let mut bare = text.trim();
    for (open, close) in [('(', ')'), ('[', ']')] {
        let inner = bare.strip_prefix(open).and_then(|rest| rest.strip_suffix(close));
        bare = inner.map_or(bare, str::trim);
    }
    let mut normal = String::with_capacity(bare.len());
    for character in bare.chars() {
        match character {
            '²' => normal.push('2'),
            '³' => normal.push('3'),
            '⁻' | '−' => normal.push('-'),
            '¹' => normal.push('1'),
            'µ' | 'μ' => normal.push('u'),
            '’' => normal.push('\''),
            '^' | '*' | '·' | '.' => {}
            blank if blank.is_whitespace() => {}
            other => normal.push(other),
        }
    }
    normal.replace("sec", "s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_many_spellings_of_one_unit() {
        let spellings =
            ["m/s^2", "m/s2", "m/s**2", "m/s²", "(m/s^2)", "[ m/s2 ]", "m·s⁻²", "M/S^2", "m/sec^2"];
        for text in spellings {
            assert_eq!(Unit::parse(text).map(|unit| unit.symbol()), Some("m/s^2"), "{text}");
        }
        for text in ["g", "G", "g's", "gs", "g_n", "[g]"] {
            let unit = Unit::parse(text).unwrap();
            assert_eq!((unit.quantity(), unit.factor()), (ChannelQuantity::Acceleration, 9.80665));
        }
    }

    #[test]
    fn factors_by_hand() {
        // Values from NIST SP 811, appendix B.
        for (text, factor) in [
            ("lbf", 4.448_221_615_260_5),
            ("kgf", 9.80665),
            ("psi", 6_894.757_293_168),
            ("mil", 2.54e-5),
            ("in/s^2", 0.0254),
            ("mN", 1e-3),
            ("kN", 1e3),
            ("µm", 1e-6),
            ("PA", 1.0),
        ] {
            let unit = Unit::parse(text).unwrap();
            assert!((unit.factor() / factor - 1.0).abs() < 1e-12, "{text}: {}", unit.factor());
        }
    }

    #[test]
    fn what_differs_by_case_and_what_is_no_unit() {
        assert_eq!(Unit::parse("MN").unwrap().factor(), 1e6);
        assert_eq!(Unit::parse("mn"), None, "milli or mega");
        for text in ["", "-", "NONE", "unknown", "kg", "furlong", "S", "(", "()"] {
            assert_eq!(Unit::parse(text), None, "{text}");
        }
        assert!(says_none(" NONE ") && says_none("[-]") && says_none("") && !says_none("furlong"));
    }

    #[test]
    fn every_quantity_has_its_si_unit_and_every_symbol_reads_back() {
        for row in TABLE {
            assert_eq!(Unit::parse(row.0), Some(Unit::of_row(row)), "{}", row.0);
            assert_eq!(Unit::si(row.2).unwrap().symbol(), row.2.si_symbol());
        }
        assert_eq!(Unit::si(ChannelQuantity::Unknown), None);
    }
}
