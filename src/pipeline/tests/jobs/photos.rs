//! `normalize` and `maps`.

use super::*;
use crate::job::Job as _;
use crate::job::Watch;
use crate::phantom::Generated as _;
use crate::phantom::nail::Pose;
use crate::phantom::photos::PhotoOptions;
use crate::photo::{MapsJob, Normalization, Outputs, PhotoSet, PhotosOptions};

const SIZE: usize = 48;
const OPTIONS: &str = "size = 48";
const SUBJECTS: [&str; 3] = ["s01", "s02", "s03"];
const POSES: [Pose; 2] = [Pose::Nominal, Pose::Flexion];

/// Three subjects in two poses, outlined, with exact maps.
fn phantom(grey: bool) -> TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    let options = PhotoOptions {
        subjects: 3,
        poses: POSES.to_vec(),
        width: 320,
        height: 240,
        size: SIZE,
        grey,
        truth_normalized: false,
        ..PhotoOptions::default()
    };
    options.write(dir.path()).expect("a set");
    dir
}

fn photos(root: &Path, subject: &str) -> Vec<At> {
    let mut inputs = Vec::new();
    for pose in POSES {
        let of = [("subject", subject), ("pose", pose.name())];
        inputs.push(at("photo", &of, root, &format!("photos/{pose}/{subject}.png")));
        let outline = at("outlines", &of, root, &format!("photos/{pose}/{subject}.json"));
        inputs.extend(outline.path.exists().then_some(outline));
    }
    inputs
}

