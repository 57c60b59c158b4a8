//! Writing of records as arrays of NumPy in a zip archive.

use std::io::{BufWriter, Seek, Write};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::error::WriteFault;
use crate::heading::Heading;
use crate::npy::NpyHeader;
use crate::rate;
use crate::record::joined_len;
use crate::text::{even_throughout, heading};
use crate::{Abscissa, Channel, ChannelQuantity, Format, Record, Samples};

/// Writes joined records: an array for each channel, named `name [unit]`, with
/// the scalars `fs` or `dt` and `t0`, or an array of the axis. With several
/// records, names start with `record 1:` and so on.
pub(crate) fn write<W: Write + Seek>(
    out: &mut W,
    records: &[Vec<&Record>],
) -> Result<(), WriteFault> {
    let mut archive = Archive { zip: ZipWriter::new(out), prefix: String::new() };
    for (number, parts) in records.iter().enumerate() {
        if records.len() > 1 {
            archive.prefix = format!("record {}: ", number + 1);
        }
        write_axis(&mut archive, parts)?;
        for index in 0..parts[0].channels.len() {
            write_channel(&mut archive, parts, index)?;
        }
    }
    archive.zip.finish().map_err(zip_fault)?;
    Ok(())
}

fn write_axis<W: Write + Seek>(
    archive: &mut Archive<'_, W>,
    parts: &[&Record],
) -> Result<(), WriteFault> {
    let first = &parts[0].channels[0];
    let name = match (&first.abscissa, first.abscissa.quantity()) {
        (&Abscissa::Even { start, step, .. }, ChannelQuantity::Time)
            if even_throughout(parts, 0) =>
        {
            let rate = rate::of_step(step);
            let (name, value) = if 1.0 / rate == step { ("fs", rate) } else { ("dt", step) };
            archive.scalar(name, value)?;
            return if start == 0.0 { Ok(()) } else { archive.scalar("t0", start) };
        }
        (_, ChannelQuantity::Time) => "time [s]",
        (_, ChannelQuantity::Frequency) => "frequency [Hz]",
        _ => return Err(refused(first, "its axis is neither time nor frequency")),
    };
    archive.array(name, &format!("({},)", joined_len(parts, 0)), false, |put| {
        for channel in parts.iter().map(|part| &part.channels[0]) {
            for index in 0..channel.samples.len() {
                put(channel.abscissa.at(index).unwrap_or(f64::NAN))?;
            }
        }
        Ok(())
    })
}

fn write_channel<W: Write + Seek>(
    archive: &mut Archive<'_, W>,
    parts: &[&Record],
    index: usize,
) -> Result<(), WriteFault> {
    let channel = &parts[0].channels[index];
    let length = joined_len(parts, index);
    let same_axis = |part: &&Record| part.channels[index].abscissa == part.channels[0].abscissa;
    if !parts.iter().all(same_axis) || length != joined_len(parts, 0) {
        return Err(refused(channel, "its axis is not that of the first channel"));
    }
    let name = heading(channel, Format::Npz)?;
    let read_back = Heading::parse(&name).quantity();
    if matches!(read_back, ChannelQuantity::Time | ChannelQuantity::Frequency) || length < 2 {
        return Err(refused(channel, "it would be read as the axis, or as a single number"));
    }
    if name.contains(':') {
        return Err(refused(channel, "its name contains a colon, which separates records"));
    }
    let complex = matches!(channel.samples, Samples::Complex(_));
    archive.array(&name, &format!("({length},)"), complex, |put| {
        for part in parts {
            match &part.channels[index].samples {
                Samples::Real(values) => values.iter().try_for_each(|value| put(*value))?,
                Samples::Complex(values) => {
                    values
                        .iter()
                        .try_for_each(|value| put(value.re).and_then(|()| put(value.im)))?;
                }
            }
        }
        Ok(())
    })
}

fn refused(channel: &Channel, reason: &'static str) -> WriteFault {
    WriteFault::refused(Format::Npz, &channel.name, reason)
}

fn zip_fault(error: zip::result::ZipError) -> WriteFault {
    WriteFault::Io(std::io::Error::other(error))
}

/// Writes one number of an array.
type Put<'p> = &'p mut dyn FnMut(f64) -> std::io::Result<()>;

struct Archive<'a, W: Write + Seek> {
    zip: ZipWriter<&'a mut W>,
    prefix: String,
}

impl<W: Write + Seek> Archive<'_, W> {
    fn scalar(&mut self, name: &str, value: f64) -> Result<(), WriteFault> {
        self.array(name, "()", false, |put| put(value))
    }

    fn array(
        &mut self,
        name: &str,
        shape: &str,
        complex: bool,
        numbers: impl FnOnce(Put<'_>) -> std::io::Result<()>,
    ) -> Result<(), WriteFault> {
        let stored = SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored)
            .large_file(true);
        let name = format!("{}{name}.npy", self.prefix);
        self.zip.start_file(name, stored).map_err(zip_fault)?;
        self.zip.write_all(&NpyHeader::to_bytes(complex, shape))?;
        let mut buffered = BufWriter::with_capacity(1 << 16, &mut self.zip);
        numbers(&mut |value| buffered.write_all(&value.to_le_bytes()))?;
        buffered.flush()?;
        Ok(())
    }
}
