//! Requests that are answered, and those that are refused.

use serde_json::json;

use crate::client::{Page, line, read, request};

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let page = Page::new();
    let html = page.get("");
    assert_eq!(html.status, 200);
    for (name, kind) in [
        ("style.css", "text/css"),
        ("explore.js", "text/javascript"),
        ("figures.js", "text/javascript"),
        ("font-0.otf", "font/otf"),
    ] {
        let file = page.get(name);
        assert!(file.status == 200 && file.head.contains(kind), "{name}: {}", file.head);
    }
    let policy = "content-security-policy: default-src 'none'; script-src 'self'";
    assert!(html.head.to_ascii_lowercase().contains(policy), "{}", html.head);
    for text in [html.body, page.get("style.css").body, page.get("explore.js").body] {
        let fetched = text.replace("http://www.w3.org/2000/svg", "");
        assert!(!fetched.contains("http://") && !fetched.contains("https://"));
        assert!(!text.contains("eval(") && !text.contains(" style=\""));
    }
}

#[test]
fn an_address_without_the_token_is_unknown() {
    let page = Page::new();
    let host = [format!("Host: {}", page.host)];
    for path in ["/", "/explore.js", "/0123456789abcdef0123456789abcdef/", "/../", "/%2e%2e/"] {
        assert_eq!(page.request("GET", path, &host, b"").status, 404, "{path}");
    }
    let other = Page::new();
    assert_ne!(page.path, other.path, "tokens are random");
    assert!(page.path.len() > 32);
}

#[test]
fn names_bound_to_the_loopback_address_are_refused() {
    let page = Page::new();
    let port = page.host.rsplit(':').next().unwrap().to_owned();
    for host in ["evil.example".to_owned(), format!("evil.example:{port}"), "127.0.0.1".to_owned()]
    {
        let answer = page.request("GET", &page.path, &[format!("Host: {host}")], b"");
        assert_eq!(answer.status, 403, "{host}");
    }
    let local = [format!("Host: localhost:{port}")];
    assert_eq!(page.request("GET", &page.path, &local, b"").status, 200);
}

#[test]
fn requests_of_other_pages_are_refused() {
    let page = Page::new();
    let body = json!({ "changes": [] }).to_string();
    let host = format!("Host: {}", page.host);
    let path = format!("{}state", page.path);
    for origin in [
        Some("http://evil.example"),
        Some("null"),
        Some("http://127.0.0.1:1"),
        Some("https://127.0.0.1"),
        None,
    ] {
        let origin = origin.map(|origin| format!("Origin: {origin}"));
        let head: Vec<String> = [host.clone()].into_iter().chain(origin.clone()).collect();
        assert_eq!(page.request("POST", &path, &head, body.as_bytes()).status, 403, "{origin:?}");
    }
    assert_eq!(page.post("state", &json!({ "changes": [] })).status, 200);
}

#[test]
fn a_malformed_request_is_refused_alone() {
    let page = Page::new();
    let path = format!("{}compute", page.path);
    let head = page.own_head();
    let good = || request("t", "hit", &["law"], &json!([]), &json!({}));
    let mut unknown_key = good();
    unknown_key["file"] = json!("/etc/passwd");
    let mut long_name = good();
    long_name["tab"] = json!("t".repeat(65));
    let mut many_views = good();
    many_views["views"] = json!(vec![json!({ "view": "law", "width": 1 }); 100]);
    let mut many_changes = good();
    many_changes["changes"] = json!(vec![json!(["/duration_s", 1]); 501]);
    let mut other_view = good();
    other_view["views"] = json!([{ "view": "passwords", "width": 1 }]);
    let texts =
        [unknown_key, long_name, many_views, many_changes, other_view].map(|v| v.to_string());
    let deep = "[".repeat(100_000);
    for text in texts.iter().map(String::as_str).chain(["", "{", "\u{0}", "[1]", &deep]) {
        let answer = page.request("POST", &path, &head, text.as_bytes());
        let start = &text[..text.len().min(80)];
        assert_eq!(answer.status, 400, "{start}: {}", answer.body);
        assert!(answer.body.contains("\"error\""), "{start}: {}", answer.body);
    }
    assert_eq!(page.request("POST", &path, &head, &vec![b' '; 3 << 20]).status, 413);
    assert_eq!(page.post("compute", &good()).status, 200);
}

/// A width that no figure can have is drawn at one that it can.
#[test]
fn pictures_have_bounded_sizes() {
    let page = Page::new();
    for width in [json!(-1e300), json!(0), json!(1e300)] {
        let mut asked = request("t", "hit", &["law"], &json!([]), &json!({}));
        asked["views"][0]["width"] = width;
        let lines = page.post("compute", &asked).lines();
        assert!(line(&lines, "picture")["svg"].as_str().unwrap().len() < 1 << 20);
    }
}

#[test]
fn the_server_ends_with_its_flag() {
    let page = Page::new();
    // A run of some minutes: it is not waited for.
    let changes =
        json!([["/duration_s", 7], ["/method", { "kind": "finite_difference", "cell_m": 1e-4 }]]);
    let asked = request("t", "hit", &["frf"], &changes, &json!({})).to_string();
    let path = format!("{}compute", page.path);
    let running = page.open("POST", &path, &page.own_head(), asked.as_bytes());
    assert_eq!(page.get("").status, 200);
    page.end();
    assert!(!read(running).body.contains("\"done\""));
}
