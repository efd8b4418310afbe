//! Fixed steps converge with the order of the method; runs do not care when they start.

use lunula_hemodynamics::{Collapse, Load, Loads, Model, Order, Parameters, SolveOptions, State, Trajectory, simulate};

use super::{distance, loads, rest};

fn run(loads: &Loads, start: &State, times: &[f64], options: &SolveOptions) -> Trajectory {
    simulate(&Model::new(&Parameters::thesis(), Collapse::Error), loads, start, times, options).expect("a run")
}

#[test]
fn fixed_steps_converge_with_the_order_at_their_ends() {
    // A pressure that grows smoothly and slowly, from rest: no layers worth a step.
    let smooth = Load::function(|t| 3000.0 * (1.0 - (4.0 * t).cos()), &[]).unwrap();
    let loads = Loads::on(&Parameters::thesis(), smooth, "0".parse().unwrap());
    let exact = run(&loads, &rest(), &[0.0, 1.0], &SolveOptions::at(1e-13));
    for (order, steps, least) in
        [(Order::Fifth, [8.0, 16.0], 4.5), (Order::Ninth, [4.0, 8.0], 8.0), (Order::Thirteenth, [4.0, 6.0], 11.0)]
    {
        let errors = steps.map(|n: f64| {
            let fixed = SolveOptions { fixed_step_s: Some(1.0 / n), order, ..SolveOptions::at(1e-13) };
            let got = run(&loads, &rest(), &[0.0, 1.0], &fixed);
            assert_eq!(got.statistics().steps, n as u64);
            (got.lumens(1)[2] - exact.lumens(1)[2]).abs()
        });
        let rate = (errors[0] / errors[1]).ln() / (steps[1] / steps[0]).ln();
        println!("{order:?} {errors:?} {rate}");
        assert!(rate >= least, "{order:?}: {errors:?} fall with the power {rate}");
    }
}

#[test]
fn a_run_does_not_care_for_other_times_asked_for_nor_when_it_starts() {
    let times: Vec<f64> = (0..=40).map(|k| f64::from(k) * 0.1).collect();
    let here = run(&loads("step:5000@0..2", "0"), &rest(), &times, &SolveOptions::at(1e-9));
    let fewer = run(&loads("step:5000@0..2", "0"), &rest(), &[0.0, 1.0, 4.0], &SolveOptions::at(1e-9));
    assert_eq!([here.lumens(10), here.lumens(40)], [fewer.lumens(1), fewer.lumens(2)]);
    // 1024 s later: times are known to 1e-13 s there.
    let later: Vec<f64> = times.iter().map(|t| t + 1024.0).collect();
    let there = run(&loads("step:5000@1024..1026", "0"), &rest(), &later, &SolveOptions::at(1e-9));
    assert!(distance(&here, &there) <= 1e-9);
    // A start before the first time asked for.
    let options = SolveOptions { start_s: Some(0.0), ..SolveOptions::at(1e-9) };
    let late = run(&loads("step:5000@0..2", "0"), &rest(), &[1.0, 4.0], &options);
    assert_eq!([late.lumens(0), late.lumens(1)], [fewer.lumens(1), fewer.lumens(2)]);
}

#[test]
fn at_a_jump_the_state_is_continuous_and_repeated_times_are_answered_twice() {
    let times = [0.0, 0.0, 2.0, 2.0, 2.0f64.next_up(), 4.0];
    let got = run(&loads("step:5000@0..2", "0"), &rest(), &times, &SolveOptions::at(1e-9));
    assert_eq!(got.len(), 6);
    assert_eq!([got.lumens(0), got.rates(0)], [&rest().lumens[..], &rest().rates[..]]);
    assert_eq!([got.lumens(2), got.rates(2)], [got.lumens(3), got.rates(3)]);
    for j in 0..3 {
        assert!((got.lumens(4)[j] - got.lumens(3)[j]).abs() <= 1e-14);
    }
}

/// What a clock's own rounding (1e-7 s at 1.7e9 s) makes of the times at which a load steps: none here, as all are
/// whole or halves.
#[test]
fn a_clock_that_counts_from_1970_or_from_the_beginning_of_all_serves_as_well() {
    let offsets: Vec<f64> = (0..=16).map(|k| f64::from(k) * 0.25).collect();
    for rtol in [1e-3, 1e-6, 1e-9, 1e-12] {
        let here = run(&loads("step:8000@1..3", "ramp:0..2000@0.5..2"), &rest(), &offsets, &SolveOptions::at(rtol));
        for begin in [1e6, 1.7e9, 1e12] {
            let proximal = Load::step(8000.0, begin + 1.0, begin + 3.0).unwrap();
            let distal = Load::ramp(0.0, 2000.0, begin + 0.5, begin + 2.0).unwrap();
            let late = Loads::on(&Parameters::thesis(), proximal, distal);
            let times: Vec<f64> = offsets.iter().map(|t| begin + t).collect();
            let there = run(&late, &rest(), &times, &SolveOptions::at(rtol));
            assert_eq!(there.times_s(), times);
            for k in 0..times.len() {
                assert_eq!(here.lumens(k), there.lumens(k), "{begin} s, {rtol:e}");
            }
        }
    }
}
