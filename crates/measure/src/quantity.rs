//! Quantities of channels.

use std::fmt;

/// The quantity of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum ChannelQuantity {
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
    /// Voltage of a sensor before calibration, SI unit V.
    Voltage,
    /// Fraction of a converter's full scale, before calibration.
    FullScale,
    /// Time, SI unit s.
    Time,
    /// Frequency, SI unit Hz.
    Frequency,
    /// Not given by the file.
    #[default]
    Unknown,
}

impl ChannelQuantity {
    /// Symbol of the SI unit; empty where there is none.
    pub fn si_symbol(self) -> &'static str {
        self.name_and_symbol().1
    }

    fn name_and_symbol(self) -> (&'static str, &'static str) {
        match self {
            Self::Force => ("force", "N"),
            Self::Acceleration => ("acceleration", "m/s^2"),
            Self::Velocity => ("velocity", "m/s"),
            Self::Displacement => ("displacement", "m"),
            Self::Pressure => ("pressure", "Pa"),
            Self::Strain => ("strain", "m/m"),
            Self::Voltage => ("voltage", "V"),
            Self::FullScale => ("fraction of full scale", "FS"),
            Self::Time => ("time", "s"),
            Self::Frequency => ("frequency", "Hz"),
            Self::Unknown => ("an unknown quantity", ""),
        }
    }

    /// The quantity of a channel's name, by whole words: `force`, `hammer`, `acc 2`, `Mic 01`.
    pub fn of_name(name: &str) -> Self {
        let lower = name.to_lowercase();
        let words = lower.split(|character: char| !character.is_alphabetic());
        words.map(of_word).find(|quantity| *quantity != Self::Unknown).unwrap_or_default()
    }
}

fn of_word(word: &str) -> ChannelQuantity {
    match word {
        "force" | "hammer" | "impact" | "kraft" => ChannelQuantity::Force,
        "acc" | "accel" | "acceleration" | "accelerometer" | "beschleunigung" => {
            ChannelQuantity::Acceleration
        }
        "vel" | "velocity" | "geschwindigkeit" => ChannelQuantity::Velocity,
        "disp" | "displacement" | "weg" => ChannelQuantity::Displacement,
        "pressure" | "mic" | "microphone" => ChannelQuantity::Pressure,
        "strain" => ChannelQuantity::Strain,
        "volt" | "voltage" => ChannelQuantity::Voltage,
        "t" | "time" | "zeit" => ChannelQuantity::Time,
        "freq" | "frequency" | "frequenz" => ChannelQuantity::Frequency,
        _ => ChannelQuantity::Unknown,
    }
}

impl fmt::Display for ChannelQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name_and_symbol().0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_quantities_by_whole_words() {
        assert_eq!(ChannelQuantity::of_name("Hammer force 1"), ChannelQuantity::Force);
        assert_eq!(ChannelQuantity::of_name("acc_z"), ChannelQuantity::Acceleration);
        assert_eq!(ChannelQuantity::of_name("Mic 01.0Scalar"), ChannelQuantity::Pressure);
        assert_eq!(ChannelQuantity::of_name("reinforcement"), ChannelQuantity::Unknown);
        assert_eq!(ChannelQuantity::of_name("Time"), ChannelQuantity::Time);
    }
}
