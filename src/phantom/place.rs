//! Results that are whole go to their places together.

use std::path::{Path, PathBuf};
use std::{fs, io};

/// Moves `names` from `stage` to `out`; what stood there goes into `stage`, to be deleted with it, or back where a move fails.
///
/// # Errors
/// The place that could not be written, and what the system says.
pub(super) fn put_in_place(stage: &Path, out: &Path, names: &[&str]) -> Result<(), (PathBuf, io::Error)> {
    let mut moves = Vec::new();
    for name in names {
        let place = out.join(name);
        if place.exists() {
            moves.push((place.clone(), stage.join(format!("old-{name}"))));
        }
        moves.push((stage.join(name), place));
    }
    for (k, (from, to)) in moves.iter().enumerate() {
        if let Err(source) = fs::rename(from, to) {
            for (from, to) in moves[..k].iter().rev() {
                fs::rename(to, from).map_err(|source| (from.clone(), source))?;
            }
            return Err((to.clone(), source));
        }
    }
    Ok(())
}
