//! The lag at which the signals of one recording best explain the channels of another.
//!
//! In: signals over the video's time (joint angles), channels over the log's (photodiodes), both at irregular times,
//! with gaps. Out: the log's time less the video's, with a standard error, and how surely it is that lag and no other;
//! or why there is none.
//!
//! Each signal alone is bent as need be ([`basis`]), or all are taken together, to explain that combination of the
//! channels' principal components which they explain best ([`line`]); drift over 30 s
//! and slower is taken off. What counts is the share that is left over and how many independent samples there are
//! ([`memory`]). All lags are looked at on a grid, with Fourier transforms; the best peaks closely; chance
//! by channels of the same kind, made as surrogates.
//!
//! What is not determined: a lag of the channels behind the signals. It is part of what is found.

mod basis;
mod chance;
mod channels;
mod coarse;
mod drift;
mod fine;
mod grid;
mod line;
mod memory;
mod series;

use clap::Args;

use self::fine::{Pair, Peak, Spot};
pub(super) use self::grid::{Candidate, Grid};
use crate::job::{not_negative, number};

/// Signals or channels over times of their own.
#[derive(Debug, Clone, Copy)]
pub struct Recording<'a> {
    /// Seconds; rows without a finite time don't count.
    pub time_s: &'a [f64],
    /// A value a time each; NaN where it is missing.
    pub columns: &'a [&'a [f64]],
}

/// Where to look.
#[derive(Debug, Clone, Copy, Default, PartialEq, Args)]
pub struct LagSearch {
    /// With correlate: the offset about which to look [default: that at which log and video begin together]
    #[arg(long = "lag-about", value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    pub about_s: Option<f64>,
    /// With correlate: how far from there to look [default: as far as half of the shorter recording overlaps]
    #[arg(long = "max-lag", value_name = "SECONDS", value_parser = not_negative)]
    pub most_s: Option<f64>,
    /// Seed of the random numbers that chance is judged with.
    #[arg(skip)]
    pub seed: u64,
}

/// A lag that explains something.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LagPeak {
    /// Log time less video time, seconds.
    pub offset_s: f64,
    /// Share of the variance of a combination of the channels that the signals explain there.
    pub explained: f64,
}

/// The lag that was found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Correlated {
    /// Log time less video time, seconds.
    pub offset_s: f64,
    /// Its standard error, from blocks of time, seconds.
    pub offset_sd_s: f64,
    /// Share of the variance of a combination of the channels that the signals explain.
    pub explained: f64,
    /// How sure it is that this is the lag and no other, 0 to 1.
    pub confidence: f64,
    /// Other lags that explain much, best first.
    pub others: Vec<LagPeak>,
    /// The lag by the first and by the second half of what overlaps; none where a half is too short to tell.
    pub halves: Option<[HalfLag; 2]>,
}

/// The lag by a part of the recordings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HalfLag {
    /// The video's time in its middle, seconds.
    pub middle_s: f64,
    /// Log time less video time, seconds.
    pub offset_s: f64,
    /// Its standard error, seconds.
    pub offset_sd_s: f64,
}

/// Peaks that are looked at closely.
const PEAKS: usize = 24;
/// Peaks that gain less than this share of the best are not.
const PEAK: f64 = 0.2;
/// The curve falls to this share of a lower peak between it and a higher one.
const VALLEY: f64 = 0.9;
/// How far around the best peak is looked at in the end: at least this share of the grid's step and so many standard
/// errors.
const NEAR: f64 = 0.25;
const NEAR_SDS: f64 = 24.0;
/// Blocks of the bootstrap.
const BLOCKS: [f64; 2] = [8.0, 60.0];
/// Less is not sure enough, by the likelihoods and by the votes of blocks of time.
const SURE: f64 = 0.99;
const VOTES: f64 = 0.95;
/// Chance does as well no more often than this.
const CHANCE: f64 = 0.001;
/// The same where the user says about where the lag is, and so that the recordings belong together.
const CHANCE_TOLD: f64 = 0.1;
/// Two peaks that gain as much as this share of each other and explain so much are of a motion that repeats itself.
const ALIKE: f64 = 0.7;
const LEAST_ALIKE: f64 = 0.5;
/// The greatest standard error, as a share of how long one independent sample takes.
const SHARP: f64 = 0.05;
/// Fewer independent samples, beyond the free numbers, prove nothing.
const LEAST_SAMPLES: f64 = 8.0;
/// Lags of halves are looked for so far away, seconds.
const HALF_AWAY_S: f64 = 0.5;
/// Less explained is not worth believing, whatever chance does.
const LEAST_EXPLAINED: f64 = 0.5;

