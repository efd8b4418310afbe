//! The report's section: it argues as section 4.2.2 does, from what was measured.

use super::compare::{ChannelDifference, ChannelFigures, ChannelRow};
use super::interval::Estimate;
use crate::figure::Page;
use crate::photo::normalize::Channel;
use crate::table::TextColumn;

const CLAIM: &str = "The thesis isolates the green component because \u{201c}the red and white areas of the \
    fingernail differ mainly in their green component, while the red and blue components are almost identical\u{201d} \
    (section 4.2.2). Here that is measured: the contrast is the mean of the white zones less that of the red ones, on \
    the same places of the nail in all three channels. White is the lightest quarter of the nail's bed, red the \
    darkest. For each subject they are chosen on the mean picture of the other subjects, in which every channel has \
    one vote; so neither a subject's noise nor one channel can make its own contrast. Intervals are 95 % confidence \
    intervals of the mean over subjects (Student's t), each for itself. Relative contrast is that of light (sRGB's \
    curve undone) divided by the mean light of both zones. Shade and lunula are light and dark in every channel: where \
    relative contrast is the same in all three, that is all the zones show. A camera's own tone curve makes it differ: \
    photographs have to be sRGB without one, or linear.";

/// The columns of the table of channels, and of that of their differences.
const COLUMNS: [TextColumn<ChannelRow>; 10] = [
    ("pose", |row| row.pose.clone()),
    ("tone", |row| row.tone.clone().unwrap_or_default()),
    ("channel", |row| row.channel.name().to_owned()),
    ("subjects", |row| row.subjects.to_string()),
    ("white, %", |row| percent(row.white)),
    ("red, %", |row| percent(row.red)),
    ("contrast, %", |row| percent(row.contrast.map(|contrast| contrast.mean))),
    ("95 % interval, %", |row| interval(row.contrast)),
    ("relative contrast, %", |row| percent(row.relative.map(|relative| relative.mean))),
    ("95 % interval, %", |row| interval(row.relative)),
];
const OF_DIFFERENCES: [TextColumn<ChannelDifference>; 6] = [
    ("pose", |row| row.pose.clone()),
    ("tone", |row| row.tone.clone().unwrap_or_default()),
    ("contrast of", |row| row.of.name().to_owned()),
    ("less that of", |row| row.less.name().to_owned()),
    ("difference, %", |row| percent(row.difference.map(|difference| difference.mean))),
    ("95 % interval, %", |row| interval(row.difference)),
];

/// What the paired differences say of a pose.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verdict {
    /// Green's contrast is beyond both others'.
    Green,
    /// Another channel's contrast is beyond green's.
    Other,
    /// An interval holds zero.
    Open,
    /// There is no interval.
    Unknown,
}

pub(in crate::photo) fn add_section(page: &mut Page, figures: &ChannelFigures) {
    page.heading("Why the green channel? (Section 4.2.2)");
    page.paragraph(CLAIM);
    page.list(&findings(figures));
    page.png(&figures.chart, "Contrast between white and red zones by pose and channel");
    let rows: Vec<Vec<String>> = figures.rows.iter().map(|row| COLUMNS.map(|(_, cell)| cell(row)).to_vec()).collect();
    page.table(&COLUMNS.map(|(name, _)| name), &rows, |_| false);
    page.paragraph(
        "All but relative contrast is in % of full scale; rows without a tone are of all subjects. Differences, \
         subject by subject:",
    );
    let rows: Vec<Vec<String>> =
        figures.differences.iter().map(|row| OF_DIFFERENCES.map(|(_, cell)| cell(row)).to_vec()).collect();
    page.table(&OF_DIFFERENCES.map(|(name, _)| name), &rows, |_| false);
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{:.2}", 100.0 * value))
}

fn interval(of: Option<Estimate>) -> String {
    let ends = of.and_then(|of| of.low.zip(of.high));
    ends.map_or_else(String::new, |(low, high)| format!("{:.2} to {:.2}", 100.0 * low, 100.0 * high))
}

/// What was found, over all subjects.
fn findings(figures: &ChannelFigures) -> Vec<String> {
    let of_all: Vec<&ChannelDifference> = figures.differences.iter().filter(|d| d.tone.is_none()).collect();
    let verdicts: Vec<(&str, Verdict)> =
        of_all.chunk_by(|a, b| a.pose == b.pose).map(|of_pose| (of_pose[0].pose.as_str(), verdict(of_pose))).collect();
    let named = |wanted: Verdict| -> Vec<&str> {
        verdicts.iter().filter(|(_, verdict)| *verdict == wanted).map(|(pose, _)| *pose).collect()
    };
    let say = |wanted: Verdict, what: &str| {
        let poses = named(wanted);
        let of =
            |poses: &[&str]| format!("In {} of {} pose(s) {what}: {}.", poses.len(), verdicts.len(), poses.join(", "));
        (!poses.is_empty()).then(|| of(&poses))
    };
    let said = [
        say(Verdict::Green, "green has more contrast than red and than blue, as the thesis finds"),
        say(Verdict::Other, "another channel has more contrast than green"),
        say(Verdict::Open, "green is not clearly ahead of both others (an interval of its lead holds zero)"),
        say(Verdict::Unknown, "nothing can be said, as there are fewer than two subjects in colour"),
    ];
    said.into_iter().flatten().chain(shares(figures)).collect()
}

/// Judges by green less red and green less blue.
fn verdict(of_pose: &[&ChannelDifference]) -> Verdict {
    let of_green = of_pose.iter().filter(|row| row.of == Channel::Green);
    let ends: Option<Vec<(f64, f64)>> =
        of_green.map(|row| row.difference.and_then(|difference| difference.low.zip(difference.high))).collect();
    match ends {
        None => Verdict::Unknown,
        Some(ends) if ends.iter().all(|(low, _)| *low > 0.0) => Verdict::Green,
        Some(ends) if ends.iter().any(|(_, high)| *high < 0.0) => Verdict::Other,
        Some(_) => Verdict::Open,
    }
}

/// How nearly identical red and blue zones are: their contrasts as shares of green's, over all poses.
fn shares(figures: &ChannelFigures) -> Option<String> {
    let total = |channel: Channel| -> f64 {
        let rows = figures.rows.iter().filter(|row| row.tone.is_none() && row.channel == channel);
        rows.filter_map(|row| row.contrast).map(|contrast| contrast.mean).sum()
    };
    let [red, green, blue] = [Channel::Red, Channel::Green, Channel::Blue].map(total);
    (green > 0.0).then(|| {
        let share = |of: f64| format!("{:.0} %", 100.0 * of / green);
        format!(
            "Of the contrast in green, summed over the poses, red shows {} and blue {}: the nearer to 0 %, the more \
             nearly identical white and red zones are there.",
            share(red),
            share(blue)
        )
    })
}
