//! What a run would do and leave out.

use crate::job::Outputs;
use crate::layout::options::{LayoutInputs, LayoutOptions};
use crate::layout::read::is_maps;
use crate::stages::Step;

/// Plans a run; `outputs` may have no place yet.
#[must_use]
pub fn plan(inputs: &LayoutInputs, options: &LayoutOptions, outputs: &Outputs) -> Vec<Step> {
    let maps = matches!(&inputs.data[..], [one] if is_maps(&one.path));
    steps(inputs.data.len(), maps, options, outputs)
}

/// The one table of steps: the plan shows them, a run's report lists those that are left out.
pub(in crate::layout) fn steps(files: usize, maps: bool, options: &LayoutOptions, outputs: &Outputs) -> Vec<Step> {
    let what = if maps { "maps and normalized pictures".to_owned() } else { format!("{files} tables or logs") };
    let figures = outputs.figures;
    let proof = options.proof > 0.0;
    let budget = format!("branch and bound, at most {} billion multiply-adds for each number", options.proof);
    vec![
        Step::new("read", true, what),
        Step::new(
            "search",
            true,
            format!("{} photodiodes: greedy and exchange from {} starts", options.k, options.starts),
        ),
        Step::new("proof", proof, if proof { budget } else { "--proof 0".to_owned() }),
        Step::new("left out", true, "chosen again without each person".to_owned()),
        Step::figures(figures, "places, error against number"),
    ]
}
