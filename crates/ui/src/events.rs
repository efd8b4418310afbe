//! What pages are told without asking: the latest of something, as it changes.
//!
//! Whoever has news never waits for a page: it leaves the latest, and a page that is slow gets fewer of them. A page
//! reads them as an `EventSource`, which asks again by itself where the connection ends.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use tokio::sync::watch;

/// The content's type.
pub(crate) const EVENTS: &str = "text/event-stream";
/// A page that hears nothing for so long may think that the server is gone.
const ALIVE: Duration = Duration::from_secs(1);

/// The latest of something, as JSON; any thread leaves it, and every page that listens gets it.
#[derive(Debug, Clone)]
pub struct Latest(watch::Sender<Arc<str>>);

impl Latest {
    /// With what there is at first.
    #[must_use]
    pub fn new(json: &str) -> Self {
        Self(watch::Sender::new(json.into()))
    }

    /// Leaves the latest; never waits.
    pub fn leave(&self, json: &str) {
        self.0.send_replace(json.into());
    }

    /// What a page gets: the latest now, and each that it is in time for.
    pub(crate) fn told(&self) -> Response {
        let mut news = self.0.subscribe();
        news.mark_changed();
        let stream = futures_util::stream::unfold(news, async |mut news| {
            news.changed().await.ok()?;
            let latest = Arc::clone(&news.borrow_and_update());
            Some((Ok::<_, Infallible>(Event::default().data(&*latest)), news))
        });
        Sse::new(stream).keep_alive(KeepAlive::new().interval(ALIVE)).into_response()
    }
}

#[cfg(test)]
mod tests {
    use http_body_util::BodyExt;

    use super::*;

    #[tokio::test]
    async fn a_page_gets_the_latest_and_a_slow_one_fewer() {
        let latest = Latest::new("0");
        let mut body = latest.told().into_body();
        let mut next = async || {
            let frame = body.frame().await.unwrap().unwrap().into_data().unwrap();
            String::from_utf8(frame.to_vec()).unwrap()
        };
        assert_eq!(next().await, "data: 0\n\n");
        for n in 1..1000 {
            latest.leave(&n.to_string());
        }
        assert_eq!(next().await, "data: 999\n\n");
    }
}
