//! Blobs of a marker's colour in a frame, or in a part of it.
//!
//! A frame's planes and the colours of markers go in; for each colour the compact spots that stand out in it come out,
//! each with its place in the stored picture, area, shape and colour. Nothing is converted: a chromatic colour is
//! looked for in the chroma planes alone (a quarter of a 4:2:0 picture), along its own direction from grey, so that
//! light and shade scale what is seen and do not turn it; black, grey and white markers, and grey video, are looked for
//! in luma.
//!
//! The spots are nodes of the plane's component tree (Najman and Couprie 2006, DOI 10.1109/TIP.2006.877518), as in
//! maximally stable extremal regions (Matas et al. 2004, DOI 10.1016/j.imavis.2004.02.006), chosen by their own
//! criterion:
//! how far the level falls from the core of a spot to where it has grown to four times its area. That needs no
//! threshold on the colour: a marker on a ground of about its colour is a spot still, the ground itself is none. Places
//! are good to about a sample of the grid looked at; [`crate::posture::centre`] does better.

mod grid;
mod paint;
mod tree;

pub(crate) use grid::Area;
pub(crate) use paint::Paint;

use grid::Grid;
use tree::Tree;

use crate::video::Frame;

/// A spot of a marker's colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Blob {
    /// Its centroid in the stored picture.
    pub(crate) at_px: [f64; 2],
    /// Its area at half its contrast, in luma samples.
    pub(crate) area_px2: f64,
    /// How far it stands out from what surrounds it, as a share of the colour's own distance from grey.
    pub(crate) contrast: f64,
    /// The longer over the shorter half axis of the ellipse with its second moments.
    pub(crate) elongation: f64,
    /// Its area over that ellipse's: 1 for a disc or an ellipse, less for anything ragged or hollow.
    pub(crate) fill: f64,
    /// Y', Cb and Cr about its centre.
    pub(crate) colour: [f64; 3],
    /// It touches the border of the picture.
    pub(crate) at_the_border: bool,
}

impl Blob {
    /// Radius of a disc of its area.
    pub(crate) fn radius_px(&self) -> f64 {
        (self.area_px2 / std::f64::consts::PI).sqrt()
    }
}

/// How far apart two places are.
pub(in crate::posture) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Looks for spots; keeps its working memory from one search to the next.
#[derive(Debug, Default)]
pub(crate) struct Finder {
    grid: Grid,
    tree: Tree,
    /// Grid samples looked at so far.
    pub(crate) samples: u64,
}

impl Finder {
    /// Loads the samples of `area` of a frame (of all of it without one), for one search or several.
    pub(crate) fn load(&mut self, frame: &Frame<'_>, area: Option<Area>) {
        self.grid.load(frame, area);
        self.samples += (self.grid.width * self.grid.height) as u64;
    }

    /// The spots of `paint` in what was loaded last, the most outstanding first, into `blobs`; none that the loaded
    /// area cuts.
    pub(crate) fn find(&mut self, frame: &Frame<'_>, paint: &Paint, blobs: &mut Vec<Blob>) {
        blobs.clear();
        if self.grid.width == 0 || self.grid.height == 0 {
            return;
        }
        paint.levels(&mut self.grid, frame);
        self.tree.spots(&self.grid, paint.least_contrast());
        for spot in self.tree.found.iter().filter(|spot| !self.grid.cuts(spot)) {
            blobs.push(self.grid.blob(frame, spot));
        }
    }
}

#[cfg(test)]
mod tests;
