use super::*;
use crate::equilibrium::rest;
use crate::equilibrium::tests::{Random, load, soft, thesis};
use crate::model::Collapse;
use crate::parameters::{Parameters, Symbol};

fn loads(to: f64, by: f64) -> Vec<f64> {
    (0..=(to / by).round() as usize).map(|k| k as f64 * by).collect()
}

/// Loads at which branches turn or end, relative; measured 0.
const TURN: f64 = 1e-12;

fn only_turn(curve: &LoadCurve) -> &Turn {
    assert_eq!(curve.turns.len(), 1, "{:?}", curve.turns);
    &curve.turns[0]
}

#[test]
fn the_branch_of_the_thesis_ends_where_a_vessel_closes() {
    let model = thesis(Collapse::Error);
    // The vein closes at P_H + k_V D_V / A_V. The distal capillary closes when P_V + k_C D_C / A_C presses on it, where
    // the blood flows through the other unit alone.
    let one = Parameters::new(
        Parameters::thesis().units()[..1].to_vec(),
        *Parameters::thesis().vein(),
        3e-3,
        460.0,
        [1e4, 0.0],
    )
    .unwrap();
    let through_one = rest(&Model::new(&one, Collapse::Error), &load(0.0, 0.0)).unwrap().pressures.venous_pa;
    for (path, end, site) in [
        (LoadPath::Proximal, 1.1e4, Site::Vein),
        (LoadPath::Both, 1.1e4, Site::Vein),
        (LoadPath::Distal, 1e4 + through_one, Site::Capillary(1)),
    ] {
        let curve = load_curve(&model, &load(0.0, 0.0), path, &loads(12000.0, 100.0)).unwrap();
        let turn = only_turn(&curve);
        assert!((turn.load_pa / end - 1.0).abs() <= TURN, "{path:?} {}", turn.load_pa);
        assert_eq!(turn.kind, TurnKind::Closing(site));
        assert!(curve.points.iter().all(|point| point.branch == 0));
        assert!(curve.points.iter().all(|point| point.equilibrium.stability == Stability::Stable));
        let [open, collapsed] = curve.ranges[..] else { panic!("{:?}", curve.ranges) };
        assert!(open.stable == 1 && open.equilibria == 1 && collapsed.collapsed());
        assert!(open.from_pa == 0.0 && open.to_pa == collapsed.from_pa && collapsed.to_pa == 12000.0);
    }
}

#[test]
fn with_contact_it_never_ends() {
    let model = thesis(Collapse::Contact);
    for path in [LoadPath::Proximal, LoadPath::Distal, LoadPath::Both] {
        let curve = load_curve(&model, &load(0.0, 0.0), path, &loads(1e6, 2e4)).unwrap();
        assert!(curve.turns.is_empty() && curve.points.len() == 51, "{path:?} {:?}", curve.turns);
    }
}

#[test]
fn a_long_step_does_not_pass_through_touching_walls() {
    // A stiff vein and thin capillaries shut within a fraction of the distance of the loads.
    for (names, factor) in
        [(vec!["k_V_N_per_m"], 2.0), (vec!["D_C1_m", "D_C2_m"], 0.1), (vec!["D_C1_m", "D_C2_m"], 0.3)]
    {
        let parameters = names.iter().fold(Parameters::thesis(), |p, name| {
            let symbol = name.parse().unwrap();
            p.set(symbol, factor * p.get(symbol).unwrap()).unwrap()
        });
        let model = Model::new(&parameters, Collapse::Contact);
        let curve = load_curve(&model, &load(0.0, 0.0), LoadPath::Distal, &loads(12000.0, 200.0)).unwrap();
        assert!(curve.turns.is_empty() && curve.points.iter().all(|point| point.branch == 0), "{:?}", curve.turns);
    }
}

#[test]
fn soft_capillaries_have_two_folds_however_coarse_the_loads() {
    for (collapse, by) in [(Collapse::Error, 20.0), (Collapse::Error, 500.0), (Collapse::Contact, 500.0)] {
        let model = Model::new(&soft(), collapse);
        let curve = load_curve(&model, &load(0.0, 0.0), LoadPath::Distal, &loads(10000.0, by)).unwrap();
        let folds: Vec<_> = curve.turns.iter().filter(|turn| turn.kind == TurnKind::Fold).collect();
        assert_eq!(folds.len(), 2);
        for (fold, load_pa) in folds.iter().zip([3774.9634734607685, 5846.13036937093]) {
            assert!((fold.load_pa / load_pa - 1.0).abs() <= TURN, "{}", fold.load_pa);
            // At a fold the slowest motion stops: around it two equilibria, beyond it none of them.
            let near = |by: f64| {
                let all = equilibria(&model, &load(0.0, fold.load_pa + by)).unwrap();
                let gap = |one: &Equilibrium| (one.state.lumens[1] - fold.state.lumens[1]).abs();
                all.iter().filter(|one| gap(one) < 1e-2).count()
            };
            let mut counts = [near(-1e-4), near(1e-4)];
            counts.sort_unstable();
            assert_eq!(counts, [0, 2], "at {load_pa} Pa");
        }
        assert!(curve.ranges.iter().any(|range| range.bistable() && range.from_pa == folds[0].load_pa));
        for point in &curve.points {
            let lower = point.equilibrium.state.lumens[1] < folds[0].state.lumens[1];
            let upper = point.equilibrium.state.lumens[1] > folds[1].state.lumens[1];
            let stability = if lower || upper { Stability::Stable } else { Stability::Unstable };
            assert_eq!(point.equilibrium.stability, stability);
            let branch = if upper {
                0
            } else if lower {
                2
            } else {
                1
            };
            assert_eq!(point.branch, branch, "at {} Pa", point.load_pa);
        }
    }
}

