//! The stages of a job: which will run and why not, and how long each took.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Time spent by stage, summed over threads, and since this was made. Stages are listed in the order in which they
/// first ran.
#[derive(Debug)]
pub struct Stages {
    begun: Instant,
    spent: Mutex<BTreeMap<&'static str, (usize, Duration, u64)>>,
}

/// One stage's share.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Stage {
    /// As the report calls it.
    pub stage: Cow<'static, str>,
    /// Seconds, summed over threads.
    pub thread_s: f64,
    /// How often it ran.
    pub runs: u64,
}

impl Default for Stages {
    fn default() -> Self {
        Self { begun: Instant::now(), spent: Mutex::default() }
    }
}

impl Stages {
    /// Seconds since the first of them could begin.
    pub fn wall_s(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Runs `work` as part of `stage`.
    pub fn time<T>(&self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.add(stage, start.elapsed(), 1);
        result
    }

    /// What was spent on `stage` elsewhere, in so many runs.
    pub fn add(&self, stage: &'static str, took: Duration, runs: u64) {
        let mut spent = self.spent.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let rank = spent.len();
        let entry = spent.entry(stage).or_insert((rank, Duration::ZERO, 0));
        entry.1 += took;
        entry.2 += runs;
    }

    /// What was spent so far.
    pub fn list(&self) -> Vec<Stage> {
        let spent = self.spent.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let mut ranked: Vec<_> = spent.iter().map(|(&stage, &(rank, time, runs))| (rank, stage, time, runs)).collect();
        ranked.sort_unstable();
        ranked
            .into_iter()
            .map(|(_, stage, time, runs)| Stage { stage: stage.into(), thread_s: time.as_secs_f64(), runs })
            .collect()
    }
}

/// Whether a stage will run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// It will.
    Run,
    /// The scene does not need it.
    LeftOut,
}

/// One stage of a plan.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Step {
    /// As the report calls it.
    pub stage: &'static str,
    /// Whether it runs.
    pub fate: Fate,
    /// On how much, or why not.
    pub reason: String,
}

impl Step {
    /// A stage that runs or not, on how much or why not.
    pub fn new(stage: &'static str, runs: bool, reason: String) -> Self {
        Self { stage, fate: if runs { Fate::Run } else { Fate::LeftOut }, reason }
    }

    /// The pictures of a job; `what` they show.
    pub fn figures(drawn: bool, what: &str) -> Self {
        Self::new("figures", drawn, if drawn { what } else { "not asked for" }.to_owned())
    }
}

/// What of a plan does not run, and why, a line each as reports tell it.
pub fn left_out(steps: impl IntoIterator<Item = Step>) -> Vec<String> {
    let left_out = steps.into_iter().filter(|step| step.fate == Fate::LeftOut);
    left_out.map(|step| format!("{}: {}", step.stage, step.reason)).collect()
}
