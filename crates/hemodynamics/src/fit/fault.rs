//! Why there is no fit.

use crate::optics::OpticsFault;
use crate::parameters::Symbol;

/// Why there is no fit.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum FitFault {
    #[error("there is no recording to fit to")]
    NoRecordings,
    #[error("recording {recording} can't be used: {what}")]
    Recording {
        /// Its number, from 1.
        recording: usize,
        what: String,
    },
    #[error("nothing is free: give parameters to fit, or let offsets and scalings be calibrated")]
    NothingFree,
    #[error("a group of free parameters is empty")]
    EmptyGroup,
    #[error("{symbol} can't be free: the model has no such unit")]
    NoSuchParameter { symbol: Symbol },
    #[error("{symbol} is free twice; a parameter belongs to one group")]
    Twice { symbol: Symbol },
    #[error("{symbol} can't be tied to others by a factor: it may be negative or 0, so it has to be free alone")]
    Tied { symbol: Symbol },
    #[error("{symbol} is 0 at the start, and is fitted by a factor; start from a value greater than 0")]
    Zero { symbol: Symbol },
    #[error("{symbol} is calibrated already; free it only with fixed calibration")]
    Calibrated { symbol: Symbol },
    #[error(
        "the bounds {lower} to {upper} of {symbol} can't be used: the upper one has to be greater, and both positive \
         for what moves by a factor"
    )]
    Bounds { symbol: Symbol, lower: f64, upper: f64 },
    #[error("{symbol} starts at {value}, outside of its bounds")]
    Outside { symbol: Symbol, value: f64 },
    #[error(
        "{values} voltages can't determine {unknowns} unknowns with their errors; more samples or fewer free \
         parameters are needed"
    )]
    TooFew { values: usize, unknowns: usize },
    #[error("{what} is {value}; it has to be {wanted}")]
    Option { what: &'static str, value: f64, wanted: &'static str },
    #[error(transparent)]
    Optics(#[from] OpticsFault),
    #[error("the fit can't start from these parameters: in recording {recording}, {why}")]
    Start {
        /// Its number, from 1.
        recording: usize,
        why: String,
    },
}
