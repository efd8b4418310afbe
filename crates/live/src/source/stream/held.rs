//! A row whose time or counter does not fit to the row before it, held back until the next row shows whether it was
//! damaged or the clock leapt.

use crate::source::decoder::Decoder;
use crate::wire::Sample;

/// Room for a row that is held back.
#[derive(Debug, Default)]
pub(super) struct Held {
    doubtful: Option<(Sample, u64)>,
    /// The row that showed that the one before it is right, behind which it waits.
    behind: Option<Sample>,
    values: Vec<f64>,
    texts: Vec<Vec<u8>>,
}

impl Held {
    /// Holds back the decoder's row, which came at `host_ns`.
    pub(super) fn keep(&mut self, sample: Sample, host_ns: u64, decoder: &Decoder) {
        let decoded = decoder.decoded();
        self.values.clone_from(&decoded.values);
        self.texts.clone_from(&decoded.texts);
        self.doubtful = Some((sample, host_ns));
    }

    /// The row that is held back, if there is one, and when it came. It is held no more.
    pub(super) fn doubtful(&mut self) -> Option<(Sample, u64)> {
        self.doubtful.take()
    }

    /// Puts the row that was held back in place of the decoder's, which waits behind it.
    pub(super) fn put_before(&mut self, sample: Sample, decoder: &mut Decoder) {
        self.exchange(decoder);
        self.behind = Some(sample);
    }

    /// Puts the row that waits, if there is one, back into the decoder.
    pub(super) fn behind(&mut self, decoder: &mut Decoder) -> Option<Sample> {
        let sample = self.behind.take()?;
        self.exchange(decoder);
        Some(sample)
    }

    fn exchange(&mut self, decoder: &mut Decoder) {
        let decoded = decoder.decoded_mut();
        std::mem::swap(&mut self.values, &mut decoded.values);
        std::mem::swap(&mut self.texts, &mut decoded.texts);
    }
}
