//! Transfer functions: HDR video (ITU-R BT.2100) to what an ordinary camera encodes of the same light, and back.
//!
//! HDR is made ordinary by a power of light, so that the ratio of two channels stays as light comes and goes. In
//! hybrid log-gamma, the HDR of most phones, and with the perceptual quantizer it does not, and in BT.2020's primaries
//! red holds a third of green. What ordinary frames say of light is [`Curve`](super::curve::Curve)'s.

/// How R'G'B' stand for light.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Transfer {
    /// A power of light, or near it: BT.601, BT.709, sRGB; which, `Info::curve` says.
    #[default]
    Power,
    /// Hybrid log-gamma, BT.2100, Table 5.
    HybridLogGamma,
    /// The perceptual quantizer, BT.2100, Table 4.
    PerceptualQuantizer,
}

/// The power of light of which ordinary video that is made of HDR is the inverse.
pub(super) const GAMMA: f64 = 2.2;
/// White of ordinary video in HDR: 75 % of hybrid log-gamma, 203 cd/m2 (BT.2408); as light.
const HLG_WHITE: f64 = 0.264_962_560_421_007_24;
const PQ_WHITE: f64 = 203.0 / 10_000.0;
/// Hybrid log-gamma's a, b and c.
const HLG: [f64; 3] = [0.178_832_77, 0.284_668_92, 0.559_910_729_529_562];
/// The perceptual quantizer's m1 and m2; c1, c2 and c3.
const PQ_POWERS: [f64; 2] = [2610.0 / 16384.0, 2523.0 / 32.0];
const PQ_SHARES: [f64; 3] = [3424.0 / 4096.0, 2413.0 / 128.0, 2392.0 / 128.0];

/// Light in BT.709's primaries to BT.2020's (BT.2087), and back.
const WIDE_OF_USUAL: [[f64; 3]; 3] = [
    [0.627403895934699, 0.329283038377884, 0.043313065687417],
    [0.069097289358232, 0.919540395075459, 0.011362315566309],
    [0.01639143887515, 0.088013307877226, 0.895595253247624],
];
pub(super) const USUAL_OF_WIDE: [[f64; 3]; 3] = [
    [1.660491002108434, -0.58764113878855, -0.072849863319885],
    [-0.124550474521591, 1.13289989712596, -0.008349422604369],
    [-0.018150763354905, -0.100578898008007, 1.118729661362913],
];

impl Transfer {
    /// As people call it; `None` of ordinary video.
    #[must_use]
    pub fn hdr(self) -> Option<&'static str> {
        match self {
            Self::Power => None,
            Self::HybridLogGamma => Some("hybrid log-gamma"),
            Self::PerceptualQuantizer => Some("perceptual quantizer"),
        }
    }

    /// A video's own R'G'B' of ordinary ones.
    pub(super) fn own(self, ordinary: [f64; 3], wide: bool) -> [f64; 3] {
        if self == Self::Power {
            return ordinary;
        }
        let light = ordinary.map(|part| odd(part, |part| part.powf(GAMMA)));
        let light = if wide { product(&WIDE_OF_USUAL, light) } else { light };
        light.map(|part| odd(part, |part| self.encoded(part)))
    }

    /// Light over that of white.
    pub(super) fn light(self, part: f64) -> f64 {
        let ([a, b, c], [m1, m2], [c1, c2, c3]) = (HLG, PQ_POWERS, PQ_SHARES);
        match self {
            Self::Power => part.powf(GAMMA),
            Self::HybridLogGamma if part <= 0.5 => part * part / 3.0 / HLG_WHITE,
            Self::HybridLogGamma => (((part - c) / a).exp() + b) / 12.0 / HLG_WHITE,
            Self::PerceptualQuantizer => {
                let root = part.powf(1.0 / m2);
                ((root - c1).max(0.0) / (c2 - c3 * root)).powf(1.0 / m1) / PQ_WHITE
            }
        }
    }

    pub(super) fn encoded(self, light: f64) -> f64 {
        let ([a, b, c], [m1, m2], [c1, c2, c3]) = (HLG, PQ_POWERS, PQ_SHARES);
        match self {
            Self::Power => light.powf(1.0 / GAMMA),
            Self::HybridLogGamma if HLG_WHITE * light <= 1.0 / 12.0 => (3.0 * HLG_WHITE * light).sqrt(),
            Self::HybridLogGamma => a * (12.0 * HLG_WHITE * light - b).ln() + c,
            Self::PerceptualQuantizer => {
                let root = (PQ_WHITE * light).powf(m1);
                ((c1 + c2 * root) / (1.0 + c3 * root)).powf(m2)
            }
        }
    }
}

