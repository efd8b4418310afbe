//! A file's rows into recordings: a new one where session, subject or trajectory change, or time goes back. Rows that
//! are not used for want of a target are the past of the next one that is, where both are of one part.

use std::mem;

use lunula_predictor::{Past, Recording};

use super::DataFile;
use super::source::Source;

/// Takes the used rows of a file, ascending.
pub(super) struct Splitter<'a> {
    source: &'a Source,
    called: &'a DataFile,
    /// Rows of the files before, and those taken so far.
    taken: usize,
    /// Which change of the groups the last row belongs to.
    group: Option<usize>,
    last_s: f64,
    /// Where each recording begins, and its group.
    starts: Vec<(usize, Option<usize>)>,
    /// Where time went back: from, to.
    resets: Vec<[f64; 2]>,
    /// Rows that were passed over since the last that was taken.
    passed: Vec<usize>,
    past: Past,
}

impl<'a> Splitter<'a> {
    /// For a file, as it is called, after `before` rows of others.
    pub(super) fn new(source: &'a Source, called: &'a DataFile, before: usize) -> Self {
        Self {
            source,
            called,
            taken: before,
            group: None,
            last_s: f64::NAN,
            starts: Vec::new(),
            resets: Vec::new(),
            passed: Vec::new(),
            past: Past::default(),
        }
    }

    /// Passes over a row that has no targets, and whose voltages are none the less what the sensor said.
    pub(super) fn pass(&mut self, row: usize) {
        self.passed.push(row);
    }

    pub(super) fn take(&mut self, row: usize) {
        let groups = &self.source.groups;
        let mut group = self.group.or((!groups.is_empty()).then_some(0));
        while let Some(next) = group.map(|k| k + 1).filter(|&next| groups.get(next).is_some_and(|g| g.0 <= row)) {
            group = Some(next);
        }
        let time_s = self.source.time_s[row];
        let changed = self.group != group || self.starts.is_empty();
        // Unknown times are passed over.
        let back = time_s < self.last_s;
        if changed || back {
            self.starts.push((self.taken, group));
            if back && !changed {
                self.resets.push([self.last_s, time_s]);
            }
            self.last_s = f64::NAN;
        }
        if !time_s.is_nan() {
            self.last_s = time_s;
        }
        let since = group.map_or(0, |k| groups[k].0);
        for passed in mem::take(&mut self.passed).into_iter().filter(|&passed| passed >= since) {
            self.past.before.push(self.taken);
            self.past.time_s.push(self.source.time_s[passed]);
            self.past.x.extend(self.source.x.iter().map(|column| column[passed]));
        }
        self.group = group;
        self.taken += 1;
    }

    /// The recordings, and what came before their rows; warns where time went back.
    pub(super) fn finish(self, recordings: &mut Vec<Recording>, past: &mut Past, warnings: &mut Vec<String>) {
        past.before.extend(self.past.before);
        past.time_s.extend(self.past.time_s);
        past.x.extend(self.past.x);
        let DataFile { path, name: file, session: own_session, subject: own_subject } = self.called;
        let several = self.starts.len() > 1;
        for (k, &(start, group)) in self.starts.iter().enumerate() {
            let end = self.starts.get(k + 1).map_or(self.taken, |next| next.0);
            let [session, subject, trajectory] = group.map(|g| self.source.groups[g].1.clone()).unwrap_or_default();
            let or_own = |name: String, own: &Option<String>| match own {
                _ if !name.is_empty() => name,
                Some(own) => own.clone(),
                None => file.clone(),
            };
            let (session, subject) = (or_own(session, own_session), or_own(subject, own_subject));
            let name = match (trajectory.is_empty(), several) {
                (false, _) => format!("{file} ({trajectory})"),
                (true, true) => format!("{file} #{}", k + 1),
                (true, false) => file.clone(),
            };
            recordings.push(Recording { name, session, subject, rows: start..end });
        }
        let groups = || self.starts.iter().filter_map(|(_, group)| Some(&self.source.groups[(*group)?].1));
        for (key, place, own) in [("session", 0, own_session), ("subject", 1, own_subject)] {
            let Some(own) = own else { continue };
            let other = groups().map(|group| &group[place]).find(|said| !said.is_empty() && *said != own);
            warnings.extend(other.map(|said| {
                format!(
                    "{}: its column `{key}` says `{said}`, which is taken, and it was given as that of `{own}`: is it \
                     in the right place?",
                    path.display()
                )
            }));
        }
        if let Some([from, to]) = self.resets.first() {
            let count = self.resets.len();
            let times = if count == 1 { "once".to_owned() } else { format!("{count} times, first") };
            warnings.push(format!(
                "{}: `time_s` goes back {times} from {from} to {to} s; a new recording begins there",
                path.display()
            ));
        }
    }
}
