//! Fig. 79 to 82 on generated people: static curves and quick presses, the model fitted to them as the thesis does.

use std::fmt::Write;

use lunula_hemodynamics::{
    Calibration, Collapse, FitOptions as Settings, FitResult, Free, Optics, Parameters, Recording, fit, time_constant,
};

use super::{SectionText, figure};
use crate::section::groups::GROUPS;
use crate::section::people::{PRESSED_S, Person, RELEASED_S, Recorded, ends};
use lunula::figure::{Item, draw_charts, draw_panels};
use lunula::files::Staging;
use lunula::hemodynamics::Pressed;
use lunula::hemodynamics::figures::{WIDTH, chart, line, over_time};
use lunula::hemodynamics::{own_parameters, voltages};
use lunula::words::Words;

/// A force is one of the curve's where it is so near, N.
const NEAR_N: f64 = 1e-6;
/// The people whose quick presses are drawn, as in Fig. 80 and 82, from 0.
const SHOWN: [usize; 2] = [1, 2];
/// The end of a quick press that its time constants are reported to, s.
const END_S: f64 = 4.4;

#[derive(Debug, Clone)]
pub(crate) struct QuickPress {
    /// What was recorded; it has times.
    pub(crate) recorded: Recorded,
    /// When the finger begins to press and to let go, and the end that time constants are reported to, s.
    pub(crate) moments_s: [f64; 3],
}

/// What was recorded of people who press on a photodiode's place: proximal, then distal.
#[derive(Debug, Clone, Default)]
pub(crate) struct Presses {
    /// Static curves, all over the same forces.
    pub(crate) slow: [Vec<Recorded>; 2],
    pub(crate) quick: [Vec<QuickPress>; 2],
}

/// The places that people press on.
pub(super) const SITES: [Pressed; 2] = [Pressed::Proximal, Pressed::Distal];

impl Presses {
    /// Of the thesis' eight generated people about these parameters.
    pub(super) fn generated(tuned: &Parameters) -> anyhow::Result<Self> {
        let Some(people) = Person::of_section_4_3(tuned) else { anyhow::bail!("no people about the tuned values") };
        let mut all = Self::default();
        for (k, pressed) in SITES.into_iter().enumerate() {
            for person in &people {
                all.slow[k].push(person.slowly(pressed)?);
                let recorded = person.quickly(pressed)?;
                all.quick[k].push(QuickPress { recorded, moments_s: [PRESSED_S, RELEASED_S, END_S] });
            }
        }
        Ok(all)
    }
}

/// Draws and reports Fig. 79 to 82, as far as they were recorded; `truth`: the middle of generated people.
pub(super) fn figures(
    text: &mut SectionText,
    presses: &Presses,
    truth: Option<&Parameters>,
    staging: &Staging,
) -> anyhow::Result<()> {
    let literal = &Parameters::thesis();
    let people = presses.slow.iter().map(Vec::len).chain(presses.quick.iter().map(Vec::len)).max().unwrap_or(0);
    anyhow::ensure!(people > 0, "there are no presses");
    text.numbers.set("people", people as f64);
    let optics = Optics::BeerLambert;
    let calibrated = Settings { collapse: Collapse::Contact, optics, ..Settings::default() };
    for ((number, pressed), recorded) in [79, 81].into_iter().zip(SITES).zip(&presses.slow) {
        if !recorded.is_empty() {
            slow(text, number, pressed, recorded, literal, &calibrated, truth.is_some(), staging)?;
        }
    }
    let all: Vec<Recording> = presses.quick.iter().flatten().map(|one| one.recorded.recording.clone()).collect();
    if all.is_empty() {
        return Ok(());
    }
    let free: Vec<Free> = GROUPS.iter().map(|(_, symbols)| Free::tied(symbols)).collect();
    let settings = Settings { calibration: Calibration::PerRecording, ..calibrated.clone() };
    let found = fit(&all, literal, &free, &settings)?;
    tell_fit(text, literal, truth, all.len(), &found)?;
    let fitted = |k: usize| -> anyhow::Result<Vec<f64>> {
        let own = own_parameters(&found.parameters, &found.photodiodes, k);
        Ok(voltages(&own, &all[k], Collapse::Contact, &Optics::BeerLambert)?.remove(0))
    };
    let mut first = 0;
    for (number, recorded) in [80, 82].into_iter().zip(&presses.quick) {
        let curves = (first..first + recorded.len()).map(fitted).collect::<anyhow::Result<Vec<_>>>()?;
        first += recorded.len();
        if !recorded.is_empty() {
            quick(text, number, recorded, &curves, truth.is_some(), staging)?;
        }
    }
    Ok(())
}

