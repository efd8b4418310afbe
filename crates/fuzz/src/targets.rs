//! Every parser of lunula as a function of bytes: no input may make it panic, abort, hang or take memory without bound;
//! an error is an answer.
//!
//! `lunula-fuzz` looks for inputs that do, and `tests/parsers.rs`, which includes this file, tries those of
//! `tests/corpus/` again. What can be read only from files is written into a folder in memory first.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lunula::align::Posture;
use lunula::job::{Keys, Made, Maker, Work};
use lunula::live::streams::pointer;
use lunula::live::streams::source::{Address, OfFinger};
use lunula::live::streams::switch::SwitchConfig;
use lunula::live::streams::wire::{LineOptions, Lines, Meaning, Naming, Step, Use};
use lunula::log::{AmbientOptions, Columns, Log, samples};
use lunula::nail::Positions;
use lunula::photo::outline::{self, Axis, Drawn, find_axes, outlines_from_mask};
use lunula::photo::{NailFrame, Normalization, Photograph, Resample, join, normalize};
use lunula::pipeline::{Parts, PipelineMark, Share, Spec, Task};
use lunula::pipeline::{kinds, phantom_catalogue, scenes, survey};
use lunula::posture::{Layout, Lens};
use lunula::predictor::Answering;
use lunula::prompt::protocol::{Prompted, Protocol};
use lunula::table::Table;
use lunula_hemodynamics::{Collapse, Model, Parameters};
use lunula_predictor::{Gate, Predictor};

/// A parser.
#[derive(Clone, Copy)]
pub(crate) struct Target {
    /// Its name, and that of its folder of the corpus.
    pub(crate) name: &'static str,
    /// Reads an input.
    pub(crate) run: fn(&Desk, &[u8]),
}

pub(crate) const TARGETS: &[Target] = &[
    Target { name: "photograph", run: photograph },
    Target { name: "labelme", run: labelme },
    Target { name: "mask", run: mask },
    Target { name: "markers", run: markers },
    Target { name: "csv", run: csv },
    Target { name: "parquet", run: parquet },
    Target { name: "partials", run: partials },
    Target { name: "model", run: model },
    Target { name: "parameters", run: parameters },
    Target { name: "pipeline", run: pipeline },
    Target { name: "records", run: records },
    Target { name: "stream", run: stream },
    Target { name: "xdf", run: xdf },
    Target { name: "source", run: source },
    Target { name: "switch", run: switch },
    Target { name: "mouse", run: mouse },
    Target { name: "positions", run: positions },
    Target { name: "protocol", run: protocol },
];

/// What a parser is given besides an input.
pub(crate) struct Desk {
    folder: tempfile::TempDir,
    photo: Photograph,
    predictor: Predictor,
    pub(crate) task: Task,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        for name in ["out/.lunula/records", "out/.lunula/failures", "part/maps"] {
            std::fs::create_dir_all(place(name)).expect("a folder");
        }
        std::fs::write(place("part/run.json"), r#"{"poses":[{"pose":"a"}]}"#).expect("a file");
        std::fs::write(place("grey.png"), include_bytes!("../../../tests/corpus/photograph/grey.png")).expect("a file");
        let photo = Photograph::read(&place("grey.png")).expect("a photograph");
        let model = include_str!("../../../tests/corpus/model/lags.json");
        let predictor = Predictor::from_json(model).expect("a model").predictor;
        let task = Task {
            id: "t".to_owned(),
            stage: "t".to_owned(),
            keys: Keys::default(),
            inputs: Vec::new(),
            options: serde_json::Value::Null,
            share: Share::Part(0),
            memory: 0,
            cost_s: 0.0,
            job: Arc::new(Toy),
        };
        Self { folder, photo, predictor, task }
    }

    pub(crate) fn place(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.place(name);
        std::fs::write(&path, bytes).expect("a file in memory");
        path
    }
}

/// Writes one file.
struct Toy;

impl Maker for Toy {
    fn run(&self, work: &Work<'_>) -> anyhow::Result<Made> {
        std::fs::write(work.folder.join("a"), "a")?;
        Ok(Made::default())
    }
}

