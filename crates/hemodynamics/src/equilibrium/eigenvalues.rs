//! Eigenvalues of the model about a state, slow and fast ones to the same number of digits.
//!
//! The walls obey `l'' = (K + u p^T) l + (B + u q^T) l'` with diagonal `K`, `B` ([`Arrow`]), so the eigenvalues are the
//! zeros of
//!
//! `prod d_j(z) S(z)`, `d_j = z^2 - B_j z - K_j`, `S = 1 - sum u_j (p_j + q_j z) / d_j`.
//!
//! They are found all at once by the iteration of Ehrlich and Aberth (doi:10.1145/355588.365107), which needs only the
//! logarithmic derivative of that product. No matrix with entries from 1 to 1e12 is decomposed, which would leave six
//! digits of the slow ones. Walls that are the same, of which only the sum acts on the rest, are taken together: `m` of
//! them have the zeros of `d_j` as eigenvalues `m - 1` times, and are one wall of `m` times the coupling in `S`.

use num_complex::Complex64;

use crate::model::Arrow;

/// An eigenvalue, with what rounding leaves open of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigenvalue {
    /// Real part, 1/s; negative where the motion decays.
    pub real_per_s: f64,
    /// Imaginary part, 1/s; not 0 where the motion swings.
    pub imaginary_per_s: f64,
    /// How far rounding may have moved it, 1/s.
    pub error_per_s: f64,
}

/// The walls that are the same.
struct Group {
    count: usize,
    /// `K`, 1/s2.
    by_lumen: f64,
    /// `B`, 1/s.
    by_rate: f64,
    /// `m u p`, 1/s2.
    coupled_lumen: f64,
    /// `m u q`, 1/s.
    coupled_rate: f64,
}

/// Rounds of the iteration before giving up.
const MOST_ROUNDS: usize = 200;
/// Rounds after which a step within rounding is taken for none: an eigenvalue of 0 has no digits of its own.
const ROUGH_ROUNDS: usize = 40;

/// All eigenvalues, those with the greatest real part first; `None` where the iteration does not settle or a
/// coefficient is not finite.
pub(super) fn eigenvalues(arrow: &Arrow) -> Option<Vec<Eigenvalue>> {
    let groups = groups(arrow);
    let mut all = Vec::with_capacity(2 * arrow.by_lumen.len());
    for group in &groups {
        for root in group.roots(group.by_lumen, group.by_rate) {
            let size = magnitude(root) * (magnitude(root) + group.by_rate.abs()) + group.by_lumen.abs();
            let error = 4.0 * f64::EPSILON * size / magnitude(2.0 * root - group.by_rate);
            all.extend((1..group.count).map(|_| Eigenvalue {
                real_per_s: root.re,
                imaginary_per_s: root.im,
                error_per_s: error,
            }));
        }
    }
    for root in settle(&groups)? {
        let error_per_s = rounding(&groups, root);
        all.push(Eigenvalue { real_per_s: root.re, imaginary_per_s: root.im, error_per_s });
    }
    let known = all.iter().all(|one| one.real_per_s.is_finite() && one.imaginary_per_s.is_finite());
    all.sort_by(|a, b| b.real_per_s.total_cmp(&a.real_per_s).then(b.imaginary_per_s.total_cmp(&a.imaginary_per_s)));
    (known && trace_holds(arrow, &all)).then_some(all)
}

/// Whether the eigenvalues add up to the trace: none was found twice in place of another.
fn trace_holds(arrow: &Arrow, all: &[Eigenvalue]) -> bool {
    let walls = 0..arrow.by_rate.len();
    let trace: f64 = walls.map(|j| arrow.by_rate[j] + arrow.by_pressure[j] * arrow.pressure_by_rate[j]).sum();
    let sum: f64 = all.iter().map(|one| one.real_per_s).sum();
    let size: f64 = all.iter().map(|one| one.real_per_s.abs() + one.imaginary_per_s.abs()).sum();
    (sum - trace).abs() <= 1e-9 * size
}

