//! Time stamps to seconds: numbers in a unit, dates with times of day, times of day alone.
//!
//! - numbers: `0.04`, `1634808058216` (with a unit);
//! - ISO 8601 and what is near it: `2021-10-21 09:20:58.216642589+00:00`, `2021-10-21T09:20:58Z`,
//!   `2021/10/21 09:20:58`, `21.10.2021 09:20:58,216`; with or without a zone, down to nanoseconds;
//! - as American and MATLAB's programs write them: `10/21/2021 9:20:58.216 AM`, `21-Oct-2021 09:20:58`. Where the first
//!   is `10/11/2021`, nobody can tell which is the month, and it is refused;
//! - times of day: `09:20:58.216`, `9:20:58 AM`; one that lies nearer to the last stamp on another day is taken to be
//!   on that day, so that time goes on over midnight.
//!
//! Out: seconds, and the midnight of the wall clock before the first stamp. The first stamp says which kind they all
//! are.

use jiff::civil::{Date, DateTime, Time};
use jiff::fmt::strtime::BrokenDownTime;
use jiff::fmt::temporal::Pieces;
use jiff::tz::Offset;
use lunula_live::wire::is_missing;

use crate::log::lines::cell::{self, Numbers};

pub(in crate::log) const DAY_S: f64 = 86_400.0;

/// The unit of time stamps that are numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds.
    Seconds,
    /// Thousandths of a second.
    Milliseconds,
    /// Millionths of a second.
    Microseconds,
    /// 1e-9 seconds.
    Nanoseconds,
}

impl TimeUnit {
    /// The unit of a word in small letters, such as `ms`.
    pub(in crate::log) fn of_word(word: &str) -> Option<Self> {
        Some(match word {
            "s" | "sec" | "secs" | "second" | "seconds" => Self::Seconds,
            "ms" | "msec" | "millis" | "millisecond" | "milliseconds" => Self::Milliseconds,
            "us" | "usec" | "micros" | "microsecond" | "microseconds" => Self::Microseconds,
            "ns" | "nsec" | "nanos" | "nanosecond" | "nanoseconds" => Self::Nanoseconds,
            _ => return None,
        })
    }

    /// How many make a second.
    pub(in crate::log) fn a_second(self) -> f64 {
        match self {
            Self::Seconds => 1.0,
            Self::Milliseconds => 1e3,
            Self::Microseconds => 1e6,
            Self::Nanoseconds => 1e9,
        }
    }
}

impl std::str::FromStr for TimeUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::of_word(text).ok_or_else(|| format!("`{text}` is no unit of time stamps; write s, ms, us or ns"))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Numbers,
    Dates { zoned: bool },
    TimesOfDay,
}

impl Kind {
    fn words(self) -> &'static str {
        match self {
            Self::Numbers => "a number",
            Self::Dates { zoned: true } => "a date and time with a zone",
            Self::Dates { zoned: false } => "a date and time without a zone",
            Self::TimesOfDay => "a time of day",
        }
    }
}

/// Reads a column of time stamps.
#[derive(Debug, Clone, Default)]
pub(in crate::log) struct Stamps {
    kind: Option<Kind>,
    /// As they were pushed, numbers in their own unit; NaN where missing.
    time: Vec<f64>,
    last_s: Option<f64>,
    midnight_s: Option<f64>,
    passed_midnight: bool,
    /// Of `10/21/2021`, as the first date says.
    day_first: Option<bool>,
}

impl Stamps {
    /// Adds the stamp in a cell without space around it.
    pub(in crate::log) fn push(&mut self, cell: &[u8], numbers: &mut Numbers) -> Result<(), String> {
        if is_missing(cell) {
            self.time.push(f64::NAN);
            return Ok(());
        }
        if self.kind == Some(Kind::Numbers) {
            let number = numbers.read(cell).map_err(|why| match date_or_time(cell, &mut None) {
                Ok(_) => self.other(cell),
                Err(_) => why,
            })?;
            self.time.push(number);
            return Ok(());
        }
        let text = || std::str::from_utf8(cell).unwrap_or("");
        if self.kind.is_none() && !text().contains(':') {
            let number = numbers.read(cell).map_err(|_| unknown(cell))?;
            self.kind = Some(Kind::Numbers);
            self.time.push(number);
            return Ok(());
        }
        let moment = date_or_time(cell, &mut self.day_first)?;
        if *self.kind.get_or_insert(moment.kind) != moment.kind {
            return Err(self.other(cell));
        }
        self.midnight_s.get_or_insert(moment.midnight_s);
        let mut time_s = moment.time_s;
        if let (Kind::TimesOfDay, Some(last_s)) = (moment.kind, self.last_s) {
            let days = ((last_s - time_s) / DAY_S).round().max(0.0);
            self.passed_midnight |= days > 0.0;
            time_s += days * DAY_S;
        }
        self.last_s = Some(time_s);
        self.time.push(time_s);
        Ok(())
    }

