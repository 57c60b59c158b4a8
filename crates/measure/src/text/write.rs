//! Writing of one record as CSV: a header of names and units, then numbers.

use std::io::Write;

use asperity_table::{Decimal, quoted};

use crate::error::WriteFault;
use crate::heading::Heading;
use crate::{Abscissa, Channel, ChannelQuantity, ChannelUnit, Format, Record, Samples};

/// Writes the only joined record, with numbers that read back to the same bits.
pub(crate) fn write(out: &mut impl Write, records: &[Vec<&Record>]) -> Result<(), WriteFault> {
    let refuse = |channel: &str, reason| Err(WriteFault::refused(Format::Text, channel, reason));
    let parts = match records {
        [] => return Ok(()),
        [parts] => parts,
        [_, other, ..] => {
            return refuse(
                &other[0].channels[0].name,
                "text holds one record only; it belongs to a second",
            );
        }
    };
    let first = &parts[0].channels[0];
    let axis = match first.abscissa.quantity() {
        ChannelQuantity::Time => "time_s",
        ChannelQuantity::Frequency => "frequency_hz",
        _ => return refuse(&first.name, "its axis is neither time nor frequency"),
    };
    out.write_all(axis.as_bytes())?;
    for channel in &parts[0].channels {
        write!(out, ",{}", quoted(&heading(channel, Format::Text)?))?;
    }
    writeln!(out)?;
    for part in parts {
        let first = &part.channels[0];
        let mut columns = Vec::with_capacity(part.channels.len());
        for channel in &part.channels {
            if channel.abscissa != first.abscissa || channel.samples.len() != first.samples.len() {
                return refuse(&channel.name, "its axis is not that of the first channel");
            }
            match &channel.samples {
                Samples::Real(values) => columns.push(values),
                Samples::Complex(_) => return refuse(&channel.name, "its samples are complex"),
            }
        }
        for index in 0..first.samples.len() {
            write!(out, "{}", Decimal(first.abscissa.at(index).unwrap_or(f64::NAN)))?;
            for column in &columns {
                write!(out, ",{}", Decimal(column[index]))?;
            }
            out.write_all(b"\n")?;
        }
    }
    Ok(())
}

/// Name and unit in one text from which both can be read.
pub(crate) fn heading(channel: &Channel, format: Format) -> Result<String, WriteFault> {
    let name = channel.name.trim();
    let plain = Heading { name: channel.name.clone(), unit: channel.unit.clone() };
    let text = match &channel.unit {
        ChannelUnit::Missing if Heading::parse(name) == plain => name.to_owned(),
        ChannelUnit::Missing => format!("{name} [-]"),
        unit => format!("{name} [{}]", unit.text()),
    };
    // A unit read from a factor alone has no symbol.
    let same = Heading::parse(&text) == plain;
    if !same || name.is_empty() || text.contains('"') || text.chars().any(char::is_control) {
        let reason =
            "its name or unit could not be read back: brackets, quotes, blanks at the ends";
        return Err(WriteFault::refused(format, &channel.name, reason));
    }
    Ok(text)
}

/// True if every part has an even axis.
pub(crate) fn even_throughout(parts: &[&Record], index: usize) -> bool {
    parts.iter().all(|part| matches!(part.channels[index].abscissa, Abscissa::Even { .. }))
}
