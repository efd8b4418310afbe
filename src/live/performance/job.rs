//! The performance job: a table of trials in, figures, tables and pictures out.

use std::collections::BTreeMap;
use std::path::Path;

use lunula_live::performance::Course;

use super::options::PerformanceOptions;
use super::read::{Row, Trials, read};
use super::report::{PerformanceFigures, PerformanceReport};
use super::tables::{MEANS, ROWS, write_means, write_rows};
use super::{analysis, figures};
use crate::files::{Places, json_text};
use crate::job::{Outputs, Report, Watch};
use crate::live::error::LiveError;
use crate::median::median_of;
use crate::stages::{Stages, Step, left_out};
use crate::words::{instead, twins};

pub(super) const FIGURES: &str = "performance.json";
/// The report, with places and times.
const REPORT: &str = "run.json";

/// What would be done and what not.
#[must_use]
pub fn plan(outputs: &Outputs) -> Vec<Step> {
    let rows = outputs.rows;
    let why = if rows { "of each row" } else { "not asked for" };
    vec![
        Step::new("read", true, "a table of trials".to_owned()),
        Step::new("means", true, "over operators, by method and trial".to_owned()),
        Step::new("learning curves", true, "exponential and power law".to_owned()),
        Step::new("comparison", true, "of each method with the baseline".to_owned()),
        Step::new("time per decision", rows, why.to_owned()),
        Step::figures(outputs.figures, "by operator, and means with curves"),
    ]
}

