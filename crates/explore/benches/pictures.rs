//! Time from an input to its pictures, by part: `cargo bench -p asperity-explore`.
//!
//! The server of the paper's rig answers inputs one after another, as the page sends them while a slider moves;
//! the medians are from the request to the last line of its answer.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a benchmark prints its results")]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use asperity_explore::{ExploreOptions, Server};
use asperity_scenario::Document;
use serde_json::{Value, json};

/// Inputs of a median.
const INPUTS: usize = 40;

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
            let mut times: Vec<f64> = (0..INPUTS)
                .map(|input| {
                    let begun = Instant::now();
                    answer(&url, &ask(input).to_string());
                    1e3 * begun.elapsed().as_secs_f64()
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let shown = views.join("+");
            let (median, late) = (times[INPUTS / 2], times[INPUTS * 9 / 10]);
            println!("{name:<14}{shown:<20}{median:8.1} ms median, {late:8.1} ms at 90 %");
        }
    }
    stop.store(true, Ordering::Relaxed);
    served.join().unwrap();
}

/// Sends a request and reads its answer to the end.
fn answer(url: &str, body: &str) {
    let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let length = body.len();
    let head = format!(
        "POST /{path}compute HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n\
         Connection: close\r\nContent-Length: {length}\r\n\r\n{body}"
    );
    stream.write_all(head.as_bytes()).unwrap();
    let mut reader = BufReader::new(stream);
    let mut status = String::new();
    reader.read_line(&mut status).unwrap();
    let mut rest = String::new();
    reader.read_to_string(&mut rest).unwrap();
    assert!(status.contains("200") && rest.contains("\"done\""), "{status}{rest}");
}
