//! Lags against a look at every pair of rows, and rows that are hard.

use super::stream::SAME_MOMENT;
use super::*;
use proptest::prelude::*;

fn set(parts: &[&[f64]], x: impl Fn(f64, usize) -> f64) -> Dataset {
    let time: Vec<f64> = parts.concat();
    let mut recordings = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let start = recordings.last().map_or(0, |one: &Recording| one.rows.end);
        recordings.push(Recording::of(format!("s{k}"), start..start + part.len()));
    }
    let values = Array2::from_shape_fn((time.len(), 2), |(row, column)| x(time[row], column));
    let y = Array2::from_shape_fn((time.len(), 1), |(row, _)| row as f64);
    Dataset::new(vec!["P1".into(), "P2".into()], vec!["Fz_N".into()], time, values, y, recordings).unwrap()
}

/// A look at every pair of rows: what [`LagStream`] does, for ascending time.
fn naive(lags: &Lags, data: &Dataset, recording: &Recording, row: usize) -> Option<Vec<f64>> {
    let time = data.time_s();
    let near = SAME_MOMENT * lags.longest_gap_s;
    let mut wide = data.x().row(row).to_vec();
    for lag in &lags.lags_s {
        let moment = time[row] - lag;
        let same = recording.rows.clone().find(|&k| (moment - near..=moment + near).contains(&time[k]));
        let pair =
            recording.rows.clone().find(|&k| k > recording.rows.start && time[k - 1] < moment && moment < time[k]);
        if let Some(same) = same {
            wide.extend(data.x().row(same));
        } else {
            let (a, b) = (pair? - 1, pair?);
            if time[b] - time[a] > lags.longest_gap_s + near {
                return None;
            }
            let share = (moment - time[a]) / (time[b] - time[a]);
            wide.extend((0..2).map(|k| data.x()[[a, k]] * (1.0 - share) + data.x()[[b, k]] * share));
        }
    }
    Some(wide)
}

#[test]
fn a_ramp_is_read_exactly_at_its_lags() {
    let time: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.04).collect();
    let data = set(&[&time, &time], |t, column| 3.0 * t + column as f64);
    let lags = Lags::of(vec![0.1, 0.04], &data).unwrap();
    assert!((lags.longest_gap_s - 0.08).abs() <= 1e-12);
    let wide = lags.expand(&data).unwrap();
    // 0.1 s are 2.5 steps: the first three rows of each recording have no history.
    assert_eq!((wide.dropped, wide.data.rows(), wide.kept[..2].to_vec()), (6, 34, vec![3, 4]));
    assert_eq!(wide.data.inputs(), ["P1", "P2", "P1@-0.1s", "P2@-0.1s", "P1@-0.04s", "P2@-0.04s"]);
    assert_eq!(wide.data.recordings().iter().map(|one| one.rows.clone()).collect::<Vec<_>>(), [0..17, 17..34]);
    assert_eq!(wide.data.y()[[0, 0]], 3.0);
    for (x, t) in wide.data.x().rows().into_iter().zip(wide.data.time_s()) {
        // Measured 2e-16.
        assert!((x[2] - 3.0 * (t - 0.1)).abs() <= 1e-14 && (x[5] - 3.0 * (t - 0.04) - 1.0).abs() <= 1e-14);
    }
}

#[test]
fn nothing_is_read_across_a_gap_or_out_of_another_recording() {
    let data = set(&[&[0.0, 1.0, 2.0, 3.0, 6.0, 7.0, 8.0], &[0.0, 1.0]], |t, _| t);
    let lags = Lags::of(vec![1.5], &data).unwrap();
    assert_eq!(lags.longest_gap_s, 2.0);
    let wide = lags.expand(&data).unwrap();
    // At 6 s and 7 s the moment lies in the gap; the second recording is too short.
    assert_eq!(wide.kept, [2, 3, 6]);
    assert_eq!(wide.data.recordings().len(), 1);
}

#[test]
fn a_stream_of_many_ages_keeps_little() {
    let lags = Lags::new(vec![0.5], 0.2).unwrap();
    let (mut stream, mut out) = (lags.stream(1), [0.0; 2]);
    let known = (0..10_000).filter(|&k| stream.push(0.1 * f64::from(k), &[f64::from(k)], &mut out)).count();
    assert_eq!(known, 9_995);
    assert!(stream.kept() <= 8, "{}", stream.kept());
}

