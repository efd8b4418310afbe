//! `lunula simulate` far from the thesis' figures: pulses, other optics, undamped and heavy walls.

use crate::util::{Answer, Dir, number};

fn run(dir: &Dir, options: &str) -> Answer {
    dir.words(&format!("simulate {options}"))
}

fn column(dir: &Dir, table: &str, name: &str) -> Vec<f64> {
    dir.table(table).iter().map(|row| number(row, name)).collect()
}

fn worst(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |worst, gap| if gap <= worst { worst } else { gap })
}

const WALLS: [&str; 3] = ["xC1_m", "xC2_m", "xV_m"];

#[test]
fn a_pulse_of_the_blood_goes_through_the_capillaries() {
    // Six seconds are fifty time constants: what is left is within the solver's tolerance, 1e-8 of 1e-5 m; measured
    // 1.8e-14.
    const PERIODIC_M: f64 = 1e-13;
    let dir = Dir::new();
    run(&dir, "--ph sine:10000+2000@1 --until 8 --with-loads --out p.csv --no-figures").expect(0);
    let (x, light) = (column(&dir, "p.csv", "xC1_m"), column(&dir, "p.csv", "VP1"));
    let pressure = column(&dir, "p.csv", "ph_Pa");
    assert_eq!((x.len(), pressure[25]), (801, 12_000.0));
    let gap = worst(&x[600..700], &x[700..800]);
    assert!(gap <= PERIODIC_M, "{gap}");
    // More pressure swells the capillaries, which take more light; both lag the pressure, whose top is at 0.25 s.
    let top = (700..800).max_by(|&a, &b| x[a].total_cmp(&x[b])).unwrap();
    assert!((726..=750).contains(&top), "{top}");
    assert!(light[top] < light[top - 50] && x[top] - x[top - 50] > 1e-8, "{} {}", x[top], x[top - 50]);
    // A pulse of no height is none.
    run(&dir, "--ph sine:10000+0@1 --pf1 step:5000@0..1 --until 2 --out flat.csv --no-figures").expect(0);
    run(&dir, "--pf1 step:5000@0..1 --until 2 --out plain.csv --no-figures").expect(0);
    for wall in WALLS {
        let gap = worst(&column(&dir, "flat.csv", wall), &column(&dir, "plain.csv", wall));
        assert!(gap <= PERIODIC_M, "{wall}: {gap}");
    }
}

#[test]
fn optics_are_chosen_and_the_tangent_touches_at_rest() {
    const DIGITS: f64 = 4e-15;
    let dir = Dir::new();
    for optics in ["beer-lambert", "quadratic", "linear"] {
        run(&dir, &format!("--pf2 step:8000@0..1 --until 2 --optics {optics} --out {optics}.csv --no-figures"))
            .expect(0);
    }
    let [exact, quadratic, linear] =
        ["beer-lambert.csv", "quadratic.csv", "linear.csv"].map(|table| column(&dir, table, "VP2"));
    // V_0 = 0 and V_1 = 1: absorption is alpha d^2.
    let printed: Vec<f64> = exact.iter().map(|light| 1.0 + light.ln()).collect();
    assert!(worst(&printed, &quadratic) <= DIGITS && worst(&exact, &quadratic) > 1e-3);
    // The run begins at rest, the working point.
    assert!((linear[0] - exact[0]).abs() <= DIGITS && worst(&exact, &linear) > 1e-3);
}

#[test]
fn walls_without_damping_or_of_any_mass_come_to_the_same_rest() {
    // Measured 7.8e-20 m.
    const NEAR_M: f64 = 1e-16;
    let dir = Dir::new();
    let all = |symbol: &str, unit_and_value: &str| -> String {
        ["C1", "C2", "V"].iter().map(|site| format!(" --set {symbol}_{site}_{unit_and_value}")).collect()
    };
    let rest = {
        run(&dir, "--pf1 5000 --pf2 3000 --until 0 --out rest.csv --no-figures").expect(0);
        dir.table("rest.csv").remove(0)
    };
    for (case, set) in
        [("undamped", all("b", "N_s_per_m=0")), ("light", all("m", "kg=1e-12")), ("heavy", all("m", "kg=1"))]
    {
        run(
            &dir,
            &format!(
                "--pf1 step:5000@0..9 --pf2 step:3000@0..9 --until 4 --every 0.1 {set} --out {case}.csv --no-figures"
            ),
        )
        .expect(0);
        let rows = dir.table(&format!("{case}.csv"));
        assert_eq!(rows.len(), 41);
        for wall in WALLS {
            let gap = (number(&rows[40], wall) - number(&rest, wall)).abs();
            assert!(gap <= NEAR_M, "{case}, {wall}: {gap:e}");
        }
    }
}
