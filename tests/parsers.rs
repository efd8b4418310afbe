//! Every parser on the inputs of `tests/corpus/<parser>/`: small valid files, and cases that fuzzing (`make fuzz`)
//! found.

#[path = "../crates/fuzz/src/targets.rs"]
mod targets;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use image::{DynamicImage, ImageFormat};
use targets::{Desk, TARGETS};

use crate::util::repository;

/// Set in the process that reads the inputs.
const WITHIN: &str = "LUNULA_CORPUS";
/// Address space for one process that reads all of the corpus, KiB. It takes 0.6 GiB with all libraries; a case that
/// takes memory by what its header says takes gigabytes.
const MEMORY_KIB: u64 = 2 << 20;
/// All of them take two seconds; a case that hangs never ends.
const PATIENCE: Duration = Duration::from_secs(120);

fn corpus(parser: &str) -> PathBuf {
    repository().join("tests/corpus").join(parser)
}

fn cases(parser: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(corpus(parser)).expect("a folder of cases");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths
}

/// The cases are read in a process of its own: it may abort, and has little memory.
#[test]
fn no_found_case_makes_a_parser_panic_abort_or_hang() {
    const OWN: &str = "parsers::no_found_case_makes_a_parser_panic_abort_or_hang";
    if std::env::var_os(WITHIN).is_some() {
        return read_all();
    }
    let all: usize = TARGETS.iter().map(|target| cases(target.name).len()).sum();
    let limited = format!("ulimit -v {MEMORY_KIB}; exec \"$0\" --exact {OWN} --nocapture --test-threads=1");
    let mut child = Command::new("sh")
        .args(["-c", &limited])
        .arg(std::env::current_exe().expect("this program"))
        .envs([(WITHIN, "read"), ("RAYON_NUM_THREADS", "2"), ("MALLOC_ARENA_MAX", "2")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a process");
    let start = Instant::now();
    let hangs = loop {
        match child.try_wait().expect("a process") {
            Some(_) => break false,
            None if start.elapsed() > PATIENCE => {
                child.kill().expect("a process");
                break true;
            }
            None => std::thread::sleep(Duration::from_millis(5)),
        }
    };
    let output = child.wait_with_output().expect("its output");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let read = said.lines().filter(|line| line.starts_with("case ")).count();
    let last = said.lines().rfind(|line| line.starts_with("case ")).unwrap_or("none");
    let why = String::from_utf8_lossy(&output.stderr);
    assert!(!hangs && output.status.success(), "{last}: hangs: {hangs}, {}\n{said}\n{why}", output.status);
    assert_eq!(read, all);
    assert!(TARGETS.len() == 18 && TARGETS.iter().all(|target| !cases(target.name).is_empty()));
}

fn read_all() {
    let desk = Desk::new();
    for target in TARGETS {
        for case in cases(target.name) {
            println!("\ncase {}", case.display());
            (target.run)(&desk, &std::fs::read(&case).expect("a case"));
        }
    }
}

/// A folder of seeds: one folder a parser.
struct Place(PathBuf);

impl Place {
    fn of(&self, name: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().expect("a parser's folder")).expect("a folder");
        path
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.of(name), bytes).expect("a seed");
    }
}

/// The seeds that are no text are still made, read without a panic, and those of the corpus.
/// `LUNULA_SEEDS=$PWD/tests/corpus` writes them there, for formats that changed.
#[test]
fn the_seeds_of_binary_formats_are_made() {
    let (desk, folder) = (Desk::new(), tempfile::tempdir().expect("a folder"));
    let place = Place(std::env::var_os("LUNULA_SEEDS").map_or_else(|| folder.path().to_path_buf(), PathBuf::from));
    pictures(&place);
    parquet(&desk, &place);
    partials(&desk, &place);
    record(&desk, &place);
    xdf(&place);
    let mut made = 0;
    for target in TARGETS.iter().filter(|target| place.0.join(target.name).is_dir()) {
        for seed in std::fs::read_dir(place.0.join(target.name)).expect("a folder") {
            let seed = seed.expect("an entry").path();
            (target.run)(&desk, &std::fs::read(&seed).expect("a seed"));
            assert!(corpus(target.name).join(seed.file_name().expect("a name")).exists(), "{}", seed.display());
            made += 1;
        }
    }
    assert!(made >= 15, "{made}");
}

