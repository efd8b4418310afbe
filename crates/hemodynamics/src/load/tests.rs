use std::f64::consts::PI;

use super::*;
use crate::parameters::Parameters;

fn load(text: &str) -> Load {
    text.parse().expect(text)
}

#[test]
fn texts_are_loads() {
    assert_eq!(load("250").at(3.0), 250.0);
    let step = load("step:5000@0..2");
    assert_eq!([-1.0, 0.0, 1.9, 2.0].map(|t| step.at(t)), [0.0, 5000.0, 5000.0, 0.0]);
    assert_eq!([0.0, 2.0].map(|t| step.before(t)), [0.0, 5000.0]);
    let ramp = load("ramp:0..1e+4@0..5");
    assert_eq!([-1.0, 0.0, 2.5, 5.0, 9.0].map(|t| ramp.at(t)), [0.0, 0.0, 5000.0, 1e4, 1e4]);
    let sine = load("sine:5e+3+1000@0.05");
    assert_eq!(sine.at(0.0), 5000.0);
    assert!((sine.at(5.0) - 6000.0).abs() <= 1e-9);
}

#[test]
fn loads_are_written_as_they_are_read() {
    for text in ["250", "step:5000@0..2", "ramp:-3..10000@0.5..5", "sine:5000+1000@0.05"] {
        assert_eq!(load(text).to_string(), text);
    }
    assert_eq!(Load::table(&[0.0, 2.5], &[1.0, 2.0]).unwrap().to_string(), "2 rows from 0 to 2.5 s");
}

#[test]
fn texts_that_are_no_loads_say_how_they_look() {
    for text in ["", "step", "step:5@0", "step:5@0..x", "ramp:0@0..1", "sine:5@1", "saw:1@2", "1..2"] {
        let message = text.parse::<Load>().unwrap_err().to_string();
        assert!(message.contains("step:5000@0..2"), "{text}: {message}");
    }
    assert!(matches!("nan".parse::<Load>(), Err(LoadFault::NotFinite { .. })));
    assert!(matches!("step:inf@0..2".parse::<Load>(), Err(LoadFault::NotFinite { .. })));
    assert!(matches!("step:1@2..2".parse::<Load>(), Err(LoadFault::Order { .. })));
    assert!(matches!("step:1@2..0".parse::<Load>(), Err(LoadFault::Order { .. })));
}

#[test]
fn tables_with_faults_name_the_row() {
    let message = |times: &[f64], values: &[f64]| Load::table(times, values).unwrap_err().to_string();
    assert!(message(&[0.0, 1.0, 1.0], &[1.0; 3]).contains("row 3"));
    assert!(message(&[0.0, 2.0, 1.0], &[1.0; 3]).contains("row 3"));
    assert!(message(&[0.0, 1.0], &[1.0, f64::NAN]).contains("the value in row 2"));
    assert!(message(&[f64::INFINITY], &[1.0]).contains("the time in row 1"));
    assert!(message(&[], &[]).contains("0 times"));
    assert!(message(&[0.0], &[]).contains("0 values"));
}

#[test]
fn a_table_is_held_outside_and_straight_inside() {
    let table = Load::table(&[0.0, 1.0, 3.0], &[10.0, 20.0, 0.0]).unwrap();
    assert_eq!([-5.0, 0.0, 0.5, 1.0, 2.0, 3.0, 8.0].map(|t| table.at(t)), [10.0, 10.0, 15.0, 20.0, 10.0, 0.0, 0.0]);
}

#[test]
fn segments_lie_end_on_end_and_end_with_what_ends() {
    let loads = Loads::on(&Parameters::thesis(), load("step:5000@0..2"), load("ramp:0..100@1..2"));
    let segments: Vec<Segment> = loads.segments(-1.0, 4.0).collect();
    let ends: Vec<[f64; 2]> = segments.iter().map(|s| [s.from_s, s.to_s]).collect();
    assert_eq!(ends, [[-1.0, 0.0], [0.0, 1.0], [1.0, 2.0], [2.0, 4.0]]);
    assert_eq!(
        segments[2].at(2.0),
        Inputs { upstream_pa: 1e4, downstream_pa: 0.0, proximal_pa: 5000.0, distal_pa: 100.0 }
    );
    assert_eq!(segments[3].at(2.0).proximal_pa, 0.0);
    assert_eq!(segments.iter().map(Segment::is_constant).collect::<Vec<_>>(), [true, true, false, true]);
    assert_eq!(loads.segments(1.0, 1.0).count(), 0);
}

