//! OpenCV's recipe on the same frames as lunula's tracker.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use lunula::posture::{Joint, Layout, Marker};
use lunula::table::Table;
use lunula::tradeoff::posture::{Angles, TRACKING};
use lunula::tradeoff::{Job, Timing};
use lunula::video::Video;

use crate::Bench;
use crate::found::Found;
use crate::recipe::{self, Recipe, Wanted};

const NAME: &str = "OpenCV: BGR, HSV, inRange, contours";

pub(crate) fn measure(bench: &Bench, folder: &Path, found: &mut Found) -> anyhow::Result<()> {
    let settings = bench.plan.posture(folder)?;
    let layout = Layout::read(&settings.markers)?;
    let truth = Angles::read(&settings.truth.join("joints.csv"), &layout)?;
    let wanted = wanted(&layout, &settings.truth)?;
    let run = || recipe::run(&settings.video, settings.effort.threads, &wanted);
    let first = run()?;
    let mut seconds = vec![seconds(&first)];
    for _ in 1..settings.effort.repeats {
        seconds.push(self::seconds(&run()?));
    }
    let time = Timing::of(seconds);
    let format = Video::open(&settings.video, settings.effort.threads)?.info().format;
    // Every sample of every plane is converted.
    let work = (format.width * format.height) as u64;
    let version = format!("OpenCV {}, in Rust", opencv::core::get_version_string()?);
    for (unit, error) in angles(&first, &layout).errors(&truth, &layout)? {
        found.add((Job::Posture, TRACKING.1), NAME, (error, &unit), time, work, &version);
    }
    Ok(())
}

/// Of a frame, without decoding.
fn seconds(recipe: &Recipe) -> f64 {
    (recipe.bgr_s + recipe.opencv_s) / recipe.frames.len() as f64
}

/// The markers, with where they are at first.
fn wanted(layout: &Layout, truth: &Path) -> anyhow::Result<Vec<Wanted>> {
    let table = Table::read(&truth.join("tracks.csv"))?;
    let names = table.texts("marker")?;
    let (x_px, y_px) = (table.numbers("x_px")?, table.numbers("y_px")?);
    let first = |name: &str| {
        let row = names.iter().position(|other| other.as_deref() == Some(name))?;
        Some([x_px[row]?, y_px[row]?])
    };
    let wanted =
        |marker: &Marker| Wanted { name: marker.name.clone(), srgb: marker.colour, start_px: first(&marker.name) };
    Ok(layout.markers.iter().map(wanted).collect())
}

/// From the recipe's centroids, as somebody would who knows of no lens.
fn angles(recipe: &Recipe, layout: &Layout) -> Angles {
    let angle = |places: &[Option<[f64; 2]>], joint: &Joint| {
        let [proximal, distal] = joint.segments.map(|segment| {
            let [a, b] = layout.segments[segment].markers.map(|marker| places[marker]);
            let (a, b) = (a?, b?);
            Some((b[1] - a[1]).atan2(b[0] - a[0]))
        });
        let turned = layout.flexion.sign() * (distal? - proximal?) - joint.zero_rad;
        Some((turned + PI).rem_euclid(TAU).to_degrees() - 180.0)
    };
    let column = |joint: &Joint| recipe.frames.iter().map(|frame| angle(&frame.at_px, joint)).collect();
    Angles::new(layout.joints.iter().map(column).collect())
}

#[cfg(test)]
mod tests {
    use lunula::tradeoff::{Effort, Plan};

    use super::*;
    use crate::python::Python;

    /// The tracker's error is below this share of the recipe's on the joint that moves most; measured 0.18.
    const FAR_BETTER: f64 = 0.5;

    #[test]
    fn the_tracker_is_far_better_than_the_recipe_on_the_same_frames() {
        let effort = Effort { repeats: 1, quick: true, ..Effort::default() };
        let bench = Bench { plan: Plan::new(1, effort, Vec::new()), python: Python::new("no-such-python") };
        let folder = tempfile::tempdir().unwrap();
        let mut found = Found::default();
        measure(&bench, folder.path(), &mut found).unwrap();
        let ours = lunula::tradeoff::posture::measure(&bench.plan.posture(folder.path()).unwrap()).unwrap();
        let theirs = found.rows.iter().find(|row| row.error_unit.starts_with("J3")).unwrap();
        let default = ours.rows.iter().find(|row| row.error_unit.starts_with("J3")).unwrap();
        assert_eq!(default.setting, "fitted to a standstill");
        assert!(default.error <= FAR_BETTER * theirs.error, "{} and {}", default.error, theirs.error);
    }
}
