//! Pictures that tests draw.

use std::path::{Path, PathBuf};

/// A picture that was drawn.
pub(crate) struct Drawn {
    pub(crate) png: Vec<u8>,
    pub(crate) picture: image::RgbImage,
    pub(crate) svg: String,
}

/// Draws a picture; kept under `LUNULA_LOOK` when that is set.
pub(crate) fn drawn(name: &str, draw: impl FnOnce(&Path, &Path)) -> Drawn {
    let dir = tempfile::tempdir().unwrap();
    let folder = std::env::var_os("LUNULA_LOOK").map_or_else(|| dir.path().to_owned(), PathBuf::from);
    let (png, svg) = (folder.join(format!("{name}.png")), folder.join(format!("{name}.svg")));
    draw(&png, &svg);
    let (png, svg) = (std::fs::read(png).unwrap(), std::fs::read_to_string(svg).unwrap());
    Drawn { picture: image::load_from_memory(&png).unwrap().to_rgb8(), png, svg }
}
