//! Whether a nail's picture is sharp: how much of what it shows is fine.
//!
//! Measured on normalized pictures, so that neither the nail's size nor the photograph's contrast matters. Medians of a
//! photograph's nails (26 real hands, turned, mirrored, halved, enlarged three times, as JPEG of quality 20, darkened,
//! overexposed, filtered; 48 phantoms): 0.22 and more on all but 3 of 310; blurred by 4 px (nails 50 px), less than
//! 0.22 on 21 of 23, smeared by 15 px on 14 of 23. Of the confident finds on the blurred ones 16 % were wrong, in place
//! of 3 %.

use ndarray::Array1;

use super::Normalized;
use crate::vision::blurred;

/// What two Gaussians leave is compared: their SDs, nails.
const FINE: f64 = 0.03;
const COARSE: f64 = 0.12;
/// The side to which a picture is reduced, about, and the least that is looked at, pixels.
const SIDE: usize = 100;
const LEAST: usize = 40;
/// Below it, a photograph is out of focus or shaken.
pub(crate) const SHARP: f64 = 0.22;

/// The SD of a picture's fine part over that of its coarse one; none of a picture that is not wholly seen, small or
/// blank.
pub(crate) fn detail(picture: &Normalized, margin: f64) -> Option<f64> {
    if picture.seen.is_some() || picture.size < LEAST {
        return None;
    }
    let block = (picture.size / SIDE).max(1);
    let side = picture.size / block;
    let mean = |at: usize| {
        let rows = (0..block).map(|row| (at / side * block + row) * picture.size + at % side * block);
        let sum: u32 = rows.flat_map(|from| &picture.levels[from..from + block]).map(|level| u32::from(*level)).sum();
        sum as f32 / (block * block) as f32
    };
    let values: Vec<f32> = (0..side * side).map(mean).collect();
    let nail_px = side as f64 / margin;
    let sd = |nails: f64| {
        let blurred = blurred(&values, [side; 2], nails * nail_px);
        let left: Array1<f64> = values.iter().zip(blurred).map(|(value, blur)| f64::from(value - blur)).collect();
        left.std(0.0)
    };
    let (fine, coarse) = (sd(FINE), sd(COARSE));
    // A level of 16 bits is rounding.
    (coarse > 1.0).then(|| fine / coarse)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A nail with a lunula, whose rims are some pixels wide.
    fn nail(size: usize, rim_px: f64) -> Normalized {
        let level = |at: usize| {
            let [x, y] = [at % size, at / size].map(|k| 1.25 * ((k as f64 + 0.5) / size as f64 - 0.5));
            let rim = rim_px / size as f64;
            let within = |d: f64| 1.0 / (1.0 + (d / rim).exp());
            let nail = within((x * x + y * y).sqrt() - 0.48);
            let lunula = within((x * x + (y - 0.5).powi(2)).sqrt() - 0.25);
            (20_000.0 + 9_000.0 * nail + 5_000.0 * nail * lunula) as u16
        };
        Normalized { size, levels: (0..size * size).map(level).collect(), seen: None }
    }

    #[test]
    fn a_blurred_nail_has_little_detail_whatever_its_size_and_contrast() {
        for size in [96, 200, 400] {
            let [sharp, blurred] = [0.01, 0.06].map(|rim| detail(&nail(size, rim * size as f64), 1.25).unwrap());
            assert!(sharp > SHARP + 0.04 && blurred < SHARP - 0.1, "{size}: {sharp} {blurred}");
            let mut pale = nail(size, 0.01 * size as f64);
            pale.levels.iter_mut().for_each(|level| *level = 30_000 + *level / 10);
            assert!((detail(&pale, 1.25).unwrap() - sharp).abs() < 0.01);
        }
        let blank = Normalized { size: 96, levels: vec![7; 96 * 96], seen: None };
        let hidden = Normalized { seen: Some(vec![true; 96 * 96]), ..nail(96, 1.0) };
        assert_eq!([blank, hidden, nail(32, 1.0)].map(|picture| detail(&picture, 1.25)), [None; 3]);
    }
}
