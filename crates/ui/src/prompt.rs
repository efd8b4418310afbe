//! The prompter's page: the state and each force to it, keys and frames from it.
//!
//! The page's clock is the server's: it asks what time it is there, takes half of the fastest round trip for the
//! uncertainty, and says with each frame what it drew and when that was seen.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde_json::json;

use crate::events::Latest;
use crate::pages::PROMPT;
use crate::site::Site;

/// Bytes of a message: some seconds of frames.
const MOST_BODY: usize = 256 << 10;

/// Whoever prompts; no call may wait.
pub trait Prompting: Send + Sync + 'static {
    /// The server's clock, seconds.
    fn now_s(&self) -> f64;

    /// A key: `{"key":"go","time_s":12.3}`; whether it is one.
    fn key(&self, json: &[u8]) -> bool;

    /// Frames that were shown: `{"frames":[..]}`; whether they are some.
    fn frames(&self, json: &[u8]) -> bool;
}

#[derive(Clone)]
struct Desk {
    prompting: Arc<dyn Prompting>,
    state: Latest,
    force: Latest,
}

/// A site of a prompter, with its latest state and force.
pub fn prompt(prompting: Arc<dyn Prompting>, state: &Latest, force: &Latest) -> Site {
    let desk = Desk { prompting, state: state.clone(), force: force.clone() };
    let routes = Router::new()
        .route("/api/prompt/state", get(async |State(desk): State<Desk>| desk.state.told()))
        .route("/api/prompt/force", get(async |State(desk): State<Desk>| desk.force.told()))
        .route("/api/prompt/clock", post(clock))
        .route("/api/prompt/key", post(async |State(desk): State<Desk>, body: Bytes| is(desk.prompting.key(&body))))
        .route(
            "/api/prompt/frames",
            post(async |State(desk): State<Desk>, body: Bytes| is(desk.prompting.frames(&body))),
        )
        .with_state(desk);
    let [page, assets @ ..] = &PROMPT;
    Site { name: "prompt", title: "Prompter", page: *page, assets, routes, most_body: MOST_BODY }
}

async fn clock(State(desk): State<Desk>) -> Response {
    Json(json!({ "time_s": desk.prompting.now_s() })).into_response()
}

fn is(good: bool) -> StatusCode {
    if good { StatusCode::NO_CONTENT } else { StatusCode::BAD_REQUEST }
}
