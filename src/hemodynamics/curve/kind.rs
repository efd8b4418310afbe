//! `static` in a pipeline: every equilibrium of the hemodynamic model for a range of loads (Fig. 78).

use std::path::Path;

use super::job::{curve, plan, steps};
use super::{CurveOptions, CurveOutputs};
use crate::hemodynamics::given::{PARAMS, existing, of_foreseen, of_task};
use crate::job::{Demand, Facts, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Work};
use crate::stages::Step;

const PICTURES: &str = "pictures";
const TABLE: &str = "static.csv";

fn outputs(folder: &Path, demand: &Demand) -> CurveOutputs {
    CurveOutputs { table: folder.join(TABLE), figures: demand.wants(PICTURES), report: false }
}

impl Job for CurveOptions {
    const KIND: Kind =
        Kind::of::<Self>("static", &[PARAMS], &[Part::new("curve", TABLE), Part::if_wanted(PICTURES, "")]);

    fn checked(self) -> Result<Self, OptionFault> {
        plan(None, &self, None).map_err(OptionFault::whole)?;
        Ok(self)
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let outputs = outputs(Path::new(""), demand);
        if !existing(inputs) {
            return Ok(steps(self, Some(&outputs), self.model.units.map(usize::from)));
        }
        let params = of_foreseen(PARAMS.name, inputs);
        plan(params.as_deref(), self, Some(&outputs)).map_err(|why| why.to_string())
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(false), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (32_000_000, 0.02 + 1e-4 * self.range.loads.loads_pa().len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let params = of_task(PARAMS.name, work);
        let outputs = outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| curve(params.as_deref(), self, &outputs, watch))?;
        Ok(report.made(Vec::new()))
    }
}
