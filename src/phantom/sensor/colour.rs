//! The nail's colour as the blood follows the finger: the zones' weights, with hysteresis and lags (4.3).
//!
//! In: a person's [`Blood`] and a movement. Out: [`ColourWeights`] at each moment, by [`Response`](super::Response).
//! Distal blood follows with a lag of 0.18 s while the pressing grows and 0.36 s while it falls, proximal blood with
//! 0.16 s and 0.12 s, as measured in 4.3; bending with that of [`Photodiode`](super::Photodiode).

use super::photodiode::{BENDING_S, DISTAL_S, PROXIMAL_S};
use super::{Following, Response, Touch};
use crate::phantom::nail::{Blood, ColourWeights, PATTERNS};

/// Distal weights, proximal weights, bending's three.
const FOLLOWED: usize = 2 * PATTERNS + 3;

impl Following<FOLLOWED> for Blood {
    fn drive(&self, [pressing_n, fx_n, fy_n, j2_rad]: [f64; 4]) -> [f64; FOLLOWED] {
        let touched = self.touched([pressing_n, fx_n, fy_n]);
        let bent = self.bent(j2_rad);
        std::array::from_fn(|k| if k < 2 * PATTERNS { touched[k % PATTERNS] } else { bent[k - 2 * PATTERNS] })
    }

    fn lags_s(&self) -> [[f64; 2]; FOLLOWED] {
        std::array::from_fn(|k| {
            let (loading_s, unloading_s) = match k / PATTERNS {
                0 => DISTAL_S,
                1 => PROXIMAL_S,
                _ => (BENDING_S, BENDING_S),
            };
            [loading_s, unloading_s].map(|tau_s| self.lag * tau_s)
        })
    }
}

impl<M: FnMut(f64) -> Touch> Response<Blood, M, FOLLOWED> {
    /// The zones' weights at `t_s`. Times are asked for in ascending order, none before the start.
    pub fn at(&mut self, t_s: f64) -> ColourWeights {
        let followed = self.followed(t_s);
        let part = |from: usize| std::array::from_fn(|k| followed[from + k]);
        let bent = std::array::from_fn(|k| followed[2 * PATTERNS + k]);
        ColourWeights::of(part(0), part(PATTERNS), bent)
    }
}