/// Runs the job on a table that results call `name`; every result is in its place when it returns.
///
/// # Errors
/// [`LiveError`] where there are no results.
pub fn run(
    data: &Path,
    name: &str,
    options: &PerformanceOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<PerformanceReport, LiveError> {
    let stages = Stages::default();
    let folder = &outputs.out;
    let mut places = Places::not_over([data]);
    places.check([FIGURES, MEANS, ROWS, REPORT].map(|name| folder.join(name)))?;
    let course = options.course();
    let trials = stages.time("read", || read(data, name, &course))?;
    let baseline = baseline(options, &trials, name)?;
    watch.go_on()?;
    let figures = stages.time("figures of merit", || analysis::figures(name, &trials, course, baseline));
    places.write(&folder.join(FIGURES), &json_text(&figures))?;
    stages.time("tables", || {
        write_means(&figures, folder, &mut places)?;
        if outputs.rows { write_rows(&trials, folder, &mut places) } else { Ok(()) }
    })?;
    watch.go_on()?;
    let mut pictures = Vec::new();
    if outputs.figures {
        let beside = folder.join(FIGURES);
        stages.time("figures", || {
            let mut draw = |kind: &str, draw: &dyn Fn(&Path, &Path) -> anyhow::Result<()>| {
                places.draw(&beside, kind, draw).map(|picture| pictures.push(picture))
            };
            draw("methods", &|png, svg| figures::draw_methods(&figures, png, svg))?;
            draw("operators", &|png, svg| figures::draw_operators(&trials, png, svg))
        })?;
    }
    let left_out = left_out(plan(outputs));
    let (notes, warnings) = (notes(&figures, outputs), warnings(&trials, &course));
    let report = Report {
        left_out,
        notes,
        warnings,
        pictures,
        failed: trials.impossible,
        ..Report::new("performance", watch, figures)
    };
    Ok(report.timed(&stages).commit(places, outputs.report.then(|| folder.join(REPORT)).as_deref())?)
}

/// Which method the others are compared with.
fn baseline(options: &PerformanceOptions, trials: &Trials, name: &str) -> Result<usize, LiveError> {
    let Some(baseline) = &options.baseline else { return Ok(0) };
    trials.methods.iter().position(|method| method == baseline).ok_or_else(|| {
        let known: Vec<&str> = trials.methods.iter().map(String::as_str).collect();
        LiveError::Faults(vec![format!(
            "{name}: has no method `{baseline}` of --baseline; {}",
            instead(baseline, &known)
        )])
    })
}

/// A decision of more seconds was logged in another unit (assumed: those of appendix C take 0.3 to 3 s).
const LONG_S: f64 = 100.0;

/// Driving alone is so little of a trial where its speed is in another unit (assumed: in appendix C it is most of it).
const LITTLE: f64 = 0.01;

/// What a person may have slipped in.
fn warnings(trials: &Trials, course: &Course) -> Vec<String> {
    let name = |(what, names): (&str, &[String])| twins(what, names.iter().map(String::as_str));
    let named = [("operators", &trials.operators[..]), ("methods", &trials.methods[..])].into_iter().filter_map(name);
    // One operator's log may be of another program.
    let long = trials.operators.iter().enumerate().filter_map(|(k, operator)| {
        let own = trials.rows.iter().filter(|row| row.operator == k);
        let median_s = median_of(own.map(|row| row.decision_s)).filter(|median| *median > LONG_S)?;
        Some(format!("half of the decisions of {operator} took {median_s:.0} s or more: is time_s in ms?"))
    });
    let median_s = median_of(trials.rows.iter().map(|row| row.time_s));
    let little = median_s.filter(|median_s| course.shortest_s() < LITTLE * median_s).map(|median_s| {
        format!(
            "driving alone takes {:.3} s of {median_s:.0} s in the median of all trials: are --path-m in metres and \
             --speed-mps in metres a second?",
            course.shortest_s()
        )
    });
    let operators = copied(&trials.operators, trials, |row| (row.operator, row.method));
    let methods = copied(&trials.methods, trials, |row| (row.method, row.operator));
    let slips = unlike(trials).into_iter().chain(stopped(trials)).chain(cumulative(trials, course));
    let slips = slips.chain(counted_on(trials)).chain(kept(trials)).chain(ended_early(trials));
    named.chain(long).chain(little).chain(slips).chain(operators).chain(methods).collect()
}

/// A decision is unlike the others where its logarithm differs by more than this, and by so many times their usual
/// difference, from its trial's and its operator's median (assumed: a slip in a digit gives 2.3; trials that differ by
/// 15 % from operator to operator 0.2).
const UNLIKE: f64 = 0.7;
const TIMES: f64 = 8.0;
/// Fewer operators of a trial have no usual one, and fewer rows no usual difference.
const OPERATORS: usize = 3;
const FEW: usize = 10;

/// Rows that are far from their trial's others, as by a slip of the pen.
fn unlike(trials: &Trials) -> Option<String> {
    let known = trials.rows.iter().filter(|row| row.decision_s > 0.0);
    let mut off: Vec<(&Row, f64)> = known.map(|row| (row, row.decision_s.ln())).collect();
    let mut centre = |of: fn(&Row) -> (usize, u32), fewest: usize| {
        let mut groups: BTreeMap<(usize, u32), Vec<f64>> = BTreeMap::new();
        off.iter().for_each(|(row, off)| groups.entry(of(row)).or_default().push(*off));
        let usual = |row: &Row| {
            let group = groups.get(&of(row)).filter(|group| group.len() >= fewest)?;
            median_of(group.iter().copied())
        };
        off.retain_mut(|(row, off)| usual(row).map(|usual| *off -= usual).is_some());
    };
    centre(|row| (row.method, row.trial), OPERATORS);
    centre(|row| (row.operator, 0), 1);
    let usual = median_of(off.iter().map(|(_, off)| off.abs())).filter(|_| off.len() >= FEW)?;
    let far: Vec<&(&Row, f64)> = off.iter().filter(|(_, off)| off.abs() > UNLIKE.max(TIMES * usual)).collect();
    let (row, by) = far.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let more = if far.len() > 1 { format!(" ({} more rows alike)", far.len() - 1) } else { String::new() };
    Some(format!(
        "a decision of {} took {:.2} s in trial {} with {}, {:.1} times what the others lead to expect{more}: is it a \
         slip? One row may turn every statement",
        trials.operators[row.operator],
        row.decision_s,
        row.trial,
        trials.methods[row.method],
        by.exp()
    ))
}

/// So many trials of exactly the greatest time, and so many times as many as have any other time, were stopped.
const STOPPED: usize = 3;

/// Trials that were ended by a limit and not by the operator.
fn stopped(trials: &Trials) -> Option<String> {
    let mut times: Vec<f64> = trials.rows.iter().map(|row| row.time_s).collect();
    times.sort_by(f64::total_cmp);
    let [others @ .., greatest] = &times.chunk_by(|a, b| a == b).collect::<Vec<_>>()[..] else { return None };
    let usual = others.iter().map(|same| same.len()).max()?;
    (greatest.len() >= STOPPED * usual).then(|| {
        format!(
            "{} trials took exactly {} s, and none longer: were they stopped by a limit? They count as done in that \
             time; leave their time empty",
            greatest.len(),
            greatest[0]
        )
    })
}

/// So many trials in a row of one time are no chance where times have decimals (600 generated tables: 4 in one of them;
/// of whole seconds 6).
const KEPT: usize = 5;

/// Trials of an operator that took exactly what the one before took.
fn kept(trials: &Trials) -> Option<String> {
    let whole = trials.rows.iter().filter(|row| row.time_s.fract() == 0.0).count();
    let mut rows: Vec<&Row> = trials.rows.iter().collect();
    rows.sort_by_key(|row| (row.operator, row.method, row.trial));
    let same = |a: &&Row, b: &&Row| (a.operator, a.method) == (b.operator, b.method) && a.time_s == b.time_s;
    let longest = rows.chunk_by(same).max_by_key(|run| run.len())?;
    let (first, last) = (longest.first()?, longest.last()?);
    (longest.len() >= KEPT && 2 * whole < trials.rows.len()).then(|| {
        format!(
            "trials {} to {} of {} with {} took exactly {} s each: was the last time carried forward? Leave a time \
             empty that is not known",
            first.trial, last.trial, trials.operators[first.operator], trials.methods[first.method], first.time_s
        )
    })
}

/// Operators, or methods, with the same trials and times, as a log that was copied under another name has; `places` are
/// a row's among `names`, and among the others.
fn copied(names: &[String], trials: &Trials, places: impl Fn(&Row) -> (usize, usize)) -> Vec<String> {
    let of = |k: usize| {
        let own = trials.rows.iter().map(|row| (places(row), row)).filter(|((own, _), _)| *own == k);
        let mut times: Vec<(usize, u32, u64)> =
            own.map(|((_, other), row)| (other, row.trial, row.time_s.to_bits())).collect();
        times.sort_unstable();
        times
    };
    let mut by_times: BTreeMap<Vec<(usize, u32, u64)>, Vec<&str>> = BTreeMap::new();
    for (k, name) in names.iter().enumerate() {
        by_times.entry(of(k)).or_default().push(name);
    }
    let copies = by_times.into_iter().filter(|(times, names)| times.len() >= COPIED && names.len() > 1);
    copies
        .map(|(times, names)| {
            format!("{} have the same times in all {} trials, and count apart: keep one", names.join(", "), times.len())
        })
        .collect()
}

/// So many equal times, or steps of a whole drive, are no chance.
const COPIED: usize = 3;

/// Times that go on from trial to trial, by a whole drive at least, as those of a clock that is never reset.
fn cumulative(trials: &Trials, course: &Course) -> Option<String> {
    let mut courses: BTreeMap<(usize, usize), BTreeMap<u32, f64>> = BTreeMap::new();
    for row in &trials.rows {
        courses.entry((row.operator, row.method)).or_default().insert(row.trial, row.time_s);
    }
    let goes_on = |times_s: &BTreeMap<u32, f64>| {
        let times_s: Vec<f64> = times_s.values().copied().collect();
        times_s.len() > COPIED && times_s.windows(2).all(|pair| pair[1] - pair[0] >= course.shortest_s())
    };
    let named = |(operator, method): &(usize, usize)| {
        format!("{} with {}", trials.operators[*operator], trials.methods[*method])
    };
    let names: Vec<String> =
        courses.iter().filter(|(_, times_s)| goes_on(times_s)).map(|(course, _)| named(course)).collect();
    (!names.is_empty()).then(|| {
        format!(
            "each trial of {} took a whole drive longer than the one before: is time_s counted on from the first \
             trial's begin? Write how long each took",
            names.join(", ")
        )
    })
}

/// The first and the last trial of each operator with each method.
fn ends(trials: &Trials) -> BTreeMap<(usize, usize), [u32; 2]> {
    let mut all: BTreeMap<(usize, usize), [u32; 2]> = BTreeMap::new();
    for row in &trials.rows {
        let ends = all.entry((row.operator, row.method)).or_insert([row.trial; 2]);
        *ends = [ends[0].min(row.trial), ends[1].max(row.trial)];
    }
    all
}

/// Trials of a method that go on where those of another end: learning would begin in the middle.
fn counted_on(trials: &Trials) -> Option<String> {
    let counts = ends(trials);
    let ended = |operator: usize, last: u32| counts.iter().any(|((o, _), ends)| *o == operator && ends[1] == last);
    let goes_on = |((operator, _), ends): &(&(usize, usize), &[u32; 2])| ends[0] > 1 && ended(*operator, ends[0] - 1);
    let all: Vec<_> = counts.iter().filter(goes_on).collect();
    let ((operator, method), [first, _]) = all.first()?;
    let more = if all.len() > 1 { format!(" ({} more alike)", all.len() - 1) } else { String::new() };
    Some(format!(
        "the trials of {} with {} begin at {first}, where those with another method end{more}: are they counted on? \
         Number those of each method from 1, by which they are compared and learning is fitted",
        trials.operators[*operator], trials.methods[*method]
    ))
}

/// An operator who lacks so many of the last trials stopped; one that lacks may have been lost (assumed; where 5 % of
/// all rows are lost by chance, 3 of 40 generated studies of 100 rows have such an operator).
const ENDED_EARLY: u32 = 2;
const MOST_NAMED: usize = 10;

/// Operators who did not go on as long as others did with a method: those who stop are seldom like those who stay.
fn ended_early(trials: &Trials) -> Option<String> {
    let ends = ends(trials);
    let mut named = Vec::new();
    for (method, name) in trials.methods.iter().enumerate() {
        let of_method = || ends.iter().filter(|((_, of), _)| *of == method);
        let last = of_method().map(|(_, ends)| ends[1]).max().unwrap_or(0);
        let early = of_method().filter(|(_, ends)| ends[1] + ENDED_EARLY <= last);
        named.extend(early.map(|((operator, _), ends)| {
            format!("{} after trial {} of {last} with {name}", trials.operators[*operator], ends[1])
        }));
    }
    let more = named.len().saturating_sub(MOST_NAMED);
    named.truncate(MOST_NAMED);
    named.extend((more > 0).then(|| format!("{more} more")));
    (!named.is_empty()).then(|| {
        format!(
            "stopped early: {}. From there on means are of the others; the curve assumes that who stopped would have \
             gone on as they did, at their own pace: judge with the operators who did all trials, too",
            named.join(", ")
        )
    })
}

/// What was chosen or could not be known.
fn notes(figures: &PerformanceFigures, outputs: &Outputs) -> Vec<String> {
    let mut notes = Vec::new();
    match figures.rows_without_time {
        0 => {}
        1 => notes.push("1 row has no time and is not counted".to_owned()),
        rows => notes.push(format!("{rows} rows have no time and are not counted")),
    }
    for method in &figures.methods {
        let fitted = &method.fitted;
        let missing = method.not_done();
        if missing > 0 && fitted.better.is_some() {
            notes.push(format!(
                "{}: {missing} of {} trials were not done; the curve is of all operators, at the pace that each had in \
                 the others",
                method.method,
                method.operators * method.trials.len()
            ));
        }
        for (law, fit) in [("exponential", &fitted.exponential), ("power law", &fitted.power)] {
            if let Some(why) = &fit.not_fitted {
                notes.push(format!("{}: {law} not fitted: {why}", method.method));
            }
        }
        if method.levels_off.is_none() && fitted.better.is_some() {
            notes.push(format!(
                "{}: the change from trial to trial may be none (the 95 % interval of b holds 0): where it levels off \
                 is not known",
                method.method
            ));
        }
    }
    for one in figures.comparisons.iter().filter(|one| one.overall.is_none()) {
        notes.push(format!(
            "{} and {}: no operator did the same trial with both: they are not compared",
            one.method, one.baseline
        ));
    }
    let operators = figures.operators.len();
    if outputs.figures && operators > figures::MOST_PANELS {
        notes.push(format!("the first {} of {operators} operators are drawn", figures::MOST_PANELS));
    }
    notes
}
