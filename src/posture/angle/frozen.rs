//! Pictures that show what the one before shows while the finger moves on: a camera that stood still for a moment, or
//! ten pictures a second in a file of thirty. Their angles are of an earlier time.
//!
//! In: from frame to frame the places of markers and the joints' angles. Out: what to say where markers stay where they
//! are, all of them at once and for a frame at least, and then jump. A finger that rests does the first and not the
//! second.
//!
//! Measured on three phantoms of 480x270, encoded again: half a second of repeated pictures (angles up to 12 degrees
//! off) and ten pictures a second (2.4 degrees) are seen in all, and nothing where all pictures are new.

/// Places that are no further apart are the same, pixels.
const SAME_PX: f64 = 0.02;
/// Markers that have to stay where they are, at least.
const MARKERS: usize = 2;
/// An angle that has changed by so much and by so many of its standard errors has jumped (assumed: a finger that
/// begins to move turns by less from one frame to the next).
const JUMP_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
const JUMP_SDS: f64 = 5.0;
/// Smaller jumps, by so much, count where there are so many of them.
const SMALL_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
const OFTEN: u64 = 10;

/// What the frames of a video say.
#[derive(Debug, Clone, Default)]
pub(super) struct Frozen {
    places: Vec<Option<[f64; 2]>>,
    angles: Vec<Option<[f64; 2]>>,
    frames: u64,
    /// Frames so far that repeat the one before.
    repeated: u64,
    /// Of jumps after such frames: how many there were, and of which frames, which frame was the first, by how much.
    stale: Stale,
    small: Stale,
}

#[derive(Debug, Clone, Copy, Default)]
struct Stale {
    jumps: u64,
    frames: u64,
    first: u64,
    most_rad: f64,
}

impl Frozen {
    /// Takes the next frame: each marker's place, each joint's angle and its standard error, radians.
    pub(super) fn add(&mut self, places: Vec<Option<[f64; 2]>>, angles: Vec<Option<[f64; 2]>>) {
        let stays = |(now, before): (&Option<[f64; 2]>, &Option<[f64; 2]>)| match (now, before) {
            (Some(now), Some(before)) => (now[0] - before[0]).hypot(now[1] - before[1]) <= SAME_PX,
            (None, None) => true,
            _ => false,
        };
        let seen = places.iter().flatten().count();
        if seen >= MARKERS && places.len() == self.places.len() && places.iter().zip(&self.places).all(stays) {
            self.repeated += 1;
        } else if self.repeated > 0 {
            let turned = |(now, before): (&Option<[f64; 2]>, &Option<[f64; 2]>)| {
                let ([rad, sd_rad], [before_rad, before_sd_rad]) = ((*now)?, (*before)?);
                let by_rad = (rad - before_rad).abs();
                (by_rad > JUMP_SDS * sd_rad.hypot(before_sd_rad)).then_some(by_rad)
            };
            let most_rad = angles.iter().zip(&self.angles).filter_map(turned).fold(0.0, f64::max);
            for (stale, least_rad) in [(&mut self.stale, JUMP_RAD), (&mut self.small, SMALL_RAD)] {
                if most_rad >= least_rad {
                    if stale.jumps == 0 {
                        stale.first = self.frames - self.repeated;
                    }
                    stale.jumps += 1;
                    stale.frames += self.repeated;
                    stale.most_rad = stale.most_rad.max(most_rad);
                }
            }
            self.repeated = 0;
        }
        self.places = places;
        self.angles = angles;
        self.frames += 1;
    }

    /// What to say where pictures stood still.
    pub(super) fn doubt(&self) -> Option<String> {
        let stale = if self.small.jumps >= OFTEN { self.small } else { self.stale };
        (stale.jumps > 0).then(|| {
            format!(
                "{} frame(s), the first is frame {}, repeat the picture before while the finger moves on: the next new \
                 picture is up to {:.1} degrees further. Their angles are of an earlier time; use the video that the \
                 camera made, or its rate of pictures",
                stale.frames,
                stale.first,
                stale.most_rad.to_degrees()
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a marker pair whose angle in each picture is `deg`; frame k shows the picture `shown(k)`.
    fn said(deg: impl Fn(usize) -> f64, shown: impl Fn(usize) -> usize) -> Option<String> {
        let mut frozen = Frozen::default();
        for frame in 0..120 {
            let picture = shown(frame);
            let rad = deg(picture).to_radians();
            // Encoded again, a place moves a little.
            let moved = 0.004 * (frame % 3) as f64;
            let places = vec![Some([10.0, 20.0 + moved]), Some([10.0 + 50.0 * rad.cos(), 20.0 + 50.0 * rad.sin()])];
            frozen.add(places, vec![Some([rad, 6e-4])]);
        }
        frozen.doubt()
    }

    #[test]
    fn pictures_that_stand_still_while_the_finger_moves_are_seen() {
        let bends = |picture: usize| 40.0 - 40.0 * (0.1 * picture as f64).cos();
        assert_eq!(said(bends, |k| k), None);
        let halted = said(bends, |k| if (40..55).contains(&k) { 39 } else { k }).expect("it stood still");
        assert!(halted.contains("15 frame(s), the first is frame 40,") && halted.contains("degrees"), "{halted}");
        let of_ten = said(bends, |k| k / 3 * 3).expect("ten pictures a second");
        assert!(of_ten.contains("the first is frame ") && of_ten.contains("11.9 degrees"), "{of_ten}");
        // Slowly: each step by itself could be a finger that begins to move.
        let slow = |picture: usize| 0.2 * picture as f64;
        assert!(said(slow, |k| k / 3 * 3).expect("ten pictures a second").contains("0.6 degrees"));
        assert_eq!(said(slow, |k| if (40..43).contains(&k) { 39 } else { k }), None);
    }

    #[test]
    fn a_finger_that_rests_and_then_moves_is_not() {
        let rests = |picture: usize| if picture < 60 { 5.0 } else { 5.0 + 0.3 * ((picture - 60) as f64).powi(2) };
        assert_eq!(said(rests, |k| k), None);
        assert_eq!(said(|_| 5.0, |k| k), None);
        assert_eq!(Frozen::default().doubt(), None);
    }
}