fn groups(arrow: &Arrow) -> Vec<Group> {
    let mut groups: Vec<(usize, Group)> = Vec::new();
    let same = |a: usize, b: usize| {
        [&arrow.by_lumen, &arrow.by_rate, &arrow.by_pressure, &arrow.pressure_by_lumen, &arrow.pressure_by_rate]
            .iter()
            .all(|values| values[a] == values[b])
    };
    for j in 0..arrow.by_lumen.len() {
        let (lumen, rate) =
            (arrow.by_pressure[j] * arrow.pressure_by_lumen[j], arrow.by_pressure[j] * arrow.pressure_by_rate[j]);
        match groups.iter_mut().find(|(first, _)| same(*first, j)) {
            Some((_, group)) => {
                group.count += 1;
                group.coupled_lumen += lumen;
                group.coupled_rate += rate;
            }
            None => groups.push((
                j,
                Group {
                    count: 1,
                    by_lumen: arrow.by_lumen[j],
                    by_rate: arrow.by_rate[j],
                    coupled_lumen: lumen,
                    coupled_rate: rate,
                },
            )),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

impl Group {
    /// The zeros of `z^2 - b z - k`, without cancellation.
    fn roots(&self, k: f64, b: f64) -> [Complex64; 2] {
        let half = 0.5 * b;
        let under = half * half + k;
        if under < 0.0 {
            let swing = (-under).sqrt();
            return [Complex64::new(half, swing), Complex64::new(half, -swing)];
        }
        let far = if half < 0.0 { half - under.sqrt() } else { half + under.sqrt() };
        let near = if far == 0.0 { 0.0 } else { -k / far };
        [Complex64::new(near, 0.0), Complex64::new(far, 0.0)]
    }

    /// `d(z)`; not 0, so that it can be divided by.
    fn quadratic(&self, z: Complex64) -> Complex64 {
        let d = z * (z - self.by_rate) - self.by_lumen;
        let least = f64::EPSILON * f64::EPSILON * self.by_lumen.abs();
        if magnitude(d) > least { d } else { Complex64::new(least, 0.0) }
    }
}

/// `S`, its slope, and the sum of the magnitudes that it is rounded from.
fn secular(groups: &[Group], z: Complex64) -> (Complex64, Complex64, f64) {
    let (mut value, mut slope, mut size) = (Complex64::new(1.0, 0.0), Complex64::new(0.0, 0.0), 1.0);
    for group in groups {
        let d = group.quadratic(z);
        let above = group.coupled_lumen + group.coupled_rate * z;
        value -= above / d;
        slope -= (group.coupled_rate - above / d * (2.0 * z - group.by_rate)) / d;
        let rounded = (magnitude(z) * (magnitude(z) + group.by_rate.abs()) + group.by_lumen.abs()) / magnitude(d);
        size += (group.coupled_lumen.abs() + group.coupled_rate.abs() * magnitude(z)) / magnitude(d) * (1.0 + rounded);
    }
    (value, slope, size)
}

/// How far rounding may move a zero of `S`.
fn rounding(groups: &[Group], z: Complex64) -> f64 {
    let (_, slope, size) = secular(groups, z);
    4.0 * f64::EPSILON * size / magnitude(slope)
}

/// `|z|` in plain operations, the same digits on every machine.
fn magnitude(z: Complex64) -> f64 {
    (z.re * z.re + z.im * z.im).sqrt()
}

/// One over the logarithmic derivative of the product at `z`: Newton's step.
fn newton(groups: &[Group], z: Complex64) -> Complex64 {
    let (value, slope, _) = secular(groups, z);
    let poles: Complex64 = groups.iter().map(|group| (2.0 * z - group.by_rate) / group.quadratic(z)).sum();
    value / (poles * value + slope)
}

/// The zeros of the product over the groups.
fn settle(groups: &[Group]) -> Option<Vec<Complex64>> {
    let mut at: Vec<Complex64> = groups
        .iter()
        .flat_map(|group| group.roots(group.by_lumen + group.coupled_lumen, group.by_rate + group.coupled_rate))
        .collect();
    // Off the real axis, or pairs would never leave it; apart, or equal ones would stay together.
    let size = at.iter().map(|&z| magnitude(z)).fold(0.0, f64::max);
    for (i, z) in at.iter_mut().enumerate() {
        let apart = 1e-3 * (1.0 + i as f64);
        let turned = Complex64::new(1.0 + apart, if i % 2 == 0 { apart } else { -apart });
        *z = if magnitude(*z) > 0.0 { *z * turned } else { 1e-12 * size * turned };
    }
    let mut settled = vec![false; at.len()];
    for round in 0..MOST_ROUNDS {
        for i in 0..at.len() {
            if settled[i] {
                continue;
            }
            let step = newton(groups, at[i]);
            let others: Complex64 = (0..at.len()).filter(|&j| j != i).map(|j| (at[i] - at[j]).inv()).sum();
            let step = step / (1.0 - step * others);
            if !step.re.is_finite() || !step.im.is_finite() {
                return None;
            }
            at[i] -= step;
            settled[i] = magnitude(step) <= 1e-14 * magnitude(at[i])
                || (round > ROUGH_ROUNDS && magnitude(step) <= rounding(groups, at[i]));
        }
        if settled.iter().all(|&done| done) {
            break;
        }
    }
    if settled.contains(&false) {
        return None;
    }
    for z in &mut at {
        *z = polished(groups, *z);
    }
    Some(at)
}

/// The zero to its last digits, on the real axis where it belongs there.
fn polished(groups: &[Group], mut z: Complex64) -> Complex64 {
    if z.im.abs() <= 4.0 * rounding(groups, z) + 1e-13 * magnitude(z) {
        z.im = 0.0;
    }
    for _ in 0..3 {
        let step = newton(groups, z);
        if magnitude(step) <= 1e-6 * magnitude(z) {
            z -= step;
        }
    }
    z
}
