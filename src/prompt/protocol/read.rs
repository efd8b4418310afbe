//! Reads a protocol's file: every fault with its line.

use std::path::{Path as FilePath, PathBuf};

use lunula_predictor::{Bending, ForceSpace, RandomBending, RandomForce, Spiral};
use toml::de::DeValue;

use super::motion::{Gauge, GaugeAxis, Motion, Path};
use super::{Check, Protocol, Step, StepKind};
use crate::toml_file::{Entry, Fault, Findings, entries};
use crate::words::{Words, instead};

/// Steps that anybody has patience for.
const MOST_STEPS: usize = 200;
/// Points of a path, and letters of a text.
const MOST_POINTS: usize = 10_000;
const MOST_TEXT: usize = 400;
/// The longest movement, seconds.
const MOST_S: f64 = 3600.0;

/// Why there is no protocol.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum ProtocolError {
    #[error("{}: {why} (`lunula prompt --write-protocol FILE` writes one to start from)", path.display())]
    Unreadable { path: PathBuf, why: std::io::Error },
    #[error(
        "{}",
        faults.iter().map(|f| format!("{}:{}: {}", path.display(), f.line, f.what)).collect::<Vec<_>>().join("\n")
    )]
    Faults {
        path: PathBuf,
        /// In the order of lines, at least one.
        faults: Vec<Fault>,
    },
}

/// A kind, and the keys that only it has.
const KINDS: [(&str, &[&str]); 8] = [
    ("ask", &[]),
    ("check", &[]),
    ("rest", &["seconds"]),
    ("spiral", &["seconds", "fs_per_N", "fc_Hz", "soft_start_s"]),
    ("random", &["seconds", "hz", "seed", "soft_start_s"]),
    ("gauge", &["axis", "cycles", "hz", "newtons", "held_N"]),
    ("bending", &["seconds", "hz", "random", "seed"]),
    ("path", &["points"]),
];
/// The keys that every step has.
const COMMON: [&str; 7] = ["kind", "name", "text", "collect", "starts", "session", "checks"];
/// When a step begins.
const STARTS: [&str; 2] = ["space", "at once"];

impl Protocol {
    /// Reads a file.
    ///
    /// # Errors
    /// A file that can't be read, or all its faults.
    pub fn read(path: &FilePath) -> Result<Self, ProtocolError> {
        let unreadable = |why| ProtocolError::Unreadable { path: path.to_owned(), why };
        let bytes = crate::input::read(path).map_err(unreadable)?;
        let text = String::from_utf8(bytes)
            .map_err(|_| unreadable(std::io::Error::new(std::io::ErrorKind::InvalidData, "not UTF-8 text")))?;
        Self::parse(&text, path)
    }

    /// Reads a text; `path` is for the messages.
    ///
    /// # Errors
    /// All its faults.
    pub fn parse(text: &str, path: &FilePath) -> Result<Self, ProtocolError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut findings = Findings::new(text);
        let protocol = findings.parse().and_then(|table| protocol(&mut findings, &entries(table.get_ref())));
        let refused = |faults| ProtocolError::Faults { path: path.to_owned(), faults };
        findings.finish().map_err(refused)?;
        let nothing = || refused(vec![Fault { line: 1, column: 1, what: "is no protocol".to_owned() }]);
        protocol.ok_or_else(nothing)
    }
}

