//! Photographs of a set that are one file under several names: of a subject that is missing, or a pose.
//!
//! Files differ by their size; of one size, as uncompressed photographs have, mostly by a few bytes of their middle.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::FileExt as _;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::set::Photo;
use crate::input;

/// Bytes of the middle that are looked at first.
const MIDDLE: usize = 4096;

/// What to say of photographs that are the same to the byte. Those that can't be read are said elsewhere.
pub(super) fn copies(photos: &[Photo]) -> Vec<String> {
    let regular = |photo: &&Photo| fs::metadata(&photo.path).is_ok_and(|about| about.is_file());
    let by_size = alike(photos.iter().filter(regular).collect(), |path| Ok(fs::metadata(path)?.len()));
    let by_middle = by_size.into_iter().flat_map(|photos| alike(photos, middle));
    let whole = |path: &Path| Ok(Sha256::digest(input::read(path)?));
    let same = by_middle.flat_map(|photos| alike(photos, whole));
    let mut said: Vec<String> = same
        .map(|photos| {
            let names: Vec<&str> = photos.iter().map(|photo| photo.file.as_str()).collect();
            format!(
                "{}: the same photograph, to the byte; it counts as each. Keep the one that it is",
                names.join(", ")
            )
        })
        .collect();
    said.sort();
    said
}

/// Groups of two files or more of which the same is found.
fn alike<T: Ord>(photos: Vec<&Photo>, of: impl Fn(&Path) -> io::Result<T>) -> Vec<Vec<&Photo>> {
    let mut groups: BTreeMap<T, Vec<&Photo>> = BTreeMap::new();
    for photo in photos {
        // A manifest may name a file several times, for several nails.
        if let Ok(found) = of(&photo.path) {
            let group = groups.entry(found).or_default();
            if group.iter().all(|other| other.path != photo.path) {
                group.push(photo);
            }
        }
    }
    groups.into_values().filter(|group| group.len() > 1).collect()
}

fn middle(path: &Path) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let mut bytes = vec![0; MIDDLE];
    let read = file.read_at(&mut bytes, file.metadata()?.len() / 2)?;
    bytes.truncate(read);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_the_same_bytes_are_found_and_others_are_not() {
        let dir = tempfile::tempdir().unwrap();
        let photo = |file: &str, bytes: &[u8]| {
            let path = dir.path().join(file);
            fs::write(&path, bytes).unwrap();
            Photo { pose: "normal".into(), subject: file.into(), file: file.into(), path, outline: None, tone: None }
        };
        let one: Vec<u8> = (0..20_000_u32).map(|k| (k * k % 251) as u8).collect();
        let mut first_byte = one.clone();
        first_byte[0] ^= 1;
        let mut photos = vec![
            photo("a", &one),
            photo("b", &first_byte),
            photo("c", &one[..19_999]),
            photo("d", &one),
            photo("e", b""),
            photo("f", &one),
        ];
        photos.push(photos[0].clone());
        photos.push(Photo { path: dir.path().join("gone"), ..photos[0].clone() });
        let [said] = &copies(&photos)[..] else { panic!("{:?}", copies(&photos)) };
        assert!(said.starts_with("a, d, f: the same photograph"), "{said}");
        assert!(copies(&photos[..3]).is_empty() && copies(&[]).is_empty());
    }
}
