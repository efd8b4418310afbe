//! The files of a set, and whether its folders hold them only, so that another set may take its place.
//!
//! Files that the set did not write are somebody's own, and so are outlines beside photographs that are no longer those
//! of `truth/outlines`: corrected by hand. Photographs and truth that were changed are not recognized. A run that was
//! killed may have left its photographs beside the truth of the set before it; the same command, run again, replaces
//! both.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{fs, io};

use super::PhotoOptions;
use crate::labelme::{LabelMe, Shape, to_labelme};
use crate::phantom::nail::{NailScene, Pose, SceneFault};
use crate::phantom::scene::place::{Error, PHOTOS_RECORD as RECORD, refused};

/// The record's folder first: where it stands, what is of one run and what of another is made again.
pub(super) const RESULTS: [&str; 2] = ["truth", PHOTOS];
/// .. and last where a set replaces another: of a run that was killed between them, the record is that of the set
/// before, and its photographs are those that the same command writes again.
pub(super) const REPLACED: [&str; 2] = [PHOTOS, "truth"];
const PHOTOS: &str = "photos";

/// The files of a set, relative to its folder.
pub(super) fn files(set: &PhotoOptions) -> Vec<String> {
    let mut files = vec!["truth/nails.csv".to_owned(), RECORD.to_owned()];
    for pose in set.poses.iter().copied().map(Pose::name) {
        files.extend(["mean", "sd", "count"].map(|what| format!("truth/maps/{pose}-{what}.npy")));
        for name in (0..set.subjects).map(|subject| set.subject_name(subject)) {
            files.push(format!("photos/{pose}/{name}.{}", set.format.extension()));
            files.push(format!("truth/outlines/{pose}/{name}.json"));
            if set.annotate {
                files.push(format!("photos/{pose}/{name}.json"));
            }
            if set.truth_normalized {
                files.push(format!("truth/normalized/{pose}/{name}.npy"));
            }
        }
    }
    files
}

/// The LabelMe file of a scene: polygon `nail`, line `axis` from proximal to distal.
pub(in crate::phantom) fn annotation(scene: &NailScene, picture: &str) -> Result<LabelMe, SceneFault> {
    let nail = scene.outline()?.points().into_iter().map(to_labelme).collect();
    let axis = scene.axis_ends_px().map(to_labelme).to_vec();
    let shapes = vec![Shape::new("nail", "polygon", nail), Shape::new("axis", "line", axis)];
    Ok(LabelMe::new(picture, scene.camera.width, scene.camera.height, shapes))
}

/// Refuses to replace the set under `out` by that of `asked` where somebody's own files would go with it.
///
/// # Errors
/// [`Error::InTheWay`] with the first such file; a folder that can't be listed.
pub(super) fn only_own(asked: &PhotoOptions, out: &Path) -> Result<(), Error> {
    let record = fs::read(out.join(RECORD)).ok();
    let earlier = record.and_then(|text| serde_json::from_slice(&text).ok()).unwrap_or_else(|| asked.clone());
    let mut there = BTreeSet::new();
    for folder in RESULTS.map(|name| out.join(name)).iter().filter(|folder| folder.is_dir()) {
        files_below(folder, &mut there).map_err(refused(folder))?;
    }
    let files = |set: &PhotoOptions| -> BTreeSet<PathBuf> { files(set).iter().map(|name| out.join(name)).collect() };
    let photographs = |files: &BTreeSet<PathBuf>| -> BTreeSet<PathBuf> {
        files.iter().filter(|file| file.starts_with(out.join(PHOTOS))).cloned().collect()
    };
    let (mut written, new) = (files(&earlier), photographs(&files(asked)));
    if photographs(&there) == new {
        written.extend(new);
    }
    let in_the_way = |place: PathBuf, whose| Err(Error::InTheWay { place, whose });
    if let Some(place) = there.difference(&written).next() {
        return in_the_way(place.clone(), "of the synthetic set there, with which it would be deleted");
    }
    let outlines = photographs(&there).into_iter().filter(|file| file.extension().is_some_and(|end| end == "json"));
    match { outlines }.find(|file| !is_of_truth(file, out) && !is_of_set(file, asked, out)) {
        Some(place) => in_the_way(place, "as the synthetic set there had it, and the change would be lost"),
        None => Ok(()),
    }
}

/// Everything below a folder that is not a folder.
fn files_below(folder: &Path, files: &mut BTreeSet<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            files_below(&entry.path(), files)?;
        } else {
            files.insert(entry.path());
        }
    }
    Ok(())
}

/// Whether the outline beside a photograph is that of the truth, but for where the photograph is.
fn is_of_truth(outline: &Path, out: &Path) -> bool {
    let truth = outline.strip_prefix(out.join(PHOTOS)).map(|name| out.join("truth/outlines").join(name));
    let (Ok(own), Some(Ok(truth))) = (LabelMe::read(outline), truth.ok().map(|path| LabelMe::read(&path))) else {
        return false;
    };
    let photograph = truth.image_path.rsplit('/').next().unwrap_or_default().to_owned();
    own == LabelMe { image_path: photograph, ..truth }
}

/// Whether the outline beside a photograph is what `set` writes there, to the byte.
fn is_of_set(outline: &Path, set: &PhotoOptions, out: &Path) -> bool {
    let all = set.poses.iter().flat_map(|&pose| (0..set.subjects).map(move |subject| (pose, subject)));
    let place = |pose, name: &str| out.join(format!("{PHOTOS}/{pose}/{name}.json"));
    let Some((pose, subject)) = { all }.find(|&(pose, k)| place(pose, &set.subject_name(k)) == outline) else {
        return false;
    };
    let photograph = format!("{}.{}", set.subject_name(subject), set.format.extension());
    let text = annotation(&set.scene(subject, pose), &photograph).ok().and_then(|written| written.to_text().ok());
    text.is_some() && text == fs::read(outline).ok()
}
