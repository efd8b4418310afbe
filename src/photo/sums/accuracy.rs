//! How far maps are from the exact ones, and how far a mean can be by its subjects' spread.

use std::path::Path;

use super::maps::Maps;
use super::partial::Partials;
use crate::npy;
use crate::photo::error::MergeError;

/// Errors of maps in 255ths of full scale, root mean squares over the pixels of all poses; `None` where nothing could
/// be compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Accuracy {
    /// The mean map's, against the exact one.
    pub mean_of_255: Option<f64>,
    /// The SD map's, against the exact one.
    pub sd_of_255: Option<f64>,
    /// Standard error of the mean map over subjects.
    pub standard_error_of_255: Option<f64>,
}

impl Accuracy {
    /// Of maps; `truth` is a folder of `<pose>-mean.npy` and `<pose>-sd.npy`.
    pub(super) fn of(partials: &Partials, truth: Option<&Path>) -> Result<Self, MergeError> {
        let (mut mean, mut sd, mut spread) = (Rms::default(), Rms::default(), Rms::default());
        for (pose, sums) in &partials.poses {
            let maps: Maps = sums.maps();
            for (map, name, rms) in [(&maps.mean, "mean", &mut mean), (&maps.sd, "sd", &mut sd)] {
                let Some(file) = truth.map(|folder| folder.join(format!("{pose}-{name}.npy"))) else { continue };
                if !file.exists() {
                    continue;
                }
                let wrong = |why: String| MergeError::Truth { file: file.clone(), why };
                let exact = npy::read::<f32>(&file).map_err(|why| {
                    let name = "name a folder with <pose>-mean.npy and <pose>-sd.npy";
                    wrong(format!("cannot be read as a map ({why}); {name}"))
                })?;
                if exact.dim() != map.dim() {
                    return Err(wrong("is of another size than the maps; make both with one `size`".into()));
                }
                map.iter().zip(&exact).for_each(|(map, exact)| rms.add(f64::from(*map) - f64::from(*exact)));
            }
            let cells = maps.sd.iter().zip(&maps.count);
            cells.for_each(|(sd, count)| spread.add(f64::from(*sd) / f64::from(*count).sqrt()));
        }
        let [mean_of_255, sd_of_255, standard_error_of_255] = [mean, sd, spread].map(Rms::of_255);
        Ok(Self { mean_of_255, sd_of_255, standard_error_of_255 })
    }
}

/// A root mean square in the making.
#[derive(Default)]
struct Rms {
    squares: f64,
    count: usize,
}

impl Rms {
    fn add(&mut self, difference: f64) {
        if difference.is_finite() {
            self.squares += difference * difference;
            self.count += 1;
        }
    }

    fn of_255(self) -> Option<f64> {
        (self.count > 0).then(|| (self.squares / self.count as f64).sqrt() * 255.0)
    }
}
