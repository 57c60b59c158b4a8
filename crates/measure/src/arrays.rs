//! Named arrays to records of channels.
//!
//! Arrays of the same length in a group (`record 2: force`, `hit.force`) are sampled together; a
//! scalar `fs` or `dt` gives the rate, a vector `time` the axis. Of several times each belongs to its
//! own channels.

mod layout;

use crate::channel::scale;
use crate::heading::Heading;
use crate::notice::Notices;
use crate::source::Source;
use crate::time_match::{TimeVectors, Vector, time_vectors};
use crate::{
    Abscissa, Channel, ChannelQuantity, MeasureError, Notice, ReadOptions, Record, Samples, rate,
};

pub(crate) use layout::{Layout, deinterleave};

/// A named array, divided into channels.
pub(crate) struct Array {
    pub(crate) name: String,
    pub(crate) columns: Vec<Samples>,
    /// Relative rounding of its numbers.
    pub(crate) epsilon: f64,
}

/// Most channels accepted in a file of that size.
pub(crate) fn most_channels(source: &Source<'_>) -> u64 {
    256.max(source.len() / 128)
}

/// Rejects more channels than accepted in a file of that size.
pub(crate) fn check_channels(source: &Source<'_>, channels: u64) -> Result<(), MeasureError> {
    let most = most_channels(source);
    if channels <= most {
        return Ok(());
    }
    let expected = format!("at most {most} in a file of {} bytes", source.len());
    Err(source.malformed(source.place(), "the number of channels", &channels.to_string(), expected))
}

/// The first of several columns, if it is an axis.
pub(crate) enum Leading {
    /// Time: start and step.
    Time(f64, f64),
    /// The count of the samples.
    Count,
}

/// The axis of an evenly increasing column, as of time.
pub(crate) fn leading(values: &[f64], epsilon: f64, notices: &mut Notices) -> Option<Leading> {
    if values.len() < 3 {
        return None;
    }
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let (start, step) = rate::even_axis(values, |_| epsilon * largest, notices)?;
    let counts = step == 1.0 && start.fract() == 0.0;
    Some(if counts { Leading::Count } else { Leading::Time(start, step) })
}

/// Records of the arrays of a file, with `separator` between group and name.
pub(crate) fn records(
    file: &str,
    arrays: Vec<Array>,
    separator: char,
    options: &ReadOptions,
    notices: &mut Notices,
) -> Result<Vec<Record>, MeasureError> {
    let mut groups: Vec<ArrayGroup> = Vec::new();
    for array in arrays {
        let (group, name) = array.name.rsplit_once(separator).unwrap_or(("", &array.name));
        let place = groups.iter().position(|known| known.group == group).unwrap_or_else(|| {
            groups.push(ArrayGroup { group: group.to_owned(), ..ArrayGroup::default() });
            groups.len() - 1
        });
        let heading = Heading::parse(name);
        groups[place].take(&heading, array, notices);
    }
    let of_file = groups.iter().find(|group| group.group.is_empty());
    let of_file = of_file.map_or((None, None), |group| (group.step, group.start));
    let mut records = Vec::new();
    for mut group in groups {
        group.step = group.step.or(of_file.0);
        group.start = group.start.or(of_file.1);
        group.into_records(file, options, &mut records, notices)?;
    }
    if records.is_empty() {
        let file = file.to_owned();
        return Err(MeasureError::NoSamples { file, expected: "arrays of numbers" });
    }
    Ok(records)
}

/// Fewest arrays of which two may be times without a name.
const FEWEST_UNNAMED: usize = 4;

/// The arrays of one group.
#[derive(Default)]
struct ArrayGroup {
    group: String,
    step: Option<f64>,
    start: Option<f64>,
    /// Abscissa, quantity and relative rounding.
    axis: Option<(Vec<f64>, ChannelQuantity, f64)>,
    /// Places of the time vectors among the channels.
    times: Vec<usize>,
    channels: Vec<(Heading, Samples, f64)>,
}

