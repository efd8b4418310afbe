//! Figures 76 to 82 of section 4.3 made again: the thesis' simulations, and its experiments on eight generated people;
//! and of the simulations Fig. 88, the lag of 5.2.2.
//!
//! In: a folder. Out: the pictures in it, and Markdown with every number of theirs ([`section_4_3`]); the
//! same bytes each time. The simulations alone are [`section_simulations`]; the experiments on recorded people instead
//! of generated ones are [`section_presses`]. "Literal" are the thesis' orders of magnitude taken as they are printed;
//! "tuned" has stiffness and damping of capillaries and vein changed within tenfold until step responses have the time
//! constants that the thesis measured (0.16/0.12 s proximal, 0.18/0.36 s distal).

mod experiments;
mod groups;
mod kind;
mod lag;
pub(crate) mod people;
pub(crate) mod presses;
mod statics;
mod steps;
mod tune;

use std::fmt::Write;
use std::path::Path;

use lunula_hemodynamics::Parameters;

use crate::numbers::Numbers;
use crate::section::groups::{GROUPS, scaled};
use experiments::Presses;
pub(crate) use kind::{PressesJob, SectionJob};
use lunula::files::Staging;
use lunula::hemodynamics::Pressed;
use lunula::hemodynamics::Response;
use lunula::hemodynamics::figures::N_PER_CM2;
use steps::{Change, Signal, Stepped, change, steps};
use tune::{constants_s, is_at_end, tune};

/// What the thesis measured, s: proximal loading and unloading, distal loading and unloading.
const MEASURED_S: [f64; 4] = [0.16, 0.12, 0.18, 0.36];
/// The step at which the model is tuned to that, Pa.
const TUNED_AT_PA: f64 = 1e4;
/// The values as they are printed.
const LITERAL: &str = "literal";
/// Tolerance of what is drawn and written.
const RTOL: f64 = 1e-9;

/// A set of parameters with its name.
struct Named {
    name: &'static str,
    parameters: Parameters,
}

/// What is said of figures.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SectionText {
    /// Tables, as Markdown.
    pub(crate) text: String,
    /// What the thesis' words speak of, by name: `fig76.vein_um`. Of the simulations, those of the literal values.
    pub(crate) numbers: Numbers,
}

impl Write for SectionText {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.text.write_str(text)
    }
}

impl SectionText {
    /// Keeps what a signal does from the lowest to the highest load: its change, how far that is from proportional, its
    /// time constants.
    fn signal(&mut self, figure: &str, name: &str, unit: &str, changes: &[(f64, Change)]) {
        let Some(((_, first), (load_pa, last))) = changes.first().zip(changes.last()) else { return };
        if *load_pa < TUNED_AT_PA {
            return;
        }
        self.numbers.set(format!("{figure}.{name}_{unit}"), last.size);
        let before = changes.iter().rev().nth(1).map(|(_, before)| before.size);
        let increments = before.map(|before| (last.size - before) / first.size);
        self.numbers.set(format!("{figure}.{name}_disproportion"), increments.map(|ratio| (1.0 - ratio).abs()));
        for (way, k) in [("loading", 0), ("unloading", 1)] {
            self.numbers.set(format!("{figure}.{name}_{way}_low_s"), first.constants_s[k]);
            self.numbers.set(format!("{figure}.{name}_{way}_high_s"), last.constants_s[k]);
        }
    }
}

/// Draws Fig. 76 to 82 into `out`; returns their numbers as Markdown.
///
/// # Errors
/// Where a file can't be written.
pub fn section_4_3(out: &Path) -> anyhow::Result<String> {
    let staging = Staging::new(out)?;
    let mut text = SectionText::default();
    let tuned = simulations(&mut text, &staging)?;
    let presses = Presses::generated(&tuned)?;
    experiments::figures(&mut text, &presses, Some(&tuned), &staging)?;
    staging.commit()?;
    Ok(text.text)
}

