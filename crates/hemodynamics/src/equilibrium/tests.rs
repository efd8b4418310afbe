use super::*;
use crate::model::Collapse;
use crate::parameters::{Parameters, Site, Symbol};

/// Numbers that look random, the same on every machine.
pub(super) struct Random(pub(super) u64);

impl Random {
    /// Between 0 and 1.
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within_tenfold(&mut self) -> f64 {
        10_f64.powf(2.0 * self.next() - 1.0)
    }

    /// The thesis' table with every vessel's parameter and venule within tenfold.
    pub(super) fn parameters(&mut self, n: usize) -> Parameters {
        let mut parameters = Parameters::along_nail(n).unwrap();
        for symbol in parameters.symbols() {
            let vessels = matches!(
                symbol,
                Symbol::Stiffness(_)
                    | Symbol::Mass(_)
                    | Symbol::Damping(_)
                    | Symbol::Area(_)
                    | Symbol::Diameter(_)
                    | Symbol::Length(_)
                    | Symbol::Count(_)
                    | Symbol::Venule(_)
            );
            if vessels {
                let value = parameters.get(symbol).unwrap() * self.within_tenfold();
                parameters = parameters.set(symbol, value).unwrap();
            }
        }
        parameters
    }
}

pub(super) fn load(proximal_pa: f64, distal_pa: f64) -> Inputs {
    Inputs { upstream_pa: 1e4, downstream_pa: 0.0, proximal_pa, distal_pa }
}

pub(super) fn thesis(collapse: Collapse) -> Model {
    Model::new(&Parameters::thesis(), collapse)
}

/// The thesis' table with soft capillaries, where distal loads have several equilibria.
pub(super) fn soft() -> Parameters {
    ["k_C1_N_per_m", "k_C2_N_per_m"]
        .iter()
        .fold(Parameters::thesis(), |p, name| p.set(name.parse().unwrap(), 5e4).unwrap())
}

/// Lumens against printed facts and closed forms; measured 5e-8 (the facts have eight digits).
const FACT: f64 = 1e-7;

#[test]
fn at_rest_the_walls_are_where_the_facts_say() {
    let parameters = Parameters::thesis();
    let resting = rest(&thesis(Collapse::Error), &load(0.0, 0.0)).unwrap();
    for (j, fact) in [9.273971e-6, 9.273971e-6, 1.0769250e-4].into_iter().enumerate() {
        let displacement_m = parameters.wall(j).diameter_m * (resting.state.lumens[j] - 1.0);
        let gap = (displacement_m - fact).abs() / fact;
        assert!(gap <= FACT, "wall {j}: {gap}");
    }
    assert!(resting.certified);
    let rates: Vec<f64> = resting.eigenvalues.iter().map(|one| one.real_per_s).collect();
    for (rate, fact) in rates.iter().zip([-8.54, -8.55, -18.0, -1.6e5, -1.008e7, -1.008e7]) {
        assert!((rate / fact - 1.0).abs() <= 0.01, "{rate} against {fact}");
    }
}

#[test]
fn beyond_the_collapse_nothing_is_open() {
    let model = thesis(Collapse::Error);
    for (proximal, distal, open) in [
        (1.09e4, 0.0, 1),
        (1.0999e4, 0.0, 1),
        (1.1e4, 0.0, 0),
        (1e6, 0.0, 0),
        (0.0, 10859.037, 1),
        (0.0, 10859.04, 0),
        (0.0, 1e6, 0),
        (1.09e4, 1.09e4, 1),
        (1e6, 1e6, 0),
    ] {
        let all = equilibria(&model, &load(proximal, distal)).unwrap();
        assert_eq!(all.len(), open, "{proximal} {distal}");
        assert!(all.iter().all(|one| one.certified && one.stability == Stability::Stable));
    }
    let fault = rest(&model, &load(1.2e4, 0.0)).unwrap_err();
    assert!(fault.to_string().contains("P_F1 = 12000 Pa"), "{fault}");
}

