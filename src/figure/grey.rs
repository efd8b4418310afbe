//! Arrays to grey pictures.

use image::GrayAlphaImage;
use ndarray::Array2;

/// How values become grey levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stretch {
    /// `low` and below is black, `high` and above white, linear between.
    Linear {
        /// The value of black.
        low: f32,
        /// The value of white.
        high: f32,
    },
    /// White above the value, black up to it.
    Above(f32),
}

impl Stretch {
    /// The grey level of a value that is known.
    pub fn level(self, value: f32) -> u8 {
        match self {
            Self::Linear { low, high } =>
            // The cast saturates; adding a half and cutting rounds.
            {
                (((value - low) / (high - low)) * 255.0 + 0.5) as u8
            }
            Self::Above(limit) => {
                if value > limit {
                    255
                } else {
                    0
                }
            }
        }
    }
}

/// Draws an array; a NaN is transparent: not known is neither black nor white.
pub fn grey_map(values: &Array2<f32>, stretch: Stretch) -> GrayAlphaImage {
    let (rows, columns) = values.dim();
    let mut drawn = GrayAlphaImage::new(columns as u32, rows as u32);
    for (pixel, &value) in drawn.chunks_exact_mut(2).zip(values) {
        if !value.is_nan() {
            pixel.copy_from_slice(&[stretch.level(value), 255]);
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_to_fifty_percent_fill_the_range() {
        let contrast = Stretch::Linear { low: 0.3, high: 0.5 };
        assert_eq!([0.0, 0.3, 0.4, 0.5, 1.0].map(|v| contrast.level(v)), [0, 0, 128, 255, 255]);
    }

    #[test]
    fn the_threshold_itself_is_black() {
        let threshold = Stretch::Above(105.0 / 255.0);
        assert_eq!([104.0, 105.0, 106.0].map(|v| threshold.level(v / 255.0)), [0, 0, 255]);
    }

    #[test]
    fn unknown_is_transparent() {
        let drawn = grey_map(&ndarray::array![[f32::NAN, 1.0]], Stretch::Linear { low: 0.0, high: 1.0 });
        assert_eq!([drawn.get_pixel(0, 0).0, drawn.get_pixel(1, 0).0], [[0, 0], [255, 255]]);
    }
}
