//! What the colours of a nail, and of the skin below it, say of a photograph or a frame: channels that were exchanged,
//! a negative, values that look linear.
//!
//! In: the picture and the nail's box in it. Out: [`Hues`]. Of grey pictures nothing is said.

use image::{DynamicImage, GenericImageView as _, Rgba};

use super::normalize::NailFrame;

/// Skin and nail are redder than green, and greener than blue, by more than this, of full scale, whatever tone and
/// light (120 nails of 26 real hands: red over green by 0.022 at least, over blue by 0.02 in one and 0.11 in the
/// others).
const BEHIND: f64 = -0.02;
/// Of pictures with linear values the ratios of channels are greater and levels lower. Weights of the logarithm of red
/// over green, of the nail and of the skin below it, of the logarithm of the nail's green, and an offset: fitted to 136
/// phantom subjects and 25 real hands. Of sets of five with two linear ones 122 of 140 of phantoms are found and 20 of
/// 30 of real hands; of 14 sets of phantoms and 30 of hands as they are none is. Curves between the two are hardly
/// seen.
const LINEAR: [f64; 4] = [16.0, 8.0, -2.0, -14.0];
/// What channels of a photograph, or a frame, seem to be in each other's place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mistaken {
    RedBlue,
    RedGreen,
    GreenBlue,
    Negative,
}

impl Mistaken {
    pub(in crate::photo) const ALL: [Self; 4] = [Self::RedBlue, Self::RedGreen, Self::GreenBlue, Self::Negative];

    /// What nail and skin look like, and what may have been done.
    pub(crate) fn words(self) -> [&'static str; 2] {
        match self {
            Self::RedBlue => {
                let bgr = "were red and blue exchanged, as by a program that saves OpenCV's BGR?";
                ["nail and skin are bluer than red", bgr]
            }
            Self::RedGreen => ["nail and skin are greener than red", "were red and green exchanged?"],
            Self::GreenBlue => ["nail and skin are bluer than green", "were green and blue exchanged?"],
            Self::Negative => ["nail and skin are bluer than green, and greener than red", "is it a negative?"],
        }
    }
}

/// The colours of a nail and of the skin below it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Hues {
    pub(crate) mistaken: Option<Mistaken>,
    /// How far the values look linear, where there are colours.
    pub(in crate::photo) linear: Option<f64>,
}

impl Hues {
    pub(crate) fn of(image: &DynamicImage, frame: &NailFrame) -> Self {
        if !image.color().has_color() {
            return Self::default();
        }
        let at = |[across, along]: &[f64; 2]| {
            let [x, y] = frame.photo_from_nail(*across, *along).map(|v| v.round());
            let within = x >= 0.0 && y >= 0.0 && x < f64::from(image.width()) && y < f64::from(image.height());
            let Rgba([red, green, blue, _]) = within.then(|| image.get_pixel(x as u32, y as u32))?;
            Some([red, green, blue].map(|value| f64::from(value) / f64::from(u8::MAX)))
        };
        let steps = || (0..9).map(|k| f64::from(k) / 8.0 - 0.5);
        let nail: Vec<[f64; 2]> = steps().flat_map(|u| steps().map(move |v| [0.7 * u, 0.7 * v])).collect();
        let skin: Vec<[f64; 2]> = steps().flat_map(|u| [[0.8 * u, -0.62], [0.8 * u, -0.75]]).collect();
        let mean = |points: &[[f64; 2]]| {
            let known: Vec<[f64; 3]> = points.iter().filter_map(at).collect();
            let sum = |k: usize| known.iter().map(|colour| colour[k]).sum::<f64>();
            (!known.is_empty()).then(|| [0, 1, 2].map(|k| sum(k) / known.len() as f64))
        };
        let (Some(nail), Some(skin)) = (mean(&nail), mean(&skin)) else { return Self::default() };
        let less = |a: usize, b: usize| [nail, skin].map(|colour| colour[a] - colour[b]);
        let is_behind = |a: usize, b: usize| less(a, b).iter().all(|less| *less < BEHIND);
        let [red_green, green_blue] = [less(0, 1), less(1, 2)].map(|less| less[0] + less[1]);
        let mistaken = if is_behind(0, 2) {
            Some(if red_green < green_blue { Mistaken::Negative } else { Mistaken::RedBlue })
        } else if is_behind(0, 1) {
            Some(Mistaken::RedGreen)
        } else {
            is_behind(1, 2).then_some(Mistaken::GreenBlue)
        };
        let [of_nail, of_skin, of_level, offset] = LINEAR;
        let [redder, below] = [nail, skin].map(|[red, green, _]| (red / green).ln());
        let linear = of_nail * redder + of_skin * below + of_level * nail[1].ln() + offset;
        Self { mistaken, linear: Some(linear).filter(|linear| linear.is_finite()) }
    }
}