#[test]
fn touching_walls_hold_any_load() {
    let model = thesis(Collapse::Contact);
    for (proximal, lumen) in [(2e4, 0.016226742), (1e5, 0.009149301)] {
        let vein = rest(&model, &load(proximal, 0.0)).unwrap().state.lumens[2];
        assert!((vein / lumen - 1.0).abs() <= FACT, "{vein}");
    }
    for (proximal, distal) in [(1e6, 0.0), (0.0, 1e6), (1e6, 1e6)] {
        assert!(rest(&model, &load(proximal, distal)).unwrap().certified);
    }
}

#[test]
fn an_input_that_is_no_number_is_refused() {
    for value in [f64::NAN, f64::INFINITY] {
        let inputs = Inputs { distal_pa: value, ..load(0.0, 0.0) };
        let fault = equilibria(&thesis(Collapse::Error), &inputs).unwrap_err();
        assert!(fault.to_string().starts_with("P_F2 is "), "{fault}");
    }
}

/// The rightmost and all other eigenvalues, relative; measured 3e-15 against 60 digits.
const EIGENVALUE: f64 = 1e-14;

#[test]
fn slow_and_fast_eigenvalues_have_as_many_digits() {
    // From the same equations in 60 digits: the Jacobian by central differences of 1e-20, its eigenvalues by QR
    // (mpmath).
    let slow_to_fast: [(Model, Inputs, [f64; 6]); 4] = [
        (
            thesis(Collapse::Error),
            load(0.0, 0.0),
            [
                -8.544973435766115,
                -8.546312368393263,
                -17.966792974713588,
                -158592.957892254,
                -10081356.780375049,
                -10082137.485037582,
            ],
        ),
        (
            thesis(Collapse::Error),
            load(0.0, 5000.0),
            [
                -1.1476210688473711,
                -8.529112082643325,
                -16.30150426772309,
                -170261.82909145454,
                -10081937.639100187,
                -10532915.310656054,
            ],
        ),
        (
            thesis(Collapse::Error),
            load(0.0, 10858.037),
            [
                -8.50428645925605,
                -9.083323805975922,
                -13.843827298511936,
                -192722.61697835577,
                -10082249.466566727,
                -11094397.524722159,
            ],
        ),
        (
            thesis(Collapse::Contact),
            load(1e6, 1e6),
            [
                -9.924194492572186,
                -318886.1651913765,
                -543991.5330252647,
                -543991.5330252647,
                -10072813.5346888,
                -11849490.398860501,
            ],
        ),
    ];
    for (model, inputs, truth) in slow_to_fast {
        let one = rest(&model, &inputs).unwrap();
        for (value, truth) in one.eigenvalues.iter().zip(truth) {
            assert!((value.real_per_s / truth - 1.0).abs() <= EIGENVALUE, "{} against {truth}", value.real_per_s);
        }
        assert_eq!(one.slowest_s(), Some(-1.0 / one.eigenvalues[0].real_per_s));
    }
    let unstable = equilibria(&Model::new(&soft(), Collapse::Error), &load(0.0, 5000.0)).unwrap();
    let growth = unstable[1].eigenvalues[0].real_per_s;
    assert!((growth / 3.8941651980822276 - 1.0).abs() <= EIGENVALUE && unstable[1].slowest_s().is_none());
    let swing = rest(&thesis(Collapse::Contact), &load(1e6, 1e6)).unwrap().eigenvalues[2].imaginary_per_s;
    assert!((swing / 681895.6187260775 - 1.0).abs() <= EIGENVALUE);
}

#[test]
fn near_a_fold_both_are_found_until_they_are_one() {
    let model = Model::new(&soft(), Collapse::Error);
    let fold = 3774.9634734607685;
    let count = |relative: f64| {
        let all = equilibria(&model, &load(0.0, fold * (1.0 + relative))).unwrap();
        (all.len(), all.iter().filter(|one| one.stability == Stability::Marginal).count())
    };
    for relative in [1e-14, 1e-13, 1e-12, 1e-11, 1e-9, 1e-6] {
        assert_eq!(count(relative), (3, 0), "{relative} beyond");
        assert_eq!(count(-relative), (1, 0), "{relative} before");
    }
    // At the fold itself they are one that is neither stable nor not.
    assert_eq!(count(0.0), (2, 1));
}

