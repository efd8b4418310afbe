//! From the rows that are kept of all frames to the traces in which presses are looked for.

use super::results::Kept;
use super::tint::{Ratios, tints};
use crate::median::{ends as ends_of, median_of};
use crate::nail::Positions;
use crate::nailvideo::options::Light;
use crate::nailvideo::press::Trace;
use crate::nailvideo::sample::Sampled;

/// Of each photodiode, and what a change of all light is in their unit; `enlarged` is what compression multiplies their
/// noise by.
pub(super) fn traces(names: &[String], kept: &[Kept], light: Light, enlarged: f64) -> (Vec<Trace>, f64) {
    let read = |k: usize, of: &dyn Fn(&Sampled) -> f64| -> Vec<f64> {
        let reading = |row: &Kept| row.readings.get(k).and_then(|one| one.ok());
        kept.iter().map(|row| reading(row).map_or(f64::NAN, |one| of(&one))).collect()
    };
    let values: Vec<Vec<f64>> = (0..names.len()).map(|k| read(k, &|one| one.value)).collect();
    let whole = match light {
        Light::None => middle(values.iter().flatten().copied()).unwrap_or(1.0),
        Light::Red | Light::Skin => 100.0,
    };
    let red = |k: usize| read(k, &|one| whole * f64::from(one.red));
    let ratios = |k: usize| {
        let [green, blue] = [0, 1].map(|of| read(k, &|one| 100.0 * f64::from(one.ratios[of])));
        let [_, steady_sd] = ends_of(read(k, &|one| 100.0 / whole * f64::from(one.steady_sd)));
        Ratios { green, blue, steady_sd }
    };
    let ratios: Vec<Ratios> = (0..names.len()).map(ratios).collect();
    let tints = tints(&ratios, enlarged, light == Light::Skin);
    let trace = |((k, values), tint): ((usize, Vec<f64>), Vec<f64>)| Trace {
        name: names[k].clone(),
        values,
        red: red(k),
        tint: tint.into_iter().map(|by| 0.01 * whole * by).collect(),
    };
    (values.into_iter().enumerate().zip(tints).map(trace).collect(), whole)
}

/// Means of the photodiodes toward each end of the nail, where all of them have a value.
pub(super) fn ends(positions: &Positions, traces: &[Trace]) -> Vec<Trace> {
    let end = |name: &str, is_there: &dyn Fn(f64) -> bool| {
        let members: Vec<&Trace> =
            positions.photodiodes.iter().zip(traces).filter(|(one, _)| is_there(one.v)).map(|(_, t)| t).collect();
        let mean = |of: fn(&Trace) -> &[f64]| -> Vec<f64> {
            let rows = members.first().map_or(0, |t| of(t).len());
            (0..rows).map(|row| members.iter().map(|t| of(t)[row]).sum::<f64>() / members.len() as f64).collect()
        };
        let trace = || Trace {
            name: name.to_owned(),
            values: mean(|t| &t.values),
            red: mean(|t| &t.red),
            tint: mean(|t| &t.tint),
        };
        (members.len() > 1).then(trace)
    };
    [end("distal", &|v| v > 0.0), end("proximal", &|v| v < 0.0)].into_iter().flatten().collect()
}

/// Readings that all differ by less than this share of their noise are of one picture: of 240 frames of phantoms none
/// or one are by chance; of fewer photodiodes than this more would be.
const SAME: f64 = 0.05;
const COMPARED: usize = 3;
/// So many of those, and a change of so many times the noise behind one, are no chance.
const REPEATED: usize = 4;
const JUMP: f64 = 5.0;

