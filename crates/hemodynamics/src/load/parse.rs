//! A load as a text: `0`, `step:5000@0..2`, `ramp:0..10000@0..5`, `sine:5000+1000@0.05`.

use std::fmt;
use std::str::FromStr;

use super::{Kind, Load, LoadFault};

impl fmt::Display for Load {
    /// As it is parsed; a table by its rows and times, a function by its name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let between = self.breakpoints.first().zip(self.breakpoints.last());
        match (&self.kind, between) {
            (Kind::Step(height), Some((from, to))) => write!(f, "step:{height}@{from}..{to}"),
            (Kind::Ramp(first, last), Some((from, to))) => write!(f, "ramp:{first}..{last}@{from}..{to}"),
            (Kind::Sine(mean, amplitude, frequency), _) => write!(f, "sine:{mean}+{amplitude}@{frequency}"),
            (Kind::Table(values), Some((from, to))) => write!(f, "{} rows from {from} to {to} s", values.len()),
            (Kind::Constant(value) | Kind::Step(value) | Kind::Ramp(value, _), _) => write!(f, "{value}"),
            (Kind::Table(_) | Kind::Function(_), _) => f.write_str("a function of time"),
        }
    }
}

impl FromStr for Load {
    type Err = LoadFault;

    /// Pascals, seconds, hertz: a number; `step:HEIGHT@FROM..TO`; `ramp:FIRST..LAST@FROM..TO`;
    /// `sine:MEAN+AMPLITUDE@FREQUENCY`.
    fn from_str(text: &str) -> Result<Load, LoadFault> {
        let wrong = || LoadFault::Text(text.to_owned());
        let number = |part: &str| part.trim().parse::<f64>().map_err(|_| wrong());
        let range = |part: &str| -> Result<[f64; 2], LoadFault> {
            let (first, last) = part.split_once("..").ok_or_else(wrong)?;
            Ok([number(first)?, number(last)?])
        };
        let Some((kind, rest)) = text.split_once(':') else {
            return Load::constant(number(text)?);
        };
        let (level, when) = rest.split_once('@').ok_or_else(wrong)?;
        match kind.trim() {
            "step" => {
                let [from, to] = range(when)?;
                Load::step(number(level)?, from, to)
            }
            "ramp" => {
                let ([first, last], [from, to]) = (range(level)?, range(when)?);
                Load::ramp(first, last, from, to)
            }
            "sine" => {
                // The plus of an exponent (1e+3) does not separate two numbers.
                let plus = level.char_indices().skip(1).find(|&(at, c)| c == '+' && !level[..at].ends_with(['e', 'E']));
                let (at, _) = plus.ok_or_else(wrong)?;
                Load::sine(number(&level[..at])?, number(&level[at + 1..])?, number(when)?)
            }
            _ => Err(wrong()),
        }
    }
}
