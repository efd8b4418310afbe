//! Other solvers on the same responses: SciPy's and scikit-sundae's, and where the machine has them RADAU5, LSODA and
//! CVODE themselves.

use std::fmt::Write;

use super::Settings;
use super::bench::Bench;
use super::peers::read_peers;
use crate::tradeoff::measure::rows::{Measured, Row};
use crate::tradeoff::peers::{PeerReport, Script};

const NAME: &str = "SciPy's solvers";
/// What the script takes as well where it is there.
const MORE: [(&str, [(&str, &str); 1]); 1] = [("CVODE of scikit-sundae", [("sksundae", "scikit-sundae")])];
const PACKAGES: [(&str, &str); 2] = [("numpy", "numpy"), ("scipy", "scipy")];
const SCRIPT: Script = Script {
    files: &[
        ("hemodynamics.py", include_str!("../../../benches/peers/hemodynamics.py")),
        ("hemodynamics.c", include_str!("../../../benches/peers/hemodynamics.c")),
    ],
};
/// Native solvers, with what they need beside Python and a C compiler.
const NATIVE: [(&str, &str); 3] = [
    ("RADAU5 (Fortran)", "Debian's gcc and r-cran-desolve"),
    ("LSODA (Fortran)", "Debian's gcc and r-cran-desolve"),
    ("CVODE (C)", "Debian's gcc and libsundials-dev"),
];
/// Seconds that a solver may take at one tolerance before tighter ones are left out.
const BUDGET_S: [&str; 2] = ["2", "0.5"];
/// In another language, with its own bench.
const DIFFSOL: (&str, &str) = (
    "diffsol",
    "cargo bench -p lunula-hemodynamics --bench transient -- --out FILE.csv measures it, and --peers FILE.csv takes \
     it from there",
);

/// Measures them, where they are to be measured and there.
pub(super) fn measure(bench: &Bench, settings: &Settings, measured: &mut Measured) -> anyhow::Result<()> {
    measured.peers.push(PeerReport::missing(DIFFSOL.0, DIFFSOL.1));
    if let Err(missing) = settings.python.has(NAME, &PACKAGES) {
        measured.peers.push(missing);
        return Ok(());
    }
    for (name, packages) in MORE {
        if let Err(missing) = settings.python.has(name, &packages) {
            measured.peers.push(missing);
        }
    }
    let rows = || -> anyhow::Result<Vec<Row>> {
        let folder = tempfile::tempdir()?;
        for (name, proximal) in [("proximal.csv", true), ("distal.csv", false)] {
            std::fs::write(folder.path().join(name), reference(bench, proximal))?;
        }
        let quick = usize::from(settings.effort.quick);
        let arguments = ["--reference", ".", "--out", "peers.csv", "--budget", BUDGET_S[quick], "--quick"];
        settings.python.run(SCRIPT, folder.path(), &arguments, &settings.effort)?;
        read_peers(&folder.path().join("peers.csv"))
    };
    let outcome = rows();
    settings.effort.check()?;
    match outcome {
        Ok(rows) => {
            for (name, needs) in NATIVE {
                if !rows.iter().any(|row| row.setting.starts_with(name)) {
                    measured.peers.push(PeerReport::missing(name, format!("not found; it needs {needs}")));
                }
            }
            measured.rows.extend(rows);
            let what =
                "the same responses, equations and tolerances, the analytic Jacobian; callbacks into Python are theirs";
            measured.peers.push(PeerReport::measured(NAME, what));
        }
        Err(why) => measured.peers.push(PeerReport::missing(NAME, format!("{why:#}"))),
    }
    Ok(())
}

/// The responses that others are compared with: displacements, as differences from the nominal diameters and over them.
fn reference(bench: &Bench, proximal: bool) -> String {
    let mut text = String::from("load_Pa,time_s,C1,C2,V\n");
    for case in bench.cases.iter().filter(|case| case.proximal == proximal) {
        let mut row = |time_s: f64, lumens: &[f64]| {
            let walls: Vec<String> = lumens.iter().map(|lumen| format!("{:e}", lumen - 1.0)).collect();
            // Writing to a string does not fail.
            let _ = writeln!(text, "{},{time_s},{}", case.load_pa, walls.join(","));
        };
        row(0.0, &bench.start.lumens);
        for (k, time_s) in bench.times_s.iter().enumerate() {
            row(*time_s, case.reference.lumens(k));
        }
    }
    text
}
