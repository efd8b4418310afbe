//! The server: what it listens at, and what it answers.

use std::io::Write;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::StatusCode;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_LENGTH, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, HeaderValue, REFERRER_POLICY,
    SET_COOKIE, X_CONTENT_TYPE_OPTIONS,
};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get, post};
use axum::{Json, Router};
use serde_json::{Value, json};
use tempfile::NamedTempFile;
use thiserror::Error;

use crate::connection::accept;
use crate::guard::{Guard, PAGES, SESSION};
use crate::pages::{Asset, COMMON};
use crate::site::Site;

/// How often it looks whether it is to stop.
const TICK: Duration = Duration::from_millis(100);

/// What pages may do: what this server gives, and nothing else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src \
                      'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const OPENER: HeaderName = HeaderName::from_static("cross-origin-opener-policy");
const RESOURCE: HeaderName = HeaderName::from_static("cross-origin-resource-policy");

/// Where a server listens.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The address; another one than loopback is reached by others, and nothing is encrypted.
    pub address: IpAddr,
    /// The port; 0 for a free one.
    pub port: u16,
    /// What the machine is called beside its loopback names, where others reach it.
    pub names: Vec<String>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { address: Ipv4Addr::LOCALHOST.into(), port: 0, names: Vec::new() }
    }
}

/// Why nothing is served.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum UiError {
    #[error("{}: is no folder that can be read ({why}); name a folder of results", path.display())]
    Folder { path: std::path::PathBuf, why: std::io::Error },
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
    guard: Arc<Guard>,
    sites: Vec<Site>,
}

impl Server {
    /// Listens, with what `sites` have to show: the first is the page at `/`, each is at `/NAME`.
    ///
    /// # Errors
    /// [`UiError`]: a port that is taken.
    pub fn bind(settings: &Settings, sites: Vec<Site>) -> Result<Self, UiError> {
        let at = SocketAddr::new(settings.address, settings.port);
        let listen = || {
            let listener = TcpListener::bind(at)?;
            listener.set_nonblocking(true)?;
            let at = listener.local_addr()?;
            Ok((listener, at))
        };
        let (listener, at) = listen().map_err(|why| UiError::Listen(at, why))?;
        let guard = Guard::new(at.port(), &settings.names).map_err(UiError::Random)?;
        Ok(Self { listener, at, guard: Arc::new(guard), sites })
    }

    /// The address of the page, with the token: whoever has it sees the results.
    #[must_use]
    pub fn url(&self) -> String {
        let host = if self.at.ip().is_unspecified() { IpAddr::V4(Ipv4Addr::LOCALHOST) } else { self.at.ip() };
        format!("http://{}/#{}", SocketAddr::new(host, self.at.port()), self.guard.token.reveal())
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
        let Self { listener, guard, sites, .. } = self;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(UiError::Serve)?;
        runtime.block_on(async move {
            let listener = tokio::net::TcpListener::from_std(listener).map_err(UiError::Serve)?;
            let serving = tokio::spawn(accept(listener, pages(guard, sites)));
            while !stop.load(Ordering::Relaxed) && !serving.is_finished() {
                tokio::time::sleep(TICK).await;
            }
            serving.abort();
            Ok(())
        })
    }
}

/// All that is answered.
fn pages(guard: Arc<Guard>, sites: Vec<Site>) -> Router {
    let most_body = sites.iter().map(|site| site.most_body).max().unwrap_or_default();
    let links: Vec<Value> = sites.iter().map(|site| json!({ "name": site.name, "title": site.title })).collect();
    let mut pages = Router::new()
        .route(SESSION, post(enter))
        .with_state(Arc::clone(&guard))
        .route(PAGES, get(async move || Json(links)));
    if let Some(first) = sites.first() {
        pages = pages.route("/", given(first.page));
    }
    for asset in &COMMON {
        pages = pages.route(asset.path, given(*asset));
    }
    for Site { name, page, assets, routes, .. } in sites {
        pages = pages.merge(routes).route(&format!("/{name}"), given(page));
        for asset in assets {
            pages = pages.route(asset.path, given(*asset));
        }
    }
    pages.layer(DefaultBodyLimit::max(most_body)).layer(from_fn_with_state((guard, most_body), guarded))
}

/// A file of the pages, as it is.
fn given(asset: Asset) -> MethodRouter {
    get(move || async move { ([(CONTENT_TYPE, asset.kind)], asset.bytes) })
}

/// Nothing of a request is used before it was let in; whoever was not hears nothing more.
async fn guarded(State((guard, most_body)): State<(Arc<Guard>, usize)>, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let length = parts.headers.get(CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse().ok());
    let mut response = if !guard.lets_in(&parts) {
        StatusCode::FORBIDDEN.into_response()
    } else if length.unwrap_or(0) > most_body {
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
async fn enter(State(guard): State<Arc<Guard>>, token: String) -> Response {
    if !guard.token.is(&token) {
        return StatusCode::FORBIDDEN.into_response();
    }
    (StatusCode::NO_CONTENT, [(SET_COOKIE, guard.set_cookie())]).into_response()
}
