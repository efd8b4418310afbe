//! Why a stream cannot be decoded at all.

/// Why a stream cannot be decoded at all.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum WireFault {
    #[error("line {line} names the columns {names}: {why}")]
    Naming {
        /// The line of names; 0 where they were given beforehand.
        line: u64,
        names: String,
        why: String,
    },
    #[error(
        "line {line} names the columns {names}, and the rows before it are {before}: the device started again with \
         other columns, and its rows are not read from there on; make a recording of its own for them"
    )]
    OtherNames { line: u64, names: String, before: String },
    #[error(
        "line {line} names the columns {names}, and --names gives them in another order, {given}; leave --names out, \
         or give them in the order of the stream (--columns P1=P2,P2=P1 exchanges two)"
    )]
    OtherOrder { line: u64, names: String, given: String },
    #[error("line {line} has {cells} cells, and --names gives {names}; give as many names as cells")]
    OtherCells { line: u64, cells: usize, names: usize },
    #[error(
        "line {line} holds numbers (`{text}`) and no line of names came before it: begin with a line such as \
         time_us,n,led,P1,P2 (reset the device if it writes one when it starts), or give the names with --names"
    )]
    NoNames { line: u64, text: String },
    #[error(
        "what comes is no text (it begins with `{text}`): this looks like a wrong baud rate; write the device's own, \
         as in `?baud=115200`, or `form=frames` if it sends frames"
    )]
    Garbled { text: String },
    #[error(
        "{bytes} bytes came and no whole frame (such as {text}): this looks like a wrong baud rate; write the \
         device's own, as in `?baud=460800`, or `form=lines` if it sends lines"
    )]
    NoFrames {
        bytes: u64,
        /// Some of them, in hexadecimal.
        text: String,
    },
    #[error("ends before a line of names; begin with a line such as time_s,P1,P2")]
    Empty,
}
