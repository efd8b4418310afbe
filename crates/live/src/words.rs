//! Words that are not known.

/// What to write instead of one: the nearest, which differs by a letter in three at most, or the choice.
pub(crate) fn instead(word: &str, known: &[&str]) -> String {
    let slips = 1.max(word.chars().count() / 3);
    let nearest = known.iter().map(|known| (strsim::osa_distance(&word.to_lowercase(), known), *known)).min();
    match nearest.filter(|(distance, _)| *distance <= slips) {
        Some((_, known)) => format!("did you mean `{known}`?"),
        None => format!("known: {}", known.join(", ")),
    }
}
