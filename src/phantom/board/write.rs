//! A scene to files: views are drawn one after the other, each by all threads, and put in their places at the end.

use std::fs;
use std::io;
use std::path::Path;
use std::time::Instant;

use image::ExtendedColorType;
use serde_json::json;

use super::{BoardOptions, Picture, Scene, View};
use crate::figure::encode_png;
use crate::job::Watch;
use crate::phantom::scene::faults::Faults;
use crate::phantom::scene::place::{Error, Unwritten, refused, staged, write_record};
use crate::phantom::scene::recording::{Cost, Generated, Written, sorted};
use crate::table::{Column, TableWriter, Value};

/// The file that says that a folder was written here.
const RECORD: &str = "truth/board.json";
const PLANE: &str = "plane.png";
const CAMERA: &str = "truth/camera.toml";
const CORNERS: &str = "truth/corners.csv";
const VIEWS: &str = "truth/views.csv";
/// The record first: where it exists, what is of one run and what of another is made again.
const RESULTS: [&str; 6] = [RECORD, "views", PLANE, CAMERA, CORNERS, VIEWS];

/// Seconds on one thread a pixel of a view (assumed).
const VIEW_S_PER_PX: f64 = 4e-7;

impl Generated for BoardOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> serde_json::Value {
        json!({ "board": self })
    }

    fn files(&self) -> Vec<String> {
        let always = [RECORD, CAMERA, CORNERS, VIEWS].into_iter().chain(self.plane.map(|_| PLANE));
        sorted((0..self.views).map(view_name).chain(always.map(str::to_owned)))
    }

    fn cost(&self) -> Cost {
        Cost::of_pictures([self.size.0, self.size.1].map(f64::from), self.views as f64, VIEW_S_PER_PX)
    }

    /// Views are drawn one after the other, each by all threads.
    fn write_watched(&self, folder: &Path, watch: &Watch<'_>) -> Result<Written, Error> {
        let scene = Scene::new(self.clone())?;
        let begin = Instant::now();
        let staging = staged(folder, &RESULTS, RECORD, "a synthetic board's")?;
        let stage = staging.path();
        let views = stage.join("views");
        fs::create_dir(&views).map_err(refused(&views))?;
        let named = scene.views.iter().enumerate().map(|(index, view)| (view_name(index), view));
        let named: Vec<(String, &View)> =
            named.chain(scene.plane.iter().map(|view| (PLANE.to_owned(), view))).collect();
        for (index, (name, view)) in named.iter().enumerate() {
            write_picture(&scene.picture(std::slice::from_ref(*view), index as u32), &stage.join(name))?;
            (watch.tick)(index as u64 + 1, Some(named.len() as u64));
            watch.go_on()?;
        }
        write_truth(&scene, &named, stage)?;
        staging.commit_exactly(&RESULTS)?;
        let (count, total_s) = (named.len(), begin.elapsed().as_secs_f64());
        let figures = json!({ "options": self, "views": count, "total_s": total_s });
        Ok(Written { count, figures, total_s, warnings: Vec::new() })
    }
}

fn view_name(index: usize) -> String {
    format!("views/{:02}.png", index + 1)
}

fn write_picture(picture: &Picture, path: &Path) -> Result<(), Unwritten> {
    let mut png = Vec::new();
    encode_png(&picture.data, [picture.width, picture.height], ExtendedColorType::L8, &mut png)
        .map_err(|why| refused(path)(io::Error::other(why)))?;
    fs::write(path, png).map_err(refused(path))
}

fn write_truth(scene: &Scene, named: &[(String, &View)], stage: &Path) -> Result<(), Error> {
    let start = |name: &str, columns: Vec<Column>| {
        let path = stage.join(name);
        TableWriter::create(&path, &path, columns, &[])
    };
    let numbers = |names: &[&str]| names.iter().map(|name| Column::number(*name)).collect::<Vec<_>>();
    let corner = vec![Column::text("view"), Column::integer("corner")];
    let mut corners = start(CORNERS, [corner, numbers(&["x_px", "y_px"])].concat())?;
    let pose = ["tilt_deg", "rx_rad", "ry_rad", "rz_rad", "tx_mm", "ty_mm", "tz_mm"];
    let mut views = start(VIEWS, [vec![Column::text("view")], numbers(&pose)].concat())?;
    for (name, view) in named {
        for (k, [x, y]) in scene.corners_px(view).into_iter().enumerate() {
            corners.write(&[name[..].into(), Value::Integer(k as i64), Value::Number(x), Value::Number(y)])?;
        }
        // The rotation's axis times its angle.
        let (turned, moved) = (view.rotation.scaled_axis(), view.translation_mm);
        let pose = [view.tilt_deg(), turned.x, turned.y, turned.z, moved.x, moved.y, moved.z];
        let row: Vec<Value<'_>> = std::iter::once(name[..].into()).chain(pose.map(Value::Number)).collect();
        views.write(&row)?;
    }
    corners.finish()?;
    views.finish()?;
    let camera = stage.join(CAMERA);
    fs::write(&camera, camera_toml(&scene.options)).map_err(refused(&camera))?;
    Ok(write_record(&stage.join(RECORD), &scene.options)?)
}

/// The true lens, as marker files have it.
fn camera_toml(options: &BoardOptions) -> String {
    let ([fx, fy], [cx, cy], (width, height)) = (options.focal_px(), options.centre_px(), options.size);
    let mut distortion = [0.0; 5];
    distortion.iter_mut().zip(&options.distortion).for_each(|(into, &from)| *into = from);
    let mut text = format!(
        "[camera]\nsize = [{width}, {height}]\nfx = {fx:?}\nfy = {fy:?}\ncx = {cx:?}\ncy = {cy:?}\n\
         distortion = {distortion:?}\n"
    );
    if let Some(plane) = options.plane {
        text += &format!("\n[camera.plane]\nnormal = {:?}\n", plane.normal());
    }
    text
}