/// Draws Fig. 76 to 78 into `out`.
pub(crate) fn section_simulations(out: &Path) -> anyhow::Result<SectionText> {
    let staging = Staging::new(out)?;
    let mut text = SectionText::default();
    simulations(&mut text, &staging)?;
    staging.commit()?;
    Ok(text)
}

/// Draws Fig. 79 to 82 of recorded people into `out`; what was not recorded is left out.
///
/// # Errors
/// No presses at all, a fit without an answer, or where a file can't be written.
pub(crate) fn section_presses(presses: &Presses, out: &Path) -> anyhow::Result<SectionText> {
    let staging = Staging::new(out)?;
    let mut text = SectionText::default();
    experiments::figures(&mut text, presses, None, &staging)?;
    staging.commit()?;
    Ok(text)
}

/// Fig. 76 to 78; gives the tuned parameters.
fn simulations(text: &mut SectionText, staging: &Staging) -> anyhow::Result<Parameters> {
    let literal = Parameters::thesis();
    let factors = tune(&literal, MEASURED_S, TUNED_AT_PA);
    let tuned = scaled(&literal, &factors).unwrap_or_else(|| literal.clone());
    tell_tuning(text, &literal, &tuned, &factors)?;
    let sets =
        [Named { name: LITERAL, parameters: literal.clone() }, Named { name: "tuned", parameters: tuned.clone() }];
    for set in &sets {
        figure_76(text, set, staging)?;
    }
    for set in &sets {
        figure_77(text, set, staging)?;
    }
    statics::figure_78(text, &sets, staging)?;
    lag::figure_88(text, &literal, staging)?;
    Ok(tuned)
}

/// Three digits, or a dash where nothing is known.
fn figure(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.3}"))
}

fn tell_tuning(
    text: &mut SectionText,
    literal: &Parameters,
    tuned: &Parameters,
    factors: &[f64; 4],
) -> anyhow::Result<()> {
    writeln!(text, "Time constants at {} N/cm2 (s), loading / unloading:\n", TUNED_AT_PA / N_PER_CM2)?;
    writeln!(text, "| | VP1, proximal step | VP2, distal step |\n|---|---|---|")?;
    for (name, parameters) in [("literal", literal), ("tuned", tuned)] {
        let found = constants_s(parameters, TUNED_AT_PA).unwrap_or([f64::NAN; 4]);
        let [a, b, c, d] = found.map(|value| format!("{value:.3}"));
        writeln!(text, "| {name} | {a} / {b} | {c} / {d} |")?;
    }
    let [a, b, c, d] = MEASURED_S;
    writeln!(text, "| measured in the thesis | {a} / {b} | {c} / {d} |\n")?;
    let factors: Vec<String> = GROUPS
        .iter()
        .zip(factors)
        .map(|((name, _), &factor)| format!("{name} x {factor:.3}{}", at_end(factor)))
        .collect();
    writeln!(text, "Tuned: {}.\n", factors.join(", "))?;
    Ok(())
}

/// Says of a tuned factor that a wider range would take it further.
fn at_end(factor: f64) -> &'static str {
    if is_at_end(factor) { " (at the end of its range)" } else { "" }
}

fn loads_pa() -> Vec<f64> {
    (1..=10).map(|k| 1e3 * f64::from(k)).collect()
}

/// The steps of a set that have an answer: under tuned values a vessel may close before 1 N/cm2.
fn answered(parameters: &Parameters, pressed: Pressed) -> (Vec<Stepped>, Option<f64>) {
    let mut answered = Vec::new();
    for load_pa in loads_pa() {
        match steps(parameters, pressed, &[load_pa], RTOL) {
            Ok(found) => answered.extend(found),
            Err(_) => return (answered, Some(load_pa)),
        }
    }
    (answered, None)
}

