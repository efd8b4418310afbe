//! A sensor in three numbers: how late, how noisy, how slow the noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// True force to predicted force: a first-order lag and noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct SensorModel {
    /// Time constant of the blood in the nail, s; 0: none. The thesis' is about 0.2 s when pressing (4.4).
    pub(super) lag_s: f64,
    /// SD of the error of each axis, N.
    pub(super) noise_n: f64,
    /// Time constant of the error, s; 0: white.
    pub(super) noise_time_s: f64,
}

impl SensorModel {
    /// The sensor with the noise of a seed; forces come at a steady rate.
    pub(super) fn seeded(self, seed: u64) -> impl FnMut(f64, [f64; 3]) -> [f64; 3] {
        let mut noise = Noise::<3>::new(self.noise_n, self.noise_time_s, seed, 1 << 32);
        let mut last: Option<(f64, [f64; 3])> = None;
        move |t_s, force_n| {
            let lagged_n = match last {
                Some((before_s, before_n)) if self.lag_s > 0.0 => {
                    let share = -(-(t_s - before_s) / self.lag_s).exp_m1();
                    std::array::from_fn(|axis| before_n[axis] + share * (force_n[axis] - before_n[axis]))
                }
                _ => force_n,
            };
            let dt_s = last.map_or(0.0, |(before_s, _)| t_s - before_s);
            last = Some((t_s, lagged_n));
            let error_n = noise.step(dt_s);
            std::array::from_fn(|axis| lagged_n[axis] + error_n[axis])
        }
    }
}

/// Noise with a time constant (Ornstein-Uhlenbeck), one for each axis.
#[derive(Debug)]
pub(super) struct Noise<const AXES: usize> {
    rng: ChaCha8Rng,
    sd: f64,
    time_s: f64,
    at: Option<[f64; AXES]>,
}

impl<const AXES: usize> Noise<AXES> {
    /// The random numbers are those of `stream` of ChaCha8 of `seed`.
    pub(super) fn new(sd: f64, time_s: f64, seed: u64, stream: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Self { rng, sd, time_s, at: None }
    }

    /// The noise `dt_s` later.
    pub(super) fn step(&mut self, dt_s: f64) -> [f64; AXES] {
        let kept = if self.time_s > 0.0 && self.at.is_some() { (-dt_s / self.time_s).exp() } else { 0.0 };
        let fresh = (1.0 - kept * kept).sqrt() * self.sd;
        let before = self.at.unwrap_or([0.0; AXES]);
        let at = before.map(|value| {
            let normal: f64 = StandardNormal.sample(&mut self.rng);
            kept * value + fresh * normal
        });
        self.at = Some(at);
        at
    }
}
