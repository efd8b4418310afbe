//! `static` in a pipeline: every equilibrium of the hemodynamic model for a range of loads (Fig. 78).

use super::CurveOptions;
use super::job::{curve, plan, steps};
use crate::hemodynamics::given::{PARAMS, existing, of_foreseen, of_task};
use crate::job::{Demand, Facts, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Work};
use crate::stages::Step;

const TABLE: &str = "static.csv";

impl Job for CurveOptions {
    const KIND: Kind = Kind::of::<Self>("static", &[PARAMS], &[Part::new("curve", TABLE), Part::pictures("")]);

    fn checked(self) -> Result<Self, OptionFault> {
        plan(None, &self, &Demand::default().outputs("")).map_err(OptionFault::whole)?;
        Ok(self)
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let outputs = demand.outputs(TABLE);
        if !existing(inputs) {
            return Ok(steps(self, &outputs, self.model.units.map(usize::from)));
        }
        let params = of_foreseen(PARAMS.name, inputs);
        plan(params.as_deref(), self, &outputs).map_err(|why| why.to_string())
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(false), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        (32_000_000, 0.02 + 1e-4 * self.range.loads.loads_pa().len() as f64)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let params = of_task(PARAMS.name, work);
        let outputs = order.demand.outputs(work.folder.join(TABLE));
        let report = work.run(order.said, |watch| curve(params.as_deref(), self, &outputs, watch))?;
        Ok(report.made(Vec::new()))
    }
}
