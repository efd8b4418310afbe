//! Every method's places for every number of photodiodes, with what they are worth to persons left out.
//!
//! The best, greedy, pivoted and D-optimal layouts are chosen again without each person and judged on that one, who
//! still has a model of their own (`held_out`); the thesis' eight and all candidates are judged as they are. Of maps a
//! subject's pictures are put to one of every two poses by the rule of the others, and the error is the share put to
//! the wrong one: judged by those who chose, two poses that do not differ are far apart already at few places of many
//! (of 8 + 8 subjects 0.0003 for 4 of 140 cells, in place of 0.5). The interval is that of the mean over persons
//! (Student's t).

use lunula_live::spread::{CONFIDENCE, Spread, normal_below, t_quantile};
use lunula_predictor::{Choice, LayoutProblem, Proof, Rules, Starts, determinant, pivoted, prove, search};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

use super::options::LayoutOptions;
use super::read::{Given, Parts, WithoutSubject, pairs};
use crate::nail::Positions;

/// Random starts where a person is left out, and of the D-optimal layout (assumed; with 20, exchange found the optimum
/// of 200 of 200 random problems of up to 25 places: measured, the predictor's ignored test).
const FEWER_STARTS: u32 = 5;

/// Who chose the places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Exchange from all starts, or branch and bound where that found better.
    Best,
    /// Forward greedy.
    Greedy,
    /// QR with column pivoting, which does not know the targets.
    Qr,
    /// The largest determinant, which does not know them either.
    DOptimal,
    /// The candidates nearest to the thesis' eight.
    Thesis,
    /// All candidates together.
    All,
}

impl Method {
    /// What tables call it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Best => "best",
            Self::Greedy => "greedy",
            Self::Qr => "qr",
            Self::DOptimal => "d-optimal",
            Self::Thesis => "thesis",
            Self::All => "all",
        }
    }
}

/// What layouts are worth to those who had no part in choosing them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LeftOut {
    /// The mean over persons; of maps over subjects, the share of their pictures put to the wrong one of two poses.
    pub error: f64,
    /// Its standard error.
    pub se: f64,
    /// The 95 % interval of the mean, from 0 up: no error is less.
    pub interval: [f64; 2],
}

/// A method's places for one number of photodiodes.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    pub(super) k: usize,
    pub(super) method: Method,
    /// By the candidates' numbers.
    pub(super) choice: Choice,
    /// Of two persons or more.
    pub(super) left_out: Option<LeftOut>,
    /// Of the best.
    pub(super) proof: Option<Proof>,
}

/// A problem under its rules, to be solved with everybody and without each part.
pub(super) struct Solver<'a> {
    given: &'a Given,
    options: &'a LayoutOptions,
    pub(super) rules: Rules,
    all: &'a LayoutProblem,
}

impl<'a> Solver<'a> {
    pub(super) fn new(given: &'a Given, options: &'a LayoutOptions, keep: Vec<usize>, all: &'a LayoutProblem) -> Self {
        let rules = Rules { apart_mm: options.apart, keep, mirror: options.mirror };
        Self { given, options, rules, all }
    }

    /// All methods for `k` photodiodes; nothing where no `k` places keep the rules.
    pub(super) fn of(&self, k: usize) -> Vec<Solved> {
        let starts = Starts { count: self.options.starts as usize, seed: self.options.seed };
        let few = Starts { count: self.options.starts.min(FEWER_STARTS) as usize, ..starts };
        let rules = &self.rules;
        let Some([greedy, found]) = search(self.all, rules, k, starts) else { return Vec::new() };
        let proof = prove(self.all, rules, &found, (1e9 * self.options.proof) as u64);
        let parts: Vec<[Option<f64>; 4]> =
            (0..self.given.parts()).into_par_iter().map(|part| self.without(part, k, few)).collect();
        let methods = [
            (Method::Best, Some(proof.best.clone())),
            (Method::Greedy, Some(greedy)),
            (Method::Qr, pivoted(self.all, rules, k)),
            (Method::DOptimal, determinant(self.all, rules, k, few)),
        ];
        let solved = methods.into_iter().enumerate().filter_map(|(at, (method, choice))| {
            let left_out = self.left_out(parts.iter().map(|part| part[at]));
            let proof = (method == Method::Best).then(|| proof.clone());
            Some(Solved { k, method, choice: choice?, left_out, proof })
        });
        solved.collect()
    }

    /// What each method's `k` places, chosen without a part, are worth to it.
    fn without(&self, part: usize, k: usize, starts: Starts) -> [Option<f64>; 4] {
        let Some(problem) = self.given.without(part, self.all, self.options) else { return [None; 4] };
        let rules = &self.rules;
        let [greedy, best] = search(&problem, rules, k, starts).map_or([None, None], |both| both.map(Some));
        [best, greedy, pivoted(&problem, rules, k), determinant(&problem, rules, k, starts)]
            .map(|choice| self.worth(part, &choice?.places))
    }

