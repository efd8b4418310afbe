//! How much larger centres' errors are than independent noise would make them.
//!
//! A codec moves and smooths whole blocks, and holds back slow movements for a while: errors are larger than residuals
//! tell, by a factor that hardly depends on the marker but on the video. It shows in how the distance of two markers on
//! one segment varies, which is that of one marker from its steadiest partner. What a distance varies by is not all
//! error where skin stretches or no two markers belong together: the factor ends at some times what the tracks'
//! trembling shows. Trembling is the fourth difference of a coordinate, which holds next to nothing of a smooth
//! movement, and 70 times the variance of errors that are independent from frame to frame (those that last are not in
//! it).
//!
//! Positions are not changed by this, only their standard errors.

use super::fit::Fit;
use crate::median::median_of;

/// Binomial coefficients of the fourth difference.
const WEIGHTS: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
/// Steps of the histogram's logarithm, and its least value.
const BINS: usize = 96;
const STEP: f64 = 0.08;
const LEAST: f64 = -4.0;
/// The factor before anything is known.
const GUESS: f64 = 2.0;
/// The factor is guessed to be so many times what trembling shows, and the guess counts for so many frames.
const OVER_TREMBLING: f64 = 1.6;
const GUESS_FRAMES: f64 = 6.0;
/// The most that distances may show over trembling.
const MOST_OVER_TREMBLING: f64 = 6.0;
/// What a codec copies from frame to frame keeps its error and does not tremble: no factor is smaller. Measured on
/// phantom films of 60 to 240 frames a second, x264 veryfast and medium: angles were up to 43 standard errors off
/// without (RMS up to 4.2 of them), 5.7 with it (2.0); of 30 frames a second it changes standard errors by 4 %.
const FLOOR: f64 = 0.6;
/// Angles err by more than distances vary: measured 0.90 to 1.20 times, over nine scenes of crf 0 to 30.
const CHOSEN: f64 = 1.05;
/// The share of a normal variable's values within one standard deviation.
const WITHIN: f64 = 0.6827;

/// What the tracks of a video showed so far.
#[derive(Debug, Clone)]
pub(crate) struct Inflation {
    trembling: Vec<f64>,
    /// The last places and their variances, the newest last.
    last: Vec<Vec<([f64; 2], [f64; 2])>>,
    /// A pair of markers each, the later one's row by row.
    pairs: Vec<Pair>,
}

/// The distance of two markers.
#[derive(Debug, Clone, Copy, Default)]
struct Pair {
    frames: f64,
    mean_px: f64,
    /// Sum of squares about the mean.
    squares_px2: f64,
    /// Sum of the variances that independent noise would make.
    white_px2: f64,
}

impl Pair {
    fn push(&mut self, one: &Fit, other: &Fit) {
        let [dx, dy] = [0, 1].map(|axis| one.centre.at_px[axis] - other.centre.at_px[axis]);
        let distance = dx.hypot(dy);
        if distance <= 0.0 {
            return;
        }
        let (x, y) = (dx / distance, dy / distance);
        let [xx, xy, yy] = [0, 1, 2].map(|k| one.white_px2[k] + other.white_px2[k]);
        self.white_px2 += x * x * xx + 2.0 * x * y * xy + y * y * yy;
        self.frames += 1.0;
        let away = distance - self.mean_px;
        self.mean_px += away / self.frames;
        self.squares_px2 += away * (distance - self.mean_px);
    }

    /// The square of the factor that it shows, from a guess on.
    fn factor2(&self, guess: f64) -> f64 {
        let white = self.white_px2 / self.frames;
        let guess = GUESS_FRAMES * guess * guess;
        (self.squares_px2 / white + guess) / ((self.frames - 1.0).max(0.0) + GUESS_FRAMES)
    }
}

impl Inflation {
    /// For so many markers, before the first frame.
    pub(crate) fn new(markers: usize) -> Self {
        let pairs = vec![Pair::default(); markers * markers.saturating_sub(1) / 2];
        Self { trembling: vec![0.0; BINS], last: vec![Vec::with_capacity(WEIGHTS.len()); markers], pairs }
    }

    /// Takes in what a frame shows of each marker.
    pub(crate) fn push(&mut self, fits: &[Option<&Fit>]) {
        for (last, fit) in self.last.iter_mut().zip(fits) {
            let Some(fit) = fit else {
                last.clear();
                continue;
            };
            if last.len() == WEIGHTS.len() {
                last.remove(0);
            }
            last.push((fit.centre.at_px, [fit.white_px2[0], fit.white_px2[2]]));
            if last.len() < WEIGHTS.len() {
                continue;
            }
            for axis in 0..2 {
                let difference: f64 = WEIGHTS.iter().zip(last.iter()).map(|(w, one)| w * one.0[axis]).sum();
                let variance: f64 = WEIGHTS.iter().zip(last.iter()).map(|(w, one)| w * w * one.1[axis]).sum();
                self.trembling[bin(difference.abs() / variance.sqrt())] += 1.0;
            }
        }
        for later in 1..fits.len() {
            for earlier in 0..later {
                // Skin stretches between blots, and with them: no error.
                let discs = [fits[later], fits[earlier]].map(|fit| fit.filter(|fit| fit.outline.is_none()));
                if let [Some(one), Some(other)] = discs {
                    self.pairs[pair(later, earlier)].push(one, other);
                }
            }
        }
    }

    pub(crate) fn factors(&self) -> Vec<f64> {
        let markers = self.last.len();
        let trembling = self.trembling();
        let guess = trembling.map_or(GUESS, |factor| OVER_TREMBLING * factor);
        let steadiest: Vec<Option<f64>> = (0..markers)
            .map(|one| {
                let partners = (0..markers).filter(|&other| other != one);
                let seen = partners.map(|other| &self.pairs[pair(one.max(other), one.min(other))]);
                seen.filter(|pair| pair.frames > 0.0).map(|pair| pair.factor2(guess)).min_by(f64::total_cmp)
            })
            .collect();
        let middle = median_of(steadiest.iter().flatten().copied()).unwrap_or(guess * guess);
        // A marker's own is known less well than that of all: between both.
        let between = steadiest.into_iter().map(|own| CHOSEN * (own.unwrap_or(middle) * middle).powf(0.25));
        between
            .map(|factor| trembling.map_or(factor, |least| factor.clamp(least, MOST_OVER_TREMBLING * least)))
            .map(|factor| factor.max(FLOOR))
            .collect()
    }

    /// The factor of errors that are independent from frame to frame, once some are seen.
    fn trembling(&self) -> Option<f64> {
        let total: f64 = self.trembling.iter().sum();
        if total < 40.0 {
            return None;
        }
        let mut left = WITHIN * total;
        for (k, &count) in self.trembling.iter().enumerate() {
            if count >= left {
                return Some((LEAST + STEP * (k as f64 + left / count)).exp());
            }
            left -= count;
        }
        None
    }
}

/// The place of a pair, the later marker first.
fn pair(later: usize, earlier: usize) -> usize {
    later * (later - 1) / 2 + earlier
}

fn bin(ratio: f64) -> usize {
    (((ratio.max(1e-9).ln() - LEAST) / STEP).max(0.0) as usize).min(BINS - 1)
}
