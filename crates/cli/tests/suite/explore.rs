//! `asperity explore`: its address, and its end.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::{asperity, fixture, text};

#[cfg(unix)]
#[test]
fn the_page_is_served_until_ctrl_c() {
    let scenario = fixture("scenarios/nouira2020-modified.json");
    let mut child = Command::new(env!("CARGO_BIN_EXE_asperity"))
        .args(["explore", "--no-browser", "--set", "/excitation/peak_n=20"])
        .arg(scenario)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut url = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut url).unwrap();
    let (host, path) = url.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
    assert!(host.starts_with("127.0.0.1:"), "{url}");
    let mut stream = TcpStream::connect(host).unwrap();
    let head = format!("GET /{path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).unwrap();
    let mut page = String::new();
    stream.read_to_string(&mut page).unwrap();
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("explore.js"), "{page}");
    let id = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(id, rustix::process::Signal::INT).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0));
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