    /// Stamps that are numbers already, NaN where missing.
    pub(in crate::log) fn of_numbers(time: Vec<f64>) -> Self {
        Self { kind: Some(Kind::Numbers), time, ..Self::default() }
    }

    /// The stamps in seconds (NaN where missing), and the midnight before the first of them.
    pub(in crate::log) fn finish(mut self, unit: Option<TimeUnit>, notes: &mut Vec<String>) -> (Vec<f64>, Option<f64>) {
        if self.passed_midnight {
            notes.push("times of day pass midnight; they go on from there".to_owned());
        }
        if self.kind != Some(Kind::Numbers) {
            return (self.time, self.midnight_s);
        }
        let first = self.time.iter().copied().find(|t| !t.is_nan()).unwrap_or(0.0);
        let unit = unit.unwrap_or_else(|| {
            let (guess, note) = since_1970(first);
            notes.extend(note);
            guess
        });
        if unit != TimeUnit::Seconds {
            self.time.iter_mut().for_each(|t| *t /= unit.a_second());
        }
        (self.time, None)
    }

    fn other(&self, cell: &[u8]) -> String {
        let kind = self.kind.map_or("", Kind::words);
        format!(
            "the time stamp `{}` is of another kind than the first, which is {kind}; write all alike",
            cell::shown(cell)
        )
    }
}

/// The unit of a bare number that may count since 1970, of the years 2001 to 2096, and a note where it does in anything
/// but seconds.
fn since_1970(stamp: f64) -> (TimeUnit, Option<String>) {
    const YEARS_2001_TO_2096: std::ops::Range<f64> = 1e9..4e9;
    let units = [
        (TimeUnit::Milliseconds, "milliseconds"),
        (TimeUnit::Microseconds, "microseconds"),
        (TimeUnit::Nanoseconds, "nanoseconds"),
    ];
    match units.iter().find(|(unit, _)| YEARS_2001_TO_2096.contains(&(stamp / unit.a_second()))) {
        Some((unit, word)) => {
            let note =
                format!("time stamps such as {stamp} are taken as {word} since 1970; --time-unit says otherwise");
            (*unit, Some(note))
        }
        None => (TimeUnit::Seconds, None),
    }
}

/// A stamp that is not a number.
struct Moment {
    kind: Kind,
    time_s: f64,
    midnight_s: f64,
}

fn date_or_time(cell: &[u8], day_first: &mut Option<bool>) -> Result<Moment, String> {
    let text = std::str::from_utf8(cell).map_err(|_| unknown(cell))?;
    if let Some(time_s) = time_of_day(text).or_else(|| half_day(text)) {
        return Ok(Moment { kind: Kind::TimesOfDay, time_s, midnight_s: 0.0 });
    }
    let mut iso = [0; 48];
    let pieces = Pieces::parse(as_iso(text, &mut iso).unwrap_or(text)).ok();
    let (date, time, offset) = match &pieces {
        Some(pieces) => (pieces.date(), pieces.time().ok_or_else(|| unknown(cell))?, pieces.to_numeric_offset()),
        None => {
            let other = other_date(&text.replace(',', "."), day_first).map_err(|help| unknown(cell) + help)?;
            (other.date(), other.time(), None)
        }
    };
    let seconds = |date: Date, time: Time| {
        let stamp = offset.unwrap_or(Offset::UTC).to_timestamp(date.to_datetime(time)).map_err(|_| unknown(cell))?;
        Ok::<_, String>(stamp.as_second() as f64 + f64::from(stamp.subsec_nanosecond()) / 1e9)
    };
    Ok(Moment {
        kind: Kind::Dates { zoned: offset.is_some() },
        time_s: seconds(date, time)?,
        midnight_s: seconds(date, Time::midnight())?,
    })
}

/// The seconds of `9:20:58.216 PM`.
fn half_day(text: &str) -> Option<f64> {
    let time = BrokenDownTime::parse("%I:%M:%S%.f %p", text.replace(',', ".")).ok()?.to_time().ok()?;
    Some(time.duration_since(Time::midnight()).as_secs_f64())
}