#[test]
fn loads_that_fall_are_refused_and_none_give_none() {
    let model = thesis(Collapse::Error);
    let fault = load_curve(&model, &load(0.0, 0.0), LoadPath::Both, &[0.0, 2.0, 1.0]).unwrap_err();
    assert!(fault.to_string().contains("1 Pa (row 3) comes after 2 Pa"), "{fault}");
    assert!(load_curve(&model, &load(0.0, 0.0), LoadPath::Both, &[f64::NAN, 1.0]).is_err());
    let none = load_curve(&model, &load(0.0, 0.0), LoadPath::Both, &[]).unwrap();
    assert!(none.points.is_empty() && none.turns.is_empty() && none.ranges.is_empty());
    let single = load_curve(&model, &load(0.0, 0.0), LoadPath::Both, &[5e3]).unwrap();
    assert_eq!(single.points.len(), 1);
}
/// Whether the counts of a curve's ranges are those of its points.
fn counts_agree(curve: &LoadCurve) -> bool {
    curve.points.chunk_by(|a, b| a.load_pa == b.load_pa).all(|at_load| {
        let load_pa = at_load[0].load_pa;
        let inside = |range: &&LoadRange| range.from_pa + 1e-6 < load_pa && load_pa < range.to_pa - 1e-6;
        let stable = at_load.iter().filter(|point| point.equilibrium.stability == Stability::Stable).count();
        curve.ranges.iter().find(inside).is_none_or(|range| range.equilibria == at_load.len() && range.stable == stable)
    })
}

#[test]
fn any_parameters_within_tenfold_have_their_curve() {
    let mut random = Random(3);
    let (mut turns, mut points) = (0, 0);
    for k in 0..40 {
        let parameters = random.parameters(1 + k % 4);
        let collapse = if k % 8 < 4 { Collapse::Error } else { Collapse::Contact };
        let model = Model::new(&parameters, collapse);
        for path in [LoadPath::Proximal, LoadPath::Distal, LoadPath::Both] {
            let curve = load_curve(&model, &load(0.0, 0.0), path, &loads(12000.0, 400.0)).unwrap();
            assert!(counts_agree(&curve), "set {k} {path:?}");
            let closing = |turn: &Turn| matches!(turn.kind, TurnKind::Closing(_));
            assert!(collapse == Collapse::Error || !curve.turns.iter().any(closing), "set {k} {path:?}");
            // A branch has one equilibrium at a load.
            for at_load in curve.points.chunk_by(|a, b| a.load_pa == b.load_pa) {
                let mut branches: Vec<_> = at_load.iter().map(|point| point.branch).collect();
                branches.sort_unstable();
                branches.dedup();
                assert_eq!(branches.len(), at_load.len(), "set {k} {path:?} at {} Pa", at_load[0].load_pa);
            }
            turns += curve.turns.len();
            points += curve.points.len();
        }
    }
    assert!(turns > 50 && points > 2000, "{turns} turns, {points} points");
}

#[test]
fn equal_units_part_from_each_other_and_meet_again() {
    // Four units, the distal two alike: the branches on which they differ begin and end on those on which they don't,
    // in mirrored pairs.
    let soft = Symbol::Stiffness;
    let four = (0..4).map(Site::Capillary).fold(Parameters::along_nail(4).unwrap(), |p, site| {
        p.set(soft(site), 0.5 * p.get(soft(site)).unwrap()).unwrap()
    });
    let model = Model::new(&four, Collapse::Error);
    let curve = load_curve(&model, &load(0.0, 0.0), LoadPath::Distal, &loads(12000.0, 100.0)).unwrap();
    assert!(counts_agree(&curve));
    // What the two units do when they do the same are the two folds and the end of one unit in their place.
    for (load_pa, kind) in [
        (3774.9634734607685, TurnKind::Fold),
        (5846.13036937093, TurnKind::Fold),
        (5879.52879426298, TurnKind::Closing(Site::Capillary(3))),
    ] {
        let turn = curve.turns.iter().find(|turn| (turn.load_pa / load_pa - 1.0).abs() <= TURN && turn.kind == kind);
        let turn = turn.unwrap_or_else(|| panic!("{kind:?} at {load_pa} Pa is not in {:?}", curve.turns));
        assert!((turn.state.lumens[2] - turn.state.lumens[3]).abs() <= 1e-9);
    }
    for point in &curve.points {
        let lumens = &point.equilibrium.state.lumens;
        let mirror = |other: &&CurvePoint| {
            let others = &other.equilibrium.state.lumens;
            other.load_pa == point.load_pa
                && (lumens[2] - others[3]).abs() <= 1e-12
                && (lumens[3] - others[2]).abs() <= 1e-12
        };
        assert!(curve.points.iter().any(|other| mirror(&other)), "{lumens:?} at {} Pa", point.load_pa);
    }
}
