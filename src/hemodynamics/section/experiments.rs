//! Fig. 79 to 82 on generated people: static curves and quick presses, the model fitted to them as the thesis does.

use std::fmt::Write;

use lunula_hemodynamics::{
    Calibration, Collapse, FitOptions as Settings, FitResult, Free, Optics, Parameters, Recording, fit, time_constant,
};

use super::figure;
use super::people::{PEOPLE, PRESSED_S, Person, RELEASED_S, Recorded, ends, people};
use super::tune::GROUPS;
use crate::figure::{Item, draw_charts, draw_panels};
use crate::files::Staging;
use crate::hemodynamics::curve::Pressed;
use crate::hemodynamics::figures::{WIDTH, chart, line, over_time};
use crate::hemodynamics::fit::{own_parameters, voltages};

/// The people whose quick presses are drawn, as in Fig. 80 and 82, from 0.
const SHOWN: [usize; 2] = [1, 2];
/// The end of a quick press that its time constants are told to, s.
const END_S: f64 = 4.4;

/// Draws and tells Fig. 79 to 82.
pub(super) fn figures(
    text: &mut String,
    literal: &Parameters,
    tuned: &Parameters,
    staging: &Staging,
) -> anyhow::Result<()> {
    let Some(people) = people(tuned) else { anyhow::bail!("no people about the tuned values") };
    let optics = Optics::BeerLambert;
    let calibrated = Settings { collapse: Collapse::Contact, optics, ..Settings::default() };
    for (number, pressed) in [(79, Pressed::Proximal), (81, Pressed::Distal)] {
        slow(text, number, pressed, &people, literal, &calibrated, staging)?;
    }
    let proximal = people.iter().map(|one| one.quickly(Pressed::Proximal)).collect::<Result<Vec<_>, _>>()?;
    let distal = people.iter().map(|one| one.quickly(Pressed::Distal)).collect::<Result<Vec<_>, _>>()?;
    let all: Vec<Recording> = proximal.iter().chain(&distal).map(|one| one.recording.clone()).collect();
    let free: Vec<Free> = GROUPS.iter().map(|(_, symbols)| Free::tied(symbols)).collect();
    let settings = Settings { calibration: Calibration::PerRecording, ..calibrated.clone() };
    let found = fit(&all, literal, &free, &settings)?;
    tell_fit(text, literal, tuned, &found)?;
    let fitted = |k: usize| -> anyhow::Result<Vec<f64>> {
        let own = own_parameters(&found.parameters, &found.photodiodes, k);
        Ok(voltages(&own, &all[k], Collapse::Contact, &Optics::BeerLambert)?.remove(0))
    };
    for (number, recorded, first) in [(80, &proximal, 0), (82, &distal, PEOPLE)] {
        let curves = (0..PEOPLE).map(|k| fitted(first + k)).collect::<anyhow::Result<Vec<_>>>()?;
        quick(text, number, recorded, &curves, staging)?;
    }
    Ok(())
}

/// A static experiment: every person's curve, their average, and the literal model in offset and scaling to each.
fn slow(
    text: &mut String,
    number: u32,
    pressed: Pressed,
    people: &[Person],
    literal: &Parameters,
    settings: &Settings,
    staging: &Staging,
) -> anyhow::Result<()> {
    let recorded = people.iter().map(|one| one.slowly(pressed)).collect::<Result<Vec<_>, _>>()?;
    let samples = recorded[0].force_n.len();
    let of = |one: &Recorded, k: usize| one.recording.photodiodes[0].voltages_v[k];
    let mean = |k: usize| recorded.iter().map(|one| of(one, k)).sum::<f64>() / recorded.len() as f64;
    let mut average = recorded[0].recording.clone().of("average");
    average.photodiodes[0].voltages_v = (0..samples).map(mean).collect();
    let mut recordings: Vec<Recording> = recorded.iter().map(|one| one.recording.clone()).collect();
    recordings.push(average);
    let found = fit(&recordings, literal, &[], settings)?;
    writeln!(
        text,
        "Fig. {number}: the literal model in offset and scaling to generated static curves; change over 1 and over 2 N, and RMS of what is left\n"
    )?;
    writeln!(
        text,
        "| | offset, V | scaling, V | change to 1 N, V | change to 2 N, V | left, % of the range |\n|---|---|---|---|---|---|"
    )?;
    let mut items = Vec::new();
    for (k, recording) in recordings.iter().enumerate() {
        let measured = &recording.photodiodes[0].voltages_v;
        let own = own_parameters(&found.parameters, &found.photodiodes, k);
        let curve = voltages(&own, recording, Collapse::Contact, &Optics::BeerLambert)?.remove(0);
        let diode = found.photodiodes.iter().find(|one| one.recordings.contains(&k));
        let (low, high) = ends(measured);
        let left = measured.iter().zip(&curve).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / samples as f64;
        let name = if k < people.len() { people[k].name.clone() } else { "average".to_owned() };
        let value = |of: Option<f64>| figure(of);
        writeln!(
            text,
            "| {name} | {} | {} | {:.3} | {:.3} | {:.1} |",
            value(diode.map(|one| one.offset.value)),
            value(diode.map(|one| one.scaling.value)),
            measured[samples / 2] - measured[0],
            measured[samples - 1] - measured[0],
            100.0 * left.sqrt() / (high - low)
        )?;
        let zero = measured[0];
        let at = |values: &[f64]| -> Vec<[f64; 2]> {
            recorded[0].force_n.iter().zip(values).map(|(force, value)| [*force, value - zero]).collect()
        };
        let last = k == people.len();
        let label = if last { Some("average") } else { (k == 0).then_some("generated people") };
        items.push(Item::Line {
            name: label.map(str::to_owned),
            runs: vec![at(measured)],
            colour: if last { 1 } else { 5 },
            width: if last { 3 } else { 1 },
        });
        if last {
            items.push(line(Some("literal model, offset and scaling fitted to the average"), at(&curve), 0));
        }
    }
    writeln!(text)?;
    let place = pressed.name();
    let title = format!("Static, {place} force on 1 cm2: a phantom of eight people");
    let y = if pressed == Pressed::Distal { "VP2 less its value at rest, V" } else { "VP1 less its value at rest, V" };
    let charts = [chart(&title, "force, N", y, items)];
    let [png, svg] = ["png", "svg"].map(|ending| format!("fig-{number}.{ending}"));
    draw_charts(&charts, WIDTH, &staging.place(&png)?, &staging.place(&svg)?)
}

