//! One simulated hit of a hammer on a bar that stands on a rough sample.
#![allow(clippy::print_stdout, reason = "an example prints its results")]

use asperity::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let law = Power::new(1.81e10, 0.35, 0.0)?;
    let structure = StackBuilder::new()
        .body(Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0)?)
        .interface("guide-sample", 1.15e-4, law)
        .body(Body::new("sample", 0.015, 1.15e-4, 71e9, 2710.0)?)
        .interface("sample-disc", 1.15e-4, law)
        .preloaded(Damping::Ratio(0.035))?;
    let hit = Simulation::of_hit(9.0).run(&structure)?;
    println!("at rest     {:.1} Hz", structure.natural_frequency().ok_or("no stiffness")?);
    println!("fundamental {:.1} Hz", hit.fundamental_hz().ok_or("no peak")?);
    println!("A2/A1       {:.3}", hit.harmonic_ratio().ok_or("no peak")?);
    Ok(())
}
