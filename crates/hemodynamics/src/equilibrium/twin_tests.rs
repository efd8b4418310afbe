//! The search against twins that prove nothing: dense scans, Newton's method from everywhere, and the sum of indices.

use super::network::Vessel;
use super::tests::{Random, load, thesis};
use super::*;
use crate::model::Collapse;
use crate::parameters::{Parameters, Symbol};

/// Accelerations at an equilibrium over their largest term; measured 6e-16.
const RESIDUAL: f64 = 1e-13;

/// What the accelerations are made of at rest, the largest term by wall.
fn residual(model: &Model, inputs: &Inputs, one: &Equilibrium) -> f64 {
    let lumens = &one.state.lumens;
    let mut out = vec![0.0; lumens.len()];
    model.accelerations(lumens, &one.state.rates, inputs, &mut out);
    let terms = |j: usize| {
        let wall = &model.walls[j];
        let pressure = inputs.upstream_pa.abs() + inputs.proximal_pa.abs() + inputs.distal_pa.abs();
        wall.push * pressure.max(1.0) + wall.spring * (lumens[j] + 1.0)
    };
    (0..lumens.len()).map(|j| (out[j] / terms(j)).abs()).fold(0.0, f64::max)
}

#[test]
fn one_unit_has_as_many_as_a_dense_scan_sees() {
    let mut random = Random(11);
    let mut several = 0;
    for _ in 0..150 {
        let model = Model::new(&random.parameters(1), Collapse::Error);
        let inputs = load(1.2e4 * random.next(), 1.2e4 * random.next());
        let network = Network::new(&model, &inputs);
        let (unit, vein) = (&network.units[0], &network.vein);
        let flow =
            |vessel: &Vessel, lumen: f64| vessel.conductance * lumen.powi(4) * (vessel.source - vessel.pressure(lumen));
        // The vein's lumen from the capillary's, then what flows in and not out.
        let balance = |lumen: f64| {
            let venous = unit.pressure(lumen) - unit.venule * flow(unit, lumen);
            let vein_lumen = 1.0 + (venous - vein.outside) / vein.stiffness;
            (vein_lumen > 0.0).then(|| flow(unit, lumen) + flow(vein, vein_lumen))
        };
        let highest = 1.0 + (1e4 - unit.outside) / unit.stiffness;
        // Dense at both ends: a wide capillary's pressure is P_H but for what a venule leaves.
        let points = 40_000;
        let spread = |k: usize| 1.0 / (1.0 + 10_f64.powf(4.0 - 16.0 * (k as f64 / points as f64)));
        let values: Vec<_> = (0..=points).map(|k| balance(highest * spread(k))).collect();
        let crossing = |pair: &&[Option<f64>]| matches!(pair, [Some(a), Some(b)] if (*a > 0.0) != (*b > 0.0));
        let seen = values.windows(2).filter(crossing).count();
        let found = equilibria(&model, &inputs).expect("one unit").len();
        assert_eq!(found, seen, "{inputs:?}");
        several += usize::from(found > 1);
    }
    assert!(several > 5, "{several}");
}

#[test]
fn none_is_missed_that_newton_finds_from_anywhere() {
    let mut random = Random(23);
    let (mut reached, mut sets) = (0, 0);
    for k in 0..80 {
        let collapse = if k % 2 == 0 { Collapse::Error } else { Collapse::Contact };
        let model = Model::new(&random.parameters(1 + k % 4), collapse);
        let inputs = load(1.2e4 * random.next(), 1.2e4 * random.next());
        let all = equilibria(&model, &inputs).expect("few units");
        let network = Network::new(&model, &inputs);
        sets += 1;
        for _ in 0..200 {
            let mut start = || 10_f64.powf(4.0 * random.next() - 2.5);
            let vein = start();
            let units = network.units.iter().map(|_| start()).collect();
            let Some((vein, units)) = network.polish(vein, units) else { continue };
            if vein < root::LEAST_LUMEN || units.iter().any(|&lumen| lumen < root::LEAST_LUMEN) {
                continue;
            }
            let own = units.iter().chain([&vein]);
            let known = all
                .iter()
                .any(|one| own.clone().zip(&one.state.lumens).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b)));
            assert!(known, "set {k}: {units:?} {vein} is not among {all:?}");
            reached += 1;
        }
    }
    assert!(sets == 80 && reached > 3000, "{reached}");
}

#[test]
fn with_contact_the_indices_add_up_to_one() {
    // Walls that can't close keep equilibria from leaving through the boundary, so the sum of the signs of the
    // determinants is that of walls so stiff that they don't move: one. A single equilibrium missed or invented would
    // change it.
    let mut random = Random(5);
    let mut counts = [0; 4];
    for k in 0..1500 {
        let model = Model::new(&random.parameters(1 + k % 5), Collapse::Contact);
        let inputs = load(1.2e4 * random.next(), 1.2e4 * random.next());
        let all = equilibria(&model, &inputs).expect("few units");
        let index = |one: &Equilibrium| {
            let growing = one.eigenvalues.iter().filter(|value| value.real_per_s > 0.0).count();
            if growing % 2 == 0 { 1 } else { -1 }
        };
        assert_eq!(all.iter().map(index).sum::<i32>(), 1, "set {k}");
        for one in &all {
            assert!(one.certified && one.stability != Stability::Marginal);
            let residual = residual(&model, &inputs, one);
            assert!(residual <= RESIDUAL, "set {k}: {residual:e}");
        }
        counts[all.len().min(9) / 3] += 1;
    }
    assert!(counts[0] > 1000 && counts[1] > 100 && counts[3] > 0, "{counts:?}");
}

