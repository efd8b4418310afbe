//! What a stage says about the logs that it reads: the same keys for every kind that reads logs, named as the commands'
//! options.

use super::options::request;
use crate::log::{LogReading, LogRequest};
use crate::pipeline::KeyFault;

/// The keys; every kind that reads logs names them among its own.
pub(super) const LOG_KEYS: [&str; 5] = ["columns", "time_unit", "full_scale", "piece", "stream"];

/// What was said.
#[derive(Debug, Clone, Default)]
pub(super) struct LogKeys {
    /// As jobs take it.
    pub(super) reading: LogReading,
    /// As it stands in the file, for whoever asks whether it has changed.
    said: toml::Table,
}

impl LogKeys {
    /// Takes the keys about logs out of a stage's.
    pub(super) fn take(keys: &mut toml::Table) -> Result<Self, KeyFault> {
        let own = LOG_KEYS.iter().filter_map(|key| keys.remove(*key).map(|value| ((*key).to_owned(), value)));
        let said: toml::Table = own.collect();
        let request = request::<LogRequest>(&said)?;
        Ok(Self { reading: request.reading(), said })
    }

    /// Adds what was said to what a stage's results hang on; nothing where nothing was.
    pub(super) fn tell(&self, mut told: serde_json::Value) -> serde_json::Value {
        if let (false, Some(told)) = (self.said.is_empty(), told.as_object_mut()) {
            told.insert("log".to_owned(), serde_json::to_value(&self.said).expect("plain data with names as keys"));
        }
        told
    }
}
