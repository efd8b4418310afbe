//! A small network: inputs, one hidden layer of softsign units, one output.
//!
//! Weights are text, one number a line: inputs, hidden units, then for each input its mean and scale, for each hidden
//! unit its weights and bias, then the output's weights and bias. They come from `nails` of `crates/training`.

/// Most inputs of any network.
const MOST_INPUTS: usize = 96;

/// One hidden layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Net {
    /// How many inputs.
    pub inputs: usize,
    /// How many hidden units.
    pub hidden: usize,
    /// mean, 1/scale of each input.
    pub norm: Vec<[f32; 2]>,
    /// `inputs` weights and a bias for each hidden unit.
    pub first: Vec<f32>,
    /// `hidden` weights and a bias.
    pub second: Vec<f32>,
}

/// What a hidden unit makes of its sum.
#[must_use]
pub fn softsign(x: f32) -> f32 {
    x / (1.0 + x.abs())
}

impl Net {
    /// Reads weights; `None` where the text is not such a list.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let mut numbers = text.split_ascii_whitespace().map(|w| w.parse::<f32>());
        let mut next = || numbers.next()?.ok();
        let (inputs, hidden) = (next()? as usize, next()? as usize);
        let norm = (0..inputs).map(|_| Some([next()?, next()?])).collect::<Option<_>>()?;
        let first = (0..(inputs + 1) * hidden).map(|_| next()).collect::<Option<_>>()?;
        let second = (0..=hidden).map(|_| next()).collect::<Option<_>>()?;
        Some(Self { inputs, hidden, norm, first, second })
    }

    /// The output for `x`.
    #[must_use]
    pub fn answer(&self, x: &[f32]) -> f32 {
        let mut z = [0.0f32; MOST_INPUTS];
        let n = self.inputs;
        for i in 0..n {
            z[i] = (x[i] - self.norm[i][0]) * self.norm[i][1];
        }
        let mut out = self.second[self.hidden];
        for (unit, w) in self.first.chunks_exact(n + 1).zip(&self.second) {
            let mut sum = [0.0f32; 8];
            let (a, b) = (&unit[..n], &z[..n]);
            let (ac, bc) = (a.chunks_exact(8), b.chunks_exact(8));
            let tail: f32 = ac.remainder().iter().zip(bc.remainder()).map(|(p, q)| p * q).sum();
            for (p, q) in ac.zip(bc) {
                for k in 0..8 {
                    sum[k] += p[k] * q[k];
                }
            }
            out += w * softsign(unit[n] + tail + sum.iter().sum::<f32>());
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::Net;

    #[test]
    fn the_weights_that_come_along_are_whole() {
        let nets = [
            (include_str!("weights/scorer.txt"), super::super::evidence::INPUTS),
            (include_str!("weights/border.txt"), super::super::refine::INPUTS),
            (include_str!("weights/judge-0.txt"), super::super::candidate::FEATURES),
            (include_str!("weights/judge-1.txt"), super::super::candidate::FEATURES),
            (include_str!("weights/judge-2.txt"), super::super::candidate::FEATURES),
        ];
        for (text, inputs) in nets {
            let net = Net::parse(text).expect("whole");
            assert_eq!(net.inputs, inputs);
            assert!(inputs <= super::MOST_INPUTS);
            let numbers = 2 + 2 * inputs + (inputs + 1) * net.hidden + net.hidden + 1;
            assert_eq!(text.split_ascii_whitespace().count(), numbers);
            assert!(net.answer(&vec![0.0; inputs]).is_finite());
        }
    }

    #[test]
    fn an_answer_is_the_sum_it_says() {
        // Two inputs (means 1, 0; scales 1, 2), one unit 0.5 a - b + 0.25, output 3 softsign(unit) - 1.
        let net = Net::parse("2 1  1 1  0 2  0.5 -1 0.25  3 -1").expect("whole");
        let unit: f32 = 0.5 * (4.0 - 1.0) - (0.25 * 2.0) + 0.25;
        let expected = 3.0 * unit / (1.0 + unit.abs()) - 1.0;
        assert!((net.answer(&[4.0, 0.25]) - expected).abs() <= 1e-6);
        assert_eq!(Net::parse("2 1 1 1 0 2 0.5 -1 0.25 3"), None);
        assert_eq!(Net::parse("one"), None);
    }
}
