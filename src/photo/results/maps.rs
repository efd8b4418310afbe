//! Maps, sums and figures of every pose.

use std::io::{BufWriter, Write};

use ndarray::Array2;
use ndarray_npy::WriteNpyExt;
use rayon::prelude::*;

use super::draw::{DrawnSheet, draw_pose, draw_sheets};
use crate::files::{Staging, WriteError};
use crate::photo::sums::{Maps, Member, Members, Partials, Sums, part_name, write_part, write_partial};
use crate::stages::Stages;

/// Sums of every pose and the list of them, for [`gather`](fn@crate::photo::gather).
pub(in crate::photo) fn write_sums(partials: &Partials, staging: &Staging, stages: &Stages) -> Result<(), WriteError> {
    stages.time("write sums", || {
        let mut members = Members::new(partials.normalization);
        for (pose, sums) in &partials.poses {
            let name = part_name(pose);
            let refused = |why: anyhow::Error| staging.refused(&name, why);
            let file = write_part(&staging.place(&name)?, pose, sums, &partials.normalization).map_err(refused)?;
            members.add(pose, Member::of(sums, &file));
        }
        members.write(staging)
    })
}

/// Maps and partial sums of every pose, and where they are wanted figures; returns the sheets over all poses.
pub(in crate::photo) fn write_maps(
    partials: &Partials,
    figures: bool,
    staging: &Staging,
    stages: &Stages,
) -> Result<Vec<DrawnSheet>, WriteError> {
    let poses: Vec<(&String, &Sums)> = partials.in_order();
    let write = |(pose, sums): &(&String, &Sums)| {
        let maps = stages.time("maps", || sums.maps());
        stages.time("write maps", || {
            write_npy(&maps.mean, staging, &format!("maps/{pose}-mean.npy"))?;
            write_npy(&maps.sd, staging, &format!("maps/{pose}-sd.npy"))?;
            write_npy(&maps.count, staging, &format!("maps/{pose}-count.npy"))?;
            let name = format!("maps/{pose}.partial.npz");
            let path = staging.place(&name)?;
            write_partial(&path, pose, sums, &partials.normalization).map_err(|why| staging.refused(&name, why))
        })?;
        Ok(figures.then_some(maps))
    };
    let maps: Vec<Option<Maps>> = poses.par_iter().map(write).collect::<Result<_, WriteError>>()?;
    if !figures {
        return Ok(Vec::new());
    }
    staging.sync_meanwhile(|| {
        let drawn = poses.par_iter().zip(maps).filter_map(|((pose, sums), maps)| {
            let (maps, subjects) = (maps?, sums.subjects().len());
            Some(stages.time("figures", || draw_pose(pose, subjects, &maps, staging)))
        });
        let drawn = drawn.collect::<Result<_, WriteError>>()?;
        stages.time("sheets", || draw_sheets(drawn, staging))
    })
}

fn write_npy<T: ndarray_npy::WritableElement>(
    array: &Array2<T>,
    staging: &Staging,
    name: &str,
) -> Result<(), WriteError> {
    let file = std::fs::File::create(staging.place(name)?).map_err(|why| staging.refused(name, why))?;
    let mut file = BufWriter::new(file);
    array.write_npy(&mut file).map_err(|why| staging.refused(name, why))?;
    file.flush().map_err(|why| staging.refused(name, why))
}
