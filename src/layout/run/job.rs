//! The layout job: inputs and options in, places with errors and pictures out; the one entry that command line and
//! pipelines call.

use std::sync::atomic::{AtomicU64, Ordering};

use lunula_predictor::{Candidate, Criterion, LayoutProblem};
use rayon::prelude::*;

use super::plan::steps;
use super::report::{ChosenFigures, LayoutFigures, LayoutReport, MethodFigures};
use super::results::{POSITIONS, TABLE, write};
use crate::files::{Places, WriteError, is_same_file};
use crate::job::{Outputs, Report, Watch};
use crate::layout::draw::{draw_errors, draw_places};
use crate::layout::error::LayoutError;
use crate::layout::options::{LayoutInputs, LayoutOptions};
use crate::layout::read::{Given, Target, is_maps, is_photodiode, read};
use crate::layout::solve::{Method, Solved, Solver, smallest_sufficient, thesis};
use crate::nail::{Position, Positions};
use crate::stages::{Stages, left_out};

const REPORT: &str = "run.json";
/// An error above this share of that of no photodiode at all is hardly one of any (assumed).
const HARDLY: f64 = 0.95;

/// The thesis' eight are drawn and judged where every candidate for one is this near to it, half widths (assumed: a
/// cell of a grid of 16 x 16 reaches 0.11 from its middle to its corner).
const NEAR: f64 = 0.25;

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`LayoutError`] where there are no results.
pub fn run(
    inputs: &LayoutInputs,
    options: &LayoutOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<LayoutReport, LayoutError> {
    let stages = Stages::default();
    let folder = &outputs.out;
    let mut places = Places::not_over(inputs.data.iter().map(|input| &input.path).chain(&inputs.positions));
    places.check([POSITIONS, TABLE, REPORT].map(|name| folder.join(name)))?;
    // The report of what is read has the same name.
    if let Some(input) = inputs.data.iter().find(|input| is_same_file(&input.path, folder)) {
        return Err(WriteError::Input(input.path.clone()).into());
    }
    let given = stages.time("read", || read(inputs, options))?;
    watch.go_on()?;
    let keep = asked(&given, options)?;
    let all = given.problem(options)?;
    let solver = Solver::new(&given, options, keep, &all);
    let done = AtomicU64::new(0);
    let each = |&k: &usize| {
        watch.go_on()?;
        let solved = solver.of(k);
        (watch.tick)(done.fetch_add(1, Ordering::Relaxed) + 1, Some(options.k.0.len() as u64));
        Ok((k, solved))
    };
    let found: Vec<(usize, Vec<Solved>)> =
        stages.time("search", || options.k.0.par_iter().map(each).collect::<Result<_, LayoutError>>())?;
    let lacking: Vec<String> = found.iter().filter(|(_, own)| own.is_empty()).map(|(k, _)| k.to_string()).collect();
    let mut solved: Vec<Solved> = found.into_iter().flat_map(|(_, own)| own).collect();
    let rules = format!("{} mm apart{}", options.apart, if options.mirror { ", left and right alike" } else { "" });
    if solved.is_empty() {
        let what = format!("no {} of {} candidates lie {rules}; lower --apart or --k", options.k, given.places.len());
        return Err(LayoutError::Request(what));
    }
    let (mut notes, mut warnings) = (notes_of(&given), given.warnings.clone());
    if !lacking.is_empty() {
        notes.push(format!("no layout of {} photodiodes: no so many candidates lie {rules}", lacking.join(", ")));
    }
    let thesis = thesis(&given).filter(|(_, farthest)| *farthest <= NEAR);
    match &thesis {
        Some((eight, _)) => solved.push(solver.fixed(Method::Thesis, eight.clone())),
        None => notes.push("the thesis' eight are left out: no candidate is near to some of them".to_owned()),
    }
    if given.rows > given.places.len() + 1 {
        solved.push(solver.fixed(Method::All, (0..given.places.len()).collect()));
    } else {
        warnings.push(format!(
            "no figure of all {} candidates together: {} rows do not determine a model of so many",
            given.places.len(),
            given.rows
        ));
    }
    if given.parts() == 0 {
        notes.push("no intervals: there is one person, or leaving one out leaves too few".to_owned());
    }
    watch.go_on()?;
    let chosen = chosen(&given, &all, &solved, options)?;
    let of_none = all.cost(&[]);
    let best = solved.iter().find(|one| one.method == Method::Best && one.k == chosen.k);
    if let Some(own) = best.and_then(|one| one.left_out).filter(|own| own.error + own.se >= of_none) {
        warnings.push(format!(
            "the places chosen may say nothing of who is left out: their error is {:.3} +- {:.3}, and {of_none} \
             without any photodiode",
            own.error, own.se
        ));
    } else if let Some(best) = best.filter(|best| best.choice.cost > HARDLY * of_none) {
        warnings.push(format!(
            "no places say much: the error of the best {} is {:.3}, and {of_none} without any photodiode; are the \
             targets those of these readings, and is --noise in the readings' unit?",
            chosen.k, best.choice.cost
        ));
    }
    warnings.extend(best.and_then(|best| crowded(&given, &best.choice.places, options)));
    let of_thesis = thesis.map(|(eight, _)| eight).unwrap_or_default();
    let figures = LayoutFigures {
        folder: folder.clone(),
        error_is: match given.criterion {
            Criterion::Error => "RMSE of the linear model over the target's SD, mean over targets and persons",
            Criterion::Confusion => "the most that two poses are confused (Bhattacharyya), mean over pairs",
        },
        error_of_none: of_none,
        candidates: given.places.len(),
        left_out_candidates: given.left_out,
        persons: given.persons.clone(),
        targets: given.targets.iter().map(|target| target.name.clone()).collect(),
        methods: solved.iter().map(|one| figures_of(&given, one)).collect(),
        chosen,
    };
    write(&figures, &mut places)?;
    let mut pictures = Vec::new();
    if outputs.figures {
        // Named after the folder's tables, not after one of them.
        for (name, draw) in [("layout", true), ("error-against-k", false)] {
            let [png, svg] = ["png", "svg"].map(|ending| folder.join(format!("{name}.{ending}")));
            let at = [places.place(&png)?, places.place(&svg)?];
            stages
                .time("figures", || match draw {
                    true => draw_places(&given, &all, &figures, &of_thesis, options, &at),
                    false => draw_errors(&figures, &at),
                })
                .map_err(|why| LayoutError::input(&png, format!("{why:#}")))?;
            pictures.push(png);
        }
    }
    let maps = matches!(&inputs.data[..], [one] if is_maps(&one.path));
    let left_out = left_out(steps(inputs.data.len(), maps, options, outputs));
    let mut report = Report { left_out, warnings, notes, pictures, ..Report::new("layout", watch, figures) };
    if maps {
        report.unused_input("positions", inputs.positions.is_some(), "maps of photographs have no photodiodes");
        report.unused(
            &["targets", "grid", "columns", "stream"],
            "maps of photographs have poses, and cells of their own",
        );
    } else {
        report.unused(&["cells"], "the candidates are the columns of the tables");
        if given.places.iter().all(|place| is_photodiode(&place.name)) {
            report.unused(&["grid"], "the candidates are photodiodes");
        }
    }
    Ok(report.timed(&stages).commit(places, outputs.report.then(|| folder.join(REPORT)).as_deref())?)
}

/// What to say of chosen places that are nearer to each other than `--apart`: kept ones and their mirror images.
fn crowded(given: &Given, chosen: &[usize], options: &LayoutOptions) -> Option<String> {
    let places: Vec<Candidate> = chosen.iter().map(|&place| given.places[place].candidate(options)).collect();
    let pairs = places.iter().enumerate().flat_map(|(k, one)| places[..k].iter().map(move |other| (other, one)));
    let distances = pairs.map(|(a, b)| (a, b, (a.across_mm - b.across_mm).hypot(a.along_mm - b.along_mm)));
    let (a, b, mm) = distances.min_by(|a, b| a.2.total_cmp(&b.2))?;
    (mm < options.apart * (1.0 - 1e-9)).then(|| {
        format!(
            "{} and {} are {mm:.2} mm apart, and --apart is {} mm: places that --keep names, and their mirror images, \
             stay where they are; name others, where photodiodes have to fit beside each other",
            a.name, b.name, options.apart
        )
    })
}

/// What reading said, and which candidates it left out.
fn notes_of(given: &Given) -> Vec<String> {
    let mut notes = given.notes.clone();
    let out = given.left_out;
    if out.edge + out.missing + out.constant > 0 {
        notes.push(format!(
            "{} candidates are chosen from; left out are {} too near to the edge or outside, {} missing in too many \
             rows, {} the same in all rows",
            given.places.len(),
            out.edge,
            out.missing,
            out.constant
        ));
    }
    notes
}

/// The numbers of the places that every layout has; numbers of photodiodes that can't be are refused.
fn asked(given: &Given, options: &LayoutOptions) -> Result<Vec<usize>, LayoutError> {
    let refused = |what: String| Err(LayoutError::Request(what));
    let largest = options.k.0.last().copied().unwrap_or(1);
    if largest > given.places.len() {
        return refused(format!(
            "--k: {largest} photodiodes are more than the {} candidates; lower --k, or give more places",
            given.places.len()
        ));
    }
    if let Some(k) = options.choose.filter(|k| !options.k.0.contains(k)) {
        return refused(format!("--choose {k}: is not among --k {}; choose one of these", options.k));
    }
    let mut keep = Vec::new();
    for name in &options.keep {
        match given.places.iter().position(|place| place.name == *name) {
            Some(at) => keep.push(at),
            None => {
                let names: Vec<&str> = given.places.iter().map(|place| place.name.as_str()).take(8).collect();
                return refused(format!("--keep: {name} is not a candidate; they are {}, ..", names.join(", ")));
            }
        }
    }
    if keep.len() > options.k.0[0] {
        return refused(format!("--keep names {} places, more than the smallest --k, {}", keep.len(), options.k.0[0]));
    }
    Ok(keep)
}

/// The layout of `layout.json`.
fn chosen(
    given: &Given,
    all: &LayoutProblem,
    solved: &[Solved],
    options: &LayoutOptions,
) -> Result<ChosenFigures, LayoutError> {
    let best = || solved.iter().filter(|one| one.method == Method::Best);
    let largest = best().map(|one| one.k).max().unwrap_or(1);
    let (k, why) = match (options.choose, smallest_sufficient(solved)) {
        (Some(k), _) => (k, "--choose".to_owned()),
        (None, Some((k, than))) => (k, format!("the smallest within a standard error of {than}")),
        (None, None) => (largest, "no intervals to judge by: the largest".to_owned()),
    };
    let Some(one) = best().find(|one| one.k == k) else {
        return Err(LayoutError::Request(format!(
            "--choose {k}: no {k} candidates keep their distance; lower --apart"
        )));
    };
    let names: Vec<String> = one.choice.places.iter().map(|&at| given.places[at].name.clone()).collect();
    let position = |(number, &at): (usize, &usize)| {
        let place = &given.places[at];
        Position { name: format!("P{}", number + 1), u: place.u, v: place.v }
    };
    let positions = Positions {
        name: format!("lunula layout: {k} of {} candidates", given.places.len()),
        nail_width_mm: options.nail_width,
        diameter_mm: options.diameter.min(0.5 * options.nail_width),
        photodiodes: one.choice.places.iter().enumerate().map(position).collect(),
    };
    let explained = all.explained(&one.choice.places);
    let of = |(column, target): (usize, &Target)| {
        let value = match given.criterion {
            Criterion::Error => {
                let each = explained.iter().zip(&target.sd).map(|(q, sd)| sd * (1.0 - q[column]).max(0.0).sqrt());
                each.sum::<f64>() / explained.len() as f64
            }
            Criterion::Confusion => explained[0][column].sqrt(),
        };
        (target.name.clone(), value)
    };
    Ok(ChosenFigures {
        k,
        why,
        candidates: names,
        positions,
        by_target: given.targets.iter().enumerate().map(of).collect(),
    })
}

fn figures_of(given: &Given, one: &Solved) -> MethodFigures {
    let names = one.choice.places.iter().map(|&at| given.places[at].name.clone());
    MethodFigures {
        k: one.k,
        method: one.method,
        error: one.choice.cost,
        left_out: one.left_out,
        bound: one.proof.as_ref().map(|proof| proof.bound),
        optimal: one.proof.as_ref().map(|proof| proof.optimal),
        nodes: one.proof.as_ref().map(|proof| proof.nodes),
        places: if one.method == Method::All { Vec::new() } else { names.collect() },
    }
}
