//! Places taken one after the other: Cholesky's factor of C_KK, with what they leave of all other candidates.
//!
//! A rung holds, for each person and candidate j, the row l_j of the factor, the variance d_j that the places taken do
//! not explain, and what is left of B. Adding j to them explains b_j^2 / d_j more of a column.

use super::problem::{Criterion, LayoutProblem};

/// A candidate with no more of its variance left than this is a combination of those taken, and adds nothing (assumed:
/// some thousand times the rounding of second moments).
const DEPENDENT: f64 = 1e-12;

/// What is left at one height.
#[derive(Debug, Clone, Default)]
pub(super) struct Rung {
    /// Persons x candidates: the factor's row; of the lowest rung nothing.
    pub(super) l: Vec<f64>,
    /// Persons x candidates.
    pub(super) d: Vec<f64>,
    /// Persons x columns x candidates.
    pub(super) b: Vec<f64>,
    /// Persons x columns: explained.
    pub(super) q: Vec<f64>,
    /// Persons: log of the determinant of C_KK, in the readings' units.
    log_determinant: Vec<f64>,
}

/// Rungs from none to the places taken.
pub(super) struct Ladder<'a> {
    pub(super) problem: &'a LayoutProblem,
    rungs: Vec<Rung>,
    height: usize,
    /// Multiply-adds so far, for budgets that do not depend on the machine.
    pub(super) work: u64,
}

impl<'a> Ladder<'a> {
    pub(super) fn new(problem: &'a LayoutProblem) -> Self {
        let n = problem.len();
        let d = (0..problem.persons * n).map(|k| problem.c[k * n + k % n]).collect();
        let ground = Rung {
            l: vec![0.0; problem.persons * n],
            d,
            b: problem.b.clone(),
            q: vec![0.0; problem.persons * problem.columns],
            log_determinant: vec![0.0; problem.persons],
        };
        Self { problem, rungs: vec![ground], height: 0, work: 0 }
    }

    pub(super) fn top(&self) -> &Rung {
        &self.rungs[self.height]
    }

    /// Takes a place.
    pub(super) fn push(&mut self, place: usize) {
        self.push_for(place, 0);
    }

    /// Takes a place; of candidates before `from` nothing is known from here on.
    pub(super) fn push_for(&mut self, place: usize, from: usize) {
        if self.rungs.len() == self.height + 1 {
            self.rungs.push(self.rungs[self.height].clone());
        }
        let (n, columns) = (self.problem.len(), self.problem.columns);
        let (below, above) = self.rungs.split_at_mut(self.height + 1);
        let (last, own) = (&below[self.height], &mut above[0]);
        for person in 0..self.problem.persons {
            let row = person * n;
            let range = row + from..row + n;
            let pivot = last.d[row + place];
            let l = &mut own.l[range.clone()];
            let root = if pivot > DEPENDENT { pivot.sqrt() } else { f64::INFINITY };
            if root.is_finite() {
                l.copy_from_slice(&self.problem.c[(row + place) * n + from..(row + place + 1) * n]);
                for rung in &below[1..] {
                    let weight = rung.l[row + place];
                    l.iter_mut().zip(&rung.l[range.clone()]).for_each(|(l, other)| *l -= weight * other);
                }
                l.iter_mut().for_each(|l| *l /= root);
            } else {
                l.fill(0.0);
            }
            for ((d, before), l) in own.d[range.clone()].iter_mut().zip(&last.d[range.clone()]).zip(&*l) {
                *d = before - l * l;
            }
            for column in person * columns..(person + 1) * columns {
                let more = last.b[column * n + place] / root;
                own.q[column] = last.q[column] + more * more;
                let range = column * n + from..(column + 1) * n;
                for ((b, before), l) in own.b[range.clone()].iter_mut().zip(&last.b[range]).zip(&*l) {
                    *b = before - l * more;
                }
            }
            own.log_determinant[person] =
                last.log_determinant[person] + log_of(pivot, self.problem.variance[row + place]);
        }
        self.height += 1;
        self.work += (self.problem.persons * (n - from) * (self.height + columns)) as u64;
    }

    /// Gives the place taken last back.
    pub(super) fn pop(&mut self) {
        self.height -= 1;
    }

    pub(super) fn cost(&self) -> f64 {
        mean_cost(self.problem.criterion, &self.top().q)
    }

    /// Minus the mean over persons of the log of the determinant: the less, the better (D-optimal).
    pub(super) fn minus_log_determinant(&self) -> f64 {
        -self.top().log_determinant.iter().sum::<f64>() / self.problem.persons as f64
    }

