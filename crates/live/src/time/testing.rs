//! Samples taken in tests as a stream takes them.

use super::{Sequence, Verdict};
use crate::wire::Sample;

/// Holds back the sample that is doubtful, as a stream does.
#[derive(Default)]
pub(crate) struct Taker {
    held: Option<(Sample, u64)>,
}

impl Taker {
    /// Takes a sample, which the one that was held back may come before; what became of both, but for what is held now.
    pub(crate) fn take(&mut self, rows: &mut Sequence, next: Sample, host_ns: u64) -> Vec<(Sample, Verdict)> {
        let first = self.held.take().filter(|_| rows.settle(&next));
        let mut given = Vec::new();
        for (sample, host_ns) in first.into_iter().chain([(next, host_ns)]) {
            match rows.take(&sample, host_ns) {
                Verdict::Doubtful => self.held = Some((sample, host_ns)),
                verdict => given.push((sample, verdict)),
            }
        }
        given
    }
}