/// `21-Oct-2021 ..`, and `10/21/2021 ..` in the order of day and month that a file's first date shows.
///
/// # Errors
/// What to add to the words that it is none.
fn other_date(text: &str, day_first: &mut Option<bool>) -> Result<DateTime, &'static str> {
    const MATLAB: [&str; 2] = ["%d-%b-%Y %H:%M:%S%.f", "%d-%b-%Y %I:%M:%S%.f %p"];
    const DAY_FIRST: [&str; 2] = ["%d/%m/%Y %H:%M:%S%.f", "%d/%m/%Y %I:%M:%S%.f %p"];
    const MONTH_FIRST: [&str; 2] = ["%m/%d/%Y %H:%M:%S%.f", "%m/%d/%Y %I:%M:%S%.f %p"];
    let of = |formats: [&str; 2]| {
        formats.iter().find_map(|format| BrokenDownTime::parse(format, text).ok()?.to_datetime().ok())
    };
    if !text.contains('/') {
        return of(MATLAB).ok_or("");
    }
    if let Some(is_day_first) = *day_first {
        let own = if is_day_first { DAY_FIRST } else { MONTH_FIRST };
        return of(own).ok_or("; its day and month are the other way round than in the first row");
    }
    let (date, is_day_first) = match (of(DAY_FIRST), of(MONTH_FIRST)) {
        (Some(day), Some(month)) if day != month => return Err("; day and month can't be told apart"),
        // The same either way, it says nothing of the next one.
        (Some(date), Some(_)) => return Ok(date),
        (Some(date), None) => (date, true),
        (None, Some(date)) => (date, false),
        (None, None) => return Err(""),
    };
    *day_first = Some(is_day_first);
    Ok(date)
}

fn unknown(cell: &[u8]) -> String {
    format!(
        "`{}` is no time stamp; write seconds, or dates as 2021-10-21 09:20:58.216, or times as 09:20:58.216",
        cell::shown(cell)
    )
}

/// The seconds of `h:mm:ss` with or without a fraction.
fn time_of_day(text: &str) -> Option<f64> {
    let (hours, rest) = text.split_once(':')?;
    let (minutes, seconds) = rest.split_once(':')?;
    let (whole, fraction) = seconds.split_once(['.', ',']).unwrap_or((seconds, ""));
    let digits = |text: &str, most: usize| {
        let fits = text.len() <= most && !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        fits.then(|| text.parse::<u32>().ok()).flatten().map(f64::from)
    };
    let (hours, minutes, whole) = (digits(hours, 3)?, digits(minutes, 2)?, digits(whole, 2)?);
    if minutes >= 60.0 || whole >= 60.0 || fraction.len() > 18 || !fraction.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let part =
        if fraction.is_empty() { 0.0 } else { fraction.parse::<f64>().ok()? / 10f64.powi(fraction.len() as i32) };
    Some(hours * 3600.0 + minutes * 60.0 + whole + part)
}