    /// What it would cost to take each candidate from `from` on as well, in `costs[from..]`.
    pub(super) fn costs_with(&mut self, from: usize, costs: &mut [f64]) {
        let (n, columns, criterion) = (self.problem.len(), self.problem.columns, self.problem.criterion);
        let top = self.top();
        let costs = &mut costs[from..n];
        costs.fill(0.0);
        for person in 0..self.problem.persons {
            let d = &top.d[person * n + from..(person + 1) * n];
            for column in person * columns..(person + 1) * columns {
                let (q, b) = (top.q[column], &top.b[column * n + from..(column + 1) * n]);
                let each = costs.iter_mut().zip(b).zip(d);
                match criterion {
                    Criterion::Error => each.for_each(|((cost, b), d)| {
                        let more = if *d > DEPENDENT { b * b / d } else { 0.0 };
                        *cost += Criterion::Error.of(q + more);
                    }),
                    Criterion::Confusion => each.for_each(|((cost, b), d)| {
                        let more = if *d > DEPENDENT { b * b / d } else { 0.0 };
                        *cost += Criterion::Confusion.of(q + more);
                    }),
                }
            }
        }
        let parts = top.q.len() as f64;
        costs.iter_mut().for_each(|cost| *cost /= parts);
        self.work += (self.problem.persons * columns * (n - from)) as u64;
    }

    /// Minus the log of the determinant with each candidate as well.
    pub(super) fn minus_log_determinants_with(&self, costs: &mut [f64]) {
        let (n, top) = (self.problem.len(), self.top());
        costs.fill(0.0);
        let persons = top.d.chunks(n).zip(self.problem.variance.chunks(n));
        for ((d, variance), before) in persons.zip(&top.log_determinant) {
            for ((cost, &d), &variance) in costs.iter_mut().zip(d).zip(variance) {
                *cost -= before + log_of(d, variance);
            }
        }
        costs.iter_mut().for_each(|cost| *cost /= self.problem.persons as f64);
    }

    /// Costs of the places taken together with all of `others[k..]`, for each k; `others` are candidates from `from`
    /// on, in their order.
    pub(super) fn costs_with_all_from(&mut self, others: &[usize]) -> Vec<f64> {
        let (problem, columns, n) = (self.problem, self.problem.columns, self.problem.len());
        let m = others.len();
        let mut q = self.top().q.clone();
        // Columns explained so far, for each k; what each person adds comes one person after the other.
        let mut all_q = vec![0.0; (m + 1) * q.len()];
        let taken = &self.rungs[1..=self.height];
        let mut own_rows = vec![0.0; m * m];
        for person in 0..problem.persons {
            let row = person * n;
            let of = person * columns..(person + 1) * columns;
            let gather = |from: &[f64], start: usize| others.iter().map(|&k| from[start + k]).collect::<Vec<f64>>();
            let mut d = gather(&self.top().d, row);
            let mut b: Vec<Vec<f64>> = of.clone().map(|column| gather(&self.top().b, column * n)).collect();
            let known: Vec<Vec<f64>> = taken.iter().map(|rung| gather(&rung.l, row)).collect();
            for i in (0..m).rev() {
                if d[i] > DEPENDENT {
                    let root = d[i].sqrt();
                    let c = &problem.c[(row + others[i]) * n..];
                    let (l, later) = own_rows[i * m..].split_at_mut(m);
                    let l = &mut l[..i];
                    l.iter_mut().zip(others).for_each(|(l, &k)| *l = c[k]);
                    for other in known.iter().map(Vec::as_slice).chain(later.chunks(m)) {
                        let weight = other[i];
                        if weight != 0.0 {
                            l.iter_mut().zip(other).for_each(|(l, other)| *l -= weight * other);
                        }
                    }
                    l.iter_mut().for_each(|l| *l /= root);
                    d.iter_mut().zip(&*l).for_each(|(d, l)| *d -= l * l);
                    for (b, q) in b.iter_mut().zip(&mut q[of.clone()]) {
                        let more = b[i] / root;
                        *q += more * more;
                        b.iter_mut().zip(&*l).for_each(|(b, l)| *b -= l * more);
                    }
                } else {
                    own_rows[i * m..(i + 1) * m].fill(0.0);
                }
                let at = i * q.len();
                all_q[at..][of.clone()].copy_from_slice(&q[of.clone()]);
            }
        }
        self.work += (problem.persons * m * m * (m / 6 + columns)) as u64 + 1;
        all_q.chunks(q.len()).take(m).map(|q| mean_cost(problem.criterion, q)).collect()
    }
}

/// The log of what is left of a variance; the determinant is zero where that is nothing.
fn log_of(share: f64, variance: f64) -> f64 {
    if share > DEPENDENT { share.ln() + variance.ln() } else { f64::NEG_INFINITY }
}

fn mean_cost(criterion: Criterion, q: &[f64]) -> f64 {
    q.iter().map(|&q| criterion.of(q)).sum::<f64>() / q.len() as f64
}

impl LayoutProblem {
    /// The cost of places, by the caller's numbers; of none where there are none.
    #[must_use]
    pub fn cost(&self, places: &[usize]) -> f64 {
        self.ladder(places).cost()
    }

    /// What each column's places explain, q, by person.
    #[must_use]
    pub fn explained(&self, places: &[usize]) -> Vec<Vec<f64>> {
        self.ladder(places).top().q.chunks(self.columns).map(<[f64]>::to_vec).collect()
    }

    fn ladder(&self, places: &[usize]) -> Ladder<'_> {
        let mut own: Vec<usize> = places.iter().map(|&place| self.own(place)).collect();
        own.sort_unstable();
        let mut ladder = Ladder::new(self);
        own.into_iter().for_each(|place| ladder.push(place));
        ladder
    }
}
