//! One NumPy array (`.npy`, versions 1 to 3).
//!
//! Source: NumPy Enhancement Proposal 1.
//!
//! | module | contents |
//! |---|---|
//! | `header` | type, order and shape |

mod header;

use crate::arrays::{Layout, Leading, check_channels, deinterleave, leading};
use crate::decoding::Records;
use crate::heading::Heading;
use crate::notice::Notices;
use crate::source::Source;
use crate::{
    Abscissa, FilePosition, Format, MeasureError, Notice, ReadOptions, Record, Samples, rate,
};

pub(crate) use header::NpyHeader;

/// An array being read.
pub(crate) struct Npy<'a> {
    source: Source<'a>,
    header: NpyHeader,
    layout: Layout,
    /// Position of its numbers.
    offset: u64,
    next: u64,
    block: u64,
    rate_of_options: Option<f64>,
    axis: Option<FirstAxis>,
}

/// The axis, from the first block.
#[derive(Clone, Copy)]
struct FirstAxis {
    start: f64,
    step: f64,
    /// True if the first channel is time or a count, and left out.
    leads: bool,
    is_time: bool,
}

impl<'a> Npy<'a> {
    pub(crate) fn open(
        mut source: Source<'a>,
        options: &ReadOptions,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        let name = source.name().to_owned();
        let wrong = |quantity, found: &str, expected: &'static str| {
            let found = crate::error::excerpt(found);
            MeasureError::malformed(&name, FilePosition::Offset(0), quantity, found, expected)
        };
        let header = NpyHeader::read(|buffer| source.read_exact(buffer, "the NPY header"), &wrong)?;
        let shape = || format!("{:?}", header.shape);
        let plane = header.plane().filter(|(rows, columns)| *rows > 0 && *columns > 0);
        let plane = plane.ok_or_else(|| {
            wrong("the shape of the array", &shape(), "one or two dimensions, none empty")
        })?;
        let elements = plane.0.saturating_mul(plane.1);
        source.need(elements.saturating_mul(header.element()), "the array")?;
        let (vector, row_major) = (header.shape.len() < 2, !header.fortran);
        let asked = options.sample_axis;
        let layout = Layout::of(source.name(), "array", vector, plane, row_major, asked, notices)?;
        check_channels(&source, layout.channels)?;
        Ok(Self {
            offset: source.position(),
            source,
            header,
            layout,
            next: 0,
            block: options.block as u64,
            rate_of_options: options.sample_rate_hz,
            axis: None,
        })
    }

    /// Real numbers of a block, by channels; complex ones as pairs.
    fn numbers(&mut self, count: u64) -> Result<Vec<Vec<f64>>, MeasureError> {
        let NpyHeader { number, endian, complex, .. } = self.header;
        let parts = if complex { 2 } else { 1 };
        let channels = self.layout.channels;
        let room = count as usize * parts;
        let mut columns: Vec<Vec<f64>> = (0..channels).map(|_| Vec::with_capacity(room)).collect();
        let element = self.header.element();
        if self.layout.contiguous {
            for (index, column) in columns.iter_mut().enumerate() {
                let before = index as u64 * self.layout.samples + self.next;
                self.source.seek_to(self.offset + before * element)?;
                let read = number.read(endian, &mut self.source, room, column);
                read.map_err(|error| self.source.io(error))?;
            }
        } else {
            self.source.seek_to(self.offset + self.next * channels * element)?;
            let (types, samples) = ((number, endian), count as usize);
            let read = deinterleave(types, &mut self.source, samples, parts, &mut columns);
            read.map_err(|error| self.source.io(error))?;
        }
        Ok(columns)
    }

    fn find_axis(
        &self,
        first: &[f64],
        channels: usize,
        notices: &mut Notices,
    ) -> Result<FirstAxis, MeasureError> {
        let may_lead = channels > 1 && !self.header.complex;
        let found =
            if may_lead { leading(first, self.header.number.epsilon(), notices) } else { None };
        if let Some(Leading::Time(start, step)) = found {
            notices.add(Notice::TimeByValues { column: "channel 1".into() });
            return Ok(FirstAxis { start, step, leads: true, is_time: true });
        }
        let counts = found.is_some();
        if counts {
            notices.left_out("channel 1", "it counts the samples");
        }
        let rate_hz = rate::of_options(self.source.name(), self.rate_of_options, notices)?;
        Ok(FirstAxis { start: 0.0, step: 1.0 / rate_hz, leads: counts, is_time: false })
    }
}

impl Records for Npy<'_> {
    fn format(&self) -> Format {
        Format::Npy
    }

    fn next_record(&mut self, notices: &mut Notices) -> Result<Option<Record>, MeasureError> {
        let count = (self.layout.samples - self.next).min(self.block);
        if count == 0 {
            return Ok(None);
        }
        let mut columns = self.numbers(count)?;
        let axis = match self.axis {
            Some(axis) => axis,
            None => self.find_axis(&columns[0], columns.len(), notices)?,
        };
        self.axis = Some(axis);
        // Only the times of later blocks are checked.
        let checked = axis.is_time && self.next > 0;
        let times = if checked { std::mem::take(&mut columns[0]) } else { Vec::new() };
        let relative = 4.0 * self.header.number.epsilon().max(1e-12);
        let tolerance = |expected: f64| relative * expected.abs();
        let abscissa =
            Abscissa::continued((axis.start, axis.step), self.next, times, tolerance, notices);
        let left_out = usize::from(axis.leads);
        let channels = columns.into_iter().enumerate().skip(left_out).map(|(index, values)| {
            let samples = Samples::of_parts(values, self.header.complex);
            Heading::bare(format!("channel {}", index + 1)).channel(abscissa.clone(), samples)
        });
        let channels = channels.collect();
        let continues = self.next > 0;
        self.next += count;
        Ok(Some(Record { channels, continues, ..Record::default() }))
    }
}