fn tell_fit(text: &mut String, literal: &Parameters, tuned: &Parameters, found: &FitResult) -> anyhow::Result<()> {
    writeln!(
        text,
        "Fig. 80 and 82: stiffness and damping fitted within tenfold to all sixteen generated quick presses, measured force as input, offset and scaling per person; factors on the literal values\n"
    )?;
    writeln!(text, "| | fitted | standard error | the people's middle |\n|---|---|---|---|")?;
    for ((name, symbols), group) in GROUPS.iter().zip(&found.groups) {
        let Some(start) = literal.get(symbols[0]) else { continue };
        let truth = tuned.get(symbols[0]).map(|value| value / start);
        let error = group.standard_errors.as_ref().map(|errors| errors[0] / start);
        writeln!(text, "| {name} | {:.3} | {} | {} |", group.values[0] / start, figure(error), figure(truth))?;
    }
    writeln!(text, "\nR2 of all voltages {}.\n", figure(found.r2))?;
    Ok(())
}

/// A quick press: the force, and of two people measured and fitted; time constants of all.
fn quick(
    text: &mut String,
    number: u32,
    recorded: &[Recorded],
    curves: &[Vec<f64>],
    staging: &Staging,
) -> anyhow::Result<()> {
    writeln!(text, "Fig. {number}: time constants (s), loading / unloading\n")?;
    writeln!(text, "| person | measured force | photodiode | fitted model |\n|---|---|---|---|")?;
    let mut charts = Vec::new();
    for (k, (one, curve)) in recorded.iter().zip(curves).enumerate() {
        let Some(times_s) = &one.times_s else { continue };
        let measured = &one.recording.photodiodes[0].voltages_v;
        // Ends of noisy signals are means over a tenth of a second.
        let calm = |values: &[f64]| -> Vec<f64> {
            let near = |at: usize| &values[at.saturating_sub(5)..(at + 6).min(values.len())];
            (0..values.len()).map(|at| near(at).iter().sum::<f64>() / near(at).len() as f64).collect()
        };
        let constants = |values: &[f64]| {
            let values = calm(values);
            let both = [
                time_constant(times_s, &values, PRESSED_S - 0.1, RELEASED_S - 0.1).map(|constant_s| constant_s - 0.1),
                time_constant(times_s, &values, RELEASED_S - 0.1, END_S).map(|constant_s| constant_s - 0.1),
            ];
            both.map(figure).join(" / ")
        };
        writeln!(text, "| {} | {} | {} | {} |", k + 1, constants(&one.force_n), constants(measured), constants(curve))?;
        if SHOWN.contains(&k) {
            let person = format!("Person {}", k + 1);
            let force = over_time(None, times_s, &one.force_n, 2, 1);
            charts.push(chart(&format!("{person}: measured force"), "time, s", "N", vec![force]));
            let light = vec![
                over_time(Some("generated recording".to_owned()), times_s, measured, 5, 1),
                over_time(Some("fitted model under the measured force".to_owned()), times_s, curve, 1, 2),
            ];
            charts.push(chart(&format!("{person}: photodiode"), "time, s", "V", light));
        }
    }
    writeln!(text)?;
    let [png, svg] = ["png", "svg"].map(|ending| format!("fig-{number}.{ending}"));
    draw_panels(&charts, 2, 640, &staging.place(&png)?, &staging.place(&svg)?)
}
