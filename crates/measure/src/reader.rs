//! Opening a file and reading its records.

use std::io::Cursor;
use std::path::Path;

use crate::decoding::Records;
use crate::memory::MemoryRecords;
use crate::notice::Notices;
use crate::source::Source;
use crate::{
    ByteStream, ChannelQuantity, ChannelUnit, Format, FrfUnits, MeasureError, Measurement, Notice,
    ReadOptions, Record, Unit,
};

/// A file being read, record by record.
pub struct Reader<'a> {
    records: Box<dyn Records + 'a>,
    notices: Notices,
    names: Vec<String>,
    units: Vec<Option<Unit>>,
    /// Name of the source, until its first record is complete; see [`ReadOptions::complete`].
    incomplete: Option<String>,
    ended: bool,
}

/// Opens a file of any format, detected from its content, for reading record by record.
///
/// # Errors
/// [`MeasureError`] for a file that cannot be opened, has no known
/// format, or has an invalid header.
///
/// ```no_run
/// use asperity_measure::{ReadOptions, open};
///
/// let mut reader = open("hits.tdms".as_ref(), &ReadOptions::default())?;
/// while let Some(record) = reader.next_record()? {
///     println!("{} channels at {:?} Hz", record.channels.len(), record.sample_rate_hz());
/// }
/// # Ok::<(), asperity_measure::MeasureError>(())
/// ```
pub fn open(path: &Path, options: &ReadOptions) -> Result<Reader<'static>, MeasureError> {
    Reader::of(Source::open(path)?, options)
}

/// Reads a whole file.
///
/// # Errors
/// As [`open`] and [`Reader::next_record`].
pub fn read(path: &Path, options: &ReadOptions) -> Result<Measurement, MeasureError> {
    let options = ReadOptions { block: usize::MAX, ..options.clone() };
    open(path, &options)?.read_all()
}

/// Reads the bytes of a whole file, as [`read`] does.
///
/// # Errors
/// As [`open`] and [`Reader::next_record`].
///
/// ```
/// use asperity_measure::{ReadOptions, read_bytes};
///
/// let options = ReadOptions { sample_rate_hz: Some(1000.0), ..ReadOptions::default() };
/// let measured = read_bytes(b"force [N],acc [g]\n0,0\n9,1\n2,3\n", &options)?;
/// let force = measured.records[0].named("force").ok_or("a channel of the header")?;
/// assert_eq!(force.samples.real(), Some(&[0.0, 9.0, 2.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_bytes(bytes: &[u8], options: &ReadOptions) -> Result<Measurement, MeasureError> {
    let options = ReadOptions { block: usize::MAX, ..options.clone() };
    Reader::from_stream("bytes", Cursor::new(bytes), &options)?.read_all()
}

impl<'a> Reader<'a> {
    /// Reads from a stream; `name` stands for the file in messages.
    ///
    /// # Errors
    /// As [`open`].
    pub fn from_stream(
        name: &str,
        stream: impl ByteStream + 'a,
        options: &ReadOptions,
    ) -> Result<Self, MeasureError> {
        Self::of(Source::new(name, Box::new(stream))?, options)
    }

