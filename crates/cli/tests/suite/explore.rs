//! `asperity explore`: its address, and its end.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::{asperity, fixture, text};

/// A page under way, which ends with it.
struct Served {
    child: Child,
    host: String,
    path: String,
}

impl Served {
    fn of(scenario: &Path, more: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_asperity"))
            .args(["explore", "--no-browser"])
            .args(more)
            .arg(scenario)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut url = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut url).unwrap();
        let (host, path) = url.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
        assert!(host.starts_with("127.0.0.1:"), "{url}");
        Self { child, host: host.to_owned(), path: format!("/{path}") }
    }

    /// Sends a request, and returns the open connection.
    fn open(&self, method: &str, place: &str, body: &str) -> TcpStream {
        let Self { host, path, .. } = self;
        let mut stream = TcpStream::connect(host).unwrap();
        let head = format!(
            "{method} {path}{place} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nConnection: close\r\n\
             Content-Length: {}\r\n\r\n{body}",
            body.len()
        );
        stream.write_all(head.as_bytes()).unwrap();
        stream
    }

    /// Asks for the response to a hit of this peak \[N\].
    fn hit(&self, peak: f64) -> TcpStream {
        let changes = format!("[[\"/excitation/peak_n\", {peak}]]");
        let views = r#"[{"view": "frf", "width": 600}]"#;
        let body =
            format!(r#"{{"tab": "t", "part": "hit", "views": {views}, "changes": {changes}}}"#);
        self.open("POST", "compute", &body)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn whole(mut stream: TcpStream) -> String {
    let mut text = Vec::new();
    // A reset after the answer is an end too.
    let _ = stream.read_to_end(&mut text);
    String::from_utf8_lossy(&text).into_owned()
}

#[cfg(unix)]
#[test]
fn the_page_is_served_until_ctrl_c() {
    let scenario = fixture("scenarios/nouira2020-modified.json");
    let mut served = Served::of(&scenario, &["--set", "/excitation/peak_n=20"]);
    let page = whole(served.open("GET", "", ""));
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("explore.js"), "{page}");
    let id = rustix::process::Pid::from_child(&served.child);
    rustix::process::kill_process(id, rustix::process::Signal::INT).unwrap();
    assert_eq!(served.child.wait().unwrap().code(), Some(0));
}

/// 2000 inputs, fifty at a time: all are answered or superseded, the last one is right, and after the first 500 the memory
/// does not grow.
#[cfg(target_os = "linux")]
#[test]
fn many_inputs_leave_the_memory_flat() {
    let block = Path::new(env!("CARGO_MANIFEST_DIR")).join("../simulation/examples/block.json");
    let served = Served::of(&block, &[]);
    let memory_kb = || -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", served.child.id()));
        let status = status.unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.trim().trim_end_matches(" kB").parse().unwrap()
    };
    let (mut random, mut early) = (1_u64, 0);
    for round in 0..40 {
        let peak = |random: &mut u64| {
            *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            1.0 + (*random >> 40) as f64 / f64::from(1 << 24) * 8.0
        };
        let streams: Vec<TcpStream> = (0..50).map(|_| served.hit(peak(&mut random))).collect();
        for stream in streams {
            let answer = whole(stream);
            let is_ended = ["done", "superseded"].map(|end| format!(r#"{{"answer":"{end}""#));
            assert!(is_ended.iter().any(|end| answer.contains(end)), "{answer}");
        }
        if round == 9 {
            early = memory_kb();
        }
    }
    let late = memory_kb();
    assert!(late < early + 30_000, "{early} kB after 500 inputs, {late} kB after 2000");
    let answer = whole(served.hit(7.25));
    let folder = tempfile::tempdir().unwrap();
    let block = block.display().to_string();
    let command =
        asperity(folder.path(), &["simulate", &block, "--set", "/excitation/peak_n=7.25"]);
    let printed = text(&command.stdout);
    let fundamental = printed.lines().find(|line| line.starts_with("fundamental")).unwrap();
    assert!(answer.contains(fundamental.trim_end()), "{fundamental}: {answer}");
}

#[test]
fn wrong_requests_are_named() {
    let here = Path::new(".");
    let scenario = fixture("scenarios/nouira2020-modified.json").display().to_string();
    let absent = asperity(here, &["explore", &scenario, "--data", "absent.json"]);
    assert_eq!(absent.status.code(), Some(2));
    assert!(text(&absent.stderr).contains("absent.json"), "{}", text(&absent.stderr));
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let refused = asperity(here, &["explore", &scenario, "--no-browser", "--port", &port]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains(&port), "{}", text(&refused.stderr));
}
