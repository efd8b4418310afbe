//! Scripts in Python: written to a folder that goes away, run on one thread, answered in lines of JSON.

use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};
use serde::Deserialize;

use super::{PeerReport, REQUIREMENTS};
use crate::tradeoff::Effort;

/// A script with the files it stands beside.
#[derive(Debug, Clone, Copy)]
pub struct Script {
    /// Names and contents; the first is run.
    pub files: &'static [(&'static str, &'static str)],
}

/// Python, or that it was not asked for.
#[derive(Debug, Clone)]
pub struct Python {
    program: Option<String>,
}

/// A script that takes longer is stopped.
const MOST_S: u64 = 300;
const LOOK: Duration = Duration::from_millis(20);
/// One thread each.
const THREADS: [&str; 4] = ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"];

/// A line printed by a script.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(in crate::tradeoff) struct Answer {
    /// Seconds of the whole, a number each repeat.
    pub(in crate::tradeoff) seconds: Vec<f64>,
    /// Which setting.
    pub(in crate::tradeoff) name: String,
    /// Which of several problems.
    pub(in crate::tradeoff) problem: Option<String>,
    /// Seconds of a fit.
    pub(in crate::tradeoff) fit_s: Vec<f64>,
    /// Seconds of one prediction.
    pub(in crate::tradeoff) row_s: Vec<f64>,
    /// A file of predictions.
    pub(in crate::tradeoff) predicted: Option<String>,
    /// A file of coefficients.
    pub(in crate::tradeoff) coefficients: Option<String>,
}

impl Python {
    /// `wanted`: whether scripts are to be run.
    #[must_use]
    pub fn new(wanted: bool) -> Self {
        Self::of(wanted.then_some("python3"))
    }

    /// Another program in the place of `python3`; none: no script is run.
    #[must_use]
    pub fn of(program: Option<&str>) -> Self {
        Self { program: program.map(str::to_owned) }
    }

    /// Whether `peer` can be run; if not, the report that says what is missing. `packages` as Python imports and as
    /// PyPI names them.
    pub(in crate::tradeoff) fn has(&self, peer: &str, packages: &[(&str, &str)]) -> Result<(), PeerReport> {
        let Some(program) = &self.program else {
            return Err(PeerReport::missing(peer, "not measured; --peers does, where python3 has its packages"));
        };
        let finds = |code: &str| {
            let run = Command::new(program).args(["-c", code]).stdout(Stdio::null()).stderr(Stdio::null()).status();
            run.is_ok_and(|status| status.success())
        };
        if !finds("import sys; sys.exit(sys.version_info < (3, 11))") {
            return Err(PeerReport::missing(
                peer,
                format!("{program} (3.11 or later) is missing: install it, then {}", install(packages)),
            ));
        }
        let missing: Vec<_> =
            packages.iter().copied().filter(|(module, _)| !finds(&format!("import {module}"))).collect();
        if missing.is_empty() {
            return Ok(());
        }
        let names = missing.iter().map(|(_, package)| *package).collect::<Vec<_>>().join(", ");
        Err(PeerReport::missing(peer, format!("{program} has no {names}: {}", install(&missing))))
    }

    /// Runs a script in `folder`, with `arguments`; what it printed.
    ///
    /// # Errors
    /// A script that fails, with its last words, or takes too long.
    pub(in crate::tradeoff) fn run(
        &self,
        script: Script,
        folder: &Path,
        arguments: &[&str],
        effort: &Effort,
    ) -> anyhow::Result<String> {
        let program = self.program.as_deref().context("no script is to be run")?;
        for (name, text) in script.files {
            std::fs::write(folder.join(name), text).with_context(|| (*name).to_owned())?;
        }
        let name = script.files.first().context("a script")?.0;
        let mut command = Command::new(program);
        command.arg(name).args(arguments).current_dir(folder).stdin(Stdio::null());
        command.envs(THREADS.map(|variable| (variable, "1"))).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().with_context(|| program.to_owned())?;
        let (out, errors) = (child.stdout.take().context("its output")?, child.stderr.take().context("its errors")?);
        let (out, errors) = (thread::spawn(move || text(out)), thread::spawn(move || text(errors)));
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait()? {
                break status;
            }
            let stopped = effort.check();
            if stopped.is_err() || begun.elapsed().as_secs() >= MOST_S {
                // It may have ended just now.
                let _ = child.kill();
                child.wait()?;
                stopped?;
                bail!("{name} took more than {MOST_S} s");
            }
            thread::sleep(LOOK);
        };
        let (out, errors) = (out.join().unwrap_or_default(), errors.join().unwrap_or_default());
        ensure!(status.success(), "{name} failed: {}", errors.trim().lines().last().unwrap_or("without a word"));
        Ok(out)
    }

    /// The same of a script that answers in lines of JSON.
    pub(in crate::tradeoff) fn answers(
        &self,
        script: Script,
        folder: &Path,
        arguments: &[&str],
        effort: &Effort,
    ) -> anyhow::Result<Vec<Answer>> {
        let out = self.run(script, folder, arguments, effort)?;
        out.lines().map(|line| serde_json::from_str(line).with_context(|| format!("its answer `{line}`"))).collect()
    }
}

fn text(mut pipe: impl Read) -> String {
    let mut bytes = Vec::new();
    // What was read before a pipe broke is reported.
    let _ = pipe.read_to_end(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

/// How to get packages, in the versions that were tried.
fn install(packages: &[(&str, &str)]) -> String {
    let pinned = |package: &str| {
        REQUIREMENTS.lines().find(|line| line.split("==").next() == Some(package)).unwrap_or(package).to_owned()
    };
    format!("pip install {}", packages.iter().map(|(_, package)| pinned(package)).collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_reported_with_how_to_get_it() {
        let packages = [("numpy", "numpy"), ("no_such_module", "scikit-image")];
        let asked = Python::new(false).has("scikit-image", &packages).unwrap_err();
        assert!(!asked.measured && asked.what.contains("--peers"), "{asked:?}");
        let without = Python::of(Some("no-such-python")).has("scikit-image", &packages).unwrap_err();
        assert!(without.what.contains("no-such-python (3.11 or later) is missing"), "{without:?}");
        assert!(without.what.contains("pip install numpy==") && without.what.contains("scikit-image=="), "{without:?}");
    }

    #[test]
    fn scripts_answer_or_say_why_not() {
        // A shell stands for Python, which not every machine has.
        let shell = Python::of(Some("sh"));
        let folder = tempfile::tempdir().unwrap();
        let effort = Effort { repeats: 1, ..Effort::default() };
        let good = Script { files: &[("good.sh", "echo \"{\\\"seconds\\\": [$1, 2.5]}\"")] };
        assert_eq!(shell.answers(good, folder.path(), &["1"], &effort).unwrap()[0].seconds, [1.0, 2.5]);
        let bad = Script { files: &[("bad.sh", "echo first >&2; echo last words >&2; exit 3")] };
        let why = shell.run(bad, folder.path(), &[], &effort).unwrap_err().to_string();
        assert_eq!(why, "bad.sh failed: last words");
        let words = Script { files: &[("words.sh", "echo words")] };
        assert!(shell.answers(words, folder.path(), &[], &effort).unwrap_err().to_string().contains("words"));
        let slow = Script { files: &[("slow.sh", "exec sleep 60")] };
        effort.stop.store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(shell.run(slow, folder.path(), &[], &effort).unwrap_err().to_string().contains("interrupted"));
    }
}
