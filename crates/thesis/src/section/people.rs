//! People that are generated: the model with values and photodiodes of their own, pressing as section 4.3.4 lets them,
//! with noise.
//!
//! In: the middle of people's values, and a seed for each. Out: what is recorded of them, Fig. 79 and 81 slowly, Fig.
//! 80 and 82 quickly. Forces here are pressing ones: positive.
//!
//! Walls touch instead of closing ([`Collapse::Contact`]): the thesis' forces reach 2 N, and on 1 cm2 the model of its
//! table closes at 1.1 N.

use lunula_hemodynamics::{Collapse, Load, Optics, Parameters, Recording, Symbol, Trace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::section::groups::scaled;
use lunula::hemodynamics::HemodynamicsError;
use lunula::hemodynamics::Pressed;
use lunula::hemodynamics::voltages;

/// SD of people's stiffness and damping, of the logarithm.
const SPREAD: f64 = 0.12;
/// SD of people's scaling, of the logarithm, and its middle, V.
const SCALING: (f64, f64) = (0.35, 4.0);
/// Noise over a signal's own range.
const NOISE: f64 = 0.01;
const FORCE_NOISE_N: f64 = 0.01;
/// Of a dynamic recording: rows a second, its end, pressing and letting go (s), how long that takes, and the force
/// held.
const RATE: u32 = 100;
const END_S: f64 = 4.5;
pub(crate) const PRESSED_S: f64 = 0.5;
pub(crate) const RELEASED_S: f64 = 2.5;
const QUICKLY_S: f64 = 0.15;
const HELD_N: f64 = 1.0;
/// The force's area, m2: a newton is 1 N/cm2.
pub(crate) const AREA_M2: f64 = 1e-4;
/// Seed of the first of the thesis' eight people, as docs/src/thesis/section-4-3.md has them.
pub(crate) const FIRST_SEED: u64 = 430;

/// A generated person.
#[derive(Debug, Clone)]
pub(crate) struct Person {
    name: String,
    /// The values that are true of them.
    pub(crate) parameters: Parameters,
    seed: u64,
}

/// What was recorded of a person, with the force as it was measured.
#[derive(Debug, Clone)]
pub(crate) struct Recorded {
    /// Loads by the measured force, and the photodiode of the pressed place.
    pub(crate) recording: Recording,
    /// The measured force, N, a sample each; positive where it presses.
    pub(crate) force_n: Vec<f64>,
    /// s; none of a static one.
    pub(crate) times_s: Option<Vec<f64>>,
}

fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move || StandardNormal.sample(&mut random)
}

impl Person {
    /// How many there are in the thesis.
    pub(crate) const COUNT: usize = 8;
    /// What `k_C`, `b_C`, `k_V` and `b_V` of the thesis' table are multiplied by to have its measured time constants,
    /// see docs/src/thesis/section-4-3.md.
    const TUNED: [f64; 4] =
        [0.733_905_503_853_136_7, 1.176_448_318_448_69, 10.000_000_000_000_002, 0.099_999_999_999_999_98];

    /// A person about these parameters; none where they can't be moved so.
    #[must_use]
    pub(crate) fn about(middle: &Parameters, name: &str, seed: u64) -> Option<Self> {
        let mut normal = normals(seed);
        let mut own = scaled(middle, &std::array::from_fn(|_| (SPREAD * normal()).exp()))?;
        for unit in 0..2 {
            let scaling = SCALING.1 * (SCALING.0 * normal()).exp();
            own = own.set(Symbol::Scaling(unit), scaling).ok()?;
            own = own.set(Symbol::Offset(unit), 0.3 * normal()).ok()?;
        }
        Some(Self { name: name.to_owned(), parameters: own, seed })
    }

    /// The thesis' eight about these parameters; for the tuned ones see docs/src/thesis/section-4-3.md.
    #[must_use]
    pub(crate) fn of_section_4_3(middle: &Parameters) -> Option<Vec<Self>> {
        (0..Self::COUNT).map(|k| Self::about(middle, &(k + 1).to_string(), FIRST_SEED + k as u64)).collect()
    }

