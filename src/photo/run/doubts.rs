//! Photographs that may be another pose's or another person's than the set says, or of another kind than the others.
//!
//! In: the set and what each nail's normalized picture and outline are. Out: warnings; nothing is left out. A person's
//! mistakes are meant (a column sorted by itself, outlines copied with their folder, a photograph saved again), by
//! which a map is another's: on phantoms its correlation with the true one falls from 1.0 to between 0.8 and -0.4.

use std::collections::BTreeMap;
use std::path::Path;

use crate::input::same_to_the_byte;
use crate::median::median_of;
use crate::photo::hues::Mistaken;
use crate::photo::normalize::{AT_FULL_SCALE, FULL_SCALE, Survey};
use crate::photo::outline::Source;
use crate::photo::pose;
use crate::photo::results::NailRow;
use crate::photo::set::{Photo, PhotoSet};
use crate::photo::sums::{Look, one_picture, seen_again};

/// A nail so many times brighter or darker than the median of all is of another exposure or depth (assumed: skin tones
/// differ by 3 in green, exposures of one set by 2).
const TIMES: f64 = 5.0;
/// The fewest nails that have a median.
const NAILS: usize = 4;
/// A picture with more than this share at its own greatest level, which is not full scale, was cut off there (119 nails
/// of 26 real hands: 0.0035 at most; overexposed ones cut off at 240 or 250 of 255: 0.015 to 0.59).
const CUT_OFF: f64 = 0.01;
/// Names that a warning gives.
const NAMES: usize = 3;

/// Subjects look linear beyond the first ([`Hues`](crate::photo::hues::Hues)), where the median subject lies below the
/// second.
const BESIDE: [f64; 2] = [1.0, -2.0];
/// The fewest subjects that have a median.
const SUBJECTS: usize = 3;

/// Photographs whose channels are exchanged.
fn exchanged(nails: &[Used]) -> Vec<String> {
    let say = |one: Mistaken| {
        let files = files(nails.iter().filter(|nail| nail.row.hues.mistaken == Some(one)))?;
        let [looks, done] = one.words();
        let green = if one == Mistaken::RedBlue { "Green is right all the same" } else { "Maps are of its green" };
        Some(format!("{looks} in {files}: {done} {green}"))
    };
    Mistaken::ALL.into_iter().filter_map(say).collect()
}

/// Subjects whose pictures look linear beside the others'.
fn linear(nails: &[Used]) -> Option<String> {
    let mut subjects: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for nail in nails {
        subjects.entry(&nail.photo.subject).or_default().extend(nail.row.hues.linear);
    }
    let known = subjects.into_iter().filter_map(|(subject, all)| Some((subject, median_of(all)?)));
    let known: Vec<(&str, f64)> = known.collect();
    let [beyond, below] = BESIDE;
    median_of(known.iter().map(|(_, linear)| *linear)).filter(|usual| *usual < below)?;
    let such: Vec<String> =
        known.iter().filter(|(_, linear)| *linear > beyond).map(|(subject, _)| (*subject).to_owned()).collect();
    let such = some(&such).filter(|_| known.len() >= SUBJECTS)?;
    Some(format!(
        "the photographs of {such} are darker and more coloured than the others': have they linear values (raw), or \
         another camera's curve, or very dim light? Means and standard deviations mix both; bring all to one curve"
    ))
}

/// Nails whose drawn axis the picture sees slant.
fn slanting(nails: &[Used]) -> Option<String> {
    let such = || nails.iter().filter(|nail| nail.row.slants_deg.is_some());
    let files = files(such())?;
    let first = such().next()?;
    let by_deg = first.row.slants_deg?;
    Some(format!(
        "the drawn axis is not the finger's direction in {files} (by the picture it is {:.0} degrees {} in {}): \
         correct the line, or, where it is right, say --distal as well",
        by_deg.abs(),
        if by_deg > 0.0 { "further clockwise" } else { "further counterclockwise" },
        first.photo.file
    ))
}

/// Nails whose drawn outline has a point far out.
fn spiked(nails: &[Used]) -> Option<String> {
    let such = nails.iter().filter_map(|nail| {
        let [x, y] = nail.row.spike_px?;
        Some(format!("{}, nail {} at ({x:.0}, {y:.0})", nail.photo.file, nail.row.number))
    });
    Some(format!(
        "a point of the drawn outline stands out far from all others: {}; is it a slip? Look at it with `lunula edit`",
        some(&such.collect::<Vec<_>>())?
    ))
}

/// Nails that are drawn, and counted, more than once.
fn drawn_twice(nails: &[Used]) -> Option<String> {
    let is_used =
        |photo: usize, number: usize| nails.iter().any(|nail| nail.row.photo == photo && nail.row.number == number);
    let such = nails.iter().filter_map(|nail| {
        let earlier = nail.row.drawn_over.filter(|earlier| is_used(nail.row.photo, *earlier))?;
        Some(format!("{}, nail {} over nail {earlier}", nail.photo.file, nail.row.number))
    });
    Some(format!(
        "outlines of one photograph lie over one another, as no two nails do: {}; a nail that is drawn twice counts \
         twice: remove one of the two in LabelMe or with `lunula edit`",
        some(&such.collect::<Vec<_>>())?
    ))
}

