//! Why there is no fit.

use crate::optics::OpticsFault;
use crate::parameters::Symbol;

/// Why there is no fit.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
pub enum FitFault {
    /// No recording.
    #[error("there is no recording to fit to")]
    NoRecordings,
    /// A recording that can't be used.
    #[error("recording {recording} can't be used: {what}")]
    Recording {
        /// Its number, from 1.
        recording: usize,
        /// What is wrong with it.
        what: String,
    },
    /// Nothing to fit.
    #[error("nothing is free: give parameters to fit, or let offsets and scalings be calibrated")]
    NothingFree,
    /// A group of no parameters.
    #[error("a group of free parameters is empty")]
    EmptyGroup,
    /// A parameter that the model has not got.
    #[error("{symbol} can't be free: the model has no such unit")]
    NoSuchParameter {
        /// Which.
        symbol: Symbol,
    },
    /// A parameter that is free twice.
    #[error("{symbol} is free twice; a parameter belongs to one group")]
    Twice {
        /// Which.
        symbol: Symbol,
    },
    /// A parameter that moves by addition, tied to others.
    #[error("{symbol} can't be tied to others by a factor: it may be negative or 0, so it has to be free alone")]
    Tied {
        /// Which.
        symbol: Symbol,
    },
    /// A parameter that moves by a factor and is 0.
    #[error("{symbol} is 0 at the start, and is fitted by a factor; start from a value greater than 0")]
    Zero {
        /// Which.
        symbol: Symbol,
    },
    /// An offset or scaling that is calibrated already.
    #[error("{symbol} is calibrated already; free it only with fixed calibration")]
    Calibrated {
        /// Which.
        symbol: Symbol,
    },
    /// Bounds that are none.
    #[error(
        "the bounds {lower} to {upper} of {symbol} can't be used: the upper one has to be greater, and both positive \
         for what moves by a factor"
    )]
    Bounds {
        /// Of which parameter.
        symbol: Symbol,
        /// The lower one.
        lower: f64,
        /// The upper one.
        upper: f64,
    },
    /// A start outside of its bounds.
    #[error("{symbol} starts at {value}, outside of its bounds")]
    Outside {
        /// Which parameter.
        symbol: Symbol,
        /// Its value.
        value: f64,
    },
    /// Fewer values than unknowns, or as many.
    #[error(
        "{values} voltages can't determine {unknowns} unknowns with their errors; more samples or fewer free \
         parameters are needed"
    )]
    TooFew {
        /// Voltages that are not missing.
        values: usize,
        /// Free groups, offsets and scalings.
        unknowns: usize,
    },
    /// Another option that can't be used.
    #[error("{what} is {value}; it has to be {wanted}")]
    Option {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it has to be.
        wanted: &'static str,
    },
    /// The optics' working point.
    #[error(transparent)]
    Optics(#[from] OpticsFault),
    /// The model has no response at the parameters to start from.
    #[error("the fit can't start from these parameters: in recording {recording}, {why}")]
    Start {
        /// Its number, from 1.
        recording: usize,
        /// Why: a vessel closes, or the solver's own words.
        why: String,
    },
}
