//! Smooth random movement of a scene: the predictor crate's waves, with the phantom's random numbers.

use std::ops::Range;

pub(in crate::phantom) use lunula_predictor::Wave;

/// A wave with rates in `rates` times `hz`; `seed`, `kind` and `index` tell the random numbers, as
/// [`numbers`](crate::phantom::nail::numbers) does.
pub(in crate::phantom) fn random_wave(hz: f64, rates: Range<f64>, seed: u64, kind: u32, index: u32) -> Wave {
    Wave::random(hz, rates, seed, (u64::from(kind) << 32) | u64::from(index))
}
