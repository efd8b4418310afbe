//! Scripts in Python, run on one thread, answered in lines of JSON.

use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};
use serde::Deserialize;

/// How to get the packages.
const REQUIREMENTS: &str = include_str!("../requirements.txt");
const SCRIPTS: &str = env!("CARGO_MANIFEST_DIR");
/// A script that takes longer is stopped.
const MOST_S: u64 = 300;
const LOOK: Duration = Duration::from_millis(20);
/// One thread each.
const THREADS: [&str; 4] = ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"];

/// A package as Python imports and as PyPI names it.
pub(crate) type Package = (&'static str, &'static str);

/// The program that runs scripts.
#[derive(Debug)]
pub(crate) struct Python {
    program: String,
}

/// A line printed by a script.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Answer {
    /// Seconds of the whole, a number each repeat.
    pub(crate) seconds: Vec<f64>,
    pub(crate) name: String,
    /// Which of several problems.
    pub(crate) problem: Option<String>,
    /// Seconds of a fit.
    pub(crate) fit_s: Vec<f64>,
    /// Seconds of one prediction.
    pub(crate) row_s: Vec<f64>,
    /// A file of predictions.
    pub(crate) predicted: Option<String>,
    /// A file of coefficients.
    pub(crate) coefficients: Option<String>,
}

impl Python {
    pub(crate) fn new(program: impl Into<String>) -> Self {
        Self { program: program.into() }
    }

    /// The versions of Python and `packages`.
    ///
    /// # Errors
    /// What of them is missing, and how to get it.
    pub(crate) fn versions(&self, packages: &[Package]) -> anyhow::Result<String> {
        let answer = |code: &str| {
            let run = Command::new(&self.program).args(["-c", code]).stderr(Stdio::null()).output().ok()?;
            run.status.success().then(|| String::from_utf8_lossy(&run.stdout).trim().to_owned())
        };
        let python =
            answer("import sys, platform; print(platform.python_version()); sys.exit(sys.version_info < (3, 11))");
        let python = python.with_context(|| {
            format!("{} (3.11 or later) is missing: install it, then {}", self.program, install(packages))
        })?;
        let version = |(module, package): &Package| {
            answer(&format!("import {module}; from importlib.metadata import version; print(version('{package}'))"))
        };
        let found: Vec<(Package, Option<String>)> = packages.iter().map(|one| (*one, version(one))).collect();
        let missing: Vec<Package> =
            found.iter().filter(|(_, version)| version.is_none()).map(|(one, _)| *one).collect();
        let names = |packages: &[Package]| packages.iter().map(|one| one.1).collect::<Vec<_>>().join(", ");
        ensure!(missing.is_empty(), "{} has no {}: {}", self.program, names(&missing), install(&missing));
        let there = found.iter().filter_map(|((_, name), version)| Some(format!("{name} {}", version.as_ref()?)));
        Ok(there.chain([format!("Python {python}")]).collect::<Vec<_>>().join("; "))
    }

    /// Runs a script of this crate's folder in `folder`, with `arguments`; what it printed.
    ///
    /// # Errors
    /// A script that fails, with its last words, or takes too long.
    pub(crate) fn run(&self, script: &str, folder: &Path, arguments: &[&str]) -> anyhow::Result<String> {
        self.run_at(&Path::new(SCRIPTS).join(script), folder, arguments)
    }

    fn run_at(&self, script: &Path, folder: &Path, arguments: &[&str]) -> anyhow::Result<String> {
        let name = script.file_name().unwrap_or_default().to_string_lossy();
        let mut command = Command::new(&self.program);
        command.arg(script).args(arguments).current_dir(folder).stdin(Stdio::null());
        command.envs(THREADS.map(|variable| (variable, "1"))).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().with_context(|| self.program.clone())?;
        let (out, errors) = (child.stdout.take().context("its output")?, child.stderr.take().context("its errors")?);
        let (out, errors) = (thread::spawn(move || text(out)), thread::spawn(move || text(errors)));
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait()? {
                break status;
            }
            if begun.elapsed().as_secs() >= MOST_S {
                // It may have ended just now.
                let _ = child.kill();
                child.wait()?;
                bail!("{name} took more than {MOST_S} s");
            }
            thread::sleep(LOOK);
        };
        let (out, errors) = (out.join().unwrap_or_default(), errors.join().unwrap_or_default());
        ensure!(status.success(), "{name} failed: {}", errors.trim().lines().last().unwrap_or("without a word"));
        Ok(out)
    }

    /// The same of a script that answers in lines of JSON.
    pub(crate) fn answers(&self, script: &str, folder: &Path, arguments: &[&str]) -> anyhow::Result<Vec<Answer>> {
        parsed(&self.run(script, folder, arguments)?)
    }
}

fn parsed(out: &str) -> anyhow::Result<Vec<Answer>> {
    out.lines().map(|line| serde_json::from_str(line).with_context(|| format!("its answer `{line}`"))).collect()
}

fn text(mut pipe: impl Read) -> String {
    let mut bytes = Vec::new();
    // What was read before a pipe broke is reported.
    let _ = pipe.read_to_end(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

/// How to get packages, in the versions that were tried.
fn install(packages: &[Package]) -> String {
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
        let why = Python::new("no-such-python").versions(&packages).unwrap_err().to_string();
        assert!(why.contains("no-such-python (3.11 or later) is missing"), "{why}");
        assert!(why.contains("pip install numpy==") && why.contains("scikit-image=="), "{why}");
    }

    #[test]
    fn scripts_answer_or_say_why_not() {
        // A shell stands for Python, which not every machine has.
        let shell = Python::new("sh");
        let folder = tempfile::tempdir().unwrap();
        let run = |text: &str, arguments: &[&str]| {
            let script = folder.path().join("one.sh");
            std::fs::write(&script, text).unwrap();
            shell.run_at(&script, folder.path(), arguments)
        };
        let good = run("echo \"{\\\"seconds\\\": [$1, 2.5]}\"", &["1"]).unwrap();
        assert_eq!(parsed(&good).unwrap()[0].seconds, [1.0, 2.5]);
        let why = run("echo first >&2; echo last words >&2; exit 3", &[]).unwrap_err().to_string();
        assert_eq!(why, "one.sh failed: last words");
        assert!(parsed("words\n").unwrap_err().to_string().contains("words"));
    }
}