#[test]
fn extremes_are_decided() {
    let scaled = |names: &[&str], factor: f64| {
        names.iter().fold(Parameters::thesis(), |p, name| {
            let symbol: Symbol = name.parse().expect("a symbol");
            p.set(symbol, factor * p.get(symbol).expect("there")).expect("in range")
        })
    };
    let stiffnesses = ["k_C1_N_per_m", "k_C2_N_per_m", "k_V_N_per_m"];
    let dampings = ["b_C1_N_s_per_m", "b_C2_N_s_per_m", "b_V_N_s_per_m"];
    let masses = ["m_C1_kg", "m_C2_kg", "m_V_kg"];
    let venules = ["R_V1_Pa_s_per_m3", "R_V2_Pa_s_per_m3"];
    let mut sets = vec![scaled(&dampings, 0.0)];
    sets.extend([1e-1, 1e1, 1e2, 1e3].map(|factor| scaled(&stiffnesses, factor)));
    sets.extend([1e-1, 1e3].map(|factor| scaled(&stiffnesses[..2], factor)));
    sets.extend([1e-1, 1e3].map(|factor| scaled(&stiffnesses[2..], factor)));
    sets.extend([0.0, 1e2, 1e4, 1e6].map(|factor| scaled(&venules, factor)));
    sets.extend([1e-9, 1e3, 1e6].map(|factor| scaled(&masses, factor)));
    let loads =
        [[0.0, 0.0], [1e3, 0.0], [0.0, 8e3], [9e3, 9e3], [2e4, 0.0], [0.0, 2e4], [1e6, 1e6], [-1e3, -1e3], [-1e5, 0.0]];
    let bloods = [[1e4, 0.0], [0.0, 1e4], [3e3, 3e3], [0.0, 0.0], [-1e3, -2e3]];
    let mut cases = 0;
    for (set, parameters) in sets.iter().enumerate() {
        for collapse in [Collapse::Error, Collapse::Contact] {
            let model = Model::new(parameters, collapse);
            for ([proximal_pa, distal_pa], [upstream_pa, downstream_pa]) in
                loads.into_iter().flat_map(|load| bloods.into_iter().map(move |blood| (load, blood)))
            {
                let inputs = Inputs { upstream_pa, downstream_pa, proximal_pa, distal_pa };
                let all = equilibria(&model, &inputs).expect("two units");
                assert!(collapse == Collapse::Error || all.len() % 2 == 1, "set {set} {inputs:?}: {}", all.len());
                for one in &all {
                    assert!(one.certified && one.stability != Stability::Marginal, "set {set} {inputs:?}");
                    assert!(one.state.check().is_ok() && one.pressures.venous_pa.is_finite());
                    let residual = residual(&model, &inputs, one);
                    assert!(residual <= RESIDUAL, "set {set} {inputs:?}: {residual:e}");
                }
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 16 * 2 * 9 * 5);
}

#[test]
fn what_nothing_damps_is_marginal() {
    // Without damping of the walls and without venules, two like capillaries swing against each other for ever.
    let names = ["b_C1_N_s_per_m", "b_C2_N_s_per_m", "b_V_N_s_per_m", "R_V1_Pa_s_per_m3", "R_V2_Pa_s_per_m3"];
    let undamped = names
        .iter()
        .fold(Parameters::thesis(), |p, name| p.set(name.parse().expect("a symbol"), 0.0).expect("may be 0"));
    for distal in [0.0, 5000.0] {
        let all = equilibria(&Model::new(&undamped, Collapse::Error), &load(0.0, distal)).expect("two units");
        assert!(all.len() == 1 && all[0].certified && all[0].stability == Stability::Marginal, "{all:?}");
    }
    assert_eq!(rest(&thesis(Collapse::Error), &load(0.0, 0.0)).expect("stable").stability, Stability::Stable);
}

#[test]
fn a_lumen_that_rounding_holds_still_hides_no_equilibrium() {
    // A venule that resists 1e10 times as much as its capillary, in front of a limp vein: the capillary's lumen is the
    // same number over most of the venous pressures. Lumens in 60 digits.
    let entries = [
        ("k_C1_N_per_m", 52397.501210046124),
        ("A_C1_m2", 0.0005437647031401185),
        ("D_C1_m", 0.0005439702837767024),
        ("L_C1_m", 0.0010266203461471077),
        ("N_C1", 18068313.886051632),
        ("R_V1_Pa_s_per_m3", 3697589102491.257),
        ("k_V_N_per_m", 11.82894152916327),
        ("A_V_m2", 0.009049747509350777),
        ("D_V_m", 1.3735722056079115e-6),
        ("L_V_m", 0.0003190473339253287),
        ("N_V", 955.7015961649556),
    ];
    let parameters = entries.iter().fold(Parameters::along_nail(1).expect("one unit"), |p, (name, value)| {
        p.set(name.parse().expect("a symbol"), *value).expect("in range")
    });
    let inputs = load(1522.0462207946307, 3789.8890810853636);
    let all = equilibria(&Model::new(&parameters, Collapse::Error), &inputs).expect("one unit");
    assert_eq!(all.len(), 1);
    for (lumen, truth) in all[0].state.lumens.iter().zip([1.154625548150713, 11.46335135767846]) {
        assert!((lumen / truth - 1.0).abs() <= 1e-13, "{lumen} {truth}");
    }
}
