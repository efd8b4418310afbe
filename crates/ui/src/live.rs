//! The page of a sensor at work: the latest of a session, and nothing from it.

use axum::Router;
use axum::extract::State;
use axum::routing::get;

use crate::events::Latest;
use crate::pages::LIVE;
use crate::site::{SMALL_BODY, Site};

/// A site of a session, with its latest state.
#[must_use]
pub fn live(state: &Latest) -> Site {
    let told = get(async |State(state): State<Latest>| state.told());
    let routes = Router::new().route("/api/live/state", told).with_state(state.clone());
    let [page, assets @ ..] = &LIVE;
    Site { page: *page, assets, routes, most_body: SMALL_BODY }
}
