//! Recorded responses: loads and photodiodes of a table, over time or static.

pub(super) mod photodiodes;
pub(super) mod signs;

use std::path::{Path, PathBuf};

use clap::Args;
use lunula_hemodynamics::{Course, Load, LoadFault, Recording, Trace};

use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::choices::Pressed;
use crate::hemodynamics::given::{BLOOD, Columns, Knots, PRESSED, Rows, TIME};
use crate::job::one_of;
use crate::log::{LogReading, doubts, is_force_in_another_unit};
use crate::words::Words;

pub use photodiodes::PhotodiodeColumn;

/// A measured force instead of pressures: the finger's force on the surface, newtons, negative where it presses.
struct ForceColumn<'a> {
    name: &'a str,
    area_m2: f64,
    pressed: Pressed,
}

impl ForceColumn<'_> {
    /// `[P_F1, P_F2]` under a force, Pa.
    fn on(&self, force_n: f64) -> [f64; 2] {
        self.pressed.of(-force_n / self.area_m2)
    }
}

fn area(text: &str) -> Result<f64, String> {
    let area_cm2 = text.parse().map_err(|_| format!("{text:?}: is not a number"))?;
    let usable = f64::is_finite(area_cm2) && area_cm2 > 0.0;
    if usable { Ok(area_cm2) } else { Err(format!("{text}: an area is greater than 0, such as 1")) }
}

/// What a load does between two rows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Between {
    /// It goes straight.
    #[default]
    Straight,
    /// It stays, and jumps at the next row.
    Held,
}

impl Words for Between {
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Straight, "straight", ""), (Self::Held, "held", "")];
}

/// How recordings are read.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct RecordingColumns {
    /// A photodiode's column and the unit below it, counted from 1 at the proximal end, such as P3=1; may be given more
    /// than once [default: VP1=1, VP2=2, ..]
    #[arg(long = "photodiode", value_name = "COLUMN=UNIT", value_parser = PhotodiodeColumn::parse)]
    pub photodiodes: Vec<PhotodiodeColumn>,
    /// The column of a force instead of pf1_Pa, pf2_Pa, such as Fz_N: of the finger on the surface in newtons, negative
    /// where it presses
    #[arg(long, value_name = "COLUMN", requires = "area_cm2")]
    pub force: Option<String>,
    /// The area that the force presses on
    #[arg(long, value_name = "CM2", requires = "force", value_parser = area, allow_negative_numbers = true)]
    pub area_cm2: Option<f64>,
    /// Where the force presses
    #[arg(long = "load", value_parser = one_of::<Pressed>(), default_value = "both", requires = "force")]
    pub pressed: Pressed,
    /// What loads do from row to row: straight lines, or held until the next row, where they jump
    #[arg(long, value_parser = one_of::<Between>(), default_value = "straight")]
    pub between: Between,
    /// Nothing pressed before the first row [default: the first row's load did, for long]
    #[arg(long)]
    pub unloaded_before: bool,
    /// How raw logs are read.
    #[command(flatten)]
    pub log: LogReading,
}

impl RecordingColumns {
    fn force(&self) -> Option<ForceColumn<'_>> {
        let (name, area_cm2) = self.force.as_deref().zip(self.area_cm2)?;
        Some(ForceColumn { name, area_m2: 1e-4 * area_cm2, pressed: self.pressed })
    }
}

#[derive(Debug, Clone)]
pub(super) struct ReadRecording {
    pub(super) path: PathBuf,
    /// As in the report: the file's name.
    pub(super) name: String,
    /// All columns of the file.
    pub(super) columns: Vec<String>,
    pub(super) recording: Recording,
    /// The photodiodes' names, as the traces of the recording.
    pub(super) photodiodes: Vec<String>,
    /// Photodiodes that are left out, as they are constant.
    pub(super) constant: Vec<PhotodiodeColumn>,
    /// Samples' times, s, of a log the first row's among them; none of a static one.
    pub(super) times_s: Option<Vec<f64>>,
    /// `[P_F1, P_F2]` of each sample, Pa.
    pub(super) pressed_pa: Vec<[f64; 2]>,
    /// Photodiodes' cells that are empty.
    pub(super) missing: usize,
    /// Photodiodes' cells that are left out, as the sensor had a fault there.
    pub(super) faults: usize,
    /// What of a log has to be known before the values are used.
    pub(super) warnings: Vec<String>,
    /// What is worth saying on a log, how its ambient light was taken away among it.
    pub(super) notes: Vec<String>,
}

