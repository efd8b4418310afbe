//! One sample a step, against a tight run on the same straight pieces.

use lunula_hemodynamics::{
    Collapse, Inputs, Live, LiveFault, Load, Loads, Model, Parameters, Site, SolveOptions, State, Trajectory, simulate,
};

use super::rest;

/// At 1 kHz, over D; measured 8.4e-10.
const TOLERANCE: f64 = 1e-8;
const SAMPLE_S: f64 = 1e-3;

/// A second of samples, and the exact states at them.
fn compare(signal: impl Fn(f64) -> Inputs, collapse: Collapse) -> (f64, Live) {
    let parameters = Parameters::thesis();
    let model = Model::new(&parameters, collapse);
    let times: Vec<f64> = (0..=1000).map(|k| f64::from(k) * SAMPLE_S).collect();
    let inputs: Vec<Inputs> = times.iter().map(|&time| signal(time)).collect();
    let table = |value: fn(&Inputs) -> f64| -> Load {
        Load::table(&times, &inputs.iter().map(value).collect::<Vec<f64>>()).expect("a recording")
    };
    let loads = Loads {
        upstream: table(|u| u.upstream_pa),
        downstream: table(|u| u.downstream_pa),
        proximal: table(|u| u.proximal_pa),
        distal: table(|u| u.distal_pa),
    };
    let exact: Trajectory = simulate(&model, &loads, &rest(), &times, &SolveOptions::at(1e-12)).expect("a tight run");
    let mut live = Live::new(&model, &rest(), &inputs[0], SAMPLE_S).expect("a start");
    let mut worst = 0.0f64;
    for (k, input) in inputs.iter().enumerate().skip(1) {
        let state = live.sample(input).expect("a sample");
        for (lumen, exact) in state.lumens.iter().zip(exact.lumens(k)) {
            worst = worst.max((lumen - exact).abs());
        }
    }
    println!("{worst:e} {:?}", live.statistics());
    (worst, live)
}

fn blood() -> Inputs {
    Inputs { upstream_pa: 1e4, downstream_pa: 0.0, proximal_pa: 0.0, distal_pa: 0.0 }
}

/// A force that rises within 50 ms and falls again, over blood that beats once a second.
fn touch(time_s: f64) -> Inputs {
    let smooth = |x: f64| 0.5 - 0.5 * (std::f64::consts::PI * x.clamp(0.0, 1.0)).cos();
    let force = 5000.0 * (smooth((time_s - 0.1) / 0.05) - smooth((time_s - 0.6) / 0.05));
    let beat = 1000.0 * (std::f64::consts::TAU * time_s).sin();
    Inputs { upstream_pa: 1e4 + beat, proximal_pa: force, distal_pa: 0.5 * force, ..blood() }
}

#[test]
fn a_touch_is_followed_in_one_step_a_sample() {
    let (worst, live) = compare(touch, Collapse::Error);
    assert!(worst <= TOLERANCE, "{worst:e}");
    let statistics = live.statistics();
    assert_eq!((statistics.samples, statistics.failed), (1000, 0));
    assert!(statistics.steps <= 1050, "{statistics:?}");
}

#[test]
fn a_jump_within_a_sample_is_cut_into_steps() {
    for height in [1000.0, 5000.0, 1e4] {
        let jump = |time_s: f64| {
            let on = if (0.3..0.7).contains(&time_s) { height } else { 0.0 };
            Inputs { proximal_pa: on, distal_pa: on, ..blood() }
        };
        let (worst, live) = compare(jump, Collapse::Error);
        assert!(worst <= TOLERANCE, "{height} Pa: {worst:e}");
        assert!(live.statistics().steps <= 1200);
    }
}

#[test]
fn contact_is_held_when_a_hammer_comes_down() {
    let hammer = |time_s: f64| {
        let on = if (0.3..0.4).contains(&time_s) { 1e6 } else { 0.0 };
        Inputs { proximal_pa: on, distal_pa: on, ..blood() }
    };
    let (worst, _) = compare(hammer, Collapse::Contact);
    assert!(worst <= 10.0 * TOLERANCE, "{worst:e}");
}

#[test]
fn a_sample_that_fails_leaves_the_last_state_and_the_next_may_follow() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    let mut live = Live::new(&model, &rest(), &blood(), SAMPLE_S).unwrap();
    live.sample(&blood()).unwrap();
    let before = live.state().clone();
    let fault = live.sample(&Inputs { proximal_pa: f64::NAN, ..blood() }).unwrap_err();
    assert!(matches!(fault, LiveFault::Input { load: "P_F1", .. }));
    let fault = live.sample(&Inputs { proximal_pa: 1e8, ..blood() }).unwrap_err();
    let LiveFault::Collapsed { site, after_s } = fault else { panic!("{fault}") };
    assert!(site == Site::Vein && after_s > 0.0 && after_s < SAMPLE_S);
    assert_eq!(live.state(), &before);
    // The way back from the failed sample's load begins with that load, and closes the vessel too; the sample after it
    // does not.
    let light = Inputs { proximal_pa: 1000.0, ..blood() };
    assert!(matches!(live.sample(&light), Err(LiveFault::Collapsed { site: Site::Vein, .. })));
    assert_eq!(live.state(), &before);
    let after = live.sample(&light).unwrap().clone();
    assert!(after.lumens[2] < before.lumens[2] && after.lumens[2] > 0.9 * before.lumens[2]);
    assert_eq!((live.statistics().samples, live.statistics().failed), (2, 2));
    for _ in 0..1000 {
        live.sample(&blood()).unwrap();
    }
    assert_eq!((live.statistics().samples, live.statistics().failed), (1002, 2));
}

#[test]
fn beginnings_without_meaning_are_refused() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    for sample_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Live::new(&model, &rest(), &blood(), sample_s), Err(LiveFault::Sample(_))));
    }
    let closed = State { lumens: vec![1.0, 1.0, 0.0], rates: vec![0.0; 3] };
    assert!(matches!(Live::new(&model, &closed, &blood(), 1e-3), Err(LiveFault::Start(_))));
    let fewer = State { lumens: vec![1.0, 1.0], rates: vec![0.0; 2] };
    assert!(matches!(Live::new(&model, &fewer, &blood(), 1e-3), Err(LiveFault::Start(_))));
}
