//! The page of outlines: the state to it, keys from it, pictures of the nail that is shown.

use std::sync::Arc;

use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use tokio::task::spawn_blocking;

use crate::events::Latest;
use crate::pages::EDIT;
use crate::site::{SMALL_BODY, Site};

/// What became of a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heard {
    /// It did something, or the state says why not.
    Done,
    /// Another nail is shown by now; it did nothing.
    Late,
    /// It is no key.
    Unknown,
}

/// Whoever holds the outlines. Calls may take as long as a photograph takes to be read: no page waits for another's.
pub trait Editing: Send + Sync + 'static {
    /// A key: `{"key":"accept","nail":3}`.
    fn key(&self, json: &[u8]) -> Heard;

    /// The part of the photograph that is shown, as a JPEG.
    fn photo(&self) -> Option<Vec<u8>>;

    /// The nail as it would come out, as a PNG; `rough`, in little time, or as it would.
    fn normalized(&self, rough: bool) -> Result<Vec<u8>, String>;
}

#[derive(Clone)]
struct Desk {
    editing: Arc<dyn Editing>,
    state: Latest,
}

/// A site of outlines, with its latest state.
pub fn edit(editing: Arc<dyn Editing>, state: &Latest) -> Site {
    let desk = Desk { editing, state: state.clone() };
    let routes = Router::new()
        .route("/api/edit/state", get(async |State(desk): State<Desk>| desk.state.told()))
        .route("/api/edit/key", post(key))
        .route("/api/edit/photo", get(photo))
        .route("/api/edit/normalized", get(async |State(desk): State<Desk>| normalized(desk, false).await))
        .route("/api/edit/rough", get(async |State(desk): State<Desk>| normalized(desk, true).await))
        .with_state(desk);
    let [page, assets @ ..] = &EDIT;
    Site { name: "edit", title: "Outlines", page: *page, assets, routes, most_body: SMALL_BODY }
}

async fn key(State(desk): State<Desk>, body: Bytes) -> StatusCode {
    match spawn_blocking(move || desk.editing.key(&body)).await {
        Ok(Heard::Done) => StatusCode::NO_CONTENT,
        Ok(Heard::Late) => StatusCode::CONFLICT,
        Ok(Heard::Unknown) => StatusCode::BAD_REQUEST,
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

async fn photo(State(desk): State<Desk>) -> Response {
    match spawn_blocking(move || desk.editing.photo()).await {
        Ok(Some(jpeg)) => ([(CONTENT_TYPE, "image/jpeg")], jpeg).into_response(),
        Ok(None) => StatusCode::NOT_FOUND.into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

async fn normalized(desk: Desk, rough: bool) -> Response {
    match spawn_blocking(move || desk.editing.normalized(rough)).await {
        Ok(Ok(png)) => ([(CONTENT_TYPE, "image/png")], png).into_response(),
        Ok(Err(why)) => (StatusCode::UNPROCESSABLE_ENTITY, why).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}
