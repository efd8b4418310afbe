//! `static` in a pipeline: every equilibrium of the hemodynamic model for a range of loads (Fig. 78).

use std::path::Path;

use super::job::{curve, plan, steps};
use super::{CurveOptions, CurveOutputs};
use crate::hemodynamics::given::{PARAMS, existing, of_foreseen, of_task};
use crate::job::{Demand, Facts, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Work};
use crate::stages::Step;

const PICTURES: &str = "pictures";
const TABLE: &str = "static.csv";

/// A stage of a pipeline.
#[derive(Debug, Clone)]
pub struct CurveJob(CurveOptions);

fn outputs(folder: &Path, demand: &Demand) -> CurveOutputs {
    CurveOutputs { table: folder.join(TABLE), figures: demand.wants(PICTURES), report: false }
}

impl Job for CurveJob {
    const KIND: Kind = Kind::of::<Self>(
        "static",
        &[PARAMS],
        &[
            Part { name: "curve", file: TABLE, only_if_wanted: false },
            Part { name: PICTURES, file: "", only_if_wanted: true },
        ],
    );

    type Options = CurveOptions;

    fn new(options: CurveOptions) -> Result<Self, OptionFault> {
        let fault = |what: String| OptionFault { key: String::new(), what };
        plan(None, &options, None).map_err(|why| fault(why.to_string()))?;
        Ok(Self(options))
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let outputs = outputs(Path::new(""), demand);
        if !existing(inputs) {
            return Ok(steps(&self.0, Some(&outputs), self.0.model.units.map(usize::from)));
        }
        let params = of_foreseen(PARAMS.name, inputs);
        plan(params.as_deref(), &self.0, Some(&outputs)).map_err(|why| why.to_string())
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(false), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (32_000_000, 0.02 + 1e-4 * self.0.range.loads.loads_pa().len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let params = of_task(PARAMS.name, work);
        let outputs = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| curve(params.as_deref(), &self.0, &outputs, watch))?;
        Ok(report.made(Vec::new()))
    }
}
