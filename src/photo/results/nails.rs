//! The nails of a result: rows of `nails.csv`, and their sheets of thumbnails.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::ops::Range;
use std::path::{Path, PathBuf};

use image::GrayAlphaImage;
use rayon::prelude::*;

use super::draw::DrawnSheet;
use crate::figure::{Sheet, Tile, TilePicture};
use crate::files::{Staging, WriteError};
use crate::input;
use crate::photo::error::MergeError;
use crate::photo::hues::Hues;
use crate::photo::normalize::{NailFrame, Survey};
use crate::photo::outline::{Axis, Nail, Outline, Source};
use crate::photo::pose::rank;
use crate::photo::set::{Photo, PhotoSet};
use crate::table::csv_bytes;

/// One nail of the result: a row of `nails.csv`.
#[derive(Debug, Clone)]
pub struct NailRow {
    /// Index of its photograph in the set.
    pub photo: usize,
    /// Counted from 1 within the photograph.
    pub number: usize,
    /// Where its outline came from.
    pub source: Source,
    /// 0 to 1, missing where nothing is known.
    pub confidence: Option<f64>,
    /// Its box, where there is one.
    pub frame: Option<NailFrame>,
    /// Its axis may be known where its box is not.
    pub axis: Option<Axis>,
    /// Name of its normalized picture among the results, if those are written; `None` where it was left out.
    pub normalized: Option<String>,
    /// The share of it at full scale; 0 where it was left out.
    pub at_full_scale: f64,
    /// Of its normalized picture, where there is one.
    pub(in crate::photo) survey: Option<Survey>,
    /// Its colours, and the skin's below it.
    pub(in crate::photo) hues: Hues,
    /// By how much the picture sees the drawn axis slant, degrees clockwise, where that is much.
    pub(in crate::photo) slants_deg: Option<f64>,
    /// An earlier nail of the photograph that is drawn around the same place, by its number.
    pub(in crate::photo) drawn_over: Option<usize>,
    /// An earlier region of its mask that it touches along a long border, by its number.
    pub(in crate::photo) touches: Option<usize>,
    /// Of a drawn outline, the same for the same corners to the last digit.
    pub(in crate::photo) drawn: Option<u64>,
    /// A point of the drawn outline that stands out alone, pixels.
    pub(in crate::photo) spike_px: Option<[f64; 2]>,
    /// What the network sees instead of the drawn outline, in words.
    pub(in crate::photo) instead: Option<String>,
    /// Why it was left out, or what of it the photograph does not show; else empty.
    pub reason: String,
}

impl NailRow {
    /// A nail that was not worked on yet.
    pub(in crate::photo) fn new(photo: usize, number: usize, nail: &Nail) -> Self {
        let drawn = nail.outline.as_ref().filter(|_| nail.source != Source::Detected);
        let by_hand = drawn.filter(|_| nail.source == Source::Annotated);
        Self {
            photo,
            number,
            source: nail.source,
            confidence: nail.confidence,
            frame: None,
            axis: nail.axis,
            normalized: None,
            at_full_scale: 0.0,
            survey: None,
            hues: Hues::default(),
            slants_deg: nail.slants_deg,
            drawn_over: nail.drawn_over,
            touches: nail.touches,
            drawn: drawn.map(corners),
            spike_px: by_hand.and_then(Outline::spike),
            instead: None,
            reason: String::new(),
        }
    }
}

/// A number that stands for the corners of an outline.
fn corners(outline: &Outline) -> u64 {
    let mut all = DefaultHasher::new();
    outline.points().iter().for_each(|corner| corner.map(f64::to_bits).hash(&mut all));
    all.finish()
}