/// Regions of a mask that are parts of one nail, of which one at least counts.
fn in_parts(set: &PhotoSet, rows: &[NailRow]) -> Option<String> {
    let is_used = |photo: usize, number: usize| {
        rows.iter().any(|row| row.photo == photo && row.number == number && row.survey.is_some())
    };
    let such = rows.iter().filter_map(|row| {
        let earlier =
            row.touches.filter(|earlier| [*earlier, row.number].iter().any(|one| is_used(row.photo, *one)))?;
        Some(format!("{}, nail {} beside nail {earlier}", set.photos[row.photo].file, row.number))
    });
    Some(format!(
        "regions of one mask touch along a long border: {}; are they parts of one nail, as its bed and its lunula, or \
         cut by a line? Each is taken for a nail of its own, with the wrong length or width: fill the whole nail with \
         one value",
        some(&such.collect::<Vec<_>>())?
    ))
}

/// Nails that the network sees elsewhere than they are drawn.
fn elsewhere(nails: &[Used]) -> Option<String> {
    let such = nails.iter().filter_map(|nail| Some((&nail.photo.file, nail.row.number, nail.row.instead.as_ref()?)));
    let such: Vec<String> = such.map(|(file, number, instead)| format!("{file}, nail {number} ({instead})")).collect();
    Some(format!(
        "by the network that finds nails, {} of {} outlines are not where the nail is: {}; look at them with \
         `lunula edit`",
        such.len(),
        nails.len(),
        some(&such)?
    ))
}

/// What there is to say.
pub(super) fn doubts(set: &PhotoSet, rows: &[NailRow], looks: &[(&Photo, Look)]) -> Vec<String> {
    let nails: Vec<Used> = rows.iter().filter_map(|row| Used::of(set, row)).collect();
    let doubts = [
        same_pictures(&nails),
        saved_again(&nails, looks),
        same_outlines(&nails),
        levels(&nails),
        cut_off(&nails),
        linear(&nails),
        slanting(&nails),
        spiked(&nails),
        drawn_twice(&nails),
        in_parts(set, rows),
        elsewhere(&nails),
        folders(set),
        deeper(set),
    ];
    let names = || set.photos.iter().map(|photo| (photo.pose.as_str(), photo.subject.as_str()));
    doubts.into_iter().flatten().chain(exchanged(&nails)).chain(pose::doubts(names)).collect()
}

/// A nail that was used.
struct Used<'a> {
    photo: &'a Photo,
    row: &'a NailRow,
    survey: Survey,
}

impl<'a> Used<'a> {
    fn of(set: &'a PhotoSet, row: &'a NailRow) -> Option<Self> {
        Some(Self { photo: &set.photos[row.photo], row, survey: row.survey? })
    }
}

/// The first names of several, and how many more there are; none of none.
fn some(names: &[String]) -> Option<String> {
    let more = names.len().saturating_sub(NAMES);
    let first = names[..names.len() - more].join(", ");
    (!names.is_empty()).then(|| if more > 0 { format!("{first} and {more} more") } else { first })
}

/// The photographs of nails, each once, where there are some.
fn files<'a, 'b: 'a>(nails: impl Iterator<Item = &'a Used<'b>>) -> Option<String> {
    let mut names: Vec<String> = nails.map(|nail| nail.photo.file.clone()).collect();
    names.dedup();
    some(&names)
}

fn as_listed(photo: &Photo) -> String {
    format!("{} as {} of {}", photo.file, photo.subject, photo.pose)
}

/// Groups of nails of several photographs of the set that have something in common.
fn alike<'a, 'b, K: Ord>(nails: &'b [Used<'a>], of: impl Fn(&Used<'a>) -> Option<K>) -> Vec<Vec<&'b Used<'a>>> {
    let mut groups: BTreeMap<K, Vec<&Used>> = BTreeMap::new();
    for nail in nails {
        if let Some(key) = of(nail) {
            groups.entry(key).or_default().push(nail);
        }
    }
    let several = |group: &Vec<&Used>| group.iter().any(|nail| nail.row.photo != group[0].row.photo);
    groups.into_values().filter(several).collect()
}

/// Photographs that are one, saved twice or listed twice: copies to the byte are said elsewhere.
fn same_pictures(nails: &[Used]) -> Option<String> {
    let has_detail = |nail: &Used| nail.survey.at_greatest < nail.survey.seen / 2;
    let groups = alike(nails, |nail| has_detail(nail).then_some(nail.survey));
    let is_said = |group: &Vec<&Used>| {
        let paths: Vec<&Path> = group.iter().map(|nail| nail.photo.path.as_path()).collect();
        let distinct = paths.iter().any(|path| *path != paths[0]);
        distinct
            && same_to_the_byte(paths.iter().map(|path| ((), *path)))
                .first()
                .is_some_and(|one| one.len() == paths.len())
    };
    let names: Vec<String> = groups
        .iter()
        .filter(|group| !is_said(group))
        .map(|group| group.iter().map(|nail| as_listed(nail.photo)).collect::<Vec<_>>().join(" and "))
        .collect();
    Some(format!("the same nail to the last digit is counted more than once: {}; keep the right one", some(&names)?))
}