/// A function of what is not negative, on both sides of 0: colours beyond the primaries have negative parts.
fn odd(part: f64, of: impl Fn(f64) -> f64) -> f64 {
    of(part.abs()).copysign(part)
}

pub(super) fn product(matrix: &[[f64; 3]; 3], of: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(of).map(|(share, part)| share * part).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ordinary R'G'B' of a video's own.
    fn ordinary(transfer: Transfer, own: [f64; 3], wide: bool) -> [f64; 3] {
        let light = own.map(|part| odd(part, |part| transfer.light(part)));
        let light = if wide { product(&USUAL_OF_WIDE, light) } else { light };
        light.map(|part| odd(part, |part| Transfer::Power.encoded(part)))
    }

    const HDR: [Transfer; 2] = [Transfer::HybridLogGamma, Transfer::PerceptualQuantizer];

    #[test]
    fn known_levels_are_the_standards() {
        // BT.2408, Tables 1 and 2: reference white and 18 % grey; BT.2100: the ends.
        let cases = [
            (HDR[0], 0.75, 1.0, 1e-9),
            (HDR[0], 0.5, 1.0 / 12.0 / HLG_WHITE, 1e-12),
            (HDR[0], 1.0, 1.0 / HLG_WHITE, 1e-6),
            (HDR[1], 0.58, 203.0 / 203.0, 0.01),
            (HDR[1], 0.508_078, 100.0 / 203.0, 1e-5),
            (HDR[1], 0.751_827, 1000.0 / 203.0, 1e-4),
            (HDR[1], 1.0, 10_000.0 / 203.0, 1e-9),
        ];
        for (transfer, level, light, within) in cases {
            assert!((transfer.light(level) - light).abs() <= within, "{transfer:?} {level}: {}", transfer.light(level));
        }
    }

    #[test]
    fn colours_go_there_and_back_and_grey_stays_grey() {
        for transfer in HDR {
            for wide in [false, true] {
                for colour in [[0.0; 3], [0.6, 0.45, 0.4], [1.0; 3], [1.5, 0.2, -0.1], [0.02, 0.9, 0.1]] {
                    let own = transfer.own(colour, wide);
                    let back = ordinary(transfer, own, wide);
                    let gap = (0..3).map(|c| (back[c] - colour[c]).abs()).fold(0.0, f64::max);
                    assert!(gap <= 1e-4, "{transfer:?} {colour:?}: {own:?}, {back:?}");
                }
                let grey = ordinary(transfer, [0.4; 3], wide);
                assert!((grey[0] - grey[1]).abs().max((grey[2] - grey[1]).abs()) <= 1e-9, "{grey:?}");
            }
        }
        assert_eq!(Transfer::Power.own([0.3, 0.2, 1.2], true), [0.3, 0.2, 1.2]);
    }

    #[test]
    fn light_that_comes_and_goes_leaves_the_ratios_of_ordinary_values() {
        for transfer in HDR {
            let ratio = |light: f64| {
                let own = transfer.own([0.7, 0.5, 0.45].map(|part: f64| part * light.powf(1.0 / GAMMA)), true);
                let read = ordinary(transfer, own, true);
                [(read[1] / read[0]).ln(), (own[1] / own[0]).ln()]
            };
            let [(few, few_own), (more, more_own)] = [0.8, 1.2].map(ratio).map(|[read, own]| (read, own));
            assert!((few - more).abs() <= 1e-4, "{transfer:?}: {few}, {more}");
            // Read as they are, they change as in a slight press.
            assert!((few_own - more_own).abs() >= 0.004, "{transfer:?}: {few_own}, {more_own}");
        }
    }
}