fn photograph(desk: &Desk, bytes: &[u8]) {
    // Time and memory go with the pixels, of which a file of some bytes may have millions.
    if let Ok(photo) = Photograph::read_up_to(&desk.file("photo", bytes), 4) {
        let _ = (photo.is_grey(), photo.depth(), photo.stored_size());
    }
}

/// Outlines onto a grey photograph of 48 x 64 pixels, on to the normalized nail.
fn labelme(desk: &Desk, bytes: &[u8]) {
    let Ok(drawn) = outline::read_annotated(&desk.file("nails.json", bytes), &desk.photo, Drawn::Auto) else { return };
    let with = Normalization { size: 8, resample: Resample::Nearest, ..Normalization::default() };
    for nail in drawn.nails.into_iter().take(4) {
        let Ok(outline) = nail.outline else { continue };
        // Looking for an axis takes a hundred times as long as all else: for one input of 16.
        let looked = || find_axes(&desk.photo.image, std::slice::from_ref(&outline)).remove(0).ok();
        let found = if bytes.len().is_multiple_of(16) { looked().map(|found| found.axis) } else { None };
        let axis = nail.axis.or(found).unwrap_or_else(|| Axis::from_clockwise_rad(0.1));
        if let Ok(frame) = NailFrame::new(&outline, axis) {
            let _ = normalize(&desk.photo.image, &frame, &with);
        }
    }
}

/// A picture file, or else a width and a depth (a byte each) and the pixels: an encoded picture is hardly ever changed
/// into another mask.
fn mask(desk: &Desk, bytes: &[u8]) {
    use image::{DynamicImage, GrayImage, ImageBuffer};
    let picture = match bytes {
        [width, depth, pixels @ ..] if (1..=64).contains(width) && *depth < 2 => {
            let (width, deep) = (u32::from(*width), *depth == 1);
            let height = (pixels.len() / (1 + usize::from(deep))).min(4096) as u32 / width;
            if deep {
                let words = pixels.chunks_exact(2).map(|two| u16::from_le_bytes([two[0], two[1]]));
                let words = words.take((width * height) as usize).collect();
                ImageBuffer::from_raw(width, height, words).map(DynamicImage::ImageLuma16)
            } else {
                let bytes = pixels[..(width * height) as usize].to_vec();
                GrayImage::from_raw(width, height, bytes).map(DynamicImage::ImageLuma8)
            }
        }
        _ => Photograph::read_up_to(&desk.file("mask", bytes), 4).ok().map(|photo| photo.image),
    };
    if let Some(picture) = picture {
        let _ = outlines_from_mask(&picture);
    }
}

fn markers(desk: &Desk, bytes: &[u8]) {
    let Ok(layout) = Layout::read(&desk.file("markers.toml", bytes)) else { return };
    let _ = layout.needed();
    if let Some(camera) = &layout.camera {
        let lens = Lens::new(camera, (64, 48), 1.0);
        let _ = lens.undistort([3.0, 4.0]).map(|there| lens.distort(there.at_px));
    }
}

/// Every column of a table in every way.
fn each_column(table: &Table) {
    for name in table.names() {
        let _ = (table.numbers(name), table.numbers_or_nan(name), table.integers(name), table.texts(name));
        let _ = table.is_text(name);
    }
}

fn log(path: &Path) {
    if let Ok(log) = Log::read(path, &Columns::default()) {
        let _ = samples(&log, &AmbientOptions::default());
    }
}

/// As a table, a table of angles, a log, and a packed log where the bytes begin as such.
fn csv(desk: &Desk, bytes: &[u8]) {
    if bytes.starts_with(&[0x1f, 0x8b]) {
        log(&desk.file("log.csv.gz", bytes));
        return;
    }
    let path = desk.file("table.csv", bytes);
    if let Ok(table) = Table::read(&path) {
        each_column(&table);
    }
    let _ = Posture::read(&path);
    log(&path);
}

fn parquet(desk: &Desk, bytes: &[u8]) {
    let path = desk.file("table.parquet", bytes);
    if let Ok(table) = Table::read(&path) {
        each_column(&table);
    }
    log(&path);
}

fn partials(desk: &Desk, bytes: &[u8]) {
    desk.file("part/maps/a.partial.npz", bytes);
    let _ = join(&[desk.place("part")]);
}

