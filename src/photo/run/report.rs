//! What a run reports: `run.json` for scripts, `report.html` for a colleague.
//!
//! Warnings are what a person may have to act on; notes are what is good to know, one line for each kind.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::{Value, json};

use super::doubts::doubts;
use crate::figure::Page;
use crate::files::{Staging, WriteError};
use crate::input::copies;
use crate::job::{Report, Watch};
use crate::photo::channels::{ChannelFigures, add_section};
use crate::photo::normalize::{MOST_AT_FULL_SCALE, Normalization, SHARP};
use crate::photo::options::{Outputs, PhotosOptions, Results};
use crate::photo::outline::{AxisUnknown, EXPORT, SavedOutlines, Source, Sources, has_nails, other_program};
use crate::photo::pose::{self, sort_by_pose};
use crate::photo::results::{DrawnSheet, NailRow, NailTable, nail_columns};
use crate::photo::set::{Photo, PhotoSet, SetFault};
use crate::photo::sums::{Look, Partials, Sums};
use crate::photograph::Profile;
use crate::stages::Stage;
use crate::words::COMPOSE;

/// Where the report goes among the results.
const JSON: &str = "run.json";
pub(in crate::photo) const HTML: &str = "report.html";

/// One run of `photos` or `photos merge`, as `run.json` and `--json` show it. Times differ from run to run; all else is
/// the same for the same input and options.
pub type PhotosReport = Report<PhotosFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct PhotosFigures {
    /// What it worked on.
    pub inputs: Vec<PathBuf>,
    /// How the normalized pictures were made.
    pub normalization: Normalization,
    /// Photographs and entries given, photographs that gave at least one nail, nails listed and used.
    pub counts: Value,
    /// Subjects by pose.
    pub poses: Vec<PoseCount>,
    /// The channels compared, where that was requested and there are colour photographs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channels: Option<ChannelFigures>,
    /// Threads that worked.
    pub threads: usize,
    /// Every nail, used or not, in the set's order; of merged parts none.
    #[serde(skip)]
    pub nails: Vec<NailRow>,
}

/// How many subjects a pose's maps hold.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PoseCount {
    /// The pose.
    pub pose: String,
    /// Its subjects.
    pub subjects: usize,
}

/// How many subjects each pose's maps hold.
pub(in crate::photo) fn pose_counts(partials: &Partials) -> Vec<PoseCount> {
    let count = |(pose, sums): (&String, &Sums)| PoseCount { pose: pose.clone(), subjects: sums.subjects().len() };
    let mut counts: Vec<PoseCount> = partials.poses.iter().map(count).collect();
    sort_by_pose(&mut counts, |counted| &counted.pose);
    counts
}

/// The poses whose maps have no standard deviation, as one note.
pub(in crate::photo) fn one_subject(poses: &[PoseCount]) -> Option<String> {
    let alone: Vec<&str> = poses.iter().filter(|pose| pose.subjects == 1).map(|pose| pose.pose.as_str()).collect();
    match alone[..] {
        [] => None,
        [pose] => Some(format!("pose `{pose}`: one subject, so no standard deviation (it needs two)")),
        [first, .., last] => Some(format!(
            "{} poses (`{first}` to `{last}`): one subject, so no standard deviation (it needs two)",
            alone.len()
        )),
    }
}

/// Warns of poses with colour and grey photographs: how many of either.
fn mixed_poses<'a>(poses: impl Iterator<Item = (&'a str, usize, usize)>) -> Vec<String> {
    let mut mixed: Vec<_> = poses.filter(|(_, colour, grey)| *colour > 0 && *grey > 0).collect();
    sort_by_pose(&mut mixed, |(pose, ..)| pose);
    let said = mixed.into_iter().map(|(pose, colour, grey)| {
        format!(
            "pose `{pose}` mixes {colour} colour and {grey} grey photograph(s): grey values equal a colour's channel \
             only where a filter of that colour was used; else make maps of each kind apart"
        )
    });
    said.collect()
}

/// What is doubtful of maps that were made in parts, a photograph a subject.
pub(in crate::photo) fn doubts_of_sums(partials: &Partials) -> Vec<String> {
    let mixed = mixed_poses(partials.poses.iter().map(|(pose, sums)| {
        let grey = sums.grey.len();
        (pose.as_str(), sums.subjects.len() - grey, grey)
    }));
    mixed.into_iter().chain(partials.one_picture()).collect()
}

