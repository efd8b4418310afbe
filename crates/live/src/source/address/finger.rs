//! What belongs to one finger of several: `index=serial:/dev/ttyACM0`, `middle=switch.toml`.

use std::fmt;
use std::str::FromStr;

/// Something of one finger, or of whatever finger there is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OfFinger<T> {
    /// The finger's name: letters, digits, `_` and `-`.
    pub finger: Option<String>,
    /// What is the finger's.
    pub what: T,
}

impl<T> OfFinger<T> {
    /// Of no finger in particular.
    pub fn any(what: T) -> Self {
        Self { finger: None, what }
    }

    /// Whether it is meant for this finger.
    pub fn is_for(&self, finger: Option<&str>) -> bool {
        self.finger.is_none() || self.finger.as_deref() == finger
    }
}

impl<T: FromStr> FromStr for OfFinger<T>
where
    T::Err: fmt::Display,
{
    type Err = String;

    /// `FINGER=WHAT`, or `WHAT`; a path that begins so is written `./index=1.csv`.
    fn from_str(text: &str) -> Result<Self, String> {
        let is_name = |name: &str| {
            name.starts_with(|c: char| c.is_ascii_alphabetic())
                && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
        };
        let (finger, rest) = match text.split_once('=') {
            Some((name, rest)) if is_name(name) => (Some(name.to_owned()), rest),
            _ => (None, text),
        };
        Ok(Self { finger, what: rest.parse().map_err(|why: T::Err| why.to_string())? })
    }
}

impl<T: fmt::Display> fmt::Display for OfFinger<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.finger {
            Some(finger) => write!(f, "{finger}={}", self.what),
            None => self.what.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::source::Address;

    #[test]
    fn a_finger_is_split_off_and_nothing_else() {
        let source = |text: &str| text.parse::<OfFinger<Address>>();
        for (text, finger, rest) in [
            ("index=serial:/dev/ttyACM0?baud=9600", Some("index"), "serial:/dev/ttyACM0?baud=9600"),
            ("left-thumb_2=-", Some("left-thumb_2"), "-"),
            ("lsl:name=a", None, "lsl:name=a"),
            ("a.csv?rate=1", None, "a.csv?rate=1"),
            ("phantom:touch?seed=1", None, "phantom:touch?seed=1"),
        ] {
            let read = source(text).unwrap();
            assert_eq!((read.finger.as_deref(), read.what), (finger, rest.parse().unwrap()), "{text}");
        }
        assert!(source("index=nothing:x").is_err() && source("index=").is_err());
        let file: OfFinger<PathBuf> = "./index=1.csv".parse().unwrap();
        assert_eq!(file, OfFinger::any(PathBuf::from("./index=1.csv")));
        assert!(file.is_for(Some("ring")) && !source("index=-").unwrap().is_for(Some("ring")));
    }
}
