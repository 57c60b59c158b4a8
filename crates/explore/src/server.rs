//! The server: its addresses, and the checks of every request.

use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use asperity_figure::BUNDLED_FONTS;
use asperity_scenario::Document;
use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{DefaultBodyLimit, Request, State as Shared};
use axum::http::header::{self, HeaderMap, HeaderValue};
use axum::http::{Method, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, mpsc};

use crate::explorer::{self, ExploreError, ExploreOptions, Explorer};
use crate::jobs::Job;
use crate::message::{ComputeRequest, KeepRequest, MOST_BYTES, PulseRequest, StateRequest};
use crate::page;
use crate::session::DEFECT;

/// Time between two looks at the flag that ends the server.
const LOOK: Duration = Duration::from_millis(50);

/// Lines of an answer that wait for the page.
const LINES: usize = 16;

/// Nothing but the files of the page, and nothing from elsewhere.
const CONTENT_SECURITY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self'; \
                                connect-src 'self'; img-src 'self'; base-uri 'none'; form-action 'none'; \
                                frame-ancestors 'none'";

/// The server of a scenario's page, listening and not yet answering.
#[derive(Debug)]
pub struct Server {
    listener: std::net::TcpListener,
    address: SocketAddr,
    token: String,
    explorer: Arc<Explorer>,
}

/// State that requests share.
#[derive(Debug)]
struct Site {
    address: SocketAddr,
    token: String,
    explorer: Arc<Explorer>,
    /// Computations at a time.
    room: Arc<Semaphore>,
}

impl Server {
    /// Reads a scenario and listens at the loopback address.
    ///
    /// # Errors
    /// [`ExploreError`] for a scenario that is not valid or an address in use.
    pub fn open(scenario: &Path, options: &ExploreOptions) -> Result<Self, ExploreError> {
        Self::of(Document::read(scenario)?, options)
    }

    /// As [`open`](Self::open), for a document that has been read, with its changes.
    ///
    /// # Errors
    /// Those of [`open`](Self::open).
    pub fn of(document: Document, options: &ExploreOptions) -> Result<Self, ExploreError> {
        Self::new(Arc::new(Explorer::new(document, options)?), options.port)
    }

    /// The server of a page, at a port or at any.
    ///
    /// # Errors
    /// [`ExploreError::Port`] for an address in use, [`ExploreError::System`] without random numbers.
    pub fn new(explorer: Arc<Explorer>, port: Option<u16>) -> Result<Self, ExploreError> {
        let port = port.unwrap_or(0);
        let listening = std::net::TcpListener::bind((Ipv4Addr::LOCALHOST, port)).and_then(|one| {
            one.set_nonblocking(true)?;
            Ok((one.local_addr()?, one))
        });
        let (address, listener) =
            listening.map_err(|source| ExploreError::Port { port, source })?;
        let token = token().map_err(ExploreError::System)?;
        Ok(Self { listener, address, token, explorer })
    }

    /// Address of the page, with its token.
    pub fn url(&self) -> String {
        format!("http://{}/{}/", self.address, self.token)
    }

    /// Answers requests until `stop` is set; computations under way are stopped then.
    ///
    /// # Errors
    /// [`ExploreError::System`] where the system gives no thread.
    pub fn run(self, stop: &Arc<AtomicBool>) -> Result<(), ExploreError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(ExploreError::System)?;
        let served = runtime.block_on(self.serve(Arc::clone(stop)));
        // A computation that has not ended by now is left behind.
        runtime.shutdown_background();
        served.map_err(ExploreError::System)
    }

    async fn serve(self, stop: Arc<AtomicBool>) -> io::Result<()> {
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let listener = TcpListener::from_std(self.listener)?;
        let Self { address, token, explorer, .. } = self;
        let site =
            Arc::new(Site { address, token, explorer, room: Arc::new(Semaphore::new(cores)) });
        let server = axum::serve(listener, routes(&site));
        tokio::select! {
            served = async { server.await } => served,
            () = stopped(&stop) => {
                site.explorer.close();
                Ok(())
            }
        }
    }
}

async fn stopped(stop: &AtomicBool) {
    while !stop.load(Ordering::Relaxed) {
        tokio::time::sleep(LOOK).await;
    }
}

/// A random text of 128 bits.
fn token() -> io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(io::Error::from)?;
    Ok(format!("{:032x}", u128::from_ne_bytes(bytes)))
}

fn routes(site: &Arc<Site>) -> Router {
    let at = |name: &str| format!("/{}/{name}", site.token);
    let mut router = Router::new()
        .route(&at(""), get(|| file("text/html; charset=utf-8", page::HTML.as_bytes())))
        .route(&at("style.css"), get(|| file("text/css; charset=utf-8", page::style().as_bytes())))
        .route(&at("explore.js"), get(|| file(SCRIPT, page::SCRIPT.as_bytes())))
        .route(&at("figures.js"), get(|| file(SCRIPT, page::figures().as_bytes())))
        .route(&at("state"), post(state))
        .route(&at("pulse"), post(pulse))
        .route(&at("compute"), post(compute))
        .route(&at("keep"), post(keep));
    for (number, font) in BUNDLED_FONTS.iter().enumerate() {
        router = router.route(&at(&page::font_name(number)), get(|| file("font/otf", font.data)));
    }
    router
        .fallback(|| async { refusal(StatusCode::NOT_FOUND, "there is no such address") })
        .layer(DefaultBodyLimit::max(MOST_BYTES))
        .layer(from_fn_with_state(Arc::clone(site), guarded))
        .with_state(Arc::clone(site))
}

const SCRIPT: &str = "text/javascript; charset=utf-8";

