//! Recordings: rows that are handed out when they are due.

use super::{Event, Feed, Sink, Step, Stream};
use crate::source::decoder::Decoder;
use crate::source::fault::SourceFault;
use crate::source::play::Waiting;
use crate::time::Verdict;
use crate::wire::{Decoded, Row};

/// The most rows that are handed out in a call.
const ROWS: u32 = 4096;

impl Stream {
    pub(super) fn poll_played(&mut self, now_ns: u64, on: &mut Sink<'_>) -> Result<(), SourceFault> {
        for _ in 0..ROWS {
            let Feed::Play(play) = &mut self.feed else { return Ok(()) };
            if let Some(row) = play.waiting {
                if row.due_ns > now_ns || play.holds(&row) {
                    return Ok(());
                }
                play.waiting = None;
                play.record(&row, now_ns);
                if !row.time_s.is_nan() {
                    play.played_s = row.time_s;
                }
                self.gaps.row(row.time_s, row.begins, self.step_s());
                self.health.row(now_ns);
                let Waiting { time_s, lit, lost, begins, .. } = row;
                let Decoded { values, texts, .. } = self.decoder.decoded();
                on.send(Event::Row(&Row { host_ns: now_ns, time_s, lit, lost, begins, values, texts }));
            }
            if on.is_over {
                return Ok(());
            }
            let step = match self.held.behind(&mut self.decoder) {
                Some(sample) => Some(Step::Sample(sample)),
                None => self.played_step(now_ns)?,
            };
            match step {
                Some(Step::Columns { again }) => self.columns(again, on)?,
                Some(Step::Spoilt(kind)) => self.spoilt(kind, on),
                Some(Step::Sample(sample)) => {
                    let sample = self.judge(&sample).map_or(sample, |(first, _)| first);
                    let (Some(sequence), Feed::Play(play)) = (&mut self.sequence, &mut self.feed) else { continue };
                    let before = sequence.counts();
                    let (time_s, lost, begins) = match sequence.take(&sample, now_ns) {
                        Verdict::Row { time_s, lost, begins } => (time_s, lost, begins),
                        Verdict::Doubtful => {
                            self.held.keep(sample, now_ns, &self.decoder);
                            continue;
                        }
                        Verdict::Duplicate | Verdict::Late => continue,
                    };
                    play.rows += 1;
                    let due_ns = play.due_ns(time_s, now_ns);
                    play.waiting = Some(Waiting { time_s, lit: sample.lit, lost, begins, due_ns, before });
                }
                None if self.rewound()? => {}
                None => {
                    self.end(on);
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// The next step of the recording; none at its end.
    fn played_step(&mut self, now_ns: u64) -> Result<Option<Step>, SourceFault> {
        let Feed::Play(play) = &mut self.feed else { return Ok(None) };
        let Some(file) = &mut play.file else {
            let Decoder::Table(table) = &mut self.decoder else { return Ok(None) };
            let failed = |what: String| SourceFault::Open { source_name: self.name.clone(), what };
            return table.next().map_err(failed);
        };
        loop {
            let mut left = file.left();
            let step = self.decoder.next(&mut left, now_ns);
            let left = left.len();
            file.used_to(left);
            let step = match step {
                Ok(None) if file.more()? => continue,
                Ok(None) => self.decoder.finish(now_ns),
                step => step,
            };
            return step.map_err(|fault| SourceFault::Wire { source_name: self.name.clone(), fault });
        }
    }

    /// Whether the recording begins again.
    fn rewound(&mut self) -> Result<bool, SourceFault> {
        let Feed::Play(play) = &mut self.feed else { return Ok(false) };
        if !play.looped || std::mem::take(&mut play.rows) == 0 {
            return Ok(false);
        }
        match (&mut play.file, &mut self.decoder) {
            (Some(file), decoder) => {
                file.rewind()?;
                decoder.cut(false);
            }
            (None, Decoder::Table(table)) => {
                let failed = |what: String| SourceFault::Open { source_name: self.name.clone(), what };
                table.rows.rewind().map_err(failed)?;
            }
            (None, _) => return Ok(false),
        }
        if let Some(sequence) = &mut self.sequence {
            sequence.begin();
        }
        Ok(true)
    }
}