/// Photographs of several people that look the same, apart from those whose nails are the same to the last digit.
fn saved_again(nails: &[Used], looks: &[(&Photo, Look)]) -> Option<String> {
    let surveys = |photo: &Photo| -> Vec<Survey> {
        nails.iter().filter(|nail| nail.photo.path == photo.path).map(|nail| nail.survey).collect()
    };
    let is_new = |one: &Photo, other: &Photo| one.subject != other.subject && surveys(one) != surveys(other);
    let pairs = seen_again(looks.iter().map(|(photo, look)| (*photo, look)), is_new);
    one_picture(&pairs.into_iter().map(|pair| pair.map(as_listed)).collect::<Vec<_>>())
}

/// Outlines that several photographs share: drawn for one of them.
fn same_outlines(nails: &[Used]) -> Option<String> {
    let differ = |group: &Vec<&Used>| group.iter().any(|nail| nail.survey != group[0].survey);
    let mut groups: Vec<_> = alike(nails, |nail| nail.row.drawn).into_iter().filter(differ).collect();
    groups.sort_by_key(|group| group[0].row.photo);
    let names: Vec<String> = groups
        .iter()
        .map(|group| group.iter().map(|nail| nail.photo.file.clone()).collect::<Vec<_>>().join(" and "))
        .collect();
    let is_mask = groups.iter().flatten().any(|nail| nail.row.source == Source::Mask);
    let masks = if is_mask { "; a mask of each pose is MASKS/<pose>/<subject>.png" } else { "" };
    Some(format!(
        "photographs share one outline to the last digit: {}; was it drawn on each of them? One that was copied \
         from another pose or person shows another place of the finger{masks}",
        some(&names)?
    ))
}

/// Nails that are far brighter or darker than all others.
fn levels(nails: &[Used]) -> Option<String> {
    let usual = median_of(nails.iter().map(|nail| nail.survey.mean())).filter(|_| nails.len() >= NAILS)?;
    let off = |nail: &&Used| !(usual / TIMES..=usual * TIMES).contains(&nail.survey.mean());
    let names: Vec<String> = nails
        .iter()
        .filter(off)
        .map(|nail| format!("{} ({:.1} %)", nail.photo.file, 100.0 * nail.survey.mean()))
        .collect();
    Some(format!(
        "nails are far brighter or darker than usual, which is {:.1} % of full scale in green: {}; are these of \
         another exposure, or of fewer bits kept in 16 (--white)? Maps average them with the others",
        100.0 * usual,
        some(&names)?
    ))
}

/// Pictures that are flat at their brightest, below full scale: what was cut off was scaled down afterwards.
fn cut_off(nails: &[Used]) -> Option<String> {
    let share = |nail: &Used| nail.survey.at_greatest as f64 / nail.survey.seen.max(1) as f64;
    let is_cut = |nail: &&Used| nail.survey.greatest < AT_FULL_SCALE && share(nail) > CUT_OFF;
    let cut: Vec<&Used> = nails.iter().filter(is_cut).collect();
    let first = cut.first()?;
    Some(format!(
        "{} of {} nails are flat at their brightest, below full scale ({} first: {:.0} % of it at exactly {:.1} %): \
         overexposed, and made darker by a program afterwards? There the maps are too flat; take them again with less \
         exposure",
        cut.len(),
        nails.len(),
        first.photo.file,
        100.0 * share(first),
        100.0 * f64::from(first.survey.greatest) / f64::from(FULL_SCALE)
    ))
}

/// Photographs in a folder that has the name of another pose.
fn folders(set: &PhotoSet) -> Option<String> {
    let poses = set.poses();
    let folder = |photo: &Photo| photo.path.parent()?.file_name()?.to_str().map(str::to_owned);
    let others = set
        .photos
        .iter()
        .filter(|photo| folder(photo).is_some_and(|folder| folder != photo.pose && poses.contains(&folder.as_str())));
    let names: Vec<String> = others.map(as_listed).collect();
    Some(format!(
        "photos.csv lists {} photograph(s) in the folder of one pose as another's: {}; was a column sorted by \
         itself?",
        names.len(),
        some(&names)?
    ))
}

/// Photographs in folders within those of poses.
fn deeper(set: &PhotoSet) -> Option<String> {
    let such = set.deeper.iter().map(|(folder, pictures)| format!("{pictures} picture(s) in {folder}"));
    let such: Vec<String> = such.collect();
    Some(format!(
        "folders within a pose's are not looked into: {}; move what belongs to the set up into the pose's folder, \
         or list all in photos.csv",
        some(&such)?
    ))
}
