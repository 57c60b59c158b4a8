//! Time from an input to its pictures, by part: `cargo bench -p asperity-explore`.
//!
//! The server of the paper's rig answers inputs one after another, as the page sends them while a slider moves;
//! the medians are from the request to the last of its first pictures, and to the last line of its answer.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a benchmark prints its results")]

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use asperity_explore::{ExploreOptions, Server};
use asperity_scenario::Document;
use serde_json::{Value, json};

/// Inputs of a median, and random ones.
const INPUTS: usize = 40;
const RANDOM_INPUTS: usize = 1000;

fn main() {
    let rig = "../../fixtures/scenarios/nouira2020-modified.json";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(rig);
    let mut document = Document::read(path).unwrap();
    document.set("/method", "\"modal\"").unwrap();
    let server = Server::of(document, &ExploreOptions::default()).unwrap();
    let url = server.url();
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let served = std::thread::spawn(move || server.run(&flag).unwrap());

    let power = |law: &str| {
        json!([["/interfaces/0/law", law], ["/interfaces/1/law", law]]).as_array().unwrap().clone()
    };
    let with = |mut changes: Vec<Value>, pointer: &str, value: f64| {
        changes.push(json!([pointer, value]));
        Value::Array(changes)
    };
    // Contact is kept with the modified law, and lost with the plain one from some newtons on.
    for (name, law) in [("contact kept", "modified"), ("contact lost", "pl")] {
        let moved = |part: usize| 0.9 + 0.2 * part as f64 / INPUTS as f64;
        for (part, views) in [
            ("hit", vec!["law", "frf", "history"]),
            ("hit", vec!["frf"]),
            ("hit", vec!["history"]),
            ("levels", vec!["levels"]),
            ("steady", vec!["steady"]),
        ] {
            let ask = |input: usize| {
                let changes = with(power(law), "/excitation/peak_n", 32.0 * moved(input));
                let changes = changes.as_array().unwrap().clone();
                let changes = with(changes, "/damping/ratio", 0.035 * moved(input));
                let views: Vec<Value> =
                    views.iter().map(|view| json!({ "view": view, "width": 460 })).collect();
                json!({ "tab": "bench", "part": part, "views": views, "changes": changes,
                        "settings": { "amplitudes": [0.6] } })
            };
            let (mut drawn, mut ended, mut spent) = (Vec::new(), Vec::new(), [0.0; 2]);
            for input in 0..INPUTS {
                let times = answer(&url, &ask(input).to_string());
                drawn.push(times.drawn);
                ended.push(times.ended);
                spent = [0, 1].map(|at| spent[at] + times.processor[at] / INPUTS as f64);
            }
            drawn.sort_by(f64::total_cmp);
            ended.sort_by(f64::total_cmp);
            let shown = views.join("+");
            let (median, late) = (drawn[INPUTS / 2], drawn[INPUTS * 9 / 10]);
            let end = ended[INPUTS / 2];
            println!(
                "{name:<14}{shown:<18}{median:7.1} ms to the pictures, {late:7.1} ms at 90 %, {end:7.1} ms to the end; \
                 processor {:6.1} and {:6.1} ms",
                spent[0], spent[1]
            );
        }
    }
    random_inputs(&url);
    stop.store(true, Ordering::Relaxed);
    served.join().unwrap();
}

/// Many random inputs, with the memory of the process before and after.
fn random_inputs(url: &str) {
    let mut random: u64 = 1;
    let mut unit = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (random >> 40) as f64 / f64::from(1 << 24)
    };
    let begun = Instant::now();
    let mut before = None;
    for input in 0..RANDOM_INPUTS {
        let changes = json!([
            ["/excitation/peak_n", 2.0 + 60.0 * unit()],
            ["/laws/modified/exponent", 0.3 + 0.1 * unit()],
            ["/damping/ratio", 0.01 + 0.05 * unit()],
        ]);
        let pinned = json!([["/excitation/peak_n", (20.0 * unit()).ceil()]]);
        let views = json!([{ "view": "law", "width": 460 }, { "view": "frf", "width": 460 }]);
        let asked = json!({ "tab": "bench", "part": "hit", "views": views, "changes": changes,
                            "pinned": pinned });
        answer(url, &asked.to_string());
        if input == RANDOM_INPUTS / 10 {
            before = memory();
        }
    }
    let seconds = begun.elapsed().as_secs_f64();
    println!("{RANDOM_INPUTS} random inputs in {seconds:.1} s");
    if let (Some(before), Some(after)) = (before, memory()) {
        println!("memory after a tenth of them {before:.0} MB, after all {after:.0} MB");
    }
}

/// Times of an answer \[ms\]: to its first pictures with their numbers and to the end, and the processor time of the
/// process until both.
struct Times {
    drawn: f64,
    ended: f64,
    processor: [f64; 2],
}

/// Processor time of the process \[ms\], in ticks of 10 ms; none where the system does not tell.
fn processor_ms() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
    let ticks = [11, 12].map(|field| fields.get(field)?.parse::<f64>().ok());
    Some(10.0 * (ticks[0]? + ticks[1]?))
}

/// Resident memory \[MB\]; none where the system does not tell.
fn memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with("VmRSS:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

/// Sends a request and reads its answer to the end.
fn answer(url: &str, body: &str) -> Times {
    let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
    let (begun, before) = (Instant::now(), processor_ms());
    let spent = || before.zip(processor_ms()).map_or(f64::NAN, |(before, now)| now - before);
    let mut stream = TcpStream::connect(host).unwrap();
    let length = body.len();
    let head = format!(
        "POST /{path}compute HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n\
         Connection: close\r\nContent-Length: {length}\r\n\r\n{body}"
    );
    stream.write_all(head.as_bytes()).unwrap();
    let mut reader = BufReader::new(stream);
    let (mut line, mut drawn, mut status, mut done) = (String::new(), None, String::new(), false);
    while reader.read_line(&mut line).unwrap() > 0 {
        if status.is_empty() {
            status.clone_from(&line);
        }
        if drawn.is_none() && line.contains(r#""answer":"words""#) {
            drawn = Some((begun.elapsed(), spent()));
        }
        done |= line.contains(r#""answer":"done""#);
        line.clear();
    }
    let end = (begun.elapsed(), spent());
    assert!(status.contains("200") && done, "{status}");
    let drawn = drawn.unwrap_or(end);
    Times {
        drawn: 1e3 * drawn.0.as_secs_f64(),
        ended: 1e3 * end.0.as_secs_f64(),
        processor: [drawn.1, end.1],
    }
}