#[test]
fn a_function_is_evaluated_before_its_breakpoint_for_what_ends_there() {
    let jump = Load::function(|t| if t < 1.0 { 3.0 } else { 7.0 }, &[1.0]).unwrap();
    let loads = Loads::on(&Parameters::thesis(), jump, Load::constant(0.0).unwrap());
    let ends: Vec<f64> = loads.segments(0.0, 2.0).map(|s| s.at(s.to_s).proximal_pa).collect();
    assert_eq!(ends, [3.0, 7.0]);
}

fn on(proximal: Load, distal: Load) -> Loads {
    Loads::on(&Parameters::thesis(), proximal, distal)
}

#[test]
fn a_line_is_exact_at_both_of_its_ends() {
    // Values whose differences round.
    let (times, values) = ([0.1, 0.3, 0.7, 1.1], [1.0 / 3.0, 1e5 / 7.0, 1e-3, 1e-3]);
    let loads = on(Load::table(&times, &values).unwrap(), load("ramp:0.1..77777.7@0.1..0.9"));
    let segments: Vec<Segment> = loads.segments(0.0, 2.0).collect();
    for pair in segments.windows(2) {
        assert_eq!(pair[0].at(pair[0].to_s), pair[1].at(pair[1].from_s), "at {} s", pair[1].from_s);
    }
    // What is level is a constant: the last row's piece, beside the ramp held by then.
    assert!(segments[4].is_constant() && segments[4].from_s == 0.9);
}

#[test]
fn a_table_of_one_row_is_that_value() {
    let table = Load::table(&[2.0], &[700.0]).unwrap();
    assert_eq!([-1.0, 2.0, 3.0].map(|t| (table.at(t), table.before(t))), [(700.0, 700.0); 3]);
    let segments: Vec<Segment> = on(table, load("0")).segments(0.0, 4.0).collect();
    assert_eq!(segments.len(), 2);
    assert!(segments.iter().all(Segment::is_constant));
}

#[test]
fn sines_stand_still_or_turn_round_or_are_fast() {
    let sine = |frequency| Load::sine(5e3, 1e3, frequency).unwrap();
    assert_eq!(sine(0.0).at(0.7), 5e3);
    assert!(on(sine(0.0), Load::sine(1.0, 0.0, 3.0).unwrap()).segments(0.0, 1.0).all(|s| s.is_constant()));
    assert_eq!(sine(-0.25).at(1.0), 4e3);
    // 1 kHz after 1000 s, a quarter period on; measured 0; the rounding of 2 pi 1e6 would be 1e-10 of 1000 Pa.
    assert!((sine(1000.0).at(1000.00025) - 6e3).abs() <= 1e-3);
    assert!(matches!(Load::sine(0.0, 1.0, 1e308), Err(LoadFault::NotFinite { .. })));
}

#[test]
fn steps_may_suck() {
    let step = Load::step(-500.0, 0.0, 1.0).unwrap();
    assert_eq!([step.at(0.5), step.at(1.0)], [-500.0, 0.0]);
}

#[test]
fn huge_values_stay_finite_or_are_refused() {
    let table = Load::table(&[0.0, 1e-300, 1.0], &[-1e300, 1e300, 0.0]).unwrap();
    for t in [-1.0, 0.0, 5e-301, 1e-300, 0.5, 1.0] {
        assert!(table.at(t).is_finite(), "{t}");
    }
    assert_eq!(table.at(5e-301), 0.0);
    let message = |times: &[f64], values: &[f64]| Load::table(times, values).unwrap_err().to_string();
    assert!(message(&[0.0, 1.0], &[-1e308, 1e308]).contains("the rise to row 2"));
    assert!(message(&[0.0, 1.0, 2.0], &[0.0, 1e308, -1e308]).contains("the rise to row 3"));
    assert!(message(&[-1e308, 1e308], &[0.0, 1.0]).contains("the time to row 2"));
    assert!(Load::ramp(-1e308, 1e308, 0.0, 1.0).is_err());
}