fn file(kind: &'static str, data: &'static [u8]) -> std::future::Ready<Response> {
    std::future::ready(([(header::CONTENT_TYPE, kind)], data).into_response())
}

/// Refuses requests from other pages, and gives every answer its headers.
async fn guarded(Shared(site): Shared<Arc<Site>>, request: Request, next: Next) -> Response {
    let reason = foreign(request.method(), request.headers(), site.address);
    let mut response = match reason {
        Some(reason) => refusal(StatusCode::FORBIDDEN, reason),
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, CONTENT_SECURITY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (header::HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (header::HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

/// The reason to refuse a request that does not come from the page itself: a name that was bound to the
/// loopback address shows in `Host`, another page in `Origin`.
fn foreign(method: &Method, headers: &HeaderMap, address: SocketAddr) -> Option<&'static str> {
    let text = |name| headers.get(name).and_then(|value: &HeaderValue| value.to_str().ok());
    let hosts = [address.to_string(), format!("localhost:{}", address.port())];
    let host = text(header::HOST).unwrap_or_default();
    if !hosts.iter().any(|own| own == host) {
        return Some("the host is not the address of this server");
    }
    match text(header::ORIGIN) {
        Some(origin) if origin.strip_prefix("http://") == Some(host) => None,
        None if method == Method::GET && !headers.contains_key(header::ORIGIN) => None,
        _ => Some("the request does not come from the page of this server"),
    }
}

fn refusal(status: StatusCode, reason: &str) -> Response {
    (status, [(header::CONTENT_TYPE, JSON)], explorer::refusal(reason)).into_response()
}

const JSON: &str = "application/json";

/// The request in a body, or the answer that refuses it.
fn parsed<T: serde::de::DeserializeOwned>(
    body: &Bytes,
    fault: impl Fn(&T) -> Option<String>,
) -> Result<T, Response> {
    explorer::parsed(body, fault).map_err(|fault| refusal(StatusCode::BAD_REQUEST, &fault))
}

/// Answers with the controls of a state.
async fn state(Shared(site): Shared<Arc<Site>>, body: Bytes) -> Response {
    let request = match parsed(&body, StateRequest::fault) {
        Ok(request) => request,
        Err(refusal) => return refusal,
    };
    let described =
        tokio::task::spawn_blocking(move || site.explorer.session.describe(&request)).await;
    match described {
        Ok(text) => ([(header::CONTENT_TYPE, JSON)], text).into_response(),
        Err(_) => refusal(StatusCode::INTERNAL_SERVER_ERROR, DEFECT),
    }
}

/// Answers with the measured force of a hit.
async fn pulse(Shared(site): Shared<Arc<Site>>, body: Bytes) -> Response {
    match parsed(&body, PulseRequest::fault) {
        Ok(request) => {
            let answer = site.explorer.session.pulse(&request).to_string();
            ([(header::CONTENT_TYPE, JSON)], answer).into_response()
        }
        Err(refusal) => refusal,
    }
}

/// Writes files to the folder of the page.
async fn keep(Shared(site): Shared<Arc<Site>>, body: Bytes) -> Response {
    let request = match parsed(&body, KeepRequest::fault) {
        Ok(request) => request,
        Err(refusal) => return refusal,
    };
    let _room = Arc::clone(&site.room).acquire_owned().await;
    let kept = tokio::task::spawn_blocking(move || site.explorer.session.keep(&request)).await;
    match kept {
        Ok(answer) => ([(header::CONTENT_TYPE, JSON)], answer.to_string()).into_response(),
        Err(_) => refusal(StatusCode::INTERNAL_SERVER_ERROR, DEFECT),
    }
}

/// Lines of JSON: the pictures and numbers of a part.
async fn compute(Shared(site): Shared<Arc<Site>>, body: Bytes) -> Response {
    let request = match parsed(&body, ComputeRequest::fault) {
        Ok(request) => request,
        Err(refusal) => return refusal,
    };
    let Some(job) = site.explorer.jobs.begin(&request.tab, request.part) else {
        return refusal(StatusCode::SERVICE_UNAVAILABLE, "the server ends");
    };
    let (sender, receiver) = mpsc::channel(LINES);
    let lines = Lines { receiver, stop: Arc::clone(&job.stop) };
    tokio::spawn(computed(site, request, job, sender));
    ([(header::CONTENT_TYPE, "application/x-ndjson")], Body::from_stream(lines)).into_response()
}

/// Computes a part once the older computation of its page has ended.
async fn computed(
    site: Arc<Site>,
    request: ComputeRequest,
    job: Job,
    sender: mpsc::Sender<Vec<u8>>,
) {
    let begun = Instant::now();
    let turn = Arc::clone(&job.turn).lock_owned().await;
    let room = Arc::clone(&site.room).acquire_owned().await;
    let work = tokio::task::spawn_blocking(move || {
        let line = |line| sender.blocking_send(line).is_ok();
        site.explorer.compute(&request, &job, begun, &line);
        (turn, room)
    });
    if let Err(defect) = work.await {
        tracing::error!("{DEFECT}: {defect}");
    }
}

/// The lines of an answer; the computation stops where the page does not wait for them any more.
struct Lines {
    receiver: mpsc::Receiver<Vec<u8>>,
    stop: Arc<AtomicBool>,
}

impl futures_core::Stream for Lines {
    type Item = Result<Vec<u8>, io::Error>;

    fn poll_next(
        mut self: std::pin::Pin<&mut Self>,
        context: &mut std::task::Context<'_>,
    ) -> std::task::Poll<Option<Self::Item>> {
        self.receiver.poll_recv(context).map(|line| line.map(Ok))
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}
