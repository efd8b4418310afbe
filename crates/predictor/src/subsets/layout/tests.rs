//! Layouts against brute force and against what has to hold of any.

use ndarray::{Array2, array};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::algebra::small::pivot;

/// What rounding may make of sums of some dozen terms of size 1 (assumed: thousands of units in the last place).
const SAME: f64 = 1e-12;
const STARTS: Starts = Starts { count: 20, seed: 1 };
const ALL: u64 = u64::MAX;

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// Readings of a smooth field over the nail: a few bumps that move with the targets, and noise.
struct Made {
    candidates: Vec<Candidate>,
    rows: Vec<[Array2<f64>; 2]>,
}

impl Made {
    /// Candidates of a seed.
    fn of(seed: u64, n: usize, persons: usize, targets: usize) -> Self {
        Self::new(&mut ChaCha8Rng::seed_from_u64(seed), n, persons, targets)
    }

    /// Candidates on a grid of 1.25 mm, five across.
    fn new(rng: &mut ChaCha8Rng, n: usize, persons: usize, targets: usize) -> Self {
        let at = |k: usize| [1.25 * ((k % 5) as f64 - 2.0), 1.25 * (k / 5) as f64];
        let place = |k: usize| Candidate { name: format!("C{k}"), across_mm: at(k)[0], along_mm: at(k)[1] };
        let rows = (0..persons).map(|_| {
            let y = Array2::from_shape_fn((60, targets), |_| normal(rng));
            let bumps: Vec<[f64; 4]> = (0..targets + 2)
                .map(|_| [3.0 * normal(rng), 3.0 + 3.0 * normal(rng), normal(rng), rng.random_range(1.0..3.0)])
                .collect();
            let idle = Array2::from_shape_fn((60, 2), |_| normal(rng));
            let x = Array2::from_shape_fn((60, n), |(row, k)| {
                let [across, along] = at(k);
                let of = |(which, [u, v, gain, width]): (usize, &[f64; 4])| {
                    let shape = (-((across - u).powi(2) + (along - v).powi(2)) / (2.0 * width * width)).exp();
                    let drive = if which < targets { y[[row, which]] } else { idle[[row, which - targets]] };
                    gain * shape * drive
                };
                bumps.iter().enumerate().map(of).sum::<f64>() + 0.1 * normal(rng)
            });
            [x, y]
        });
        let rows = rows.collect();
        Self { candidates: (0..n).map(place).collect(), rows }
    }

    fn moments(&self) -> Vec<Moments> {
        self.rows.iter().map(|[x, y]| Moments::of_rows(x.view(), y.view()).unwrap()).collect()
    }

    fn problem(&self, noise_sd: f64) -> LayoutProblem {
        LayoutProblem::new(Criterion::Error, &self.candidates, &self.moments(), noise_sd).unwrap()
    }
}

/// The cost by Cholesky's factor of the chosen rows and columns alone, of everything that the module does apart.
fn plain_cost(criterion: Criterion, persons: &[Moments], noise_sd: f64, places: &[usize]) -> f64 {
    let k = places.len();
    let mut sum = 0.0;
    for Moments { c, b } in persons {
        let noise = |i: usize, j: usize| if i == j { noise_sd * noise_sd } else { 0.0 };
        let of = nalgebra::DMatrix::from_fn(k, k, |i, j| c[[places[i], places[j]]] + noise(i, j));
        let factor = of.cholesky().expect("independent readings");
        for column in b.columns() {
            let right = nalgebra::DVector::from_fn(k, |i, _| column[places[i]]);
            let q = right.dot(&factor.solve(&right));
            sum += match criterion {
                Criterion::Error => (1.0 - q).max(0.0).sqrt(),
                Criterion::Confusion => 0.5 * (-q / 8.0).exp(),
            };
        }
    }
    sum / (persons.len() * persons[0].b.ncols()) as f64
}

/// The least cost of `k` of `n` that `may` be chosen together, each looked at.
fn brute(n: usize, k: usize, may: &dyn Fn(&[usize]) -> bool, cost: &dyn Fn(&[usize]) -> f64) -> Option<f64> {
    let mut places: Vec<usize> = (0..k).collect();
    let mut least: Option<f64> = None;
    loop {
        if may(&places) {
            let own = cost(&places);
            least = Some(least.map_or(own, |least| least.min(own)));
        }
        let Some(at) = (0..k).rev().find(|&at| places[at] < n - k + at) else { return least };
        places[at] += 1;
        for later in at + 1..k {
            places[later] = places[later - 1] + 1;
        }
    }
}