/// Finds the lag at which `video` best explains `log`.
///
/// # Errors
/// Too little to compare, chance would explain as much, or several lags do: in words, with what to do.
pub(super) fn correlate(video: Recording<'_>, log: Recording<'_>, search: LagSearch) -> Result<Correlated, String> {
    let grid = Grid::new(video, log, &search)?;
    let Grid { video, log, .. } = &grid;
    let candidates = candidates(&grid.curve(&grid.channels));
    let Some(best) = candidates.first() else {
        return Err("at no lag that is looked at the video and the log overlap by half of the shorter; check both \
                    files, or give another offset to look about"
            .to_owned());
    };
    let most_chance = if search.about_s.is_some() && search.most_s.is_some() { CHANCE_TOLD } else { CHANCE };
    let greatest = |channels: &[Vec<f64>]| grid.curve(channels).iter().map(|at| at.gain).fold(0.0, f64::max);
    let chance = chance::probability(&grid.channels, &greatest, best.gain, search.seed);
    let alike =
        candidates.get(1).is_some_and(|next| next.gain > ALIKE * best.gain && explained(next.left) > LEAST_ALIKE);
    if (chance.is_nan() || chance > most_chance || explained(best.left) < LEAST_EXPLAINED) && !alike {
        return Err(format!(
            "the angles do not explain the photodiodes at any lag: at the best, {:.3} s, they explain {:.0} % of them, \
             as unrelated signals of the same kind would with probability {}; check that the files belong together, or \
             tie by the clock or an offset",
            grid.at_s(best.lag),
            100.0 * explained(best.left),
            if chance < 0.01 { "under 1 %".to_owned() } else { format!("{:.0} %", 100.0 * chance) }
        ));
    }
    let spots: Vec<Spot<'_>> = candidates
        .iter()
        .map(|at| Spot { offset_s: grid.at_s(at.lag), model: &grid.models[at.model], judge: grid.judge(at.model) })
        .collect();
    let overlap_s = (video.last_s() + spots[0].offset_s).min(log.last_s())
        - (video.first_s() + spots[0].offset_s).max(log.first_s());
    let each_s = grid.judge(best.model).each_s;
    let block_s = overlap_s / (overlap_s / (2.0 * each_s)).clamp(BLOCKS[0], BLOCKS[1]);
    let pair = Pair { video, log, block_s, seed: search.seed };
    let range_s = grid.lags.map(|lag| grid.at_s(lag));
    let mut peaks = different(fine::peaks(pair, &spots, 1.5 * grid.step_s, range_s), each_s);
    let spot = Spot { offset_s: peaks[0].offset_s, ..spots[peaks[0].spot] };
    // Once more, closer, where blocks agree much better than the grid's step.
    let near_s = (NEAR * grid.step_s).max(NEAR_SDS * peaks[0].offset_sd_s);
    if near_s < grid.step_s {
        let closer = fine::peaks(pair, &[spot], near_s, range_s);
        peaks[0] = Peak { votes: peaks[0].votes, ..closer[0] };
    }
    let best = peaks[0];
    let preferred = preferred(&peaks, &spots);
    let as_lag = |peak: &Peak| LagPeak { offset_s: peak.offset_s, explained: explained(peak.left) };
    if explained(best.left) < LEAST_EXPLAINED {
        return Err(format!(
            "the angles explain only {:.0} % of the photodiodes at the best lag, {:.3} s: check that the files belong \
             together, or tie by the clock or an offset",
            100.0 * explained(best.left),
            best.offset_s
        ));
    }
    if preferred < SURE || best.votes < VOTES || chance > most_chance {
        let listed: Vec<String> = peaks
            .iter()
            .take(6)
            .map(|peak| format!("{:.3} s ({:.1} %)", peak.offset_s, 100.0 * explained(peak.left)))
            .collect();
        return Err(format!(
            "several lags explain the photodiodes nearly as well: {} (log time less video time, share explained); a \
             motion that repeats itself can't \
             tell them apart: tie by the clock or an offset, or look about a known offset",
            listed.join(", ")
        ));
    }
    let samples = spot.judge.samples(best.overlap_s);
    if samples < LEAST_SAMPLES {
        return Err(format!(
            "the lag may be {:.3} s, but the finger moves too rarely or too slowly to be sure: the overlap of {:.1} s \
             is worth {:.0} independent samples \
             more than the curve takes; record for longer, or tie by the clock or an offset",
            best.offset_s, best.overlap_s, samples
        ));
    }
    if search.most_s.is_some() && range_s.iter().any(|end_s| (best.offset_s - end_s).abs() < 1.5 * grid.step_s) {
        return Err(format!(
            "the best lag, {:.3} s, is at the end of what is looked at, so a better one may lie beyond: look further, \
             or about another offset",
            best.offset_s
        ));
    }
    if best.offset_sd_s > SHARP * spot.judge.each_s {
        return Err(format!(
            "the lag is {:.3} s with a standard error of {:.3} s: the motion is too slow or too short to tell; tie by \
             the clock or an offset",
            best.offset_s, best.offset_sd_s
        ));
    }
    Ok(Correlated {
        offset_s: best.offset_s,
        offset_sd_s: best.offset_sd_s,
        explained: explained(best.left),
        confidence: (1.0 - chance) * preferred.min(best.votes),
        others: peaks[1..].iter().map(as_lag).collect(),
        halves: halves(pair, spot, best.offset_s, range_s),
    })
}

