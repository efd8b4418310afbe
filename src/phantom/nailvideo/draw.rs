//! A frame's picture: the moved canvas, in the frame's light, with what covers it and the camera's noise.

use super::Scene;
use super::track::Affine;
use crate::phantom::video::{Siting, add_noise, encoded};
use crate::video::Picture;

/// The most pixels between two exposures, and the most exposures.
const APART_PX: f64 = 0.7;
const MOST_EXPOSURES: f64 = 48.0;

impl Scene {
    /// A frame's picture, as the encoder gets it.
    #[must_use]
    pub fn picture(&self, frame: usize) -> Picture {
        let noise_sd = (self.options.noise / 255.0) as f32;
        let exposures = self.exposures(frame);
        let painted = match &self.other {
            Some((canvas, weights)) if self.is_cut(frame) => canvas.painted(weights),
            _ => self.canvas.painted(&self.moments[frame].weights),
        };
        let time_s = self.time_s(frame);
        let light = self.light.at(time_s, &self.track.at(time_s));
        let held: Vec<_> = self.covers.iter().filter_map(|cover| cover.at(time_s)).collect();
        let share = 1.0 / exposures.len() as f32;
        encoded(self.options.format(), &self.options.coding.matrix(), Siting::Left, |y, row| {
            let [red, green, blue] = &mut row.rgb;
            for (x, ((red, green), blue)) in red.iter_mut().zip(green).zip(blue).enumerate() {
                let at = [x as f64, y as f64];
                let mut colour = [0.0f32; 3];
                for back in &exposures {
                    let one = painted.colour(back.apply(at));
                    (0..3).for_each(|c| colour[c] += share * one[c]);
                }
                for (covered, own) in held.iter().map(|cover| cover.over(at)).filter(|(covered, _)| *covered > 0.0) {
                    (0..3).for_each(|c| colour[c] += covered as f32 * (own[c] as f32 - colour[c]));
                }
                [*red, *green, *blue] = light.on(colour, at);
            }
            add_noise(&mut row.rgb, noise_sd, self.options.seed, frame, y);
        })
    }

    /// This frame's pixels to frame 0's plane, one for each exposure.
    fn exposures(&self, frame: usize) -> Vec<Affine> {
        let time_s = self.time_s(frame);
        let open_s = self.options.blur / self.options.fps;
        let at = |share: f64| self.track.at(time_s + share * open_s);
        let [width, height] = [self.options.size.0, self.options.size.1].map(f64::from);
        let moved = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]].map(|corner| {
            let [from, to] = [-0.5, 0.5].map(|share| at(share).apply(corner));
            (from[0] - to[0]).hypot(from[1] - to[1])
        });
        let count = (moved.into_iter().fold(0.0, f64::max) / APART_PX).ceil().clamp(1.0, MOST_EXPOSURES) as usize;
        (0..count).map(|k| at((k as f64 + 0.5) / count as f64 - 0.5).inverse()).collect()
    }
}
