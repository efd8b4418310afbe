//! What jobs of lunula wrote beside a folder's own files, which is no recording and no photograph.
//!
//! In: a folder and the names in it; out: which of them are results. A report (`run.json` of a folder, `NAME.run.json`
//! of a table) names the pictures and the table of its run. What an earlier run with other options or another job left
//! there no report names any more: that is known by the names that jobs write.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

/// Tables and pictures that jobs write into their folder, without ending: where there is a report of any job, for two
/// of them that write into one folder leave one report.
const OF_ANY: [&str; 17] = [
    "best-of-size",
    "by-magnitude",
    "delays",
    "eigennails",
    "error-against-k",
    "held-out",
    "layout",
    "merit",
    "modes",
    "over-time",
    "performance-methods",
    "performance-operators",
    "scatter",
    "skill-summary",
    "splits",
    "subsets",
    "without-one",
];
/// What else they write, tables, pictures and folders: only where the report is that job's, as such names may well be
/// a person's own.
const OF_JOB: [(&str, &[&str]); 7] = [
    ("evaluate", &["predicted"]),
    ("nailvideo", &["cells", "frames", "maps", "motion", "nail", "photodiodes", "presses", "sheet", "traces"]),
    ("performance", &["rows", "table"]),
    ("photos", OF_PHOTOS),
    ("photos merge", OF_PHOTOS),
    ("skill", &["skill"]),
    ("switch evaluate", &["presses"]),
];
const OF_PHOTOS: &[&str] = &["channels", "figures", "maps", "nails", "normalized"];
/// What they draw beside a table `NAME.csv`, as `NAME-angles.png`, ..
const DRAWN_BESIDE: [&str; 10] =
    ["angles", "corners", "coupling", "curve", "fitted", "labels", "overlay", "response", "static", "tie"];
/// .. and the tables beside it.
const TABLES_BESIDE: [&str; 2] = ["estimates", "fitted"];

/// A folder's results of jobs.
#[derive(Debug, Default)]
pub(super) struct JobResults {
    /// Whether there is a `run.json`.
    of_folder: bool,
    /// What only the job writes that it is of.
    of_job: &'static [&'static str],
    /// What reports name.
    named: BTreeSet<String>,
    /// The names of tables with a report of their own, without ending.
    tables: Vec<String>,
}

impl JobResults {
    pub(super) fn of<'a>(folder: &Path, names: impl Iterator<Item = &'a str>) -> Self {
        let mut results = Self::default();
        for name in names.filter(|name| name.ends_with("run.json")) {
            let stem = name.strip_suffix(".run.json");
            if stem.is_none() && name != "run.json" {
                continue;
            }
            let text = std::fs::read(folder.join(name)).ok();
            let report = text.and_then(|text| serde_json::from_slice::<Value>(&text).ok()).unwrap_or_default();
            let Some(job) = report["job"].as_str() else { continue };
            results.named.extend(named(&report));
            match stem {
                Some(stem) => results.tables.push(stem.to_owned()),
                None => {
                    results.of_folder = true;
                    results.of_job = OF_JOB.iter().find(|(of, _)| *of == job).map_or(&[], |(_, names)| names);
                }
            }
        }
        results
    }

    /// Whether one of the folder's names is a result's.
    pub(super) fn holds(&self, name: &str, is_folder: bool) -> bool {
        if is_folder {
            return self.of_job.contains(&name);
        }
        let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
        let (is_table, is_picture) = (["csv", "parquet"].contains(&ending), ["png", "svg"].contains(&ending));
        let of_folder =
            || (is_table || is_picture) && (self.of_job.contains(&stem) || self.of_folder && OF_ANY.contains(&stem));
        let beside = || {
            let known: &[&str] = if is_table { &TABLES_BESIDE } else { &DRAWN_BESIDE };
            let rests = self.tables.iter().filter_map(|table| stem.strip_prefix(table.as_str())?.strip_prefix('-'));
            rests.into_iter().any(|rest| known.contains(&rest))
        };
        self.named.contains(name) || of_folder() || beside()
    }
}

/// The files that a report names as written: pictures, of which the SVG is beside the PNG, and the table.
fn named(report: &Value) -> impl Iterator<Item = String> {
    let pictures = report["pictures"].as_array().into_iter().flatten();
    let paths = pictures.chain([&report["table"]]).filter_map(Value::as_str).map(Path::new);
    let files = paths.flat_map(|path| [path.to_owned(), path.with_extension("svg")]);
    files.filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Part;
    use crate::pipeline::kinds;
    use crate::pipeline::tests::planned::folder_of;

    fn results_of(files: &[(&str, &str)]) -> JobResults {
        let dir = folder_of(files);
        JobResults::of(dir.path(), files.iter().map(|(name, _)| *name))
    }

    #[test]
    fn every_table_that_a_job_writes_into_its_folder_is_known() {
        let into_folders =
            ["analyse", "evaluate", "layout", "nailvideo", "performance", "prune", "skill", "switch-evaluate"];
        let mut looked_at = 0;
        for kind in kinds().iter().filter(|kind| into_folders.contains(&kind.name)) {
            let report = format!("{{\"job\": \"{}\"}}", kind.name.replace('-', " "));
            let results = results_of(&[("run.json", &report)]);
            let tables = kind.parts.iter().filter(|part| part.name != Part::PICTURES && part.file.ends_with(".csv"));
            for table in tables {
                assert!(results.holds(table.file, false), "{}: {}", kind.name, table.file);
                looked_at += 1;
            }
        }
        assert_eq!(looked_at, 13);
    }

    #[test]
    fn only_what_jobs_write_is_a_result() {
        let evaluated = results_of(&[("run.json", "{\"job\": \"evaluate\", \"pictures\": [\"there/of-it.png\"]}")]);
        for name in ["merit.csv", "predicted.csv", "scatter.png", "scatter.svg", "layout.png", "of-it.png", "of-it.svg"]
        {
            assert!(evaluated.holds(name, false), "{name}");
        }
        for name in ["random.csv", "S01.png", "scatter.mp4", "cells.csv", "photodiodes.csv", "of-it.csv"] {
            assert!(!evaluated.holds(name, false), "{name}");
        }
        assert!(!evaluated.holds("maps", true));
        let simulated = results_of(&[("a.run.json", "{\"job\": \"simulate\", \"table\": \"there/a.csv\"}")]);
        for name in ["a.csv", "a-response.png", "a-angles.svg", "a-overlay.mp4", "a-estimates.csv"] {
            assert!(simulated.holds(name, false), "{name}");
        }
        for name in ["a-2.csv", "a-rest.png", "b-angles.png", "scatter.png", "merit.csv", "a.mp4"] {
            assert!(!simulated.holds(name, false), "{name}");
        }
        assert!(results_of(&[("run.json", "{\"job\": \"photos\"}")]).holds("normalized", true));
        assert!(!results_of(&[("run.json", "{\"runs\": 1}")]).holds("merit.csv", false));
        assert!(!results_of(&[("rerun.json", "{\"job\": \"evaluate\"}")]).holds("merit.csv", false));
    }
}
