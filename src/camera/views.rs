//! Photographs and frames to boards' corners.
//!
//! In: photographs, folders of them, videos. Out: for each picture that was looked at its size, how it was turned to be
//! upright, and the corners of its board or why there are none. Corners are in pixels of the upright picture, which is
//! what `lunula posture` and `lunula photos` measure in. Photographs are looked at side by side; the order of what
//! comes out is that of the names.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::board::BoardSize;
use super::error::CameraError;
use super::options::CameraOptions;
use crate::input;
use crate::job::Watch;
use crate::photograph::{Photograph, is_picture};
use crate::stages::Stages;
use crate::video::{Frame, Item, Plane, Turn, Video};
use crate::vision::{Corners, Grey, Sought, VisionError, find_board, shows_another};

/// A picture that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Look {
    /// The file, and of a video the frame.
    pub(super) name: String,
    /// Width and height, upright, and how it was turned.
    pub(super) kind: Kind,
    /// The corners, row after row; or why there are none.
    pub(super) board: Result<Corners, String>,
    /// The size of another board that it may show: inner corners across and down.
    other: Option<[usize; 2]>,
}

/// What all views have to have in common.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Kind {
    /// Width and height, upright.
    pub(super) size: (usize, usize),
    /// How the stored picture was turned: 0 not at all, else one number for each way.
    pub(super) turned: u8,
}

/// The files to look at, folders unfolded, in the order of their names.
pub(super) fn files(sources: &[PathBuf]) -> Result<Vec<PathBuf>, CameraError> {
    let mut files = Vec::new();
    for source in sources {
        let refused = |why: String| CameraError::Input { path: source.clone(), why };
        if source.exists() && !source.is_dir() {
            files.push(source.clone());
            continue;
        }
        let mut own = input::list(source).map_err(|why| refused(why.to_string()))?;
        own.retain(|path| path.is_file() && is_picture(path));
        if own.is_empty() {
            return Err(refused("holds no photographs (png, jpg, tif, bmp); name the folder of the views".to_owned()));
        }
        files.extend(own);
    }
    Ok(files)
}

/// Looks at all files. Where the first shows a board of another size, the others are looked at for that first.
pub(super) fn look(
    files: &[PathBuf],
    options: &CameraOptions,
    stages: &Stages,
    watch: &Watch<'_>,
) -> Result<Vec<Look>, CameraError> {
    let done = AtomicU64::new(0);
    let one = |path: &PathBuf, other: Option<[usize; 2]>| -> Result<Vec<Look>, CameraError> {
        watch.go_on()?;
        let looks = if is_picture(path) {
            vec![photograph(path, options, other, stages)?]
        } else {
            of_video(path, options, other, stages, watch)?
        };
        (watch.tick)(done.fetch_add(1, Ordering::Relaxed) + 1, Some(files.len() as u64));
        Ok(looks)
    };
    let Some((first, rest)) = files.split_first() else { return Ok(Vec::new()) };
    let mut looks = one(first, None)?;
    let other = looks.first().and_then(|look| look.other);
    let rest: Vec<Vec<Look>> =
        rest.par_iter().with_max_len(1).map(|path| one(path, other)).collect::<Result<_, _>>()?;
    looks.extend(rest.into_iter().flatten());
    Ok(looks)
}

fn photograph(
    path: &Path,
    options: &CameraOptions,
    other: Option<[usize; 2]>,
    stages: &Stages,
) -> Result<Look, CameraError> {
    let name = path.display().to_string();
    let photograph = match stages.time("read", || Photograph::read(path)) {
        Ok(photograph) => photograph,
        Err(why) => return Ok(Look { name, kind: Kind::default(), board: Err(why.to_string()), other: None }),
    };
    let turned = photograph.orientation.to_exif() - 1;
    let picture = photograph.image.into_luma8();
    let size = (picture.width() as usize, picture.height() as usize);
    let grey = Grey { width: size.0, height: size.1, data: picture.as_raw() };
    let Seen { board, other } = stages.time("corners", || board(grey, options.board, other))?;
    Ok(Look { name, kind: Kind { size, turned }, board, other })
}