impl ArrayGroup {
    fn take(&mut self, heading: &Heading, array: Array, notices: &mut Notices) {
        let mut columns = array.columns;
        let single = match columns.as_slice() {
            [Samples::Real(values)] if values.len() == 1 => values.first().copied(),
            _ => None,
        };
        if let Some(value) = single {
            let positive = value.is_finite() && value > 0.0;
            match heading.name.to_lowercase().as_str() {
                "fs" | "sr" | "rate" | "sample_rate" | "sampling_rate" | "samplerate"
                    if positive =>
                {
                    self.step = Some(1.0 / value);
                }
                "dt" | "delta_t" | "step" if positive => self.step = Some(value),
                "t0" | "start" if value.is_finite() => self.start = Some(value),
                _ => notices.left_out(array.name, "a single number other than a sample rate"),
            }
            return;
        }
        let quantity = heading.quantity();
        let is_time = quantity == ChannelQuantity::Time;
        let is_axis = is_time || quantity == ChannelQuantity::Frequency && self.axis.is_none();
        if is_axis && columns.len() == 1 {
            match columns.remove(0) {
                Samples::Real(mut values) => {
                    let factor = heading.unit.known().map_or(1.0, |unit| unit.factor());
                    scale(&mut values, factor);
                    if is_time {
                        self.times.push(self.channels.len());
                        let samples = Samples::Real(values);
                        self.channels.push((heading.clone(), samples, array.epsilon));
                    } else {
                        self.axis = Some((values, quantity, array.epsilon));
                    }
                    return;
                }
                complex @ Samples::Complex(_) => columns.push(complex),
            }
        }
        let many = columns.len() > 1;
        for (index, samples) in columns.into_iter().enumerate() {
            let mut heading = heading.clone();
            if many {
                heading.name = format!("{}[{index}]", heading.name);
            }
            self.channels.push((heading, samples, array.epsilon));
        }
    }

    fn into_records(
        mut self,
        file: &str,
        options: &ReadOptions,
        records: &mut Vec<Record>,
        notices: &mut Notices,
    ) -> Result<(), MeasureError> {
        self.take_unnamed_times(notices);
        if self.times.len() > 1 && self.times.len() < self.channels.len() {
            match self.time_vectors(file)? {
                TimeVectors::OfEach(time_of) => {
                    self.into_records_of_times(&time_of, records, notices);
                    return Ok(());
                }
                TimeVectors::First(others) => {
                    for other in others.into_iter().rev() {
                        let name = self.channels.remove(other).0.name;
                        notices.left_out(name, "a second time of the same samples");
                    }
                }
            }
        }
        if let Some(place) = self.times.first()
            && let (heading, Samples::Real(values), epsilon) = self.channels.remove(*place)
        {
            self.axis = Some((values, heading.quantity(), epsilon));
        }
        let mut lengths: Vec<usize> = Vec::new();
        for (_, samples, _) in &self.channels {
            if !lengths.contains(&samples.len()) && !samples.is_empty() {
                lengths.push(samples.len());
            }
            if lengths.len() > 64 {
                let found = format!("more than {} lengths", lengths.len() - 1);
                let expected = "arrays sampled together, of the same length";
                let place = crate::FilePosition::Offset(0);
                let quantity = "the set of arrays";
                return Err(MeasureError::malformed(file, place, quantity, found, expected));
            }
        }
        let mut channels = self.channels;
        for length in lengths {
            let (mut own, rest): (Vec<_>, Vec<_>) =
                channels.into_iter().partition(|(_, samples, _)| samples.len() == length);
            channels = rest;
            let mut step = self.step;
            if self.axis.as_ref().is_none_or(|axis| axis.0.len() != length)
                && let Some(place) = frequency_axis(&own)
                && let (heading, Samples::Real(values), epsilon) = own.remove(place)
            {
                if heading.quantity() == ChannelQuantity::Unknown {
                    notices.add(Notice::FrequencyByValues { column: heading.name });
                }
                self.axis = Some((values, ChannelQuantity::Frequency, epsilon));
            }
            let abscissa = match &self.axis {
                Some((values, quantity, epsilon)) if values.len() == length => {
                    Some(axis_of(values, *quantity, *epsilon, notices))
                }
                _ if step.is_none() && own.len() > 1 => {
                    let found = match &own[0] {
                        (_, Samples::Real(values), epsilon) => leading(values, *epsilon, notices),
                        _ => None,
                    };
                    match found {
                        Some(Leading::Time(start, step)) => {
                            let column = own.remove(0).0.name;
                            notices.add(Notice::TimeByValues { column });
                            Some(Abscissa::Even { start, step, quantity: ChannelQuantity::Time })
                        }
                        Some(Leading::Count) => {
                            notices.left_out(own.remove(0).0.name, "it counts the samples");
                            None
                        }
                        None => None,
                    }
                }
                _ => None,
            };
            if abscissa.is_none() && step.is_none() {
                step = Some(1.0 / rate::of_options(file, options.sample_rate_hz, notices)?);
            }
            let (start, step) = (self.start.unwrap_or(0.0), step.unwrap_or(1.0));
            let abscissa =
                abscissa.unwrap_or(Abscissa::Even { start, step, quantity: ChannelQuantity::Time });
            let own = own.into_iter();
            let channels = own
                .map(|(heading, samples, _)| heading.channel(abscissa.clone(), samples))
                .collect();
            records.push(Record { channels, title: self.group.clone(), ..Record::default() });
        }
        Ok(())
    }