    /// Reads records in memory as a file: in blocks, with the names and units of the
    /// options, and with the quantities that follow; `name` stands for the file in messages.
    ///
    /// # Errors
    /// [`MeasureError`] for options that are not valid.
    ///
    /// ```
    /// use asperity_measure::{ReadOptions, Reader, read_bytes};
    ///
    /// let text = b"time_s,hammer,acc\n0,0,0\n0.001,10,0.5\n0.002,0,0.25\n";
    /// let records = read_bytes(text, &ReadOptions::default())?.records;
    /// let units = vec!["N".to_owned(), "g".to_owned()];
    /// let options = ReadOptions { units, block: 2, ..ReadOptions::default() };
    /// let mut reader = Reader::of_records("arrays", &records, &options)?;
    /// let block = reader.next_record()?.ok_or("the first block")?;
    /// assert_eq!((block.len(), block.channels[1].unit.text()), (2, "g"));
    /// assert!(reader.next_record()?.ok_or("the second block")?.continues);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_records(
        name: &str,
        records: &'a [Record],
        options: &ReadOptions,
    ) -> Result<Self, MeasureError> {
        let units = units(name, options)?;
        let records = Box::new(MemoryRecords::new(records, options.block.max(1)));
        Ok(Self::with(records, Notices::default(), options, (name.to_owned(), units)))
    }

    fn with(
        records: Box<dyn Records + 'a>,
        notices: Notices,
        options: &ReadOptions,
        (name, units): (String, Vec<Option<Unit>>),
    ) -> Self {
        let incomplete = options.complete.then_some(name);
        Self { records, notices, names: options.names.clone(), units, incomplete, ended: false }
    }

    fn of(source: Source<'a>, options: &ReadOptions) -> Result<Self, MeasureError> {
        let mut source = source.decoded()?;
        let (name, units) = (source.name().to_owned(), units(source.name(), options)?);
        let options = &ReadOptions { block: options.block.max(1), ..options.clone() };
        let mut notices = Notices::default();
        let records: Box<dyn Records + 'a> = match Format::of_content(&mut source)? {
            Format::UniversalText | Format::UniversalBinary => {
                Box::new(crate::uff::Universal::open(source, options, &mut notices)?)
            }
            Format::Text => Box::new(crate::text::Text::open(source, options, &mut notices)?),
            Format::Npy => Box::new(crate::npy::Npy::open(source, options, &mut notices)?),
            Format::Npz => Box::new(crate::npz::open(source, options, &mut notices)?),
            Format::Mat => Box::new(crate::mat::open(source, options, &mut notices)?),
            Format::Wav => Box::new(crate::wav::Wav::open(source, options)?),
            Format::Tdms => Box::new(crate::tdms::Tdms::open(source, options, &mut notices)?),
            #[cfg(feature = "hdf5")]
            Format::Hdf5 => Box::new(crate::hdf5::open(source, options, &mut notices)?),
            #[cfg(not(feature = "hdf5"))]
            Format::Hdf5 => {
                return Err(MeasureError::Unsupported {
                    file: source.name().to_owned(),
                    feature: "HDF5 (MATLAB 7.3)",
                    instead: "build with the feature `hdf5`, or save it with `save -v7` or as NPZ",
                });
            }
            // Not found in content.
            Format::Memory => {
                let file = source.name().to_owned();
                return Err(MeasureError::UnknownFormat { file, expected: Format::READABLE });
            }
        };
        Ok(Self::with(records, notices, options, (name, units)))
    }

    /// The format.
    pub fn format(&self) -> Format {
        self.records.format()
    }

    /// Assumptions and observations so far.
    pub fn notices(&self) -> &[Notice] {
        self.notices.all()
    }

    /// The next record; none at the end, and none after an error.
    ///
    /// # Errors
    /// [`MeasureError`] for content that violates the format, with its position.
    pub fn next_record(&mut self) -> Result<Option<Record>, MeasureError> {
        if self.ended {
            return Ok(None);
        }
        let next = self.records.next_record(&mut self.notices);
        self.ended = !matches!(next, Ok(Some(_)));
        let Some(mut record) = next? else { return Ok(None) };
        self.check_complete(&record)?;
        self.name_and_unit(&mut record);
        Ok(Some(record))
    }

    pub(crate) fn read_all(mut self) -> Result<Measurement, MeasureError> {
        let mut records = Vec::new();
        while let Some(record) = self.next_record()? {
            records.push(record);
        }
        Ok(Measurement { format: self.format(), records, notices: self.notices.into_all() })
    }

    /// Rejects names or units that are fewer or more than the channels of the first record.
    fn check_complete(&mut self, record: &Record) -> Result<(), MeasureError> {
        let Some(file) = self.incomplete.take() else { return Ok(()) };
        let channels = record.channels.len();
        for (option, given) in [("names", self.names.len()), ("units", self.units.len())] {
            if given > 0 && given != channels {
                let names: Vec<String> =
                    record.channels.iter().map(|channel| format!("`{}`", channel.name)).collect();
                let names = names.join(", ");
                return Err(MeasureError::Option {
                    file,
                    option,
                    found: format!("a list of {given}"),
                    expected: format!(
                        "{channels}, one for each channel ({names}); an empty one keeps the file's"
                    ),
                });
            }
        }
        Ok(())
    }

    /// Sets the names and units of the options, then the quantities.
    fn name_and_unit(&mut self, record: &mut Record) {
        let channels = record.channels.len();
        for (of, given) in [("names", self.names.len()), ("units", self.units.len())] {
            if given > channels {
                self.notices.add(Notice::NotUsed { of, given, channels });
            }
        }
        for (index, channel) in record.channels.iter_mut().enumerate() {
            if let Some(name) = self.names.get(index).filter(|name| !name.is_empty()) {
                channel.name.clone_from(name);
            }
            if let Some(Some(unit)) = self.units.get(index) {
                channel.unit = ChannelUnit::Known(*unit);
                channel.quantity = unit.quantity();
            }
            let name = || channel.name.clone();
            match &channel.unit {
                ChannelUnit::Known(unit) => {
                    let (stated, by_unit) = (channel.quantity, unit.quantity());
                    if stated != ChannelQuantity::Unknown && stated != by_unit {
                        let channel = name();
                        self.notices.add(Notice::QuantityContradictsUnit {
                            channel,
                            stated,
                            by_unit,
                        });
                    }
                    channel.quantity = by_unit;
                }
                ChannelUnit::Missing => {
                    self.notices.add(Notice::UnitMissing { channel: name() });
                }
                ChannelUnit::Unrecognised(text)
                    if channel.abscissa.quantity() == ChannelQuantity::Frequency
                        && FrfUnits::parse(text).is_some() =>
                {
                    let units = FrfUnits::parse(text);
                    channel.origin.frf = channel.origin.frf.or(units);
                }
                ChannelUnit::Unrecognised(text) => {
                    let text = text.clone();
                    self.notices.add(Notice::UnitUnrecognised { channel: name(), text });
                }
            }
            if channel.quantity == ChannelQuantity::Unknown {
                channel.quantity = ChannelQuantity::of_name(&channel.name);
            }
        }
    }
}

fn units(file: &str, options: &ReadOptions) -> Result<Vec<Option<Unit>>, MeasureError> {
    if let Some(rate) = options.sample_rate_hz
        && !(rate.is_finite() && rate > 0.0)
    {
        return Err(MeasureError::Option {
            file: file.to_owned(),
            option: "sample_rate_hz",
            found: rate.to_string(),
            expected: "a positive rate in hertz".into(),
        });
    }
    let parse = |text: &String| (!text.is_empty()).then(|| Unit::require(text)).transpose();
    options.units.iter().map(parse).collect()
}
