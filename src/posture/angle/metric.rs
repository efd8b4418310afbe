//! Whether a length looks alike in every direction: in a stretched video, or of a finger that is filmed obliquely, it
//! does not, and all angles are wrong.
//!
//! In: from frame to frame the vectors of segments, which turn and keep their lengths. With v = (dx^2, dy^2, 2 dx dy)
//! the metric m = (a, b, c), a + b = 2, is looked for with which v m of each segment stays the most alike: least
//! squares, C m = k (1, 1, 0), C being the covariance of v over its segment's mean squared length. (1, 1, 0) is a view
//! that is square. Out: what to say where it is not ([`Metric::doubt`]).
//!
//! Measured on the true places of a phantom's markers (8 s, J2 over 80 degrees) with errors of 0.3 px: squeezed to
//! 0.75, 0.866 and 0.9 of their width they look 1.33, 1.155 and 1.11 times as long in one direction, and lengths vary
//! by 6.3, 3.5 and 2.5 % before and 0.4 % after. Markers that slide on the skin, which makes segments up to 15 %
//! longer at 90 degrees of flexion in any mixture (200 of them), look like 1.11 at most in 95 %, and never pass what
//! is asked for.

use nalgebra::{Matrix2, Matrix3, Vector3};

/// Lengths differ so much between directions that it matters, vary by so much, and so much of it is left at most with
/// the metric (assumed; see the head).
const LEAST_RATIO: f64 = 1.12;
const LEAST_SD: f64 = 0.02;
const LEFT: f64 = 0.4;
/// One segment at least has to turn by about 30 degrees: cos and sin of twice its direction are no longer than this in
/// the mean (of directions spread evenly over 0.5 rad: sin(0.5) / 0.5).
const TURNED: f64 = 0.96;
/// Below so many frames of a segment it has no say.
const FRAMES: f64 = 20.0;

/// What the segments of one video say.
#[derive(Debug, Clone)]
pub(super) struct Metric {
    segments: Vec<Sums>,
}

/// Of one segment: frames, sums of v and of its products.
#[derive(Debug, Clone, Default)]
struct Sums {
    count: f64,
    v: Vector3<f64>,
    products: Matrix3<f64>,
}

impl Metric {
    pub(super) fn new(segments: usize) -> Self {
        Self { segments: vec![Sums::default(); segments] }
    }

    /// Takes a segment's vector in one frame.
    pub(super) fn add(&mut self, segment: usize, [dx, dy]: [f64; 2]) {
        let v = Vector3::new(dx * dx, dy * dy, 2.0 * dx * dy);
        let sums = &mut self.segments[segment];
        sums.count += 1.0;
        sums.v += v;
        sums.products += v * v.transpose();
    }

