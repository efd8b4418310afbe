//! What a run says of itself: `run.json` for scripts, `report.html` for a colleague.

use std::path::PathBuf;
use std::time::Duration;

use serde::Serialize;
use serde_json::{Value, json};

use super::job::{PhotosOptions, PhotosResult};
use super::nail_row::NailRow;
use super::partial::Partials;
use super::read::MOST_MEGAPIXELS;
use super::results::{NAIL_COLUMNS, nail_cells, sheet_names};
use super::set::{PhotoSet, SetFault};
use crate::figure::{Page, Sheet, Tile};
use crate::files::{Staging, WriteError};
use crate::stages::Stage;

/// One run of `photos` or `photos merge`, as `run.json` and `--json` show it. Times differ from run to run; all else is
/// the same for the same input and options.
#[derive(Debug, Clone, Serialize)]
pub struct RunReport {
    /// `photos` or `photos merge`.
    pub job: &'static str,
    /// Of lunula.
    pub version: &'static str,
    /// What it worked on.
    pub inputs: Vec<PathBuf>,
    /// Every option that shapes the result.
    pub options: Value,
    /// Photographs and entries given, photographs that gave at least one nail, nails listed and used.
    pub counts: Value,
    /// Subjects by pose.
    pub poses: Vec<PoseCount>,
    /// What failed, with its place.
    pub failed: Vec<SetFault>,
    /// What a reader of the maps should know.
    pub warnings: Vec<String>,
    /// What the scene did not need.
    pub left_out: Vec<String>,
    /// Time by stage, summed over threads.
    pub stages: Vec<Stage>,
    /// From start to end, seconds.
    pub wall_s: f64,
    /// Threads that worked.
    pub threads: usize,
}

/// How many subjects a pose's maps hold.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PoseCount {
    /// The pose.
    pub pose: String,
    /// Its subjects.
    pub subjects: usize,
}

fn pose_counts(partials: &Partials) -> Vec<PoseCount> {
    partials
        .poses
        .iter()
        .map(|(pose, sums)| PoseCount { pose: pose.clone(), subjects: sums.subjects().len() })
        .collect()
}

impl RunReport {
    /// Of `lunula photos`.
    pub fn of_photos(set: &PhotoSet, options: &PhotosOptions, result: &PhotosResult, wall: Duration) -> Self {
        let outlines = &options.outlines;
        let mut gave: Vec<usize> = result.rows.iter().filter(|r| r.normalized.is_some()).map(|r| r.photo).collect();
        gave.dedup();
        Self {
            job: "photos",
            version: env!("CARGO_PKG_VERSION"),
            inputs: vec![set.folder.clone()],
            options: json!({
                "normalization": options.normalization,
                "outline": outlines.sources,
                "masks": outlines.masks,
                "mask_value": outlines.mask_values,
                "distal": outlines.distal,
                "annotations": outlines.drawn,
                "max_megapixels": options.max_megapixels.unwrap_or(MOST_MEGAPIXELS),
            }),
            counts: json!({
                "photographs": set.photos.len(),
                "photographs_used": gave.len(),
                "nails": result.rows.len(),
                "nails_used": result.rows.iter().filter(|r| r.normalized.is_some()).count(),
            }),
            poses: pose_counts(&result.partials),
            failed: result.failed.clone(),
            warnings: result.warnings.clone(),
            left_out: result.left_out.clone(),
            stages: result.stages.list(),
            wall_s: wall.as_secs_f64(),
            threads: rayon::current_num_threads(),
        }
    }

    /// Of `lunula photos merge`.
    pub fn of_merge(
        parts: &[PathBuf],
        partials: &Partials,
        warnings: Vec<String>,
        stages: Vec<Stage>,
        wall: Duration,
    ) -> Self {
        Self {
            job: "photos merge",
            version: env!("CARGO_PKG_VERSION"),
            inputs: parts.to_vec(),
            options: json!({ "normalization": partials.normalization }),
            counts: json!({ "parts": parts.len() }),
            poses: pose_counts(partials),
            failed: Vec::new(),
            warnings,
            left_out: vec!["photographs: not read again, their sums are joined".into()],
            stages,
            wall_s: wall.as_secs_f64(),
            threads: rayon::current_num_threads(),
        }
    }

