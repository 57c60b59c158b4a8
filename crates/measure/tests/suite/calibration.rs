//! Calibration of sensor signals.

use asperity_measure::{
    ChannelQuantity, MeasureError, ReadOptions, STANDARD_GRAVITY, SensorSensitivity, read_bytes,
};

use crate::build::{channel, parsed, record, samples};

#[test]
fn volts_become_newtons_and_accelerations() {
    let file = "time_s,hammer_mV,acc [V]\n0,0,0\n0.001,22.5,1\n0.002,4.5,-0.5\n";
    let mut measured = parsed(file);
    let [hammer, response] = &mut measured.records[0].channels[..] else { panic!("two channels") };
    hammer.calibrate(&"2.25 mV/N".parse::<SensorSensitivity>().unwrap()).unwrap();
    response.calibrate(&"100 mV/g".parse::<SensorSensitivity>().unwrap()).unwrap();
    assert_eq!((hammer.quantity, hammer.unit.text()), (ChannelQuantity::Force, "N"));
    assert_eq!((response.quantity, response.unit.text()), (ChannelQuantity::Acceleration, "m/s^2"));
    let near = |values: &[f64], expected: [f64; 3]| {
        values.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-12)
    };
    assert!(near(hammer.samples.real().unwrap(), [0.0, 10.0, 2.0]));
    let g = STANDARD_GRAVITY;
    assert!(near(response.samples.real().unwrap(), [0.0, 10.0 * g, -5.0 * g]));
}

#[test]
fn a_wave_file_is_calibrated_from_full_scale() {
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 48_000,
        bits_per_sample: 24,
        sample_format: hound::SampleFormat::Int,
    };
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, spec).unwrap();
    for sample in [0, 1 << 22, -(1 << 23), 1, 4_194_304, -1] {
        writer.write_sample(sample).unwrap();
    }
    writer.finalize().unwrap();
    let mut measured = parsed(bytes.into_inner());
    let record = &mut measured.records[0];
    assert_eq!(record.sample_rate_hz(), Some(48_000.0));
    assert_eq!(samples(record, "channel 1"), [0.0, -1.0, 0.5]);
    assert_eq!(samples(record, "channel 2"), [0.5, 1.0 / 8_388_608.0, -1.0 / 8_388_608.0]);
    assert_eq!(record.channels[0].quantity, ChannelQuantity::FullScale);
    record.channels[0].calibrate(&"0.005 FS/N".parse().unwrap()).unwrap();
    assert_eq!(samples(record, "channel 1"), [0.0, -200.0, 100.0]);
    // A sensitivity in volts needs the full scale in volts.
    let error = record.channels[1].calibrate(&"100 mV/g".parse().unwrap()).unwrap_err();
    assert!(matches!(
        error,
        MeasureError::QuantityMismatch { found: ChannelQuantity::FullScale, .. }
    ));
}

#[test]
fn a_floating_point_wave_file() {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 51_200,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = hound::WavWriter::new(&mut bytes, spec).unwrap();
    for sample in [0.25_f32, -1.5, 1e-7] {
        writer.write_sample(sample).unwrap();
    }
    writer.finalize().unwrap();
    let measured = parsed(bytes.into_inner());
    assert_eq!(samples(&measured.records[0], "channel 1"), [0.25, -1.5, f64::from(1e-7_f32)]);
}

#[test]
fn an_unknown_unit_stays_unknown_until_it_is_given() {
    let mut furlongs = channel("x", "furlong", 1.0, vec![1.0]);
    let error = furlongs.to_si().unwrap_err();
    assert!(
        matches!(&error, MeasureError::UnknownUnit { text, .. } if text == "furlong"),
        "{error}"
    );
    let mut nothing = channel("x", "NONE", 1.0, vec![1.0]);
    assert!(nothing.to_si().is_err() && nothing.calibrate(&"1 V/N".parse().unwrap()).is_err());
    assert!(nothing.set_unit("parsec").is_err());
    nothing.set_unit("kN").unwrap();
    nothing.to_si().unwrap();
    assert_eq!((nothing.samples.real(), nothing.unit.text()), (Some(&[1000.0][..]), "N"));
    let error = nothing.calibrate(&"1 V/N".parse().unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "channel `x` is force; this conversion needs voltage");
}

#[test]
fn names_and_units_of_the_options_replace_those_of_the_file() {
    let options = ReadOptions {
        names: vec![String::new(), "tip".into()],
        units: vec!["lbf".into(), String::new()],
        ..ReadOptions::default()
    };
    let measured = read_bytes(b"time_s,a,b [g]\n0,1,2\n1,3,4\n", &options).unwrap();
    let record = &measured.records[0];
    assert_eq!(
        (record.channels[0].name.as_str(), record.channels[0].quantity),
        ("a", ChannelQuantity::Force)
    );
    assert_eq!((record.channels[1].name.as_str(), record.channels[1].unit.text()), ("tip", "g"));
    let options = ReadOptions { units: vec!["parsec".into()], ..options };
    assert!(read_bytes(b"time_s,a,b\n0,1,2\n1,3,4\n", &options).is_err());
}

#[test]
fn records_return_channels_by_name_and_quantity() {
    let hit = record(vec![
        channel("f", "N", 10.0, vec![1.0, 2.0]),
        channel("a", "g", 10.0, vec![3.0, 4.0]),
    ]);
    assert_eq!(hit.of_quantity(ChannelQuantity::Acceleration).unwrap().name, "a");
    assert_eq!((hit.len(), hit.is_empty(), hit.sample_rate_hz()), (2, false, Some(10.0)));
    assert!(hit.named("x").is_none() && hit.of_quantity(ChannelQuantity::Velocity).is_none());
}
