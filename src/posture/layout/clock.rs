//! What the marker file says of the digital clock in the picture.

/// A digital clock in the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Where it is.
    pub roi: ClockRoi,
    /// What its digits mean: `h`, `m`, `s` a digit of hours, minutes, seconds, `t` tenths and finer; anything else is written
    /// as it is. Such as `mm:ss.t`.
    pub format: String,
}

/// Where the clock is on the shown picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClockRoi {
    /// To be looked for.
    Auto,
    /// x, y of the top-left corner, width, height.
    Box([f64; 4]),
}

/// Why `format` is no clock format, if so.
pub(super) fn format_fault(format: &str) -> Option<String> {
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
    const UNITS: [char; 4] = ['h', 'm', 's', 't'];
    let help = "write the digits as `h`, `m`, `s` and `t` (tenths and finer), such as \"mm:ss.t\"";
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
        // Readings become 64-bit floating-point seconds.
        _ if groups.iter().any(|&(_, count)| count > 9) => {
            Some("more than 9 digits of one unit; shorten it".to_owned())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_of_clocks_are_told_from_others() {
        for good in ["mm:ss.t", "h:mm:ss", "hh:mm:ss.ttt", "s.tt", "sss", "mmm:ss", "hhmmss", "mm'ss\"tt"] {
            assert_eq!(format_fault(good), None, "{good}");
        }
        for bad in
            ["", ":", "HH:mm", "mm:ss.f", "ss:mm", "hh:ss", "m:s", "t", "mm:ss:ss", "00:ss", "ss.t\n", "tttttttttt"]
        {
            assert!(format_fault(bad).is_some(), "{bad}");
        }
    }
}
