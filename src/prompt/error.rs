//! Why a prompted session has no result.

use thiserror::Error;

use super::protocol::ProtocolError;
use crate::files::WriteError;
use crate::live::LiveError;

/// Why there is none.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum PromptError {
    #[error("{0}")]
    Request(String),
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    #[error(transparent)]
    Session(#[from] LiveError),
    #[error(transparent)]
    Results(#[from] WriteError),
}