#[test]
fn what_numbers_cannot_hold_is_refused() {
    // Parameters refuse what makes no normal number (1e-300), equilibria what their products can't hold.
    assert!(Parameters::thesis().set("N_C1".parse().unwrap(), 1e-300).is_err());
    let tiny = Parameters::thesis().set("N_C1".parse().unwrap(), 1e-55).unwrap();
    let fault = equilibria(&Model::new(&tiny, Collapse::Error), &load(0.0, 0.0)).unwrap_err();
    assert_eq!(fault, EquilibriumFault::Range);
    assert_eq!(equilibria(&thesis(Collapse::Contact), &load(1e300, 0.0)), Err(EquilibriumFault::Range));
}

#[test]
fn units_that_are_the_same_take_all_orders() {
    for (n, count) in [(4, 9), (6, 27), (8, 81)] {
        let softer = (0..n).map(|i| Symbol::Stiffness(Site::Capillary(i)));
        let parameters = softer
            .fold(Parameters::along_nail(n).unwrap(), |p, symbol| p.set(symbol, 0.5 * p.get(symbol).unwrap()).unwrap());
        let model = Model::new(&parameters, Collapse::Contact);
        let all = equilibria(&model, &load(0.0, 5000.0)).unwrap();
        assert_eq!(all.len(), count);
        for (k, one) in all.iter().enumerate() {
            assert!(one.certified && all[..k].iter().all(|other| other.state.lumens != one.state.lumens));
            let open = one.state.lumens[n / 2..n].iter().filter(|&&lumen| lumen > 1.0).count();
            let shut = one.state.lumens[n / 2..n].iter().filter(|&&lumen| lumen < 0.3).count();
            // A lumen between open and shut is unstable.
            let stability = if open + shut == n / 2 { Stability::Stable } else { Stability::Unstable };
            assert_eq!(one.stability, stability, "{:?}", one.state.lumens);
        }
        // Seen by their share, n units are the two of the thesis where all do the same.
        let two = equilibria(&Model::new(&soft(), Collapse::Contact), &load(0.0, 5000.0)).unwrap();
        for one in &two {
            let [c1, c2, v] = one.state.lumens[..] else { panic!("three walls") };
            let gap = |many: &Equilibrium| {
                let truth = (0..=n).map(|i| {
                    if i < n / 2 {
                        c1
                    } else if i < n {
                        c2
                    } else {
                        v
                    }
                });
                many.state.lumens.iter().zip(truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            // Rounding: measured 5e-16.
            assert!(all.iter().map(gap).fold(f64::INFINITY, f64::min) <= 1e-14);
        }
    }
}

#[test]
fn too_many_equilibria_are_an_error_and_soon() {
    let softer = |n: usize, apart: f64| {
        (0..n).fold(Parameters::along_nail(n).unwrap(), |p, i| {
            let symbol = Symbol::Stiffness(Site::Capillary(i));
            p.set(symbol, (0.5 + apart * i as f64) * p.get(symbol).unwrap()).unwrap()
        })
    };
    let fault = equilibria(&Model::new(&softer(20, 0.0), Collapse::Contact), &load(0.0, 5000.0)).unwrap_err();
    assert_eq!(fault, EquilibriumFault::Equilibria { units: 20, most: 10_000 });
    let fault = equilibria(&Model::new(&softer(20, 0.005), Collapse::Contact), &load(0.0, 5000.0)).unwrap_err();
    assert!(matches!(fault, EquilibriumFault::Choices { units: 20, .. }), "{fault}");
    // At 4000 Pa open and narrow equilibria are close to each other; still each of 81 comes once.
    assert_eq!(equilibria(&Model::new(&softer(8, 0.0), Collapse::Contact), &load(0.0, 4000.0)).unwrap().len(), 81);
    // Fifty units with one equilibrium are no trouble.
    let fifty = Model::new(&Parameters::along_nail(50).unwrap(), Collapse::Error);
    assert_eq!(equilibria(&fifty, &load(5000.0, 5000.0)).unwrap().len(), 1);
}