fn pictures(place: &Place) {
    let colour = DynamicImage::ImageRgb8(image::RgbImage::from_fn(11, 7, |x, y| {
        image::Rgb([(x * 20) as u8, (y * 30) as u8, (x * y) as u8])
    }));
    let grey = DynamicImage::ImageLuma8(image::GrayImage::from_fn(48, 64, |x, y| image::Luma([(x + 2 * y) as u8])));
    let mut pictures = vec![("grey.png", grey, ImageFormat::Png)];
    pictures.push(("deep.png", colour.to_rgb16().into(), ImageFormat::Png));
    pictures.push(("colour.jpg", colour.clone(), ImageFormat::Jpeg));
    pictures.push(("colour.bmp", colour.clone(), ImageFormat::Bmp));
    pictures.push(("deep.tif", colour.to_luma16().into(), ImageFormat::Tiff));
    pictures.push(("alpha.tif", colour.to_rgba8().into(), ImageFormat::Tiff));
    for (name, picture, format) in pictures {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).expect("a picture");
        place.write(&format!("photograph/{name}"), bytes.get_ref());
    }
    // Two nails and a speck, white and by number: the width, the depth, the pixels.
    let within = |x: u32, y: u32| u8::from((3..12).contains(&x) && (2..14).contains(&y));
    let other = |x: u32, y: u32| u8::from((14..23).contains(&x) && (4..15).contains(&y)) + 2 * u8::from(x + y == 0);
    let pixels = |value: &dyn Fn(u8, u8) -> u8| -> Vec<u8> {
        let all = (0..16).flat_map(|y| (0..24).map(move |x| (x, y)));
        all.map(|(x, y)| value(within(x, y), other(x, y))).collect()
    };
    let white = pixels(&|a, b| (a | b).saturating_mul(200));
    place.write("mask/white", &[&[24, 0][..], &white].concat());
    place.write("mask/numbers", &[&[24, 0][..], &pixels(&|a, b| a + 2 * b)].concat());
    let words: Vec<u8> = white.iter().flat_map(|value| [0, *value]).collect();
    place.write("mask/deep", &[&[24, 1][..], &words].concat());
}

fn parquet(desk: &Desk, place: &Place) {
    use lunula::table::{Column, TableWriter, Value};
    let path = desk.place("seed.parquet");
    let columns = vec![Column::number("time_s"), Column::number("P1"), Column::integer("led"), Column::text("subject")];
    let facts = [("lunula".to_owned(), "seed".to_owned())];
    let mut table = TableWriter::create(&path, &path, columns, &facts).expect("a table");
    for row in 0..6 {
        let volts = if row == 3 { Value::Missing } else { Value::Number(0.5 + row as f64) };
        let cells = [Value::Number(row as f64 / 8.0), volts, Value::Integer(row % 2), Value::Text("S01")];
        table.write(&cells).expect("a row");
    }
    table.finish().expect("a table");
    std::fs::copy(&path, place.of("parquet/log.parquet")).expect("a seed");
}

