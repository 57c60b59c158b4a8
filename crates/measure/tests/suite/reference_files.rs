//! Files written by pyuff, NumPy and SciPy; see PROVENANCE.md beside them.

use asperity_measure::{
    ChannelQuantity, Complex64, Format, MeasureError, Notice, ReadOptions, Record, SampleAxis,
    Samples, read,
};

use crate::build::{read_reference, reference, samples};

/// The signals behind most of the files, as NumPy stored them.
fn expected() -> Record {
    let mut measured = read_reference("expected.npz");
    assert_eq!(measured.records[0].sample_rate_hz(), Some(51_200.0));
    measured.records.remove(0)
}

/// Response k of `H = (1 + i/4) / (1 + i k/4)`, which the scripts evaluated in NumPy.
fn response(k: usize) -> Complex64 {
    Complex64::new(1.0, 0.25) / Complex64::new(1.0, k as f64 / 4.0)
}

fn complex(samples: &Samples) -> &[Complex64] {
    let Samples::Complex(values) = samples else { panic!("complex samples") };
    values
}

#[test]
fn universal_files_by_pyuff() {
    let expected = expected();
    for (name, format) in
        [("pyuff_ascii.uff", Format::UniversalText), ("pyuff_binary.uff", Format::UniversalBinary)]
    {
        let measured = read_reference(name);
        assert_eq!((measured.format, measured.records.len()), (format, 1));
        let record = &measured.records[0];
        assert_eq!((record.title.as_str(), record.date.as_str()), ("beam", "01-Nov-26 10:00:00"));
        // 1.95313e-05 in the file: 51199.87 Hz without snapping.
        assert_eq!(record.sample_rate_hz(), Some(51_200.0));
        // Both signals have six decimals at most, fewer than either format.
        assert_eq!(samples(record, "hammer"), samples(&expected, "force"));
        assert_eq!(samples(record, "top"), samples(&expected, "acc"));
        let top = record.of_quantity(ChannelQuantity::Acceleration).unwrap();
        assert_eq!(top.unit.text(), "g");
        let node = top.origin.response.as_ref().unwrap();
        assert_eq!((node.entity.as_str(), node.node, node.direction), ("BEAM", 3, -3));
        let disagree = |notice: &Notice| matches!(notice, Notice::UnitsDisagree { .. });
        assert!(measured.notices.iter().any(disagree), "g beside a system of SI units");
    }
}

#[test]
fn complex_functions_by_pyuff_with_a_wrong_byte_count() {
    let measured = read_reference("pyuff_complex.uff");
    let record = &measured.records[0];
    assert_eq!(record.channels.len(), 2);
    for (channel, tolerance) in record.channels.iter().zip([5.1e-12, 0.0]) {
        assert_eq!(channel.abscissa.quantity(), ChannelQuantity::Frequency);
        assert_eq!(channel.abscissa.at(4), Some(50.0));
        for (k, value) in complex(&channel.samples).iter().enumerate() {
            // Text has twelve digits; NumPy may divide differently in the last bit.
            assert!((value - response(k)).norm() <= tolerance + 4e-16, "{k}: {value}");
        }
    }
    let count =
        |notice: &Notice| matches!(notice, Notice::ByteCount { announced: 128, taken: 256, .. });
    assert!(measured.notices.iter().any(count), "{:?}", measured.notices);
}

#[test]
fn uneven_functions_by_pyuff() {
    let measured = read_reference("pyuff_uneven.uff");
    let record = &measured.records[0];
    let abscissae = [0.0, 0.125, 0.5, 0.625, 2.0, 3.5];
    for channel in &record.channels {
        assert_eq!(channel.sample_rate_hz(), None);
        let values = channel.samples.real().unwrap();
        for (index, x) in abscissae.into_iter().enumerate() {
            assert_eq!(channel.abscissa.at(index), Some(x));
            assert_eq!(values[index], x * x - 1.0, "eighths are exact in both formats");
        }
    }
}

#[test]
fn arrays_by_numpy() {
    let expected = expected();
    let (force, acceleration) = (samples(&expected, "force"), samples(&expected, "acc"));
    let rows = read_reference("rows_f8.npy");
    assert_eq!(rows.records[0].sample_rate_hz(), Some(51_200.0));
    assert_eq!(samples(&rows.records[0], "channel 2"), force);
    assert_eq!(samples(&rows.records[0], "channel 3"), acceleration);

    let columns = read_reference("columns_fortran_f4_big.npy");
    assert_eq!(columns.records[0].sample_rate_hz(), Some(51_200.0));
    let single: Vec<f64> = acceleration.iter().map(|value| f64::from(*value as f32)).collect();
    assert_eq!(samples(&columns.records[0], "channel 3"), single);

    let options = ReadOptions {
        sample_rate_hz: Some(51_200.0),
        names: vec!["hammer".into()],
        units: vec!["mN".into(), "mg".into()],
        ..ReadOptions::default()
    };
    let mut integers = read(&reference("columns_i2.npy"), &options).unwrap();
    let record = &mut integers.records[0];
    let counts: Vec<f64> = force.iter().map(|value| (value * 100.0).round()).collect();
    assert_eq!(samples(record, "hammer"), counts);
    record.channels[0].to_si().unwrap();
    assert_eq!(record.channels[0].quantity, ChannelQuantity::Force);
    assert_eq!(samples(record, "hammer")[12], 1e-3 * 4000.0);

    let spectra = read(&reference("complex.npy"), &options).unwrap();
    let second = complex(&spectra.records[0].channels[1].samples);
    assert!((second[3] - 2.0 * response(3)).norm() < 1e-15);
}