/// What to say where pictures repeat the one before and the nail goes on changing: a camera that stood still, or
/// fifteen pictures a second in a file of thirty. Measured on ten such videos of a phantom, encoded in four ways: in
/// presses of one that stood still for 0.4 s time constants are up to 5.8 times too short, and said to be known.
pub(super) fn repeated(traces: &[Trace], noise: &[Option<f64>], index: impl Fn(usize) -> u64) -> Option<String> {
    let frames = traces.first()?.values.len();
    let change = |frame: usize| {
        let of = |(trace, noise): (&Trace, &Option<f64>)| {
            let change = (trace.values[frame] - trace.values[frame - 1]).abs() / (*noise)?;
            change.is_finite().then_some(change)
        };
        let all: Vec<f64> = traces.iter().zip(noise).filter_map(of).collect();
        (all.len() >= COMPARED).then(|| all.into_iter().fold(0.0, f64::max))
    };
    let changes: Vec<Option<f64>> = (1..frames).map(change).collect();
    let is_same = |change: &Option<f64>| change.is_some_and(|change| change < SAME);
    let same: Vec<usize> = (0..changes.len()).filter(|&k| is_same(&changes[k])).collect();
    let behind = changes.windows(2).filter(|pair| is_same(&pair[0])).filter_map(|pair| pair[1]);
    let jump = behind.reduce(f64::max)?;
    (same.len() >= REPEATED && jump > JUMP).then(|| {
        format!(
            "{} frames, the first is frame {}, repeat the picture before, and one behind them differs by {jump:.0} \
             times the noise: a camera that stood still, or fewer pictures a second than the file says? Onsets and \
             time constants of presses.csv are wrong by as much",
            same.len(),
            index(same[0] + 1)
        )
    })
}

/// In the median of photodiodes, a leap from frame to frame of this share of how far each goes, and of so many times
/// the largest of the two frames before and behind, is none of blood (phantoms as they are, of 10 and 30 frames a
/// second, with light and exposure that drift: 0.33 and 1.8 at most; with seconds cut out of a press 0.63 to 0.88 and
/// 10 to 127).
const LEAP: f64 = 0.25;
const LEAPS: f64 = 5.0;
/// ... and of so many standard errors (three nails filmed at rest leap at key frames by 1.1 at most, one that is
/// pressed faintly by 1.8; where 20 frames are left out as a press begins, seven films of presses leap by 2.7 to 26).
const LEAP_SDS: f64 = 2.5;

/// What to say where all photodiodes leap in one frame, and go on quietly: times behind it are not the film's. `sd` is
/// the standard error of each.
pub(super) fn leaps(traces: &[Trace], sd: &[Option<f64>], index: impl Fn(usize) -> u64) -> Option<String> {
    let spans: Vec<f64> =
        traces.iter().map(|trace| ends_of(trace.values.iter().copied())).map(|[a, b]| b - a).collect();
    let in_units_of = |frame: usize, units: &dyn Fn(usize) -> f64| {
        let of = |(k, trace): (usize, &Trace)| (trace.values[frame] - trace.values[frame - 1]).abs() / units(k);
        let known: Vec<f64> = traces.iter().enumerate().map(of).filter(|change| change.is_finite()).collect();
        median_of(known.iter().copied()).filter(|_| known.len() >= COMPARED)
    };
    let change = |frame: usize| in_units_of(frame, &|k| spans[k]);
    let is_certain =
        |frame: usize| in_units_of(frame, &|k| sd[k].unwrap_or(f64::NAN)).is_some_and(|sds| sds > LEAP_SDS);
    let frames = traces.first()?.values.len();
    let changes: Vec<Option<f64>> = (1..frames).map(change).collect();
    let leap = |around: &[Option<f64>]| {
        let [a, b, own, c, d] = <[Option<f64>; 5]>::try_from(around).ok()?;
        let beside = [a?, b?, c?, d?].into_iter().fold(0.0, f64::max);
        own.filter(|own| *own > LEAP && *own > LEAPS * beside)
    };
    let all = changes.windows(5).enumerate().filter_map(|(k, around)| Some((k + 3, leap(around)?)));
    let all: Vec<(usize, f64)> = all.filter(|(frame, _)| is_certain(*frame)).collect();
    let (first, share) = *all.first()?;
    Some(format!(
        "the photodiodes leap by {:.0} % of all that they change, from one frame to the next, in {} place(s), the \
         first before frame {}: was the video cut there, or has it too few pictures a second? Onsets and time \
         constants of presses.csv are then not the nail's",
        100.0 * share,
        all.len(),
        index(first)
    ))
}

