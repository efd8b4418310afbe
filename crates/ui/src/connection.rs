//! Connections: a few at a time, and none that only waits keeps others out.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::http::{Request, StatusCode};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::AbortHandle;
use tower::ServiceExt;

/// Connections at once; a browser opens six.
const MOST: usize = 16;
/// A connection that asks nothing for so long is closed.
const IDLE: Duration = Duration::from_secs(10);
/// One that lives so long is as well: a reader that does not read.
const LIFE: Duration = Duration::from_secs(120);
/// Bytes of a request's head.
const HEAD: usize = 16 << 10;

/// Connections that are open, the oldest first.
#[derive(Default)]
struct Open(VecDeque<Connection>);

struct Connection {
    /// Whether a request of it was let in.
    known: Arc<AtomicBool>,
    task: AbortHandle,
}

impl Open {
    /// Whether there is room for one more: where all places are taken, the oldest that nobody knows gives up its own.
    fn has_room(&mut self) -> bool {
        self.0.retain(|connection| !connection.task.is_finished());
        if self.0.len() < MOST {
            return true;
        }
        let stranger = self.0.iter().position(|connection| !connection.known.load(Ordering::Relaxed));
        let Some(stranger) = stranger.and_then(|at| self.0.remove(at)) else { return false };
        stranger.task.abort();
        true
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        for connection in &self.0 {
            connection.task.abort();
        }
    }
}

/// Answers connections until it is dropped. One too many is closed at once.
pub(crate) async fn accept(listener: TcpListener, pages: Router) -> Infallible {
    let mut open = Open::default();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // No descriptors are left: others have to end first.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        if !open.has_room() {
            continue;
        }
        let known = Arc::new(AtomicBool::new(false));
        // Whoever goes away or takes too long gets no answer.
        let answering = tokio::time::timeout(LIFE, answer(stream, pages.clone(), Arc::clone(&known)));
        open.0.push_back(Connection { known, task: tokio::spawn(answering).abort_handle() });
    }
}

async fn answer(stream: TcpStream, pages: Router, known: Arc<AtomicBool>) -> hyper::Result<()> {
    let service = hyper::service::service_fn(move |request: Request<Incoming>| {
        let (pages, known) = (pages.clone(), Arc::clone(&known));
        async move {
            let answer = pages.oneshot(request.map(Body::new)).await;
            let let_in = answer.as_ref().is_ok_and(|answer| answer.status() != StatusCode::FORBIDDEN);
            known.fetch_or(let_in, Ordering::Relaxed);
            answer
        }
    });
    http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(IDLE)
        .max_buf_size(HEAD)
        .serve_connection(TokioIo::new(stream), service)
        .await
}
