//! Jobs that write texts from texts, and what tests do with them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::super::{Input, Outcome, PipelineMark, RunOptions, RunReport, RunWatch, Share, Source, Task, run};
use crate::job::{Keys, Made, Maker, Work};
use crate::pipeline::store::hashes::{ContentHash, files_in};

/// What a toy does besides its text.
#[derive(Debug, Clone, Default)]
pub(super) enum Act {
    #[default]
    Nothing,
    Sleep(u64),
    Fail,
    Panic,
    /// Writes a file of so many bytes.
    Big(usize),
    /// Raises the flag, then waits until it is stopped.
    WaitForStop,
}

/// Writes `text.txt` and, in a folder, `deep/more.txt`: what its inputs hold, and its salt.
#[derive(Debug, Clone, Default)]
pub(super) struct Toy {
    pub(super) salt: u64,
    /// Tells only so many different things, so that changes before it may come to nothing.
    pub(super) blunt: Option<u64>,
    /// A second file, made only with an odd salt.
    pub(super) odd: bool,
    pub(super) act: Act,
    pub(super) diary: Diary,
    pub(super) id: String,
}

/// Which toys ran, and with how many threads.
pub(super) type Diary = Arc<Mutex<Vec<(String, usize)>>>;

pub(super) fn folder_and_diary() -> (tempfile::TempDir, Diary) {
    (tempfile::tempdir().unwrap(), Diary::default())
}

pub(super) fn ran(diary: &Diary) -> Vec<String> {
    let mut ran: Vec<String> = diary.lock().unwrap().drain(..).map(|(id, _)| id).collect();
    ran.sort();
    ran
}

impl Maker for Toy {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        self.diary.lock().unwrap().push((self.id.clone(), work.threads));
        match self.act {
            Act::Nothing => {}
            Act::Sleep(ms) => std::thread::sleep(Duration::from_millis(ms)),
            Act::Fail => anyhow::bail!("the toy is broken"),
            Act::Panic => panic!("the toy fell"),
            Act::Big(bytes) => fs::write(work.folder.join("big.bin"), vec![7; bytes])?,
            Act::WaitForStop => {
                while !work.stop.load(Ordering::Relaxed) {
                    std::thread::sleep(Duration::from_millis(1));
                }
                anyhow::bail!("stopped");
            }
        }
        let mut lines = Vec::new();
        for input in &work.inputs {
            let names = if input.path.is_dir() { files_in(&input.path)? } else { vec![String::new()] };
            for name in names {
                let path = if name.is_empty() { input.path.clone() } else { input.path.join(&name) };
                lines.push(format!(
                    "{} {} {}/{name} {}",
                    input.role,
                    input.keys,
                    input.name,
                    ContentHash::of(&fs::read(path)?)
                ));
            }
        }
        let all = ContentHash::of(lines.join("\n").as_bytes()).to_string();
        let text = match self.blunt {
            Some(few) => format!("{}", u64::from_str_radix(&all[..8], 16)? % few),
            None => format!("{}\n{}\n", self.salt, lines.join("\n")),
        };
        fs::write(work.folder.join("text.txt"), text)?;
        fs::create_dir(work.folder.join("deep"))?;
        fs::write(work.folder.join("deep/more.txt"), &all)?;
        if self.odd && self.salt % 2 == 1 {
            fs::write(work.folder.join("odd.txt"), format!("odd {}", self.salt))?;
        }
        Ok(Made { warnings: vec![format!("made of {} inputs", work.inputs.len())], ..Made::default() })
    }
}

pub(super) fn result(task: &str, name: &str) -> Input {
    let source = Source::Result { task: task.into(), name: name.into() };
    Input { role: "in", keys: Keys::default(), source, may_fail: false }
}

pub(super) fn given(folder: &Path, name: &str) -> Input {
    let source = Source::Given { path: folder.join(name), name: name.into() };
    Input { role: "in", keys: Keys::default(), source, may_fail: false }
}

impl Toy {
    pub(super) fn task(mut self, id: &str, inputs: Vec<Input>) -> Task {
        self.id = id.to_owned();
        Task {
            id: id.to_owned(),
            stage: id.split('/').next().unwrap_or_default().to_owned(),
            keys: Keys::default(),
            inputs,
            options: serde_json::json!({
                "job": "toy",
                "revision": 1,
                "options": { "salt": self.salt, "blunt": self.blunt },
            }),
            share: Share::Whole,
            memory: 0,
            cost_s: 1.0,
            job: Arc::new(self),
        }
    }
}

pub(super) fn toy(id: &str, salt: u64, inputs: Vec<Input>, diary: &Diary) -> Task {
    Toy { salt, diary: Arc::clone(diary), ..Toy::default() }.task(id, inputs)
}

pub(super) fn mark() -> PipelineMark {
    PipelineMark {
        name: "toys".into(),
        decides: ContentHash::of(b"toys"),
        path: "toys.toml".into(),
        text: "one\ntwo\n".into(),
    }
}

pub(super) fn options(threads: usize) -> RunOptions {
    RunOptions { threads, memory: u64::MAX, shard: None, pipeline: mark() }
}

pub(super) fn run_with(tasks: &[Task], out: &Path, options: &RunOptions) -> RunReport {
    let watch = RunWatch { stop: &AtomicBool::new(false), tick: &|_| {} };
    run(tasks, out, options, &watch).unwrap()
}

pub(super) fn run_on(tasks: &[Task], out: &Path) -> RunReport {
    run_with(tasks, out, &options(2))
}

/// How it went, task by task: `done`, `kept`, `failed`, `not done`, `elsewhere`.
pub(super) fn outcomes(report: &RunReport) -> Vec<&'static str> {
    let word = |outcome: &Outcome| match outcome {
        Outcome::Done => "done",
        Outcome::Kept => "kept",
        Outcome::Failed(_) => "failed",
        Outcome::NotDone(_) => "not done",
        Outcome::Elsewhere => "elsewhere",
    };
    report.tasks.iter().map(|task| word(&task.outcome)).collect()
}

/// All files of results with what they hold, without what is kept of edits.
pub(super) fn results(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let ours = |name: &String| !name.starts_with(".lunula/") && !name.contains(".edited");
    let names = files_in(out).unwrap().into_iter().filter(ours);
    names.map(|name| (name.clone(), fs::read(out.join(&name)).unwrap())).collect()
}

/// What the tasks make, made in a folder of its own by one thread.
pub(super) fn from_scratch(tasks: &[Task]) -> BTreeMap<String, Vec<u8>> {
    let out = tempfile::tempdir().unwrap();
    run_with(tasks, out.path(), &options(1));
    results(out.path())
}

/// Folders of tasks at work that were left behind.
pub(super) fn left_at_work(out: &Path) -> Vec<PathBuf> {
    fs::read_dir(out.join(".lunula/work")).unwrap().map(|entry| entry.unwrap().path()).collect()
}
