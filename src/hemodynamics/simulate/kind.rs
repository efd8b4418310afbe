//! `simulate` in a pipeline: the hemodynamic model under loads over time (4.3).

use std::path::PathBuf;

use super::job::{plan, simulate, steps};
use super::{SimulateInputs, SimulateOptions};
use crate::hemodynamics::given::{PARAMS, Start, existing, of_foreseen, of_task};
use crate::job::{Demand, Facts, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Quality, Role, Takes, Work};
use crate::stages::Step;

const TABLE: &str = "trajectory.csv";
const LOADS: &str = "loads";
const START: &str = "start";

impl SimulateOptions {
    /// The stage's files and options; the error says what is given twice.
    fn with(&self, of: impl Fn(&str) -> Option<PathBuf>) -> Result<(SimulateInputs, SimulateOptions), &'static str> {
        let inputs = SimulateInputs { params: of(PARAMS.name), loads: of(LOADS) };
        if inputs.loads.is_some() && (self.loads.pf1.is_some() || self.loads.pf2.is_some()) {
            return Err("`loads` replaces `pf1` and `pf2`: leave one or the other out");
        }
        let start = match (self.start.clone(), of(START)) {
            (Some(_), Some(_)) => return Err("`start` and `from` both say where it starts: leave one out"),
            (own, path) => path.map(Start::File).or(own),
        };
        Ok((inputs, SimulateOptions { start, ..self.clone() }))
    }
}

impl Job for SimulateOptions {
    const KIND: Kind = Kind::of::<Self>(
        "simulate",
        &[
            PARAMS,
            Role::new(LOADS, Takes::Optional, "a table time_s,pf1_Pa,pf2_Pa instead of pf1 and pf2"),
            Role::new(START, Takes::Optional, "a trajectory whose last row it starts from"),
        ],
        &[Part::new("trajectory", TABLE), Part::pictures("")],
    )
    .revision(3);

    fn checked(self) -> Result<Self, OptionFault> {
        if let Some(Start::File(path)) = &self.start {
            let what = format!("`{}`: write zero; the trajectory to start from is the input `{START}`", path.display());
            return Err(OptionFault { key: "from".to_owned(), what });
        }
        // The numbers are checked with the parameters, which may be a file's: a fault with the thesis' is one with any.
        plan(&SimulateInputs::default(), &self, &Demand::default().outputs("")).map_err(OptionFault::whole)?;
        Ok(self)
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let (files, options) = self.with(|role| of_foreseen(role, inputs))?;
        let outputs = demand.outputs(TABLE);
        if existing(inputs) {
            plan(&files, &options, &outputs).map_err(|why| why.to_string())
        } else {
            Ok(steps(&options, &outputs, options.model.units.map(usize::from)))
        }
    }

    fn facts(&self, _inputs: &[Foreseen], _demand: &Demand) -> Facts {
        Facts { led: Some(false), forces: Some(false), ..Facts::default() }
    }

    fn cost(&self, _inputs: &[Foreseen]) -> (u64, f64) {
        let walls = f64::from(self.model.units.unwrap_or(2)) + 1.0;
        let values = self.rows() * (3.0 * walls + 4.0);
        (32_000_000 + (40.0 * values) as u64, 0.02 + 1e-7 * values + 2e-3 * self.until_s * walls)
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let (inputs, options) = self.with(|role| of_task(role, work)).map_err(anyhow::Error::msg)?;
        let outputs = order.demand.outputs(work.folder.join(TABLE));
        let report = work.run(order.said, |watch| simulate(&inputs, &options, &outputs, watch))?;
        let quality = Quality::stated("lumens", report.rtol, "of the nominal diameter, at most");
        Ok(report.made(vec![quality]))
    }
}
