//! Events as lines of JSON: `{"t":1.25,"event":"move","dx":1,"dy":0}`.

use std::io::{self, Write};

use super::super::event::Event;

/// No event's line is longer, bytes: a time and two forces of 24 digits, and words.
const LONGEST: usize = 160;

/// A writer of lines. A line is handed to the writer whole; nothing is allocated for it.
#[derive(Debug)]
pub struct JsonLines<W> {
    to: W,
    line: Vec<u8>,
}

impl<W: Write> JsonLines<W> {
    /// Lines go to `to`, which is better buffered where many come.
    pub fn new(to: W) -> Self {
        Self { to, line: Vec::with_capacity(LONGEST) }
    }

    /// Writes one line.
    ///
    /// # Errors
    /// The writer's.
    pub fn write(&mut self, event: &Event) -> io::Result<()> {
        self.line.clear();
        serde_json::to_writer(&mut self.line, event)?;
        self.line.push(b'\n');
        self.to.write_all(&self.line)
    }

    /// Hands on what a buffer holds.
    ///
    /// # Errors
    /// The writer's.
    pub fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }

    /// The writer.
    pub fn into_inner(self) -> W {
        self.to
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::event::{Button, Reason};
    use super::*;

    const EVENTS: [(Event, &str); 8] = [
        (Event::Move { t_s: 1.25, dx: 1, dy: 0 }, r#"{"t":1.25,"event":"move","dx":1,"dy":0}"#),
        (
            Event::Button { t_s: 2.0, button: Button::Left, down: true },
            r#"{"t":2.0,"event":"button","button":"left","down":true}"#,
        ),
        (Event::Scroll { t_s: 0.1, lines: -3 }, r#"{"t":0.1,"event":"scroll","lines":-3}"#),
        (Event::Zero { t_s: 3.5, fx_n: 0.02, fy_n: -0.01 }, r#"{"t":3.5,"event":"zero","Fx_N":0.02,"Fy_N":-0.01}"#),
        (Event::Drag { t_s: 3.5, fx_n: 0.5, fy_n: 0.25 }, r#"{"t":3.5,"event":"drag","Fx_N":0.5,"Fy_N":0.25}"#),
        (Event::Ready { t_s: 0.0 }, r#"{"t":0.0,"event":"ready"}"#),
        (Event::Lost { t_s: 9.0, reason: Reason::Watchdog }, r#"{"t":9.0,"event":"lost","reason":"watchdog"}"#),
        (
            Event::Move { t_s: -1.234_567_890_123_456_7e-300, dx: i32::MIN, dy: i32::MAX },
            r#"{"t":-1.2345678901234568e-300,"event":"move","dx":-2147483648,"dy":2147483647}"#,
        ),
    ];

    #[test]
    fn every_event_is_a_line() {
        let mut lines = JsonLines::new(Vec::new());
        EVENTS.iter().for_each(|(event, _)| lines.write(event).unwrap());
        let text = String::from_utf8(lines.into_inner()).unwrap();
        let expected: Vec<&str> = EVENTS.iter().map(|(_, line)| *line).collect();
        assert_eq!(text.lines().collect::<Vec<_>>(), expected);
        assert!(text.ends_with('\n') && text.lines().all(|line| line.len() < LONGEST));
    }

    #[test]
    fn nothing_is_allocated_for_a_line() {
        let mut lines = JsonLines::new(io::sink());
        let counted = allocation_counter::measure(|| {
            for _ in 0..100 {
                EVENTS.iter().for_each(|(event, _)| lines.write(event).unwrap());
            }
        });
        assert_eq!(counted.count_total, 0);
    }

    #[test]
    fn a_writer_that_fails_says_so() {
        let mut full: [u8; 10] = [0; 10];
        let mut lines = JsonLines::new(&mut full[..]);
        assert_eq!(lines.write(&EVENTS[0].0).unwrap_err().kind(), io::ErrorKind::WriteZero);
    }
}
