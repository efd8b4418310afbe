//! What a session with a sensor is to do: the options of `lunula live` and `lunula record`.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;
use lunula_live::source::{Address, OfFinger};

use crate::job::number;
use crate::log::LogReading;
use crate::predictor::GateChoices;

/// Where samples come from, and how they are read.
#[derive(Debug, Clone, Default, Args)]
pub struct StreamOptions {
    /// Where samples come from: serial:/dev/ttyACM0?baud=921600, serial:auto, tcp:HOST:PORT, tcp-listen:ADDRESS:PORT,
    /// udp:PORT, lsl:name=NAME, - (standard input), FILE?rate=1|max, phantom:contacts?seed=1; of several fingers
    /// once for each, as index=SOURCE
    #[arg(long, required = true, value_name = "[FINGER=]SOURCE", value_parser = str::parse::<OfFinger<Address>>)]
    pub source: Vec<OfFinger<Address>>,
    /// A force transducer that is a device of its own: its columns are recorded at the times of the sensor's samples
    #[arg(long, value_name = "[FINGER=]SOURCE", value_parser = str::parse::<OfFinger<Address>>)]
    pub force: Vec<OfFinger<Address>>,
    /// What a step of the converter is, where the device sends counts: 10/65536 of 16 bits over 10 V
    #[arg(long, value_name = "VOLTS", value_parser = volts)]
    pub volts_per_count: Option<f64>,
    /// The names of the columns, where the stream does not begin with them, as time_us,n,led,P1,P2
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub names: Option<Vec<String>>,
    /// Further columns of numbers that are kept, by name
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub keep: Vec<String>,
    /// Ends after so many seconds of the stream's time [default: at the stream's end, or when interrupted]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub seconds: Option<f64>,
    /// How the columns are read.
    #[command(flatten)]
    pub log: LogReading,
}

/// What is made of the samples.
#[derive(Debug, Clone, Args)]
pub struct AnswerOptions {
    /// Equation 9's threshold and angle while touching.
    #[command(flatten)]
    pub gate: GateChoices,
    /// Each prediction's interval as well, as TARGET_low, TARGET_high (the models need to be trained with --validate)
    #[arg(long)]
    pub intervals: bool,
    /// Rows with a saturated photodiode count too
    #[arg(long)]
    pub keep_faults: bool,
}

/// The options of `lunula live`.
#[derive(Debug, Clone, Args)]
pub struct LiveOptions {
    /// The stream.
    #[command(flatten)]
    pub stream: StreamOptions,
    /// What is made of it.
    #[command(flatten)]
    pub answer: AnswerOptions,
    /// Hands the rows out to whoever connects to this address too, as 127.0.0.1:7777
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub tcp: Option<SocketAddr>,
    /// Sends the rows as a stream of the Lab Streaming Layer of this name too
    #[arg(long, value_name = "NAME")]
    pub lsl: Option<String>,
    /// Shows the session on a page of this machine's browser: traces as on the nail, forces, switch, losses, latency
    #[arg(long)]
    pub serve: bool,
}

/// The options of `lunula mouse`.
#[derive(Debug, Clone, Args)]
pub struct MouseOptions {
    /// The stream.
    #[command(flatten)]
    pub stream: StreamOptions,
    /// What is made of it.
    #[command(flatten)]
    pub answer: AnswerOptions,
}

/// Files of a session.
#[derive(Debug, Clone, Default)]
pub struct SessionFiles {
    /// The recording.
    pub out: Option<PathBuf>,
    /// Whether a recording, or events, that exist are replaced.
    pub replace: bool,
    /// The models, of a finger or of all.
    pub models: Vec<OfFinger<PathBuf>>,
    /// The switches, of a finger or of all.
    pub switches: Vec<OfFinger<PathBuf>>,
    /// The switches' events.
    pub events: Option<PathBuf>,
    /// The mouse.
    pub mouse: Option<MouseFiles>,
}

/// Files of a mouse.
#[derive(Debug, Clone, Default, Args)]
pub struct MouseFiles {
    /// Dead zone, gains, thresholds, times [default: the defaults of each key]
    #[arg(long, value_name = "MOUSE.toml")]
    pub config: Option<PathBuf>,
    /// Moves, buttons and scrolling, a line of JSON each
    #[arg(long, value_name = "EVENTS.jsonl", required_unless_present_any = ["uinput", "plan"])]
    pub events: Option<PathBuf>,
    /// Move the pointer of this computer (Linux' uinput; `lunula doctor` says what it lacks)
    #[arg(long)]
    pub uinput: bool,
}

fn volts(text: &str) -> Result<f64, String> {
    let value = match text.split_once('/') {
        Some((volts, steps)) => number(volts)? / number(steps)?,
        None => number(text)?,
    };
    let good = value.is_finite() && value > 0.0;
    if good { Ok(value) } else { Err("write volts above 0, as 0.00015 or 10/65536".to_owned()) }
}

fn seconds(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|s| *s > 0.0).ok_or_else(|| "write seconds above 0".to_owned())
}
