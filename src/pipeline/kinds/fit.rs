//! `fit`: the hemodynamic model's free parameters to recorded responses (Fig. 79 to 82).
//!
//! Recordings of one subject are those whose key `subject` is the same; where not all have it, all are one's.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::log_keys::LogKeys;
use super::nail::{PARAMS, Settings, Told, all_stand, given, of_foreseen, of_task, without_report};
use super::options::{fault, read, told};
use super::pool::in_pool;
use super::recordings::{ambient_step, bytes};
use crate::hemodynamics::model::{Bounds, Calibration, Collapse, Parameters};
use crate::hemodynamics::{
    Between, FitOptions, FitOutputs, FitReport, ForceColumn, GivenParameters, OpticsChoice, PhotodiodeColumn, Pressed,
    RecordingColumns, STARTS, fit, fit_outline, fit_plan,
};
use crate::pipeline::keys::Keys;
use crate::pipeline::kind::{Demand, Facts, Foreseen, KeyFault, Kind, Part, Prepared, Role, Takes};
use crate::pipeline::task::{Job, Made, Quality, Work};
use crate::stages::Step;

const PICTURES: &str = "pictures";
const RECORDINGS: &str = "recordings";
const TRUTH: &str = "truth";

/// The kind.
pub(super) static FIT: Kind = Kind {
    name: "fit",
    about: "the hemodynamic model's free parameters to recorded responses",
    roles: &[
        Role {
            name: RECORDINGS,
            takes: Takes::Many,
            about: "recorded responses: loads and photodiodes; a log or align's set",
        },
        PARAMS,
        Role { name: TRUTH, takes: Takes::Optional, about: "the true parameters, where they are known" },
    ],
    parts: &[
        Part { name: "params", file: "fit.toml", only_if_wanted: false, about: "the fitted parameters, for simulate" },
        Part {
            name: "estimates",
            file: "fit-estimates.csv",
            only_if_wanted: false,
            about: "each fitted value with its standard error",
        },
        Part { name: "fitted", file: "fit-fitted.csv", only_if_wanted: false, about: "measured and fitted voltages" },
        Part { name: PICTURES, file: "", only_if_wanted: true, about: "measured and fitted" },
    ],
    revision: 1,
    keys: KEYS,
    prepare,
};

const KEYS: &[&str] = &[
    "free",
    "bounds",
    "starts",
    "calibrate",
    "noise",
    "photodiode",
    "force",
    "area_cm2",
    "load",
    "between",
    "unloaded_before",
    "collapse",
    "optics",
    "units",
    "set",
    "columns",
    "time_unit",
    "full_scale",
    "piece",
    "stream",
];

/// A stage's keys, named as the command's options.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
struct Asked {
    free: Option<Vec<String>>,
    bounds: BTreeMap<String, Told<Bounds>>,
    starts: u16,
    #[serde(with = "crate::words")]
    calibrate: Calibration,
    noise: BTreeMap<String, f64>,
    photodiode: BTreeMap<String, usize>,
    force: Option<String>,
    area_cm2: Option<f64>,
    #[serde(with = "crate::words")]
    load: Pressed,
    #[serde(with = "crate::words")]
    between: Between,
    unloaded_before: bool,
    #[serde(with = "crate::words")]
    collapse: Collapse,
    #[serde(with = "crate::words")]
    optics: OpticsChoice,
    units: Option<u16>,
    set: Settings,
}

impl Default for Asked {
    fn default() -> Self {
        Self {
            free: None,
            bounds: BTreeMap::new(),
            starts: STARTS,
            calibrate: Calibration::default(),
            noise: BTreeMap::new(),
            photodiode: BTreeMap::new(),
            force: None,
            area_cm2: None,
            load: Pressed::default(),
            between: Between::default(),
            unloaded_before: false,
            collapse: Collapse::default(),
            optics: OpticsChoice::default(),
            units: None,
            set: Settings::new(),
        }
    }
}

fn prepare(mut table: toml::Table) -> Result<Arc<dyn Prepared>, KeyFault> {
    let log = LogKeys::take(&mut table)?;
    let asked: Asked = read(KEYS, table)?;
    let free = asked.free.clone();
    let free = free.ok_or_else(|| fault("free", "is needed, as [\"k_C\", \"b_C\"]; [] fits the photodiodes alone"))?;
    if !(1..=1000).contains(&asked.starts) {
        return Err(fault("starts", format!("{}: choose 1 to 1000", asked.starts)));
    }
    let positive = |value: f64| value > 0.0 && value.is_finite();
    if let Some((name, _)) = asked.noise.iter().find(|(_, noise_v)| !positive(**noise_v)) {
        return Err(fault("noise", format!("{name}: volts greater than 0, as 5e-5")));
    }
    let force = match (asked.force.clone(), asked.area_cm2) {
        (Some(name), Some(area_cm2)) if positive(area_cm2) => {
            Some(ForceColumn { name, area_m2: 1e-4 * area_cm2, pressed: asked.load })
        }
        (Some(_), _) => return Err(fault("area_cm2", "the area that `force` presses on, greater than 0, as 1")),
        (None, Some(_)) => return Err(fault("force", "is needed with `area_cm2`: the force's column, as \"Fz_N\"")),
        (None, None) => None,
    };
    let photodiodes = asked.photodiode.iter().map(|(name, unit)| PhotodiodeColumn::above(name, *unit));
    let options = FitOptions {
        recordings: Vec::new(),
        columns: RecordingColumns {
            between: asked.between,
            unloaded_before: asked.unloaded_before,
            force,
            photodiodes: photodiodes.collect::<Result<_, _>>().map_err(|why| fault("photodiode", why))?,
            log: log.reading.clone(),
        },
        subjects: Vec::new(),
        names: Vec::new(),
        free: if free == ["none"] { Vec::new() } else { free },
        bounds: asked.bounds.iter().map(|(name, bounds)| (name.clone(), bounds.value)).collect(),
        noise: asked.noise.iter().map(|(name, noise_v)| (name.clone(), *noise_v)).collect(),
        calibration: asked.calibrate,
        starts: usize::from(asked.starts),
        parameters: given(asked.units, &asked.set)?,
        collapse: asked.collapse,
        optics: asked.optics,
    };
    Ok(Arc::new(Fitting { asked, options, log }))
}

