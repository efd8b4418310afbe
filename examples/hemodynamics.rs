//! What the photodiodes on a nail see while the fingertip is pressed: `cargo run --example hemodynamics`.

use lunula_hemodynamics::{
    Collapse, Load, Loads, Model, Optics, Parameters, Photodiodes, SolveOptions, rest, simulate,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let parameters = Parameters::thesis();
    let model = Model::new(&parameters, Collapse::Error);
    let loads = Loads::on(&parameters, Load::step(5000.0, 0.0, 2.0)?, Load::step(5000.0, 0.0, 2.0)?);
    let start = rest(&model, &loads.before(0.0))?.state;
    let times_s: Vec<f64> = (0..=20).map(|row| 0.2 * f64::from(row)).collect();
    let trajectory = simulate(&model, &loads, &start, &times_s, &SolveOptions::default())?;
    let photodiodes = Photodiodes::new(&parameters, &Optics::default())?;
    println!("time_s,VP1,VP2");
    for (row, time_s) in times_s.iter().enumerate() {
        let [proximal, distal] = [0, 1].map(|unit| photodiodes.voltage(unit, trajectory.lumens(row)[unit]));
        println!("{time_s:.1},{proximal:.4},{distal:.4}");
    }
    Ok(())
}
