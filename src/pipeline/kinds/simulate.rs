//! `simulate`: the hemodynamic model under loads over time (4.3).

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::nail::{PARAMS, Settings, Told, all_stand, given, of_foreseen, of_task, without_report};
use super::options::{fault, read, told};
use super::pool::in_pool;
use crate::hemodynamics::model::{Collapse, Load};
use crate::hemodynamics::{
    GivenLoads, OpticsChoice, SimulateOptions, SimulateOutputs, Start, simulate, simulate_outline, simulate_plan,
};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Quality, Work};
use crate::stages::Step;

const PICTURES: &str = "pictures";
const TABLE: &str = "trajectory.csv";

/// The kind.
pub(super) static SIMULATE: Kind = Kind {
    name: "simulate",
    about: "the hemodynamic model under loads over time",
    roles: &[
        PARAMS,
        Role { name: "loads", takes: Takes::Optional, about: "a table time_s,pf1_Pa,pf2_Pa instead of pf1 and pf2" },
        Role { name: "start", takes: Takes::Optional, about: "a trajectory whose last row it starts from" },
    ],
    parts: &[
        Part { name: "trajectory", file: TABLE, only_if_wanted: false, about: "walls and photodiodes over time" },
        Part { name: PICTURES, file: "", only_if_wanted: true, about: "the response over time" },
    ],
    revision: 2,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &[
    "pf1",
    "pf2",
    "ph",
    "pl",
    "from",
    "collapse",
    "until",
    "every",
    "rtol",
    "optics",
    "with_loads",
    "keep_partial",
    "units",
    "set",
];

/// A stage's keys, named as the command's options.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    pf1: Option<Told<Load>>,
    pf2: Option<Told<Load>>,
    ph: Option<Told<Load>>,
    pl: Option<Told<Load>>,
    /// `zero`: no displacement, no velocity.
    from: Option<String>,
    #[serde(with = "crate::words")]
    collapse: Collapse,
    until: f64,
    every: f64,
    rtol: f64,
    #[serde(with = "crate::words")]
    optics: OpticsChoice,
    with_loads: bool,
    keep_partial: bool,
    units: Option<u16>,
    set: Settings,
}

impl Default for Asked {
    fn default() -> Self {
        let usual = SimulateOptions::default();
        Self {
            pf1: None,
            pf2: None,
            ph: None,
            pl: None,
            from: None,
            collapse: usual.collapse,
            until: usual.until_s,
            every: usual.every_s,
            rtol: usual.rtol,
            optics: usual.optics,
            with_loads: usual.with_loads,
            keep_partial: usual.keep_partial,
            units: None,
            set: Settings::new(),
        }
    }
}

fn prepare(table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let asked: Asked = read(KEYS, table)?;
    let start = match asked.from.as_deref() {
        None => Start::Equilibrium,
        Some("zero") => Start::Zero,
        Some(other) => {
            return Err(fault(
                "from",
                format!("`{other}`: write zero; the trajectory to start from is the input `start`"),
            ));
        }
    };
    let load = |one: &Option<Told<Load>>| one.as_ref().map(|told| told.value.clone());
    let options = SimulateOptions {
        parameters: given(asked.units, &asked.set)?,
        loads: GivenLoads {
            proximal: load(&asked.pf1),
            distal: load(&asked.pf2),
            upstream: load(&asked.ph),
            downstream: load(&asked.pl),
            file: None,
        },
        start,
        collapse: asked.collapse,
        optics: asked.optics,
        until_s: asked.until,
        every_s: asked.every,
        rtol: asked.rtol,
        keep_partial: asked.keep_partial,
        with_loads: asked.with_loads,
    };
    // The numbers are checked with the parameters, which may be a file's: with the usual ones, a fault is one all the
    // same.
    simulate_plan(&options, None).map_err(|why| fault("", why.to_string()))?;
    Ok(Arc::new(Simulation { asked, options }))
}

struct Simulation {
    asked: Asked,
    options: SimulateOptions,
}

fn outputs(folder: &Path, demand: &Demand) -> SimulateOutputs {
    SimulateOutputs { table: folder.join(TABLE), figures: demand.parts.contains(PICTURES) }
}

/// That loads are told twice, or where to start from.
fn told_twice(options: &SimulateOptions, has: impl Fn(&str) -> bool) -> Option<&'static str> {
    let pressed = options.loads.proximal.is_some() || options.loads.distal.is_some();
    match () {
        () if pressed && has("loads") => Some("`loads` stands for `pf1` and `pf2`: leave one or the other out"),
        () if options.start == Start::Zero && has("start") => {
            Some("`start` and `from` both say where it starts: leave one out")
        }
        () => None,
    }
}

impl Prepared for Simulation {
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&self.asked, demand, &[PICTURES])
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(SimulateJob { options: self.options.clone(), demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let of = |role: &str| inputs.iter().find(|input| input.role == role).map(|input| input.path.clone());
        if let Some(why) = told_twice(&self.options, |role| of(role).is_some()) {
            return Err(why.to_owned());
        }
        let mut options = self.options.clone();
        options.parameters = of_foreseen(&options.parameters, inputs);
        options.loads.file = of("loads");
        if let Some(path) = of("start") {
            options.start = Start::File(path);
        }
        let out = outputs(Path::new(""), demand);
        if all_stand(inputs) {
            simulate_plan(&options, Some(&out)).map_err(|why| why.to_string())
        } else {
            Ok(simulate_outline(&options, Some(&out)))
        }
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(false), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        let walls = f64::from(self.asked.units.unwrap_or(2)) + 1.0;
        let values = self.options.rows() * (3.0 * walls + 4.0);
        (32_000_000 + (40.0 * values) as u64, 0.02 + 1e-7 * values + 2e-3 * self.asked.until * walls)
    }
}

struct SimulateJob {
    options: SimulateOptions,
    demand: Demand,
}

impl Job for SimulateJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        if let Some(why) = told_twice(&self.options, |role| work.one(role).is_some()) {
            anyhow::bail!(why);
        }
        let mut options = self.options.clone();
        options.parameters = of_task(&options.parameters, work);
        options.loads.file = work.one("loads").map(|at| at.path.clone());
        if let Some(at) = work.one("start") {
            options.start = Start::File(at.path.clone());
        }
        let outputs = outputs(work.folder, &self.demand);
        let report = in_pool(work.threads, || simulate(&options, &outputs, work.stop))??;
        without_report(&outputs.table)?;
        let quality = vec![Quality {
            what: "lumens".to_owned(),
            value: report.rtol,
            unit: "of the nominal diameter, at most".to_owned(),
            against_truth: false,
        }];
        Ok(Made {
            report: serde_json::to_value(&report)?,
            left_out: report.left_out,
            warnings: report.warnings,
            failed: report.failed,
            stages: report.stages,
            quality,
        })
    }
}