/// Searches and proves; the cost is that of the places.
fn solved(problem: &LayoutProblem, rules: &Rules, k: usize) -> Option<(Choice, Proof)> {
    let [greedy, best] = search(problem, rules, k, STARTS)?;
    assert!(best.cost <= greedy.cost + SAME && best.places.len() == k);
    let proof = prove(problem, rules, &best, ALL);
    assert!(proof.optimal && proof.bound == proof.best.cost);
    assert!((problem.cost(&proof.best.places) - proof.best.cost).abs() <= SAME);
    Some((best, proof))
}

/// `cases` random problems of at most `most` candidates, each against brute force.
fn against_brute_force(cases: u64, sizes: [usize; 2], most_subsets: f64) {
    let (mut found, mut ran) = (0, 0);
    for seed in 0.. {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let n = rng.random_range(sizes[0]..=sizes[1]);
        let k = rng.random_range(1..=8.min(n));
        let subsets: f64 = (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product();
        if subsets > most_subsets {
            continue;
        }
        let (persons, targets) = (rng.random_range(1..=2), rng.random_range(1..=3));
        let made = Made::new(&mut rng, n, persons, targets);
        let noise_sd = if seed % 2 == 0 { 0.0 } else { 0.3 };
        let problem = made.problem(noise_sd);
        let moments = made.moments();
        let cost = |places: &[usize]| plain_cost(Criterion::Error, &moments, noise_sd, places);
        let least = brute(n, k, &|_| true, &cost).unwrap();
        let (best, proof) = solved(&problem, &Rules::default(), k).unwrap();
        assert!((proof.best.cost - least).abs() <= SAME, "seed {seed}: {} for {least}", proof.best.cost);
        assert!((cost(&proof.best.places) - least).abs() <= SAME, "seed {seed}");
        found += usize::from(best.cost - least <= SAME);
        ran += 1;
        if ran == cases {
            break;
        }
    }
    assert_eq!(ran, cases);
    println!("exchange alone found {found} of {ran}");
}

#[test]
fn small_problems_are_solved_as_by_brute_force() {
    against_brute_force(60, [4, 25], 30_000.0);
}

#[test]
fn sixty_nine_places_are_solved_as_by_brute_force() {
    for (seed, most) in [(1, 4), (2, 3), (3, 3)] {
        let made = Made::of(seed, 69, 1, 3);
        let moments = made.moments();
        for k in 1..=most {
            let cost = |places: &[usize]| plain_cost(Criterion::Error, &moments, 0.1, places);
            let least = brute(69, k, &|_| true, &cost).unwrap();
            let (_, proof) = solved(&made.problem(0.1), &Rules::default(), k).unwrap();
            assert!((proof.best.cost - least).abs() <= SAME, "{k}: {} {least}", proof.best.cost);
        }
    }
}

/// `cargo test --release -p lunula-predictor -- --ignored --nocapture speed_of_sixty`
#[test]
#[ignore = "measures time"]
fn speed_of_sixty_nine_places() {
    let problem = Made::of(1, 69, 7, 3).problem(0.1);
    let rules = Rules { apart_mm: 1.5, ..Rules::default() };
    let all: Vec<usize> = (0..69).collect();
    println!("all: {}", problem.cost(&all));
    for (k, rules) in [(4, &Rules::default()), (8, &Rules::default()), (4, &rules), (8, &rules)] {
        let start = std::time::Instant::now();
        let [greedy, best] = search(&problem, rules, k, STARTS).unwrap();
        println!("{k}, 20 starts: {:?}; {} {}", start.elapsed(), greedy.cost, best.cost);
        for budget in [1e9, 1e10] {
            let start = std::time::Instant::now();
            let proof = prove(&problem, rules, &best, budget as u64);
            println!(
                "  {budget}: {:?} {} {} {} {}",
                start.elapsed(),
                proof.best.cost,
                proof.bound,
                proof.optimal,
                proof.nodes
            );
        }
    }
}

/// `cargo test --release -p lunula-predictor -- --ignored --nocapture two_hundred`
#[test]
#[ignore = "minutes: all sizes up to 25 places, 8 chosen"]
fn two_hundred_problems_are_solved_as_by_brute_force() {
    against_brute_force(200, [4, 25], f64::INFINITY);
}

#[test]
fn the_bound_never_lies_above_the_optimum() {
    let mut stopped = 0;
    for seed in 0..20 {
        let problem = Made::of(100 + seed, 16, 2, 2).problem(0.1);
        let (_, proof) = solved(&problem, &Rules::default(), 5).unwrap();
        let known = Choice { places: vec![0, 1, 2, 3, 4], cost: problem.cost(&[0, 1, 2, 3, 4]) };
        let mut last = 0.0;
        for budget in [0, 3_000, 30_000, 100_000, 300_000, ALL] {
            let part = prove(&problem, &Rules::default(), &known, budget);
            assert!(part.bound <= proof.best.cost + SAME && part.bound >= last, "{budget}: {part:?}");
            assert!(part.bound <= part.best.cost && part.best.cost <= known.cost);
            assert_eq!(part.optimal, (part.bound - part.best.cost).abs() <= SAME, "{budget}: {part:?}");
            stopped += usize::from(!part.optimal);
            last = part.bound;
        }
        assert!((last - proof.best.cost).abs() <= SAME);
    }
    assert!(stopped >= 20, "{stopped}");
}

#[test]
fn candidates_in_any_order_give_the_same_layout() {
    for seed in 0..10 {
        let made = Made::of(200 + seed, 20, 2, 2);
        let turned: Vec<usize> = (0..20).map(|k| (7 * k + 3) % 20).collect();
        let candidates: Vec<Candidate> = turned.iter().map(|&k| made.candidates[k].clone()).collect();
        let moments: Vec<Moments> = made
            .moments()
            .iter()
            .map(|own| Moments {
                c: own.c.select(ndarray::Axis(0), &turned).select(ndarray::Axis(1), &turned),
                b: own.b.select(ndarray::Axis(0), &turned),
            })
            .collect();
        let other = LayoutProblem::new(Criterion::Error, &candidates, &moments, 0.05).unwrap();
        let (one, proof) = solved(&made.problem(0.05), &Rules::default(), 4).unwrap();
        let (two, proof_turned) = solved(&other, &Rules::default(), 4).unwrap();
        let back = |choice: &Choice| choice.places.iter().map(|&k| turned[k]).collect::<Vec<_>>();
        assert_eq!((back(&two), two.cost), (one.places.clone(), one.cost));
        assert_eq!((back(&proof_turned.best), proof_turned.nodes), (proof.best.places, proof.nodes));
        let rules = Rules::default();
        let [first, second] = [&made.problem(0.05), &other].map(|problem| pivoted(problem, &rules, 4).unwrap());
        assert_eq!(back(&second), first.places);
    }
}

#[test]
fn a_mirrored_nail_has_the_mirrored_layout() {
    for seed in 0..10 {
        let made = Made::of(300 + seed, 20, 2, 2);
        let mirrored: Vec<Candidate> =
            made.candidates.iter().map(|one| Candidate { across_mm: -one.across_mm, ..one.clone() }).collect();
        let other = LayoutProblem::new(Criterion::Error, &mirrored, &made.moments(), 0.0).unwrap();
        let sorted = |problem: &LayoutProblem| {
            let mut places = solved(problem, &Rules::default(), 5).unwrap().1.best.places;
            places.sort_unstable();
            places
        };
        assert_eq!(sorted(&made.problem(0.0)), sorted(&other));
    }
}

#[test]
fn rules_are_kept_and_the_best_under_them_is_found() {
    for seed in 0..12 {
        let made = Made::of(400 + seed, 15, 1, 2);
        let moments = made.moments();
        let cost = |places: &[usize]| plain_cost(Criterion::Error, &moments, 0.1, places);
        // Five in a row: 4 - k % 5 is the mirror image of column k % 5.
        let image = |k: usize| k / 5 * 5 + 4 - k % 5;
        let apart = |places: &[usize], mm: f64| {
            let far = |i: usize, j: usize| {
                let (a, b) = (&made.candidates[i], &made.candidates[j]);
                (a.across_mm - b.across_mm).hypot(a.along_mm - b.along_mm) >= mm - 1e-9
            };
            places.iter().all(|&i| places.iter().all(|&j| i == j || far(i, j)))
        };
        let rules = [
            Rules { apart_mm: 1.5, ..Rules::default() },
            Rules { keep: vec![7, 1], apart_mm: 1.3, ..Rules::default() },
            Rules { mirror: true, apart_mm: 1.5, ..Rules::default() },
            Rules { mirror: true, keep: vec![5], ..Rules::default() },
        ];
        for (which, rules) in rules.into_iter().enumerate() {
            for k in 2..=5 {
                let may = |places: &[usize]| {
                    apart(places, rules.apart_mm)
                        && rules.keep.iter().all(|kept| places.contains(kept))
                        && (!rules.mirror || places.iter().all(|&place| places.contains(&image(place))))
                };
                let least = brute(15, k, &may, &cost);
                let found = solved(&made.problem(0.1), &rules, k);
                assert_eq!(found.is_some(), least.is_some(), "rules {which}, {k} places");
                let (Some(least), Some((_, proof))) = (least, found) else { continue };
                assert!((proof.best.cost - least).abs() <= SAME, "rules {which}, {k}: {} {least}", proof.best.cost);
                assert!(may(&proof.best.places), "rules {which}: {:?}", proof.best.places);
                let pivots = pivoted(&made.problem(0.1), &rules, k);
                assert!(pivots.is_none_or(|pivots| apart(&pivots.places, rules.apart_mm)));
            }
        }
    }
    let made = Made::of(0, 15, 1, 1);
    assert!(search(&made.problem(0.0), &Rules { apart_mm: 100.0, ..Rules::default() }, 2, STARTS).is_none());
    assert!(search(&made.problem(0.0), &Rules { keep: vec![1, 2], ..Rules::default() }, 1, STARTS).is_none());
}

#[test]
fn duplicated_candidates_change_no_cost() {
    let made = Made::of(7, 10, 2, 2);
    let twice: Vec<usize> = (0..20).map(|k| k % 10).collect();
    let candidates: Vec<Candidate> = twice
        .iter()
        .enumerate()
        .map(|(k, &of)| Candidate { name: format!("D{k}"), ..made.candidates[of].clone() })
        .collect();
    let rows: Vec<Moments> = made
        .rows
        .iter()
        .map(|[x, y]| Moments::of_rows(x.select(ndarray::Axis(1), &twice).view(), y.view()).unwrap())
        .collect();
    let doubled = LayoutProblem::new(Criterion::Error, &candidates, &rows, 0.0).unwrap();
    for k in 1..=5 {
        let (_, one) = solved(&made.problem(0.0), &Rules::default(), k).unwrap();
        let (_, two) = solved(&doubled, &Rules::default(), k).unwrap();
        assert!((one.best.cost - two.best.cost).abs() <= SAME, "{k}");
    }
    // Both of a pair are worth one of them, and all twenty the ten.
    assert!((doubled.cost(&[3, 13]) - doubled.cost(&[3])).abs() <= SAME);
    let all: Vec<usize> = (0..20).collect();
    assert!((doubled.cost(&all) - made.problem(0.0).cost(&all[..10])).abs() <= 1e-10);
}

#[test]
fn noise_without_end_leaves_the_mean_and_all_places_the_whole_model() {
    let made = Made::of(8, 9, 3, 2);
    for noise_sd in [1e12, f64::INFINITY] {
        let [greedy, best] = search(&made.problem(noise_sd), &Rules::default(), 4, STARTS).unwrap();
        assert!((greedy.cost - 1.0).abs() <= 1e-15 && (best.cost - 1.0).abs() <= 1e-15);
    }
    assert_eq!(made.problem(0.0).cost(&[]), 1.0);
    // The whole model by the crate's own least squares on the rows.
    let full: f64 = made
        .rows
        .iter()
        .flat_map(|[x, y]| {
            let fit = crate::least_squares(x.view(), y.view(), &crate::LeastSquaresOptions::default()).unwrap();
            let [centre, of_targets] = [&fit.centre, &fit.target_centre].map(|one| ndarray::Array1::from(one.clone()));
            let left = y - &of_targets - (x - &centre).dot(&fit.coefficients.t());
            let share = |k: usize| {
                let mean = y.column(k).mean().unwrap();
                let spread: f64 = y.column(k).iter().map(|value| (value - mean).powi(2)).sum();
                (left.column(k).iter().map(|value| value * value).sum::<f64>() / spread).sqrt()
            };
            [share(0), share(1)]
        })
        .sum();
    let [_, all] = search(&made.problem(0.0), &Rules::default(), 9, STARTS).unwrap();
    assert!((all.cost - full / 6.0).abs() <= 1e-10, "{} {}", all.cost, full / 6.0);
}

#[test]
fn classes_are_separated_as_by_brute_force() {
    for seed in 0..10 {
        let mut rng = ChaCha8Rng::seed_from_u64(500 + seed);
        let Made { candidates, rows } = Made::new(&mut rng, 14, 1, 2);
        let within = Moments::of_rows(rows[0][0].view(), rows[0][1].view()).unwrap().c;
        let between = Array2::from_shape_fn((14, 6), |_| 0.5 * normal(&mut rng));
        let moments = [Moments { c: within, b: between }];
        let problem = LayoutProblem::new(Criterion::Confusion, &candidates, &moments, 0.2).unwrap();
        let cost = |places: &[usize]| plain_cost(Criterion::Confusion, &moments, 0.2, places);
        for k in 1..=4 {
            let least = brute(14, k, &|_| true, &cost).unwrap();
            let (_, proof) = solved(&problem, &Rules::default(), k).unwrap();
            assert!((proof.best.cost - least).abs() <= SAME, "{} {least}", proof.best.cost);
        }
        assert_eq!(problem.cost(&[]), 0.5);
    }
}

#[test]
fn what_others_choose_is_the_best_by_their_own_measure() {
    let made = Made::of(9, 12, 1, 2);
    let (problem, rules) = (made.problem(0.0), Rules::default());
    let c = &made.moments()[0].c;
    let determinant_of = |places: &[usize]| {
        nalgebra::DMatrix::from_fn(places.len(), places.len(), |i, j| c[[places[i], places[j]]]).determinant()
    };
    for k in 1..=4 {
        let most = -brute(12, k, &|_| true, &|places| -determinant_of(places)).unwrap();
        let found = determinant(&problem, &rules, k, STARTS).unwrap();
        assert!((determinant_of(&found.places) - most).abs() <= SAME * most, "{k}");
    }
    // QR with column pivoting of the centred rows themselves.
    let x = &made.rows[0][0];
    let means = x.mean_axis(ndarray::Axis(0)).unwrap();
    let mut centred: Vec<Vec<f64>> = (x - &means).columns().into_iter().map(|column| column.to_vec()).collect();
    let (order, rank) = pivot(&mut centred, &[1e-9; 12]);
    assert_eq!(rank, 12);
    for k in 1..=6 {
        let mut pivots = order[..k].to_vec();
        let mut places = pivoted(&problem, &rules, k).unwrap().places;
        pivots.sort_unstable();
        places.sort_unstable();
        assert_eq!(places, pivots);
    }
}

#[test]
fn a_person_left_out_is_out() {
    let made = Made::of(10, 8, 3, 2);
    let (all, moments) = (made.problem(0.1), made.moments());
    let without = all.without(1).unwrap();
    let [first, last] = [0, 2].map(|one| plain_cost(Criterion::Error, &moments[one..=one], 0.1, &[1, 4]));
    assert!((without.cost(&[1, 4]) - 0.5 * (first + last)).abs() <= SAME);
    assert!(without.without(0).unwrap().without(0).is_none());
}

#[test]
fn what_is_no_problem_is_refused() {
    let place = |name: &str| Candidate { name: name.to_owned(), across_mm: 0.0, along_mm: 0.0 };
    let moments = Moments { c: array![[1.0, 0.0], [0.0, 1.0]], b: array![[0.1], [0.2]] };
    let new = |candidates: &[Candidate], persons: &[Moments], noise_sd: f64| {
        LayoutProblem::new(Criterion::Error, candidates, persons, noise_sd).map(|problem| problem.len())
    };
    let (two, one) = ([place("a"), place("b")], std::slice::from_ref(&moments));
    assert_eq!(new(&two, one, 0.0), Ok(2));
    assert_eq!(new(&two, &[], 0.0), Err(LayoutFault::Empty("persons")));
    assert_eq!(new(&two[..1], one, 0.0), Err(LayoutFault::Shape { person: 0 }));
    assert_eq!(new(&[place("a"), place("a")], one, 0.0), Err(LayoutFault::Twins("a".to_owned())));
    assert_eq!(LayoutProblem::fits(1024, 64), Ok(()));
    assert_eq!(LayoutProblem::fits(1024, 65), Err(LayoutFault::TooMany { candidates: 1024, persons: 65 }));
    assert!(LayoutProblem::fits(1025, 1).is_err());
    assert!(matches!(new(&two, one, f64::NAN), Err(LayoutFault::NotFinite { .. })));
    let broken = Moments { c: array![[1.0, f64::NAN], [0.0, 1.0]], ..moments.clone() };
    assert!(matches!(new(&two, &[broken], 0.0), Err(LayoutFault::NotFinite { .. })));
    let (x, flat) = (array![[1.0], [2.0]], array![[3.0], [3.0]]);
    assert_eq!(Moments::of_rows(x.view(), flat.view()), Err(LayoutFault::ConstantTarget { column: 0 }));
}