#[test]
fn breakpoints_shared_by_loads_cut_once() {
    let times: Vec<f64> = (0..5).map(f64::from).collect();
    let table = Load::table(&times, &[0.0, 5.0, 1.0, 2.0, 2.0]).unwrap();
    let function = Load::function(|t| t, &[1.0, 1.0_f64.next_up(), 3.0]).unwrap();
    let step = load("step:5@1..3");
    let loads = Loads { upstream: table.clone(), downstream: function, proximal: step, distal: table };
    let ends: Vec<f64> = loads.segments(0.5, 3.5).map(|segment| segment.to_s).collect();
    assert_eq!(ends, [1.0, 1.0_f64.next_up(), 2.0, 3.0, 3.5]);
}

#[test]
fn segments_of_long_tables_take_linear_time() {
    let rows = 1_000_000;
    let times: Vec<f64> = (0..rows).map(|k| 1e-3 * f64::from(k)).collect();
    let values: Vec<f64> = (0..rows).map(|k| f64::from(k % 11)).collect();
    let table = Load::table(&times, &values).unwrap();
    // A scan of the table in each segment would take hours.
    assert_eq!(on(table.clone(), table).segments(-1.0, 2000.0).count(), 1_000_001);
}

#[test]
fn times_that_are_no_numbers_have_no_segments() {
    let loads = on(load("step:5@0..1"), load("0"));
    for [from, to] in [[f64::NAN, 1.0], [0.0, f64::NAN], [f64::NAN, f64::NAN], [1.0, 0.0], [f64::INFINITY, 1.0]] {
        assert_eq!(loads.segments(from, to).count(), 0, "{from} to {to}");
    }
    let ends: Vec<f64> = loads.segments(f64::NEG_INFINITY, f64::INFINITY).map(|s| s.to_s).collect();
    assert_eq!(ends, [0.0, 1.0, f64::INFINITY]);
}

#[test]
fn functions_may_answer_anything() {
    let function = Load::function(|t| if t > 1.0 { f64::NAN } else { f64::INFINITY }, &[]).unwrap();
    assert!(function.at(0.0).is_infinite() && function.at(2.0).is_nan());
    assert!(matches!(Load::function(|t| t, &[0.0, f64::NAN]), Err(LoadFault::NotFinite { .. })));
    assert!(matches!(Load::function(|t| t, &[1.0, 1.0]), Err(LoadFault::Order { .. })));
    assert!(matches!(Load::function(|t| t, &[1.0, 0.5]), Err(LoadFault::Order { .. })));
}

#[test]
fn slopes_are_derivatives() {
    // Exact for what is straight or a sine; a function's is a difference, measured 1.5e-3 Pa/s of up to 300.
    let cubic = Load::function(|t| 100.0 * t * t * t, &[0.5]).unwrap();
    let loads = Loads {
        upstream: load("sine:5000+1000@2"),
        downstream: load("7"),
        proximal: load("ramp:0..300@0..2"),
        distal: cubic,
    };
    for segment in loads.segments(0.0, 1.0) {
        for part in [0.0, 0.3, 1.0] {
            let t = segment.from_s + part * (segment.to_s - segment.from_s);
            let slope = segment.slope(t);
            assert!((slope.upstream_pa - 4000.0 * PI * (4.0 * PI * t).cos()).abs() <= 1e-9);
            assert_eq!([slope.downstream_pa, slope.proximal_pa], [0.0, 150.0]);
            assert!((slope.distal_pa - 300.0 * t * t).abs() <= 2e-3, "{t}: {}", slope.distal_pa);
        }
    }
}