#[test]
fn bad_rows_of_a_stream() {
    let lags = Lags::new(vec![1.0], 1.0).unwrap();
    let (mut stream, mut out) = (lags.stream(1), [0.0; 2]);
    let mut push = |time, x| stream.push(time, &[x], &mut out).then_some(out);
    assert_eq!(push(0.0, 1.0), None);
    assert_eq!(push(f64::NAN, 2.0), None);
    assert_eq!(push(1.0, f64::NAN), None, "no row of NaN");
    assert_eq!(push(2.0, 5.0), None, "nor history of it");
    assert_eq!(push(3.0, 6.0), Some([6.0, 5.0]));
    assert_eq!(push(3.0, 7.0), Some([7.0, 5.0]));
    assert_eq!(push(4.0, 8.0), Some([8.0, 6.0]), "the first row of a moment stays");
    assert_eq!(push(0.0, 1.0), None, "time goes back: a new recording");
    assert_eq!(push(1.0, 2.0), Some([2.0, 1.0]));
}

#[test]
fn what_makes_no_lags() {
    for lag in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Lags::new(vec![0.5, lag], 1.0), Err(LagFault::Lag(_))));
    }
    assert_eq!(Lags::new(vec![0.5, 0.5], 1.0), Err(LagFault::Lag(0.5)));
    assert_eq!(Lags::new(vec![], 1.0), Err(LagFault::None));
    assert_eq!(Lags::new(vec![1.0], 0.0), Err(LagFault::Gap(0.0)));
    let time: Vec<f64> = (0..5).map(f64::from).collect();
    let data = set(&[&time], |t, _| t);
    let long = Lags::of(vec![10.0], &data).unwrap();
    assert!(long.expand(&data).unwrap_err().to_string().contains("none of 5 rows has a history of 10 s"));
    let reversed = set(&[&[4.0, 3.0, 2.0]], |t, _| t);
    assert_eq!(Lags::of(vec![1.0], &reversed), Err(LagFault::Step));
    assert!(matches!(Lags::new(vec![1.0], 2.0).unwrap().expand(&reversed), Err(LagFault::History { rows: 3, .. })));
    let lags = Lags::of(vec![1.0], &data).unwrap();
    let text = serde_json::to_string(&lags).unwrap();
    assert_eq!(serde_json::from_str::<Lags>(&text).unwrap(), lags);
    assert!(serde_json::from_str::<Lags>(&text.replace("1.0", "-1.0")).is_err());
}

proptest! {
    #[test]
    fn streams_sets_and_a_look_at_every_pair_agree(
        steps in proptest::collection::vec(0.01..0.3_f64, 2..60),
        lags in proptest::collection::vec(0.01..1.0_f64, 1..4),
        cut in 0.0..1.0_f64,
    ) {
        let time: Vec<f64> = steps.iter().scan(0.0, |t, step| { *t += step; Some(*t) }).collect();
        let (first, second) = time.split_at((cut * time.len() as f64) as usize);
        let data = set(&[first, second], |t, column| (t * (3.0 + column as f64)).sin());
        let lags = Lags::new(lags, 0.2).unwrap();
        let expected: Vec<Vec<f64>> = data.recordings().iter()
            .flat_map(|one| one.rows.clone().filter_map(|row| naive(&lags, &data, one, row)).collect::<Vec<_>>())
            .collect();
        match lags.expand(&data) {
            Ok(wide) => {
                let rows: Vec<Vec<f64>> = wide.data.x().rows().into_iter().map(|row| row.to_vec()).collect();
                prop_assert_eq!(rows, expected);
                prop_assert_eq!(wide.kept.len() + wide.dropped, data.rows());
            }
            Err(fault) => prop_assert!(expected.is_empty(), "{}", fault),
        }
    }
}

#[test]
fn rows_without_times_are_refused_as_such() {
    let x = Array2::from_shape_fn((9, 1), |(row, _)| row as f64);
    let (inputs, targets) = (vec!["P1".to_owned()], vec!["J2_deg".to_owned()]);
    let one = vec![Recording::of("a", 0..9)];
    let data = Dataset::new(inputs, targets, vec![f64::NAN; 9], x.clone(), x, one).unwrap();
    let fault = Lags::new(vec![0.1], 0.08).unwrap().expand(&data).unwrap_err();
    assert_eq!(fault, LagFault::NoTime { longest_s: 0.1 });
}
