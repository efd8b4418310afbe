//! How detection by the network does on photographs that neither its weights nor its calibration have seen.
//!
//! In: photographs of hands with masks, their true axes, which fold each belongs to, and for each fold the network
//! trained without it (`fold-0.f16`) with the calibration of the other folds (`fold-0.txt`). Out: a table, and where
//! it is wanted each photograph with what was found drawn over it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use image::{DynamicImage, Rgb, RgbImage};
use imageproc::drawing::draw_line_segment_mut;
use lunula::photo::outline::training::{NailNet, detect_by};
use lunula::photo::outline::{Axis, DetectOptions, Detected, Outline, outlines_from_mask};
use rayon::prelude::*;

/// Where everything is.
#[derive(Debug, clap::Args)]
pub struct Folds {
    /// Networks and calibrations: fold-0.f16, fold-0.txt, ...
    #[arg(long, value_name = "FOLDER")]
    nets: PathBuf,
    /// Which photograph belongs to which fold: columns photograph (the start of its name), fold
    #[arg(long, value_name = "CSV", default_value = "crates/training/nail-net/folds.csv")]
    folds: PathBuf,
    /// True axes: columns file, x_px, y_px, axis_deg
    #[arg(long, value_name = "CSV", default_value = "tests/data/real_nail_axes.csv")]
    axes: PathBuf,
    /// Draw every photograph with what was found here
    #[arg(long, value_name = "FOLDER")]
    sheets: Option<PathBuf>,
}

/// A photograph with its truth, and what was found.
struct Seen {
    fold: String,
    look: Look,
    nails: usize,
    finds: Vec<Find>,
}

struct Find {
    is_confident: bool,
    /// With the best true outline: of the outline found, and of the network's own.
    iou: f64,
    unrefined: f64,
    /// How far its axis is off, degrees.
    off_deg: f64,
}

/// How a photograph is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Look {
    Colour,
    /// Dark skin: what has the colour of skin is darkened, the nails on it less.
    Dark,
    /// As a green filter and a camera without colour show it.
    Green,
}

/// The table of all folds.
///
/// # Errors
/// A file that can't be read, with its path.
pub fn table(hands: &Path, with: &Folds) -> anyhow::Result<String> {
    let mut axes: BTreeMap<String, Vec<[f64; 3]>> = BTreeMap::new();
    for row in csv::Reader::from_path(&with.axes).with_context(|| with.axes.display().to_string())?.deserialize() {
        let (file, x, y, axis): (String, f64, f64, f64) = row?;
        axes.entry(file).or_default().push([x, y, axis]);
    }
    let mut folds: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for row in csv::Reader::from_path(&with.folds).with_context(|| with.folds.display().to_string())?.records() {
        let row = row?;
        folds.entry(row[1].to_owned()).or_default().push(row[0].to_owned());
    }
    let mut all = Vec::new();
    for (fold, names) in &folds {
        let weights = with.nets.join(format!("fold-{fold}.f16"));
        let Ok(bytes) = std::fs::read(&weights) else { continue };
        let calibration = weights.with_extension("txt");
        let text = std::fs::read_to_string(&calibration).with_context(|| calibration.display().to_string())?;
        let net = NailNet::parse(&bytes, &text).with_context(|| weights.display().to_string())?;
        let files: Vec<(&String, &Vec<[f64; 3]>)> =
            axes.iter().filter(|(file, _)| names.iter().any(|name| file.starts_with(name.as_str()))).collect();
        let seen = files.par_iter().flat_map_iter(|(file, truth)| {
            Look::ALL.map(|look| look.seen(&net, fold, hands, file, truth, with.sheets.as_deref()))
        });
        all.extend(seen.collect::<anyhow::Result<Vec<_>>>()?);
    }
    let mut text = String::from("| fold | look | nails | confident: recall 0.5, 0.7, precision | with doubtful | IoU");
    text += " in median (unrefined) | distal end wrong |\n|---|---|---|---|---|---|---|\n";
    for look in Look::ALL {
        for fold in folds.keys().map(String::as_str).chain(["all"]) {
            let own: Vec<&Seen> = all.iter().filter(|s| s.look == look && (fold == "all" || s.fold == fold)).collect();
            if !own.is_empty() {
                writeln!(text, "{}", line(fold, look, &own))?;
            }
        }
    }
    Ok(text)
}