/// So many outlines, and more than this share of all whose finger is looked for, without a clear direction are warned
/// of (measured, 128 masks of 26 real photographs: 3 %; turned by 180 degrees 40 %, mirrored 41 %, those of the next
/// photograph 43 %, 40 px off 19 %).
const UNCLEAR: usize = 3;
const UNCLEAR_SHARE: f64 = 0.15;

/// What a run found, photograph by photograph, before it is a report.
pub(in crate::photo) struct Findings<'a> {
    set: &'a PhotoSet,
    options: &'a PhotosOptions,
    has_maps: bool,
    /// Every nail, used or not, in the set's order.
    pub(in crate::photo) rows: Vec<NailRow>,
    /// Photographs that gave nothing, and entries of the set that could not be used.
    pub(in crate::photo) failed: Vec<SetFault>,
    /// What the scene did not need.
    pub(in crate::photo) left_out: Vec<String>,
    /// Whether some photograph was searched for nails.
    pub(in crate::photo) detects: bool,
    /// Detected outlines, where they were to be saved.
    pub(in crate::photo) outlines: Option<SavedOutlines>,
    /// Photographs that have neither outline nor mask.
    pub(in crate::photo) without_outline: Vec<&'a Photo>,
    /// Photographs whose outlines say that they were drawn on another, and on which.
    pub(in crate::photo) drawn_elsewhere: Vec<(&'a Photo, PathBuf)>,
    /// Photographs whose LabelMe files don't say their picture's size, and whether an outline seems to be of another.
    pub(in crate::photo) of_unknown_size: Vec<(&'a Photo, bool)>,
    /// Photographs on which nails were found, and how much fine detail those show.
    pub(in crate::photo) details: Vec<(&'a Photo, f64)>,
    /// What photographs look like of which a nail was used.
    pub(in crate::photo) looks: Vec<(&'a Photo, Look)>,
    /// Colour and grey photographs by pose.
    colours: BTreeMap<&'a str, [usize; 2]>,
    /// How many photographs of 16 bits, and their largest sample.
    sixteen: (usize, u16),
    /// Photographs by the name of their colour profile, sRGB and none having no name.
    profiles: BTreeMap<Option<String>, Encoded<'a>>,
    without_maps: Vec<String>,
}

/// Photographs of one colour profile.
struct Encoded<'a> {
    count: usize,
    first: &'a str,
    /// See [`Profile::skin_green`].
    skin_green: f32,
}

impl<'a> Findings<'a> {
    pub(in crate::photo) fn new(set: &'a PhotoSet, options: &'a PhotosOptions, outputs: &Outputs) -> Self {
        Self {
            set,
            options,
            has_maps: outputs.results == Results::Maps,
            rows: Vec::new(),
            failed: set.faults.clone(),
            left_out: Vec::new(),
            detects: false,
            outlines: None,
            without_outline: Vec::new(),
            drawn_elsewhere: Vec::new(),
            of_unknown_size: Vec::new(),
            details: Vec::new(),
            looks: Vec::new(),
            colours: BTreeMap::new(),
            sixteen: (0, 0),
            profiles: BTreeMap::new(),
            without_maps: Vec::new(),
        }
    }

    /// A photograph: whether it is grey (not known where none of it was used), its largest sample of 16 bits, whose
    /// colours it has.
    pub(in crate::photo) fn add(
        &mut self,
        photo: &'a Photo,
        grey: Option<bool>,
        largest: Option<u16>,
        profile: Option<&Profile>,
    ) {
        if let Some(grey) = grey {
            self.colours.entry(&photo.pose).or_default()[usize::from(grey)] += 1;
            let skin_green = profile.map_or(0.0, |profile| profile.skin_green);
            let encoded = Encoded { count: 0, first: &photo.file, skin_green };
            self.profiles.entry(profile.map(|profile| profile.name.clone())).or_insert(encoded).count += 1;
        }
        if let Some(largest) = largest {
            self.sixteen = (self.sixteen.0 + 1, self.sixteen.1.max(largest));
        }
    }

    pub(in crate::photo) fn poses_without_maps(&mut self, poses: Vec<String>) {
        self.without_maps = poses;
        sort_by_pose(&mut self.without_maps, |pose| pose);
    }

    fn warnings(&self) -> Vec<String> {
        let without =
            self.without_maps.iter().map(|pose| format!("pose `{pose}`: no nail could be used, so it has no maps"));
        // A manifest may name a file several times, for several nails.
        let mut seen = BTreeSet::new();
        let files = self.set.photos.iter().filter(|photo| seen.insert(&photo.path));
        let copies = copies(files.map(|photo| (photo.file.clone(), photo.path.as_path())));
        let elsewhere = self.drawn_on_others();
        let mixed = self.colours.iter().map(|(pose, [colour, grey])| (*pose, *colour, *grey));
        mixed_poses(mixed)
            .into_iter()
            .chain(self.mixed_profiles())
            .chain(self.few_bits())
            .chain(without)
            .chain(copies)
            .chain(elsewhere)
            .chain(self.unknown_size(true))
            .chain(self.unclear())
            .chain(self.without_mask())
            .chain(self.encoded_otherwise())
            .chain(self.of_no_photograph())
            .chain(self.blurred())
            .chain(self.overexposed())
            .chain(self.drawn_and_left_out())
            .chain(doubts(self.set, &self.rows, &self.looks))
            .collect()
    }

    /// Photographs that are out of focus or shaken, where nails were found on them.
    fn blurred(&self) -> Option<String> {
        let all: Vec<&str> =
            self.details.iter().filter(|(_, detail)| *detail < SHARP).map(|(photo, _)| photo.file.as_str()).collect();
        Some(format!(
            "{} of {} photographs on which nails were found look out of focus or shaken there ({} first): look at the \
             outlines, of which more are wrong on such ones, whatever their confidence",
            all.len(),
            self.details.len(),
            all.first()?
        ))
    }

    /// Nails that are as bright as a file can say, so that they show less contrast than they have.
    fn overexposed(&self) -> Option<String> {
        let used = self.rows.iter().filter(|row| row.normalized.is_some());
        let bright: Vec<&NailRow> = used.clone().filter(|row| row.at_full_scale > MOST_AT_FULL_SCALE).collect();
        let most = bright.iter().map(|row| row.at_full_scale).fold(0.0, f64::max);
        Some(format!(
            "{} of {} nails are overexposed ({} first; up to {:.0} % of a nail is at full scale): there the maps are \
             too dark and flat; leave these photographs out, or take them again with less exposure",
            bright.len(),
            used.count(),
            self.set.photos[bright.first()?.photo].file,
            100.0 * most
        ))
    }

    /// Nails that somebody drew and that are left out, on photographs of which others are used: of those that gave
    /// nothing it is said elsewhere.
    fn drawn_and_left_out(&self) -> Option<String> {
        let used: BTreeSet<usize> =
            self.rows.iter().filter(|row| row.normalized.is_some()).map(|row| row.photo).collect();
        // A mask's specks are no nails.
        let is_drawn = |row: &NailRow| row.source == Source::Annotated || row.drawn.is_some();
        let is_left_out = |row: &&NailRow| row.normalized.is_none() && is_drawn(row) && used.contains(&row.photo);
        let mut such = self.rows.iter().filter(is_left_out);
        let first = such.next()?;
        Some(format!(
            "{} drawn nail(s) are left out, others of their photographs being used: {}, nail {} first: {}; correct \
             them with `lunula edit` (nails.csv lists all), or remove what is no nail",
            1 + such.count(),
            self.set.photos[first.photo].file,
            first.number,
            first.reason
        ))
    }

    /// Outlines around which too many fingers are not seen.
    fn unclear(&self) -> Option<String> {
        let is_unclear = |row: &&NailRow| row.reason.ends_with(AxisUnknown::ADVICE);
        let sought = |row: &&NailRow| row.source != Source::Detected && (row.confidence.is_some() || is_unclear(row));
        let all = self.rows.iter().filter(sought).count();
        let unclear: Vec<&NailRow> = self.rows.iter().filter(sought).filter(is_unclear).collect();
        let first = &self.set.photos[unclear.first()?.photo].file;
        (unclear.len() >= UNCLEAR && unclear.len() as f64 > UNCLEAR_SHARE * all as f64).then(|| {
            format!(
                "around {} of {all} outlines no finger's direction is clear ({first} first): do masks and annotations \
                 belong to these photographs, as they are turned now? Then draw an `axis`, or say --distal",
                unclear.len()
            )
        })
    }

    /// Photographs that have no mask where masks were given.
    fn without_mask(&self) -> Option<String> {
        let folder = self.options.outlines.masks.as_ref()?;
        let first = self.without_outline.first()?;
        Some(format!(
            "{} of {} photographs have no mask in {} ({} first), and their nails are sought: a mask is called as its \
             photograph, {2}/{}.png or {2}/{}/{4}.png",
            self.without_outline.len(),
            self.set.photos.len(),
            folder.display(),
            first.file,
            first.path.file_stem().unwrap_or_default().to_string_lossy(),
            first.pose
        ))
    }

    /// Outlines that are not found as their names only look like their photographs'.
    fn encoded_otherwise(&self) -> Option<String> {
        let outlines = &self.options.outlines;
        let one = |photo: &&Photo| outlines.encoded_otherwise(photo);
        let mut all = self.without_outline.iter().filter_map(one);
        let first = all.next()?;
        Some(format!(
            "{} outline(s) are not found ({} first): their names look like their photographs', but their accents are \
             encoded in another way, as on a Mac: {COMPOSE}",
            1 + all.count(),
            first.display()
        ))
    }

    /// LabelMe files with nails that no photograph is called as, and other programs' annotations.
    fn of_no_photograph(&self) -> impl Iterator<Item = String> {
        let alone = if self.options.outlines.sources == Sources::Detect { &[][..] } else { &self.set.alone };
        let called = |file: &'a Path| file.strip_prefix(&self.set.folder).unwrap_or(file).display();
        let mut such = alone.iter().filter(|file| has_nails(file));
        let unused = such.next().map(|first| {
            format!(
                "{} LabelMe file(s) with nails are not used, as no photograph beside them is called so ({} first): \
                 were photographs renamed or removed? Call each as its photograph, or remove it",
                1 + such.count(),
                called(first)
            )
        });
        let others = alone.iter().filter_map(move |file| {
            let (file, program) = (called(file), other_program(file)?);
            Some(format!("{file} holds annotations of {program}, which are not read; {EXPORT}"))
        });
        unused.into_iter().chain(others)
    }

    /// Outlines that were taken for another photograph's.
    fn drawn_on_others(&self) -> Option<String> {
        let (first, other) = self.drawn_elsewhere.first()?;
        let all = self.drawn_elsewhere.len();
        let more = if all > 1 { format!(", and so do those of {} more", all - 1) } else { String::new() };
        Some(format!(
            "{}: its outline says that it was drawn on another photograph, {} (imagePath){more}: were outlines mixed \
             up? Where they fit, save them again on their own",
            first.file,
            other.display()
        ))
    }

    /// LabelMe files that don't say their picture's size: a warning where an outline seems to be of another, else a
    /// note, unless the network looks at all outlines anyway.
    fn unknown_size(&self, is_warning: bool) -> Option<String> {
        let all = &self.of_unknown_size;
        let odd: Vec<&str> = all.iter().filter(|(_, is_odd)| *is_odd).map(|(photo, _)| photo.file.as_str()).collect();
        let what = "LabelMe file(s) don't say the size of the picture they were drawn on (imageWidth, imageHeight";
        let look = if self.options.check_outlines { "look at them with `lunula edit`" } else { CHECK };
        match (odd.first(), is_warning) {
            (Some(first), true) => Some(format!(
                "{} {what}), and on {} of these photographs ({first} first) an outline reaches beyond it or is not \
                 where a finger is seen: were photographs resized or cropped after it? {look}",
                all.len(),
                odd.len()
            )),
            (None, false) if !self.options.check_outlines => Some(format!(
                "{} {what}; {} first), so whether photographs were resized after it isn't known: {look}",
                all.len(),
                all.first()?.0.file
            )),
            _ => None,
        }
    }

    /// Values are as the file encodes them, so photographs of several profiles are not comparable to the last bit.
    fn mixed_profiles(&self) -> Option<String> {
        let kind = |(name, of): (&Option<String>, &Encoded<'_>)| {
            let name = name.as_deref().map_or("sRGB or none".to_owned(), |name| {
                format!("{name}, green of skin {:+.1} of 255 against sRGB's", of.skin_green)
            });
            format!("{} photograph(s) of {name} ({} first)", of.count, of.first)
        };
        let kinds: Vec<String> = self.profiles.iter().map(kind).collect();
        // One profile may have several names.
        let green = || self.profiles.values().map(|of| of.skin_green);
        let apart = green().fold(f32::NEG_INFINITY, f32::max) - green().fold(f32::INFINITY, f32::min);
        (apart >= Profile::SAME).then(|| {
            format!(
                "the set mixes colour profiles: {}; values are as the files encode them: export all as sRGB, or make \
                 maps of each kind apart",
                kinds.join("; ")
            )
        })
    }

    /// Photographs of 16 bits, of which none uses more than a quarter of full scale: values are a fraction of what they
    /// should be.
    fn few_bits(&self) -> Option<String> {
        let (count, largest) = self.sixteen;
        let white_of = |bits: u32| (1_u32 << bits) - 1;
        let bits = FEW_BITS.into_iter().find(|bits| u32::from(largest) <= white_of(*bits))?;
        (self.options.normalization.white.is_none() && largest > 0).then(|| {
            format!(
                "the largest sample of the {count} photograph(s) of 16 bits is {largest} of 65535, as of {bits} bits \
                 kept in 16: if they are, --white {} makes that full scale",
                white_of(bits)
            )
        })
    }
}

/// What to do about outlines that may be elsewhere than their nails.
const CHECK: &str = "--check-outlines looks at each";

/// Bits that scientific cameras keep in 16; a set whose largest sample has no more is noted.
const FEW_BITS: [u32; 4] = [8, 10, 12, 14];

/// Of `lunula photos`.
pub(in crate::photo) fn of_photos(found: Findings<'_>, mut poses: Vec<PoseCount>, watch: &Watch<'_>) -> PhotosReport {
    sort_by_pose(&mut poses, |counted| &counted.pose);
    let warnings = found.warnings();
    let unknown_size = found.unknown_size(false);
    let all_grey = !found.colours.is_empty() && found.colours.values().all(|[colour, _]| *colour == 0);
    let Findings { set, options, has_maps, rows, failed, left_out, detects, outlines, .. } = found;
    let mut notes: Vec<String> = outlines.iter().flat_map(SavedOutlines::notes).collect();
    notes.extend(set.unlisted.first().map(|first| {
        format!("{} photograph(s) beside those that photos.csv names are not used ({first} first)", set.unlisted.len())
    }));
    notes.extend(unknown_size);
    notes.extend(one_subject(&poses).filter(|_| has_maps));
    let some_drawn = rows.iter().any(|row| row.source != Source::Detected);
    let used = || rows.iter().filter(|row| row.normalized.is_some());
    let mut photographs: Vec<usize> = used().map(|row| row.photo).collect();
    photographs.dedup();
    let figures = PhotosFigures {
        inputs: vec![set.folder.clone()],
        normalization: options.normalization,
        counts: json!({
            "photographs": set.photos.len(),
            "photographs_used": photographs.len(),
            "nails": rows.len(),
            "nails_used": used().count(),
        }),
        poses,
        channels: None,
        threads: rayon::current_num_threads(),
        nails: rows,
    };
    let failed = failed.iter().map(ToString::to_string).collect();
    let mut report = Report { left_out, warnings, notes, failed, ..Report::new("photos", watch, figures) };
    if options.outlines.masks.is_none() {
        report.unused(&["mask_value"], "there is no folder of --masks");
    }
    if !some_drawn {
        report.unused(&["annotations", "distal"], "no outline was drawn");
    }
    if all_grey {
        report.unused(&["channel", "channels"], "every photograph is grey");
    }
    if !detects {
        report.unused(&["detector", "detect_size"], "no outline has to be detected");
    }
    report
}

pub(in crate::photo) fn of_merge(parts: &[PathBuf], partials: &Partials, watch: &Watch<'_>) -> PhotosReport {
    let poses = pose_counts(partials);
    let notes = one_subject(&poses).into_iter().collect();
    let figures = PhotosFigures {
        inputs: parts.to_vec(),
        normalization: partials.normalization,
        counts: json!({ "parts": parts.len() }),
        poses,
        channels: None,
        threads: rayon::current_num_threads(),
        nails: Vec::new(),
    };
    let mut left_out = vec!["photographs: not read again, their sums are joined".into()];
    if parts.iter().any(|part| part.join("channels.csv").exists()) {
        left_out
            .push("channels compared: over all subjects, so photographs are needed: `lunula photos --channels`".into());
    }
    let mut warnings = doubts_of_sums(partials);
    let poses_of = || partials.poses.iter();
    warnings.extend(pose::doubts(|| {
        poses_of().flat_map(|(pose, sums)| sums.subjects().map(move |subject| (pose.as_str(), subject)))
    }));
    Report { left_out, warnings, notes, ..Report::new("photos merge", watch, figures) }
}

impl PhotosReport {
    /// Writes `run.json` and `report.html`, all else of the results being written already. An earlier run's results in
    /// the same folder are not deleted, but nobody should take them for this run's: they become a warning.
    pub(in crate::photo) fn write(
        &mut self,
        nails: &NailTable,
        sheets: &[DrawnSheet],
        nail_sheets: &[DrawnSheet],
        staging: &Staging,
    ) -> Result<(), WriteError> {
        self.warn_of_left(&staging.left_from_earlier(&[]));
        self.warn_of_replaced(&staging.target().join(JSON));
        staging.write(HTML, self.html(nails, sheets, nail_sheets).as_bytes())?;
        staging.write(JSON, self.text().as_bytes())
    }

    /// A page of sheets, nails, what was left out and why, times. Nothing is loaded from elsewhere.
    fn html(&self, nails: &NailTable, sheets: &[DrawnSheet], nail_sheets: &[DrawnSheet]) -> String {
        let mut page = Page::new("Fingernail coloration");
        page.reserve(sheets.iter().chain(nail_sheets).map(|sheet| sheet.png.len()).sum());
        let poses: Vec<String> = self.poses.iter().map(|p| format!("{} (n = {})", p.pose, p.subjects)).collect();
        page.paragraph(&format!("lunula {} {}, {}", self.version, self.job, list_paths(&self.inputs)));
        page.paragraph(&match &poses[..] {
            [] => "Not one nail could be used, so there are no maps.".to_owned(),
            poses => format!("Poses and subjects: {}.", poses.join(", ")),
        });
        page.list(&self.warnings);
        page.list(&self.notes);
        for sheet in sheets {
            page.heading(&sheet.title);
            page.png(&sheet.png, &sheet.title);
        }
        if let Some(channels) = &self.channels {
            add_section(&mut page, channels);
        }
        if !nail_sheets.is_empty() {
            page.heading("What was found, and every nail, distal end up");
        }
        for sheet in nail_sheets {
            page.png(&sheet.png, &sheet.title);
        }
        let used = (0..nails.rows.len()).filter(|&row| nails.is_used(row)).count();
        page.heading(&format!("Nails: {} listed, {used} used", nails.rows.len()));
        page.table(&nail_columns(), &nails.rows, |row| !nails.is_used(row));
        if !self.failed.is_empty() {
            page.heading("Photographs that gave nothing");
            page.list(&self.failed);
        }
        page.heading("What the scene did not need");
        page.list(&self.left_out);
        page.heading("Time");
        let total: f64 = self.stages.iter().map(|s| s.thread_s).sum();
        let share = |s: &Stage| if total > 0.0 { 100.0 * s.thread_s / total } else { 0.0 };
        let row = |s: &Stage| {
            vec![s.stage.to_string(), format!("{:.3}", s.thread_s), format!("{:.0} %", share(s)), s.runs.to_string()]
        };
        let rows: Vec<Vec<String>> = self.stages.iter().map(row).collect();
        page.table(&["stage", "s, summed over threads", "share", "runs"], &rows, |_| false);
        page.paragraph(&format!(
            "{:.2} s from start to end on {} thread(s), this page not counted.",
            self.wall_s, self.threads
        ));
        page.heading("Options");
        page.paragraph(&json!({ "options": self.options, "normalization": self.normalization }).to_string());
        page.finish()
    }
}

fn list_paths(paths: &[PathBuf]) -> String {
    paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ")
}