/// A static experiment: every person's curve, their average, and the literal model in offset and scaling to each.
#[expect(clippy::too_many_arguments, reason = "two figures report the same")]
fn slow(
    text: &mut SectionText,
    number: u32,
    pressed: Pressed,
    recorded: &[Recorded],
    literal: &Parameters,
    settings: &Settings,
    generated: bool,
    staging: &Staging,
) -> anyhow::Result<()> {
    let force_n = &recorded[0].force_n;
    let samples = force_n.len();
    let of = |one: &Recorded, k: usize| one.recording.photodiodes[0].voltages_v[k];
    let mean = |k: usize| recorded.iter().map(|one| of(one, k)).sum::<f64>() / recorded.len() as f64;
    let mut average = recorded[0].recording.clone().of("average");
    average.photodiodes[0].voltages_v = (0..samples).map(mean).collect();
    let mut recordings: Vec<Recording> = recorded.iter().map(|one| one.recording.clone()).collect();
    recordings.push(average);
    let found = fit(&recordings, literal, &[], settings)?;
    writeln!(
        text,
        "Fig. {number}: the literal model in offset and scaling to {} static curves; change over 1 and over 2 N, and \
         RMS of what is left\n",
        if generated { "generated" } else { "recorded" }
    )?;
    writeln!(
        text,
        "| | offset, V | scaling, V | change to 1 N, V | change to 2 N, V | left, % of the range \
         |\n|---|---|---|---|---|---|"
    )?;
    let mut items = Vec::new();
    for (k, recording) in recordings.iter().enumerate() {
        let measured = &recording.photodiodes[0].voltages_v;
        let own = own_parameters(&found.parameters, &found.photodiodes, k);
        let curve = voltages(&own, recording, Collapse::Contact, &Optics::BeerLambert)?.remove(0);
        let diode = found.photodiodes.iter().find(|one| one.recordings.contains(&k));
        let (low, high) = ends(measured);
        let left = measured.iter().zip(&curve).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / samples as f64;
        let name = recording.subject.clone().unwrap_or_else(|| (k + 1).to_string());
        let near = |force: f64| force_n.iter().position(|own| (own - force).abs() < NEAR_N);
        let change = |force: f64| near(force).map(|at| measured[at] - measured[0]);
        if k == recorded.len() {
            let name = |what: &str| format!("fig{number}.{what}");
            text.numbers.set(name("change_to_1N_V"), change(1.0));
            let halves = change(0.5).zip(change(1.0)).map(|(half, one)| (one - half) / half);
            text.numbers.set(name("second_half_over_first"), halves);
            let beyond = change(1.0).zip(change(2.0)).map(|(one, two)| (two - one) / one);
            text.numbers.set(name("beyond_over_up_to_1N"), beyond);
            text.numbers.set(name("left_share"), left.sqrt() / (high - low));
        }
        writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {:.1} |",
            figure(diode.map(|one| one.offset.value)),
            figure(diode.map(|one| one.scaling.value)),
            figure(change(1.0)),
            figure(change(2.0)),
            100.0 * left.sqrt() / (high - low)
        )?;
        let zero = measured[0];
        let at = |values: &[f64]| -> Vec<[f64; 2]> {
            force_n.iter().zip(values).map(|(force, value)| [*force, value - zero]).collect()
        };
        let last = k == recorded.len();
        let label = if last {
            Some("average")
        } else {
            (k == 0).then_some(if generated { "generated people" } else { "people" })
        };
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
    let place = pressed.word();
    let who = if generated { "a phantom of eight people".to_owned() } else { format!("{} people", recorded.len()) };
    let title = format!("Static, {place} force on 1 cm2: {who}");
    let y = if pressed == Pressed::Distal { "VP2 less its value at rest, V" } else { "VP1 less its value at rest, V" };
    let charts = [chart(&title, "force, N", y, items)];
    let [png, svg] = ["png", "svg"].map(|ending| format!("fig-{number}.{ending}"));
    draw_charts(&charts, WIDTH, &staging.place(&png)?, &staging.place(&svg)?)
}