    /// What places are worth to a person, or a subject of maps, who is left out.
    fn worth(&self, part: usize, places: &[usize]) -> Option<f64> {
        match &self.given.parts {
            Parts::Persons(each) => each[part].error(places, self.options.noise),
            Parts::Subjects(each) => each[part].confused(places, self.options.noise),
        }
    }

    /// Places that nobody's rows chose.
    pub(super) fn fixed(&self, method: Method, places: Vec<usize>) -> Solved {
        let worths: Vec<Option<f64>> =
            (0..self.given.parts()).into_par_iter().map(|part| self.worth(part, &places)).collect();
        let left_out = self.left_out(worths.into_iter());
        let choice = Choice { cost: self.all.cost(&places), places };
        Solved { k: choice.places.len(), method, choice, left_out, proof: None }
    }

    /// Mean and interval over the parts; none where one has no value.
    fn left_out(&self, worths: impl Iterator<Item = Option<f64>>) -> Option<LeftOut> {
        let spread = Spread::of(worths.collect::<Option<Vec<f64>>>()?)?;
        let se = spread.sd? / (spread.n as f64).sqrt();
        let half = t_quantile(spread.n.checked_sub(1)?)? * se;
        // A share of which so many subjects show nothing with a probability of 5 %.
        let unseen = match &self.given.parts {
            Parts::Subjects(_) if spread.mean == 0.0 => 1.0 - (1.0 - CONFIDENCE).powf(1.0 / spread.n as f64),
            _ => 0.0,
        };
        // Of persons an error is in units of the target's own spread, and has no upper limit.
        let most = match &self.given.parts {
            Parts::Subjects(_) => 1.0,
            Parts::Persons(_) => f64::INFINITY,
        };
        let interval = [(spread.mean - half).max(0.0), (spread.mean + half).max(unseen).min(most)];
        Some(LeftOut { error: spread.mean, se, interval })
    }
}

impl WithoutSubject {
    /// The share of the subject's pictures that the others' linear rule puts to the wrong one of two poses, mean over
    /// pairs, with what a photodiode's noise adds; none where the others' readings there determine no rule.
    fn confused(&self, places: &[usize], noise_sd: f64) -> Option<f64> {
        let k = places.len();
        let c = DMatrix::from_fn(k, k, |i, j| {
            self.moments.c[[places[i], places[j]]] + if i == j { noise_sd * noise_sd } else { 0.0 }
        });
        let rule = c.cholesky()?;
        let mut shares = Vec::new();
        for (column, [a, b]) in pairs(self.means.len()).enumerate() {
            let weights = rule.solve(&DVector::from_fn(k, |i, _| self.moments.b[[places[i], column]]));
            let on =
                |at: &dyn Fn(usize) -> f64| places.iter().zip(&weights).map(|(&place, w)| w * at(place)).sum::<f64>();
            let between = on(&|place| 0.5 * (self.means[a][place] + self.means[b][place]));
            let noise = noise_sd * weights.norm();
            let wrong = |(pose, reading): &(usize, ndarray::Array1<f64>)| {
                let past = on(&|place| reading[place]) - between;
                let wrong_by = if *pose == a { -past } else { past };
                // Without noise, all or nothing.
                if wrong_by == 0.0 { 0.5 } else { normal_below(wrong_by / noise) }
            };
            let pictures = self.own.iter().filter(|(pose, _)| [a, b].contains(pose));
            shares.extend(Spread::of(pictures.map(wrong)).map(|share| share.mean));
        }
        Spread::of(shares).map(|share| share.mean)
    }
}

/// The candidates nearest to the thesis' eight, each once, and how far the farthest is from its place, half widths.
pub(super) fn thesis(given: &Given) -> Option<(Vec<usize>, f64)> {
    let mut places: Vec<usize> = Vec::new();
    let mut farthest = 0.0_f64;
    for one in Positions::thesis().photodiodes {
        let far = |k: &usize| (given.places[*k].u - one.u).hypot(given.places[*k].v - one.v);
        let free = (0..given.places.len()).filter(|k| !places.contains(k));
        let nearest = free.min_by(|a, b| far(a).total_cmp(&far(b)))?;
        farthest = farthest.max(far(&nearest));
        places.push(nearest);
    }
    Some((places, farthest))
}

/// The smallest number of photodiodes whose left-out error is within a standard error of that of all candidates; where
/// none is, of that of the best number. With what it was held against.
pub(super) fn smallest_sufficient(solved: &[Solved]) -> Option<(usize, &'static str)> {
    let of = |method: Method| solved.iter().filter(move |one| one.method == method);
    let errors: Vec<(usize, LeftOut)> = of(Method::Best).filter_map(|one| Some((one.k, one.left_out?))).collect();
    let within = |limit: LeftOut| {
        let sufficient = errors.iter().filter(|(_, own)| own.error <= limit.error + limit.se);
        sufficient.map(|(k, _)| *k).min()
    };
    let of_all = of(Method::All).find_map(|one| one.left_out).and_then(within);
    let best = errors.iter().map(|(_, own)| *own).min_by(|a, b| a.error.total_cmp(&b.error));
    let of_best = || Some((best.and_then(within)?, "the best number of them"));
    of_all.map(|k| (k, "all candidates together")).or_else(of_best)
}
