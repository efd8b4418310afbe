//! What a server has to show: one page, its files, and what they ask for.

use axum::Router;

use crate::pages::Asset;

/// Bytes of a request's body where a page sends no more than the token.
pub(crate) const SMALL_BODY: usize = 1 << 10;

/// A page, its files, and what it asks the server for, below `/api/`.
pub struct Site {
    pub(crate) page: Asset,
    pub(crate) assets: &'static [Asset],
    pub(crate) routes: Router,
    pub(crate) most_body: usize,
}
