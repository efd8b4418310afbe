//! Between R'G'B' and Y'CbCr: the matrices of ITU-R BT.601, BT.709 and BT.2020, both ranges.

/// The matrix between R'G'B' and Y'CbCr, and the range of the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matrix {
    /// Red's share of luma.
    pub k_red: f64,
    /// Blue's share of luma.
    pub k_blue: f64,
    /// Samples use all values; if not, luma runs from 16 to 235 and chroma from 16 to 240.
    pub full_range: bool,
}

impl Matrix {
    /// ITU-R BT.601.
    pub const BT601: Self = Self { k_red: 0.299, k_blue: 0.114, full_range: false };
    /// ITU-R BT.709.
    pub const BT709: Self = Self { k_red: 0.2126, k_blue: 0.0722, full_range: false };
    /// ITU-R BT.2020, non-constant luminance.
    pub const BT2020: Self = Self { k_red: 0.2627, k_blue: 0.0593, full_range: false };

    /// Y'CbCr on the scale of 8 bits (0 to 255, grey has Cb = Cr = 128) of R'G'B' from 0 to 1.
    #[must_use]
    pub fn from_rgb(&self, [red, green, blue]: [f64; 3]) -> [f64; 3] {
        let luma = self.k_red * red + self.k_blue * blue + (1.0 - self.k_red - self.k_blue) * green;
        let cb = (blue - luma) / (2.0 * (1.0 - self.k_blue));
        let cr = (red - luma) / (2.0 * (1.0 - self.k_red));
        let (base, luma_span, chroma_span) = self.spans();
        [base + luma_span * luma, 128.0 + chroma_span * cb, 128.0 + chroma_span * cr]
    }

    /// R'G'B' from 0 to 1 (not clipped) of Y'CbCr on the scale of 8 bits.
    #[must_use]
    pub fn to_rgb(&self, [luma, cb, cr]: [f64; 3]) -> [f64; 3] {
        let (base, luma_span, chroma_span) = self.spans();
        let luma = (luma - base) / luma_span;
        let red = luma + 2.0 * (1.0 - self.k_red) * (cr - 128.0) / chroma_span;
        let blue = luma + 2.0 * (1.0 - self.k_blue) * (cb - 128.0) / chroma_span;
        let green = (luma - self.k_red * red - self.k_blue * blue) / (1.0 - self.k_red - self.k_blue);
        [red, green, blue]
    }

    fn spans(&self) -> (f64, f64, f64) {
        if self.full_range { (0.0, 255.0, 255.0) } else { (16.0, 219.0, 224.0) }
    }
}
