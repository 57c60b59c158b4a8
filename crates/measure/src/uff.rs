//! Universal files: functions at nodes (dataset 58 and 58b), title (151), units (164).
//!
//! The format is the SDRC I-DEAS test data universal file, with
//! datasets between lines of `-1`. A first pass reads the position and the header of each function,
//! so that the consecutive functions of one hit can be read together in blocks.
//!
//! | module | contents |
//! |---|---|
//! | `index` | first pass |
//! | `header`, `fields` | lines before the numbers |
//! | `binary`, `printed` | numbers |
//! | `system` | dataset 164, and units of a channel |
//! | `group` | functions sampled together |
//! | `write` | writing |

mod binary;
mod fields;
mod group;
mod header;
mod index;
mod printed;
mod system;
mod write;

use std::sync::Arc;

use crate::channel::scale;
use crate::decoding::Records;
use crate::notice::Notices;
use crate::source::Source;
use crate::{
    Abscissa, Channel, ChannelQuantity, Format, MeasureError, Origin, ReadOptions, Record, Samples,
    rate,
};

use binary::Values;
use header::FunctionHeader;
use index::{Data, FunctionEntry, Group};
use printed::Printed;

pub(crate) use write::write;

/// A universal file being read.
pub(crate) struct Universal<'a> {
    source: Source<'a>,
    format: Format,
    groups: std::vec::IntoIter<Group>,
    /// The current group, and its next sample.
    current: Option<(Group, u64)>,
    /// Positions in the printed numbers of the functions of the current group.
    printed: Vec<Option<Printed>>,
    /// Start and step of the functions of the current group whose times are even though the file gives
    /// each of them.
    even_times: Vec<Option<(f64, f64)>>,
    block: u64,
    rate_of_options: Option<f64>,
}

impl<'a> Universal<'a> {
    pub(crate) fn open(
        mut source: Source<'a>,
        options: &ReadOptions,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        let entries = index::index(&mut source, notices)?;
        if entries.is_empty() {
            let file = source.name().to_owned();
            return Err(MeasureError::NoSamples { file, expected: "dataset 58 or 58b" });
        }
        let binary = entries.iter().any(|entry| matches!(entry.data, Data::Binary(_)));
        let format = if binary { Format::UniversalBinary } else { Format::UniversalText };
        let groups = group::groups(entries).into_iter();
        Ok(Self {
            source,
            format,
            groups,
            current: None,
            printed: Vec::new(),
            even_times: Vec::new(),
            block: options.block as u64,
            rate_of_options: options.sample_rate_hz,
        })
    }

    fn channel(
        &mut self,
        entry: &FunctionEntry,
        slot: usize,
        from: u64,
        count: usize,
        notices: &mut Notices,
    ) -> Result<Channel, MeasureError> {
        let header = &entry.header;
        let mut values = Values::for_points(count, header.even, header.complex);
        match (&entry.data, &mut self.printed[slot]) {
            (Data::Binary(payload), _) => {
                payload.read(&mut self.source, from, count, &mut values)?;
            }
            (Data::Printed(_), Some(printed)) => {
                printed.read(&mut self.source, count, &mut values)?;
                if from + count as u64 == header.points {
                    printed.close(&mut self.source)?;
                }
            }
            (Data::Printed(_), None) => {}
        }
        let abscissa = if header.even {
            self.even_abscissa(header, from, notices)?
        } else {
            self.given_abscissa(entry, slot, from, values.abscissae, notices)
        };
        let name = header.channel_name(slot);
        let (unit, quantity) =
            system::unit_of(header, entry.context.system.as_ref(), &name, notices);
        Ok(Channel {
            name,
            quantity,
            unit,
            abscissa,
            samples: if header.complex {
                Samples::Complex(values.complex)
            } else {
                Samples::Real(values.real)
            },
            origin: Origin {
                description: header.description.clone(),
                date: header.date.clone(),
                response: header.response.clone(),
                reference: header.reference.clone(),
                frf: system::frf_units(header, entry.context.system.as_ref()),
                is_coherence: header.function == header::COHERENCE,
            },
        })
    }

    fn even_abscissa(
        &self,
        header: &FunctionHeader,
        from: u64,
        notices: &mut Notices,
    ) -> Result<Abscissa, MeasureError> {
        let (quantity, factor) = header.abscissa_unit();
        let mut step = header.step * factor;
        if quantity == ChannelQuantity::Time {
            if step == 0.0 {
                step = 1.0 / rate::of_options(self.source.name(), self.rate_of_options, notices)?;
            }
            step = rate::snapped_step(step, header.step_uncertainty * factor, notices);
        }
        let start = header.start * factor + from as f64 * step;
        Ok(Abscissa::Even { start, step, quantity })
    }

    /// The axis of abscissae that the file gives; even if they are so within their rounding.
    fn given_abscissa(
        &mut self,
        entry: &FunctionEntry,
        slot: usize,
        from: u64,
        mut values: Vec<f64>,
        notices: &mut Notices,
    ) -> Abscissa {
        let header = &entry.header;
        let (quantity, factor) = header.abscissa_unit();
        scale(&mut values, factor);
        if quantity != ChannelQuantity::Time {
            return Abscissa::Uneven { values, quantity };
        }
        let rounding = |value: f64| match &entry.data {
            // Half a unit of the sixth digit.
            Data::Printed(_) => 0.5 * 10f64.powf(value.abs().log10().floor() - 5.0),
            Data::Binary(payload) => payload.abscissa_epsilon() * value.abs(),
        };
        if from == 0 {
            // A step in the header says more than times of six digits.
            let start = values.first().copied().unwrap_or(0.0);
            let stated = (start, header.step * factor);
            let fits = |value: f64, expected: f64| 2.0 * rounding(value.abs().max(expected.abs()));
            self.even_times[slot] = rate::even_axis(&values, rounding, notices).or_else(|| {
                (stated.1 > 0.0 && rate::is_even(&values, stated, fits)).then_some(stated)
            });
        }
        let Some(even) = self.even_times[slot] else {
            return Abscissa::Uneven { values, quantity };
        };
        let tolerance = |expected: f64| 4.0 * rounding(expected) + 1e-9 * expected.abs();
        Abscissa::continued(even, from, values, tolerance, notices)
    }
}

impl Records for Universal<'_> {
    fn format(&self) -> Format {
        self.format
    }

    fn next_record(&mut self, notices: &mut Notices) -> Result<Option<Record>, MeasureError> {
        let (group, from) = match self.current.take() {
            Some(current) => current,
            None => match self.groups.next() {
                None => return Ok(None),
                Some(group) => {
                    self.printed = group.iter().map(|entry| Printed::of(entry)).collect();
                    self.even_times = vec![None; group.len()];
                    (group, 0)
                }
            },
        };
        let Some(first) = group.first() else { return Ok(None) };
        let (points, context) = (first.header.points, Arc::clone(&first.context));
        let count = (points - from).min(self.block);
        let mut channels = Vec::with_capacity(group.len());
        for (slot, entry) in group.iter().enumerate() {
            channels.push(self.channel(entry, slot, from, count as usize, notices)?);
        }
        if from + count < points {
            self.current = Some((group, from + count));
        }
        Ok(Some(Record {
            channels,
            continues: from > 0,
            title: context.title.clone(),
            date: context.date.clone(),
        }))
    }
}