/// Read, written again, and asked.
fn model(_: &Desk, bytes: &[u8]) {
    let Ok(opened) =
        std::str::from_utf8(bytes).map_err(|_| ()).and_then(|text| Predictor::from_json(text).map_err(drop))
    else {
        return;
    };
    let _ = opened.predictor.to_json();
    answer(opened.predictor, b"time_s,P1,P2\n0,1,2\n0.1,-1e300,2\n");
}

fn answer(predictor: Predictor, bytes: &[u8]) {
    let gate = Gate::new(0.1, 0.0, 0.0).expect("a gate");
    for intervals in [false, true] {
        let Ok(mut answering) = Answering::new(vec![predictor.clone()], gate, intervals) else { continue };
        let inputs = answering.inputs().to_vec();
        let mut out = vec![f64::NAN; answering.columns().len()];
        let known = inputs.clone();
        let naming: Naming = Box::new(move |names| {
            let place = |name: &String| known.iter().position(|input| input == name);
            let uses = names.iter().map(|name| match place(name) {
                Some(at) => Use::Value { at, scaled: false },
                None if name == "time_s" => Use::Time { per_second: 1.0 },
                None => Use::None,
            });
            Ok(Meaning { uses: uses.collect(), values: known.len(), texts: 0 })
        });
        let mut lines = Lines::new(naming, LineOptions::default());
        let mut bytes = bytes;
        while let Ok(Some(step)) = lines.next(&mut bytes, 0) {
            if let Step::Sample(sample) = step {
                answering.answer(sample.time, false, &lines.decoded().values, &mut out);
            }
        }
    }
}

fn parameters(_: &Desk, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(parameters) = Parameters::from_toml(text) {
        let _ = Model::new(&parameters, Collapse::Error);
        let _ = parameters.to_toml();
    }
}

/// What a pipeline file says, and what it has generated; what it finds in folders is no matter of bytes.
fn pipeline(desk: &Desk, bytes: &[u8]) {
    let path = desk.file("pipeline.toml", bytes);
    if let Ok(spec) = Spec::read(&path, &[kinds(), lunula_thesis::kinds()].concat()) {
        let _: PipelineMark = spec.mark();
        let known = [lunula_thesis::experiments(), scenes()].concat();
        let _ = spec.catalogue(|block| phantom_catalogue(block, &known));
    }
}

/// What a pipeline keeps under `.lunula`: the same bytes as each of its files.
fn records(desk: &Desk, bytes: &[u8]) {
    for name in ["records/t.e3b98a4da31a127d.json", "failures/t.e3b98a4da31a127d.json", "hashes", "part.json"] {
        desk.file(&format!("out/.lunula/{name}"), bytes);
    }
    let _ = survey(std::slice::from_ref(&desk.task), &desk.place("out"));
    let _ = Parts::open(&[desk.place("out")]);
}

fn stream(desk: &Desk, bytes: &[u8]) {
    answer(desk.predictor.clone(), bytes);
}

/// A recording, or a packed one.
fn xdf(desk: &Desk, bytes: &[u8]) {
    log(&desk.file("log.xdf", bytes));
}

/// The name of a source; what it is written as is read again.
fn source(_: &Desk, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(source) = text.trim_end().parse::<OfFinger<Address>>() {
        assert_eq!(source.to_string().parse::<OfFinger<Address>>().as_ref(), Ok(&source));
    }
}

fn switch(_: &Desk, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(switch) = SwitchConfig::from_toml(text) {
        let _ = switch.at(0.01, 0.02);
    }
}

fn mouse(_: &Desk, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = pointer::Config::from_toml(text);
}

/// As it is gone through: what it prompts at any time is a number.
fn protocol(_: &Desk, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(protocol) = Protocol::parse(text, Path::new("p.toml")) else { return };
    for motion in protocol.steps.iter().filter_map(|step| step.motion()) {
        for share in [-1.0, 0.0, 0.3, 1.0, 2.0] {
            match motion.at(share * motion.whole_s()) {
                Prompted::Force(force) => assert!(force.iter().all(|force| force.is_finite())),
                Prompted::Bend(j2_deg) => assert!(j2_deg.is_finite()),
            }
        }
    }
}

fn positions(_: &Desk, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = (Positions::from_toml(text), Positions::from_json(text));
}