    /// What to say where lengths depend on their direction.
    pub(super) fn doubt(&self) -> Option<String> {
        let (mut covariance, mut frames, mut turned) = (Matrix3::zeros(), 0.0, 1.0_f64);
        for sums in self.segments.iter().filter(|sums| sums.count >= FRAMES) {
            let mean = sums.v / sums.count;
            let squared = mean.x + mean.y;
            covariance += (sums.products - mean * mean.transpose() * sums.count) / (squared * squared);
            frames += sums.count;
            turned = turned.min((mean.x - mean.y).hypot(mean.z) / squared);
        }
        if turned > TURNED {
            return None;
        }
        let covariance = covariance / frames;
        let square = Vector3::new(1.0, 1.0, 0.0);
        // Of a squared length, which varies by twice as much.
        let sd = |m: &Vector3<f64>| 0.5 * m.dot(&(covariance * m)).max(0.0).sqrt();
        // What keeps it solvable where nothing turns.
        let solved = (covariance + Matrix3::identity() * 1e-12).try_inverse()? * square;
        let best = solved * (2.0 / square.dot(&solved));
        let eigen = Matrix2::new(best.x, best.z, best.z, best.y).symmetric_eigen();
        let [low, high] = [eigen.eigenvalues.imin(), eigen.eigenvalues.imax()];
        let ratio = (eigen.eigenvalues[high] / eigen.eigenvalues[low]).sqrt();
        let (recorded, left) = (sd(&square), sd(&best));
        if !(ratio >= LEAST_RATIO && recorded >= LEAST_SD && left <= LEFT * recorded) {
            return None;
        }
        // Where true lengths are less than they look.
        let along = eigen.eigenvectors.column(low);
        let along_deg = along.y.atan2(along.x).to_degrees().round().rem_euclid(180.0) + 0.0;
        let off_deg = ((ratio - 1.0) / (2.0 * ratio.sqrt())).atan().to_degrees();
        Some(format!(
            "as the finger turns, its segments look {ratio:.2} times as long along {along_deg:.0} degrees of the \
             picture (0 is right, 90 down) as across (lengths vary by {:.1} %, corrected by {:.1} %): a stretched \
             video, or one that is filmed obliquely, by {:.0} degrees? Then segments' directions are up to \
             {off_deg:.0} degrees off; resize it to square pixels, or let `lunula camera --plane` measure the \
             finger's plane",
            100.0 * recorded,
            100.0 * left,
            ratio.recip().acos().to_degrees()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of four segments of a finger that bends and stretches, their vectors `seen`; they are longer by
    /// `slides` of their length at a right angle.
    fn said(slides: [f64; 4], seen: impl Fn([f64; 2]) -> [f64; 2]) -> Option<String> {
        let mut metric = Metric::new(4);
        for frame in 0..200 {
            let bent = 0.5 - 0.5 * (0.1 * f64::from(frame)).cos();
            for (segment, slide) in slides.into_iter().enumerate() {
                let rad = 0.2 + [0.0, 0.3, 1.4, 2.1][segment] * bent;
                let noise = f64::from((frame * 7 + segment as i32 * 3) % 11 - 5) * 0.06;
                let length = [100.0, 80.0, 50.0, 35.0][segment] * (1.0 + slide * bent) + noise;
                metric.add(segment, seen([length * rad.cos(), length * rad.sin()]));
            }
        }
        metric.doubt()
    }

    #[test]
    fn a_stretched_or_oblique_view_is_seen_and_skin_that_slides_is_not() {
        let still = [0.0; 4];
        assert_eq!(said(still, |d| d), None);
        let squeezed = said(still, |[x, y]| [0.75 * x, y]).expect("it is stretched");
        assert!(squeezed.contains("look 1.33 times as long along 90 degrees"), "{squeezed}");
        assert!(squeezed.contains("by 41 degrees? Then segments' directions are up to 8 degrees off"), "{squeezed}");
        let widened = said(still, |[x, y]| [1.2 * x, y]).expect("it is stretched");
        assert!(widened.contains("look 1.20 times as long along 0 degrees"), "{widened}");
        // Shorter across a direction of 30 degrees.
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let oblique = |[x, y]: [f64; 2]| {
            let [along, across] = [cos * x + sin * y, 0.8 * (cos * y - sin * x)];
            [cos * along - sin * across, sin * along + cos * across]
        };
        let oblique = said(still, oblique).expect("it is oblique");
        assert!(oblique.contains("look 1.25 times as long along 30 degrees"), "{oblique}");
        for slides in [[0.0, 0.1, -0.1, 0.1], [0.1, 0.1, 0.1, 0.1], [0.0, -0.1, 0.05, -0.1], [0.0, 0.0, 0.1, -0.1]] {
            assert_eq!(said(slides, |d| d), None, "{slides:?}");
        }
        // A finger that does not turn, and a video of a few frames.
        let mut metric = Metric::new(1);
        (0..200).for_each(|frame| metric.add(0, [30.0 + f64::from(frame % 7), 10.0]));
        assert_eq!(metric.doubt(), None);
        assert_eq!(Metric::new(4).doubt(), None);
    }
}