struct Fitting {
    asked: Asked,
    options: FitOptions,
    log: LogKeys,
}

fn outputs(folder: &Path, demand: &Demand) -> FitOutputs {
    FitOutputs { result: folder.join("fit.json"), figures: demand.parts.contains(PICTURES) }
}

/// Whose each recording is; none where not all say so.
fn subjects<'a>(keys: impl Iterator<Item = &'a Keys>) -> Vec<String> {
    keys.map(|keys| keys.get("subject").map(str::to_owned)).collect::<Option<Vec<_>>>().unwrap_or_default()
}

impl Prepared for Fitting {
    fn demand(&self, _role: &str, own: &Demand) -> Demand {
        Demand { joints: Some(Default::default()), clock: own.clock, ..Demand::default() }
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        self.log.tell(told(&self.asked, demand, &[PICTURES]))
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(FitJob { options: self.options.clone(), demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let own = || inputs.iter().filter(|input| input.role == RECORDINGS);
        let options = FitOptions {
            recordings: own().map(|input| input.path.clone()).collect(),
            subjects: subjects(own().map(|input| &input.keys)),
            parameters: of_foreseen(&self.options.parameters, inputs),
            ..self.options.clone()
        };
        let out = outputs(Path::new(""), demand);
        let mut steps = if all_stand(inputs) {
            fit_plan(&options, Some(&out)).map_err(|why| why.to_string())?
        } else {
            fit_outline(&options, Some(&out))
        };
        steps.insert(0, ambient_step(inputs, &[RECORDINGS], &self.log.reading));
        Ok(steps)
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts::default()
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let bytes = bytes(inputs.iter().filter(|input| input.role == RECORDINGS));
        let fits = f64::from(self.asked.starts) * (1.0 + self.options.free.len() as f64);
        (32_000_000 + 10 * bytes, 0.1 + fits * (0.05 + 2e-7 * bytes as f64))
    }
}

struct FitJob {
    options: FitOptions,
    demand: Demand,
}

impl Job for FitJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let options = FitOptions {
            recordings: work.of(RECORDINGS).map(|at| at.path.clone()).collect(),
            names: work.of(RECORDINGS).map(|at| at.name.clone()).collect(),
            subjects: subjects(work.of(RECORDINGS).map(|at| &at.keys)),
            parameters: of_task(&self.options.parameters, work),
            ..self.options.clone()
        };
        let outputs = outputs(work.folder, &self.demand);
        let report = in_pool(work.threads, || fit(&options, &outputs, work.stop))??;
        without_report(&outputs.result)?;
        // The result stands in the record.
        std::fs::remove_file(&outputs.result)?;
        let mut quality = stated(&report);
        if let Some(at) = work.one(TRUTH) {
            let truth = GivenParameters { file: Some(at.path.clone()), ..GivenParameters::default() }.read()?;
            quality.extend(against(&report, &truth));
        }
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

/// What the fit says of itself.
fn stated(report: &FitReport) -> Vec<Quality> {
    let of =
        |what: String, value: f64, unit: &str| Quality { what, value, unit: unit.to_owned(), against_truth: false };
    let mut quality = vec![of("voltages".to_owned(), report.residual_sd_v, "V, SD of the residuals")];
    for group in &report.free {
        let errors = group.standard_errors.iter().flatten();
        for ((name, value), error) in group.names.iter().zip(&group.values).zip(errors) {
            quality.push(of(name.clone(), (error / value).abs(), "of its value, standard error"));
        }
    }
    quality.retain(|one| one.value.is_finite());
    quality
}

/// What it is off what is true.
fn against(report: &FitReport, truth: &Parameters) -> Vec<Quality> {
    let one = |(name, value): (&String, &f64)| {
        let is = truth.get(name.parse().ok()?)?;
        let error = ((value - is) / is).abs();
        let unit = "of its true value".to_owned();
        error.is_finite().then_some(Quality { what: name.clone(), value: error, unit, against_truth: true })
    };
    report.free.iter().flat_map(|group| group.names.iter().zip(&group.values)).filter_map(one).collect()
}
