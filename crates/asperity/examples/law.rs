//! Closures of a contact law from a table of measured stiffnesses.
#![allow(clippy::print_stdout, reason = "an example prints its results")]

use asperity::prelude::*;

fn main() -> Result<(), LawError> {
    // Pressure [Pa] and contact stiffness per area [Pa/m].
    let measured = [(0.14e6, 1.15e12), (0.35e6, 1.75e12), (0.57e6, 1.95e12), (1e6, 2.46e12)];
    let law = Tabulated::new(&measured)?;
    for (pressure, stiffness) in measured {
        println!("{pressure:.2e} Pa: {stiffness:.2e} Pa/m, {:.4e} m", law.closure(pressure));
    }
    let power = fit_power(&measured)?;
    println!("K = {:.3e} p^{:.3}", power.coefficient, power.exponent);
    Ok(())
}
