//! Draws one figure of each kind into a folder: `cargo run --example gallery -- FOLDER`.
#![allow(clippy::print_stdout, reason = "an example prints its results")]

use asperity_figure::report::{ClaimOutcome, Report, TableCell};
use asperity_figure::{Axis, Color, ColorBar, Dash, Figure, Legend, Marker, Panel, Series};
use std::{fs, path::PathBuf};

/// Magnitude of the receptance of two modes, in m/N.
fn receptance(frequency: f64, shift: f64, damping: f64) -> f64 {
    let mode = |natural: f64, stiffness: f64| {
        let r = frequency / natural;
        let (re, im) = (1.0 - r * r, 2.0 * damping * r);
        let square = stiffness * (re * re + im * im);
        (re / square, -im / square)
    };
    let (a, b) = (mode(132.0 - shift, 4e6), mode(318.0 - 0.6 * shift, 3e7));
    (a.0 + b.0).hypot(a.1 + b.1)
}

fn sweep(low: f64, high: f64, count: u32) -> Vec<f64> {
    (0..count).map(|i| low + (high - low) * f64::from(i) / f64::from(count - 1)).collect()
}

fn two_panels() -> Figure {
    let time = sweep(0.0, 0.2, 24_000);
    let decay = |damping: f64, frequency: f64| -> Vec<f64> {
        let angle = std::f64::consts::TAU * frequency;
        time.iter().map(|t| 3.1e-5 * (-damping * angle * t).exp() * (angle * t).cos()).collect()
    };
    let pressure = sweep(2e5, 4e6, 11);
    let stiffness: Vec<f64> = pressure.iter().map(|p| 4.2e9 * (p / 1e6_f64).sqrt()).collect();
    let linear: Vec<f64> = pressure.iter().map(|p| 1.2e9 + 1.9e9 * (p / 1e6)).collect();
    let lower: Vec<f64> = stiffness.iter().map(|k| 0.9 * k).collect();
    let upper: Vec<f64> = stiffness.iter().map(|k| 1.1 * k).collect();
    Figure::new("Free decay and contact stiffness")
        .panel(
            Panel::new(
                Axis::linear("Time", "ms").scale(1e3),
                Axis::linear("Displacement", "µm").scale(1e6),
            )
            .series(Series::line("without contact", &time, decay(0.035, 132.0)))
            .series(
                Series::line("with contact", &time, decay(0.02, 96.0))
                    .color(Color::RED)
                    .dash(Dash::Dashed),
            ),
        )
        .panel(
            Panel::new(
                Axis::linear("Contact pressure", "MPa").scale(1e-6).low(0.0),
                Axis::linear("Contact stiffness", "N/m³").low(0.0),
            )
            .series(Series::band("±10 %", &pressure, lower, upper).color(Color::BLUE))
            .series(
                Series::line_points("k_{n} ∝ p^{1/2}", &pressure, &stiffness).color(Color::BLUE),
            )
            .series(
                Series::line_points("linear in p", &pressure, linear)
                    .color(Color::BLACK)
                    .marker(Marker::Square)
                    .filled(true),
            )
            .note(pressure[3], stiffness[3], "preload"),
        )
}

fn force_levels() -> Figure {
    let frequency = sweep(20.0, 450.0, 4000);
    let levels = [0.05, 0.1, 0.2, 0.4, 0.8, 1.15, 1.6, 2.3];
    let bar = ColorBar::continuous("Force amplitude", "N", levels[0], levels[7]);
    let mut panel = Panel::new(
        Axis::linear("Frequency", "Hz").range(0.0, 450.0),
        Axis::log("Receptance |H|", "m/N"),
    )
    .color_bar(bar.clone());
    for level in levels {
        let gain =
            frequency.iter().map(|f| receptance(*f, 14.0 * level, 0.012)).collect::<Vec<_>>();
        panel = panel.series(Series::line("", &frequency, gain).color(bar.color(level)));
    }
    let linear: Vec<f64> = frequency.iter().map(|f| receptance(*f, 0.0, 0.012)).collect();
    let linear = Series::line("linearised", &frequency, linear);
    Figure::new("Receptance at eight force levels")
        .panel(panel.series(linear.color(Color::RED).dash(Dash::Dashed)))
}

