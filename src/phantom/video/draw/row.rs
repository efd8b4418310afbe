//! A row of a picture in the making.

/// A row of R'G'B', 0 to 1, and its pixels' places.
#[derive(Debug, Clone)]
pub(in crate::phantom) struct Row {
    pub(in crate::phantom) rgb: [Vec<f32>; 3],
    pub(in crate::phantom::video) light: Vec<f32>,
}

impl Row {
    pub(in crate::phantom::video) fn new(width: usize) -> Self {
        Self { rgb: [vec![0.0; width], vec![0.0; width], vec![0.0; width]], light: vec![1.0; width] }
    }

    pub(in crate::phantom::video) fn width(&self) -> usize {
        self.light.len()
    }

    /// Lays `share` of a colour under this light over a pixel.
    pub(in crate::phantom::video) fn mix(&mut self, x: usize, colour: [f32; 3], share: f32) {
        let light = self.light[x];
        for (channel, value) in self.rgb.iter_mut().zip(colour) {
            channel[x] += share * (light * value - channel[x]);
        }
    }
}
