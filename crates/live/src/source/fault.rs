//! Why there is no stream.

use std::path::PathBuf;

use crate::wire::WireFault;

/// Why there is no stream, and what to do.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SourceFault {
    #[error("`{text}` is no source: {what}")]
    Address { text: String, what: String },
    #[error("{source_name}: {what}")]
    Open { source_name: String, what: String },
    #[error("{source_name}: {fault}")]
    Wire { source_name: String, fault: WireFault },
    #[error("{path}: cannot be read ({why})", path = path.display())]
    Read { path: PathBuf, why: std::io::Error },
}
