//! Inputs that are one file under several names: copied for a subject who is missing, or given twice.
//!
//! Files differ by their size; of one size, as uncompressed photographs have, mostly by a few bytes of their middle.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::FileExt as _;
use std::path::Path;

use sha2::{Digest, Sha256};

/// Bytes of the middle that are looked at first.
const MIDDLE: usize = 4096;

/// An input with what the caller calls it.
type Named<'a, N> = (N, &'a Path);

/// What to say of inputs that are the same to the byte.
pub(crate) fn copies<'a>(inputs: impl IntoIterator<Item = Named<'a, String>>) -> Vec<String> {
    let mut said: Vec<String> = same_to_the_byte(inputs)
        .into_iter()
        .map(|inputs| {
            let names: Vec<&str> = inputs.iter().map(|(name, _)| name.as_str()).collect();
            format!("{}: the same to the byte, and counted {} times; keep one", names.join(", "), names.len())
        })
        .collect();
    said.sort();
    said
}

/// Groups of two inputs or more that are the same to the byte, each in its inputs' order. Of those that can't be read
/// it is said elsewhere.
pub(crate) fn same_to_the_byte<'a, N>(inputs: impl IntoIterator<Item = Named<'a, N>>) -> Vec<Vec<Named<'a, N>>> {
    let regular = |input: &Named<'a, N>| fs::metadata(input.1).is_ok_and(|about| about.is_file());
    let by_size = alike(inputs.into_iter().filter(regular).collect(), |path| Ok(fs::metadata(path)?.len()));
    let by_middle = by_size.into_iter().flat_map(|inputs| alike(inputs, middle));
    by_middle.flat_map(|inputs| alike(inputs, |path| Ok(Sha256::digest(super::read(path)?)))).collect()
}

/// Groups of two inputs or more of which the same is found.
fn alike<'a, N, T: Ord>(inputs: Vec<Named<'a, N>>, of: impl Fn(&Path) -> io::Result<T>) -> Vec<Vec<Named<'a, N>>> {
    let mut groups: BTreeMap<T, Vec<Named<'a, N>>> = BTreeMap::new();
    for input in inputs {
        if let Ok(found) = of(input.1) {
            groups.entry(found).or_default().push(input);
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
        let one: Vec<u8> = (0..20_000_u32).map(|k| (k * k % 251) as u8).collect();
        let mut first_byte = one.clone();
        first_byte[0] ^= 1;
        let files = [("a", &one[..]), ("b", &first_byte), ("c", &one[..19_999]), ("d", &one), ("e", b""), ("f", &one)];
        let paths = files.map(|(name, bytes)| {
            let path = dir.path().join(name);
            fs::write(&path, bytes).unwrap();
            path
        });
        let gone = dir.path().join("gone");
        let named = || files.iter().zip(&paths).map(|((name, _), path)| ((*name).to_owned(), path.as_path()));
        let all = copies(named().chain([("gone".into(), gone.as_path()), ("folder".into(), dir.path())]));
        assert_eq!(all, ["a, d, f: the same to the byte, and counted 3 times; keep one"]);
        assert!(copies(named().take(3)).is_empty() && copies([]).is_empty());
        let twice = copies([("c".into(), paths[2].as_path()), ("./c".into(), paths[2].as_path())]);
        assert!(twice[0].starts_with("c, ./c: "), "{twice:?}");
    }
}
