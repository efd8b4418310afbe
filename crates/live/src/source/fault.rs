//! Why there is no stream.

use std::path::PathBuf;

use crate::wire::WireFault;

/// Why there is no stream, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum SourceFault {
    /// The address is none.
    #[error("`{text}` is no source: {what}")]
    Address {
        /// As it was written.
        text: String,
        /// What is wrong.
        what: String,
    },
    /// A port or a file cannot be opened.
    #[error("{source_name}: {what}")]
    Open {
        /// The source.
        source_name: String,
        /// What is wrong, and what to do.
        what: String,
    },
    /// What comes cannot be decoded.
    #[error("{source_name}: {fault}")]
    Wire {
        /// The source.
        source_name: String,
        /// What is wrong.
        fault: WireFault,
    },
    /// A file cannot be read any more.
    #[error("{path}: cannot be read ({why})", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        why: std::io::Error,
    },
}
