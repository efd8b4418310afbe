//! Other solvers on the same responses: SciPy's and scikit-sundae's, where the machine has them RADAU5, LSODA and CVODE
//! themselves, and diffsol's BDF where it is compiled in.

use std::path::Path;

use anyhow::Context;
use lunula::tradeoff::hemodynamics::{ERROR, SOLVING};
use lunula::tradeoff::{Job, Timing};

use crate::Bench;
use crate::found::Found;
use crate::python::Package;

const NAME: &str = "SciPy's solvers";
const PACKAGES: [Package; 2] = [("scipy", "scipy"), ("numpy", "numpy")];
/// What the script takes as well where it is there: how its rows begin, packages.
const SUNDAE: (&str, [Package; 1]) = ("CVODE (scikit-sundae)", [("sksundae", "scikit-sundae")]);
/// Native solvers, with what they need beside Python and a C compiler.
const NATIVE: [(&str, &str); 3] = [
    ("RADAU5 (Fortran)", "Debian's gcc and r-cran-desolve"),
    ("LSODA (Fortran)", "Debian's gcc and r-cran-desolve"),
    ("CVODE (C)", "Debian's gcc and libsundials-dev"),
];
/// Seconds that a solver may take at one tolerance before tighter ones are left out.
const BUDGET_S: [&str; 2] = ["2", "0.5"];
/// How a solver's name ends whose tolerances of the rates are loosened.
const LOOSE: &str = " loose rates";

/// A row of the script's table.
#[derive(Debug, serde::Deserialize)]
struct Solved {
    solver: String,
    rtol: f64,
    error: f64,
    microseconds: f64,
    evaluations: u64,
}

impl Solved {
    fn add(&self, version: &str, found: &mut Found) {
        let Self { solver, rtol, error, microseconds, evaluations } = self;
        let setting = match solver.strip_suffix(LOOSE) {
            Some(solver) => format!("{solver}, {rtol:.0e} (loose)"),
            None => format!("{solver}, {rtol:.0e}"),
        };
        // The fastest of several rounds, whose spread is not known.
        let time = Timing { repeats: 0, ..Timing::of(vec![1e-6 * microseconds]) };
        found.add((Job::Hemodynamics, SOLVING.1), &setting, (*error, ERROR), time, *evaluations, version);
    }
}

pub(crate) fn measure(bench: &Bench, folder: &Path, found: &mut Found) -> anyhow::Result<()> {
    let responses = lunula::tradeoff::hemodynamics::Bench::new()?;
    for (name, proximal) in [("proximal.csv", true), ("distal.csv", false)] {
        std::fs::write(folder.join(name), responses.reference(proximal))?;
    }
    found.try_program(NAME, |found| {
        let mut version = bench.python.versions(&PACKAGES)?;
        match bench.python.versions(&SUNDAE.1) {
            Ok(sundae) => version = format!("{sundae}; {version}"),
            Err(why) => found.left_out.push(format!("{}: {why}", SUNDAE.0)),
        }
        let quick = usize::from(bench.plan.effort.quick);
        let arguments = ["--reference", ".", "--out", "peers.csv", "--budget", BUDGET_S[quick], "--quick"];
        bench.python.run("hemodynamics.py", folder, &arguments)?;
        let rows = csv::Reader::from_path(folder.join("peers.csv"))?.into_deserialize();
        let rows = rows.collect::<Result<Vec<Solved>, _>>().context("the script's table")?;
        rows.iter().for_each(|row| row.add(&version, found));
        for (name, needs) in NATIVE {
            if !rows.iter().any(|row| row.solver.starts_with(name)) {
                found.left_out.push(format!("{name}: not found; it needs {needs}"));
            }
        }
        Ok(())
    });
    #[cfg(feature = "diffsol")]
    found.try_program("diffsol", |found| crate::diffsol::measure(&responses, bench.plan.effort.repeats, found));
    #[cfg(not(feature = "diffsol"))]
    found.left_out.push("diffsol: compile with --features diffsol".to_owned());
    Ok(())
}
