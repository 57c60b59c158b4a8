//! Names and units of columns.

use crate::{Abscissa, Channel, ChannelQuantity, ChannelUnit, Origin, Samples, Unit};

/// Name and unit of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Heading {
    pub(crate) name: String,
    pub(crate) unit: ChannelUnit,
}

impl Heading {
    /// The heading of a text such as `Force (N)`, `Force [N]`, `Force/N`, `force_N`,
    /// `acceleration_m_per_s2`.
    pub(crate) fn parse(text: &str) -> Self {
        let text = asperity_table::unquoted(text.trim());
        in_brackets(text)
            .or_else(|| after_slash(text))
            .or_else(|| after_underscore(text))
            .unwrap_or_else(|| Self::bare(text.to_owned()))
    }

    /// A name without unit.
    pub(crate) fn bare(name: String) -> Self {
        Self { name, unit: ChannelUnit::Missing }
    }

    /// A channel of this name and unit, without further information.
    pub(crate) fn channel(self, abscissa: Abscissa, samples: Samples) -> Channel {
        let Self { name, unit } = self;
        let (quantity, origin) = (ChannelQuantity::Unknown, Origin::default());
        Channel { name, quantity, unit, abscissa, samples, origin }
    }

    /// Quantity of the column, from its unit, else from its name.
    pub(crate) fn quantity(&self) -> ChannelQuantity {
        let by_unit = self.unit.known().map(|unit| unit.quantity());
        by_unit.unwrap_or_else(|| ChannelQuantity::of_name(&self.name))
    }
}

/// True if one word is a unit and every word is a unit or states none.
pub(crate) fn are_units(words: &[String]) -> bool {
    let known = |word: &String| Unit::parse(word).is_some();
    words.iter().any(known) && words.iter().all(|word| known(word) || crate::unit::says_none(word))
}

fn in_brackets(text: &str) -> Option<Heading> {
    let square = text.ends_with(']');
    let (open, close) = if square { ('[', ']') } else { ('(', ')') };
    let inside = text.strip_suffix(close)?;
    // The bracket that opens first, as in `acc (m/(s^2))`.
    let (name, unit) = inside.split_once(open)?;
    let unit = ChannelUnit::of_text(unit);
    // Round brackets may contain remarks: `force (rear)`.
    if !square && matches!(unit, ChannelUnit::Unrecognised(_)) {
        return None;
    }
    Some(Heading { name: name.trim().to_owned(), unit })
}

fn after_slash(text: &str) -> Option<Heading> {
    let (name, unit) = text.split_once('/')?;
    let unit = Unit::parse(unit)?;
    if Unit::parse(text).is_some() || name.trim().is_empty() {
        return None;
    }
    Some(Heading { name: name.trim().to_owned(), unit: ChannelUnit::Known(unit) })
}

fn after_underscore(text: &str) -> Option<Heading> {
    let starts = text.char_indices().filter(|(_, c)| *c == '_').map(|(index, _)| index);
    starts.take(8).find_map(|start| {
        let (name, suffix) = (&text[..start], &text[start + 1..]);
        let unit = suffix_unit(suffix)?;
        let (stated, by_unit) = (ChannelQuantity::of_name(name), unit.quantity());
        let sensor = matches!(by_unit, ChannelQuantity::Voltage | ChannelQuantity::FullScale);
        // `force_in` is an input, not a length.
        let fits =
            sensor || stated == by_unit || stated == ChannelQuantity::Unknown && suffix != "in";
        // The last unit of `stiffness_pa_per_m` is a part of another.
        let is_whole = !name.ends_with("_per") && !name.is_empty();
        (fits && is_whole)
            .then(|| Heading { name: name.to_owned(), unit: ChannelUnit::Known(unit) })
    })
}

/// A unit in letters: `m_per_s2`, `m_s2`, and SI units such as `n` for newton.
fn suffix_unit(suffix: &str) -> Option<Unit> {
    let with_slash = if suffix.contains("_per_") {
        suffix.replacen("_per_", "/", 1)
    } else {
        suffix.replacen('_', "/", 1)
    };
    match with_slash.as_str() {
        "n" => Unit::parse("N"),
        "v" => Unit::parse("V"),
        other => Unit::parse(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_as_people_write_them() {
        for (text, name, unit) in [
            ("time_s", "time", "s"),
            ("force_N", "force", "N"),
            ("force_n", "force", "N"),
            ("acc_m_s2", "acc", "m/s^2"),
            ("acceleration_m_per_s2", "acceleration", "m/s^2"),
            ("Force (N)", "Force", "N"),
            ("Force [kN]", "Force", "kN"),
            ("Acc 1 [m/s²]", "Acc 1", "m/s^2"),
            ("acc (m/(s^2))", "acc", "m/s^2"),
            ("F/N", "F", "N"),
            ("a/m/s^2", "a", "m/s^2"),
            ("hammer_1_mV", "hammer_1", "mV"),
            ("stiffness_pa_per_m", "stiffness_pa_per_m", ""),
            ("receptance_m_per_n", "receptance_m_per_n", ""),
            ("Force [-]", "Force", ""),
            ("Force [furlong]", "Force", "furlong"),
            ("force (rear)", "force (rear)", ""),
            ("force_in", "force_in", ""),
            ("signal_in", "signal_in", ""),
            ("acc_x", "acc_x", ""),
            ("_s", "_s", ""),
            ("'=1+2 (N)", "=1+2", "N"),
            ("'-x_s", "-x", "s"),
            ("", "", ""),
        ] {
            let heading = Heading::parse(text);
            assert_eq!((heading.name.as_str(), heading.unit.text()), (name, unit), "{text}");
        }
    }

    #[test]
    fn a_row_of_units() {
        let row =
            |words: &[&str]| are_units(&words.iter().map(|&w| w.to_owned()).collect::<Vec<_>>());
        assert!(row(&["s", "N", "m/s^2"]) && row(&["[s]", "[N]", "-"]) && row(&["s", ""]));
        assert!(!row(&["time", "N"]) && !row(&["", "-"]));
    }
}
