//! A client of HTTP/1.1, and a server in a thread.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use asperity_explore::{ExploreOptions, Server};
use asperity_scenario::Document;
use serde_json::{Value, json};

/// A server of a scenario, which ends with it.
pub(crate) struct Page {
    pub(crate) host: String,
    pub(crate) path: String,
    stop: Arc<AtomicBool>,
    served: Option<JoinHandle<()>>,
}

/// Status and body of an answer.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: String,
}

pub(crate) fn block() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../simulation/examples/block.json")
}

/// The block with another value.
pub(crate) fn changed(pointer: &str, value: &str) -> Document {
    let mut document = Document::read(block()).unwrap();
    document.set(pointer, value).unwrap();
    document
}

impl Page {
    pub(crate) fn of(scenario: &Path, options: &ExploreOptions) -> Self {
        Self::of_document(Document::read(scenario).unwrap(), options)
    }

    pub(crate) fn of_document(document: Document, options: &ExploreOptions) -> Self {
        let server = Server::of(document, options).unwrap();
        let url = server.url();
        let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
        let (host, path) = (host.to_owned(), format!("/{path}"));
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        let served = std::thread::spawn(move || server.run(&flag).unwrap());
        Self { host, path, stop, served: Some(served) }
    }

    /// Address of the page.
    pub(crate) fn url(&self) -> String {
        format!("http://{}{}", self.host, self.path)
    }

    pub(crate) fn new() -> Self {
        Self::of(&block(), &ExploreOptions::default())
    }

    /// Sends a request with these lines of the head, and returns the open connection.
    pub(crate) fn open(&self, method: &str, path: &str, head: &[String], body: &[u8]) -> TcpStream {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let length = body.len();
        let text = format!(
            "{method} {path} HTTP/1.1\r\n{}\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n",
            head.join("\r\n")
        );
        // A server that refuses does not read to the end.
        let _ = stream.write_all(text.as_bytes()).and_then(|()| stream.write_all(body));
        stream
    }

    pub(crate) fn request(&self, method: &str, path: &str, head: &[String], body: &[u8]) -> Answer {
        read(self.open(method, path, head, body))
    }

    pub(crate) fn own_head(&self) -> Vec<String> {
        vec![format!("Host: {}", self.host), format!("Origin: http://{}", self.host)]
    }

    pub(crate) fn get(&self, name: &str) -> Answer {
        let head = [format!("Host: {}", self.host)];
        self.request("GET", &format!("{}{name}", self.path), &head, b"")
    }

    pub(crate) fn post(&self, name: &str, body: &Value) -> Answer {
        let text = body.to_string();
        let path = format!("{}{name}", self.path);
        self.request("POST", &path, &self.own_head(), text.as_bytes())
    }

    /// The lines of the answer to a computation.
    pub(crate) fn compute(&self, part: &str, views: &[&str], changes: &Value) -> Vec<Value> {
        self.compute_with(part, views, changes, &json!({}))
    }

    pub(crate) fn compute_with(
        &self,
        part: &str,
        views: &[&str],
        changes: &Value,
        settings: &Value,
    ) -> Vec<Value> {
        let answer = self.post("compute", &request("tab", part, views, changes, settings));
        assert_eq!(answer.status, 200, "{}", answer.body);
        answer.lines()
    }

    pub(crate) fn end(mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.served.take().unwrap().join().unwrap();
    }
}

/// A request of a computation.
pub(crate) fn request(
    tab: &str,
    part: &str,
    views: &[&str],
    changes: &Value,
    settings: &Value,
) -> Value {
    let views: Vec<Value> =
        views.iter().map(|view| json!({ "view": view, "width": 600 })).collect();
    json!({ "tab": tab, "part": part, "views": views, "changes": changes, "settings": settings })
}

impl Drop for Page {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Answer {
    /// The lines of a body, each a JSON value.
    pub(crate) fn lines(&self) -> Vec<Value> {
        self.body.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }
}

/// The answer on a connection, which the server closes.
pub(crate) fn read(mut stream: TcpStream) -> Answer {
    let mut bytes = Vec::new();
    // A reset after the answer is an end too.
    let _ = stream.read_to_end(&mut bytes);
    let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").expect("a head");
    let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    let rest = bytes.split_off(end + 4);
    let is_chunked = head.to_ascii_lowercase().contains("transfer-encoding: chunked");
    let body = if is_chunked { joined(&rest) } else { rest };
    Answer { status, head, body: String::from_utf8_lossy(&body).into_owned() }
}

/// The chunks of a body.
fn joined(mut rest: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    while let Some(end) = rest.windows(2).position(|two| two == b"\r\n") {
        let length = usize::from_str_radix(std::str::from_utf8(&rest[..end]).unwrap(), 16).unwrap();
        if length == 0 {
            break;
        }
        body.extend_from_slice(&rest[end + 2..end + 2 + length]);
        rest = &rest[end + 4 + length..];
    }
    body
}

/// The line of this kind.
pub(crate) fn line<'a>(lines: &'a [Value], kind: &str) -> &'a Value {
    let found = lines.iter().find(|line| line["answer"] == kind);
    found.unwrap_or_else(|| panic!("no {kind} in {lines:?}"))
}