/// The median of what is known.
pub(super) fn middle(all: impl Iterator<Item = f64>) -> Option<f64> {
    median_of(all.filter(|value| value.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of three photodiodes at 30 frames a second; frame k shows the picture `shown(k)`.
    fn said(shown: impl Fn(usize) -> usize) -> Option<String> {
        let noise = |k: usize| 0.1 * ((((k * 7919 + 31) * (k + 17)) % 2003) as f64 / 1001.0 - 1.0);
        let press = |k: usize| 20.0 * (1.0 - (-(k.saturating_sub(60) as f64) / 6.0).exp());
        let trace = |name: &str, of: &dyn Fn(usize) -> f64| Trace {
            name: name.to_owned(),
            // Encoded again, a value moves a little.
            values: (0..150).map(|frame| of(shown(frame)) + 1e-3 * (frame % 3) as f64).collect(),
            red: Vec::new(),
            tint: Vec::new(),
        };
        let traces = [
            trace("P1", &|k| press(k) + noise(k)),
            trace("P2", &|k| noise(2 * k + 1) - 0.5 * press(k)),
            trace("P3", &|k| noise(3 * k + 2)),
        ];
        assert_eq!(repeated(&traces[..2], &[Some(0.06); 2], |row| row as u64), None, "two may agree by chance");
        repeated(&traces, &[Some(0.06); 3], |row| row as u64)
    }

    #[test]
    fn a_video_that_was_cut_in_a_press_is_seen() {
        let leaps_of = |shown: &dyn Fn(usize) -> usize, sd: f64| {
            let noise = |k: usize| 0.1 * ((((k * 7919 + 31) * (k + 17)) % 2003) as f64 / 1001.0 - 1.0);
            let press = |k: usize| 20.0 * (1.0 - (-(k.saturating_sub(60) as f64) / 6.0).exp());
            let traces = [1.0, -0.5, 0.7].map(|by| {
                let values = (0..150).map(|frame| by * press(shown(frame)) + noise(frame)).collect();
                Trace { name: "P1".to_owned(), values, red: Vec::new(), tint: Vec::new() }
            });
            leaps(&traces, &[Some(sd); 3], |row| row as u64)
        };
        let said = |shown: &dyn Fn(usize) -> usize| leaps_of(shown, 0.5);
        assert_eq!(said(&|k| k), None);
        assert_eq!(said(&|k| 3 * k), None, "10 frames a second");
        let cut = said(&|k| if k < 62 { k } else { k + 20 }).expect("it was cut");
        assert!(cut.contains("in 1 place(s), the first before frame 62"), "{cut}");
        // As a nail at rest at a key frame, where all changes are a few standard errors.
        assert_eq!(leaps_of(&|k| if k < 62 { k } else { k + 20 }, 8.0), None);
    }

    #[test]
    fn pictures_that_repeat_while_the_nail_changes_are_seen() {
        assert_eq!(said(|k| k), None);
        assert_eq!(said(|k| if (5..25).contains(&k) { 4 } else { k }), None, "a camera that stood still in a rest");
        let stalled = said(|k| if (60..72).contains(&k) { 59 } else { k }).expect("it stood still in a press");
        assert!(stalled.starts_with("12 frames, the first is frame 60, repeat the picture before"), "{stalled}");
        assert!(said(|k| k / 2 * 2).is_some_and(|said| said.starts_with("75 frames, the first is frame 1,")));
    }
}
