//! The command line's options as the keys of a TOML table: `--clock-offset 30` is `clock_offset = 30`, a flag is
//! `true`.
//!
//! Values go through the very parsers of the command line. An option that may be given again takes a list.

use std::collections::BTreeSet;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{ArgAction, ArgMatches, Args, Command, FromArgMatches};
use serde::Serialize;
use thiserror::Error;
use toml::{Table, Value};

use crate::table::TableFormat;
use crate::words::{Words, instead};

/// What is wrong with a key.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{what}")]
pub struct OptionFault {
    /// The key; empty: the table as a whole.
    pub key: String,
    /// What is wrong, and what to write.
    pub what: String,
}

impl OptionFault {
    /// That of a table as a whole.
    pub fn whole(what: impl ToString) -> Self {
        Self { key: String::new(), what: what.to_string() }
    }
}

/// The keys of a request, in the order of its fields.
#[must_use]
pub fn keys<R: Args>() -> Vec<String> {
    let command = R::augment_args(Command::new("lunula"));
    command.get_arguments().filter_map(|one| Some(one.get_long()?.replace('-', "_"))).collect()
}

/// Reads a number.
///
/// # Errors
/// What to write instead.
pub fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "write a number, such as 0.5".to_owned())
}

/// Reads a number that is not negative.
///
/// # Errors
/// What to write instead.
pub fn not_negative(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|number| *number >= 0.0).ok_or_else(|| "write a number of at least 0".to_owned())
}

/// Options as somebody wrote them, by name, with the defaults of all others; flags that are not set are left out.
///
/// They are what a pipeline's results depend on, and what reports repeat: written into a pipeline file they do the same
/// again.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Said {
    all: serde_json::Map<String, serde_json::Value>,
    /// Those that are no defaults.
    #[serde(skip)]
    written: BTreeSet<String>,
}

impl Said {
    /// Nothing was said, and there are no defaults.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Whether somebody wrote an option, be it with its default.
    #[must_use]
    pub fn was_written(&self, key: &str) -> bool {
        self.written.contains(key)
    }

    /// With another option, first read by the job itself.
    #[must_use]
    pub fn and(mut self, key: &str, value: &str) -> Self {
        self.all.insert(key.to_owned(), value.into());
        self.written.insert(key.to_owned());
        self
    }

    fn of<R: Args>(matches: &ArgMatches) -> Self {
        let command = R::augment_args(Command::new("lunula"));
        let mut written = BTreeSet::new();
        let all = command.get_arguments().filter_map(|one| {
            let (key, id) = (one.get_long()?.replace('-', "_"), one.get_id().as_str());
            if matches.value_source(id) == Some(ValueSource::CommandLine) {
                written.insert(key.clone());
            }
            let value = match one.get_action() {
                ArgAction::SetTrue => matches.get_flag(id).then_some(true)?.into(),
                ArgAction::SetFalse => (!matches.get_flag(id)).then_some(true)?.into(),
                action => {
                    let words = matches.get_raw(id)?.map(|word| word.to_string_lossy().into_owned());
                    let mut words: Vec<String> = words.collect();
                    if matches!(action, ArgAction::Append) { words.into() } else { words.pop()?.into() }
                }
            };
            Some((key, value))
        });
        let all = all.collect();
        Self { all, written }
    }
}

/// Options, read, and as they were written; flattened into a command they are its options.
#[derive(Debug, Clone)]
pub struct Given<R> {
    /// As the job takes them.
    pub options: R,
    /// As they were written.
    pub said: Said,
}

impl<R: Args> FromArgMatches for Given<R> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        Ok(Self { said: Said::of::<R>(matches), options: R::from_arg_matches(matches)? })
    }

    fn from_arg_matches_mut(matches: &mut ArgMatches) -> Result<Self, clap::Error> {
        Ok(Self { said: Said::of::<R>(matches), options: R::from_arg_matches_mut(matches)? })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        self.said = Said::of::<R>(matches);
        self.options.update_from_arg_matches(matches)
    }
}

impl<R: Args> Args for Given<R> {
    fn augment_args(command: Command) -> Command {
        R::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        R::augment_args_for_update(command)
    }
}

/// How a stage's tables are written; on the command line the name of a table's file says it.
#[derive(Debug, Clone, Copy, Args)]
pub struct Tables {
    /// csv or parquet
    #[arg(long, value_parser = one_of::<TableFormat>(), default_value = "csv")]
    format: TableFormat,
}

