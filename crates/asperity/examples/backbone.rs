//! The backbone of a bar on a rough contact: frequency and second harmonic over amplitude.
#![allow(clippy::print_stdout, reason = "an example prints its results")]

use asperity::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let structure = StackBuilder::new()
        .body(Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0)?)
        .interface("guide-disc", 1.15e-4, Power::new(1.81e10, 0.35, 0.0)?)
        .preloaded(Damping::Ratio(0.035))?;
    let near = structure.natural_frequency().ok_or("no stiffness at rest")?;
    let system = ContactSystem::of_structure(&structure, LawEvaluation::default())?;
    let mode = Continuation::Mode { near, from: 1e-9, to: 1e-7 };
    for point in &trace(&system, &mode, &HarmonicSettings::default())?.points {
        let (frequency, ratio) = (point.frequency_hz(), point.displacement_ratio());
        println!("{:.2e} m: {frequency:.2} Hz, ratio {ratio:.4}", point.amplitude(1));
    }
    Ok(())
}
