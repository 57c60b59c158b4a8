//! What a channel measures.

use std::fmt;

/// A measured quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Quantity {
    /// Force, SI unit N.
    Force,
    /// Acceleration, SI unit m/s^2.
    Acceleration,
    /// Velocity, SI unit m/s.
    Velocity,
    /// Displacement or length, SI unit m.
    Displacement,
    /// Pressure or stress, SI unit Pa.
    Pressure,
    /// Strain, SI unit 1 (written m/m).
    Strain,
    /// Voltage of a sensor that is not yet calibrated, SI unit V.
    Voltage,
    /// Fraction of a converter's full scale, not yet calibrated.
    FullScale,
    /// Time, SI unit s.
    Time,
    /// Frequency, SI unit Hz.
    Frequency,
    /// Not said by the file.
    #[default]
    Unknown,
}

impl Quantity {
    /// Symbol of the SI unit; empty where there is none.
    pub fn si_symbol(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Acceleration => "m/s^2",
            Self::Velocity => "m/s",
            Self::Displacement => "m",
            Self::Pressure => "Pa",
            Self::Strain => "m/m",
            Self::Voltage => "V",
            Self::FullScale => "FS",
            Self::Time => "s",
            Self::Frequency => "Hz",
            Self::Unknown => "",
        }
    }

    /// The quantity that a channel's name speaks of: `force`, `hammer`, `acc 2`, `Mic 01`.
    /// A word counts, not a part of one, so that `reinforcement` is no force.
    pub fn of_name(name: &str) -> Self {
        let lower = name.to_lowercase();
        let words = lower.split(|character: char| !character.is_alphabetic());
        words.map(of_word).find(|quantity| *quantity != Self::Unknown).unwrap_or_default()
    }
}

fn of_word(word: &str) -> Quantity {
    match word {
        "force" | "hammer" | "impact" | "kraft" => Quantity::Force,
        "acc" | "accel" | "acceleration" | "accelerometer" | "beschleunigung" => {
            Quantity::Acceleration
        }
        "vel" | "velocity" | "geschwindigkeit" => Quantity::Velocity,
        "disp" | "displacement" | "weg" => Quantity::Displacement,
        "pressure" | "mic" | "microphone" => Quantity::Pressure,
        "strain" => Quantity::Strain,
        "volt" | "voltage" => Quantity::Voltage,
        "t" | "time" | "zeit" => Quantity::Time,
        "freq" | "frequency" | "frequenz" => Quantity::Frequency,
        _ => Quantity::Unknown,
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Force => "force",
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
            Self::Pressure => "pressure",
            Self::Strain => "strain",
            Self::Voltage => "voltage",
            Self::FullScale => "fraction of full scale",
            Self::Time => "time",
            Self::Frequency => "frequency",
            Self::Unknown => "an unknown quantity",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_speak_of_quantities_by_whole_words() {
        assert_eq!(Quantity::of_name("Hammer force 1"), Quantity::Force);
        assert_eq!(Quantity::of_name("acc_z"), Quantity::Acceleration);
        assert_eq!(Quantity::of_name("Mic 01.0Scalar"), Quantity::Pressure);
        assert_eq!(Quantity::of_name("reinforcement"), Quantity::Unknown);
        assert_eq!(Quantity::of_name("Time"), Quantity::Time);
    }
}
