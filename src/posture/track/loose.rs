//! Markers on no segment: any single thing of a colour, a ball as well as a disc.
//!
//! Where no disc can be fitted (texture, motion blur, fingers about it), the blob of its colour gives the place, with a
//! standard error to match. Angles never come from such places, for no segment has such a marker.

use crate::posture::marker::fit::Fit;
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::sight::Centre;
use crate::posture::survey::find::Blob;
use crate::posture::survey::naming::Point;
use crate::video::Frame;

/// Standard error of a blob's centroid: a share of its radius, and a part of a sample.
const ERROR_RADII: f64 = 0.12;
const ERROR_PX: f64 = 0.5;
/// Shapes that are still a thing seen whole.
const LONGEST: f64 = 3.0;
const LEAST_FILL: f64 = 0.75;
/// Distance of the surround's samples, in radii.
const SURROUND_RADII: f64 = 1.8;

/// The looks of a thing that is no clean disc.
pub(crate) fn look(frame: &Frame<'_>, point: &Point) -> Look {
    let (across, down) = frame.subsampling();
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for k in 0..16 {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 16.0).sin_cos();
        let [x, y] = [cos, sin].map(|part| SURROUND_RADII * point.radius_px * part);
        let [x, y] = [point.at_px[0] + x, point.at_px[1] + y];
        if x >= 0.0 && y >= 0.0 && (x as usize) < frame.luma.width && (y as usize) < frame.luma.height {
            let (x, y) = (x as usize, y as usize);
            sum[0] += f64::from(frame.luma.sample(x, y));
            if let Some(chroma) = frame.chroma {
                for plane in 0..2 {
                    sum[plane + 1] += f64::from(chroma[plane].sample(x / across, y / down));
                }
            }
            count += 1.0;
        }
    }
    let background = sum.map(|value| value / f64::max(count, 1.0));
    let plain = Look::plain(point.radius_px, point.colour, background);
    Look { blur_px: 0.3 * point.radius_px, misfit: 0.02, least_misfit: 0.02, noise: [2.0; 3], ..plain }
}

/// The place of a blob of the marker of this look; none if it is not one compact thing.
pub(super) fn fit(look: &Look, blob: &Blob) -> Option<Fit> {
    if blob.at_the_border || blob.elongation > LONGEST || blob.fill < LEAST_FILL {
        return None;
    }
    let variance = (ERROR_RADII * blob.radius_px()).powi(2) + ERROR_PX * ERROR_PX;
    let covariance_px2 = [variance, 0.0, variance];
    let centre = Centre { at_px: blob.at_px, covariance_px2, lasting_px2: [0.0; 3], radius_px: blob.radius_px() };
    Some(Fit { marker: blob.colour, ..look.unfitted(centre, covariance_px2) })
}
