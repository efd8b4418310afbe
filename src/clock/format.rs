//! How a clock is written: which of its characters are digits, and of what.

/// A unit of time that has digits of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Unit {
    /// Hours.
    Hours,
    /// Minutes.
    Minutes,
    /// Seconds.
    Seconds,
    /// Tenths of a second and finer.
    Fraction,
}

/// One character of a clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// A digit that counts units of `10^-9` seconds, so many of them a step; the digit of a tens place of minutes or
    /// seconds that another unit stands before goes to 5 only.
    Digit {
        /// Of what.
        unit: Unit,
        /// Nanoseconds that one step of this digit is worth.
        worth_ns: i64,
        /// The highest digit that can stand here: 9, or 5 for tens of minutes and seconds below another unit.
        highest: u8,
    },
    /// A mark that stands as it is, such as `:`.
    Mark(char),
    /// AM or PM, in capitals or not, with dots or without.
    Half,
}

/// Which half of the day a 12-hour clock shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Half {
    /// From midnight on, which is 12 AM.
    Am,
    /// From noon on, which is 12 PM.
    Pm,
}

/// A clock's format, checked: `h`, `m`, `s` stand for a digit of hours, minutes, seconds, `t` for tenths and finer, `a`
/// before or after all of them for AM or PM; anything else stands as it is. Such as `mm:ss.t` and `hh:mm:ss a`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClockFormat {
    text: String,
    cells: Vec<Cell>,
}

const SECOND_NS: i64 = 1_000_000_000;
/// AM or PM in a format's text.
const HALF: char = 'a';

impl ClockFormat {
    /// Checks a format.
    ///
    /// # Errors
    /// What is wrong and what to write instead.
    pub fn parse(text: &str) -> Result<Self, String> {
        if let Some(fault) = fault(text) {
            return Err(fault);
        }
        let letters: Vec<char> = text.chars().collect();
        let first = letters.iter().find(|&&c| c.is_alphanumeric() && c != HALF);
        let half = letters.contains(&HALF);
        let mut cells = Vec::with_capacity(letters.len());
        for (k, &letter) in letters.iter().enumerate() {
            let unit = match letter {
                'h' => Unit::Hours,
                'm' => Unit::Minutes,
                's' => Unit::Seconds,
                't' => Unit::Fraction,
                HALF => {
                    cells.push(Cell::Half);
                    continue;
                }
                mark => {
                    cells.push(Cell::Mark(mark));
                    continue;
                }
            };
            let of_its_kind = |letters: &[char]| letters.iter().filter(|&&c| c == letter).count() as u32;
            let worth_ns = match unit {
                Unit::Hours => 3600 * SECOND_NS * 10i64.pow(of_its_kind(&letters[k + 1..])),
                Unit::Minutes => 60 * SECOND_NS * 10i64.pow(of_its_kind(&letters[k + 1..])),
                Unit::Seconds => SECOND_NS * 10i64.pow(of_its_kind(&letters[k + 1..])),
                Unit::Fraction => SECOND_NS / 10i64.pow(1 + of_its_kind(&letters[..k])),
            };
            let tens = matches!(unit, Unit::Minutes | Unit::Seconds) && of_its_kind(&letters[k + 1..]) == 1;
            let of_twelve = half && unit == Unit::Hours && of_its_kind(&letters[k + 1..]) == 1;
            let highest = if of_twelve {
                1
            } else if tens && first != Some(&letter) {
                5
            } else {
                9
            };
            cells.push(Cell::Digit { unit, worth_ns, highest });
        }
        Ok(Self { text: text.to_owned(), cells })
    }

    /// As the user wrote it.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its characters, in order.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// How many of its characters are digits.
    #[must_use]
    pub fn digits(&self) -> usize {
        self.cells.iter().filter(|cell| matches!(cell, Cell::Digit { .. })).count()
    }

    /// Whether it says AM and PM.
    #[must_use]
    pub fn has_half(&self) -> bool {
        self.cells.contains(&Cell::Half)
    }

    /// Whether its AM or PM stands before the digits; false where it has none.
    #[must_use]
    pub fn half_leads(&self) -> bool {
        self.cells.first() == Some(&Cell::Half)
    }

    /// The least step that it shows, seconds: 0.1 for `mm:ss.t`.
    #[must_use]
    pub fn resolution_s(&self) -> f64 {
        let worth = |cell: &Cell| if let Cell::Digit { worth_ns, .. } = cell { Some(*worth_ns) } else { None };
        self.cells.iter().filter_map(worth).min().unwrap_or(SECOND_NS) as f64 / SECOND_NS as f64
    }

    /// How many digits of tenths and finer it has.
    #[must_use]
    pub fn decimals(&self) -> usize {
        self.cells.iter().filter(|cell| matches!(cell, Cell::Digit { unit: Unit::Fraction, .. })).count()
    }

