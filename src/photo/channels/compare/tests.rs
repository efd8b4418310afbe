//! Pictures whose contrasts are known, cell by cell.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::*;
use crate::photo::channels::cells::GRID;
use crate::photo::channels::zones::bed;

fn photo(subject: usize) -> Photo {
    let subject = format!("s{subject:02}");
    let file = format!("{subject}.png");
    Photo { pose: "normal".into(), path: file.clone().into(), file, subject, outline: None, tone: None }
}

/// Lighter on the right by `contrast` of full scale, with noise of its own in every cell.
fn picture(contrast: [f64; 3], noise_sd: [f64; 3], rng: &mut ChaCha8Rng) -> Cells {
    let levels = [0, 1, 2].map(|c| {
        let noise = Normal::new(0.0, noise_sd[c]).expect("a deviation");
        let right = |at: usize| if at % GRID >= GRID / 2 { 0.5 } else { -0.5 };
        let value = |at: usize, rng: &mut ChaCha8Rng| 0.5 + contrast[c] * right(at) + noise.sample(rng);
        (0..GRID * GRID).map(|at| (value(at, rng).clamp(0.0, 1.0) * f64::from(FULL_SCALE)) as u16).collect()
    });
    Cells { levels, seen: vec![true; GRID * GRID] }
}

/// Contrasts by channel of `count` subjects.
fn contrasts(pictures: Vec<Cells>) -> Compared {
    let photos: Vec<Photo> = (0..pictures.len()).map(photo).collect();
    let samples: Vec<Sample<'_>> = photos.iter().zip(pictures).map(|(photo, cells)| Sample { photo, cells }).collect();
    compare(&samples)
}

/// What green shows where zones are the lightest and darkest quarter of the subject's own green.
fn naive(cells: &Cells) -> f64 {
    let mut values: Vec<u16> = bed().map(|at| cells.levels[1][at]).collect();
    values.sort_unstable();
    let quarter = values.len() / 4;
    let mean = |of: &[u16]| of.iter().map(|&v| f64::from(v)).sum::<f64>() / of.len() as f64 / f64::from(FULL_SCALE);
    mean(&values[values.len() - quarter..]) - mean(&values[..quarter])
}

#[test]
fn noise_alone_is_no_contrast_though_it_is_where_green_chooses_for_itself() {
    let rng = &mut ChaCha8Rng::seed_from_u64(7);
    let pictures: Vec<Cells> = (0..10).map(|_| picture([0.0; 3], [0.002, 0.04, 0.002], rng)).collect();
    let chosen = pictures.iter().map(naive).sum::<f64>() / 10.0;
    // The mean of a normal distribution's upper quarter is 1.27 SD.
    assert!((chosen - 2.0 * 1.27 * 0.04).abs() <= 0.003, "{chosen}");
    for row in contrasts(pictures).figures.rows {
        let contrast = row.contrast.expect("measured");
        // Ten means of 240 cells each way: a standard error of 0.0012 in green.
        assert!(contrast.mean.abs() <= 0.005, "{row:?}");
    }
}

/// Repetitions of the study below.
const STUDIES: usize = 400;

#[test]
fn no_channel_is_favoured_where_all_have_the_same_contrast_and_intervals_hold_what_they_say() {
    let rng = &mut ChaCha8Rng::seed_from_u64(11);
    let (mut lead, mut held, mut held_difference) = (0.0, 0, 0);
    for _ in 0..STUDIES {
        // Green is ten times as noisy; subjects differ in how much blood moves.
        let of_subjects = Normal::new(0.06, 0.02).expect("a deviation");
        let pictures = (0..6)
            .map(|_| {
                let contrast = of_subjects.sample(rng);
                picture([contrast; 3], [0.003, 0.03, 0.003], rng)
            })
            .collect();
        let figures = contrasts(pictures).figures;
        let holds = |of: Option<Estimate>, truth: f64| {
            of.is_some_and(|e| e.low.is_some_and(|low| low <= truth) && e.high.is_some_and(|high| truth <= high))
        };
        held += usize::from(holds(figures.rows[1].contrast, 0.06));
        let green_less_red = figures.differences[0].difference;
        held_difference += usize::from(holds(green_less_red, 0.0));
        lead += green_less_red.expect("measured").mean / STUDIES as f64;
    }
    // A study's difference has a standard error of 0.0011.
    assert!(lead.abs() <= 2e-4, "{lead}");
    // 95 % of 400, within 3 standard deviations of a binomial: 93.2 to 98.3 % and 91.7 to 98.3 %.
    for (name, held) in [("contrast", held), ("difference", held_difference)] {
        let share = held as f64 / STUDIES as f64;
        assert!((0.917..=0.983).contains(&share), "{name}: {share}");
    }
}

#[test]
fn one_subject_has_a_contrast_and_no_interval() {
    let rng = &mut ChaCha8Rng::seed_from_u64(3);
    let compared = contrasts(vec![picture([0.01, 0.10, 0.03], [0.0; 3], rng)]);
    assert!(compared.notes[0].contains("one subject"), "{:?}", compared.notes);
    for (row, truth) in compared.figures.rows.iter().zip([0.01, 0.10, 0.03]) {
        let contrast = row.contrast.expect("a contrast");
        assert_eq!((row.subjects, row.zones, contrast.low, contrast.high), (1, ZonesOf::Own, None, None));
        assert!((contrast.mean - truth).abs() <= 2e-5, "{row:?}");
    }
}

#[test]
fn what_is_not_seen_is_missing_and_leaves_the_others_alone() {
    let rng = &mut ChaCha8Rng::seed_from_u64(5);
    let mut pictures: Vec<Cells> = (0..4).map(|_| picture([0.02, 0.08, 0.04], [0.0; 3], rng)).collect();
    // The third photograph does not show the right half of its nail, the fourth nothing of its lower quarter.
    for at in 0..GRID * GRID {
        let hidden = [(2, at % GRID >= GRID / 2), (3, at / GRID >= 3 * GRID / 4)];
        for (subject, _) in hidden.into_iter().filter(|(_, hidden)| *hidden) {
            pictures[subject].seen[at] = false;
            pictures[subject].levels.iter_mut().for_each(|levels| levels[at] = 0);
        }
    }
    let compared = contrasts(pictures);
    assert!(compared.notes[0].contains("`s02` left out"), "{:?}", compared.notes);
    for (row, truth) in compared.figures.rows.iter().zip([0.02, 0.08, 0.04]) {
        assert_eq!(row.subjects, 3);
        assert!((row.contrast.expect("a contrast").mean - truth).abs() <= 2e-5, "{row:?}");
    }
}

#[test]
fn a_channel_at_full_scale_is_warned_of() {
    let rng = &mut ChaCha8Rng::seed_from_u64(9);
    let mut pictures: Vec<Cells> = (0..3).map(|_| picture([0.1; 3], [0.001; 3], rng)).collect();
    pictures.iter_mut().for_each(|cells| cells.levels[0].fill(FULL_SCALE));
    let compared = contrasts(pictures);
    assert_eq!(compared.figures.rows[0].contrast.expect("measured").mean, 0.0);
    assert!(matches!(&compared.warnings[..], [one] if one.contains("100 % of the zones in red")));
}