    /// Writes `run.json`.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn write_json(&self, staging: &Staging) -> Result<(), WriteError> {
        let text = serde_json::to_string_pretty(self).map_err(|why| staging.refused("run.json", why))?;
        staging.write("run.json", (text + "\n").as_bytes())
    }

    /// Writes `report.html` and the sheets of all nails on it: sheets, nails, what was left out and why, times. Nothing
    /// is loaded from elsewhere.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn write_html(&self, nails: &NailTable, staging: &Staging) -> Result<(), WriteError> {
        let refused = |why: image::ImageError| staging.refused("report.html", why);
        let mut page = Page::new("Fingernail coloration");
        let poses: Vec<String> = self.poses.iter().map(|p| format!("{} (n = {})", p.pose, p.subjects)).collect();
        page.paragraph(&format!("lunula {} {}, {}", self.version, self.job, list_paths(&self.inputs)));
        page.paragraph(&format!("Poses and subjects: {}.", poses.join(", ")));
        page.list(&self.warnings);
        for (name, title) in sheet_names() {
            page.heading(title);
            page.png(&staging.read(&format!("figures/{name}.png"))?, title);
        }
        if !nails.sheets.is_empty() {
            page.heading("Every nail, distal end up");
        }
        for (number, sheet) in (1..).zip(&nails.sheets) {
            let png = sheet.png().map_err(refused)?;
            page.png(&png, &sheet.title);
            staging.write(&format!("figures/nails-{number}.png"), &png)?;
        }
        page.heading(&format!("Nails: {} listed, {} used", nails.rows.len(), nails.rows.len() - nails.left_out()));
        page.table(&NAIL_COLUMNS, &nails.rows, |row| nails.rows[row][USED] != "true");
        if !self.failed.is_empty() {
            page.heading("Photographs that gave nothing");
            let rows: Vec<Vec<String>> = self.failed.iter().map(|f| vec![f.place.clone(), f.what.clone()]).collect();
            page.table(&["where", "what is wrong, what to do"], &rows, |_| true);
        }
        page.heading("What the scene did not need");
        page.list(&self.left_out);
        page.heading("Time");
        let total: f64 = self.stages.iter().map(|s| s.thread_s).sum();
        let rows: Vec<Vec<String>> = self
            .stages
            .iter()
            .map(|s| {
                let share = if total > 0.0 { 100.0 * s.thread_s / total } else { 0.0 };
                vec![s.stage.to_string(), format!("{:.3}", s.thread_s), format!("{share:.0} %"), s.runs.to_string()]
            })
            .collect();
        page.table(&["stage", "s, summed over threads", "share", "runs"], &rows, |_| false);
        page.paragraph(&format!(
            "{:.2} s from start to end on {} thread(s), this page not counted.",
            self.wall_s, self.threads
        ));
        page.heading("Options");
        page.paragraph(&self.options.to_string());
        staging.write("report.html", page.finish().as_bytes())
    }
}

const USED: usize = 11;
/// Nails a sheet of thumbnails.
const NAILS_A_SHEET: usize = 130;
const NAILS_A_ROW: usize = 13;

/// The nails of a report: table and thumbnails.
#[derive(Debug, Clone, Default)]
pub struct NailTable {
    rows: Vec<Vec<String>>,
    sheets: Vec<Sheet>,
}

impl NailTable {
    /// From a run's rows.
    pub fn of(rows: &[NailRow], set: &PhotoSet) -> Self {
        let tiles: Vec<Tile> = rows
            .iter()
            .filter_map(|row| {
                let photo = &set.photos[row.photo];
                let caption = format!("{}: {}", row.number, photo.subject);
                Some(Tile { caption, picture: row.thumbnail.clone()?, png: None })
            })
            .collect();
        let sheets = tiles
            .chunks(NAILS_A_SHEET)
            .enumerate()
            .map(|(k, tiles)| Sheet {
                title: format!("Normalized nails, sheet {}", k + 1),
                tiles: tiles.to_vec(),
                columns: NAILS_A_ROW,
                scale: None,
            })
            .collect();
        Self { rows: rows.iter().map(|row| nail_cells(row, set).to_vec()).collect(), sheets }
    }

    /// From the tables of merged parts, in the order that one run would have given: by pose, subject, file, nail.
    pub fn of_parts(mut rows: Vec<Vec<String>>) -> Self {
        let key =
            |row: &Vec<String>| (row[3].clone(), row[2].clone(), row[0].clone(), row[1].parse::<u32>().unwrap_or(0));
        rows.sort_by_key(key);
        Self { rows, sheets: Vec::new() }
    }

    /// The cells, row by row.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    fn left_out(&self) -> usize {
        self.rows.iter().filter(|row| row[USED] != "true").count()
    }
}

fn list_paths(paths: &[PathBuf]) -> String {
    paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ")
}
