//! Trials of two methods of control, as appendix C has them: how long each operator took to drive the course, trial by
//! trial (Fig. 123, 124).
//!
//! In: the study's seed. Out: the table of `lunula performance`, `operator,method,trial,time_s`. A time is the
//! driving's and a time per decision, which falls exponentially from the first trial to a level; each operator has a
//! factor of their own, and each trial one. All sizes are assumed after appendix C's words: at first less than half the
//! time per decision with virtual switches, level in at most half the trials. Fig. 123 shows four operators, and Fig.
//! 124 is said to average five: here are five.

use std::fmt::Write;

use rand::RngExt;

use lunula::phantom::nail::numbers;

const KIND_TRIALS: u32 = 43;
const OPERATORS: [&str; 5] = ["A", "B", "C", "D", "E"];
const TRIALS: u32 = 10;
/// The course: 1.42 m at 0.025 m/s, 27 moves.
const DRIVING_S: f64 = 1.42 / 0.025;
const DECISIONS: f64 = 27.0;
/// Methods: the time per decision that is left in the end, what the first trial takes beyond that, seconds, and how
/// fast that is learned, trials.
const METHODS: [(&str, [f64; 3]); 2] = [("pendant", [2.2, 6.3, 2.6]), ("virtual", [1.7, 2.0, 1.1])];
/// How far operators and trials are off either way, shares.
const OPERATOR: f64 = 0.2;
const TRIAL: f64 = 0.06;

/// The table's text.
pub(crate) fn trials(seed: u64) -> String {
    let mut text = "operator,method,trial,time_s\n".to_owned();
    let mut rng = numbers(seed, KIND_TRIALS, 0);
    for operator in OPERATORS {
        for (method, [level_s, more_s, pace]) in METHODS {
            let own = 1.0 + rng.random_range(-OPERATOR..OPERATOR);
            for trial in 1..=TRIALS {
                let learned_s = level_s + more_s * (-f64::from(trial - 1) / pace).exp();
                let decision_s = own * learned_s * (1.0 + rng.random_range(-TRIAL..TRIAL));
                // Writing to a text does not fail.
                let _ = writeln!(text, "{operator},{method},{trial},{:.1}", DRIVING_S + DECISIONS * decision_s);
            }
        }
    }
    text
}