/// Reads a recording of a model of `units` units.
///
/// # Errors
/// Every fault with its row and column.
pub(super) fn read(path: &Path, columns: &RecordingColumns, units: usize) -> Result<ReadRecording, HemodynamicsError> {
    let refused = |what: String| HemodynamicsError::table(path, what);
    let rows = Rows::read(path, &columns.log)?;
    let names = rows.names();
    let dynamic = names.iter().any(|own| own == TIME);
    let mut needed: Vec<&str> = if dynamic { vec![TIME] } else { Vec::new() };
    let force = columns.force();
    if let Some(force) = force.as_ref().filter(|force| is_force_in_another_unit(force.name)) {
        return Err(refused(format!("`{}` is a force that is not in newtons; write newtons", force.name)));
    }
    match &force {
        Some(force) => needed.push(force.name),
        None => needed.extend(PRESSED),
    }
    let wanted: &[&str] = if dynamic { &BLOOD } else { &[] };
    let read = rows.numbers(&needed, wanted, TIME)?;
    if let Some(force) = &force {
        let forces = read.get(force.name).unwrap_or_default();
        if forces.iter().any(|&force_n| force_n > 0.0) && !forces.iter().any(|&force_n| force_n < 0.0) {
            return Err(refused(format!(
                "`{}` is never negative: nothing presses; the finger's force on the surface is negative where it \
                 presses, so turn its sign",
                force.name
            )));
        }
    }
    let mut pressed_pa = pressed(&read, force.as_ref());
    let (mut photodiodes, mut constant) = (Vec::new(), Vec::new());
    let mut traces = Vec::new();
    let (mut missing, mut faults) = (0, 0);
    let (mut unknown, mut of_photodiodes) = (None, Vec::new());
    for one in photodiodes::of(names, &columns.photodiodes, units).map_err(refused)? {
        let voltages = rows.voltages(&one.name)?;
        if photodiodes::is_constant(&voltages.values_v) {
            constant.push(one);
            continue;
        }
        faults += voltages.faults;
        missing += voltages.values_v.iter().filter(|value| value.is_nan()).count() - voltages.faults;
        // The same rows for every photodiode.
        unknown = voltages.warning;
        of_photodiodes.extend(doubts::cut_off(&one.name, &voltages.values_v));
        of_photodiodes.extend(photodiodes::takes_few_values(&one.name, &voltages.values_v));
        traces.push(Trace::new(one.unit, voltages.values_v));
        photodiodes.push(one);
    }
    if photodiodes.is_empty() {
        return Err(refused(format!(
            "every photodiode is constant ({}): it determines nothing; leave the recording out",
            photodiodes::in_words(&constant)
        )));
    }
    let mut times_s = read.get(TIME).map(<[f64]>::to_vec);
    let course = match &mut times_s {
        None => {
            let [proximal_pa, distal_pa] = [0, 1].map(|k| pressed_pa.iter().map(|both| both[k]).collect());
            Course::Static { proximal_pa, distal_pa }
        }
        Some(times_s) => {
            let [proximal, distal] = pressed_knots(&rows, &read, force.as_ref());
            let earliest_s = proximal.times_s[0].min(distal.times_s[0]);
            if earliest_s < times_s[0] {
                // The response begins at the log's first row; unlit, it has no voltage.
                times_s.insert(0, earliest_s);
                pressed_pa.insert(0, [proximal.values[0], distal.values[0]]);
                traces.iter_mut().for_each(|trace| trace.voltages_v.insert(0, f64::NAN));
            }
            // A log's clock may count from 1970, which leaves a step of a solver few digits: its first row is 0 here.
            let origin_s = if rows.is_log() { times_s[0] } else { 0.0 };
            let load = |knots: &Knots, before: Option<f64>| {
                let times_s: Vec<f64> = knots.times_s.iter().map(|time_s| time_s - origin_s).collect();
                load(&times_s, &knots.values, columns.between, before).map_err(|why| refused(why.to_string()))
            };
            let blood = |name: &str| read.get(name).map(|_| load(&rows.knots(name, &read), None)).transpose();
            let before = columns.unloaded_before.then_some(0.0);
            let (proximal, distal) = (load(&proximal, before)?, load(&distal, before)?);
            let (upstream, downstream) = (blood(BLOOD[0])?, blood(BLOOD[1])?);
            let times_s = times_s.iter().map(|time_s| time_s - origin_s).collect();
            Course::Transient { times_s, proximal, distal, upstream, downstream }
        }
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut warnings = rows.warnings().to_vec();
    warnings.extend(photodiodes::beyond(names, &columns.photodiodes, units));
    warnings.extend(unknown.into_iter().chain(of_photodiodes));
    let used: Vec<&str> = needed.iter().copied().chain(photodiodes.iter().map(|one| one.name.as_str())).collect();
    if let Some(times_s) = times_s.as_deref().filter(|_| !rows.is_log()) {
        warnings.extend(doubts::time(times_s).into_iter().chain(doubts::gap(times_s)));
    }
    warnings.extend(match &force {
        Some(force) => signs::of_force(force.name, read.get(force.name).unwrap_or_default(), rows.is_log()),
        None => signs::of_pressures(PRESSED.map(|name| (name, read.get(name).unwrap_or_default()))),
    });
    match read.get(TIME) {
        Some(times_s) => {
            warnings.extend(rows.near_misses(&BLOOD, &used));
            let loads = needed.iter().filter(|name| **name != TIME);
            let doubt = |name: &&str| {
                let values = read.get(name).unwrap_or_default();
                match columns.between {
                    Between::Straight => doubts::held(name, times_s, values).or_else(|| signs::steps(name, values)),
                    Between::Held => signs::moves(name, values),
                }
            };
            warnings.extend(loads.filter_map(doubt));
        }
        None => {
            let mut loads = needed.iter().filter_map(|name| read.get(name));
            // A series of growing loads has other columns that grow.
            let turns = |load: &[f64]| !load.is_sorted() && !load.is_sorted_by(|a, b| a >= b);
            warnings.extend(loads.any(turns).then(|| rows.like_a_time(&used)).flatten());
        }
    }
    let loads = || needed.iter().filter(|name| **name != TIME);
    let values = |name: &&str| read.get(name).unwrap_or_default();
    let largest = loads().flat_map(values).fold(0.0, |largest: f64, load| largest.max(load.abs()));
    let unloaded = loads().filter_map(|name| signs::never_rests(name, values(name), largest));
    let notes = rows.notes().into_iter().chain(unloaded).collect();
    Ok(ReadRecording {
        columns: names.to_vec(),
        path: path.to_owned(),
        recording: Recording { course, photodiodes: traces, subject: None },
        name,
        photodiodes: photodiodes.into_iter().map(|one| one.name).collect(),
        constant,
        times_s,
        pressed_pa,
        missing,
        faults,
        warnings,
        notes,
    })
}

/// A jump at a row takes so long, s.
const JUMP_S: f64 = 1e-9;

/// The load of these rows; `before` is its value before the first one, where that is another.
fn load(times_s: &[f64], values: &[f64], between: Between, before: Option<f64>) -> Result<Load, LoadFault> {
    let (mut times, mut loads) = (Vec::new(), Vec::new());
    let mut last = before;
    for (row, (&time_s, &value)) in times_s.iter().zip(values).enumerate() {
        if let Some(last) = last.filter(|&last| last != value && (row == 0 || between == Between::Held)) {
            // The jump begins at the row: just before it, and in the equilibrium before the first one, the load is
            // still the old one.
            times.push(time_s);
            loads.push(last);
            times.push((time_s + JUMP_S).max(time_s.next_up()));
        } else {
            times.push(time_s);
        }
        loads.push(value);
        last = Some(value);
    }
    Load::table(&times, &loads)
}

/// `[P_F1, P_F2]` of each row.
fn pressed(read: &Columns, force: Option<&ForceColumn<'_>>) -> Vec<[f64; 2]> {
    let column = |name: &str| read.get(name).unwrap_or_default();
    match force {
        Some(force) => column(force.name).iter().map(|force_n| force.on(*force_n)).collect(),
        None => column(PRESSED[0]).iter().zip(column(PRESSED[1])).map(|(first, second)| [*first, *second]).collect(),
    }
}

/// `P_F1` and `P_F2` over time, Pa, at all rows at which they are known.
fn pressed_knots(rows: &Rows, read: &Columns, force: Option<&ForceColumn<'_>>) -> [Knots; 2] {
    let Some(force) = force else { return PRESSED.map(|name| rows.knots(name, read)) };
    let Knots { times_s, values } = rows.knots(force.name, read);
    let pressed_pa: Vec<[f64; 2]> = values.iter().map(|force_n| force.on(*force_n)).collect();
    [0, 1].map(|k| Knots { times_s: times_s.clone(), values: pressed_pa.iter().map(|both| both[k]).collect() })
}