    /// After how many seconds it can show the same again. With AM and PM a day; of a leading `hh` a day, half of one
    /// or, of a timer, 100 hours; of leading `mm` and `ss` an hour and a minute or, of a timer that counts on, 100 of
    /// them; so there may be several.
    #[must_use]
    pub fn wraps_s(&self) -> Vec<f64> {
        if self.has_half() {
            return vec![2.0 * HALF_DAY_S];
        }
        let mut leading = None;
        let mut count = 0;
        for cell in &self.cells {
            if let Cell::Digit { unit, .. } = cell {
                if *leading.get_or_insert(*unit) != *unit {
                    break;
                }
                count += 1;
            }
        }
        let all = 10f64.powi(count);
        match leading {
            Some(Unit::Hours) if count == 2 => vec![86_400.0, 43_200.0, 360_000.0],
            Some(Unit::Hours) if count == 1 => vec![36_000.0, 43_200.0, 86_400.0],
            Some(Unit::Hours) => vec![3600.0 * all],
            Some(Unit::Minutes) if count == 2 => vec![3600.0, 6000.0],
            Some(Unit::Minutes) => vec![60.0 * all],
            Some(Unit::Seconds) if count == 2 => vec![60.0, 100.0],
            _ => vec![all],
        }
    }

    /// The seconds that these digits mean, one for each [`Cell::Digit`], in order, and AM or PM; none where a digit
    /// can't stand in its place, or AM or PM are missing where the format has them.
    #[must_use]
    pub fn seconds(&self, digits: &[u8], half: Option<Half>) -> Option<f64> {
        let mut left = digits.iter();
        let (mut sum_ns, mut hours) = (0, 0);
        for cell in &self.cells {
            if let Cell::Digit { worth_ns, highest, unit } = cell {
                let digit = *left.next()?;
                if digit > *highest {
                    return None;
                }
                sum_ns += i64::from(digit) * worth_ns;
                if *unit == Unit::Hours {
                    hours = 10 * hours + u32::from(digit);
                }
            }
        }
        let shown_s = sum_ns as f64 / SECOND_NS as f64;
        let half_s = match (self.has_half(), half) {
            (false, _) => 0.0,
            // The hour 12 comes before 1.
            (true, Some(half)) if (1..=12).contains(&hours) => {
                (if hours == 12 { -HALF_DAY_S } else { 0.0 }) + (if half == Half::Pm { HALF_DAY_S } else { 0.0 })
            }
            (true, _) => return None,
        };
        left.next().is_none().then_some(shown_s + half_s)
    }
}

/// From midnight to noon, seconds.
const HALF_DAY_S: f64 = 43_200.0;

