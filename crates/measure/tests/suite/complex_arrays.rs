//! Complex samples over frequency in MAT files, as other programs write frequency response functions.

use asperity_measure::{Abscissa, ChannelQuantity, Complex64, Notice, Samples};

use crate::build::parsed;

/// An element of a MAT file, padded to eight bytes.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend_from_slice(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A column of doubles, complex where it has an imaginary part.
fn column(name: &str, real: &[f64], imaginary: Option<&[f64]>) -> Vec<u8> {
    let flags = 6_u32 | if imaginary.is_some() { 0x800 } else { 0 };
    let doubles =
        |values: &[f64]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let size = [(real.len() as u32).to_le_bytes(), 1_u32.to_le_bytes()].concat();
    let mut parts = vec![
        element(6, &[flags.to_le_bytes(), 0_u32.to_le_bytes()].concat()),
        element(5, &size),
        element(1, name.as_bytes()),
        element(9, &doubles(real)),
    ];
    parts.extend(imaginary.map(|values| element(9, &doubles(values))));
    element(14, &parts.concat())
}

fn mat(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut file = b"MATLAB 5.0 MAT-file".to_vec();
    file.resize(124, b' ');
    file.extend(0x0100_u16.to_le_bytes());
    file.extend(b"IM");
    file.extend(variables.concat());
    file
}

#[test]
fn complex_arrays_are_over_their_frequencies_whatever_their_order() {
    let frequency: Vec<f64> = (0..50).map(|n| 10.0 + 2.0 * f64::from(n)).collect();
    let (real, imaginary) = (vec![0.5; 50], vec![-0.25; 50]);
    let coherence: Vec<f64> = (0..50).map(|n| 0.9 + 0.1 * f64::from(n % 2)).collect();
    let function = || column("H1_acc", &real, Some(&imaginary));
    let coherence = || column("coh", &coherence, None);
    for axis in ["f", "freq", "x_values"] {
        let axis_of = || column(axis, &frequency, None);
        for variables in
            [vec![axis_of(), function(), coherence()], vec![function(), coherence(), axis_of()]]
        {
            let found = parsed(mat(&variables));
            let record = &found.records[0];
            assert_eq!(record.channels.len(), 2, "{axis}");
            for channel in &record.channels {
                let expected =
                    Abscissa::Even { start: 10.0, step: 2.0, quantity: ChannelQuantity::Frequency };
                assert_eq!(channel.abscissa, expected, "{axis}: {}", channel.name);
            }
            let samples = &record.named("H1_acc").unwrap().samples;
            assert_eq!(*samples, Samples::Complex(vec![Complex64::new(0.5, -0.25); 50]));
            let told = found.notices.iter().any(
                |notice| matches!(notice, Notice::FrequencyByValues { column } if column == axis),
            );
            assert_eq!(told, axis != "freq", "{axis}: {:?}", found.notices);
        }
    }
}
