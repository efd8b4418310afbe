//! The pages of lunula: a small server for one person's browser on the same machine.
//!
//! In: folders of results. Out: one address, `http://127.0.0.1:PORT/#TOKEN`, with every page behind it. Nothing is
//! fetched from elsewhere, nothing is sent away.
//!
//! Any web page that the person has open can send requests to this machine, so a request has to show that it is this
//! server's own page: `guard` checks `Host` (a name that was bound to this address elsewhere), `Origin` and
//! `Sec-Fetch-Site` (another page), and the token (another user of the machine). The token is in the address'
//! fragment, which is in no log and in no `Referer`; the page exchanges it for a cookie that scripts can't read.
//! Reports of results, which are HTML, are shown in a sandbox without scripts. What is read lies below the folders that
//! were named, and is asked for by number, never by path.

mod connection;
mod edit;
mod events;
mod guard;
mod live;
mod pages;
mod prompt;
mod results;
mod server;
mod site;
mod token;

pub use edit::{Editing, Heard, edit};
pub use events::Latest;
pub use live::live;
pub use prompt::{Prompting, prompt};
pub use results::results;
pub use server::{Server, Settings, UiError};
pub use site::Site;
