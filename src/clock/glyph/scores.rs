//! How probably a patch shows each digit.

/// A digit that is at least this probable is read. On drawn digits of typefaces and displays that nothing was trained
/// on, sharp and in good light, 93 % are (4 in a million wrong), and under any conditions 75 %, 1 in 6000 wrong
/// (`digits figures` of `crates/training`).
pub const SURE: f64 = 0.95;

/// How probably a patch shows each digit, or anything else: nothing, a mark, two digits blended, a digit half covered.
/// They add up to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scores {
    /// Of the digits 0 to 9.
    pub digits: [f64; 10],
    /// Of anything else.
    pub other: f64,
}

impl Scores {
    /// From the network's answers, natural logarithms up to a common term.
    pub(super) fn of(answers: [f32; 11]) -> Self {
        let most = answers.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let shares = answers.map(|a| f64::from(a - most).exp());
        let sum: f64 = shares.iter().sum();
        Self { digits: std::array::from_fn(|k| shares[k] / sum), other: shares[10] / sum }
    }

    /// The likeliest digit and how probable it is, sure or not.
    #[must_use]
    pub fn likeliest(&self) -> (u8, f64) {
        let mut best = (0, self.digits[0]);
        for (digit, &probability) in (1..).zip(&self.digits[1..]) {
            if probability > best.1 {
                best = (digit, probability);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_become_probabilities() {
        let mut answers = [0.0; 11];
        answers[7] = 8.0;
        answers[10] = 2.0;
        let scores = Scores::of(answers);
        assert!((scores.digits.iter().sum::<f64>() + scores.other - 1.0).abs() <= 1e-12);
        assert!((scores.digits[7] / scores.other - 6f64.exp()).abs() <= 1e-6);
        assert!(matches!(scores.likeliest(), (7, probability) if probability >= SURE));
        answers[10] = 7.0;
        assert!(matches!(Scores::of(answers).likeliest(), (7, probability) if probability < SURE && probability > 0.7));
    }
}