/// `2021/10/21 ..` and `21.10.2021 ..` as ISO 8601 writes them.
fn as_iso<'a>(text: &str, into: &'a mut [u8; 48]) -> Option<&'a str> {
    let bytes = text.as_bytes();
    let marks = |at: [usize; 2], mark: u8| bytes.len() > 10 && at.iter().all(|&k| bytes[k] == mark);
    let order: [usize; 10] = if marks([4, 7], b'/') {
        [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]
    } else if marks([2, 5], b'.') {
        [6, 7, 8, 9, 2, 3, 4, 5, 0, 1]
    } else {
        return None;
    };
    let into = into.get_mut(..bytes.len())?;
    into.copy_from_slice(bytes);
    for (to, from) in order.into_iter().enumerate() {
        into[to] = if matches!(to, 4 | 7) { b'-' } else { bytes[from] };
    }
    std::str::from_utf8(into).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(cells: &[&str]) -> Result<Stamps, String> {
        let (mut stamps, mut numbers) = (Stamps::default(), Numbers::of(b';'));
        cells.iter().try_for_each(|cell| stamps.push(cell.as_bytes(), &mut numbers))?;
        Ok(stamps)
    }

    fn seconds(cells: &[&str], unit: Option<TimeUnit>) -> (Vec<f64>, Option<f64>, usize) {
        let mut notes = Vec::new();
        let (time_s, midnight_s) = read(cells).unwrap().finish(unit, &mut notes);
        (time_s, midnight_s, notes.len())
    }

    /// The step of 64-bit numbers at 1.6e9, half of it lost twice (nanoseconds as a number, then as seconds).
    const STEP_S: f64 = 2.4e-7;

    #[test]
    fn dates_are_read_with_and_without_zone() {
        let at = 1_634_808_058.216_642_6;
        for (text, time_s, midnight_s) in [
            ("2021-10-21 09:20:58.216642589+00:00", at, 1_634_774_400.0),
            ("2021-10-21T09:20:58.216642589Z", at, 1_634_774_400.0),
            ("2021-10-21 09:20:58.216642589", at, 1_634_774_400.0),
            ("2021-10-21 11:20:58.216642589+02:00", at, 1_634_767_200.0),
            ("2021-10-21T05:20:58.216642589-0400", at, 1_634_788_800.0),
            ("2021/10/21 09:20:58,216642589", at, 1_634_774_400.0),
            ("21.10.2021 09:20:58.216642589", at, 1_634_774_400.0),
            ("1970-01-02 20:18:58.629079887", 159_538.629_079_887, 86_400.0),
            ("10/21/2021 9:20:58.216642589 AM", at, 1_634_774_400.0),
            ("21/10/2021 09:20:58.216642589", at, 1_634_774_400.0),
            ("21/10/2021 09:20:58,216642589", at, 1_634_774_400.0),
            ("21-Oct-2021 09:20:58,216642589", at, 1_634_774_400.0),
            ("21-Oct-2021 09:20:58.216642589", at, 1_634_774_400.0),
        ] {
            let (time, midnight, notes) = seconds(&[text], None);
            assert!((time[0] - time_s).abs() <= STEP_S, "{text}: {}", time[0]);
            assert_eq!((midnight, notes), (Some(midnight_s), 0), "{text}");
        }
    }

    #[test]
    fn times_of_day_go_on_over_midnight() {
        let (time, midnight, notes) = seconds(&["23:59:59.9", "", "0:00:00.0", "23:59:59.95", "00:00:00,1"], None);
        assert!(time[1].is_nan());
        assert_eq!((time[2], midnight, notes), (86_400.0, Some(0.0), 1));
        assert!((time[3] - 86_399.95).abs() <= 1e-9 && (time[4] - 86_400.1).abs() <= 1e-9);
        assert_eq!(seconds(&["00:00:01", "00:00:00"], None).0, [1.0, 0.0]);
        assert_eq!(seconds(&["11:59:59,5 AM", "12:00:00 PM", "1:00:01 PM"], None).0, [43_199.5, 43_200.0, 46_801.0]);
    }

    #[test]
    fn the_first_date_says_which_is_the_month() {
        let days = |cells: &[&str]| seconds(cells, None).0.iter().map(|s| s / DAY_S).collect::<Vec<f64>>();
        assert_eq!(days(&["1/31/1970 00:00:00", "2/1/1970 00:00:00"]), [30.0, 31.0]);
        assert_eq!(days(&["31/1/1970 00:00:00", "1/2/1970 00:00:00"]), [30.0, 31.0]);
        assert_eq!(days(&["1/1/1970 00:00:00"]), [0.0], "the same either way");
        assert!(read(&["1/31/1970 00:00:00", "31/1/1970 00:00:00"]).unwrap_err().contains("the other way round"));
    }

    #[test]
    fn numbers_have_a_unit() {
        assert_eq!(seconds(&["0,5", "1"], None), (vec![0.5, 1.0], None, 0));
        assert_eq!(seconds(&["39", "62"], Some(TimeUnit::Milliseconds)).0, [0.039, 0.062]);
        for (stamp, notes) in
            [("1634808058.25", 0), ("1634808058250", 1), ("1634808058250000", 1), ("1634808058250000000", 1)]
        {
            let (time, midnight, note) = seconds(&[stamp], None);
            assert!((time[0] - 1_634_808_058.25).abs() <= STEP_S, "{stamp}");
            assert_eq!((midnight, note), (None, notes), "{stamp}");
        }
        // A unit that is given is the unit.
        assert_eq!(seconds(&["1634808058250"], Some(TimeUnit::Seconds)), (vec![1_634_808_058_250.0], None, 0));
        assert_eq!("us".parse(), Ok(TimeUnit::Microseconds));
        assert!("h".parse::<TimeUnit>().unwrap_err().contains("s, ms, us or ns"));
    }

    #[test]
    fn other_stamps_are_refused_in_words() {
        for (cells, words) in [
            (&["10/11/2021 09:20:58"][..], "can't be told apart"),
            (&["31/31/2021 09:20:58"], "no time stamp"),
            (&["yesterday"], "no time stamp"),
            (&["2021-10-21"], "no time stamp"),
            (&["2021-02-30 00:00:00"], "no time stamp"),
            (&["09:20"], "no time stamp"),
            (&["09:61:00"], "no time stamp"),
            (&["inf"], "no time stamp"),
            (&["0.5", "x"], "`x` is no number"),
            (&["0.5", "09:20:58"], "of another kind than the first, which is a number"),
            (&["09:20:58", "0.5"], "no time stamp"),
            (&["2021-10-21 09:20:58", "2021-10-21 09:20:58Z"], "of another kind"),
        ] {
            let error = read(cells).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }
}
