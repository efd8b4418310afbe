//! Connections: a few at a time, and none that only waits keeps others out.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::http::header::CONTENT_TYPE;
use axum::http::{Request, StatusCode};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::AbortHandle;
use tower::ServiceExt;

use crate::events::EVENTS;

/// Connections at once; a browser opens six.
const MOST: usize = 16;
/// A connection that asks nothing for so long is closed.
const IDLE: Duration = Duration::from_secs(10);
/// One that lives so long is as well: a reader that does not read. One that is told events may live on, and gives its
/// place up to the next page.
const LIFE: Duration = Duration::from_secs(120);
/// Between connections that are accepted: whoever comes back again and again takes little of the machine.
const BETWEEN: Duration = Duration::from_millis(2);
/// Bytes of a request's head.
const HEAD: usize = 16 << 10;

/// Connections that are open, the oldest first.
#[derive(Default)]
struct Open(VecDeque<Connection>);

struct Connection {
    seen: Arc<Seen>,
    task: AbortHandle,
}

/// What a connection has shown of itself.
#[derive(Default)]
struct Seen {
    /// Whether a request of it was let in.
    known: AtomicBool,
    /// Whether it is told events.
    listens: AtomicBool,
}

impl Open {
    /// Whether there is room for one more: where all places are taken, the oldest that nobody knows gives up its own,
    /// or else the oldest that only listens.
    fn has_room(&mut self) -> bool {
        self.0.retain(|connection| !connection.task.is_finished());
        if self.0.len() < MOST {
            return true;
        }
        let stranger = self.0.iter().position(|connection| !connection.seen.known.load(Ordering::Relaxed));
        let listener = || self.0.iter().position(|connection| connection.seen.listens.load(Ordering::Relaxed));
        let Some(ends) = stranger.or_else(listener).and_then(|at| self.0.remove(at)) else { return false };
        ends.task.abort();
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
            tokio::time::sleep(BETWEEN).await;
            continue;
        }
        let seen = Arc::new(Seen::default());
        let answering = answer_for_long(stream, pages.clone(), Arc::clone(&seen));
        open.0.push_back(Connection { seen, task: tokio::spawn(answering).abort_handle() });
        tokio::time::sleep(BETWEEN).await;
    }
}

/// Whoever goes away or takes too long gets no answer.
async fn answer_for_long(stream: TcpStream, pages: Router, seen: Arc<Seen>) {
    let mut answering = std::pin::pin!(answer(stream, pages, Arc::clone(&seen)));
    while tokio::time::timeout(LIFE, &mut answering).await.is_err() && seen.listens.load(Ordering::Relaxed) {}
}

async fn answer(stream: TcpStream, pages: Router, seen: Arc<Seen>) -> hyper::Result<()> {
    let service = hyper::service::service_fn(move |request: Request<Incoming>| {
        let (pages, seen) = (pages.clone(), Arc::clone(&seen));
        async move {
            let answer = pages.oneshot(request.map(Body::new)).await;
            if let Ok(answer) = &answer {
                seen.known.fetch_or(answer.status() != StatusCode::FORBIDDEN, Ordering::Relaxed);
                let listens = answer.headers().get(CONTENT_TYPE).is_some_and(|kind| kind == EVENTS);
                seen.listens.fetch_or(listens, Ordering::Relaxed);
            }
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
