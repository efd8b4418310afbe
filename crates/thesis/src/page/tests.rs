//! The page on parts that are made here.

use super::*;
use lunula::job::defaults;

fn part(at: &Path, part: Part, subject: &str, files: &[(&str, &[u8])]) -> PartFolder {
    let folder = at.join(part.name()).join(subject);
    fs::create_dir_all(&folder).unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(folder.join(name), bytes).unwrap());
    PartFolder { part, folder, subject: subject.to_owned() }
}

fn png() -> Vec<u8> {
    lunula::figure::png(&image::DynamicImage::new_luma8(2, 2)).unwrap()
}

#[test]
fn what_there_is_is_shown_and_the_rest_is_said_to_be_lacking() {
    let folder = tempfile::tempdir().unwrap();
    let (at, png) = (folder.path(), png());
    let numbers = br#"{"P7.phase_deg": 10.0, "P5.phase_deg": 10.0}"#;
    let parts = [
        part(at, Part::Lateral, "S02", &[("numbers.json", b"{}")]),
        part(
            at,
            Part::Lateral,
            "S01",
            &[("numbers.json", numbers), ("averages.png", &png), ("responses.csv", b"a\n1\n")],
        ),
        part(at, Part::Normal, "S01", &[("numbers.json", b"nothing")]),
    ];
    let options = PageOptions { title: "A study".to_owned(), phantom: true, subject: None };
    let report = study_page(&parts, &options, &at.join("out"), &Watch::nobody()).unwrap();
    assert_eq!((report.figures.figures, report.agree, report.do_not), (1, 1, 1 + 1));
    assert_eq!(report.figures_lacking.len(), SECTIONS.iter().map(|one| one.figures.len()).sum::<usize>() - 1);
    assert!(report.warnings.len() == 1 && report.warnings[0].starts_with("normal: "), "{:?}", report.warnings);
    let html = fs::read_to_string(at.join("out/study.html")).unwrap();
    for words in
        ["A phantom is no people", "Fig. 28", "Subject S01", "tables/lateral-responses.csv", "can&#39;t be judged"]
    {
        assert!(html.contains(words), "{words}");
    }
    assert!(!html.contains(&at.display().to_string()));
    let table = fs::read_to_string(at.join("out/statements.csv")).unwrap();
    assert!(table.contains("lateral-p7,3.3.3,27,") && table.lines().count() > 100);
}

#[test]
fn an_empty_study_has_a_page_that_judges_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let report = study_page(&[], &defaults(), folder.path(), &Watch::nobody()).unwrap();
    assert_eq!((report.figures.figures, report.agree, report.do_not), (0, 0, 0));
    assert!(report.cannot_tell > 100);
    assert!(!fs::read_to_string(folder.path().join("study.html")).unwrap().contains("A phantom"));
}
