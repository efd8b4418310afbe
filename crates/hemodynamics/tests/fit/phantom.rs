//! Recordings of a known model with noise.

use lunula_hemodynamics::{
    Collapse, Free, Load, Loads, Model, Optics, Parameters, Photodiodes, Recording, SolveOptions, Symbol, Trace, rest,
    simulate,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

pub(crate) fn symbol(name: &str) -> Symbol {
    name.parse().expect("a parameter")
}

/// The thesis' table with some parameters changed by a factor.
pub(crate) fn changed(factors: &[(&str, f64)]) -> Parameters {
    factors.iter().fold(Parameters::thesis(), |parameters, (name, factor)| {
        let value = parameters.get(symbol(name)).expect("a parameter") * factor;
        parameters.set(symbol(name), value).expect("a good value")
    })
}

/// Capillaries' stiffness and damping changed by factors.
pub(crate) fn softer(stiffness: f64, damping: f64) -> Parameters {
    let [k, b] = [stiffness, damping];
    changed(&[("k_C1_N_per_m", k), ("k_C2_N_per_m", k), ("b_C1_N_s_per_m", b), ("b_C2_N_s_per_m", b)])
}

/// `k_C1 = k_C2` and `b_C1 = b_C2`, free.
pub(crate) fn tied() -> [Free; 2] {
    let pair = |a: &str, b: &str| Free::tied(&[symbol(a), symbol(b)]);
    [pair("k_C1_N_per_m", "k_C2_N_per_m"), pair("b_C1_N_s_per_m", "b_C2_N_s_per_m")]
}

/// Photodiodes' scaling and offset, V.
pub(crate) fn with_photodiodes(parameters: Parameters, scalings_v: [f64; 2], offsets_v: [f64; 2]) -> Parameters {
    (0..2).fold(parameters, |parameters, i| {
        let parameters = parameters.set(Symbol::Scaling(i), scalings_v[i]).expect("finite");
        parameters.set(Symbol::Offset(i), offsets_v[i]).expect("finite")
    })
}

pub(crate) fn times() -> Vec<f64> {
    (0..400).map(|k| 0.01 * k as f64).collect()
}

/// Never pressed.
pub(crate) fn zero() -> Load {
    Load::constant(0.0).expect("a finite load")
}

/// Pressed for the first two seconds.
pub(crate) fn step(height_pa: f64) -> Load {
    Load::step(height_pa, 0.0, 2.0).expect("a finite load")
}

/// A finger that presses from `from_s` to `to_s` as fast as it can: a time constant of 40 ms, sampled as a force sensor
/// does.
pub(crate) fn pressed(height_pa: f64, from_s: f64, to_s: f64) -> Load {
    let rise = |t: f64| if t <= 0.0 { 0.0 } else { 1.0 - (-t / 0.04).exp() };
    let values: Vec<f64> = times().iter().map(|t| height_pa * (rise(t - from_s) - rise(t - to_s))).collect();
    Load::table(&times(), &values).expect("growing times")
}

/// What the photodiodes of these units see, without noise, from the equilibrium of the load before.
pub(crate) fn exact(parameters: &Parameters, proximal: &Load, distal: &Load, units: &[usize]) -> Recording {
    seen(parameters, &times(), proximal, distal, units)
}

/// The same at other times, from the load before 0.
pub(crate) fn seen(
    parameters: &Parameters,
    times: &[f64],
    proximal: &Load,
    distal: &Load,
    units: &[usize],
) -> Recording {
    let model = Model::new(parameters, Collapse::Error);
    let loads = Loads::on(parameters, proximal.clone(), distal.clone());
    let start = rest(&model, &loads.before(0.0)).expect("an equilibrium").state;
    let options = SolveOptions::at(1e-10);
    let trajectory = simulate(&model, &loads, &start, times, &options).expect("no collapse");
    let optics = Photodiodes::new(parameters, &Optics::default()).expect("no working point");
    let traces = units
        .iter()
        .map(|&unit| {
            let volts = (0..times.len()).map(|k| optics.voltage(unit, trajectory.lumens(k)[unit])).collect();
            Trace::new(unit, volts)
        })
        .collect();
    Recording::transient(times.to_vec(), proximal.clone(), distal.clone(), traces)
}

/// With noise of a part of each photodiode's swing.
pub(crate) fn noisy(recording: &Recording, part: f64, seed: u64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut recording = recording.clone();
    for trace in &mut recording.photodiodes {
        let most = trace.voltages_v.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = trace.voltages_v.iter().copied().fold(f64::INFINITY, f64::min);
        trace.noise_v = part * (most - least);
        for volts in &mut trace.voltages_v {
            let normal: f64 = StandardNormal.sample(&mut random);
            *volts += part * (most - least) * normal;
        }
    }
    recording
}