fn say_closed(text: &mut SectionText, closed: Option<f64>) -> anyhow::Result<()> {
    if let Some(load_pa) = closed {
        writeln!(text, "\nFrom {} N/cm2 on, the model has no answer: a vessel closes.", load_pa / N_PER_CM2)?;
    }
    writeln!(text)?;
    Ok(())
}

/// Steps on the proximal surface.
fn figure_76(text: &mut SectionText, set: &Named, staging: &Staging) -> anyhow::Result<()> {
    let parameters = &set.parameters;
    let title = format!("Steps in PF1, {} values: capillaries (C1 and C2 alike)", set.name);
    let (capillary, vein) =
        (|of: &Response| of.diameters_um(parameters, 0), |of: &Response| of.diameters_um(parameters, 2));
    let signals = [
        Signal { title: &title, y: "diameter, um", name: "capillary", unit: "um", of: &capillary },
        Signal { title: "Vein", y: "diameter, um", name: "vein", unit: "um", of: &vein },
        Signal { title: "Photodiode", y: "VP1, V", name: "VP1", unit: "V", of: &light(0) },
    ];
    let words = "a step in P_F1; changes of diameters (um) and of VP1 (mV per volt of scaling), time constants of \
                 loading / unloading (s)";
    figure_of_steps(text, 76, set, Pressed::Proximal, words, &signals, staging)
}

/// Steps on both surfaces.
fn figure_77(text: &mut SectionText, set: &Named, staging: &Staging) -> anyhow::Result<()> {
    let title = format!("Steps in PF1 and PF2, {} values: proximal photodiode", set.name);
    let signals = [
        Signal { title: &title, y: "VP1, V", name: "VP1", unit: "V", of: &light(0) },
        Signal { title: "Distal photodiode", y: "VP2, V", name: "VP2", unit: "V", of: &light(1) },
    ];
    let words = "a step in P_F1 and P_F2; changes (mV per volt of scaling), time constants of loading / unloading (s)";
    figure_of_steps(text, 77, set, Pressed::Both, words, &signals, staging)
}

fn light(unit: usize) -> impl Fn(&Response) -> Vec<f64> {
    move |response| response.photodiode_v(unit)
}

/// Draws and reports what signals do under steps of all loads.
fn figure_of_steps(
    text: &mut SectionText,
    number: u32,
    set: &Named,
    pressed: Pressed,
    words: &str,
    signals: &[Signal<'_>],
    staging: &Staging,
) -> anyhow::Result<()> {
    let (stepped, closed) = answered(&set.parameters, pressed);
    let [png, svg] = ["png", "svg"].map(|ending| format!("fig-{number}-{}.{ending}", set.name));
    steps::draw(&stepped, signals, &staging.place(&png)?, &staging.place(&svg)?)?;
    writeln!(text, "Fig. {number}, {} values: {words}\n", set.name)?;
    let names = signals.iter().map(|signal| signal.name).collect::<Vec<_>>().join(" | ");
    writeln!(text, "| N/cm2 | {names} | {names} |\n|{}", "---|".repeat(1 + 2 * signals.len()))?;
    let mut changes: Vec<Vec<(f64, Change)>> = vec![Vec::new(); signals.len()];
    for one in &stepped {
        let (mut sizes, mut constants) = (Vec::new(), Vec::new());
        for (signal, changes) in signals.iter().zip(&mut changes) {
            let own = change(&one.response.times_s, &(signal.of)(&one.response));
            sizes.push(format!("{:.3}", if signal.unit == "V" { 1e3 * own.size } else { own.size }));
            constants.push(own.constants_s.map(figure).join(" / "));
            changes.push((one.load_pa, own));
        }
        writeln!(text, "| {} | {} | {} |", one.load_pa / N_PER_CM2, sizes.join(" | "), constants.join(" | "))?;
    }
    if set.name == LITERAL {
        for (signal, all) in signals.iter().zip(&changes) {
            text.signal(&format!("fig{number}"), signal.name, signal.unit, all);
        }
    }
    say_closed(text, closed)
}