    /// Takes arrays without a name of time that rise evenly as times, if there are two or more.
    fn take_unnamed_times(&mut self, notices: &mut Notices) {
        if self.axis.is_some() || !self.times.is_empty() || self.channels.len() < FEWEST_UNNAMED {
            return;
        }
        let rises = |(_, samples, epsilon): &(Heading, Samples, f64)| {
            let values = samples.real().unwrap_or_default();
            let found = leading(values, *epsilon, &mut Notices::default());
            matches!(found, Some(Leading::Time(..)))
        };
        let places = (0..self.channels.len()).filter(|place| rises(&self.channels[*place]));
        let places: Vec<usize> = places.collect();
        if places.len() > 1 {
            for place in &places {
                notices.add(Notice::TimeByValues { column: self.channels[*place].0.name.clone() });
            }
            self.times = places;
        }
    }

    fn time_vectors(&self, file: &str) -> Result<TimeVectors, MeasureError> {
        let mut vectors = Vec::with_capacity(self.channels.len());
        for (place, (heading, samples, _)) in self.channels.iter().enumerate() {
            let times = samples.real().filter(|_| self.times.contains(&place));
            vectors.push(Vector { name: &heading.name, length: samples.len(), times });
        }
        time_vectors(file, &vectors)
    }

    /// A record for the channels of each time; one for all if a time has one channel only.
    fn into_records_of_times(
        self,
        time_of: &[usize],
        records: &mut Vec<Record>,
        notices: &mut Notices,
    ) {
        let time = ChannelQuantity::Time;
        let axis = |place: &usize| {
            let (_, samples, epsilon) = &self.channels[*place];
            axis_of(samples.real().unwrap_or_default(), time, *epsilon, notices)
        };
        let axes: Vec<Abscissa> = self.times.iter().map(axis).collect();
        let mut sets: Vec<Vec<Channel>> = vec![Vec::new(); axes.len()];
        for (place, (heading, samples, _)) in self.channels.into_iter().enumerate() {
            let set = self.times.iter().position(|time| *time == time_of[place]);
            if let Some(set) = set.filter(|_| time_of[place] != place) {
                sets[set].push(heading.channel(axes[set].clone(), samples));
            }
        }
        sets.retain(|channels| !channels.is_empty());
        if sets.iter().any(|channels| channels.len() == 1) {
            sets = vec![sets.into_iter().flatten().collect()];
        }
        records.extend(sets.into_iter().map(|channels| Record {
            channels,
            title: self.group.clone(),
            ..Record::default()
        }));
    }
}

/// Names of frequencies beside complex samples.
const FREQUENCIES: [&str; 8] = ["f", "fr", "hz", "freqs", "frequencies", "faxis", "fvec", "f_hz"];

/// The place of the frequencies of complex samples: of a name for frequencies, else the only real array that
/// rises evenly from zero or more.
fn frequency_axis(own: &[(Heading, Samples, f64)]) -> Option<usize> {
    if !own.iter().any(|(_, samples, _)| matches!(samples, Samples::Complex(_))) {
        return None;
    }
    let rises = |place: &usize| {
        let (_, samples, epsilon) = &own[*place];
        let values = samples.real().unwrap_or_default();
        let is_even = || leading(values, *epsilon, &mut Notices::default()).is_some();
        values.first().is_some_and(|first| *first >= 0.0) && is_even()
    };
    let is_named = |place: &usize| {
        let (heading, samples, _) = &own[*place];
        let name = heading.name.to_lowercase();
        samples.real().is_some_and(|values| values.windows(2).all(|pair| pair[1] > pair[0]))
            && (FREQUENCIES.contains(&name.as_str())
                || heading.quantity() == ChannelQuantity::Frequency)
    };
    (0..own.len()).find(is_named).or_else(|| {
        let all: Vec<usize> = (0..own.len()).filter(rises).collect();
        if let [only] = all[..] { Some(only) } else { None }
    })
}

fn axis_of(
    values: &[f64],
    quantity: ChannelQuantity,
    epsilon: f64,
    notices: &mut Notices,
) -> Abscissa {
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let mut ignored = Notices::default();
    let notices = if quantity == ChannelQuantity::Time { notices } else { &mut ignored };
    match rate::even_axis(values, |_| epsilon * largest, notices) {
        Some((start, step)) => Abscissa::Even { start, step, quantity },
        None => Abscissa::Uneven { values: values.to_vec(), quantity },
    }
}