/// The lag by each half of what overlaps, looked for about `offset_s`.
fn halves(pair: Pair<'_>, spot: Spot<'_>, offset_s: f64, range_s: [f64; 2]) -> Option<[HalfLag; 2]> {
    let from_s = pair.video.first_s().max(pair.log.first_s() - offset_s);
    let to_s = pair.video.last_s().min(pair.log.last_s() - offset_s);
    let half_s = 0.5 * (to_s - from_s);
    if spot.judge.samples(half_s) < 0.5 * LEAST_SAMPLES {
        return None;
    }
    let around_s = HALF_AWAY_S.min(spot.judge.each_s);
    let of = |first_s: f64| {
        let video = pair.video.between(first_s, first_s + half_s);
        let half = Pair { video: &video, block_s: pair.block_s.min(half_s / BLOCKS[0]), ..pair };
        let peak = *fine::peaks(half, &[Spot { offset_s, ..spot }], around_s, range_s).first()?;
        let sure = explained(peak.left) >= LEAST_EXPLAINED && peak.offset_sd_s <= SHARP * spot.judge.each_s;
        let middle_s = first_s + 0.5 * half_s;
        sure.then_some(HalfLag { middle_s, offset_s: peak.offset_s, offset_sd_s: peak.offset_sd_s })
    };
    Some([of(from_s)?, of(from_s + half_s)?])
}

/// The share that is explained where `left` is the logarithm of what is left over.
pub(super) fn explained(left: f64) -> f64 {
    1.0 - left.exp()
}

/// The probability of the first peak among all by their likelihoods, each other one's as great as either its gain or
/// what it leaves over makes it.
fn preferred(peaks: &[Peak], spots: &[Spot<'_>]) -> f64 {
    let samples = |peak: &Peak| spots[peak.spot].judge.samples(peak.overlap_s);
    let best = &peaks[0];
    let other = |peak: &Peak| {
        let by_left = samples(peak).min(samples(best)) * (peak.left - best.left);
        (-0.5 * by_left.min(best.gain - peak.gain)).exp()
    };
    1.0 / (1.0 + peaks[1..].iter().map(other).sum::<f64>())
}

/// Peaks, best first, without those that climbed to one that is there already, within `apart_s`/4; they give it their
/// votes.
fn different(mut peaks: Vec<Peak>, apart_s: f64) -> Vec<Peak> {
    peaks.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.spot.cmp(&b.spot)));
    let mut taken: Vec<Peak> = Vec::new();
    for peak in peaks {
        match taken.iter_mut().find(|other| (other.offset_s - peak.offset_s).abs() < 0.25 * apart_s) {
            Some(other) => other.votes += peak.votes,
            None => taken.push(peak),
        }
    }
    taken
}

/// The highest peaks of a curve, best first, each with a valley to the ones before.
fn candidates(curve: &[Candidate]) -> Vec<Candidate> {
    let is_peak = |&k: &usize| {
        let gain = curve[k].gain;
        (k == 0 || gain > curve[k - 1].gain) && (k + 1 == curve.len() || gain >= curve[k + 1].gain)
    };
    let mut tops: Vec<usize> = (0..curve.len()).filter(is_peak).collect();
    tops.sort_by(|&a, &b| curve[b].gain.total_cmp(&curve[a].gain).then(a.cmp(&b)));
    let mut taken: Vec<usize> = Vec::new();
    for top in tops {
        if taken.first().is_some_and(|&best| curve[top].gain < PEAK * curve[best].gain) || taken.len() == PEAKS {
            break;
        }
        let apart = |&other: &usize| {
            let lowest = curve[top.min(other)..=top.max(other)].iter().map(|at| at.gain).fold(f64::INFINITY, f64::min);
            lowest < VALLEY * curve[top].gain
        };
        if taken.iter().all(apart) {
            taken.push(top);
        }
    }
    taken.into_iter().map(|top| curve[top]).collect()
}

#[cfg(test)]
mod tests;