/// Why `format` is no clock format, if so.
fn fault(format: &str) -> Option<String> {
    let groups: Vec<(char, usize)> = format
        .chars()
        .fold(Vec::new(), |mut groups, c| {
            match groups.last_mut() {
                Some((last, count)) if *last == c => *count += 1,
                _ => groups.push((c, 1)),
            }
            groups
        })
        .into_iter()
        .filter(|(c, _)| c.is_alphanumeric())
        .collect();
    let halves: Vec<usize> = (0..groups.len()).filter(|&k| groups[k].0 == HALF).collect();
    let ends = halves.iter().all(|&k| k == 0 || k + 1 == groups.len());
    let fits = halves.len() <= 1 && halves.iter().all(|&k| groups[k].1 == 1);
    let groups: Vec<(char, usize)> = groups.into_iter().filter(|(c, _)| *c != HALF).collect();
    let hours = groups.first().is_some_and(|&(c, count)| c == 'h' && count <= 2);
    const UNITS: [char; 4] = ['h', 'm', 's', 't'];
    let help = "write the digits as `h`, `m`, `s` and `t` (tenths and finer), such as \"mm:ss.t\", and AM or PM \
                as `a`, such as \"hh:mm:ss a\"";
    if !(halves.is_empty() || ends && fits && hours) {
        return Some(format!(
            "`a` (AM or PM) stands once, before or after all digits, of which the first are hours; {help}"
        ));
    }
    if let Some((c, _)) = groups.iter().find(|(c, _)| !UNITS.contains(c)) {
        return Some(format!("`{c}` is no digit of a clock format; {help}"));
    }
    if format.chars().any(char::is_control) {
        return Some(format!("a clock format is one line of digits and marks; {help}"));
    }
    if groups.is_empty() {
        return Some(format!("a clock format needs digits; {help}"));
    }
    let place = |c: char| UNITS.iter().position(|&u| u == c).unwrap_or(0);
    for pair in groups.windows(2) {
        let [(a, _), (b, count)] = [pair[0], pair[1]];
        if place(b) != place(a) + 1 {
            return Some(format!(
                "`{b}` can't follow `{a}` in a clock format; the order is h, m, s, t with none between left out"
            ));
        }
        if b != 't' && count != 2 {
            return Some(format!(
                "`{b}` stands {count} time(s) after `{a}`; minutes and seconds that follow have two digits"
            ));
        }
    }
    match groups[0] {
        ('t', _) => Some("`t` needs the seconds before it; write \"s.t\"".to_owned()),
        // Readings are 64-bit numbers of nanoseconds: ten million hours have no room.
        _ if groups.iter().any(|&(c, count)| count > if c == 't' { 9 } else { 6 }) => {
            Some("more than 6 digits of one unit, or 9 behind the point; shorten it".to_owned())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clock_formats_parse_and_others_are_refused() {
        for good in [
            "mm:ss.t",
            "h:mm:ss",
            "hh:mm:ss.ttt",
            "s.tt",
            "sss",
            "mmm:ss",
            "hhmmss",
            "mm'ss\"tt",
            "hh:mm:ss a",
            "a h:mm",
            "h:mma",
        ] {
            assert!(ClockFormat::parse(good).is_ok(), "{good}");
        }
        for bad in [
            "",
            ":",
            "HH:mm",
            "mm:ss.f",
            "ss:mm",
            "hh:ss",
            "m:s",
            "t",
            "mm:ss:ss",
            "00:ss",
            "ss.t\n",
            "tttttttttt",
            "hhhhhhhhh:mm",
            "mm:ss a",
            "hh a:mm",
            "a hh:mm a",
            "hh:mm aa",
            "hhh:mm a",
            "a",
        ] {
            assert!(ClockFormat::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn digits_become_seconds_exactly() {
        let of = |format: &str, digits: &[u8]| ClockFormat::parse(format).unwrap().seconds(digits, None);
        assert_eq!(of("mm:ss.t", &[6, 2, 0, 3, 5]), Some(3723.5));
        assert_eq!(of("hh:mm:ss", &[2, 3, 5, 9, 5, 9]), Some(86_399.0));
        assert_eq!(of("hh:mm:ss.ttt", &[0, 0, 0, 0, 0, 1, 2, 0, 7]), Some(1.207));
        assert_eq!(of("ssss", &[3, 7, 2, 3]), Some(3723.0));
        // Tens of seconds below minutes end at 5; leading minutes may go on to 99.
        assert_eq!(of("mm:ss.t", &[0, 0, 6, 0, 0]), None);
        assert_eq!(of("mm:ss.t", &[9, 9, 5, 9, 9]), Some(5999.9));
        assert_eq!(of("mm:ss.t", &[0, 0, 0]), None);
    }

    #[test]
    fn a_day_of_twelve_hours_begins_with_twelve() {
        let format = ClockFormat::parse("hh:mm:ss a").unwrap();
        let of = |digits: [u8; 6], half| format.seconds(&digits, half);
        let day_s = 86_400.0;
        assert_eq!(of([1, 2, 0, 0, 0, 0], Some(Half::Am)), Some(0.0));
        assert_eq!(of([1, 1, 5, 9, 5, 9], Some(Half::Am)), Some(0.5 * day_s - 1.0));
        assert_eq!(of([1, 2, 0, 0, 0, 0], Some(Half::Pm)), Some(0.5 * day_s));
        assert_eq!(of([0, 1, 0, 0, 0, 0], Some(Half::Pm)), Some(13.0 * 3600.0));
        assert_eq!(of([1, 1, 5, 9, 5, 9], Some(Half::Pm)), Some(day_s - 1.0));
        for none in [of([1, 2, 0, 0, 0, 0], None), of([1, 3, 0, 0, 0, 0], Some(Half::Pm)), of([0; 6], Some(Half::Am))] {
            assert_eq!(none, None);
        }
        assert_eq!(format.wraps_s(), [day_s]);
        assert!(format.has_half() && !format.half_leads() && ClockFormat::parse("a h:mm").unwrap().half_leads());
    }

    #[test]
    fn resolution_and_wraps_follow_the_digits() {
        let of = |format: &str| ClockFormat::parse(format).unwrap();
        assert_eq!(
            (of("mm:ss.t").resolution_s(), of("ss.tt").resolution_s(), of("ss").resolution_s()),
            (0.1, 0.01, 1.0)
        );
        assert_eq!(of("hh:mm:ss").wraps_s(), [86_400.0, 43_200.0, 360_000.0]);
        assert_eq!(of("mm:ss").wraps_s(), [3600.0, 6000.0]);
        assert_eq!(of("sss.t").wraps_s(), [1000.0]);
    }
}