    /// The middle of people: the thesis' table with stiffness and damping tuned to the time constants that it measured.
    #[must_use]
    pub(crate) fn middle() -> Option<Parameters> {
        scaled(&Parameters::thesis(), &Self::TUNED)
    }

    /// The photodiode of the pressed place over a force from 0 to 2 N and back, slowly: an average of three cycles.
    pub(crate) fn slowly(&self, pressed: Pressed) -> Result<Recorded, HemodynamicsError> {
        let force_n: Vec<f64> = (0..=40).map(|k| 0.05 * f64::from(k)).collect();
        let [proximal, distal] = pressures(pressed, &force_n);
        let recording = Recording::steady(proximal, distal, vec![trace(pressed, vec![0.0; force_n.len()])]);
        self.recorded(recording, force_n, None, 1.0 / 3.0_f64.sqrt(), pressed)
    }

    /// The photodiode of the pressed place as the finger presses quickly, holds, and lets go quickly.
    pub(crate) fn quickly(&self, pressed: Pressed) -> Result<Recorded, HemodynamicsError> {
        let times_s: Vec<f64> =
            (0..=(END_S * f64::from(RATE)) as u32).map(|k| f64::from(k) / f64::from(RATE)).collect();
        let ease = |since_s: f64| 0.5 - 0.5 * (std::f64::consts::PI * (since_s / QUICKLY_S).clamp(0.0, 1.0)).cos();
        let mut normal = normals(self.seed + 1000 * (1 + pressed.of(1.0)[1] as u64));
        let (slow_hz, height) = (1.0 + 0.2 * normal(), HELD_N * (0.08 * normal()).exp());
        let force = |time_s: f64| {
            let held = ease(time_s - PRESSED_S) - ease(time_s - RELEASED_S);
            height * held * (1.0 + 0.02 * (std::f64::consts::TAU * slow_hz * time_s).sin())
        };
        let true_n: Vec<f64> = times_s.iter().map(|&time_s| force(time_s)).collect();
        let force_n: Vec<f64> = true_n.iter().map(|force| force + FORCE_NOISE_N * normal()).collect();
        let with = |forces: &[f64]| -> Result<Recording, HemodynamicsError> {
            let [proximal, distal] = pressures(pressed, forces)
                .map(|pa| Load::table(&times_s, &pa).map_err(|why| HemodynamicsError::Model(why.to_string())));
            let unknown = vec![trace(pressed, vec![0.0; times_s.len()])];
            Ok(Recording::transient(times_s.clone(), proximal?, distal?, unknown))
        };
        let found = self.recorded(with(&true_n)?, force_n.clone(), Some(times_s.clone()), 1.0, pressed)?;
        let mut recording = with(&force_n)?.of(&self.name);
        recording.photodiodes = found.recording.photodiodes;
        Ok(Recorded { recording, ..found })
    }

    /// The model's answer with noise.
    fn recorded(
        &self,
        mut recording: Recording,
        force_n: Vec<f64>,
        times_s: Option<Vec<f64>>,
        noise: f64,
        pressed: Pressed,
    ) -> Result<Recorded, HemodynamicsError> {
        let mut normal = normals(self.seed + 10 * (1 + pressed.of(1.0)[1] as u64) + 5 * u64::from(times_s.is_some()));
        let mut answers = voltages(&self.parameters, &recording, Collapse::Contact, &Optics::BeerLambert)?;
        let answer = answers.remove(0);
        let (low, high) = ends(&answer);
        let noisy = answer.iter().map(|value| value + noise * NOISE * (high - low) * normal()).collect();
        recording.photodiodes[0].voltages_v = noisy;
        Ok(Recorded { recording: recording.of(&self.name), force_n, times_s })
    }
}

/// The loads of forces on a place, Pa: proximal and distal.
pub(crate) fn pressures(pressed: Pressed, force_n: &[f64]) -> [Vec<f64>; 2] {
    [0, 1].map(|k| force_n.iter().map(|force| pressed.of(force / AREA_M2)[k]).collect())
}

/// The photodiode of the pressed place.
pub(crate) fn trace(pressed: Pressed, volts: Vec<f64>) -> Trace {
    Trace::new(usize::from(pressed == Pressed::Distal), volts)
}

/// The least and the greatest.
pub(crate) fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}