fn protocol(findings: &mut Findings<'_>, all: &[Entry<'_>]) -> Option<Protocol> {
    findings.unknown_keys(all, &["fz_max_N", "mu", "step"], "key");
    let usual = ForceSpace::default();
    let mut keys = Keys { findings, all };
    let fz_max_n = keys.number("fz_max_N", usual.fz_max_n(), 0.01..=100.0);
    let mu = keys.number("mu", usual.mu(), 0.01..=10.0);
    let space = ForceSpace::new(fz_max_n, mu).unwrap_or_default();
    let Some(list) = all.iter().find(|e| e.key == "step") else {
        findings.fault(0, "has no step; write [[step]] and its lines below");
        return None;
    };
    let Some(tables) = list.value.as_array() else {
        findings.fault(list.key_at, "`step` is no list of tables; write [[step]], with two brackets");
        return None;
    };
    if tables.len() > MOST_STEPS {
        findings.fault(list.key_at, format!("{} steps; {MOST_STEPS} are the most", tables.len()));
        return None;
    }
    let mut steps = Vec::new();
    for table in tables.iter() {
        let at = table.span().start;
        match table.get_ref() {
            DeValue::Table(table) => steps.extend(step(findings, &entries(table), at, &space)),
            _ => findings.fault(at, "a step is a table; write [[step]] and its lines below"),
        }
    }
    if steps.is_empty() && findings.is_empty() {
        findings.fault(list.key_at, "has no step; write [[step]] and its lines below");
    }
    Some(Protocol { space, steps })
}

fn step(findings: &mut Findings<'_>, all: &[Entry<'_>], at: usize, space: &ForceSpace) -> Option<Step> {
    let names: Vec<&str> = KINDS.iter().map(|kind| kind.0).collect();
    let Some(entry) = all.iter().find(|e| e.key == "kind") else {
        findings.fault(at, format!("this step has no `kind`; {}", instead("", &names)));
        return None;
    };
    let Some((kind, own)) = KINDS.iter().find(|kind| entry.value.as_str() == Some(kind.0)) else {
        let word = entry.value.as_str().unwrap_or_default();
        findings.fault(entry.at, format!("unknown kind of step `{word}`; {}", instead(word, &names)));
        return None;
    };
    let known: Vec<&str> = COMMON.iter().chain(*own).copied().collect();
    findings.unknown_keys(all, &known, &format!("key of a step of kind `{kind}`"));
    let mut keys = Keys { findings, all };
    let step_kind = keys.kind(kind, at, space);
    let moves = matches!(step_kind, StepKind::Move(_));
    let name = keys.text("name", kind, 40);
    if name.chars().any(|c| ",\"\r\n".contains(c)) || name.trim().is_empty() {
        keys.fault("name", at, "a name is a word or some, without commas, quotes and line breaks");
    }
    let waits = keys.text("starts", STARTS[0], MOST_TEXT);
    if !STARTS.contains(&waits.as_str()) {
        keys.fault("starts", at, &format!("`starts` is {}", STARTS.map(|word| format!("\"{word}\"")).join(" or ")));
    }
    let collects = keys.yes("collect", moves);
    if collects && !moves {
        keys.fault("collect", at, "nothing is collected where nothing moves; leave `collect` out");
    }
    let session = keys.whole("session", 1, 1..=10_000);
    let checks = keys.checks(kind, at, moves);
    let text = keys.text("text", "", MOST_TEXT);
    Some(Step { name, text, kind: step_kind, collects, waits: waits == STARTS[0], session, checks })
}

/// A table's keys, with defaults for what is left out.
struct Keys<'f, 'a, 'b> {
    findings: &'f mut Findings<'a>,
    all: &'f [Entry<'b>],
}

