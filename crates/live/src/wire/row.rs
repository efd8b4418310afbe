//! What a row of a stream is, and what its columns mean.

/// What a column is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Use {
    /// The device's time; so many of its units make a second.
    Time {
        /// Units in a second.
        per_second: f64,
    },
    /// A counter that grows by one with each row.
    Counter,
    /// Whether the LED was on.
    Led,
    /// A number that is read, and its place among [`Row::values`].
    Value(usize),
    /// The same, of a photodiode: volts, or counts where the device sends them.
    Counts(usize),
    /// Text that is kept as it is, and its place among [`Row::texts`].
    Text(usize),
    /// Passed over unread.
    None,
}

/// What the columns of a stream mean: made once, from their names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Meaning {
    /// Of each column, in order.
    pub uses: Vec<Use>,
    /// How many values a row has.
    pub values: usize,
    /// How many texts.
    pub texts: usize,
}

/// A row of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row<'a> {
    /// When its last byte came, nanoseconds of the host's monotonic clock since the session began.
    pub host_ns: u64,
    /// The device's time, unwrapped, seconds; that of arrival where the device has none. NaN where the row lacks it.
    pub time_s: f64,
    /// Whether the LED was on; none where the row does not say.
    pub lit: Option<bool>,
    /// Rows that were lost just before it, by the counter.
    pub lost: u64,
    /// Whether a recording begins with it: the first row, or the first after the source was lost or its clock set back.
    pub begins: bool,
    /// The numbers that are read, NaN where missing.
    pub values: &'a [f64],
    /// The texts that are kept, without space and quotes around them.
    pub texts: &'a [Vec<u8>],
}