const NAME: &str = "nails.csv";
/// A column of `nails.csv`: its name and its cells, empty where nothing is known.
type NailColumn = (&'static str, fn(&NailRow, &Photo) -> String);
const COLUMNS: [NailColumn; 13] = [
    ("file", |_, photo| photo.file.clone()),
    ("nail", |row, _| row.number.to_string()),
    ("subject", |_, photo| photo.subject.clone()),
    ("pose", |_, photo| photo.pose.clone()),
    ("outline", |row, _| row.source.name().to_owned()),
    ("confidence", |row, _| number(row.confidence)),
    ("center_x_px", |row, _| number(row.frame.map(|f| f.center_px[0]))),
    ("center_y_px", |row, _| number(row.frame.map(|f| f.center_px[1]))),
    ("length_px", |row, _| number(row.frame.map(|f| f.length_px))),
    ("width_px", |row, _| number(row.frame.map(|f| f.width_px))),
    ("axis_deg", |row, _| number(row.axis.map(Axis::clockwise_deg))),
    ("used", |row, _| row.normalized.is_some().to_string()),
    ("reason", |row, _| row.reason.clone()),
];

fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.3}"))
}

/// The header of `nails.csv`.
pub(in crate::photo) fn nail_columns() -> [&'static str; COLUMNS.len()] {
    COLUMNS.map(|(name, _)| name)
}

/// Some columns of it: of which photograph, which of its nails and whose one is, where it lies, whether it was used.
const FILE: usize = 0;
const NUMBER: usize = 1;
const SUBJECT: usize = 2;
const POSE: usize = 3;
const FRAME: Range<usize> = 6..11;
const USED: usize = 11;
const NAILS_PER_SHEET: usize = 130;
const NAILS_PER_ROW: usize = 13;

/// Nails of one pose, or some of them.
#[derive(Debug)]
struct NailSheet {
    pose: String,
    /// Counted from 1 in the pose.
    number: usize,
    sheet: Sheet,
}

/// The nails of a report: table and thumbnails.
#[derive(Debug, Default)]
pub(in crate::photo) struct NailTable {
    /// Cells, row by row.
    pub(in crate::photo) rows: Vec<Vec<String>>,
    /// The part of each row, by its place among the parts; of a run none.
    parts: Vec<usize>,
    /// Every normalized picture, small, pose by pose; of merged parts none.
    sheets: Vec<NailSheet>,
}

impl NailTable {
    /// From a run's rows and, in the same order, the thumbnails of those that have one.
    pub(in crate::photo) fn of(rows: &[NailRow], thumbnails: Vec<Option<GrayAlphaImage>>, set: &PhotoSet) -> Self {
        let mut sheets: Vec<NailSheet> = Vec::new();
        for (row, picture) in rows.iter().zip(thumbnails) {
            let (Some(picture), Some(name)) = (picture, &row.normalized) else { continue };
            let pose = &set.photos[row.photo].pose;
            let last = sheets.last().filter(|last| last.pose == *pose);
            if last.is_none_or(|last| last.sheet.tiles.len() == NAILS_PER_SHEET) {
                let number = last.map_or(0, |last| last.number) + 1;
                let again = if number > 1 { format!(", sheet {number}") } else { String::new() };
                let title = format!("Normalized nails, {pose}{again}");
                let sheet = Sheet { title, tiles: Vec::new(), columns: NAILS_PER_ROW, scale: None };
                sheets.push(NailSheet { pose: pose.clone(), number, sheet });
            }
            let caption = Path::new(name).file_stem().unwrap_or_default().to_string_lossy().into_owned();
            if let Some(NailSheet { sheet, .. }) = sheets.last_mut() {
                sheet.tiles.push(Tile { caption, picture: TilePicture::Grey(picture), png: None });
            }
        }
        let cells = |row: &NailRow| COLUMNS.map(|(_, cell)| cell(row, &set.photos[row.photo])).to_vec();
        Self { rows: rows.iter().map(cells).collect(), parts: Vec::new(), sheets }
    }

    /// From the tables of parts, in the order that one run would have given: by pose, subject, file, nail.
    pub(in crate::photo) fn of_parts(parts: &[PathBuf]) -> Result<Self, MergeError> {
        let mut rows = Vec::new();
        for (at, part) in parts.iter().enumerate() {
            rows.extend(read(&part.join(NAME))?.into_iter().map(|row| (at, row)));
        }
        rows.sort_by_cached_key(|(_, row): &(usize, Vec<String>)| {
            let (place, pose) = rank(&row[POSE]);
            (place, pose.to_owned(), row[SUBJECT].clone(), row[FILE].clone(), row[NUMBER].parse::<u32>().unwrap_or(0))
        });
        let (parts, rows) = rows.into_iter().unzip();
        Ok(Self { rows, parts, sheets: Vec::new() })
    }