impl<'b> Keys<'_, '_, 'b> {
    fn entry(&self, key: &str) -> Option<Entry<'b>> {
        self.all.iter().find(|e| e.key == key).copied()
    }

    fn fault(&mut self, key: &str, at: usize, what: &str) {
        let at = self.entry(key).map_or(at, |entry| entry.at);
        self.findings.fault(at, what);
    }

    fn number(&mut self, key: &str, default: f64, range: std::ops::RangeInclusive<f64>) -> f64 {
        let Some(entry) = self.entry(key) else { return default };
        let Some(value) = self.findings.number(entry) else { return default };
        if range.contains(&value) {
            return value;
        }
        self.findings.fault(entry.at, format!("{key} = {value}: choose {} to {}", range.start(), range.end()));
        default
    }

    fn whole(&mut self, key: &str, default: u32, range: std::ops::RangeInclusive<u32>) -> u32 {
        let (low, high) = (f64::from(*range.start()), f64::from(*range.end()));
        let value = self.number(key, f64::from(default), low..=high);
        if value.fract() != 0.0 {
            self.fault(key, 0, &format!("{key} = {value}: write a whole number"));
        }
        value as u32
    }

    fn yes(&mut self, key: &str, default: bool) -> bool {
        let Some(entry) = self.entry(key) else { return default };
        match entry.value {
            DeValue::Boolean(yes) => *yes,
            _ => {
                self.findings.fault(entry.at, format!("`{key}` is true or false"));
                default
            }
        }
    }

    fn text(&mut self, key: &str, default: &str, most: usize) -> String {
        let Some(entry) = self.entry(key) else { return default.to_owned() };
        match entry.value.as_str() {
            Some(text) if text.chars().count() <= most => text.to_owned(),
            Some(_) => {
                self.findings.fault(entry.at, format!("`{key}` is longer than {most} letters"));
                default.to_owned()
            }
            None => {
                self.findings.fault(entry.at, format!("`{key}` has to be a text in quotes"));
                default.to_owned()
            }
        }
    }

    fn checks(&mut self, kind: &str, at: usize, moves: bool) -> Vec<Check> {
        let mut checks = Vec::new();
        let Some(entry) = self.entry("checks") else {
            if kind == "check" {
                self.findings
                    .fault(at, "this step checks nothing; write checks = [\"photodiodes\", \"tare\", \"sign\"]");
            }
            return checks;
        };
        let words =
            entry.value.as_array().map(|list| list.iter().map(|one| one.get_ref().as_str()).collect::<Vec<_>>());
        for word in words.unwrap_or_else(|| vec![None]) {
            let check = word.ok_or_else(|| "`checks` is a list of texts".to_owned()).and_then(Check::by_word);
            let fits = |check: Check| match check {
                Check::Adhesion => moves,
                Check::Photodiodes => moves || kind == "check",
                Check::Tare | Check::Sign => kind == "check",
            };
            match check {
                Ok(check) if fits(check) => checks.push(check),
                Ok(Check::Adhesion) => self.findings.fault(entry.at, "`adhesion` is checked while the finger moves"),
                Ok(check) => {
                    let what = format!("`{}` is checked in a step of kind \"check\"", check.word());
                    self.findings.fault(entry.at, what);
                }
                Err(what) => self.findings.fault(entry.at, what),
            }
        }
        // The finger is lifted before it presses.
        checks.sort_unstable();
        checks.dedup();
        checks
    }

    fn kind(&mut self, kind: &str, at: usize, space: &ForceSpace) -> StepKind {
        let seconds = |keys: &mut Self, default: f64| keys.number("seconds", default, 1.0..=MOST_S);
        let (spiral, bending) = (Spiral::default(), Bending::default());
        let (seconds, path) = match kind {
            "ask" => return StepKind::Ask,
            "check" => return StepKind::Check,
            "rest" => (seconds(self, 10.0), Path::Rest),
            "spiral" => {
                let duration_s = seconds(self, spiral.duration_s);
                let path = Spiral {
                    fz_max_n: space.fz_max_n(),
                    mu: space.mu(),
                    duration_s,
                    fs_per_n: self.number("fs_per_N", spiral.fs_per_n, 0.01..=100.0),
                    fc_hz: self.number("fc_Hz", spiral.fc_hz, 0.001..=10.0),
                    soft_s: self.number("soft_start_s", spiral.soft_s.min(duration_s), 0.0..=duration_s),
                };
                (duration_s, Path::Spiral(path))
            }
            "random" => {
                let seconds = seconds(self, 100.0);
                let soft_s = self.number("soft_start_s", seconds.min(5.0), 0.0..=seconds);
                let (hz, seed) = (self.number("hz", 0.03, 0.001..=10.0), self.whole("seed", 1, 0..=u32::MAX));
                let random = RandomForce::even(*space, hz, u64::from(seed)).out_of_rest(soft_s, seconds);
                (seconds, Path::Random(Box::new(random)))
            }
            "gauge" => return self.gauge(at, space),
            "bending" => {
                let seconds = seconds(self, Bending::PROTOCOL_S);
                let (hz, seed) = (self.number("hz", bending.hz, 0.001..=10.0), self.whole("seed", 1, 0..=u32::MAX));
                let random = self.yes("random", false);
                let path = if random {
                    Path::RandomBending(RandomBending::new(hz, seconds.min(2.0), u64::from(seed)))
                } else {
                    Path::Bending(Bending { hz })
                };
                (seconds, path)
            }
            _ => self.points(at, space),
        };
        StepKind::Move(Motion { seconds, path })
    }

    fn gauge(&mut self, at: usize, space: &ForceSpace) -> StepKind {
        let axis = GaugeAxis::by_word(&self.text("axis", "", MOST_TEXT)).unwrap_or_else(|what| {
            self.fault("axis", at, &format!("axis: {what}"));
            GaugeAxis::Normal
        });
        let hz = self.number("hz", 0.05, 0.001..=10.0);
        let cycles = self.whole("cycles", 5, 1..=1000);
        let newtons = self.number("newtons", if axis == GaugeAxis::Normal { 4.0 } else { 2.0 }, 0.01..=100.0);
        let held_n = self.number("held_N", 3.0, 0.01..=100.0);
        if axis != GaugeAxis::Normal && newtons > space.mu() * held_n {
            let most_n = space.mu() * held_n;
            self.fault("newtons", at, &format!("{newtons} N of shear slip: friction holds {most_n} N at {held_n} N"));
        }
        let seconds = f64::from(cycles) / hz;
        if seconds > MOST_S {
            self.fault("cycles", at, &format!("{cycles} cycles take {seconds} s; {MOST_S} s are the most"));
        }
        StepKind::Move(Motion { seconds, path: Path::Gauge(Gauge { axis, newtons, held_n, hz }) })
    }

    fn points(&mut self, at: usize, space: &ForceSpace) -> (f64, Path) {
        let nothing = (1.0, Path::Rest);
        let Some(entry) = self.entry("points") else {
            self.findings.fault(at, "a path needs `points`: points = [[0, 0, 0, 0], [2, 0.1, 0, -1], ..]");
            return nothing;
        };
        let shape = "`points` is a list of [time_s, Fx_N, Fy_N, Fz_N]";
        let Some(list) = entry.value.as_array() else {
            self.findings.fault(entry.at, shape);
            return nothing;
        };
        let mut points: Vec<[f64; 4]> = Vec::new();
        for point in list.iter().take(MOST_POINTS + 1) {
            let at = point.span().start;
            let numbers = self.findings.numbers(Entry { key: "points", key_at: at, value: point.get_ref(), at }, shape);
            let Ok(point) = <[f64; 4]>::try_from(numbers.unwrap_or_default()) else {
                self.findings.fault(at, shape);
                return nothing;
            };
            if points.last().map_or(point[0] != 0.0, |last| point[0] <= last[0]) {
                self.findings.fault(at, "times of `points` begin at 0 and ascend");
                return nothing;
            }
            if point[3] > 0.0 {
                self.findings.fault(at, "pressing is a negative Fz_N");
                return nothing;
            }
            let [_, fx_n, fy_n, fz_n] = point;
            let (shear_n, held_n) = (fx_n.hypot(fy_n), fz_n.abs());
            if shear_n > space.mu() * held_n + 1e-9 {
                let most_n = space.mu() * held_n;
                self.findings.fault(at, format!("{shear_n} N of shear slip: friction holds {most_n} N at {held_n} N"));
                return nothing;
            }
            points.push(point);
        }
        let last_s = points.last().map_or(0.0, |last| last[0]);
        if points.len() > MOST_POINTS || !(1.0..=MOST_S).contains(&last_s) {
            self.findings.fault(entry.at, format!("a path takes 1 to {MOST_S} s and has {MOST_POINTS} points at most"));
            return nothing;
        }
        (last_s, Path::Points(points))
    }
}