impl Tables {
    /// The name of a table, of the two that it can have.
    #[must_use]
    pub fn named(self, csv: &'static str, parquet: &'static str) -> &'static str {
        match self.format {
            TableFormat::Csv => csv,
            TableFormat::Parquet => parquet,
        }
    }

    /// The format.
    #[must_use]
    pub fn format(self) -> TableFormat {
        self.format
    }
}

/// Reads a choice by its word; help lists them.
pub fn one_of<T: Words>() -> impl TypedValueParser<Value = T> {
    let value = |word: &'static str, about: &'static str| {
        let value = PossibleValue::new(word);
        if about.is_empty() { value } else { value.help(about) }
    };
    PossibleValuesParser::new(T::WORDS.iter().map(|&(_, word, about)| value(word, about)))
        .try_map(|word| T::by_word(&word))
}

/// The options that nobody gave: all defaults.
///
/// # Panics
/// Where an option has no default and is needed.
#[must_use]
pub fn defaults<R: Args>() -> R {
    match read::<R>(&Table::new(), "lunula") {
        Ok(given) => given.options,
        Err(fault) => panic!("{fault}"),
    }
}

/// Reads options from a table; `of` is the command or job, as `lunula phantom video`.
///
/// # Errors
/// [`OptionFault`], the first thing that is wrong.
pub fn read<R: Args>(table: &Table, of: &str) -> Result<Given<R>, OptionFault> {
    let command = R::augment_args(Command::new("lunula").no_binary_name(true).disable_help_flag(true));
    let mut words = Vec::new();
    for (key, value) in table {
        let fault = |what: String| OptionFault { key: key.clone(), what };
        let long = key.replace('_', "-");
        let Some(option) = command.get_arguments().find(|one| one.get_long() == Some(&long)) else {
            let known = keys::<R>();
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let choice = if known.is_empty() { "it has none".to_owned() } else { instead(key, &known) };
            return Err(fault(format!("`{key}` is not an option of {of}; {choice}")));
        };
        let flag = matches!(option.get_action(), ArgAction::SetTrue | ArgAction::SetFalse);
        let again = matches!(option.get_action(), ArgAction::Append);
        match value {
            Value::Boolean(yes) if flag => words.extend(yes.then(|| format!("--{long}"))),
            _ if flag => return Err(fault(format!("`{key}` is a flag: write true or false"))),
            // Pairs, as `--set b_V=300 --set k_C=1e5`.
            Value::Table(pairs) if again => {
                for (name, value) in pairs {
                    words.push(format!("--{long}={name}={}", word(value).ok_or_else(|| fault(no_value(key)))?));
                }
            }
            Value::Array(values) if values.is_empty() => {
                if option.is_required_set() || !option.get_default_values().is_empty() {
                    return Err(fault(format!("`{key}` is empty; name at least one")));
                }
            }
            Value::Array(values) if again => {
                for value in values {
                    words.push(format!("--{long}={}", word(value).ok_or_else(|| fault(no_value(key)))?));
                }
            }
            value => words.push(format!("--{long}={}", word(value).ok_or_else(|| fault(no_value(key)))?)),
        }
    }
    let refused = |error: clap::Error| of_keys(&error);
    Given::from_arg_matches(&command.try_get_matches_from(words).map_err(refused)?).map_err(refused)
}

fn no_value(key: &str) -> String {
    format!("`{key}` has to be a number or text, or a list of them where the command takes it more than once")
}

/// A value as one would type it.
fn word(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Integer(number) => Some(number.to_string()),
        Value::Float(number) => Some(number.to_string()),
        // A row of several, as in `--places P7,P2,P5`.
        Value::Array(names) => {
            let names = names.iter().map(Value::as_str).collect::<Option<Vec<_>>>()?;
            Some(names.join(","))
        }
        // Pairs, as in `--columns P1=ch_1,led=lamp`.
        Value::Table(pairs) => {
            let pair = |(name, text): (&String, &Value)| Some(format!("{name}=\"{}\"", text.as_str()?));
            Some(pairs.iter().map(pair).collect::<Option<Vec<_>>>()?.join(","))
        }
        _ => None,
    }
}