    /// What to say of several people's nails that lie at one place of their photographs, to a thousandth of a pixel.
    pub(in crate::photo) fn at_one_place(&self) -> Option<String> {
        let mut places: BTreeMap<&[String], Vec<&Vec<String>>> = BTreeMap::new();
        for row in self.rows.iter().filter(|row| row[USED] == "true") {
            places.entry(&row[FRAME]).or_default().push(row);
        }
        let several = |rows: &&Vec<&Vec<String>>| rows.iter().any(|row| row[SUBJECT] != rows[0][SUBJECT]);
        let mut files = places.values().filter(several).map(|rows| {
            rows.iter().map(|row| format!("{} of {}", row[FILE], row[SUBJECT])).collect::<Vec<_>>().join(" and ")
        });
        let first = files.next()?;
        let more = files.count();
        let more = if more > 0 { format!(" ({more} more)") } else { String::new() };
        Some(format!(
            "nails of several people lie at one place to a thousandth of a pixel: {first}{more}; is one photograph a \
             copy of the other, or its outline? Keep the right one"
        ))
    }

    /// Writes `nails.csv`: every nail, used or not.
    pub(in crate::photo) fn write(&self, staging: &Staging) -> Result<(), WriteError> {
        staging.write(NAME, &csv_bytes(nail_columns(), &self.rows).map_err(|why| staging.refused(NAME, why))?)
    }

    pub(in crate::photo) fn draw_sheets(&self, staging: &Staging) -> Result<Vec<DrawnSheet>, WriteError> {
        let draw = |NailSheet { pose, number, sheet }: &NailSheet| {
            DrawnSheet::new(sheet, &format!("figures/{pose}-nails-{number}.png"), staging)
        };
        self.sheets.par_iter().map(draw).collect()
    }

    /// Where the normalized picture of each used subject would be, if its part has pictures: what else lies there is of
    /// an earlier run.
    pub(in crate::photo) fn pictures(&self, parts: &[PathBuf]) -> impl Iterator<Item = PathBuf> {
        let photograph = |row: usize| [self.rows[row][POSE].as_str(), self.rows[row][SUBJECT].as_str()];
        let mut nails: BTreeMap<(usize, [&str; 2]), usize> = BTreeMap::new();
        for (row, part) in self.parts.iter().enumerate() {
            *nails.entry((*part, photograph(row))).or_default() += 1;
        }
        let used = self.parts.iter().enumerate().filter(|(row, _)| self.is_used(*row));
        used.map(move |(row, part)| {
            let [pose, subject] = photograph(row);
            let several = nails[&(*part, [pose, subject])] > 1;
            let tail = if several { format!("-{}", self.rows[row][NUMBER]) } else { String::new() };
            parts[*part].join(format!("normalized/{pose}/{subject}{tail}.png"))
        })
    }

    /// Whether a row's nail is part of the maps.
    pub(in crate::photo) fn is_used(&self, row: usize) -> bool {
        self.rows[row][USED] == "true"
    }
}

fn read(file: &Path) -> Result<Vec<Vec<String>>, MergeError> {
    let wrong = |why: String| MergeError::Nails { file: file.to_owned(), why };
    let mut table = csv::Reader::from_reader(input::open(file).map_err(|e| wrong(e.to_string()))?);
    if table.headers().map_err(|e| wrong(e.to_string()))?.iter().ne(nail_columns()) {
        return Err(wrong(format!("its columns are not {}", nail_columns().join(","))));
    }
    let cells = |record: csv::StringRecord| record.iter().map(str::to_owned).collect();
    table.records().map(|record| record.map(cells).map_err(|e| wrong(e.to_string()))).collect()
}
