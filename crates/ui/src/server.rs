//! The server: what it listens at, and what it answers.

use std::io::Write;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::extract::{DefaultBodyLimit, Path, Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_LENGTH, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, HeaderValue, REFERRER_POLICY,
    SET_COOKIE, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use tempfile::NamedTempFile;
use thiserror::Error;

use crate::connection::accept;
use crate::guard::{Guard, SESSION};
use crate::pages::ASSETS;
use crate::results::Folders;

/// Bytes of a request's body: a token.
const MOST_BODY: usize = 1 << 10;
/// How often it looks whether it is to stop.
const TICK: Duration = Duration::from_millis(100);

/// What pages may do: what this server gives, and nothing else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src \
                      'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// What a report may do: be looked at. It may hold names and texts of anybody's files.
const SANDBOX: &str = "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:; font-src data:; base-uri \
                       'none'; form-action 'none'; frame-ancestors 'self'";
const OPENER: HeaderName = HeaderName::from_static("cross-origin-opener-policy");
const RESOURCE: HeaderName = HeaderName::from_static("cross-origin-resource-policy");

/// What a server shows, and where.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Folders of results.
    pub folders: Vec<PathBuf>,
    /// The address; another one than loopback is reached by others, and nothing is encrypted.
    pub address: IpAddr,
    /// The port; 0 for a free one.
    pub port: u16,
    /// What the machine is called beside its loopback names, where others reach it.
    pub names: Vec<String>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { folders: Vec::new(), address: Ipv4Addr::LOCALHOST.into(), port: 0, names: Vec::new() }
    }
}

/// Why nothing is served.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum UiError {
    #[error("{}: {why}; name a folder of results", path.display())]
    Folder { path: PathBuf, why: std::io::Error },
    #[error("{0}: can't listen there ({1}); choose another --port")]
    Listen(SocketAddr, std::io::Error),
    #[error("the system gives no random numbers ({0})")]
    Random(getrandom::Error),
    #[error("the server can't go on ({0})")]
    Serve(std::io::Error),
}

/// A server that listens.
pub struct Server {
    listener: TcpListener,
    at: SocketAddr,
    shared: Arc<Shared>,
}

struct Shared {
    guard: Guard,
    folders: Mutex<Folders>,
}

impl Server {
    /// Listens.
    ///
    /// # Errors
    /// [`UiError`]: a folder that can't be read, a port that is taken.
    pub fn bind(settings: Settings) -> Result<Self, UiError> {
        let mut roots = Vec::new();
        for path in settings.folders {
            let root = path.canonicalize().and_then(|root| std::fs::read_dir(&root).map(|_| root));
            roots.push(root.map_err(|why| UiError::Folder { path, why })?);
        }
        let at = SocketAddr::new(settings.address, settings.port);
        let listen = || {
            let listener = TcpListener::bind(at)?;
            listener.set_nonblocking(true)?;
            let at = listener.local_addr()?;
            Ok((listener, at))
        };
        let (listener, at) = listen().map_err(|why| UiError::Listen(at, why))?;
        let guard = Guard::new(at.port(), &settings.names).map_err(UiError::Random)?;
        Ok(Self { listener, at, shared: Arc::new(Shared { guard, folders: Mutex::new(Folders::new(roots)) }) })
    }

    /// The address of the page, with the token: whoever has it sees the results.
    #[must_use]
    pub fn url(&self) -> String {
        let host = if self.at.ip().is_unspecified() { IpAddr::V4(Ipv4Addr::LOCALHOST) } else { self.at.ip() };
        format!("http://{}/#{}", SocketAddr::new(host, self.at.port()), self.shared.guard.token.reveal())
    }

    /// A page for the browser to open, which only this person can read: on a command line others would see the token.
    /// It is gone when it is dropped.
    ///
    /// # Errors
    /// The file can't be made.
    pub fn page_to_open(&self) -> std::io::Result<NamedTempFile> {
        let mut page = tempfile::Builder::new().prefix("lunula-").suffix(".html").tempfile()?;
        let url = self.url();
        write!(page, "<!DOCTYPE html><title>lunula</title><meta http-equiv=\"refresh\" content=\"0;url={url}\">")?;
        page.flush()?;
        Ok(page)
    }

    /// Serves until `stop`, on this thread.
    ///
    /// # Errors
    /// The system refuses to.
    pub fn run(self, stop: &AtomicBool) -> Result<(), UiError> {
        let Self { listener, shared, .. } = self;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(UiError::Serve)?;
        runtime.block_on(async move {
            let listener = tokio::net::TcpListener::from_std(listener).map_err(UiError::Serve)?;
            let serving = tokio::spawn(accept(listener, pages(shared)));
            while !stop.load(Ordering::Relaxed) && !serving.is_finished() {
                tokio::time::sleep(TICK).await;
            }
            serving.abort();
            Ok(())
        })
    }
}

/// All that is answered.
fn pages(shared: Arc<Shared>) -> Router {
    let mut pages = Router::new()
        .route(SESSION, post(enter))
        .route("/api/results", get(results))
        .route("/api/file/{number}", get(file));
    for asset in &ASSETS {
        pages = pages.route(asset.path, get(|| async { ([(CONTENT_TYPE, asset.kind)], asset.bytes) }));
    }
    pages
        .layer(DefaultBodyLimit::max(MOST_BODY))
        .layer(from_fn_with_state(Arc::clone(&shared), guarded))
        .with_state(shared)
}

/// Nothing of a request is used before it was let in; whoever was not hears nothing more.
async fn guarded(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let length = parts.headers.get(CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse().ok());
    let mut response = if !shared.guard.lets_in(&parts) {
        StatusCode::FORBIDDEN.into_response()
    } else if length.unwrap_or(0) > MOST_BODY {
        // What is announced is not waited for.
        StatusCode::PAYLOAD_TOO_LARGE.into_response()
    } else {
        next.run(Request::from_parts(parts, body)).await
    };
    let headers = response.headers_mut();
    headers.entry(CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(POLICY));
    for (name, value) in [
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (REFERRER_POLICY, "no-referrer"),
        (OPENER, "same-origin"),
        (RESOURCE, "same-origin"),
        (CACHE_CONTROL, "no-store"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

/// The token for a cookie.
async fn enter(State(shared): State<Arc<Shared>>, token: String) -> Response {
    if !shared.guard.token.is(&token) {
        return StatusCode::FORBIDDEN.into_response();
    }
    (StatusCode::NO_CONTENT, [(SET_COOKIE, shared.guard.set_cookie())]).into_response()
}

async fn results(State(shared): State<Arc<Shared>>) -> Response {
    let looked = tokio::task::spawn_blocking(move || {
        let mut folders = shared.folders.lock().unwrap_or_else(PoisonError::into_inner);
        folders.look()
    });
    looked.await.map_or_else(|_| StatusCode::INTERNAL_SERVER_ERROR.into_response(), |found| Json(found).into_response())
}

async fn file(State(shared): State<Arc<Shared>>, Path(number): Path<usize>) -> Response {
    let read = tokio::task::spawn_blocking(move || {
        let folders = shared.folders.lock().unwrap_or_else(PoisonError::into_inner);
        folders.read(number)
    });
    let Ok(Some(file)) = read.await else { return StatusCode::NOT_FOUND.into_response() };
    let mut headers = HeaderMap::new();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(file.kind));
    // Of whoever made it, not ours.
    headers.insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(SANDBOX));
    (headers, file.bytes).into_response()
}