fn line(fold: &str, look: Look, seen: &[&Seen]) -> String {
    let nails = seen.iter().map(|s| s.nails).sum::<usize>() as f64;
    let finds: Vec<&Find> = seen.iter().flat_map(|s| &s.finds).collect();
    let sure: Vec<&Find> = finds.iter().copied().filter(|f| f.is_confident).collect();
    let right = |finds: &[&Find], iou: f64| finds.iter().filter(|f| f.iou >= iou).count() as f64;
    let median = |value: fn(&Find) -> f64| {
        let mut values: Vec<f64> = sure.iter().map(|f| value(f)).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let turned = sure.iter().filter(|f| f.iou >= 0.5 && f.off_deg > 45.0).count();
    format!(
        "| {fold} | {look:?} | {nails} | {:.3}, {:.3}, {:.3} of {} | {:.3} of {} | {:.3} ({:.3}) | {turned} |",
        right(&sure, 0.5) / nails,
        right(&sure, 0.7) / nails,
        right(&sure, 0.5) / sure.len().max(1) as f64,
        sure.len(),
        right(&finds, 0.5) / nails,
        finds.len(),
        median(|f| f.iou),
        median(|f| f.unrefined),
    )
}

impl Look {
    const ALL: [Self; 3] = [Self::Colour, Self::Dark, Self::Green];

    fn of(self, image: DynamicImage, mask: &DynamicImage) -> DynamicImage {
        let mut rgb = image.to_rgb8();
        match self {
            Self::Colour => image,
            Self::Dark => {
                for (pixel, mask) in rgb.pixels_mut().zip(mask.to_luma8().pixels()) {
                    let [r, g, b] = pixel.0.map(f64::from);
                    let is_skin = r > 60.0 && r > 1.08 * g && g > 0.8 * b;
                    // Of the gains that make light skin dark: the share that reaches a nail's bed.
                    let share = if mask.0[0] > 127 { 0.6 } else { f64::from(u8::from(is_skin)) };
                    let gain = [0.55, 0.40, 0.28].map(|gain: f64| gain.powf(share));
                    pixel.0 = [r * gain[0], g * gain[1], b * gain[2]].map(|v| v.round() as u8);
                }
                rgb.into()
            }
            Self::Green => {
                let green = rgb.pixels().map(|p| p.0[1]).collect();
                image::GrayImage::from_raw(rgb.width(), rgb.height(), green).expect("a value a pixel").into()
            }
        }
    }

    fn seen(
        self,
        net: &NailNet,
        fold: &str,
        hands: &Path,
        file: &str,
        axes: &[[f64; 3]],
        sheets: Option<&Path>,
    ) -> anyhow::Result<Seen> {
        let open = |folder: &str| {
            let path = hands.join(folder).join(file);
            image::open(&path).with_context(|| path.display().to_string())
        };
        let mask = open("masks")?;
        let image = self.of(open("images")?, &mask);
        let truths = outlines_from_mask(&mask)?.nails;
        let (unrefined, _) = net.segments(&image)?;
        let found = detect_by(net, &image, &DetectOptions::default())?;
        let one = |(found, is_confident): (&Detected, bool)| {
            let best = truths.iter().max_by(|a, b| a.iou(&found.outline).total_cmp(&b.iou(&found.outline)));
            let iou = |outline: &Outline| best.map_or(0.0, |truth| truth.iou(outline));
            Find {
                is_confident,
                iou: iou(&found.outline),
                unrefined: unrefined.iter().map(|s| iou(&s.outline)).fold(0.0, f64::max),
                off_deg: best.and_then(|truth| off_deg(truth, found.axis, axes)).unwrap_or(0.0),
            }
        };
        if let Some(folder) = sheets {
            std::fs::create_dir_all(folder)?;
            sheet(&image, &truths, &found.nails, &found.doubtful)
                .save(folder.join(format!("{fold}-{self:?}-{file}.png")))?;
        }
        let all = found.nails.iter().map(|nail| (nail, true)).chain(found.doubtful.iter().map(|nail| (nail, false)));
        Ok(Seen { fold: fold.to_owned(), look: self, nails: truths.len(), finds: all.map(one).collect() })
    }
}

fn off_deg(truth: &Outline, axis: Axis, axes: &[[f64; 3]]) -> Option<f64> {
    let [x, y] = lunula::photo::outline::Moments::of(truth).centroid_px;
    let away = |row: &&[f64; 3]| (row[0] - x).hypot(row[1] - y);
    let row = axes.iter().min_by(|a, b| away(a).total_cmp(&away(b)))?;
    Some(axis.apart_deg(Axis::from_clockwise_rad(row[2].to_radians())))
}

/// The photograph, true outlines white, confident finds green, doubtful ones yellow, with a line to the distal end.
fn sheet(image: &DynamicImage, truths: &[Outline], sure: &[Detected], doubtful: &[Detected]) -> RgbImage {
    let mut picture = image.to_rgb8();
    let mut draw = |points: &[[f64; 2]], colour: [u8; 3]| {
        for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
            let [a, b] = [a, b].map(|p| (p[0] as f32, p[1] as f32));
            draw_line_segment_mut(&mut picture, a, b, Rgb(colour));
        }
    };
    for truth in truths {
        draw(&truth.points(), [255; 3]);
    }
    let found = sure.iter().map(|one| (one, [0, 220, 60])).chain(doubtful.iter().map(|one| (one, [255, 220, 0])));
    for (one, colour) in found {
        draw(&one.outline.points(), colour);
        let [x, y] = lunula::photo::outline::Moments::of(&one.outline).centroid_px;
        let reach = 0.5 * one.outline.area_px2().sqrt();
        let [dx, dy] = one.axis.distal();
        draw(&[[x, y], [x + reach * dx, y + reach * dy]], colour);
    }
    picture
}
