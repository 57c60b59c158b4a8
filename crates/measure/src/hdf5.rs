//! HDF5 and MATLAB 7.3: datasets of numbers at the root and in its groups.
//!
//! The whole file is held in memory; the memory of its decoded datasets is limited by its size.
//! Units and rates are taken from names and scalars, as in
//! archives of NumPy; attributes are not read.

use hdf5_pure::{DType, Dataset, Error, File};

use crate::arrays::{Array, Layout, records};
use crate::decoding::{Budget, DecodedRecords};
use crate::notice::Notices;
use crate::source::Source;
use crate::{FilePosition, Format, MeasureError, ReadOptions, Samples};

/// Reads every dataset of numbers, in groups one level deep.
pub(crate) fn open(
    mut source: Source<'_>,
    options: &ReadOptions,
    notices: &mut Notices,
) -> Result<DecodedRecords, MeasureError> {
    let name = source.name().to_owned();
    let mut budget = Budget::new(&source, options);
    let mut bytes = vec![0; usize::try_from(source.len()).unwrap_or(usize::MAX)];
    source.read_exact(&mut bytes, "the file")?;
    let wrong = |error: Error| {
        let (place, expected) = (FilePosition::Offset(0), "one that hdf5-pure reads");
        MeasureError::malformed(&name, place, "the HDF5 file", error.to_string(), expected)
    };
    let file = File::from_bytes(bytes).map_err(wrong)?;
    let root = file.root();
    let mut arrays = Vec::new();
    let mut take = |name: String, dataset: &Dataset| {
        let Some((epsilon, plane)) = shape(dataset).map_err(wrong)? else {
            notices.left_out(name, "it is not an array of numbers of one or two dimensions");
            return Ok(());
        };
        // The dataset and its channels are in memory together.
        let elements = plane.0.saturating_mul(plane.1);
        let place = FilePosition::Offset(0);
        budget.take(elements.saturating_mul(16), place, "the datasets")?;
        let (vector, asked) = (plane.0 == 1 || plane.1 == 1, options.sample_axis);
        let layout = Layout::of(source.name(), &name, vector, plane, true, asked, notices)?;
        budget.take(layout.channels.saturating_mul(512), place, "the channels")?;
        let columns = cut(dataset.read_f64().map_err(wrong)?, layout);
        arrays.push(Array { name, columns, epsilon });
        Ok::<(), MeasureError>(())
    };
    for name in root.datasets().map_err(wrong)? {
        take(name.clone(), &root.dataset(&name).map_err(wrong)?)?;
    }
    for group_name in root.groups().map_err(wrong)? {
        // The contents of MATLAB cells have this name.
        if group_name == "#refs#" {
            continue;
        }
        let group = root.group(&group_name).map_err(wrong)?;
        for name in group.datasets().map_err(wrong)? {
            let dataset = group.dataset(&name).map_err(wrong)?;
            take(format!("{group_name}:{name}"), &dataset)?;
        }
    }
    Ok(DecodedRecords::new(Format::Hdf5, records(&name, arrays, ':', options, notices)?))
}

/// The numbers of a dataset, by channels.
fn cut(values: Vec<f64>, layout: Layout) -> Vec<Samples> {
    let (channels, samples) = (layout.channels as usize, layout.samples as usize);
    if channels == 1 {
        return vec![Samples::Real(values)];
    }
    let channel = |index: usize| {
        let (first, step) =
            if layout.contiguous { (index * samples, 1) } else { (index, channels) };
        values.iter().skip(first).step_by(step).take(samples).copied().collect()
    };
    (0..channels).map(|index| Samples::Real(channel(index))).collect()
}

/// Relative rounding, rows and columns.
type Shape = (f64, (u64, u64));

/// Rounding and shape of a dataset of numbers; none for another.
fn shape(dataset: &Dataset) -> Result<Option<Shape>, Error> {
    let epsilon = match dataset.dtype()? {
        DType::F32 => f64::from(f32::EPSILON),
        DType::F64 => f64::EPSILON,
        DType::I8
        | DType::I16
        | DType::I32
        | DType::I64
        | DType::U8
        | DType::U16
        | DType::U32
        | DType::U64 => 0.0,
        _ => return Ok(None),
    };
    let plane = match dataset.shape()?[..] {
        [] => (1, 1),
        [length] => (1, length),
        [rows, columns] => (rows, columns),
        _ => return Ok(None),
    };
    Ok((plane.0 > 0 && plane.1 > 0).then_some((epsilon, plane)))
}