fn normalize(root: &Path, subject: &str, parts: &[&'static str]) -> Task<'static> {
    let demand = wanting(parts);
    Task {
        kind: &PhotosOptions::KIND,
        options: OPTIONS,
        demand,
        keys: keys(&[("subject", subject)]),
        inputs: photos(root, subject),
    }
}

/// Each subject's sums.
fn sums(root: &Path) -> Vec<Folder> {
    SUBJECTS.iter().map(|subject| normalize(root, subject, &["sums"]).run(2, None).0).collect()
}

fn maps(of: &[(&str, &Folder)], parts: &[&'static str], truth: Option<&Path>) -> Task<'static> {
    let sums = |(subject, folder): &(&str, &Folder)| {
        let (path, name) = (folder.path().to_owned(), format!("nails/{subject}"));
        At { role: "sums", keys: keys(&[("subject", subject)]), path, name }
    };
    let mut inputs: Vec<At> = of.iter().map(sums).collect();
    inputs.extend(truth.map(|root| at("truth", &[], root, "truth/maps")));
    Task { kind: &MapsJob::KIND, options: "", demand: wanting(parts), keys: Keys::default(), inputs }
}

#[test]
fn a_subject_s_results_are_the_same_anywhere() {
    let dir = phantom(false);
    let task = normalize(dir.path(), "s02", &["sums", "pictures"]);
    let (folder, made) = is_the_same_anywhere(&task, dir.path());
    let names = [
        "nails.csv",
        "normalized/flexion/s02.png",
        "normalized/nominal/s02.png",
        "partials/flexion.partial.npz",
        "partials/members.json",
        "partials/nominal.partial.npz",
    ];
    assert_eq!(folder.names(), names);
    assert!(folder.text("nails.csv").contains("\nphotos/flexion/s02.png,1,s02,flexion,annotated,"));
    assert!(made.left_out.iter().any(|what| what.starts_with("detection: not run on 2")), "{:?}", made.left_out);
    assert!(made.warnings.is_empty() && made.failed.is_empty(), "{made:?}");
    has_its_parts(&PhotosOptions::KIND, OPTIONS, &task.demand, &folder);
    let (bare, _) = normalize(dir.path(), "s02", &["sums"]).run(1, None);
    assert!(!bare.names().iter().any(|name| name.starts_with("normalized")), "nobody wants the pictures");
}

#[test]
fn maps_of_parts_are_those_of_one_run_and_go_on_from_what_stands() {
    let dir = phantom(false);
    let parts = sums(dir.path());
    let of = |chosen: &[usize]| chosen.iter().map(|&k| (SUBJECTS[k], &parts[k])).collect::<Vec<_>>();
    let (two, _) = maps(&of(&[0, 2]), &["maps", "figures"], None).run(2, None);
    let all = maps(&of(&[0, 1, 2]), &["maps", "figures"], None);
    let (fresh, made) = all.run(1, None);
    assert_eq!((&made.report["sums_added"], &made.report["sums_kept"]), (&6.into(), &0.into()));
    let (onto, made) = all.run(3, Some(two.path()));
    assert_eq!((&made.report["sums_added"], &made.report["sums_kept"]), (&2.into(), &4.into()));
    assert!(fresh.bytes() == onto.bytes(), "added to what exists, or all made again");
    has_its_parts(&MapsJob::KIND, "", &all.demand, &fresh);

    // The command, all at once.
    let at_once = Folder(tempfile::tempdir().unwrap());
    let set = PhotoSet::open(&dir.path().join("photos"), &[]).unwrap();
    let normalization = Normalization { size: SIZE, ..Normalization::default() };
    let options = PhotosOptions { normalization, ..PhotosOptions::default() };
    crate::photo::run(&set, &options, &Outputs::maps(at_once.path()), &Watch::nobody()).unwrap();
    let bytes = fresh.bytes();
    // The pictures are the parts' own, the report is the pipeline's, and a photograph's name is that among its inputs.
    let of_both =
        |name: &str| ["maps/", "figures/"].iter().any(|folder| name.starts_with(folder)) && !name.contains("nails-");
    let same = at_once.bytes().into_iter().filter(|(name, _)| of_both(name));
    assert_eq!(same.map(|(name, expected)| assert!(bytes[&name] == expected, "{name}")).count(), 2 * 8 + 8);
}

#[test]
fn sums_that_stand_are_left_where_a_member_is_gone_or_has_changed() {
    let dir = phantom(false);
    let parts = sums(dir.path());
    let of = |chosen: &[usize]| chosen.iter().map(|&k| (SUBJECTS[k], &parts[k])).collect::<Vec<_>>();
    let (three, _) = maps(&of(&[0, 1, 2]), &["maps"], None).run(2, None);
    let two = maps(&of(&[0, 1]), &["maps"], None);
    let (fresh, (without, made)) = (two.run(2, None).0, two.run(2, Some(three.path())));
    assert_eq!(made.report["sums_added"], 4);
    assert!(fresh.bytes() == without.bytes());

    let photo = dir.path().join("photos/flexion/s03.png");
    image::open(&photo).unwrap().brighten(-20).save(&photo).unwrap();
    let (third, _) = normalize(dir.path(), "s03", &["sums"]).run(2, None);
    let changed = maps(&[(SUBJECTS[0], &parts[0]), (SUBJECTS[1], &parts[1]), ("s03", &third)], &["maps"], None);
    let (fresh, (again, made)) = (changed.run(2, None).0, changed.run(2, Some(three.path())));
    // The other pose's sums hold all that they held.
    assert_eq!((&made.report["sums_added"], &made.report["sums_kept"]), (&3.into(), &3.into()));
    assert!(fresh.bytes() == again.bytes() && fresh.bytes() != three.bytes());

    // A result that somebody wrote over.
    fs::write(three.path().join("maps/nominal.partial.npz"), "broken").unwrap();
    let (again, made) = maps(&of(&[0, 1, 2]), &["maps"], None).run(2, Some(three.path()));
    assert_eq!((&made.report["sums_added"], &made.report["sums_kept"]), (&3.into(), &3.into()));
    assert!(again.names().contains(&"maps/nominal-mean.npy".to_owned()));
}

#[test]
fn maps_tell_how_far_they_are_from_the_true_ones() {
    let dir = phantom(false);
    let parts = sums(dir.path());
    let of: Vec<_> = SUBJECTS.into_iter().zip(&parts).collect();
    let (_, made) = maps(&of, &["maps"], Some(dir.path())).run(2, None);
    let qualities: Vec<(&str, bool)> = made.quality.iter().map(|q| (q.what.as_str(), q.against_truth)).collect();
    assert_eq!(qualities, [("mean map", true), ("SD map", true), ("mean map", false)]);
    // Of 255; 0.4 of three subjects of 320 x 240 pixels were measured.
    assert!(made.quality[0].value <= 2.0, "{:?}", made.quality);
}

#[test]
fn a_photograph_that_fails_leaves_the_others_be() {
    let dir = phantom(true);
    fs::write(dir.path().join("photos/flexion/s01.png"), "no picture").unwrap();
    let task = normalize(dir.path(), "s01", &["sums"]);
    let (folder, made) = task.run(2, None);
    assert_eq!(made.failed.len(), 1);
    assert!(made.failed[0].starts_with("photos/flexion/s01.png: "), "{:?}", made.failed);
    assert!(folder.names().contains(&"partials/nominal.partial.npz".to_owned()));
    assert!(made.left_out.iter().any(|what| what.starts_with("channel: not taken from 1 grey")), "{:?}", made.left_out);
    fs::write(dir.path().join("photos/nominal/s01.png"), "no picture").unwrap();
    let error = task.try_run(2, None).err().unwrap().to_string();
    assert!(error.contains("photos/nominal/s01.png") && error.contains("photos/flexion/s01.png"), "{error}");
}

#[test]
fn an_outline_counts_only_where_the_task_was_given_it() {
    let dir = phantom(false);
    let mut task = normalize(dir.path(), "s01", &["sums"]);
    task.inputs.retain(|input| input.role == "photo");
    let (folder, _) = task.run(2, None);
    let nails = folder.text("nails.csv");
    assert!(nails.contains(",detected,") && !nails.contains(",annotated,"), "{nails}");
    let prepared = prepared(&PhotosOptions::KIND, "");
    let photo = Path::new("a/nominal/s01.png");
    assert_eq!(prepared.beside("photo", photo), [("outlines", PathBuf::from("a/nominal/s01.json"))]);
    let detecting = super::prepared(&PhotosOptions::KIND, "outline = 'detect'");
    assert!(detecting.beside("photo", photo).is_empty());
    assert_eq!(prepared.each(), ["subject"]);
}

#[test]
fn the_plan_leaves_out_what_photographs_do_not_need() {
    let dir = phantom(true);
    let inputs = photos(dir.path(), "s01");
    let wanted = wanting(&["sums"]);
    let standing: Vec<_> = inputs.iter().map(|input| foreseen(input, true, Facts::default())).collect();
    let facts = Facts { grey: Some(true), outlined: Some(true), ..Facts::default() };
    let to_be: Vec<_> = inputs.iter().map(|input| foreseen(input, false, facts)).collect();
    for steps in
        [&standing, &to_be].map(|inputs| prepared(&PhotosOptions::KIND, OPTIONS).steps(inputs, &wanted).unwrap())
    {
        assert_eq!(step(&steps, "channel"), (false, "every photograph is grey"));
        assert_eq!(step(&steps, "outlines from LabelMe"), (true, "2 photograph(s)"));
        assert!(!step(&steps, "detection").0 && !step(&steps, "pictures written").0 && !step(&steps, "maps").0);
    }
    let colour: Vec<_> = inputs
        .iter()
        .filter(|input| input.role == "photo")
        .map(|input| foreseen(input, false, Facts { grey: Some(false), outlined: Some(false), ..Facts::default() }))
        .collect();
    let steps = prepared(&PhotosOptions::KIND, OPTIONS).steps(&colour, &wanting(&["sums", "pictures"])).unwrap();
    assert!(step(&steps, "channel").0 && step(&steps, "detection").0 && step(&steps, "pictures written").0);
}

#[test]
fn white_and_mask_values_are_part_of_what_a_task_is() {
    let options = |keys: &str| super::prepared(&PhotosOptions::KIND, keys).depends_on(&wanting(&["sums"]));
    let plain = options("");
    assert!(plain["options"].get("white").is_none() && plain["options"].get("mask_value").is_none());
    let said = options("white = 4095\nmask_value = '250..255'\nmax_megapixels = 400");
    let said = &said["options"];
    assert_eq!(
        (&said["white"], &said["mask_value"], &said["max_megapixels"]),
        (&"4095".into(), &"250..255".into(), &"400".into())
    );
    for keys in ["white = 7", "mask_value = '9..1'", "max_megapixels = 0"] {
        assert!((PhotosOptions::KIND.prepare)(&keys.parse().unwrap()).is_err(), "{keys}");
    }
}
