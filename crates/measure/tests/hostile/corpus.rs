//! Small valid files: by the writers, by hand, and by other programs.

use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, Complex64, Format, Origin, Record, Samples,
    Unit, WriteOptions, write,
};

/// A file, by name.
type Seed = (&'static str, Vec<u8>);

fn channel(name: &str, unit: &str, samples: Samples) -> Channel {
    let unit = Unit::parse(unit).unwrap();
    Channel {
        name: name.to_owned(),
        quantity: unit.quantity(),
        unit: ChannelUnit::Known(unit),
        abscissa: Abscissa::even_time(0.0, 51_200.0),
        samples,
        origin: Origin::default(),
    }
}

fn records() -> Vec<Record> {
    let wave = |factor: f64| (0..50).map(|n| factor * (0.3 * f64::from(n)).sin()).collect();
    let record = |factor| Record {
        channels: vec![
            channel("force", "N", Samples::Real(wave(10.0 * factor))),
            channel("acc", "g", Samples::Real(wave(factor))),
        ],
        ..Record::default()
    };
    vec![record(1.0), record(2.0)]
}

fn odd_records() -> Vec<Record> {
    let complex = (0..20).map(|n| Complex64::new(f64::from(n), -1.0)).collect();
    let mut uneven = channel("bent", "m", Samples::Real(vec![1.0, -2.0, 3.0]));
    uneven.abscissa =
        Abscissa::Uneven { values: vec![0.0, 1.0, 5.0], quantity: ChannelQuantity::Time };
    let mut spectrum = channel("spectrum", "N", Samples::Complex(complex));
    spectrum.abscissa =
        Abscissa::Even { start: 0.0, step: 2.5, quantity: ChannelQuantity::Frequency };
    [spectrum, uneven]
        .map(|channel| Record { channels: vec![channel], ..Record::default() })
        .to_vec()
}

fn written(records: &[Record], format: Format) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    write(&path, records, format, &WriteOptions::default()).unwrap();
    std::fs::read(path).unwrap()
}

fn reference(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/reference/measure/");
    std::fs::read(format!("{folder}{name}")).unwrap()
}

pub(crate) fn universal() -> Vec<Seed> {
    vec![
        ("text", written(&records(), Format::UniversalText)),
        ("binary", written(&records(), Format::UniversalBinary)),
        ("odd text", written(&odd_records(), Format::UniversalText)),
        ("odd binary", written(&odd_records(), Format::UniversalBinary)),
        ("pyuff complex", reference("pyuff_complex.uff")),
        ("pyuff uneven", reference("pyuff_uneven.uff")),
    ]
}

pub(crate) fn text() -> Vec<Seed> {
    let row = |n: u32| format!("{};{},5;{}", n, n * n, n % 7);
    let german: Vec<String> = (0..40).map(row).collect();
    let german = german.join("\n");
    let uneven: Vec<String> = (0..40).map(|n| format!("{} {n}", n * n)).collect();
    let uneven = uneven.join("\n");
    let labview = "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tNo\n\
        ***End_of_Header***\t\n\t\nChannels\t2\nSamples\t3\t3\nX0\t0\t0\nDelta_X\t0.001\t0.001\n\
        Y_Unit_Label\tN\tg\n***End_of_Header***\t\nX_Value\tforce\tacc\tComment\n\
        \t1\t2\n\t3\t4\n\t5\t6\nChannels\t1\n***End_of_Header***\t\nX_Value\ta\n\t1\n"
        .as_bytes();
    let pairs = "LabVIEW Measurement\t\nX_Columns\tMulti\n***End_of_Header***\t\n\t\n\
        Channels\t2\t\t\t\nX0\t0\t\t1\t\nDelta_X\t0.5\t\t0.25\t\n***End_of_Header***\n\
        X_Value\ta\tX_Value\tb\n0\t1\t1\t4\n0.5\t2\t1.25\t5\n1\t3\t1.5\t6\n"
        .as_bytes();
    vec![
        ("pairs", pairs.to_vec()),
        ("ours", written(&records()[..1], Format::Text)),
        ("semicolons", format!("Zeit;Kraft;a\n[ms];[N];[g]\n{german}").into_bytes()),
        ("uneven", format!("# time_s x_mm\n{uneven}").into_bytes()),
        ("LabVIEW", labview.to_vec()),
        ("narrow", b"1 1\n".repeat(500)),
    ]
}

pub(crate) fn numpy() -> Vec<Seed> {
    vec![
        ("ours", written(&records(), Format::Npz)),
        ("odd", written(&odd_records(), Format::Npz)),
        ("folded", reference("folded.npz")),
        ("arrays", reference("arrays.npz")),
        ("rows", reference("rows_f8.npy")),
        ("columns", reference("columns_fortran_f4_big.npy")),
        ("integers", reference("columns_i2.npy")),
        ("complex", reference("complex.npy")),
    ]
}

pub(crate) fn matlab() -> Vec<Seed> {
    vec![
        ("plain", reference("plain.mat")),
        ("folded", reference("folded.mat")),
        ("big endian", reference("big_endian.mat")),
    ]
}

#[cfg(feature = "hdf5")]
pub(crate) fn hdf5() -> Vec<Seed> {
    vec![("plain", reference("plain.h5")), ("MATLAB 7.3", reference("version73.mat"))]
}

pub(crate) fn tdms() -> Vec<Seed> {
    vec![
        ("hits", reference("hits.tdms")),
        ("scales", reference("scales.tdms")),
        ("types", reference("types.tdms")),
        ("interleaved", reference("interleaved.tdms")),
        ("incremental", reference("incremental.tdms")),
    ]
}

pub(crate) fn wave() -> Vec<Seed> {
    use hound::SampleFormat::{Float, Int};
    let with = |bits_per_sample, sample_format, channels| {
        let spec = hound::WavSpec { channels, sample_rate: 48_000, bits_per_sample, sample_format };
        let mut bytes = std::io::Cursor::new(Vec::new());
        let mut writer = hound::WavWriter::new(&mut bytes, spec).unwrap();
        for n in 0..60_i16 {
            match sample_format {
                hound::SampleFormat::Int => writer.write_sample(n - 30).unwrap(),
                hound::SampleFormat::Float => writer.write_sample(f32::from(n) / 60.0).unwrap(),
            }
        }
        writer.finalize().unwrap();
        bytes.into_inner()
    };
    vec![
        ("16 bit", with(16, Int, 2)),
        ("24 bit", with(24, Int, 3)),
        ("8 bit", with(8, Int, 1)),
        ("float", with(32, Float, 2)),
    ]
}
