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
use std::time::{Duration, Instant};

use asperity_explore::{ExploreOptions, Server};
use asperity_scenario::Document;
use serde_json::{Value, json};

/// Inputs of a median, and random ones, one every so many milliseconds.
const INPUTS: usize = 40;
const RANDOM_INPUTS: u32 = 2000;
const INTERVAL: Duration = Duration::from_millis(30);

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
            // A shaker opens the contacts of the plain law from 1.4 N on.
            let shaken = if law == "pl" { 2.0 } else { 0.6 };
            let ask = |input: usize| {
                let changes = with(power(law), "/excitation/peak_n", 32.0 * moved(input));
                let changes = changes.as_array().unwrap().clone();
                let changes = with(changes, "/damping/ratio", 0.035 * moved(input));
                asked(part, &views, &changes, ("bench", shaken))
            };
            let (mut drawn, mut ended, mut spent) = (Vec::new(), Vec::new(), [0.0; 2]);
            for input in 0..INPUTS {
                let times = answer(&url, &ask(input));
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

/// Random inputs of all parts in a minute, each of which takes the place of the one before, as those of a slider that
/// moves; with the memory of the process before and after, and the last answers against those to the same questions alone.
fn random_inputs(url: &str) {
    let mut random: u64 = 1;
    let mut unit = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (random >> 40) as f64 / f64::from(1 << 24)
    };
    let parts =
        [("hit", vec!["law", "frf"]), ("levels", vec!["levels"]), ("steady", vec!["steady"])];
    let begun = Instant::now();
    let (mut before, mut open, mut last) = (None, [None, None, None], Value::Null);
    for input in 0..RANDOM_INPUTS {
        last = json!([
            ["/excitation/peak_n", 2.0 + 60.0 * unit()],
            ["/laws/modified/exponent", 0.3 + 0.1 * unit()],
            ["/damping/ratio", 0.01 + 0.05 * unit()],
        ]);
        for ((part, views), open) in parts.iter().zip(&mut open) {
            // The page gives up the answer before.
            *open = Some(send(url, &asked(part, views, &last, ("random", 0.6))));
        }
        if input == RANDOM_INPUTS / 10 {
            before = memory();
        }
        std::thread::sleep((INTERVAL * (input + 1)).saturating_sub(begun.elapsed()));
    }
    drop(open);
    let seconds = begun.elapsed().as_secs_f64();
    println!("{RANDOM_INPUTS} random inputs of all parts in {seconds:.1} s");
    if let (Some(before), Some(after)) = (before, memory()) {
        println!("memory after a tenth of them {before:.0} MB, after all {after:.0} MB");
    }
    for (part, views) in &parts {
        let [own, alone] = ["random", "alone"]
            .map(|tab| answer(url, &asked(part, views, &last, (tab, 0.6))).pictures);
        assert!(!own.is_empty() && own == alone, "{part}");
    }
    println!("the last answers are those to the same questions alone");
}

/// A question of a page about a part, with the amplitude of a shaker \[N\].
fn asked(part: &str, views: &[&str], changes: &Value, (tab, shaken): (&str, f64)) -> String {
    let views: Vec<Value> =
        views.iter().map(|view| json!({ "view": view, "width": 460 })).collect();
    json!({ "tab": tab, "part": part, "views": views, "changes": changes,
            "settings": { "amplitudes": [shaken] } })
    .to_string()
}

/// Times of an answer \[ms\]: to its first pictures with their numbers and to the end, and the processor time of the
/// process until both; and its last pictures.
struct Answer {
    pictures: Vec<String>,
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

/// Sends a request.
fn send(url: &str, body: &str) -> TcpStream {
    let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let length = body.len();
    let head = format!(
        "POST /{path}compute HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n\
         Connection: close\r\nContent-Length: {length}\r\n\r\n{body}"
    );
    stream.write_all(head.as_bytes()).unwrap();
    stream
}

/// Sends a request and reads its answer to the end.
fn answer(url: &str, body: &str) -> Answer {
    let (begun, before) = (Instant::now(), processor_ms());
    let spent = || before.zip(processor_ms()).map_or(f64::NAN, |(before, now)| now - before);
    let mut reader = BufReader::new(send(url, body));
    let (mut line, mut drawn, mut status, mut done) = (String::new(), None, String::new(), false);
    let mut pictures = Vec::new();
    while reader.read_line(&mut line).unwrap() > 0 {
        if status.is_empty() {
            status.clone_from(&line);
        }
        if line.contains(r#""answer":"picture""#) && line.contains(r#""draft":false"#) {
            pictures.push(line.clone());
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
    Answer {
        pictures,
        drawn: 1e3 * drawn.0.as_secs_f64(),
        ended: 1e3 * end.0.as_secs_f64(),
        processor: [drawn.1, end.1],
    }
}
