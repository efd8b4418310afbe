//! Programs that lunula works with: Python's peers on the curves of `lunula tradeoff`, LabelMe, Snakemake, Slurm. None is needed.

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::Check;

/// A program that does not answer within this time is left alone.
const PATIENCE: Duration = Duration::from_secs(20);
const LOOK_AGAIN: Duration = Duration::from_millis(5);

/// Of Python's packages: their module, and what `pip install` calls them.
const PEERS: [(&str, &str); 6] = [
    ("cv2", "opencv-python-headless"),
    ("numpy", "numpy"),
    ("pandas", "pandas"),
    ("scipy", "scipy"),
    ("skimage", "scikit-image"),
    ("sklearn", "scikit-learn"),
];

/// Prints, of the modules that are its arguments, those that are not there.
const WHICH: &str =
    "import importlib.util, sys; print(*[m for m in sys.argv[1:] if importlib.util.find_spec(m) is None])";

/// A program that is asked for its version: its name, what it is for, how to get it.
const OTHERS: [(&str, &str, &str); 3] = [
    ("labelme", "corrects outlines by hand", "pip install labelme"),
    ("snakemake", "runs pipelines in parts on a cluster", "pip install snakemake snakemake-executor-plugin-slurm"),
    ("sbatch", "hands parts of pipelines to Slurm", "apt-get install slurm-wlm, or ask those who run your cluster"),
];

pub(super) fn examine() -> Vec<Check> {
    // Each is a program that takes its time to start: all at once.
    std::thread::scope(|scope| {
        let asked: Vec<_> = OTHERS.iter().map(|other| scope.spawn(move || asked(*other))).collect();
        let mut checks = vec![peers()];
        checks.extend(asked.into_iter().filter_map(|one| one.join().ok()));
        checks
    })
}

fn peers() -> Check {
    let modules: Vec<&str> = PEERS.iter().map(|(module, _)| *module).collect();
    let arguments: Vec<&str> = ["-c", WHICH].into_iter().chain(modules).collect();
    peers_of(answer("python3", &arguments))
}

/// From the modules that are not there.
fn peers_of(missing: Result<String, String>) -> Check {
    let what = "Python's peers";
    let install = |names: &[&str]| {
        format!("only for peers on the curves of `lunula tradeoff` and `make bench`: pip install {}", names.join(" "))
    };
    let all: Vec<&str> = PEERS.iter().map(|(_, package)| *package).collect();
    match missing {
        Err(why) => Check::note(what, format!("python3: {why}"), install(&all)),
        Ok(missing) => {
            let is_missing = |module: &str| missing.split_whitespace().any(|other| other == module);
            let missing: Vec<&str> =
                PEERS.iter().filter(|(module, _)| is_missing(module)).map(|(_, package)| *package).collect();
            if missing.is_empty() {
                Check::good(what, all.join(", "))
            } else {
                Check::note(what, format!("without {}", missing.join(", ")), install(&missing))
            }
        }
    }
}

fn asked((name, purpose, get): (&str, &str, &str)) -> Check {
    match answer(name, &["--version"]) {
        Ok(version) => Check::good(name, version.lines().next().unwrap_or_default().to_owned()),
        Err(why) => Check::note(name, format!("{why}; it {purpose}"), get),
    }
}

/// What a program prints, or why it does not.
fn answer(name: &str, arguments: &[&str]) -> Result<String, String> {
    let mut command = Command::new(name);
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(|why| match why.kind() {
        std::io::ErrorKind::NotFound => "not installed".to_owned(),
        _ => format!("can't be run ({why})"),
    })?;
    let asked = Instant::now();
    // Its answer is a few lines, less than a pipe holds: it never waits for a reader.
    while child.try_wait().map_err(|why| why.to_string())?.is_none() {
        if asked.elapsed() > PATIENCE {
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("gives no answer within {} s", PATIENCE.as_secs()));
        }
        sleep(LOOK_AGAIN);
    }
    let output = child.wait_with_output().map_err(|why| why.to_string())?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("fails ({}): {}", output.status, said.lines().next().unwrap_or_default()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::*;

    #[test]
    fn what_a_program_says_or_why_it_does_not() {
        assert_eq!(answer("sh", &["-c", "echo 1.2"]).unwrap(), "1.2");
        assert!(answer("sh", &["-c", "echo why >&2; exit 3"]).unwrap_err().ends_with("3): why"));
        assert_eq!(answer("no-such-program-of-lunula", &[]).unwrap_err(), "not installed");
    }

    #[test]
    fn only_what_is_missing_is_to_be_installed() {
        assert_eq!(peers_of(Ok(String::new())).state, State::Good);
        let some = peers_of(Ok("skimage cv2".to_owned()));
        assert_eq!(some.state, State::Note);
        assert!(some.remedy.ends_with("pip install opencv-python-headless scikit-image"), "{}", some.remedy);
        let none = peers_of(Err("not installed".to_owned()));
        assert!(none.remedy.contains("numpy") && none.remedy.contains("scikit-learn"), "{}", none.remedy);
    }
}
