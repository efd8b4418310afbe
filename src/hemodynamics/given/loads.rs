//! Loads over time from options and a file.

use std::path::Path;

use clap::Args;
use lunula_hemodynamics::{Load, LoadFault, Loads, Parameters};

use super::columns::{BLOOD, Columns, Knots, PRESSED, Rows, TIME};
use crate::hemodynamics::HemodynamicsError;
use crate::log::{LogReading, doubts};
use crate::median::ends;

/// Pressures that are nowhere greater hardly press on vessels of kilopascals, and are in another unit (assumed).
const HARDLY_PA: f64 = 200.0;

/// Of two pressures, one that is so many times less than the other is in another unit (assumed: mmHg are 133 Pa).
const APART: f64 = 100.0;

/// What to say of pressures, Pa, known by name, that are all but nothing: of all, or of one beside another.
pub(in crate::hemodynamics) fn hardly_pressed(columns: &[(&str, &[f64])]) -> Option<String> {
    let most = |values: &[f64]| values.iter().map(|pa| pa.abs()).filter(|pa| pa.is_finite()).fold(0.0, f64::max);
    let each: Vec<(&str, f64)> = columns.iter().map(|(name, values)| (*name, most(values))).collect();
    let largest = each.iter().map(|(_, most)| *most).fold(0.0, f64::max);
    if largest > 0.0 && largest < HARDLY_PA {
        let of = each.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(" and ");
        return Some(format!(
            "no pressure of {of} is greater than {largest} Pa, which hardly presses on a vessel: are they in kPa or \
             mmHg? Write them in Pa"
        ));
    }
    // Not the noise or the offset of one that does not press.
    let presses = |values: &[f64]| {
        let [least, most] = ends(values.iter().copied());
        least > -0.1 * most && least < 0.5 * most && most < HARDLY_PA && largest > APART * most
    };
    let (name, values) = columns.iter().find(|(_, values)| presses(values))?;
    let most = most(values);
    Some(format!(
        "no pressure of {name} is greater than {most} Pa, and the other reaches {largest} Pa: is {name} in kPa or \
         mmHg? Write it in Pa"
    ))
}

/// What to know of a negative load.
pub(in crate::hemodynamics) const SUCTION: &str = "pressing is positive, and negative pressure is suction";

/// The pressures of the blood.
#[derive(Debug, Clone, Default, Args)]
pub struct BloodOptions {
    /// P_H, the upstream blood pressure, for a pulse as sine:10000+2000@1.2 [default: the parameters' constant]
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    pub ph: Option<Load>,
    /// P_L, the downstream blood pressure [default: the parameters' constant]
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    pub pl: Option<Load>,
}

/// What presses, over time.
#[derive(Debug, Clone, Default, Args)]
pub struct LoadOptions {
    /// P_F1, on the proximal palmar surface: it presses on the vein [default: nothing]
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    pub pf1: Option<Load>,
    /// P_F2, on the distal palmar surface: it presses on the distal capillaries [default: nothing]
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    pub pf2: Option<Load>,
    /// The pressures of the blood.
    #[command(flatten)]
    pub blood: BloodOptions,
}

/// Loads, and until when a file knows them.
#[derive(Debug, Clone)]
pub(in crate::hemodynamics) struct ReadLoads {
    pub(in crate::hemodynamics) loads: Loads,
    /// The first and the last time of the file.
    pub(in crate::hemodynamics) known_s: Option<[f64; 2]>,
    /// What of a file that is a log has to be known.
    pub(in crate::hemodynamics) warnings: Vec<String>,
    /// How a file that is a log was read.
    pub(in crate::hemodynamics) notes: Vec<String>,
}

