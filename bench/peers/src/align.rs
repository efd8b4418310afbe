//! Labels from the same tables by pandas and numpy's interp; loading pandas is not counted.

use std::path::Path;

use lunula::tradeoff::align::{BRIDGING, LABEL_ERROR, labels};
use lunula::tradeoff::{Job, Timing};

use crate::Bench;
use crate::found::Found;
use crate::python::Package;

const SETTING: &str = "pandas, interp";
const PACKAGES: [Package; 2] = [("pandas", "pandas"), ("numpy", "numpy")];

pub(crate) fn measure(bench: &Bench, folder: &Path, found: &mut Found) -> anyhow::Result<()> {
    found.try_program("pandas", |found| {
        let version = bench.python.versions(&PACKAGES)?;
        let settings = bench.plan.align(folder)?;
        let labels = labels(&settings, folder)?;
        let training = folder.join("training.csv");
        let [joints, log, out] = [&labels.joints, &settings.log, &training].map(|path| path.display().to_string());
        let arguments = [joints.as_str(), &log, &out, &bench.plan.effort.repeats.to_string()];
        let answers = bench.python.answers("align.py", folder, &arguments)?;
        let time = Timing::of(answers.into_iter().flat_map(|answer| answer.seconds).collect());
        let (error, rows) = labels.error(&training)?;
        found.add((Job::Align, BRIDGING.1), SETTING, (error, LABEL_ERROR), time, rows, &version);
        Ok(())
    });
    Ok(())
}
