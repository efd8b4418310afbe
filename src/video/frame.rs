//! One frame's planes: borrowed from the decoder or owned by whoever draws one.

/// One plane of samples of 8 to 16 bits.
#[derive(Debug, Clone, Copy)]
pub struct Plane<'a> {
    /// Samples a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Bytes from a row's first sample to the next row's.
    pub stride: usize,
    /// Bits of a sample; over 8, a sample takes two bytes, the low one first.
    pub depth: u32,
    /// The bytes, row after row: `height` x `stride`.
    pub data: &'a [u8],
}

impl Plane<'_> {
    /// The sample of column `x` and row `y`, on the scale of 8 bits (0 to 255, with fractions for deeper samples).
    #[must_use]
    pub fn sample(&self, x: usize, y: usize) -> f32 {
        let at = y * self.stride;
        if self.depth <= 8 {
            f32::from(self.data[at + x])
        } else {
            let deep = u16::from_le_bytes([self.data[at + 2 * x], self.data[at + 2 * x + 1]]);
            f32::from(deep) * self.to_eight_bits()
        }
    }

    /// Samples of row `y` from column `x0` on into `into`, on the scale of 8 bits.
    pub fn copy_row(&self, y: usize, x0: usize, into: &mut [f32]) {
        let start = y * self.stride;
        if self.depth <= 8 {
            let row = &self.data[start + x0..start + x0 + into.len()];
            for (value, &byte) in into.iter_mut().zip(row) {
                *value = f32::from(byte);
            }
        } else {
            let row = &self.data[start + 2 * x0..start + 2 * (x0 + into.len())];
            let scale = self.to_eight_bits();
            for (value, pair) in into.iter_mut().zip(row.chunks_exact(2)) {
                *value = f32::from(u16::from_le_bytes([pair[0], pair[1]])) * scale;
            }
        }
    }

    fn to_eight_bits(self) -> f32 {
        1.0 / (1u32 << (self.depth - 8)) as f32
    }
}

/// A frame to look at.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// Its place in the order of presentation, from 0; frames that could not be decoded are counted.
    pub index: u64,
    /// Its presentation time from the first frame's.
    pub time_s: f64,
    /// Luma.
    pub luma: Plane<'a>,
    /// Cb and Cr, of the same size each; none for grey video.
    pub chroma: Option<[Plane<'a>; 2]>,
    /// How coarsely it is encoded: the mean quantization parameter of its blocks, 0 to 51; the step doubles with each
    /// 6. `None` where the decoder doesn't tell (all but H.264).
    pub quantizer: Option<f64>,
}

impl Frame<'_> {
    /// Luma columns and rows for one chroma sample: (2, 2) for 4:2:0; (1, 1) without chroma.
    #[must_use]
    pub fn subsampling(&self) -> (usize, usize) {
        self.chroma.map_or((1, 1), |[cb, _]| {
            let ratio = |luma: usize, chroma: usize| luma.div_ceil(chroma.max(1)).next_power_of_two();
            (ratio(self.luma.width, cb.width), ratio(self.luma.height, cb.height))
        })
    }
}

/// How a picture's samples are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Format {
    /// Luma columns.
    pub width: usize,
    /// Luma rows.
    pub height: usize,
    /// Luma columns and rows for one chroma sample; none without chroma.
    pub subsampling: Option<(usize, usize)>,
    /// Bits of a sample.
    pub depth: u32,
}

impl Format {
    /// Columns and rows of a chroma plane.
    #[must_use]
    pub fn chroma_size(&self) -> Option<(usize, usize)> {
        self.subsampling.map(|(across, down)| (self.width.div_ceil(across), self.height.div_ceil(down)))
    }

    /// Bytes of a sample.
    #[must_use]
    pub fn sample_bytes(&self) -> usize {
        if self.depth > 8 { 2 } else { 1 }
    }

    /// Luma, Cb and Cr. Of a plane's number and width: bytes from row to row, and all bytes.
    pub(in crate::video) fn planes<'a>(
        &self,
        of: impl Fn(usize, usize) -> (usize, &'a [u8]),
    ) -> (Plane<'a>, Option<[Plane<'a>; 2]>) {
        let plane = |number: usize, (width, height)| {
            let (stride, data) = of(number, width);
            Plane { width, height, stride, depth: self.depth, data }
        };
        let chroma = self.chroma_size().map(|size| [plane(1, size), plane(2, size)]);
        (plane(0, (self.width, self.height)), chroma)
    }
}

/// A picture of one's own, to draw on and to encode.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// How the samples are laid out.
    pub format: Format,
    /// Luma, Cb, Cr (the first alone without chroma), rows without gaps; two bytes a sample, the low one first, over 8
    /// bits.
    pub planes: Vec<Vec<u8>>,
}

impl Picture {
    /// A picture of zeros.
    #[must_use]
    pub fn new(format: Format) -> Self {
        let bytes = format.sample_bytes();
        let mut planes = vec![vec![0; format.width * format.height * bytes]];
        if let Some((width, height)) = format.chroma_size() {
            planes.resize_with(3, || vec![0; width * height * bytes]);
        }
        Self { format, planes }
    }

    /// The picture as a frame.
    #[must_use]
    pub fn frame(&self, index: u64, time_s: f64) -> Frame<'_> {
        let bytes = self.format.sample_bytes();
        let (luma, chroma) = self.format.planes(|number, width| (width * bytes, &self.planes[number]));
        Frame { index, time_s, luma, chroma, quantizer: None }
    }
}
