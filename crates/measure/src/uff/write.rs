//! Writing of universal files: datasets 151 and 164, which other tools expect, then a
//! dataset 58 or 58b for each channel.

use std::io::Write;

use crate::WriteOptions;
use crate::error::WriteFault;
use crate::record::joined_len;
use crate::uff::fields::text;
use crate::uff::header::{COHERENCE, FRF, SPECIFIC_TYPES};
use crate::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, DegreeOfFreedom, Format, Record, Samples,
};

/// Writes joined records; samples as doubles, binary ones little endian.
///
/// The step has seven digits, from which a whole rate is read back.
/// Abscissae of an uneven axis have six in text, all in binary.
pub(crate) fn write(
    out: &mut impl Write,
    records: &[Vec<&Record>],
    binary: bool,
    options: &WriteOptions,
) -> Result<(), WriteFault> {
    let first = records.first().and_then(|parts| parts.first());
    let said = |own: fn(&Record) -> &str, given| {
        first.map(|record| own(record)).filter(|text| !text.is_empty()).unwrap_or(given)
    };
    let title = said(|record| &record.title, &options.title);
    let date = said(|record| &record.date, &options.date);
    title_and_units(out, title, date)?;
    for parts in records {
        for index in 0..parts[0].channels.len() {
            let channel = &parts[0].channels[index];
            header(out, channel, joined_len(parts, index), binary)?;
            for part in parts {
                data(out, &part.channels[index], binary)?;
            }
            writeln!(out, "{:>6}", -1)?;
        }
    }
    Ok(())
}

fn title_and_units(out: &mut impl Write, title: &str, date: &str) -> Result<(), WriteFault> {
    let title: String = clean(title).chars().take(80).collect();
    let date: String = clean(date).chars().take(20).collect();
    writeln!(out, "{:>6}\n{:>6}{:74}", -1, 151, "")?;
    writeln!(out, "{title:<80}\n{:<80}\n{:<80}", "NONE", "asperity")?;
    writeln!(out, "{date:<20}{:>10}{:>10}{:>10}", 0, 0, 0)?;
    writeln!(out, "{date:<20}\n{:<80}\n{date:<20}\n{:>6}", "asperity", -1)?;
    // Units code 1 is SI, temperature mode 2 absolute.
    writeln!(out, "{:>6}\n{:>6}{:74}", -1, 164, "")?;
    writeln!(out, "{:>10}{:<20}{:>10}", 1, "SI: Meter (newton)", 2)?;
    let factor = |value: f64| exponential(value, 16, 25).replace('e', "D");
    writeln!(out, "{}{}{}", factor(1.0), factor(1.0), factor(1.0))?;
    writeln!(out, "{}\n{:>6}", factor(273.15), -1)?;
    Ok(())
}

fn header(
    out: &mut impl Write,
    channel: &Channel,
    points: usize,
    binary: bool,
) -> Result<(), WriteFault> {
    let format = if binary { Format::UniversalBinary } else { Format::UniversalText };
    let refuse = |reason| Err(WriteFault::refused(format, &channel.name, reason));
    let complex = matches!(channel.samples, Samples::Complex(_));
    let (even, start, step) = match channel.abscissa {
        Abscissa::Even { start, step, .. } => (true, start, step),
        Abscissa::Uneven { .. } => (false, 0.0, 0.0),
    };
    let lines = [&channel.name, &channel.origin.description, &channel.origin.date];
    if lines.iter().any(|line| line.chars().count() > 80 || line.chars().any(char::is_control)) {
        return refuse("a line of its text is longer than 80 characters, or not printable");
    }
    if channel.unit.text().chars().count() > 20 || channel.unit.text().chars().any(char::is_control)
    {
        return refuse("its unit is longer than 20 characters, or not printable");
    }
    let kind = match channel.abscissa.quantity() {
        ChannelQuantity::Frequency if channel.origin.frf.is_some() => (FRF, 18, "Frequency", "Hz"),
        ChannelQuantity::Frequency if channel.origin.is_coherence => {
            (COHERENCE, 18, "Frequency", "Hz")
        }
        ChannelQuantity::Time => (1, 17, "Time", "s"),
        ChannelQuantity::Frequency => (12, 18, "Frequency", "Hz"),
        _ => (0, 0, "NONE", "NONE"),
    };
    writeln!(out, "{:>6}", -1)?;
    if binary {
        let value = 8 * (1 + usize::from(complex) + usize::from(!even));
        let bytes = points * value;
        writeln!(
            out,
            "{:>6}b{:>6}{:>6}{:>12}{bytes:>12}{:>6}{:>6}{:>12}{:>12}",
            58, 1, 2, 11, 0, 0, 0, 0
        )?;
    } else {
        writeln!(out, "{:>6}{:74}", 58, "")?;
    }
    let or_none =
        |line: &str| if text(line).is_empty() { "NONE".to_owned() } else { line.to_owned() };
    for line in lines {
        writeln!(out, "{:<80}", or_none(line))?;
    }
    writeln!(out, "{:<80}\n{:<80}", "NONE", "NONE")?;
    let node = |freedom: &Option<DegreeOfFreedom>| {
        let freedom = freedom.clone().unwrap_or_default();
        let entity = or_none(&freedom.entity);
        let fits = entity.chars().count() <= 10
            && !entity.chars().any(char::is_control)
            && (-999_999_999..=9_999_999_999).contains(&freedom.node)
            && (-999..=9_999).contains(&freedom.direction);
        fits.then(|| format!(" {entity:<10}{:>10}{:>4}", freedom.node, freedom.direction))
    };
    let nodes = (node(&channel.origin.response), node(&channel.origin.reference));
    let (Some(response), Some(reference)) = nodes else {
        return refuse("a node's name has more than 10 characters, or its number too many digits");
    };
    writeln!(out, "{:>5}{:>10}{:>5}{:>10}{response}{reference}", kind.0, 0, 1, 0)?;
    let ordinate = if complex { 6 } else { 4 };
    writeln!(
        out,
        "{ordinate:>10}{points:>10}{:>10}{}{}{}",
        i32::from(even),
        exponential(start, 5, 13),
        exponential(step, 6, 13),
        exponential(0.0, 5, 13)
    )?;
    let mut axis = |kind: i64, label: &str, unit: &str| {
        writeln!(out, "{kind:>10}{:>5}{:>5}{:>5} {label:<20} {unit:<20}", 0, 0, 0)
    };
    axis(kind.1, kind.2, kind.3)?;
    let unit = match &channel.unit {
        ChannelUnit::Missing => "NONE",
        unit => unit.text(),
    };
    // A quantity without unit would get the SI unit of dataset 164.
    let quantity = channel.unit.known().map_or(ChannelQuantity::Unknown, |unit| unit.quantity());
    if let Some(units) = channel.origin.frf {
        for unit in [units.response, units.excitation] {
            let (code, label) = specific_type(unit.quantity());
            axis(code, label, unit.symbol())?;
        }
    } else {
        let (code, label) = specific_type(quantity);
        axis(code, label, unit)?;
        axis(0, "NONE", "NONE")?;
    }
    axis(0, "NONE", "NONE")?;
    Ok(())
}

