//! Random models, loads and starts against a run of another order at the finest tolerance.

use lunula_hemodynamics::{
    Collapse, Load, Loads, Model, Order, Parameters, SolveOptions, Solver, State, Symbol, Trajectory, simulate,
};

use super::{distance, load};

/// Runs over their tolerance, of those whose conditioning amplifies an error no more than twofold: of 5040 such runs
/// measured none (with contact 2 of 2500), of the 520 here of either kind none.
const MOST_OVER: f64 = 0.01;
/// The worst of them over its tolerance; measured 0.46 here (0.75 with contact).
const WORST: f64 = 2.0;
/// An amplification that counts as none.
const MILD: f64 = 2.0;
const CASES: u64 = 60;

/// SplitMix64.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
    }

    fn power(&mut self, from: f64, to: f64) -> f64 {
        10f64.powf(self.between(from, to))
    }

    /// Every parameter within a factor 2 of the thesis'.
    fn parameters(&mut self, units: usize) -> Parameters {
        let base = Parameters::along_nail(units).expect("units");
        base.symbols().into_iter().fold(base.clone(), |parameters, symbol| match symbol {
            Symbol::Stiffness(_)
            | Symbol::Mass(_)
            | Symbol::Damping(_)
            | Symbol::Area(_)
            | Symbol::Diameter(_)
            | Symbol::Length(_)
            | Symbol::Count(_)
            | Symbol::Venule(_)
            | Symbol::Viscosity => {
                let value = base.get(symbol).expect("a symbol of its own") * self.power(-0.3, 0.3);
                parameters.set(symbol, value).expect("a value that can be used")
            }
            _ => parameters,
        })
    }

    fn load(&mut self, most_pa: f64) -> Load {
        let height = self.between(0.0, most_pa);
        let from = self.between(0.0, 1.5);
        match self.next() % 5 {
            0 => Load::step(height, from, self.between(from + 0.01, 4.0)),
            1 => Load::ramp(height, self.between(0.0, most_pa), from, self.between(from + 0.001, 4.0)),
            2 => Load::sine(0.6 * height, 0.4 * height, self.power(-1.0, 1.5)),
            3 => {
                let times: Vec<f64> =
                    (0..6).map(|k| self.between(0.6 * f64::from(k), 0.6 * f64::from(k + 1))).collect();
                let values: Vec<f64> = times.iter().map(|_| self.between(0.0, most_pa)).collect();
                Load::table(&times, &values)
            }
            _ => Load::step(height, from, from + self.power(-8.0, -2.0)),
        }
        .expect("a load")
    }
}

/// A run to be repeated, and what it has to give.
struct Case {
    model: Model,
    loads: Loads,
    start: State,
    exact: Trajectory,
}

impl Case {
    /// `None` where a vessel closes.
    fn new(model: Model, loads: Loads, start: State) -> Option<Case> {
        let mut times: Vec<f64> = (0..=200).map(|k| f64::from(k) * 0.02).collect();
        times.extend((0..45).map(|k| 10f64.powf(-11.0 + 0.25 * f64::from(k))));
        for at in [&loads.proximal, &loads.distal].into_iter().flat_map(Load::breakpoints) {
            times.extend((0..18).map(|k| at + 10f64.powf(-10.0 + 0.5 * f64::from(k))));
        }
        times.retain(|&time| time <= 4.0);
        times.sort_by(f64::total_cmp);
        let finest = SolveOptions { order: Order::Thirteenth, longest_step_s: Some(5e-3), ..SolveOptions::at(1e-13) };
        let exact = simulate(&model, &loads, &start, &times, &finest).ok()?;
        Some(Case { model, loads, start, exact })
    }

    /// By how much a change of a lumen at five moments grows at most.
    fn amplification(&self) -> f64 {
        let mut solver = Solver::new(&self.model);
        let (mut most, times) = (1.0f64, self.exact.times_s());
        let (mut base, mut moved) = (Trajectory::default(), Trajectory::default());
        for from in [0, times.len() / 8, times.len() / 4, times.len() / 2, 3 * times.len() / 4] {
            let mut state = self.exact.state(from);
            let options = SolveOptions { order: Order::Ninth, ..SolveOptions::at(1e-9) };
            solver.run(&self.loads, &state, &times[from..], &options, &mut base).expect("as the exact one");
            for j in 0..state.lumens.len() {
                let (kept, by) = (state.lumens[j], 1e-5 * state.lumens[j]);
                state.lumens[j] += by;
                solver.run(&self.loads, &state, &times[from..], &options, &mut moved).expect("as the exact one");
                state.lumens[j] = kept;
                most = most.max(distance(&base, &moved) / by);
            }
        }
        most
    }

    /// The error of a run over its tolerance.
    fn error(&self, rtol: f64) -> f64 {
        let got = simulate(&self.model, &self.loads, &self.start, self.exact.times_s(), &SolveOptions::at(rtol));
        distance(&got.expect("as the exact one"), &self.exact) / rtol
    }
}

fn check(collapse: Collapse, most_pa: f64, seed: u64) {
    let (mut runs, mut over, mut worst) = (0, 0, 0.0);
    for number in 0..CASES {
        let mut draw = Draw(seed + number);
        let units = 1 + (draw.next() % 5) as usize;
        let parameters = draw.parameters(units);
        let loads = Loads::on(&parameters, draw.load(most_pa), draw.load(most_pa));
        let mut start = State::undisplaced(&parameters);
        start.lumens.iter_mut().for_each(|lumen| *lumen = draw.power(-1.3, 0.5));
        let Some(case) = Case::new(Model::new(&parameters, collapse), loads, start) else { continue };
        if case.amplification() > MILD {
            continue;
        }
        for exponent in 3..=12 {
            let error = case.error(10f64.powi(-exponent));
            if error > 1.0 {
                println!("case {number}, 1e-{exponent}: {error}");
            }
            runs += 1;
            over += usize::from(error > 1.0);
            worst = if error <= worst { worst } else { error };
        }
    }
    println!("{over} of {runs} runs over their tolerance, the worst {worst}");
    assert!(runs >= 400, "{runs}");
    assert!(over as f64 <= MOST_OVER * f64::from(runs), "{over} of {runs}");
    assert!(worst <= WORST, "{worst}");
}

#[test]
fn tolerances_hold_on_random_models() {
    check(Collapse::Error, 6000.0, 3_000_009);
}

#[test]
fn tolerances_hold_on_random_models_whose_walls_touch() {
    check(Collapse::Contact, 2e4, 7_000_021);
}

#[test]
fn two_starts_far_from_rest_hold_at_ninety_one_tolerances() {
    // Both were over by up to 80 times where a step could grow twelvefold on the word of a single estimate. Measured
    // 0.14.
    let far =
        [(Parameters::thesis(), "0", vec![0.1; 3]), (Parameters::along_nail(1).unwrap(), "3000", vec![0.1, 0.25])];
    for (parameters, proximal, lumens) in far {
        let loads = Loads::on(&parameters, load(proximal), load("0"));
        let start = State { rates: vec![0.0; lumens.len()], lumens };
        let case = Case::new(Model::new(&parameters, Collapse::Error), loads, start).expect("open vessels");
        let mut worst = 0.0;
        for k in 0..=90 {
            let error = case.error(10f64.powf(-3.0 - 0.1 * f64::from(k)));
            assert!(error <= 1.0, "at 1e-{}: {error}", 3.0 + 0.1 * f64::from(k));
            worst = if error <= worst { worst } else { error };
        }
        println!("{worst}");
    }
}
