//! Colours of skin and nail by tone, from very light to very dark.
//!
//! Tones follow Fitzpatrick's I to VI: melanin takes blue more than green more than red. The nail bed has little
//! melanin and changes far less. Values are linear reflectances as a camera of sRGB primaries sees them (typical
//! values, not one person's), encoded here once.

/// Linear reflectance (red, green, blue) of skin from Fitzpatrick I to VI.
const SKIN: [[f64; 3]; 6] = [
    [0.84, 0.60, 0.50],
    [0.76, 0.49, 0.37],
    [0.64, 0.36, 0.24],
    [0.46, 0.235, 0.140],
    [0.250, 0.115, 0.066],
    [0.100, 0.045, 0.028],
];

/// Linear reflectance of the nail bed seen through the plate, without melanin and with the most.
const BED: [[f64; 3]; 2] = [[0.80, 0.42, 0.37], [0.58, 0.285, 0.225]];

/// How dark a skin is: 0 for Fitzpatrick I to 1 for VI.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Tone(f64);

/// sRGB's curve: linear 0..1 to encoded 0..1.
fn encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn between(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|c| encode(a[c].powf(1.0 - t) * b[c].powf(t)))
}

impl Tone {
    /// The tone `darkness` (0 lightest to 1 darkest; values beyond are taken to the nearer end).
    pub fn new(darkness: f64) -> Self {
        Self(darkness.clamp(0.0, 1.0))
    }

    /// 0 for the lightest to 1 for the darkest.
    pub fn darkness(self) -> f64 {
        self.0
    }

    /// The skin's colour in full light, encoded.
    pub fn skin(self) -> [f64; 3] {
        let at = self.0 * 5.0;
        let low = (at.floor() as usize).min(4);
        between(SKIN[low], SKIN[low + 1], at - low as f64)
    }

    /// The nail bed's colour in full light, encoded.
    pub fn bed(self) -> [f64; 3] {
        between(BED[0], BED[1], self.0)
    }
}
