//! A person's fingertip: everything that stays the same from photograph to photograph.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{FingerShape, NailShape, Tone, coloration::Habit};

/// One person's fingertip.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The nail's outline.
    pub nail: NailShape,
    /// The fingertip's silhouette.
    pub finger: FingerShape,
    /// How dark the skin is.
    pub tone: Tone,
    /// The skin's redness, relative change of green and blue.
    pub redness: f64,
    /// Lightening of the lunula, encoded.
    pub lunula: f64,
    /// Height of the lunula, fraction of the nail's length.
    pub lunula_height: f64,
    /// Length of the free edge, fraction of the nail's length.
    pub free_edge: f64,
    /// 0 translucent to 1 white.
    pub free_edge_white: f64,
    /// Darkening in the creases of the nail folds, relative.
    pub crease: f64,
    /// Width of the creases in half nail widths.
    pub crease_width: f64,
    /// Lightening of the cuticle, encoded.
    pub cuticle: f64,
    /// Height of the folds' ridges, as relative lightening.
    pub ridge: f64,
    /// Lightening of the plate by its own gloss, relative.
    pub gloss: f64,
    /// The bed's lightness relative to its tone's.
    pub bed: f64,
    /// Relative contrast of the striations along the nail.
    pub striation: f64,
    /// Relative contrast of the skin's texture.
    pub texture: f64,
    /// Relative contrast of the wrinkles over the joint.
    pub wrinkle: f64,
    /// Pale and dark marks in the plate; none in photographs.
    pub specks: Vec<Speck>,
    pub(super) habit: Habit,
    pub(super) seed: u32,
}

/// A mark in the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speck {
    /// Where it is, `u` and `v`.
    pub at: [f64; 2],
    /// Its standard deviation in half nail widths.
    pub size: f64,
    /// How much lighter it is in its middle, relative; negative: darker.
    pub contrast: f64,
}

/// The random numbers of one thing (`kind`) of the set `seed`, independent of all others.
pub fn numbers(seed: u64, kind: u32, index: u32) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream((u64::from(kind) << 32) | u64::from(index));
    rng
}

const KIND_SUBJECT: u32 = 1;
const KIND_SPECKS: u32 = 46;
/// How many specks a nail has (assumed: what a plain close-up shows of white spots, pits and dirt).
const SPECKS: usize = 14;

impl Subject {
    /// Subject `index` of the set `seed`. Sixteen that follow each other from a multiple of 16 hold one of each
    /// sixteenth of the tones.
    pub fn random(seed: u64, index: u32) -> Self {
        let mut rng = numbers(seed, KIND_SUBJECT, index);
        let sixteenth = f64::from((index % 16).reverse_bits() >> 28);
        let tone = Tone::new((sixteenth + rng.random_range(0.0..1.0)) / 16.0);
        let mut within = |low: f64, high: f64| rng.random_range(low..=high);
        let nail = NailShape {
            aspect: within(0.9, 1.6),
            middle_u: within(-0.10, 0.10),
            widest_v: within(-0.05, 0.45),
            across: [within(2.0, 3.0), within(2.0, 3.2)],
            along: [within(2.3, 3.8), within(2.8, 5.5)],
            skew: within(-0.12, 0.12),
        };
        let finger = FingerShape {
            half_width: within(1.24, 1.48),
            tip: within(0.22, 0.55),
            widening: within(0.0, 0.07),
            blunt: within(0.05, 0.45),
            offset: within(-0.06, 0.06),
        };
        Self {
            nail,
            finger,
            tone,
            redness: within(-0.03, 0.05),
            lunula: within(-0.04, 0.11).max(0.0),
            lunula_height: within(0.12, 0.26),
            free_edge: within(-0.02, 0.12).max(0.0),
            free_edge_white: within(0.25, 1.0),
            crease: within(0.06, 0.45),
            crease_width: within(0.018, 0.045),
            cuticle: within(0.0, 0.12),
            ridge: within(0.0, 0.08),
            gloss: within(0.0, 0.10),
            bed: within(0.96, 1.05),
            striation: within(0.002, 0.022),
            texture: within(0.02, 0.07),
            wrinkle: within(0.03, 0.16),
            habit: Habit {
                amplitude: within(0.055, 0.080),
                shift: [within(-0.05, 0.05), within(-0.05, 0.05)],
                size: within(0.92, 1.08),
            },
            seed: rng.random(),
            specks: Vec::new(),
        }
    }

    /// The same fingertip with marks in its plate, as plates have them and a camera that comes close sees them.
    #[must_use]
    pub fn with_specks(mut self) -> Self {
        let mut rng = numbers(u64::from(self.seed), KIND_SPECKS, 0);
        let mut within = |low: f64, high: f64| rng.random_range(low..=high);
        let speck = |_| Speck {
            at: [within(-0.85, 0.85), within(-0.85, 0.85)],
            size: within(0.015, 0.05),
            contrast: within(0.03, 0.09) * within(-1.0, 1.0).signum(),
        };
        self.specks = (0..SPECKS).map(speck).collect();
        self
    }
}
