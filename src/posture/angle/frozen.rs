//! Pictures that show what the one before shows while the finger moves on: a camera that stood still for a moment, or
//! ten pictures a second in a file of thirty. Their angles are of an earlier time.
//!
//! In: from frame to frame the places of markers and the joints' angles. Out: what to say where markers stay where they
//! are, all of them at once and for a frame at least, and then jump. A finger that rests does the first and not the
//! second.
//!
//! Measured on three phantoms of 480x270, encoded again: half a second of repeated pictures (angles up to 12 degrees
//! off) and ten pictures a second (2.4 degrees) are seen in all, and nothing where all pictures are new. Encoded again
//! coarsely, a picture that comes twice moves its markers by 0.05 to 0.3 px where the next new one moves them by 3.5.

/// Places that are no further apart are the same, pixels.
const SAME_PX: f64 = 0.02;
/// .. or, where such frames come all through, than this of how far a new picture moved them.
const SAME_SHARE: f64 = 0.15;
/// All through: so many of the frames that turn a joint come after such (assumed: of 24 pictures a second as 30 a
/// quarter does, of a finger that taps three times a second 3 %). Such a turn has so many standard errors.
const ALL_THROUGH: f64 = 0.15;
const TURN_SDS: f64 = 3.0;
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
    /// How far the last new picture moved the markers, pixels.
    moved_px: f64,
    /// Frames that turned a joint.
    turns: u64,
    stale: Stale,
    small: Stale,
    nearly: Stale,
}

/// Of jumps after frames that repeat the one before: how many there were, and of which frames, which frame was the
/// first, by how much.
#[derive(Debug, Clone, Copy, Default)]
struct Stale {
    /// Such frames up to now.
    repeated: u64,
    jumps: u64,
    frames: u64,
    first: u64,
    most_rad: f64,
}

impl Frozen {
    /// Takes the next frame: each marker's place, each joint's angle and its standard error, radians.
    pub(super) fn add(&mut self, places: Vec<Option<[f64; 2]>>, angles: Vec<Option<[f64; 2]>>) {
        let moved_px = self.moved_px(&places);
        let turned = |(now, before): (&Option<[f64; 2]>, &Option<[f64; 2]>)| {
            let ([rad, sd_rad], [before_rad, before_sd_rad]) = ((*now)?, (*before)?);
            Some(((rad - before_rad).abs(), sd_rad.hypot(before_sd_rad)))
        };
        let turned: Vec<(f64, f64)> = angles.iter().zip(&self.angles).filter_map(turned).collect();
        let most_rad = |least_sds: f64| {
            let surely = turned.iter().filter(|(by_rad, sd_rad)| *by_rad > least_sds * sd_rad);
            surely.fold(0.0, |most, (by_rad, _)| f64::max(most, *by_rad))
        };
        let share_px = SAME_SHARE * self.moved_px;
        let (jump_rad, turn_rad) = (most_rad(JUMP_SDS), most_rad(TURN_SDS));
        for (stale, same_px, turned_rad, least_rad) in [
            (&mut self.stale, SAME_PX, jump_rad, JUMP_RAD),
            (&mut self.small, SAME_PX, jump_rad, SMALL_RAD),
            (&mut self.nearly, share_px.max(SAME_PX), turn_rad, SMALL_RAD),
        ] {
            stale.add(self.frames, moved_px.is_some_and(|px| px <= same_px), turned_rad, least_rad);
        }
        self.turns += u64::from(turn_rad >= SMALL_RAD);
        self.moved_px = moved_px.filter(|&px| px > share_px).unwrap_or(self.moved_px);
        self.places = places;
        self.angles = angles;
        self.frames += 1;
    }

    /// How far the marker that moved most is from where it was; none where they are too few or others than before.
    fn moved_px(&self, places: &[Option<[f64; 2]>]) -> Option<f64> {
        let both = places.iter().zip(&self.places);
        let are_same =
            places.len() == self.places.len() && both.clone().all(|(now, before)| now.is_some() == before.is_some());
        let by_px = |(now, before): (&Option<[f64; 2]>, &Option<[f64; 2]>)| {
            let (now, before) = ((*now)?, (*before)?);
            Some((now[0] - before[0]).hypot(now[1] - before[1]))
        };
        let moved: Vec<f64> = both.filter_map(by_px).collect();
        (are_same && moved.len() >= MARKERS).then(|| moved.into_iter().fold(0.0, f64::max))
    }

    /// What to say where pictures stood still.
    pub(super) fn doubt(&self) -> Option<String> {
        let comes_all_through = self.nearly.jumps as f64 >= ALL_THROUGH * self.turns as f64;
        let stale = match (self.nearly, self.small) {
            (nearly, _) if nearly.jumps >= OFTEN && comes_all_through => nearly,
            (_, small) if small.jumps >= OFTEN => small,
            _ => self.stale,
        };
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

impl Stale {
    /// Takes the next frame: whether it repeats the one before, and how far it turned a joint.
    fn add(&mut self, frame: u64, repeats: bool, turned_rad: f64, least_rad: f64) {
        if repeats {
            self.repeated += 1;
            return;
        }
        if self.repeated > 0 && turned_rad >= least_rad {
            if self.jumps == 0 {
                self.first = frame - self.repeated;
            }
            self.jumps += 1;
            self.frames += self.repeated;
            self.most_rad = self.most_rad.max(turned_rad);
        }
        self.repeated = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a marker pair whose angle in each picture is `deg`; frame k shows the picture `shown(k)`.
    fn said(deg: impl Fn(usize) -> f64, shown: impl Fn(usize) -> usize) -> Option<String> {
        said_of(deg, shown, 0.004)
    }

    /// Where encoding moves a place by up to twice `coded_px`.
    fn said_of(deg: impl Fn(usize) -> f64, shown: impl Fn(usize) -> usize, coded_px: f64) -> Option<String> {
        let mut frozen = Frozen::default();
        for frame in 0..120 {
            let picture = shown(frame);
            let rad = deg(picture).to_radians();
            // Encoded again, a place moves a little.
            let moved = coded_px * (frame % 3) as f64;
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
    fn pictures_that_come_twice_are_seen_through_coarse_encoding() {
        let bends = |picture: usize| 40.0 - 40.0 * (0.05 * picture as f64).cos();
        let of = |shown: fn(usize) -> usize| said_of(bends, shown, 0.05);
        assert!(of(|k| k / 2 * 2).expect("30 as 60").contains("the first is frame "));
        assert!(of(|k| k - k / 5).expect("24 as 30").contains("the first is frame "));
        assert_eq!(of(|k| k), None);
        // A finger that taps: pictures near its turns are alike, and those behind them are not.
        let taps = |picture: usize| 20.0 - 20.0 * (0.63 * picture as f64).cos();
        assert_eq!(said_of(taps, |k| k, 0.05), None);
    }

    #[test]
    fn a_finger_that_rests_and_then_moves_is_not() {
        let rests = |picture: usize| if picture < 60 { 5.0 } else { 5.0 + 0.3 * ((picture - 60) as f64).powi(2) };
        assert_eq!(said(rests, |k| k), None);
        assert_eq!(said(|_| 5.0, |k| k), None);
        assert_eq!(Frozen::default().doubt(), None);
    }
}