/// What a picture shows.
struct Seen {
    /// The corners of the only board, or why there are none.
    board: Result<Corners, String>,
    /// The size of another that may be there.
    other: Option<[usize; 2]>,
}

/// Looks for the board.
fn board(picture: Grey<'_>, size: BoardSize, other: Option<[usize; 2]>) -> Result<Seen, VisionError> {
    let other = match find_board(picture, size.columns, size.rows, other)? {
        Sought::Whole(corners) => {
            let is_one = !shows_another(picture, &corners, size.columns, size.rows)?;
            let board = is_one.then_some(corners).ok_or("shows two boards; cover one of them".to_owned());
            return Ok(Seen { board, other: None });
        }
        Sought::OfSize(other) => Some(other),
        Sought::Nowhere => None,
    };
    let other_words = other.map_or(String::new(), |[columns, rows]| format!(", but one of {columns}x{rows}"));
    let why = format!(
        "no board of {size} inner corners is seen whole{other_words}; all of it has to be in the picture, lit evenly, \
         with a white margin (--board counts inner corners, not squares)"
    );
    Ok(Seen { board: Err(why), other })
}

/// A frame's luma as it is stored, 8 bits.
struct Still {
    index: u64,
    size: (usize, usize),
    data: Vec<u8>,
}

fn of_video(
    path: &Path,
    options: &CameraOptions,
    mut other: Option<[usize; 2]>,
    stages: &Stages,
    watch: &Watch<'_>,
) -> Result<Vec<Look>, CameraError> {
    let mut video = Video::open(path, options.threads)?;
    let turn = video.info().turn;
    let (mut looks, mut stills, mut next_s) = (Vec::new(), Vec::new(), f64::NEG_INFINITY);
    let name = |index: u64| format!("{}: frame {index}", path.display());
    let mut see = |stills: &mut Vec<Still>, looks: &mut Vec<Look>| -> Result<(), CameraError> {
        let all = stills.par_iter().with_max_len(1).map(|still| {
            let grey = Grey { width: still.size.0, height: still.size.1, data: &still.data };
            let Seen { board, other } = stages.time("corners", || board(grey, options.board, other))?;
            let shown = board.map(|corners| corners.into_iter().map(|at| upright(at, turn, still.size)).collect());
            let kind = Kind { size: turn.shown_size(still.size), turned: turn.quarters() as u8 };
            Ok(Look { name: name(still.index), kind, board: shown, other })
        });
        looks.extend(all.collect::<Result<Vec<Look>, VisionError>>()?);
        other = looks.first().and_then(|look| look.other);
        stills.clear();
        Ok(())
    };
    while let Some(item) = stages.time("decode", || video.next_item())? {
        watch.go_on()?;
        let Item::Frame(frame) = item else { continue };
        if frame.time_s < next_s {
            continue;
        }
        next_s = frame.time_s + options.every;
        stills.push(still(&frame));
        if looks.is_empty() || stills.len() >= rayon::current_num_threads() {
            see(&mut stills, &mut looks)?;
        }
    }
    see(&mut stills, &mut looks)?;
    Ok(looks)
}

fn still(frame: &Frame<'_>) -> Still {
    let Plane { width, height, .. } = frame.luma;
    let mut row = vec![0.0_f32; width];
    let mut data = Vec::with_capacity(width * height);
    for y in 0..height {
        frame.luma.copy_row(y, 0, &mut row);
        data.extend(row.iter().map(|value| value.round() as u8));
    }
    Still { index: frame.index, size: (width, height), data }
}

fn upright([x, y]: [f32; 2], turn: Turn, size: (usize, usize)) -> [f32; 2] {
    turn.shown_from_stored([f64::from(x), f64::from(y)], size).map(|at| at as f32)
}
