//! A session of the sensor while it goes: the latest picture of it, as JSON, to whoever looks.
//!
//! A picture: `fingers` (each with `name`, `photodiodes` and their `places` on the nail, `low` and `high` of each over
//! the last seconds, the last answers' names `answers` and `values`, `contact`, `pressed`, `state`), `bin_s` and
//! `pixels` of a trace, `health` (rows, losses, latency), `ended`. What is not known is null.

use axum::Router;
use axum::routing::get;

use crate::events::Latest;
use crate::pages::LIVE;
use crate::site::{SMALL_BODY, Site};

/// A site that shows the latest pictures of a session.
#[must_use]
pub fn live(pictures: &Latest) -> Site {
    let pictures = pictures.clone();
    let routes = Router::new().route("/api/live", get(async move || pictures.told()));
    let [page, assets @ ..] = &LIVE;
    Site { name: "live", title: "Sensor", page: *page, assets, routes, most_body: SMALL_BODY }
}
