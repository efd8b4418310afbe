//! Maps, sums and figures of every pose.

use ndarray::Array2;
use ndarray_npy::{WritableElement, WriteNpyExt};
use rayon::prelude::*;

use super::draw::{DrawnPose, DrawnSheet, draw_pose, draw_sheets};
use crate::files::{Staging, WriteError};
use crate::photo::normalize::Normalization;
use crate::photo::sums::{Member, Partials, Sums, bytes, bytes_of_part, part_name};
use crate::stages::Stages;

/// A pose's sums, for [`gather`](fn@crate::photo::gather); returns what the list of them says.
pub(in crate::photo) fn write_sums(
    pose: &str,
    sums: &Sums,
    with: &Normalization,
    staging: &Staging,
    stages: &Stages,
) -> Result<Member, WriteError> {
    stages.time("write sums", || {
        let name = part_name(pose);
        let file = bytes_of_part(pose, sums, with).map_err(|why| staging.refused(&name, why))?;
        staging.write(&name, &file)?;
        Ok(Member::of(sums, &file))
    })
}

/// A pose's maps and partial sums, and where they are wanted its figures.
pub(in crate::photo) fn write_pose(
    pose: &str,
    sums: &Sums,
    with: &Normalization,
    figures: bool,
    staging: &Staging,
    stages: &Stages,
) -> Result<Option<DrawnPose>, WriteError> {
    let maps = stages.time("maps", || sums.maps());
    stages.time("write maps", || {
        write_npy(&maps.mean, staging, &format!("maps/{pose}-mean.npy"))?;
        write_npy(&maps.sd, staging, &format!("maps/{pose}-sd.npy"))?;
        write_npy(&maps.count, staging, &format!("maps/{pose}-count.npy"))?;
        let name = format!("maps/{pose}.partial.npz");
        staging.write(&name, &bytes(pose, sums, with).map_err(|why| staging.refused(&name, why))?)
    })?;
    let draw = || stages.time("figures", || draw_pose(pose, sums.subjects().len(), &maps, staging));
    figures.then(draw).transpose()
}

/// [`write_pose`] of every pose; returns the sheets over all of them.
pub(in crate::photo) fn write_maps(
    partials: &Partials,
    figures: bool,
    staging: &Staging,
    stages: &Stages,
) -> Result<Vec<DrawnSheet>, WriteError> {
    let poses: Vec<(&String, &Sums)> = partials.poses.iter().collect();
    let write =
        |(pose, sums): &(&String, &Sums)| write_pose(pose, sums, &partials.normalization, figures, staging, stages);
    let drawn: Vec<Option<DrawnPose>> = poses.par_iter().map(write).collect::<Result<_, WriteError>>()?;
    if !figures {
        return Ok(Vec::new());
    }
    staging.sync_meanwhile(|| stages.time("sheets", || draw_sheets(drawn.into_iter().flatten().collect(), staging)))
}

/// Writes an array as the result `name`.
pub(crate) fn write_npy<T: WritableElement>(
    array: &Array2<T>,
    staging: &Staging,
    name: &str,
) -> Result<(), WriteError> {
    let mut bytes = Vec::new();
    array.write_npy(&mut bytes).map_err(|why| staging.refused(name, why))?;
    staging.write(name, &bytes)
}
