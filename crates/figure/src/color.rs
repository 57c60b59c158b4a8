//! Colours: the paper's three, a categorical palette and a sequential ramp.

use std::fmt;

/// An opaque sRGB colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Color {
    /// Red, 0 to 255.
    pub red: u8,
    /// Green, 0 to 255.
    pub green: u8,
    /// Blue, 0 to 255.
    pub blue: u8,
}

/// Categorical palette in order of use: distinct under the common colour vision deficiencies and in
/// lightness (after Okabe and Ito, darkened where the original is too pale for lines on white).
pub const CATEGORIES: [Color; 7] =
    [Color::BLACK, Color::BLUE, Color::RED, Color::GREEN, Color::PURPLE, Color::ORANGE, Color::SKY];

/// Twenty anchors of the viridis ramp, dark to light (CC0).
const RAMP: [u32; 20] = [
    0x44_0154, 0x48_1567, 0x48_2677, 0x45_3781, 0x40_4788, 0x39_568c, 0x33_638d, 0x2d_708e,
    0x28_7d8e, 0x23_8a8d, 0x1f_968b, 0x20_a387, 0x29_af7f, 0x3c_bb75, 0x55_c667, 0x73_d055,
    0x95_d840, 0xb8_de29, 0xdc_e319, 0xfd_e725,
];

/// The ramp stops before the yellow end, which cannot be read as a line on white.
const RAMP_END: f64 = 0.88;

impl Color {
    /// Black.
    pub const BLACK: Self = Self::hex(0x00_0000);
    /// White.
    pub const WHITE: Self = Self::hex(0xff_ffff);
    /// Mid grey, for references and secondary marks.
    pub const GREY: Self = Self::hex(0x7a_7a7a);
    /// Light grey, for grids and bands.
    pub const LIGHT_GREY: Self = Self::hex(0xd9_d9d9);
    /// Blue.
    pub const BLUE: Self = Self::hex(0x00_58c8);
    /// Red.
    pub const RED: Self = Self::hex(0xd0_1c1f);
    /// Bluish green.
    pub const GREEN: Self = Self::hex(0x00_8a63);
    /// Reddish purple.
    pub const PURPLE: Self = Self::hex(0xa8_4a92);
    /// Orange.
    pub const ORANGE: Self = Self::hex(0xe0_8a00);
    /// Sky blue.
    pub const SKY: Self = Self::hex(0x3f_a7dd);

    /// A colour from its components.
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// A colour from `0xRRGGBB`.
    pub const fn hex(rgb: u32) -> Self {
        Self::rgb((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8)
    }

    /// Entry `index` of the categorical palette, cyclic.
    pub const fn category(index: usize) -> Self {
        CATEGORIES[index % CATEGORIES.len()]
    }

    /// The sequential ramp at `fraction` in [0, 1], dark to light; values outside are clamped and
    /// NaN is taken as 0.
    pub fn ramp(fraction: f64) -> Self {
        let fraction = if fraction.is_nan() { 0.0 } else { fraction.clamp(0.0, 1.0) };
        let position = fraction * RAMP_END * (RAMP.len() - 1) as f64;
        let index = (position.floor() as usize).min(RAMP.len() - 2);
        Self::hex(RAMP[index]).mix(Self::hex(RAMP[index + 1]), position - index as f64)
    }

    /// The ramp colour of item `index` among `count`, the first dark and the last light.
    pub fn ramp_step(index: usize, count: usize) -> Self {
        Self::ramp(index as f64 / count.saturating_sub(1).max(1) as f64)
    }

    /// This colour mixed with `other`: `self` at 0, `other` at 1.
    #[must_use]
    pub fn mix(self, other: Self, fraction: f64) -> Self {
        let blend = |a: u8, b: u8| {
            (f64::from(a) + fraction.clamp(0.0, 1.0) * (f64::from(b) - f64::from(a))).round() as u8
        };
        Self::rgb(
            blend(self.red, other.red),
            blend(self.green, other.green),
            blend(self.blue, other.blue),
        )
    }

    /// This colour mixed with white: unchanged at 0, white at 1.
    #[must_use]
    pub fn lighten(self, fraction: f64) -> Self {
        self.mix(Self::WHITE, fraction)
    }
}

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.red, self.green, self.blue)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramp_starts_dark_and_grows_lighter() {
        let luminance = |c: Color| {
            0.2126 * f64::from(c.red) + 0.7152 * f64::from(c.green) + 0.0722 * f64::from(c.blue)
        };
        let levels: Vec<f64> = (0..=20).map(|i| luminance(Color::ramp_step(i, 21))).collect();
        assert!(levels.windows(2).all(|w| w[1] > w[0]), "{levels:?}");
        assert_eq!(Color::ramp(-1.0), Color::ramp(f64::NAN));
        assert_eq!(Color::ramp(2.0), Color::ramp(1.0));
        assert_eq!(Color::ramp_step(0, 1), Color::ramp(0.0));
    }

    #[test]
    fn displays_as_css() {
        assert_eq!(Color::hex(0x01_02ff).to_string(), "#0102ff");
        assert_eq!(Color::BLACK.lighten(1.0), Color::WHITE);
    }
}