/// The command line's complaint, of keys instead of options.
fn of_keys(error: &clap::Error) -> OptionFault {
    let of = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        Some(ContextValue::Strings(all)) => all.first().cloned(),
        _ => None,
    };
    // As `--clock-offset <SECONDS>`.
    let name = |usage: &str| {
        let long = usage.split([' ', '=', '[']).next().unwrap_or_default();
        long.trim_start_matches("--").replace('-', "_")
    };
    let invalid = of(ContextKind::InvalidArg).unwrap_or_default();
    let key = name(&invalid);
    let what = match error.kind() {
        ErrorKind::MissingRequiredArgument => format!("`{key}` is needed"),
        ErrorKind::ArgumentConflict => {
            let other = of(ContextKind::PriorArg).map(|usage| name(&usage)).unwrap_or_default();
            format!("`{key}` can't be given together with `{other}`")
        }
        _ => {
            let value = of(ContextKind::InvalidValue).unwrap_or_default();
            let why = std::error::Error::source(error).map(|why| format!(": {why}")).unwrap_or_default();
            let choices = match error.get(ContextKind::ValidValue) {
                Some(ContextValue::Strings(all)) if !all.is_empty() => format!("; choose {}", all.join(", ")),
                _ => String::new(),
            };
            format!("`{value}` is not a value of `{key}`{why}{choices}")
        }
    };
    OptionFault { key, what }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantom::request::{LogRequest, PhotosRequest, VideoRequest};
    use crate::phantom::video::{Hide, Preset, VideoOptions};

    fn table(text: &str) -> Table {
        text.parse().unwrap()
    }

    fn refused<R: Args + std::fmt::Debug>(text: &str) -> (String, String) {
        let fault = read::<R>(&table(text), "lunula phantom x").unwrap_err();
        (fault.key, fault.what)
    }

    #[test]
    fn keys_are_the_options_of_the_command_line() {
        let text = "scene = \"small\"\nseconds = 2\nclock = \"mm:ss.t\"\nclock_offset = -3.5\nclock_dark = \
                    true\nstart = false\n\
            hide = [\"middle_dist@3+2\", \"hand_prox@9+1\"]\njoints = [\"J2\", \"J3\"]\nblur = 0.25";
        let options = read::<VideoRequest>(&table(text), "lunula phantom video").unwrap().options.options().unwrap();
        let mut expected = VideoOptions { seconds: 2.0, blur: 0.25, ..VideoOptions::new(Preset::Small) };
        let clock = options.clock.clone().unwrap();
        assert_eq!((clock.offset_s, clock.light_digits, clock.format.as_str()), (-3.5, false, "mm:ss.t"));
        expected.clock = Some(clock);
        let hide = |marker: &str, frame, frames| Hide { marker: marker.to_owned(), frame, frames };
        expected.hide = vec![hide("middle_dist", 3, 2), hide("hand_prox", 9, 1)];
        expected.joints = vec!["J2".to_owned(), "J3".to_owned()];
        assert_eq!(options, expected);
        let keys = "poses = [\"nominal\"]\nsubjects = 3\ngrey = true\nsize = \"160x96\"";
        let photos = read::<PhotosRequest>(&table(keys), "").unwrap().options.options();
        assert_eq!((photos.poses.len(), photos.subjects, photos.grey, photos.width), (1, 3, true, 160));
    }

    #[test]
    fn a_fault_names_its_key() {
        let (key, what) = refused::<VideoRequest>("secnds = 2");
        assert_eq!(
            (key.as_str(), what.as_str()),
            ("secnds", "`secnds` is not an option of lunula phantom x; did you mean `seconds`?")
        );
        let (key, what) = refused::<PhotosRequest>("quick = 2");
        assert!(key == "quick" && what.contains("known: seed, subjects,"), "{what}");
        let (key, what) = refused::<VideoRequest>("video_size = 2");
        assert!(key == "video_size" && what.contains("is not a"), "{what}");
        let (key, what) = refused::<PhotosRequest>("size = \"wide\"");
        assert!(key == "size" && what.contains("`wide` is not WIDTHxHEIGHT"), "{what}");
        let (key, what) = refused::<LogRequest>("protocol = \"touchy\"");
        assert!(key == "protocol" && what.contains("touch-random"), "{what}");
        let (key, what) = refused::<PhotosRequest>("grey = 1");
        assert!(key == "grey" && what.contains("true or false"), "{what}");
        let (key, what) = refused::<PhotosRequest>("seed = [1, 2]");
        assert!(key == "seed" && what.contains("a number or text"), "{what}");
        let (key, what) = refused::<VideoRequest>("clock_offset = 2");
        assert!(key == "clock" && what.contains("is needed"), "{what}");
    }
}
