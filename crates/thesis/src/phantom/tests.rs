//! The study as a block of `[phantom]`.

use lunula::job::{Facts, OptionFault, read};
use lunula::pipeline::{Catalogue, phantom_catalogue, scenes};

use super::StudyRequest;

fn of(text: &str) -> Result<Catalogue, OptionFault> {
    phantom_catalogue(&text.parse().unwrap(), &[crate::experiments(), scenes()].concat())
}

fn facts_of(catalogue: &Catalogue, path: &str) -> Facts {
    let file = catalogue.files.iter().find(|file| file.path == path);
    file.unwrap_or_else(|| panic!("{path}: {:#?}", catalogue.files)).facts
}

#[test]
fn a_study_is_a_task_a_recording_and_its_tables_are_among_its_files() {
    let catalogue = of("study = { subjects = 3, sensors = 2, presses = 0 }").unwrap();
    assert_eq!(catalogue.tasks.len(), 1 + 2 * 6 + 4 + 1);
    assert!(catalogue.tables.keys().all(|name| catalogue.files.iter().any(|file| file.path == *name)));
    let task = catalogue.tasks.iter().find(|task| task.name == "s02/bending").unwrap();
    assert_eq!(task.keys.get("subject"), Some("s02"));
    let video = facts_of(&catalogue, "s02/bending/video.mp4");
    assert_eq!((video.clock, video.distorted), (Some(true), Some(false)));
    assert_eq!(facts_of(&catalogue, "s02/bending/log.csv").forces, Some(true));
    assert_eq!(facts_of(&catalogue, "photos/photos/nominal/s01.png").grey, Some(true));
    let sessions = &catalogue.tables["tables/sessions.csv"];
    assert!(
        sessions.contains("\ns02,touch-2,touch,2,,,../s02/touch-2/log.csv,,../s02/touch-2/truth/log.csv\n"),
        "{sessions}"
    );
    assert!(!sessions.contains("s02,normal") && sessions.contains("s01,normal"));
    // A person is the same whoever else takes part.
    let more = of("study = { subjects = 16 }").unwrap();
    let options = |catalogue: &Catalogue| {
        catalogue.tasks.iter().find(|task| task.name == "s02/bending").map(|task| task.options.clone())
    };
    assert_eq!(options(&catalogue), options(&more));
    assert_ne!(options(&of("study = { seed = 2 }").unwrap()), options(&more));
}

#[test]
fn what_is_wrong_is_told_of_its_key() {
    for (text, key, words) in [
        ("", "", "as study = { seed = 1 }"),
        ("studdy = {}", "studdy", "there are study, photos, video, log"),
        ("study = 1", "study", "has to be a table"),
        ("study = [{ name = \"a\" }]", "study", "has to be a table"),
        ("study = { subjects = 0 }", "study", "--subjects 0"),
        ("study = { quick = 2 }", "study.quick", "known: seed, subjects, sensors"),
        ("study = { video_size = \"wide\" }", "study.video_size", "`wide` is not WIDTHxHEIGHT"),
        ("study = {}\nphotos = {}", "", "{phantom}/photos"),
    ] {
        let fault = of(text).err().unwrap_or_else(|| panic!("{text} is taken"));
        assert!(fault.key == key && fault.what.contains(words), "{text}: {fault:?}");
    }
}

#[test]
fn who_is_not_counted_otherwise_wears_the_sensor() {
    let keys = "subjects = 2\nvideo_size = \"160x96\"".parse().unwrap();
    let study = read::<StudyRequest>(&keys, "").unwrap().options.options();
    assert_eq!((study.subjects, study.sensors, study.width, study.fps), (2, 2, 160, 30.0));
}