impl LoadOptions {
    /// Reads and checks them. `file` is a table `time_s,pf1_Pa,pf2_Pa` instead of `P_F1` and `P_F2`, and `ph_Pa`,
    /// `pl_Pa` where it has them; a log's unlit rows are taken too.
    ///
    /// # Errors
    /// [`HemodynamicsError`] with every fault of the file by row and column.
    pub(in crate::hemodynamics) fn read(
        &self,
        file: Option<&Path>,
        parameters: &Parameters,
    ) -> Result<ReadLoads, HemodynamicsError> {
        let nothing = || Load::constant(0.0).expect("zero is finite");
        let or_nothing = |load: &Option<Load>| load.clone().unwrap_or_else(nothing);
        let mut loads = Loads::on(parameters, or_nothing(&self.pf1), or_nothing(&self.pf2));
        let (mut known_s, mut warnings, mut notes) = (None, Vec::new(), Vec::new());
        if let Some(path) = file {
            let rows = Rows::read(path, &LogReading::default())?;
            let needed = [TIME, PRESSED[0], PRESSED[1]];
            let columns = rows.numbers(&needed, &BLOOD, TIME)?;
            let placed = |what: &[String]| what.iter().map(|one| format!("{}: {one}", path.display())).collect();
            let pressed: Vec<(&str, &[f64])> =
                PRESSED.iter().filter_map(|name| Some((*name, columns.get(name)?))).collect();
            let times_s = columns.get(TIME).unwrap_or_default();
            // Of a table that a person wrote the rows are as far apart as they please.
            let logged = doubts::even_step(times_s).filter(|_| !rows.is_log());
            let time = logged.and_then(|_| doubts::time(times_s).or_else(|| doubts::gap(times_s)));
            let doubted: Vec<String> = hardly_pressed(&pressed).into_iter().chain(time).collect();
            warnings = placed(&[rows.warnings(), &rows.near_misses(&BLOOD, &needed), &doubted].concat());
            notes = placed(&rows.notes());
            known_s = place_columns(&rows, &columns, &mut loads)?;
        }
        let loads = loads.with_blood(&self.blood.ph, &self.blood.pl);
        if file.is_none() {
            let given = [("--pf1", &self.pf1), ("--pf2", &self.pf2)];
            warnings.extend(given.iter().filter_map(|(of, load)| hardly_pressed(&[(*of, &values(load.as_ref()?))])));
        }
        let greatest = |load: &Load| values(load).into_iter().fold(f64::NEG_INFINITY, f64::max);
        warnings.extend(hardly_flows([&loads.upstream, &loads.downstream].map(greatest)));
        Ok(ReadLoads { loads, known_s, warnings, notes })
    }
}

/// Values of a load that show how large it is, Pa.
fn values(load: &Load) -> Vec<f64> {
    let breaks = load.breakpoints().iter().flat_map(|&time_s| [load.before(time_s), load.at(time_s)]);
    breaks.chain((0..SAMPLES).map(|k| load.at(SAMPLED_S * f64::from(k)))).collect()
}

/// Times at which a load without breakpoints is looked at: a pulse's, seconds.
const SAMPLES: u32 = 40;
const SAMPLED_S: f64 = 0.05;

/// What to say of the blood's pressures, P_H and P_L at most, Pa.
pub(in crate::hemodynamics) fn hardly_flows([upstream, downstream]: [f64; 2]) -> Option<String> {
    if upstream < HARDLY_PA {
        return Some(format!(
            "the upstream pressure P_H is nowhere greater than {upstream} Pa, and a finger's blood has kilopascals: is \
             it in kPa or mmHg? Write it in Pa"
        ));
    }
    (downstream >= upstream).then(|| {
        format!(
            "the downstream pressure P_L reaches {downstream} Pa and the upstream one P_H {upstream} Pa: blood flows \
             backwards; are they exchanged?"
        )
    })
}

/// Puts the columns of a table of loads into `loads`; returns its first and last time.
///
/// # Errors
/// What the crate refuses of them, with the file.
fn place_columns(rows: &Rows, columns: &Columns, loads: &mut Loads) -> Result<Option<[f64; 2]>, HemodynamicsError> {
    let refused = |why: LoadFault| HemodynamicsError::table(&columns.path, why);
    let mut known_s: Option<[f64; 2]> = None;
    let places = [&mut loads.proximal, &mut loads.distal, &mut loads.upstream, &mut loads.downstream];
    for (name, place) in PRESSED.iter().chain(&BLOOD).zip(places) {
        if columns.get(name).is_some() {
            let Knots { times_s, values } = rows.knots(name, columns);
            *place = Load::table(&times_s, &values).map_err(refused)?;
            if let (Some(&first), Some(&last)) = (times_s.first(), times_s.last()) {
                known_s = Some(known_s.map_or([first, last], |[from, to]| [from.min(first), to.max(last)]));
            }
        }
    }
    Ok(known_s)
}
