//! What a server has to show: pages, each with its files and what they ask for.

use axum::Router;

use crate::pages::Asset;

/// Bytes of a request's body where a page sends no more than the token.
pub(crate) const SMALL_BODY: usize = 1 << 10;

/// A page, its files, and what it asks the server for, below `/api/NAME`; no two pages share a name or a file's.
pub struct Site {
    /// Where the page is: `/NAME`.
    pub(crate) name: &'static str,
    /// What a link to it says.
    pub(crate) title: &'static str,
    pub(crate) page: Asset,
    pub(crate) assets: &'static [Asset],
    pub(crate) routes: Router,
    pub(crate) most_body: usize,
}