#[test]
fn archives_by_numpy() {
    let expected = expected();
    let arrays = read_reference("arrays.npz");
    let record = &arrays.records[0];
    assert_eq!(record.sample_rate_hz(), Some(51_200.0), "from the array `time`");
    assert_eq!(samples(record, "both[1]"), samples(&expected, "acc"));
    let left_out =
        |notice: &Notice| matches!(notice, Notice::ArrayLeftOut { array, .. } if array == "note");
    assert!(arrays.notices.iter().any(left_out));
    let folded = read_reference("folded.npz");
    assert_eq!(samples(&folded.records[0], "force"), samples(&expected, "force"));
    assert_eq!(folded.records[0].named("acc").unwrap().unit.text(), "g");
}

#[test]
fn matlab_files_by_scipy() {
    let expected = expected();
    let plain = read_reference("plain.mat");
    assert_eq!(samples(&plain.records[0], "force"), samples(&expected, "force"));
    let single: Vec<f64> =
        samples(&expected, "acc").iter().map(|value| f64::from(*value as f32)).collect();
    assert_eq!(samples(&plain.records[0], "acc"), single);
    let z = complex(&plain.records[1].named("z").unwrap().samples);
    assert!((z[5] - response(5)).norm() < 4e-16);
    let counts = samples(&plain.records[2], "counts");
    assert_eq!(counts, [0.0, 1.0, 4.0, 9.0, 16.0, 25.0, 36.0, 49.0]);

    let folded = read_reference("folded.mat");
    assert_eq!(folded.records.len(), 2, "one for each structure");
    for (record, factor) in folded.records.iter().zip([1.0, 2.0]) {
        assert_eq!(record.sample_rate_hz(), Some(51_200.0), "the rate beside them");
        let doubled: Vec<f64> = samples(&expected, "acc").iter().map(|v| factor * v).collect();
        assert_eq!(samples(record, "acc"), doubled);
    }
    assert_eq!(folded.records[1].title, "hit2");
}

#[test]
fn a_big_endian_matlab_file_by_hand() {
    let measured = read_reference("big_endian.mat");
    let record = &measured.records[0];
    assert_eq!(record.sample_rate_hz(), Some(1000.0));
    assert_eq!(samples(record, "force"), [0.0, 1.5, -2.25, 3.0]);
    assert_eq!(samples(record, "acc"), [1.0, -2.0, 3.0, -4.0]);
}

#[cfg(feature = "hdf5")]
#[test]
fn hdf5_files_by_h5py() {
    let expected = expected();
    let plain = read_reference("plain.h5");
    assert_eq!((plain.format, plain.records.len()), (Format::Hdf5, 2));
    let second = &plain.records[1];
    assert_eq!((second.title.as_str(), second.sample_rate_hz()), ("hit2", Some(51_200.0)));
    let doubled: Vec<f64> = samples(&expected, "force").iter().map(|value| 2.0 * value).collect();
    assert_eq!(samples(second, "force"), doubled, "chunked, shuffled and compressed");
    assert_eq!(samples(second, "both[1]"), samples(&expected, "acc"));
    assert_eq!(second.named("acc").unwrap().unit.text(), "g");
    let matlab = read_reference("version73.mat");
    assert_eq!(samples(&matlab.records[0], "force"), samples(&expected, "force"));
    assert_eq!(matlab.records[0].sample_rate_hz(), Some(51_200.0));
    let latest = read(&reference("latest.h5"), &ReadOptions::default()).unwrap_err();
    assert!(matches!(latest, MeasureError::Malformed { .. }), "{latest}");
}

#[cfg(not(feature = "hdf5"))]
#[test]
fn hdf5_without_the_feature_is_an_error_naming_it() {
    for name in ["plain.h5", "version73.mat"] {
        let error = read(&reference(name), &ReadOptions::default()).unwrap_err();
        assert!(error.to_string().contains("build with the feature `hdf5`"), "{error}");
    }
}

#[test]
fn errors_of_unsupported_files_give_an_alternative() {
    let error = read(&reference("version4.mat"), &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, MeasureError::Unsupported { .. }));
    assert!(error.to_string().ends_with("save it with `save -v7`"), "{error}");
    let error = read(&reference("columns_i2.npy"), &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, MeasureError::NoSampleRate { .. }), "{error}");
    let wrong_way = ReadOptions {
        sample_axis: Some(SampleAxis::Last),
        sample_rate_hz: Some(1.0),
        ..ReadOptions::default()
    };
    let measured = read(&reference("columns_i2.npy"), &wrong_way).unwrap();
    assert_eq!((measured.records[0].channels.len(), measured.records[0].len()), (64, 2));
}