fn tell_fit(
    text: &mut SectionText,
    literal: &Parameters,
    truth: Option<&Parameters>,
    presses: usize,
    found: &FitResult,
) -> anyhow::Result<()> {
    let count = if truth.is_some() && presses == 16 { "sixteen generated".to_owned() } else { presses.to_string() };
    writeln!(
        text,
        "Fig. 80 and 82: stiffness and damping fitted within tenfold to all {count} quick presses, measured force as \
         input, offset and scaling per person; factors on the literal values\n"
    )?;
    writeln!(text, "| | fitted | standard error | the people's middle |\n|---|---|---|---|")?;
    for ((name, symbols), group) in GROUPS.iter().zip(&found.groups) {
        let Some(start) = literal.get(symbols[0]) else { continue };
        let truth = truth.and_then(|truth| truth.get(symbols[0])).map(|value| value / start);
        let error = group.standard_errors.as_ref().map(|errors| errors[0] / start);
        let end = if group.at_bound.is_some() { " (at the end of its range)" } else { "" };
        writeln!(text, "| {name} | {:.3}{end} | {} | {} |", group.values[0] / start, figure(error), figure(truth))?;
    }
    writeln!(text, "\nR2 of all voltages {}.\n", figure(found.r2))?;
    Ok(())
}

/// A quick press: the force, and of two people measured and fitted; time constants of all.
fn quick(
    text: &mut SectionText,
    number: u32,
    recorded: &[QuickPress],
    curves: &[Vec<f64>],
    generated: bool,
    staging: &Staging,
) -> anyhow::Result<()> {
    writeln!(text, "Fig. {number}: time constants (s), loading / unloading\n")?;
    writeln!(text, "| person | measured force | photodiode | fitted model |\n|---|---|---|---|")?;
    let mut charts = Vec::new();
    let mut found: Vec<[[Option<f64>; 2]; 2]> = Vec::new();
    for (k, (QuickPress { recorded: one, moments_s }, curve)) in recorded.iter().zip(curves).enumerate() {
        let Some(times_s) = &one.times_s else { continue };
        let [pressed_s, released_s, end_s] = *moments_s;
        let measured = &one.recording.photodiodes[0].voltages_v;
        // Ends of noisy signals are means over a tenth of a second.
        let calm = |values: &[f64]| -> Vec<f64> {
            let near = |at: usize| &values[at.saturating_sub(5)..(at + 6).min(values.len())];
            (0..values.len()).map(|at| near(at).iter().sum::<f64>() / near(at).len() as f64).collect()
        };
        let constants = |values: &[f64]| {
            let values = calm(values);
            [
                time_constant(times_s, &values, pressed_s - 0.1, released_s - 0.1).map(|constant_s| constant_s - 0.1),
                time_constant(times_s, &values, released_s - 0.1, end_s).map(|constant_s| constant_s - 0.1),
            ]
        };
        let name = one.recording.subject.clone().unwrap_or_else(|| (k + 1).to_string());
        let own = [&one.force_n, measured, curve].map(|values| constants(values));
        let [force, light, model] = own.map(|both| both.map(figure).join(" / "));
        writeln!(text, "| {name} | {force} | {light} | {model} |")?;
        found.push([own[0], own[1]]);
        if SHOWN.contains(&k) || recorded.len() <= SHOWN[0] {
            let person = format!("Person {name}");
            let force = over_time(None, times_s, &one.force_n, 2, 1);
            charts.push(chart(&format!("{person}: measured force"), "time, s", "N", vec![force]));
            let light = vec![
                over_time(
                    Some(if generated { "generated recording" } else { "recording" }.to_owned()),
                    times_s,
                    measured,
                    5,
                    1,
                ),
                over_time(Some("fitted model under the measured force".to_owned()), times_s, curve, 1, 2),
            ];
            charts.push(chart(&format!("{person}: photodiode"), "time, s", "V", light));
        }
    }
    for (way, name) in ["loading_s", "unloading_s"].into_iter().enumerate() {
        let all: Vec<f64> = found.iter().filter_map(|own| own[1][way]).collect();
        text.numbers.set(format!("fig{number}.{name}"), all.iter().sum::<f64>() / all.len() as f64);
    }
    let ratios = found.iter().flat_map(|own| [0, 1].map(|way| own[1][way].zip(own[0][way])));
    let slowest = ratios.flatten().map(|(light, force)| light / force).reduce(f64::max);
    text.numbers.set(format!("fig{number}.slowest_over_force"), slowest);
    writeln!(text)?;
    let [png, svg] = ["png", "svg"].map(|ending| format!("fig-{number}.{ending}"));
    draw_panels(&charts, 2, 640, &staging.place(&png)?, &staging.place(&svg)?)
}