/// The sums of two subjects and the levels of one.
fn partials(desk: &Desk, place: &Place) {
    let set = desk.place("set");
    std::fs::create_dir_all(set.join("a")).expect("a folder");
    for subject in ["S01", "S02"] {
        let picture = crate::util::drawn_nail();
        picture.save(set.join(format!("a/{subject}.png"))).expect("a picture");
        std::fs::write(set.join(format!("a/{subject}.json")), crate::util::drawn_labels()).expect("a file");
    }
    let lunula = |arguments: &[&std::ffi::OsStr]| {
        let status = Command::new(env!("CARGO_BIN_EXE_lunula")).arg("photos").args(arguments).status();
        assert!(status.expect("the binary runs").success());
    };
    let out = desk.place("maps");
    lunula(&[set.as_os_str(), "--size".as_ref(), "8".as_ref(), "--out".as_ref(), out.as_os_str()]);
    std::fs::copy(out.join("maps/a.partial.npz"), place.of("partials/two.npz")).expect("a seed");
}

/// What a run keeps of a task.
fn record(desk: &Desk, place: &Place) {
    use lunula::pipeline::{PipelineMark, Results, RunOptions, RunWatch, Shard};
    let (stop, out) = (std::sync::atomic::AtomicBool::new(false), desk.place("run"));
    let options = RunOptions {
        threads: 1,
        memory: u64::MAX,
        shard: Shard::new(1, 1),
        pipeline: PipelineMark::new(Path::new("p.toml"), "name = \"p\"\n"),
    };
    let results = Results::open(&out).expect("a folder");
    let tasks = std::slice::from_ref(&desk.task);
    results.run(tasks, &options, &RunWatch { stop: &stop, tick: &|_| {} }).expect("a run");
    drop(results);
    let home = out.join(".lunula");
    let records = std::fs::read_dir(home.join("records")).expect("records").next().expect("one").expect("one").path();
    std::fs::copy(records, place.of("records/record.json")).expect("a seed");
    std::fs::copy(home.join("part.json"), place.of("records/part.json")).expect("a seed");
}

fn xdf(place: &Place) {
    let chunk = |tag: u16, content: &[u8]| {
        let length = content.len() as u32 + 2;
        [&[4][..], &length.to_le_bytes(), &tag.to_le_bytes(), content].concat()
    };
    let header = |format: &str, channels: &str, count: usize| {
        let xml = format!(
            "<?xml version=\"1.0\"?><info><name>a</name><channel_count>{count}</channel_count>\
             <nominal_srate>10</nominal_srate>\
             <channel_format>{format}</channel_format><desc><channels>{channels}</channels></desc></info>"
        );
        chunk(2, &[&1_u32.to_le_bytes()[..], xml.as_bytes()].concat())
    };
    let samples = |rows: &[(Option<f64>, Vec<u8>)]| {
        let mut content = [&1_u32.to_le_bytes()[..], &[1, rows.len() as u8]].concat();
        for (stamp, values) in rows {
            match stamp {
                None => content.push(0),
                Some(stamp) => content.extend([8].into_iter().chain(stamp.to_le_bytes())),
            }
            content.extend(values);
        }
        chunk(3, &content)
    };
    let offset =
        |time_s: f64| chunk(4, &[&1_u32.to_le_bytes()[..], &time_s.to_le_bytes(), &0.5_f64.to_le_bytes()].concat());
    let two = "<channel><label>P1</label></channel><channel><label>P2</label></channel>";
    let double = |a: f64, b: f64| [a.to_le_bytes(), b.to_le_bytes()].concat();
    let doubles = [
        b"XDF:".to_vec(),
        chunk(1, b"<info/>"),
        header("double64", two, 2),
        samples(&[(Some(1.0), double(0.5, 1.0)), (None, double(0.25, f64::NAN)), (None, double(0.125, 2.0))]),
        offset(0.0),
        offset(5.0),
        chunk(6, &[1, 0, 0, 0]),
    ];
    place.write("xdf/doubles.xdf", &doubles.concat());
    let short = |value: i16| value.to_le_bytes().to_vec();
    let shorts = [
        b"XDF:".to_vec(),
        header("int16", "<channel><label>P1</label></channel>", 1),
        samples(&[(Some(1.0), short(3)), (Some(1.1), short(-4))]),
    ];
    place.write("xdf/shorts.xdf", &shorts.concat());
}
