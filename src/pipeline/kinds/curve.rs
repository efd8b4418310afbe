//! `static`: every equilibrium of the hemodynamic model for a range of loads (Fig. 78).

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::nail::{PARAMS, Settings, Told, all_stand, given, of_foreseen, of_task, without_report};
use super::options::{fault, read, told};
use super::pool::in_pool;
use crate::hemodynamics::model::{Collapse, Load};
use crate::hemodynamics::{
    CurveOptions, CurveOutputs, LoadRange, OpticsChoice, Pressed, curve, curve_outline, curve_plan,
};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared};
use crate::pipeline::task::{Job, Made, Work};
use crate::stages::Step;

const PICTURES: &str = "pictures";
const TABLE: &str = "static.csv";

/// The kind.
pub(super) static STATIC: Kind = Kind {
    name: "static",
    about: "every equilibrium of the hemodynamic model for a range of loads",
    roles: &[PARAMS],
    parts: &[
        Part { name: "curve", file: TABLE, only_if_wanted: false, about: "the equilibria, a row each" },
        Part { name: PICTURES, file: "", only_if_wanted: true, about: "photodiodes over the load" },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &["static", "load", "ph", "pl", "collapse", "optics", "units", "set"];

/// A stage's keys, named as the options of `simulate --static`.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    #[serde(rename = "static")]
    range: Option<Told<LoadRange>>,
    #[serde(with = "crate::words")]
    load: Pressed,
    ph: Option<Told<Load>>,
    pl: Option<Told<Load>>,
    #[serde(with = "crate::words")]
    collapse: Collapse,
    #[serde(with = "crate::words")]
    optics: OpticsChoice,
    units: Option<u16>,
    set: Settings,
}

fn prepare(table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let asked: Asked = read(KEYS, table)?;
    let range = asked.range.as_ref().map(|told| told.value);
    let range = range.ok_or_else(|| fault("static", "is needed: the loads in pascals, as \"0..12000/100\""))?;
    let load = |one: &Option<Told<Load>>| one.as_ref().map(|told| told.value.clone());
    let options = CurveOptions {
        parameters: given(asked.units, &asked.set)?,
        upstream: load(&asked.ph),
        downstream: load(&asked.pl),
        pressed: asked.load,
        range,
        collapse: asked.collapse,
        optics: asked.optics,
    };
    curve_plan(&options, None).map_err(|why| fault("", why.to_string()))?;
    Ok(Arc::new(Equilibria { asked, options }))
}

struct Equilibria {
    asked: Asked,
    options: CurveOptions,
}

fn outputs(folder: &Path, demand: &Demand) -> CurveOutputs {
    CurveOutputs { table: folder.join(TABLE), figures: demand.parts.contains(PICTURES) }
}

impl Prepared for Equilibria {
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        told(&self.asked, demand, &[PICTURES])
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(CurveJob { options: self.options.clone(), demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let mut options = self.options.clone();
        options.parameters = of_foreseen(&options.parameters, inputs);
        let out = outputs(Path::new(""), demand);
        if all_stand(inputs) {
            curve_plan(&options, Some(&out)).map_err(|why| why.to_string())
        } else {
            Ok(curve_outline(&options, Some(&out)))
        }
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(false), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (32_000_000, 0.02 + 1e-4 * self.options.range.loads_pa().len() as f64)
    }
}

struct CurveJob {
    options: CurveOptions,
    demand: Demand,
}

impl Job for CurveJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let mut options = self.options.clone();
        options.parameters = of_task(&options.parameters, work);
        let outputs = outputs(work.folder, &self.demand);
        let report = in_pool(work.threads, || curve(&options, &outputs, work.stop))??;
        without_report(&outputs.table)?;
        Ok(Made {
            report: serde_json::to_value(&report)?,
            left_out: report.left_out,
            warnings: report.warnings,
            failed: report.failed,
            stages: report.stages,
            quality: Vec::new(),
        })
    }
}
