//! The order of poses wherever they are listed: that of the thesis' figures (Fig. 51 and 53 to 56), then the alphabet.

/// The thesis' poses, by their names in folders and tables, in the order of its figures.
pub const THESIS_POSES: [&str; 8] = [
    "nominal",
    "normal",
    "lateral_negative",
    "lateral_positive",
    "longitudinal_negative",
    "longitudinal_positive",
    "extension",
    "flexion",
];

/// What poses are sorted by: the thesis' come first, in its order, all others after them by name.
pub(in crate::photo) fn rank(pose: &str) -> (usize, &str) {
    (THESIS_POSES.iter().position(|name| *name == pose).unwrap_or(THESIS_POSES.len()), pose)
}

/// Sorts what belongs to poses; what belongs to the same one stays in its order.
pub(in crate::photo) fn sort_by_pose<T>(items: &mut [T], pose: impl Fn(&T) -> &str) {
    items.sort_by(|a, b| rank(pose(a)).cmp(&rank(pose(b))));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_poses_come_first_and_in_its_order() {
        let mut poses = ["relaxed", "flexion", "Normal", "extension", "normal", "nominal"];
        sort_by_pose(&mut poses, |pose| pose);
        assert_eq!(poses, ["nominal", "normal", "extension", "flexion", "Normal", "relaxed"]);
    }
}
