use super::*;
use crate::job::Watch;
use crate::live::streams::source::OfFinger;
use crate::prompt::{Nobody, REST_N};
use crate::table::Table;
use lunula_predictor::{ForceSpace, cone_coverage};

pub(super) fn options(source: &str) -> StreamOptions {
    StreamOptions { source: vec![OfFinger::any(source.parse().unwrap())], ..StreamOptions::default() }
}

const SHORT: &str = "[[step]]\nkind = \"ask\"\n[[step]]\nkind = \"check\"\nchecks = [\"photodiodes\", \"tare\", \
                     \"sign\"]\n[[step]]\nkind = \"spiral\"\nname = \"force\"\nseconds = 40\n[[step]]\nkind = \
                     \"bending\"\nname = \"bend\"\nseconds = 20\nchecks = [\"adhesion\"]\n";

fn run(dir: &Path, source: &str, protocol: &str) -> Result<PromptReport, PromptError> {
    let path = dir.join("p.toml");
    std::fs::write(&path, protocol).unwrap();
    let files = PromptFiles { protocol: Some(path), out: dir.join("r.csv"), replace: false };
    Prompter::new(&options(source), &files, Arc::new(Nobody))?.run(None, &|_| {}, &Watch::nobody())
}

fn column(table: &Table, name: &str) -> Vec<f64> {
    table.numbers(name).unwrap().into_iter().map(|cell| cell.unwrap_or(f64::NAN)).collect()
}

#[test]
fn a_simulated_person_goes_through_a_protocol_and_the_file_has_what_was_shown() {
    let dir = tempfile::tempdir().unwrap();
    let report = run(dir.path(), "phantom:subject?seed=3&rate=max", SHORT).unwrap();
    assert!(report.completed && report.failed.is_empty(), "{:?} {:?}", report.failed, report.turns);
    let table = Table::read(&dir.path().join("r.csv")).unwrap();
    let [x, y, z] = ["Fx_N", "Fy_N", "Fz_N"].map(|name| column(&table, name));
    let forces: Vec<[f64; 3]> = (0..table.rows()).map(|k| [x[k], y[k], z[k]]).collect();
    assert_eq!(report.rows, table.rows());
    assert_eq!(report.coverage, cone_coverage(forces, &ForceSpace::default(), REST_N));
    // 42 and 20 s at 25 Hz.
    assert!((1540..=1560).contains(&table.rows()), "{}", table.rows());
    let (times, prompts) = (column(&table, "time_s"), column(&table, "prompt_Fz_N"));
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]));
    // The finger follows 0.21 to 0.39 s late: of a slow rise that is little.
    let worst = z.iter().zip(&prompts).filter(|(_, prompt)| !prompt.is_nan()).map(|(z, prompt)| (z - prompt).abs());
    // Letting go falls by 2.25 N/s; measured 1.0.
    assert!(worst.fold(0.0, f64::max) <= 1.3);
    let followed = report.followed.iter().find(|step| step.step == "force").unwrap();
    assert!(followed.rms_n.unwrap() > 0.05 && followed.rms_n.unwrap() <= 0.7, "{followed:?}");
    // Bending has no prompted force, and none is made up.
    let bends = column(&table, "prompt_J2_deg");
    assert!(bends.iter().zip(&prompts).all(|(bend, prompt)| bend.is_nan() != prompt.is_nan()));
    assert!(bends.iter().copied().fold(f64::MIN, f64::max) > 74.0);
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let text = |seed: u32| {
        let dir = tempfile::tempdir().unwrap();
        let protocol = "[[step]]\nkind = \"spiral\"\nseconds = 10\n";
        run(dir.path(), &format!("phantom:subject?seed={seed}&rate=max"), protocol).unwrap();
        std::fs::read(dir.path().join("r.csv")).unwrap()
    };
    let one = text(1);
    assert!(one.len() > 10_000 && one == text(1) && one != text(2));
}

#[test]
fn where_nothing_was_collected_a_recording_of_before_keeps_its_certificate() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["r.csv", "r.stream.json", "r.run.json"] {
        std::fs::write(dir.path().join(name), "kept").unwrap();
    }
    let files = PromptFiles { protocol: None, out: dir.path().join("r.csv"), replace: true };
    // Rows come, and nobody at the page says that they may be recorded.
    let options = StreamOptions { seconds: Some(1.0), ..options("phantom:subject?seed=3") };
    let report = Prompter::new(&options, &files, Arc::new(Nobody)).unwrap().run(None, &|_| {}, &Watch::nobody());
    let report = report.unwrap();
    assert!(report.rows == 0 && report.failed.iter().any(|why| why.contains("nothing is written")), "{report:?}");
    for name in ["r.csv", "r.stream.json", "r.run.json"] {
        assert_eq!(std::fs::read_to_string(dir.path().join(name)).unwrap(), "kept", "{name}");
    }
}

#[test]
fn what_can_not_be_prompted_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |source: &str| run(dir.path(), source, SHORT).map(|_| ()).unwrap_err().to_string();
    assert!(refused("phantom:touch").contains("phantom:subject does"));
    assert!(refused("phantom:subject?rate=3").contains("rate=1 or rate=max"));
    assert!(refused("other.csv").contains("a recording follows no prompt"));
    assert!(refused("phantom:subject?rate=max&sed=1").contains("seed"));
    std::fs::write(dir.path().join("r.csv"), "kept").unwrap();
    assert!(refused("phantom:subject?rate=max").contains("exists already"));
    let parquet = PromptFiles { out: dir.path().join("r.parquet"), ..PromptFiles::default() };
    let why = Prompter::new(&options("tcp:127.0.0.1:1"), &parquet, Arc::new(Nobody)).map(|_| ()).unwrap_err();
    assert!(why.to_string().contains(".csv"), "{why}");
    assert!(subject().is_ok() && is_alone(&options("phantom:subject?rate=max")));
    assert!(!is_alone(&options("phantom:subject")));
}