/// Specific data type and label of a quantity.
fn specific_type(quantity: ChannelQuantity) -> (i64, &'static str) {
    let known = SPECIFIC_TYPES.iter().find(|(_, known, _)| *known == quantity);
    known.map_or((0, "NONE"), |(kind, _, label)| (*kind, *label))
}

/// The numbers of one channel. Lines of text contain whole points, so that a
/// continuing record begins a line.
fn data(out: &mut impl Write, channel: &Channel, binary: bool) -> Result<(), WriteFault> {
    let abscissae = match &channel.abscissa {
        Abscissa::Even { .. } => None,
        Abscissa::Uneven { values, .. } => Some(values),
    };
    let mut sink = Sink { out, binary, on_line: 0 };
    let per_line = match (abscissae.is_some(), &channel.samples) {
        (true, Samples::Real(_)) | (false, Samples::Complex(_)) => 2,
        (true, Samples::Complex(_)) => 1,
        (false, Samples::Real(_)) => 4,
    };
    for index in 0..channel.samples.len() {
        if let Some(abscissae) = abscissae {
            sink.put(abscissae[index], 5, 13)?;
        }
        match &channel.samples {
            Samples::Real(values) => sink.put(values[index], 12, 20)?,
            Samples::Complex(values) => {
                sink.put(values[index].re, 12, 20)?;
                sink.put(values[index].im, 12, 20)?;
            }
        }
        sink.point(per_line)?;
    }
    sink.end()
}

struct Sink<'a, W> {
    out: &'a mut W,
    binary: bool,
    /// Points on the current line.
    on_line: u32,
}

impl<W: Write> Sink<'_, W> {
    fn put(&mut self, value: f64, decimals: usize, width: usize) -> Result<(), WriteFault> {
        if self.binary {
            self.out.write_all(&value.to_le_bytes())?;
        } else {
            self.out.write_all(exponential(value, decimals, width).as_bytes())?;
        }
        Ok(())
    }

    fn point(&mut self, per_line: u32) -> Result<(), WriteFault> {
        self.on_line += 1;
        if self.on_line == per_line { self.end() } else { Ok(()) }
    }

    fn end(&mut self) -> Result<(), WriteFault> {
        if !self.binary && self.on_line > 0 {
            self.out.write_all(b"\n")?;
        }
        self.on_line = 0;
        Ok(())
    }
}

/// `value` in the E format of Fortran and `%e` of C, with two or more digits of exponent.
fn exponential(value: f64, decimals: usize, width: usize) -> String {
    let plain = format!("{value:.decimals$e}");
    let Some((mantissa, exponent)) = plain.split_once('e') else {
        return format!("{plain:>width$}");
    };
    let (sign, digits) = exponent.strip_prefix('-').map_or(('+', exponent), |rest| ('-', rest));
    format!("{:>width$}", format!("{mantissa}e{sign}{digits:0>2}"))
}

fn clean(text: &str) -> String {
    let text: String = text.chars().filter(|character| !character.is_control()).collect();
    if text.trim().is_empty() { "NONE".to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_look_as_in_c() {
        // From the printf of C: "%13.5e" and "%20.12e".
        assert_eq!(exponential(3.90625e-5, 5, 13), "  3.90625e-05");
        assert_eq!(exponential(-1.0 / 3.0, 12, 20), " -3.333333333333e-01");
        assert_eq!(exponential(-1e-100, 12, 20), "-1.000000000000e-100");
        assert_eq!(exponential(0.0, 5, 13), "  0.00000e+00");
    }
}
