//! `lunula posture` on fingers whose skin is that of real photographs ([`Film`]): how far angles are off, what is said.

use std::ops::Range;

use crate::util::hand_film::{FRAMES, Film, JOINTS};
use crate::util::{Dir, known};

/// What became of the angles of films.
#[derive(Debug, Default)]
struct Tally {
    films: usize,
    refused: usize,
    found: usize,
    bad: usize,
    /// Films of which a tenth of the angles is wrong, and nothing was said.
    silent: Vec<u64>,
    /// Off the truth, degrees, and that in standard errors.
    errors: Vec<[f64; 2]>,
}

impl Tally {
    fn add(&mut self, film: &Film) {
        let dir = Dir::new();
        film.write(&dir);
        let answer = dir.words("posture film.mp4 --markers markers.toml --out joints.csv --no-figures --json");
        self.films += 1;
        if answer.code == 2 {
            self.refused += 1;
            eprintln!("{:4} {}: refused: {}", film.seed, film.paint, answer.stderr.trim());
            return;
        }
        let warnings = answer.json()["warnings"].clone();
        let first = self.errors.len();
        for (frame, row) in dir.table("joints.csv").iter().enumerate() {
            for (joint, name) in JOINTS.iter().enumerate() {
                let Some(angle) = known(row, &format!("{name}_deg")) else { continue };
                let error = (angle - film.truth_deg(joint, frame)).abs();
                self.errors.push([error, error / known(row, &format!("{name}_sd_deg")).expect("a standard error")]);
            }
        }
        let new = &self.errors[first..];
        let bad = new.iter().filter(|error| error[0] > 1.0 && error[1] > 3.0).count();
        let worst = new.iter().fold(0.0, |worst: f64, error| worst.max(error[0]));
        self.found += new.len();
        self.bad += bad;
        if 10 * bad > new.len() && warnings.as_array().is_none_or(Vec::is_empty) {
            self.silent.push(film.seed);
        }
        eprintln!(
            "{:4} {}, {} of {}, {bad} bad, {worst:.1} at worst: {warnings}",
            film.seed,
            film.paint,
            new.len(),
            3 * FRAMES
        );
    }

    fn share_within(&self, errors: f64) -> f64 {
        self.errors.iter().filter(|error| error[1] <= errors).count() as f64 / self.errors.len().max(1) as f64
    }

    fn print(&mut self, what: &str) {
        self.errors.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let rms = (self.errors.iter().map(|error| error[0].powi(2)).sum::<f64>() / self.errors.len() as f64).sqrt();
        eprintln!(
            "{what}: {} films, {} refused, {} of {} angles, {} bad, {:.0} and {:.0} % within 1 and 2, median {:.2}, \
             RMS {rms:.2} degrees; silent {:?}",
            self.films,
            self.refused,
            self.found,
            3 * FRAMES * self.films,
            self.bad,
            100.0 * self.share_within(1.0),
            100.0 * self.share_within(2.0),
            self.errors[self.errors.len() / 2][0],
            self.silent
        );
    }
}

/// Films that chose limits of `posture`, and others.
const CHOSE: Range<u64> = 0..16;
const CHOSE_NOTHING: Range<u64> = 100..124;

fn tally(what: &str, seeds: Range<u64>, of_skin: bool) -> Tally {
    let mut tally = Tally::default();
    seeds.for_each(|seed| tally.add(&Film::new(seed, of_skin)));
    tally.print(what);
    tally
}

/// Paint of hues that skin has not gives angles.
fn other_paint(what: &str, seeds: Range<u64>) {
    let tally = tally(what, seeds, false);
    assert!(6 * tally.refused <= tally.films, "{} refused", tally.refused);
    assert!(10 * tally.found >= 8 * 3 * FRAMES * (tally.films - tally.refused), "{} found", tally.found);
    assert!(40 * tally.bad <= tally.found, "{} bad of {}", tally.bad, tally.found);
    assert!(tally.share_within(1.0) >= 0.6 && tally.share_within(2.0) >= 0.85);
    assert!(10 * tally.silent.len() <= tally.films, "{:?}", tally.silent);
}

#[test]
#[ignore = "80 films take minutes; needs real recordings: LUNULA_REAL_DATA"]
fn films_on_photographs_of_hands() {
    for (what, seeds) in [("films that chose", CHOSE), ("others", CHOSE_NOTHING)] {
        other_paint(&format!("paint, {what}"), seeds.clone());
        // Paint of the hue of skin is seldom wrong in silence.
        let tally = tally(&format!("paint of skin's hue, {what}"), seeds, true);
        assert!(10 * tally.bad <= tally.found, "{} bad of {}", tally.bad, tally.found);
        assert!(tally.share_within(1.0) >= 0.5 && tally.share_within(2.0) >= 0.75);
        assert!(10 * tally.silent.len() <= tally.films, "{:?}", tally.silent);
    }
}

mod real_data {
    use super::*;

    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn paint_that_skin_has_not_gives_angles() {
        other_paint("paint, a few films", CHOSE_NOTHING.start..CHOSE_NOTHING.start + 8);
    }
}
