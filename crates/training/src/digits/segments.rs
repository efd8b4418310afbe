//! Seven-segment displays: breadth, gaps, ends, corners and proportions at random.

use rand::{Rng, RngExt};

use super::mask::{Mask, tight};

/// One display's segments, a (top), b, c, d (bottom), e, f, g (middle).
#[derive(Debug, Clone)]
pub struct Display {
    pub(super) segments: [Mask; 7],
    pub(super) dots: [Mask; 2],
    /// From one digit's left to the next one's, units.
    pub(super) advance: f32,
    /// A 7 with f lit, a 6 without a, a 9 without d.
    pub(super) variants: [bool; 3],
    /// The box that holds any digit, units.
    pub(super) cell: [f32; 4],
}

/// Lit segments of each digit, a first.
const LIT: [&str; 10] = ["abcdef", "bc", "abdeg", "abcdg", "bcfg", "acdfg", "acdefg", "abc", "abcdefg", "abcdfg"];

impl Display {
    pub(super) fn random(rng: &mut impl Rng) -> Self {
        // Middle lines are `wide` x 1 - 2 `half`; `half` is half a segment's breadth.
        let half = rng.random_range(0.028f32..0.095);
        let outer = rng.random_range(0.42f32..0.72).max(5.2 * half);
        let (tall, wide) = (1.0 - 2.0 * half, outer - 2.0 * half);
        let gap = if rng.random_bool(0.2) { 0.0 } else { rng.random_range(0.0f32..0.045) };
        let ends = rng.random_range(0..4);
        let level_ends = if rng.random_bool(0.7) { ends } else { rng.random_range(0..4) };
        let cut = rng.random_range(0.6f32..1.0);
        // Level segments may be finer than upright ones, and end otherwise.
        let fine = if rng.random_bool(0.5) { rng.random_range(0.8f32..1.1) } else { rng.random_range(0.28f32..0.9) };
        let level_half = (half * fine).max(0.018);
        let (l, m, r) = (half, half + 0.5 * tall, half + wide);
        let (t, b) = (half, half + tall);
        let lines: [[f32; 4]; 7] =
            [[l, t, r, t], [r, t, r, m], [r, m, r, b], [l, b, r, b], [l, m, l, b], [l, t, l, m], [l, m, r, m]];
        let segments: [Mask; 7] = std::array::from_fn(|k| {
            let [x0, y0, x1, y1] = lines[k];
            let level = y0 == y1;
            let (breadth, ends) = if level { (level_half, level_ends) } else { (half, ends) };
            let frame = [x0.min(x1) - 0.13, y0.min(y1) - 0.13, x0.max(x1) + 0.13, y0.max(y1) + 0.13];
            let length = if level { x1 - x0 } else { y1 - y0 };
            Mask::draw(frame, |x, y| {
                let (along, off) = if level { (x - x0, y - y0) } else { (y - y0, x - x0) };
                // Towards the digit's inside.
                let inner = match k {
                    0 => off,
                    1 | 2 => -off,
                    3 => -off,
                    4 | 5 => off,
                    _ => off.abs(),
                };
                if off.abs() > breadth {
                    return false;
                }
                let near = along.min(length - along);
                // At the middle, upright segments give way to g.
                let middle = matches!(k, 1 | 5) && along > 0.5 * length || matches!(k, 2 | 4) && along < 0.5 * length;
                match ends {
                    // Hexagons.
                    0 => near - gap >= cut * off.abs(),
                    // Bars.
                    1 => near - 0.4 * gap >= 0.5 * half,
                    // Round ends.
                    2 => {
                        let end = (0.6 * gap + 0.8 * half).min(0.35 * length);
                        (along - along.clamp(end, length - end)).hypot(off) <= breadth
                    }
                    // Corners cut on the diagonal, the outline closed.
                    _ => near - 0.7 * gap >= if middle || k == 6 { cut * inner.max(0.0) } else { inner },
                }
            })
        });
        let dot = |y: f32| {
            Mask::draw([-0.1, y - 0.12, 0.3, y + 0.12], |x, v| {
                (x - 0.1).abs() <= 1.1 * half && (v - y).abs() <= 1.1 * half
            })
        };
        let cell = tight(segments.iter().flat_map(|mask| mask.edge.iter().copied()));
        Self {
            cell,
            segments,
            dots: [dot(0.3), dot(0.7)],
            advance: outer + rng.random_range(0.1f32..0.35),
            variants: std::array::from_fn(|_| rng.random_bool(0.25)),
        }
    }

    pub(super) fn lit(&self, digit: usize) -> [bool; 7] {
        let extra = match digit {
            7 if self.variants[0] => "f",
            _ => "",
        };
        let without = match digit {
            6 if self.variants[1] => 'a',
            9 if self.variants[2] => 'd',
            _ => ' ',
        };
        let mut lit = [false; 7];
        for (k, name) in ('a'..='g').enumerate() {
            lit[k] = (LIT[digit].contains(name) || extra.contains(name)) && name != without;
        }
        lit
    }
}

/// Whether any display shows these segments for a digit.
pub(super) fn is_a_digit(lit: [bool; 7]) -> bool {
    let name: String = ('a'..='g').zip(lit).filter(|(_, on)| *on).map(|(name, _)| name).collect();
    // With the usual variants, a 1 on the left and a lower-case o among them.
    LIT.contains(&name.as_str()) || ["abcf", "cdefg", "abcfg", "ef", "cdeg"].contains(&name.as_str())
}