fn three_markers() -> Figure {
    let order = sweep(1.0, 8.0, 8);
    let error = |rate: f64, start: f64| -> Vec<f64> {
        order.iter().map(|n| start * rate.powf(*n) * (1.0 + 0.3 * (7.0 * n).sin())).collect()
    };
    Figure::new("Harmonics").panel(
        Panel::new(
            Axis::linear("Harmonic order", "").range(0.5, 8.5),
            Axis::log("Amplitude over the first harmonic", ""),
        )
        .series(Series::points("measured", &order, error(0.22, 4.5)).color(Color::BLACK))
        .series(
            Series::points("law of Hertz", &order, error(0.25, 4.0))
                .color(Color::BLUE)
                .marker(Marker::Triangle),
        )
        .series(
            Series::points("exponential law", &order, error(0.17, 6.0))
                .color(Color::RED)
                .marker(Marker::Cross),
        )
        .horizontal(2e-5, "noise floor"),
    )
}

fn many_panels() -> Figure {
    let x = sweep(0.1, 1000.0, 300);
    let y: Vec<f64> = x.iter().map(|x| x.powi(2) * 1e-3).collect();
    let gaps: Vec<f64> = x
        .iter()
        .map(|x| if (300.0..500.0).contains(x) { f64::NAN } else { (x / 80.0).sin() })
        .collect();
    let noise: Vec<f64> = x.iter().map(|x| (x * 91.7).sin() * 1e-7).collect();
    Figure::new("Four panels")
        .panel(
            Panel::new(Axis::log("Log abscissa", "s"), Axis::log("Log ordinate", "kg"))
                .series(Series::line("square", &x, y).color(Color::PURPLE)),
        )
        .panel(
            Panel::new(Axis::linear("With a gap", ""), Axis::linear("Sine", ""))
                .series(Series::line("gap", &x, gaps).color(Color::GREEN))
                .vertical(300.0, "gap starts")
                .legend(Legend::BottomLeft),
        )
        .panel(
            Panel::new(Axis::linear("Dense", "Hz"), Axis::linear("Noise", "V"))
                .title("A legend that finds no free place")
                .series(Series::line("first long name", &x, &noise).color(Color::ORANGE).width(0.6))
                .series(
                    Series::line(
                        "second name",
                        &x,
                        noise.iter().map(|v| 0.6 * v).collect::<Vec<_>>(),
                    )
                    .width(0.6),
                )
                .series(
                    Series::line("third", &x, noise.iter().map(|v| 0.3 * v).collect::<Vec<_>>())
                        .width(0.6),
                ),
        )
        .panel(
            Panel::new(
                Axis::linear("Order", "").range(0.0, 10.0),
                Axis::linear("Amplitude", "m/s²"),
            )
            .series(Series::points("", sweep(1.0, 9.0, 5), [10.0, 3.0, 5.0, 1.0, 0.5]))
            .color_bar(ColorBar::continuous("Contact pressure", "Pa", 1e3, 1e7)),
        )
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "gallery".to_owned()));
    fs::create_dir_all(&folder)?;
    let figures = [
        ("two-panels", two_panels()),
        ("force-levels", force_levels()),
        ("three-markers", three_markers()),
        ("many-panels", many_panels()),
    ];
    let mut report = Report::new("Gallery of figures")
        .intro("One figure of each kind, drawn from computed tables.")
        .section("Figures");
    let mut pictures = Vec::new();
    for (name, figure) in &figures {
        pictures.push((*name, figure.to_svg(), figure.to_png(12.0)));
    }
    for (name, svg, png) in pictures {
        println!("{name}: {} bytes of SVG", svg.len());
        fs::write(folder.join(format!("{name}.svg")), &svg)?;
        fs::write(folder.join(format!("{name}.png")), png?)?;
        report = report.figure(name, format!("The figure called {name}."), svg);
    }
    let report = report
        .section("Claims")
        .table(
            ["Quantity", "Claimed", "Found", "Outcome"],
            [
                vec!["f_{1} (Hz)".into(), 132.0.into(), 131.96.into(), ClaimOutcome::Pass.into()],
                vec![
                    "k_{n} (N/m^{3})".into(),
                    4.2e9.into(),
                    4.9e9.into(),
                    ClaimOutcome::Fail.into(),
                ],
                vec![
                    "ζ (%)".into(),
                    3.5.into(),
                    TableCell::from(f64::NAN),
                    ClaimOutcome::Warn.into(),
                ],
            ],
        )
        .section("How it was made")
        .key_values([("seed", "none"), ("laws", "Hertz, exponential")]);
    fs::write(folder.join("index.html"), report.to_html())?;
    fs::write(folder.join("index.md"), report.to_markdown(|id| format!("{id}.png")))?;
    Ok(())
}
