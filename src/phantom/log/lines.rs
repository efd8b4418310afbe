//! The rows of `log.csv`: its columns, and what a row says in them.

use super::{LogOptions, Row, Stamps};
use crate::table::{Column, Value};

/// The transducer's columns.
pub(super) const FORCES: [&str; 3] = ["Fx_N", "Fy_N", "Fz_N"];
/// The column of an ideal switch under the finger.
pub(super) const CONTACT: &str = "contact";
/// Decimals of stamps, of readings (a step of the converter is 0.00015 V) and of forces (steps of 0.0008 N).
const STAMP_DECIMALS: usize = 6;
const READING_DECIMALS: usize = 6;
const FORCE_DECIMALS: usize = 4;

/// The photodiodes' columns, each with `suffix` behind its name.
pub(super) fn photodiodes(options: &LogOptions, suffix: &str) -> Vec<String> {
    options.names().into_iter().map(|name| name + suffix).collect()
}

pub(super) fn columns(options: &LogOptions) -> Vec<Column> {
    let mut columns = vec![match options.stamps {
        Stamps::Seconds | Stamps::Epoch => Column::rounded("time_s", STAMP_DECIMALS),
        Stamps::Datetime => Column::text("time"),
    }];
    if options.led {
        columns.push(Column::integer("led"));
    }
    columns.extend(photodiodes(options, "").into_iter().map(|name| Column::rounded(name, READING_DECIMALS)));
    if options.forces {
        columns.extend(FORCES.map(|name| Column::rounded(name, FORCE_DECIMALS)));
    }
    if options.contact {
        columns.push(Column::integer(CONTACT));
    }
    columns
}

/// What a row says in them; `date` is where its date is written.
pub(super) fn cells<'a>(options: &LogOptions, row: &Row, date: &'a mut String) -> Vec<Value<'a>> {
    let mut cells = vec![match options.stamps {
        Stamps::Seconds => Value::Number(row.stamp_s),
        Stamps::Epoch => Value::Number(LogOptions::MIDNIGHT_S as f64 + row.stamp_s),
        Stamps::Datetime => {
            *date = date_and_time(row.stamp_s);
            Value::Text(date)
        }
    }];
    if options.led {
        cells.push(Value::Integer(row.lit.into()));
    }
    cells.extend(row.read_v[..options.channels()].iter().copied().map(Value::Number));
    if options.forces {
        cells.extend(row.forces_read_n.map(Value::Number));
    }
    if options.contact {
        cells.push(Value::Integer(row.contact.into()));
    }
    cells
}

/// The date and time of day that a clock shows at `clock_s` seconds from the midnight of [`LogOptions::DATE`] on.
fn date_and_time(clock_s: f64) -> String {
    let (year, month, day) = LogOptions::DATE;
    let since = jiff::SignedDuration::from_micros((clock_s * 1e6).round() as i64);
    let shown = jiff::civil::date(year, month, day).at(0, 0, 0, 0).saturating_add(since);
    format!("{shown:.6}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_is_followed_by_the_next() {
        assert_eq!(date_and_time(0.0), "2026-03-14T00:00:00.000000");
        assert_eq!(date_and_time(86_399.999_999_6), "2026-03-15T00:00:00.000000");
        assert_eq!(date_and_time(-0.25), "2026-03-13T23:59:59.750000");
        assert_eq!(date_and_time(34_013.589_793), "2026-03-14T09:26:53.589793");
        assert_eq!(date_and_time(86_400.0 * (365.0 + 365.0 - 14.0)), "2028-02-28T00:00:00.000000");
        assert_eq!(date_and_time(86_400.0 * (365.0 + 365.0 - 13.0)), "2028-02-29T00:00:00.000000");
    }
}
