//! What can't be fitted is reported, and why.

use lunula_hemodynamics::{
    Bounds, Calibration, Course, FitFault, FitOptions, Free, Load, Optics, Parameters, Recording, Symbol, Trace, fit,
};

use crate::phantom::{exact, step, symbol, tied, times, with_photodiodes, zero};

fn recording() -> Recording {
    let truth = with_photodiodes(Parameters::thesis(), [2.5; 2], [0.4; 2]);
    exact(&truth, &step(5000.0), &zero(), &[0])
}

fn refusal(recording: Recording) -> String {
    fit(&[recording], &Parameters::thesis(), &tied(), &FitOptions::default()).expect_err("a fault").to_string()
}

#[test]
fn recordings_that_cant_be_used_say_where() {
    assert_eq!(fit(&[], &Parameters::thesis(), &tied(), &FitOptions::default()), Err(FitFault::NoRecordings));
    let with = |change: &dyn Fn(&mut Recording)| {
        let mut recording = recording();
        change(&mut recording);
        refusal(recording)
    };
    let time = |row: usize, value: f64| {
        with(&|recording| {
            if let Course::Transient { times_s, .. } = &mut recording.course {
                times_s[row] = value;
            }
        })
    };
    assert!(time(7, f64::NAN).contains("recording 1 can't be used: the time of sample 8 is NaN"));
    assert!(time(7, 0.06).contains("sample 8 (0.06 s) comes after 0.06 s"));
    assert!(with(&|r| r.photodiodes[0].voltages_v[3] = f64::INFINITY).contains("the voltage of sample 4 is infinite"));
    assert!(with(&|r| r.photodiodes[0].voltages_v.fill(f64::NAN)).contains("all of its voltages are missing"));
    assert!(with(&|r| r.photodiodes[0].voltages_v.truncate(9)).contains("9 voltages for 400 samples"));
    assert!(with(&|r| r.photodiodes[0].unit = 2).contains("unit 3): the model has 2 units"));
    assert!(with(&|r| r.photodiodes[0].noise_v = 0.0).contains("its noise is 0 V"));
    assert!(with(&|r| r.photodiodes.clear()).contains("there is nothing in it"));
    let steady = |proximal: Vec<f64>, distal: Vec<f64>| refusal(Recording::steady(proximal, distal, vec![]));
    assert!(steady(vec![0.0], vec![]).contains("1 proximal pressures and 0 distal ones"));
    assert!(steady(vec![0.0, f64::NAN], vec![0.0; 2]).contains("the proximal pressure of sample 2 is NaN"));
    assert!(steady(vec![], vec![]).contains("there is nothing in it"));
}

#[test]
fn too_few_samples_are_no_fit() {
    let short = |samples: usize| {
        let mut recording = recording();
        recording.photodiodes[0].voltages_v[samples..].fill(f64::NAN);
        fit(&[recording], &Parameters::thesis(), &tied(), &FitOptions::default())
    };
    assert_eq!(short(4), Err(FitFault::TooFew { values: 4, unknowns: 4 }));
    assert!(short(5).is_ok());
}

#[test]
fn what_is_free_has_to_make_sense() {
    let fault = |free: &[Free], calibration: Calibration| {
        let options = FitOptions { calibration, ..FitOptions::default() };
        fit(&[recording()], &Parameters::thesis(), free, &options).unwrap_err()
    };
    let with = |free: Free| fault(&[free], Calibration::PerSubject);
    let k = symbol("k_C1_N_per_m");
    assert_eq!(fault(&[], Calibration::Fixed), FitFault::NothingFree);
    assert_eq!(with(Free::tied(&[])), FitFault::EmptyGroup);
    assert_eq!(fault(&[Free::one(k), Free::tied(&[k])], Calibration::Shared), FitFault::Twice { symbol: k });
    let third = symbol("k_C3_N_per_m");
    assert_eq!(with(Free::one(third)), FitFault::NoSuchParameter { symbol: third });
    assert_eq!(with(Free::tied(&[k, Symbol::Upstream])), FitFault::Tied { symbol: Symbol::Upstream });
    assert_eq!(with(Free::one(Symbol::Scaling(0))), FitFault::Calibrated { symbol: Symbol::Scaling(0) });
    for bounds in [
        Bounds::Factors(2.0, 0.5),
        Bounds::Factors(0.0, 2.0),
        Bounds::Factors(f64::NAN, 2.0),
        Bounds::Values(-1.0, 1e6),
        Bounds::Values(1e4, f64::INFINITY),
    ] {
        let fault = with(Free::one(k).within(bounds));
        assert!(matches!(fault, FitFault::Bounds { .. }), "{bounds:?}: {fault}");
    }
    assert!(matches!(with(Free::one(Symbol::Upstream).within(Bounds::Factors(0.5, 2.0))), FitFault::Bounds { .. }));
    assert!(matches!(with(Free::one(k).within(Bounds::Values(2e5, 1e6))), FitFault::Outside { .. }));
    let undamped = Parameters::thesis().set(symbol("b_V_N_s_per_m"), 0.0).unwrap();
    let free = [Free::one(symbol("b_V_N_s_per_m"))];
    let fault = fit(&[recording()], &undamped, &free, &FitOptions::default()).unwrap_err();
    assert_eq!(fault, FitFault::Zero { symbol: symbol("b_V_N_s_per_m") });
}

#[test]
fn options_have_to_make_sense() {
    let fault = |options: FitOptions| fit(&[recording()], &Parameters::thesis(), &tied(), &options).unwrap_err();
    for options in [
        FitOptions { rtol: 0.0, ..FitOptions::default() },
        FitOptions { tolerance: f64::NAN, ..FitOptions::default() },
        FitOptions { most_points: 0, ..FitOptions::default() },
        FitOptions { starts: 0, ..FitOptions::default() },
    ] {
        assert!(matches!(fault(options), FitFault::Option { .. }));
    }
    let optics = Optics::Linear(vec![1.0]);
    assert!(matches!(fault(FitOptions { optics, ..FitOptions::default() }), FitFault::Optics(_)));
}

#[test]
fn a_start_at_which_a_vessel_closes_is_reported() {
    for distal in [step(1.2e4), Load::constant(1.2e4).unwrap()] {
        let trace = Trace::new(0, times().iter().map(|t| t.sin()).collect());
        let message = refusal(Recording::transient(times(), zero(), distal, vec![trace]));
        assert!(message.contains("the fit can't start from these parameters: in recording 1"), "{message}");
        assert!(message.contains("C2"), "{message}");
    }
    let steady =
        Recording::steady(vec![0.0, 1.2e4, 5e3, 0.0, 1e3, 2e3], vec![0.0; 6], vec![Trace::new(0, vec![1.0; 6])]);
    assert!(refusal(steady).contains("V closes"));
}

#[test]
fn a_load_that_is_not_a_number_is_reported() {
    let load = Load::function(|t| if t > 1.0 { f64::NAN } else { 100.0 }, &[]).unwrap();
    let recording = Recording::transient(times(), load, zero(), vec![Trace::new(0, vec![1.0; 400])]);
    assert!(refusal(recording).contains("P_F1"));
}
